"""Every mistake has its place, what is wrong, and how to mend it; and all are found at once."""

# ruff: noqa: E501, RUF100  (one line for each mistake)

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin import laws, profiles
from compoundkin.model.profiles import synthesised
from tests import catalog
from tests.scaled import scaled

BASE: dict[str, Any] = {
    "frame": ck.link("frame", A=(0, 0), D=(4, 0), Q=(0, 3)),
    "crank": ck.link("crank", A=(0, 0), B=(1, 0)),
    "coupler": ck.link("coupler", B=(0, 0), C=(3, 0), E=(1, 1)),
    "rocker": ck.link("rocker", D=(0, 0), C=(3, 0)),
    "block": ck.link("block", E=(0, 0)),
    "rod": ck.link("rod", R=(0, 0), S=(1, 0)),
    "slide": ck.slide("rod", on="frame", at="R", through="Q"),
    "drive": ck.drive("crank"),
}


def problems(*extra: Any, **changed: Any) -> list[tuple[str, str, str]]:
    """The problems of the base mechanism with some items changed (None leaves one out) and some added."""
    items = [item for item in {**BASE, **changed}.values() if item is not None]
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        ck.Mechanism("m", *items, *extra)
    return [(p.where, p.what, p.remedy) for p in caught.value.problems]


def test_the_base_is_sound() -> None:
    ck.Mechanism("m", *BASE.values())


