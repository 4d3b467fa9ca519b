"""Modes where neither a drawing nor a sign chooses: the open four-bar, in whatever order anything is written."""

import itertools
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from tests import catalog

# Crank, coupler, rocker and frame of the four-bar of issue 13, and where its inner pin is at 40 degrees: by hand, the
# intersection of two circles that lies above.
TEXTBOOK = (40.0, 120.0, 80.0, 100.0)


def four_bar(a: Any, b: Any, c: Any, d: Any, order: Any = range(4), backward: bool = False, *more: Any) -> ck.Mechanism:
    links = [
        ("frame", {"A": 0, "D": d}),
        ("crank", {"A": 0, "B": a}),
        ("coupler", {"B": 0, "C": b}),
        ("rocker", {"D": 0, "C": c}),
    ]
    written = [(name, dict(reversed(points.items())) if backward else points) for name, points in links]
    return ck.Mechanism(
        "Four-bar", *(ck.link(*written[k][:1], **written[k][1]) for k in order), ck.drive("crank"), *more
    )


def area(motion: Any, letters: str = "ABCD") -> Any:
    """The signed area of a polygon by the shoelace formula."""
    corners = [motion.points[letter].position for letter in letters]
    return sum(p.real * q.imag - q.real * p.imag for p, q in zip(corners, corners[1:] + corners[:1], strict=True)) / 2


@pytest.mark.parametrize("backward", [False, True])
@pytest.mark.parametrize("order", list(itertools.permutations(range(4))))
def test_the_four_bar_of_every_textbook_is_open(order: Any, backward: bool) -> None:
    motion = ck.solve(four_bar(*TEXTBOOK, order, backward), {"crank": ck.deg(40)})
    assert abs(complex(motion.points["C"].position) - (143.19 + 67.34j)) < 0.01
    assert np.rad2deg(motion.links["coupler"].angle) == pytest.approx(20.3, abs=0.05)
    assert np.rad2deg(motion.links["rocker"].angle) == pytest.approx(57.3, abs=0.05)
    assert motion.chosen_by == {0: "default"}
    # on a tie, just after it, the driver increasing
    assert ck.solve(four_bar(*TEXTBOOK, order, backward), {"crank": ck.deg([0, -10])}).points["C"].y[0] > 0
    assert ck.solve(four_bar(*TEXTBOOK, order, backward), {"crank": ck.deg([180, 190])}).points["C"].y[0] < 0


@pytest.mark.parametrize("seed", range(20))
def test_the_area_is_the_larger_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, b, c, d = rng.uniform(1.0, 1.2), *rng.uniform(2.0, 3.0, 3)
    angle = rng.uniform(0.0, 2 * np.pi)
    motions = [ck.solve(four_bar(a, b, c, d), {"crank": angle}, modes=m) for m in (None, {"rocker": 1}, {"rocker": -1})]
    default, *both = (abs(float(area(motion))) for motion in motions)
    assert default == pytest.approx(max(both))


def test_a_motion_says_its_modes() -> None:
    motion = ck.solve(four_bar(*TEXTBOOK), {"crank": ck.deg(40)})
    (mode,) = motion.modes.values()
    assert list(motion.modes) == ["RRR(coupler)"]
    assert (mode.links, mode.sign, mode.chosen) == (("coupler", "rocker"), -1, "taken by default")
    assert repr(mode) == "GroupMode(coupler, rocker: -1, taken by default)"
    (chosen,) = ck.solve(four_bar(*TEXTBOOK), {"crank": ck.deg(40)}, modes={"rocker": 1}).modes.values()
    assert (chosen.sign, chosen.chosen) == (1, "chosen by sign")
    several = ck.solve(four_bar(*TEXTBOOK), {"crank": ck.deg([[40.0], [320.0]])}).modes["RRR(coupler)"]
    assert np.asarray(several.sign).tolist() == [-1, 1]
    third = ck.solve(ck.load("class-iii-six-bar")).modes["RRR-RRR(leg-1)"]
    assert (third.sign, third.chosen) == (None, "nearest to the drawing")
    assert ck.solve(ck.load("scotch-yoke")).modes["RPP(block)"].chosen == "the only one"


def test_every_design_has_its_own() -> None:
    angles = ck.deg(np.array([40.0, 320.0]))[:, None]
    motion = ck.solve(four_bar(*TEXTBOOK), {"crank": angles})
    assert (motion.points["C"].y[:, 0] > 0).tolist() == [True, False]
    grid = four_bar(40.0, np.full((2, 1, 1), 120.0), np.full((3, 1), 80.0), 100.0)
    assert np.all(ck.solve(grid, {"crank": ck.deg([40, 60])}).points["C"].y > 0)


def test_a_parallelogram_is_one_by_default_from_any_first_pose() -> None:
    for first in (0, 40, 180, 200):
        motion = ck.solve(four_bar(2.0, 5.0, 2.0, 5.0), {"crank": ck.deg(first + np.arange(0.0, 361.0, 5.0))})
        assert np.abs(motion.links["coupler"].angle).max() < 1e-12


