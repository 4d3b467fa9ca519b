"""No optional answer is needed: kinds without any pass every public function, and so does each kind without each."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import compoundkin as ck
from compoundkin.analysis.equations.expressions import latex, text
from compoundkin.analysis.equivalents import equivalent_linkage
from compoundkin.base.errors import InvalidInput, InvalidMechanism, UnassembledPoses
from compoundkin.cli import cli
from compoundkin.files import load
from compoundkin.files.mechanism_files import dumps, loads
from compoundkin.model.elements import Drive
from compoundkin.model.pairs import KINDS
from compoundkin.model.pairs.contract import Drivable, Pair, Replaceable, TurnCounting
from compoundkin.view.sketch.picture_kinds import KINDS as PICTURES
from tests.model.pairs.minimal import Guided, Level, register, with_guided, with_level
from tests.support import EVERYTHING

MECHANISMS = {"held once": with_level, "held twice": with_guided}


@pytest.fixture(params=MECHANISMS)
def mechanism(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> ck.Mechanism:
    """A mechanism with a minimal kind, which is taken up among the others."""
    for kind in (Level, Guided):
        register(kind, monkeypatch)
    return MECHANISMS[request.param]()


def test_the_kinds_answer_what_is_abstract_and_no_more() -> None:
    for kind in (Level, Guided):
        own = {name for base in kind.__mro__ if issubclass(base, Level) for name in vars(base)}
        answered = {name for name in own & set(dir(Pair)) if not name.startswith("_")}
        facts = {"code", "title", "held", "free", "free_is_angle", "table", "name"}
        assert answered - facts == Pair.__abstractmethods__


def test_it_is_solved_and_verified(mechanism: ck.Mechanism) -> None:
    motion = ck.solve(mechanism)
    assert motion.assembled.all()
    assert ck.verify(motion).passed
    assert ck.gaps(motion) == ()
    assert np.isfinite(ck.quantity(motion, mechanism.outputs[0]).values).all()


def test_it_is_compiled(mechanism: ck.Mechanism) -> None:
    output = mechanism.outputs[0]
    found, solved = ck.compile(mechanism, output)(), ck.quantity(ck.solve(mechanism), output).values
    assert np.max(np.abs(found[output] - solved)) <= 1e-12 * np.max(np.abs(solved))


def test_its_configurations_and_circuits_are_found(mechanism: ck.Mechanism) -> None:
    # nothing says which way round a link is meant: both count
    assert len(ck.configurations(mechanism, {"crank": 0.3})) == 2
    assert len(ck.configurations(mechanism, {"crank": [0.3, 0.4]})) == 2
    assert len(ck.circuits(mechanism).circuits) == 2


def test_its_freedoms_centres_and_equations_are_found(mechanism: ck.Mechanism) -> None:
    assert ck.mobility_analysis(mechanism).finite == 1
    motion, equations = ck.solve(mechanism), ck.loop_equations(mechanism)
    centres = ck.instant_centres(motion)
    last = list(mechanism.links)[-1]
    # what does not turn has its centre at infinity
    assert centres[last, "frame"].at_infinity.all()
    assert equations.is_solvable
    for one in (*equations.loops, *equations.auxiliary, *equations.drivers):
        assert text(one)
        assert latex(one)


def test_others_are_made_of_it(mechanism: ck.Mechanism) -> None:
    assert len(list(ck.alternatives(mechanism))) > 1
    other = ck.with_frame(mechanism, list(mechanism.links)[2])
    assert ck.verify(ck.solve(other)).passed
    assert ck.verify(ck.solve(ck.with_driver(mechanism, list(mechanism.links)[1]))).passed
    assert equivalent_linkage(ck.solve(mechanism), at=1).links


def test_nothing_drives_it(mechanism: ck.Mechanism) -> None:
    link = mechanism.written_pairs[0].members[1]
    with pytest.raises(InvalidMechanism, match="drive"):
        ck.with_driver(mechanism, link)


@pytest.mark.parametrize("kind", PICTURES)
def test_it_is_drawn(mechanism: ck.Mechanism, kind: str) -> None:
    if kind == "construction":  # its group is no dyad
        with pytest.raises(InvalidInput, match="there is no dyad"):
            ck.draw(ck.solve(mechanism), kind=kind)
        return
    if kind == "singularities":  # it is regular everywhere
        with pytest.raises(InvalidInput, match="no pose along the motion is singular"):
            ck.draw(ck.solve(mechanism), kind=kind)
        return
    if kind in ("forces", "free-bodies", "force-polygon", "normal-force", "shear", "bending-moment"):
        units = {"length": "m", "mass": "kg", "force": "N"}
        mechanism = mechanism.replace(ck.mass(mechanism.drives[0].link, 2.0), units=units)
    assert ck.draw(ck.solve(mechanism), kind=kind).svg.startswith("<svg")


def test_it_is_animated_plotted_and_shown(mechanism: ck.Mechanism) -> None:
    motion = ck.solve(mechanism)
    assert ck.animate(motion).svg.startswith("<svg")
    assert ck.plot(motion, mechanism.outputs[0]).content("svg")
    assert mechanism.title in ck.page(motion).html


def test_it_is_written_and_read(mechanism: ck.Mechanism) -> None:
    assert loads(dumps(mechanism)) == mechanism


VERBS = ("report", "structure", "solve", "check", "centres", "configurations", "circuits", "draw", "plot", "animate")


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_takes_it(
    mechanism: ck.Mechanism, verb: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("m.toml").write_text(dumps(mechanism), encoding="utf-8")
    more = {"plot": [mechanism.outputs[0], "-o", "a.svg"], "draw": ["-o", "a.svg"], "animate": ["-o", "a.svg"]}
    found = CliRunner().invoke(cli, [verb, "m.toml", *more.get(verb, [])], catch_exceptions=False)
    assert found.exit_code == 0, found.output


# --- full kinds, each optional answer left out in turn -------------------------------------------------------

NAMED = {
    "R": "geneva-wheel",
    "P": "wedge-press",
    "S": "quick-return-pin-in-slot",
    "A": "",
    "C": "oscillating-roller-follower",
    "F": "oscillating-flat-follower",
    "G": "planetary-train",
    "B": "belt-coupled-cranks",
    "K": "rack-driven-double-slider",
    "L": "rolling-wheel",
    "O": "cardan-gear-straight-line",
}
BASES = (Drivable, TurnCounting, Replaceable, Pair)


def example(code: str) -> ck.Mechanism:
    """A small mechanism with a kind of pair."""
    frame, crank = ck.link("frame", A=(0, 0), D=(60, 0)), ck.link("crank", A=(0, 0), B=(20, 0))
    if code == "A":
        rod = ck.link("rod", B=(0, 0), C=(70, 0))
        pair = ck.arc("rod", on="frame", at="C", centre_at="D", radius=40)
        return ck.Mechanism("Pin in an arc", frame, crank, rod, pair, ck.drive("crank", values=ck.deg([10, 50, 90])))
    if code == "O":
        wheel = ck.link("wheel", B=(0, 0), T=(10, 0))
        pair = ck.roll_around("wheel", on="frame", at="B", centre_at="A", circle=10, radius=10)
        return ck.Mechanism("Wheel", frame, crank, wheel, pair, ck.drive("crank", values=ck.deg([10, 50, 90])))
    return load(NAMED[code])


def answers(kind: type[Pair]) -> list[str]:
    """The optional answers that a kind gives."""
    known = [(name, base) for base in BASES if issubclass(kind, base) for name in vars(base)]
    optional = [(name, base) for name, base in known if not name.startswith("_") and name not in FACTS]
    return [name for name, base in optional if getattr(kind, name) is not vars(base)[name]]


FACTS = {*Pair.__annotations__, *Pair.__abstractmethods__, *Drivable.__abstractmethods__, "keys"}


def without(pair: Pair, name: str) -> Pair:
    """A pair of the same kind but for one answer."""
    kind = type(pair)
    default = next(vars(base)[name] for base in BASES if issubclass(kind, base) and name in vars(base))
    lesser: Callable[..., Pair] = type(kind.__name__, (kind,), {name: default})
    return lesser(**{field.name: getattr(pair, field.name) for field in fields(kind)})


def coarse(item: Any) -> Any:
    """A driver of fewer poses, for each is verified: a turn in steps of sixty degrees, a range in sixths."""
    if not isinstance(item, Drive) or item.law is not None:
        return item
    values = np.linspace(0.0, 2.0 * np.pi, 7) if item.values is None else np.asarray(item.values)
    return replace(item, values=values[..., :: max(1, values.shape[-1] // 6)])


# Each answer is left out by every second or sixth of its kinds, begun with another kind for each answer.
STRIDE = 2 if EVERYTHING else 6
OF_KINDS = [(name, kind.code) for kind in KINDS.values() for name in answers(kind)]
BY_NAME = {name: [code for other, code in OF_KINDS if other == name] for name, _ in sorted(OF_KINDS)}
LEFT_OUT = [(code, name) for number, (name, codes) in enumerate(BY_NAME.items())
            for code in codes[number % min(STRIDE, len(codes)) :: STRIDE]]  # fmt: skip
REPORTED = dict(reversed(LEFT_OUT))


@pytest.mark.parametrize(("code", "name"), LEFT_OUT, ids=[f"{code} {name}" for code, name in LEFT_OUT])
def test_each_answer_may_be_left_out(code: str, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = example(code)
    others = [item for item in whole.items if not isinstance(item, Pair)]
    pairs = [without(pair, name) if pair.code == code else pair for pair in whole.written_pairs]
    if code == "R":
        kind = KINDS[code]
        default = next(vars(base)[name] for base in BASES if name in vars(base))
        monkeypatch.setattr(kind, name, default)
    time = None if whole.time is None else whole.time[::6]
    lesser = ck.Mechanism(whole.title, *map(coarse, others), *pairs, outputs=whole.outputs, time=time)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnassembledPoses)
        motion = ck.solve(lesser)
    assert motion.assembled.any()
    assert ck.loop_equations(lesser).unknowns
    assert ck.mobility_analysis(lesser).finite >= 1
    assert ck.instant_centres(motion) is not None
    assert ck.draw(motion).svg
    # what is verified is in the report, which takes five times as long: once for each kind of pair
    assert (ck.report(motion).outcome if REPORTED[code] == name else ck.verify(motion)).passed