MISTAKES: list[tuple[str, Callable[[], list[tuple[str, str, str]]], str, str, str]] = [
    ("no frame", lambda: problems(frame=ck.link("Frame", A=0, D=4, Q=3j)), "links", "no link is called 'frame'", "'Frame'"),
    ("link twice", lambda: problems(ck.link("crank", A=0, B=1)), "links.crank", "'crank' is used twice", "unique"),
    ("slide twice", lambda: problems(BASE["slide"]), "slides[1].name", "'rod/frame' is used twice", "unique"),
    ("drive twice", lambda: problems(ck.drive("rocker", name="crank")), "drives[1].name", "'crank' is used twice", "unique"),
    ("link name", lambda: problems(rod=ck.link("a.b", R=0)), "links.a.b", "'a.b' is not a name", "without dots"),
    ("blank name", lambda: problems(ck.link(" x", A=0)), "links. x", "' x' is not a name", "blanks"),
    ("empty name", lambda: problems(ck.link("", A=0)), "links.", "'' is not a name", "printable"),
    ("letter", lambda: problems(ck.link("x", **{"A": 0, "P,Q": 0})), "points.P,Q", "'P,Q' is not a name", "commas"),
    ("drive name", lambda: problems(drive=ck.drive("crank", name="a.b")), "drives[0].name", "'a.b' is not a name", "dots"),
    ("slide name", lambda: problems(slide=ck.slide("rod", on="frame", at="R", through="Q", name="a\n")), "slides[0].name", "is not a name", "printable"),
    ("link as point", lambda: problems(ck.link("x", A=0, crank=1)), "links.crank", "a link and a point have the same name", "rename"),
    ("no points", lambda: problems(ck.link("x")), "links.x.points", "at least one point", ""),
    ("not finite", lambda: problems(crank=ck.link("crank", A=0, B=np.nan)), "links.crank.points.B", "not finite", ""),
    ("empty array", lambda: problems(crank=ck.link("crank", A=0, B=np.zeros(0))), "links.crank.points.B", "empty", ""),
    ("misdrawn", lambda: problems(ck.link("x", "A", "Zed"), ck.drawn(A=0, Zet=1)), "links.x.points.Zed", "neither given nor drawn", "did you mean 'Zet'"),
    ("drawn for none", lambda: problems(ck.drawn(Z=1)), "drawn.Z", "no link carries this point", "known: A, D"),
    ("drawn not finite", lambda: problems(ck.drawn(B=np.inf)), "drawn.B", "not finite", ""),
    ("no length", lambda: problems(crank=ck.link("crank", A=1, B=1)), "links.crank.points.B", "A and B coincide", "move one"),
    ("no length drawn", lambda: problems(crank=ck.link("crank", "A", "B"), x=ck.drawn(A=1, B=1)), "links.crank.points.B", "A and B coincide", "one letter"),
    ("no length once", lambda: problems(crank=ck.link("crank", A=1, B=np.array([1, 2]))), "links.crank.points.B", "A and B coincide", ""),
    ("pinned slide", lambda: problems(ck.slide("coupler", on="rocker", at="C", through="D")), "slides[1]", "'coupler' and 'rocker' are also pinned at C", "different letters"),
    ("joined to nothing", lambda: problems(ck.link("x", Y=0)), "links.x", "joined to nothing", "share a letter"),
    ("nearly joined", lambda: problems(ck.link("x", b=0, Pin=0), ck.link("y", A=0, Pim=0)), "links.x", "joined to nothing", "did you mean"),
    ("driven link", lambda: problems(drive=ck.drive("crnk")), "drives[0].link", "no link 'crnk'", "'crank'"),
    ("driven on", lambda: problems(drive=ck.drive("crank", on="frme")), "drives[0].on", "no link 'frme'", "'frame'"),
    ("driven unpaired", lambda: problems(drive=ck.drive("rocker", on="crank")), "drives[0]", "no pair between 'rocker' and 'crank'", "paired with"),
    ("driven pair", lambda: problems(drive=ck.drive("crank", pair="B")), "drives[0]", "no pair called 'B'", "paired with"),
    ("driven itself", lambda: problems(drive=ck.drive("crank", on="crank")), "drives[0]", "no pair", ""),
    ("driven twice", lambda: problems(ck.drive("frame", on="crank", name="again")), "drives[1]", "'A' is driven already by 'crank'", "leave one"),
    ("several pairs", lambda: problems(ck.link("y", A=0, B=1), drive=ck.drive("y", on="crank")), "drives[0].pair", "share several pairs", "A, B"),
    ("values", lambda: problems(drive=ck.drive("crank", values=[0, np.nan])), "drives[0].values", "not finite", ""),
    ("no values", lambda: problems(drive=ck.drive("crank", values=[])), "drives[0].values", "empty", ""),
    ("speed", lambda: problems(drive=ck.drive("crank", speed=np.inf)), "drives[0].speed", "not finite", ""),
    ("mode", lambda: problems(ck.mode(1, "copler")), "modes[0].links", "no link 'copler'", "'coupler'"),
    ("expected driver", lambda: problems(ck.expect("rocker.angle", 1, 1, crnk=0)), "expected[0].at.crnk", "no driver 'crnk'", "'crank'"),
    ("expected rate", lambda: problems(ck.expect("rocker.angle", 1, 1, **{"crank.sped": 0})), "expected[0].at.crank.sped", "no 'sped'", "speed"),
    ("expected at", lambda: problems(ck.expect("rocker.angle", 1, 1, crank=np.nan)), "expected[0].at.crank", "not finite", ""),
    ("expected value", lambda: problems(ck.expect("rocker.angle", np.nan, 1)), "expected[0].value", "not finite", ""),
    ("tolerance", lambda: problems(ck.expect("rocker.angle", 1, -1)), "expected[0].tolerance", "not a tolerance", "not negative"),
    ("shapes", lambda: problems(crank=ck.link("crank", A=0, B=([1, 2], 0)), drive=ck.drive("crank", values=[1, 2, 3])), "drives[0].values", "(3,) does not broadcast with (2,)", "last axis"),
    ("dates", lambda: problems(slide=ck.slide("rod", on="frame", at="R", through="Q", offset=np.datetime64("2020-01-01"))), "slides[0].offset", "not a number", ""),
    ("slide shape", lambda: problems(crank=ck.link("crank", A=0, B=([1, 2], 0)), slide=ck.slide("rod", on="frame", at="R", through="Q", offset=np.ones(3))), "slides[0].offset", "does not broadcast", "last axis"),
]  # fmt: skip


@pytest.mark.parametrize(("make", "place", "what", "remedy"), [m[1:] for m in MISTAKES], ids=[m[0] for m in MISTAKES])
def test_each_mistake(make: Callable[[], list[tuple[str, str, str]]], place: str, what: str, remedy: str) -> None:
    found = make()
    assert any(p == place and what in w and remedy in r for p, w, r in found), found