def test_both_loops_of_a_six_bar_on_a_double_pin_stand_open() -> None:
    """Two four-bars one behind the other; the second dyad hangs on a pin of three links."""
    links = (
        ck.link("frame", A=0, D=100, G=180),
        ck.link("crank", A=0, B=40),
        ck.link("coupler", B=0, C=120),
        ck.link("rocker", D=0, C=80),
        ck.link("rod", C=0, F=90),
        ck.link("follower", G=0, F=70),
    )
    for order in itertools.islice(itertools.permutations(range(6)), 0, None, 37):
        mechanism = ck.Mechanism("Six-bar", *(links[k] for k in order), ck.drive("crank"))
        motion = ck.solve(mechanism, {"crank": ck.deg(40)})
        assert abs(complex(motion.points["C"].position) - (143.19 + 67.34j)) < 0.01
        own = {"rocker": motion.sign(0, 0)}
        both = (ck.solve(mechanism, {"crank": ck.deg(40)}, modes={**own, "rod": sign}) for sign in (1, -1))
        assert abs(area(motion, "DCFG")) == pytest.approx(max(abs(area(one, "DCFG")) for one in both))


def test_other_dyads_have_mode_one() -> None:
    """A slider-crank, whose block is farther along its guide; and a dyad between two driven cranks: five links."""
    slider = ck.Mechanism(
        "Slider-crank",
        ck.link("frame", A=0),
        ck.link("crank", A=0, B=1),
        ck.link("rod", B=0, C=3),
        ck.link("slider", C=0),
        ck.slide("slider", on="frame", through="A"),
        ck.drive("crank"),
    )
    assert ck.solve(slider, {"crank": ck.deg(40)}).points["C"].x > 0
    five_bar = ck.Mechanism(
        "Five-bar",
        ck.link("frame", A=0, E=4),
        ck.link("left", A=0, B=2),
        ck.link("right", E=0, D=2),
        ck.link("one", B=0, C=3),
        ck.link("two", D=0, C=3),
        ck.drive("left"),
        ck.drive("right"),
    )
    assert ck.solve(five_bar, {"left": 1.5, "right": 1.6}).sign(0, 0) == 1


@pytest.mark.parametrize("more", [(), (ck.drawn(B=1, P=1),)], ids=["not drawn", "drawn"])
def test_a_group_of_one_mode_is_not_chosen_by_anything(more: Any) -> None:
    yoke = ck.Mechanism(
        "Scotch yoke",
        ck.link("frame", A=0),
        ck.link("crank", A=0, B=1),
        ck.link("block", B=0),
        ck.link("yoke", P=0),
        ck.slide("block", on="yoke", through="P", angle=ck.deg(90)),
        ck.slide("yoke", on="frame", through="A"),
        ck.drive("crank"),
        *more,
    )
    assert ck.solve(yoke).chosen_by == {0: "only one"}


def platform(order: Any, scale: float = 1.0) -> ck.Mechanism:
    links = [
        ("frame", {"A": 0, "D": 5, "Q": 9 - 6j}),
        ("crank", {"A": 0, "B": 1.2}),
        ("first", {"B": 0, "K": 6}),
        ("second", {"D": 0, "L": 5}),
        ("third", {"Q": 0, "M": 7}),
        ("plate", {"K": 0, "L": 3, "M": 1.5 + 2j}),
    ]
    scaled = [(name, {letter: scale * p for letter, p in points.items()}) for name, points in links]
    return ck.Mechanism("Platform", *(ck.link(scaled[k][0], **scaled[k][1]) for k in order), ck.drive("crank"))


def test_a_larger_group_is_as_far_from_singular_as_can_be() -> None:
    """Its configuration has the largest derivative of the legs' lengths, and depends on no order and no unit."""
    expected = ck.solve(platform(range(6)), {"crank": 0.3}).points["M"].position
    for order in ((5, 4, 3, 2, 1, 0), (2, 5, 0, 3, 1, 4), (4, 1, 5, 2, 0, 3)):
        for scale in (1.0, 1e-4, 1e5):
            motion = ck.solve(platform(order, scale), {"crank": 0.3})
            assert abs(motion.points["M"].position / scale - expected) < 1e-8
            assert motion.chosen_by == {0: "default"}
    leverages = []
    for one in ck.configurations(platform(range(6)), {"crank": 0.3}):
        legs = [(one.points[p], one.points[q]) for p, q in ("BK", "DL", "QM")]
        lines = [(q - p) / abs(q - p) for p, q in legs]
        moments = [(p.conjugate() * line).imag for (p, _), line in zip(legs, lines, strict=True)]
        table = [(line.real, line.imag, moment) for line, moment in zip(lines, moments, strict=True)]
        leverages.append((abs(np.linalg.det(table)), one.points["M"]))
    assert abs(max(leverages, key=lambda found: found[0])[1] - expected) < 1e-8


def test_every_mechanism_of_the_catalog_states_its_modes() -> None:
    for name in catalog.NAMES:
        motion = catalog.motion(name)
        for solver in motion.solving_order.solvers:
            assert solver.modes == 1 or motion.chosen_by[solver.index] != "default", name
