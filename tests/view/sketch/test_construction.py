"""Dyads constructed by circles and lines: loci that meet where the solution is, and pictures that show them."""

from __future__ import annotations

from collections import Counter
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import compoundkin as ck
from compoundkin.cli import cli
from compoundkin.kinematics.dyad_loci import CircleLocus, Loci
from compoundkin.kinematics.groups import DYADS, as_dyad
from compoundkin.view.sketch.labels import text_half
from compoundkin.view.sketch.shapes import CircleShape, Text, leaves
from compoundkin.view.sketch.sketch_style import LETTER, SMALL
from tests import catalog
from tests.support import drawn_values, random_sketch


def constructed(motion: ck.results.Motion, at: int) -> list[tuple[Any, tuple[Loci, ...], Any]]:
    """The dyads of a motion with their constructions at a pose, and the block that they were made from."""
    pose = slice(at, at + 1)
    block = motion.block(motion.inputs.cut(slice(0, 1), pose), 0, np.array([[float(at)]]), np.array([[0]]))
    solvers = [dyad for dyad in map(as_dyad, motion.solving_order.solvers) if dyad is not None]
    return [(solver, solver.constructions(block), block) for solver in solvers]


def off(loci: Loci, size: float) -> float:
    """How far the meeting place is from being on every curve; a line may touch a circle elsewhere."""
    (line,) = [curve for curve in loci.curves if not isinstance(curve, CircleLocus)][-1:] or (None,)
    found = []
    for curve in loci.curves:
        if isinstance(curve, CircleLocus):
            own = abs(abs(loci.meeting - curve.centre) - curve.radius)
            touching = np.inf
            if line is not None:
                touching = abs(abs((np.conj(line.along) * (curve.centre - line.at)).imag) - curve.radius)
            found.append(min(own, touching))
            assert not curve.name or abs(abs(curve.end - curve.centre) - curve.radius) < 1e-12 * size
        else:
            found.append(abs((np.conj(curve.along) * (loci.meeting - curve.at)).imag))
    return max(found) / size


def check(motion: ck.results.Motion, at: int) -> Counter[str]:
    """Every dyad of a pose: its curves meet; the first mode is that of the motion, the other one another."""
    count: Counter[str] = Counter()
    for solver, modes, block in constructed(motion, at):
        count[solver.name] += 1
        assert len(modes) == solver.modes
        assert all(off(loci, motion.size) < 1e-9 for loci in modes)
        first, inner, second = solver.arguments(block)
        body = block.world.get(solver.bodies[0].links[0])
        if body is not None and solver.inner[0].pair.code == "R":
            assert abs(modes[0].meeting - np.ravel(body.at(inner[0].point).c[0])[0]) < 1e-9 * motion.size
        assert all(loci.told for loci in modes)
        if solver.name == "RRR":
            outer = [np.ravel(side.world.point.c[0])[0] for side in (first, second)]
            way = (modes[0].meeting - outer[0]) / (outer[1] - outer[0])
            mirrored = outer[0] + np.conj(way) * (outer[1] - outer[0])
            assert abs(modes[1].meeting - mirrored) < 1e-9 * motion.size
    return count