def test_all_mistakes_at_once() -> None:
    found = problems(
        ck.link("x", Y=0),
        ck.link("crank", A=0, B=1),
        ck.mode(1, "nobody"),
        ck.drawn(Z=1),
        ck.expect("rocker.angle", 1, -1),
        drive=ck.drive("nobody"),
        slide=ck.slide("rod", on="nobody", at="R", through="Q"),
    )
    places = [p for p, _, _ in found]
    expected = {
        "links.x",
        "links.crank",
        "modes[0].links",
        "drawn.Z",
        "expected[0].tolerance",
        "drives[0].link",
        "slides[0].on",
    }
    assert expected <= set(places)
    assert str(ck.errors.InvalidMechanism([], heading="x")) == "x:"


def test_the_message_lists_every_problem_with_its_place() -> None:
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        ck.Mechanism("Bad", ck.link("a", A=0), ck.drive("b"))
    text = str(caught.value)
    assert text.startswith("'Bad' cannot be built:\n")
    assert all(str(p) in text for p in caught.value.problems)
    assert len(caught.value.problems) >= 2


def test_what_is_not_a_word_is_refused() -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match=r"items\[2\].*not a"):
        ck.Mechanism("m", ck.link("frame", A=0), ck.link("b", A=0), "crank")  # type: ignore[arg-type]
    with pytest.raises(ck.errors.InvalidInput, match="tolerance: 'small' is no number"):
        ck.expect("b.angle", 1, "small")  # type: ignore[arg-type]


def test_one_link_alone_is_a_mechanism() -> None:
    assert ck.Mechanism("m", ck.link("frame", A=0)).links.keys() == {"frame"}


def test_letters_of_any_script_are_names() -> None:
    mechanism = ck.Mechanism("m", ck.link("frame", Ω=0), ck.link("кривошип 1", Ω=0, B_2=1), ck.drive("кривошип 1"))
    assert abs(complex(ck.solve(mechanism, {"кривошип 1": 0.0}).points["B_2"].position) - 1) < 1e-15


QUARTER = np.pi / 2.0


LIFT = laws.program(
    laws.dwell(QUARTER),
    laws.rise(10, over=QUARTER, law="cycloidal"),
    laws.dwell(QUARTER),
    laws.fall(10, over=QUARTER, law="cycloidal"),
)


@pytest.mark.parametrize("factor", [1e-320, 1e-200, 1e-60, 1e60, 1e160, 1e200])
@pytest.mark.parametrize("name", ["six-bar", "crank-shaper", "slider-crank", "class-iii-six-bar", "planetary-train"])
def test_lengths_that_cannot_be_computed_with_are_refused(name: str, factor: float) -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match="choose another unit"):
        scaled(catalog.mechanism(name), factor)


@pytest.mark.parametrize("base", [1e60, 1e200])
def test_profiles_that_cannot_be_computed_with_are_refused(base: float) -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match="choose another unit"):
        profiles.synthesise(LIFT, base=base, follower="roller", roller=8)
    with pytest.raises(ck.errors.InvalidMechanism, match="beyond 1e50"):
        _ = profiles.disc(base).curve


@pytest.mark.parametrize("follower", ["roller", "flat"])
@pytest.mark.parametrize("base", [1e-300, 1e-9, 1e-3, 1.0])
def test_a_base_circle_that_will_do_is_found_from_an_absurd_one_in_few_trials(
    base: float, follower: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    trials = []
    asked = synthesised._is_sufficient
    monkeypatch.setattr(synthesised, "_is_sufficient", lambda made: trials.append(made.base) or asked(made))
    roller = 12.0 if follower == "roller" else 0.0
    with pytest.raises(ck.errors.InvalidMechanism, match="take a base circle of") as told:
        _ = profiles.synthesise(LIFT, base=base, follower=follower, roller=roller).curve
    # 1.1 ** 73 is a thousand; halving takes some 24 more
    assert len(trials) < 250
    least = float(str(told.value).split("take a base circle of ")[1].split()[0])
    assert profiles.synthesise(LIFT, base=least * 1.001, follower=follower, roller=roller).curve.closed
    with pytest.raises(ck.errors.InvalidMechanism):
        _ = profiles.synthesise(LIFT, base=least * 0.99, follower=follower, roller=roller).curve
