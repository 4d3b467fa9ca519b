"""Springs that balance, against closed forms of arms, re-analysed mechanisms and the conditions of a minimum."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.errors import InvalidInput, UnknownName

SI = {"length": "m", "mass": "kg", "force": "N"}
TRAVEL = {"arm": np.deg2rad(np.linspace(-60.0, 80.0, 29))}
# m g l of the arm below
WEIGHT = 3.0 * 9.81 * 1.2
ZERO_LENGTH = ck.spring("arm", "A", at="S", stiffness=1.0, name="balancer")


def arm(*more: Any) -> ck.Mechanism:
    return ck.Mechanism(
        "Arm",
        ck.link("frame", O=0, S=0.5j, T=(0.3, 0.4)),
        ck.link("arm", O=0, A=0.4),
        ck.drive("arm"),
        ck.mass("arm", 3.0, at=1.2, inertia=0.0),
        ck.gravity(0, -9.81),
        *more,
        units=SI,
    )


def statics(mechanism: ck.Mechanism, values: Any = TRAVEL) -> ck.results.Forces:
    return ck.force_analysis(ck.solve(mechanism, values), inertia=False)


def held(mechanism: ck.Mechanism, values: Any = TRAVEL) -> Any:
    return np.asarray(statics(mechanism, values).drives["arm"].effort)


def test_one_spring_without_free_length_balances_a_hanging_arm() -> None:
    """k a b = m g l, and no second spring is taken."""
    aside = ck.spring("arm", "A", at="T", stiffness=1.0, free_length=0.1, name="aside")
    torsion = ck.spring(pair="O", stiffness=7.0, free=1.0, name="torsion")
    found = ck.figures.balancing_springs(statics(arm(torsion, aside, ZERO_LENGTH)))
    assert list(found.stiffnesses) == ["balancer"]
    assert found.stiffnesses["balancer"] == pytest.approx(WEIGHT / (0.4 * 0.5), rel=1e-12)
    assert found.is_reached
    assert np.max(np.abs(held(found.mechanism))) < 1e-11
    (before,), (after,) = found.before, found.after
    assert before.greatest == pytest.approx(WEIGHT, rel=1e-12)
    assert after.greatest < 1e-11
    assert "stiffness of balancer" in found.text()


def test_two_springs_where_one_cannot() -> None:
    """Springs to both sides: k1 T1 + k2 T2 must be straight above the pin."""
    mirrored = [ck.spring("arm", "A", at=at, stiffness=1.0, name=name) for at, name in
                (((0.3, 0.4), "right"), ((-0.3, 0.4), "left"))]  # fmt: skip
    found = ck.figures.balancing_springs(statics(arm(*mirrored)))
    # k (T + T') a = m g l upwards, T + T' = 0.8 i
    assert found.is_reached
    assert found.stiffnesses == pytest.approx(dict.fromkeys(("right", "left"), WEIGHT / (0.4 * 0.8)), rel=1e-12)


def test_fewer_springs_where_less_is_asked() -> None:
    springs = [ck.spring("arm", "A", at=(0.05, 0.5), stiffness=1.0, name="near"),
               ck.spring("arm", "A", at=(-0.4, 0.3), stiffness=1.0, name="far")]  # fmt: skip
    forces = statics(arm(*springs))
    assert len(ck.figures.balancing_springs(forces).stiffnesses) == 2
    rough = ck.figures.balancing_springs(forces, within=0.15)
    assert list(rough.stiffnesses) == ["near"]
    assert 1e-9 < rough.rest <= 0.15
    assert rough.rest == pytest.approx(rough.after[0].rms / rough.before[0].rms, rel=1e-10)


def test_what_is_left_is_least() -> None:
    """A spring with free length, and a torsion spring: other stiffnesses of the mechanism leave more effort."""
    springs = (ck.spring("arm", "A", at="S", stiffness=1.0, free_length=0.25, name="above"),
               ck.spring(pair="O", stiffness=1.0, free=1.5, name="torsion"))  # fmt: skip
    found = ck.figures.balancing_springs(statics(arm(*springs)))
    assert not found.is_reached
    assert len(found.stiffnesses) == 2
    fine = {"arm": np.deg2rad(np.linspace(-60.0, 80.0, 2001))}

    def square(stiffnesses: dict[str, float]) -> float:
        again = [ck.spring("arm", "A", at="S", stiffness=stiffnesses["above"], free_length=0.25, name="above"),
                 ck.spring(pair="O", stiffness=stiffnesses["torsion"], free=1.5, name="torsion")]  # fmt: skip
        return float(np.trapezoid(held(arm(*again), fine) ** 2, fine["arm"]))

    least = square(dict(found.stiffnesses))
    for name, value in found.stiffnesses.items():
        more, less = (square({**found.stiffnesses, name: value * part}) for part in (1.001, 0.999))
        assert min(more, less) > least
        assert more - least == pytest.approx(less - least, rel=1e-2)


def test_bounds_hold() -> None:
    found = ck.figures.balancing_springs(statics(arm(ZERO_LENGTH)), most={"balancer": 100.0})
    assert found.stiffnesses["balancer"] == pytest.approx(100.0, rel=1e-12)
    # efforts are (m g l - k a b) cos q
    assert found.rest == pytest.approx(1.0 - 100.0 * 0.2 / WEIGHT, rel=1e-10)


def test_a_spring_makes_the_torque_of_a_turning_crank_even() -> None:
    """A crank that is driven by a constant torque besides: m g l cos q goes, the constant torque stays."""
    turning = arm(ZERO_LENGTH, ck.torque("arm", -5.0))
    forces = ck.force_analysis(ck.solve(turning, {"arm": np.linspace(0.0, 2 * np.pi, 25)}, speed=10.0))
    found = ck.figures.balancing_springs(forces, even=True)
    assert found.stiffnesses["balancer"] == pytest.approx(WEIGHT / 0.2, rel=1e-10)
    again = ck.force_analysis(ck.solve(found.mechanism, {"arm": np.linspace(0.0, 2 * np.pi, 25)}, speed=10.0))
    np.testing.assert_allclose(again.drives["arm"].effort, 5.0, atol=1e-10)
    assert found.before[0].greatest == pytest.approx(WEIGHT, rel=1e-9)
    assert found.after[0].greatest < 1e-9


def test_optimise_agrees_on_a_slider_crank() -> None:
    """The goal "even" of `optimise` over equally many poses finds the stiffness that is found here between them."""
    engine = ck.Mechanism(
        "Pump",
        ck.link("frame", O=0, S=(0.4, 0)),
        ck.link("crank", O=0, A=0.05),
        ck.link("rod", A=0, B=0.2),
        ck.link("piston", B=0),
        ck.slide("piston", on="frame", through="O", name="cylinder"),
        ck.drive("crank"),
        ck.mass("piston", 2.0, at="B"),
        ck.spring("piston", "B", at="S", stiffness=1.0, free_length=0.15, name="return"),
        units=SI,
    )
    turn = {"crank": np.linspace(0.0, 2 * np.pi, 181)}
    forces = ck.force_analysis(ck.solve(engine, turn, speed=20.0))
    found = ck.figures.balancing_springs(forces, even=True)
    assert found.after[0].rms < 0.95 * found.before[0].rms
    goal = ck.goals.even("crank.effort")
    other = ck.optimise(engine, {"return.stiffness": (10.0, 5000.0)}, goal, values=turn, speed=20.0, starts=2)
    assert other.dimensions["return.stiffness"] == pytest.approx(found.stiffnesses["return"], rel=1e-5)


@pytest.mark.parametrize(
    ("more", "words", "error", "message"),
    [
        ([], {}, InvalidInput, "no spring"),
        ([ZERO_LENGTH], {"springs": "balancr"}, UnknownName, "balancer"),
        ([ZERO_LENGTH], {"most": -1.0}, InvalidInput, "most.balancer"),
        ([ZERO_LENGTH], {"most": {"other": 1.0}}, UnknownName, "other"),
        ([ZERO_LENGTH], {"within": 2.0}, InvalidInput, "within"),
        ([ZERO_LENGTH, ck.friction("O", 0.1, radius=0.01)], {}, InvalidInput, "friction"),
        ([ck.spring("arm", "A", at="S", stiffness=1.0, only="tension", name="s")], {}, InvalidInput, "tension only"),
        ([ck.spring("arm", "A", at="S", stiffness=1.0, preload=2.0, name="s")], {}, InvalidInput, "preload"),
        ([ck.spring("arm", "A", at="S", stiffness=lambda q: q, name="s")], {}, InvalidInput, "function"),
    ],
)
def test_bad_input_is_named(more: list[Any], words: dict[str, Any], error: type[Exception], message: str) -> None:
    forces = ck.force_analysis(ck.solve(arm(*more), TRAVEL, speed=1.0), inertia=False)
    with pytest.raises(error, match=message):
        ck.figures.balancing_springs(forces, **words)