def test_loci_meet_where_the_dyads_of_the_catalog_are_assembled() -> None:
    count: Counter[str] = Counter()
    for name in catalog.NAMES:
        if any(group.name in DYADS for group in catalog.structure(name).groups):
            motion = catalog.motion(name)
            count += check(motion, int(np.flatnonzero(motion.failed[0] == 0)[motion.inputs.poses // 7]))
    assert count["RRR"] > 60
    assert min(count[name] for name in ("RRP", "RPR", "RPP")) >= 2


@pytest.mark.parametrize("kind", DYADS)
def test_loci_of_eccentric_dyads_meet_too(kind: str) -> None:
    for seed in range(6):
        mechanism = random_sketch(np.random.default_rng(seed), (kind,), multiple=0.0).mechanism()
        motion = ck.solve(mechanism, {name: [value] for name, value in drawn_values(mechanism).items()})
        assert check(motion, 0)[kind] == 1


SHOWN = ["crank-rocker", "slider-crank-offset", "whitworth-quick-return", "scotch-yoke", "six-bar", "hydraulic-crane"]


@pytest.mark.parametrize("name", SHOWN)
def test_a_picture_shows_whole_circles_and_labels_beside_each_other(name: str) -> None:
    motion = catalog.motion(name)
    picture = ck.draw(motion, kind="construction")
    window = picture.window
    assert window is not None
    solver, modes, _ = constructed(motion, int(pose_of(motion)))[0]
    circles = [shape for shape in leaves(picture.shapes) if isinstance(shape, CircleShape)]
    for curve in modes[0].curves:
        if isinstance(curve, CircleLocus):
            at, radius = complex(window.at(curve.centre)), curve.radius * window.scale
            assert any(abs(c.centre - at) < 0.2 and abs(c.radius - radius) < 0.2 for c in circles)
            assert all(window.holds(at + radius * e) for e in (1, 1j, -1, -1j))
    texts = [shape for shape in leaves(picture.shapes) if isinstance(shape, Text)]
    said = [text for text in texts if text.style in ("letter", "number")]
    assert {curve.name for curve in modes[0].curves if isinstance(curve, CircleLocus)} <= {"", *(t.text for t in said)}
    assert all(window.holds(text.at) for text in said)
    for one, two in combinations([text for text in said if text.at not in {c.centre for c in circles}], 2):
        halves = [text_half(t.text, LETTER if t.style == "letter" else SMALL) for t in (one, two)]
        gap = one.at - two.at
        assert abs(gap.real) >= sum(h.real for h in halves) or abs(gap.imag) >= sum(h.imag for h in halves)
    prime = f"{solver.letters[1]}\u2032"
    assert (prime in [text.text for text in said]) == (solver.name in ("RRR", "RRP"))


def test_a_guide_used_far_beyond_the_mechanism_is_drawn_where_the_pose_needs_it() -> None:
    """Two blocks on one pin, their guides nearly parallel at the first pose."""
    first = ck.slide("one", on="frame", at="X", through="P")
    blocks = (
        first,
        ck.slide("two", on="crank", at="X", through="O", toward="Q"),
        ck.link("one", "X"),
        ck.link("two", "X"),
    )
    bars = ck.link("frame", O=(0, 0), P=(0, 40)), ck.link("crank", "O", "Q"), ck.drive("crank")
    mechanism = ck.Mechanism("guides", *bars, *blocks, ck.drawn(O=(0, 0), Q=(60, 60), P=(0, 40), X=(40, 40)))
    picture = ck.draw(ck.solve(mechanism, {"crank": np.linspace(1e-5, 1.5, 9)}), pose=4, kind="construction")
    assert len(picture.svg) < 20_000
    assert max(picture.width, picture.height) < 800


def test_a_small_dyad_fills_its_picture() -> None:
    """The bucket of an excavator reaches over a seventh of the arm; circles show it without the rest."""
    picture = ck.draw(catalog.motion("excavator-arm"), kind="construction", link="bucket")
    radii = [shape.radius for shape in leaves(picture.shapes) if isinstance(shape, CircleShape)]
    assert max(radii) > 0.15 * max(picture.width, picture.height)


def test_nothing_is_said_of_another_mode_that_is_the_same() -> None:
    """The guide of an RPR dyad runs through its pins in both modes, which differ by rounding."""
    for name, link in (("dixon-mechanism", "cf"), ("double-parallelogram-lift", "lower-3")):
        texts = [shape.text for shape in leaves(ck.draw(catalog.motion(name), kind="construction", link=link).shapes)
                 if isinstance(shape, Text)]  # fmt: skip
        assert any("runs through" in text for text in texts)
        assert not any("dashed" in text for text in texts)


def pose_of(motion: ck.results.Motion) -> int:
    """The pose that pictures show where none is asked for."""
    from compoundkin.view.sketch.picture_options import scene_of

    return scene_of(motion, None, None, 0).pose[1]


def test_the_dyad_is_that_of_a_link() -> None:
    assert ck.draw(catalog.motion("six-bar"), kind="construction", link="bar").title.endswith("of bar, block")
    same = ck.draw(catalog.mechanism("six-bar"), ck.deg(35), kind="construction", link="plate")
    assert same.svg == ck.draw(catalog.motion("six-bar"), ck.deg(35), kind="construction", link="plate").svg


def test_what_cannot_be_constructed_is_told() -> None:
    six_bar = catalog.motion("six-bar")
    for what, words, why in (
        (six_bar, {"link": "crank"}, "'crank' is in no group; the dyads have"),
        (six_bar, {"ghosts": 3}, "ghosts: it does not go with the kind 'construction'"),
        (catalog.motion("class-iii-six-bar"), {"link": catalog.structure("class-iii-six-bar").groups[0].links[0]},
         "which is not a dyad"),
        (catalog.motion("class-iii-six-bar"), {}, "there is no dyad"),
    ):  # fmt: skip
        with pytest.raises(ck.errors.InvalidInput, match=why):
            ck.draw(what, kind="construction", **words)
    with pytest.raises(ck.errors.UnknownName, match="brr"):
        ck.draw(six_bar, kind="construction", link="brr")
    with pytest.raises(ck.errors.InvalidInput, match="does not go with the kind 'sketch'"):
        ck.draw(six_bar, link="bar")
    rocker = catalog.mechanism("triple-rocker")
    with pytest.raises(ck.errors.NotAssembled):
        ck.draw(rocker, np.pi, kind="construction")


def test_the_command_line_draws_constructions() -> None:
    ran = CliRunner().invoke(cli, ["draw", "six-bar", "--at", "35", "--construction", "plate"])
    assert ran.exit_code == 0
    assert ran.stdout == ck.draw(catalog.motion("six-bar"), ck.deg(35), kind="construction", link="plate").svg
    for options, said in (
        (["--construction", "crank"], "is in no group"),
        (["--construction", "plate", "--ghosts", "2"], "it does not go with --construction"),
        (["--construction", "plate", "--polygon", "velocity"], "it does not go with --polygon"),
        (["--construction", "plat"], "did you mean 'plate'?"),
    ):
        ran = CliRunner().invoke(cli, ["draw", "six-bar", *options])
        assert ran.exit_code == 2
        assert said in ran.stderr
