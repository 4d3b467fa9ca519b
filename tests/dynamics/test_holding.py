"""A pair that holds in the place of the driver that moves."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from tests.dynamics import cases


@pytest.mark.parametrize("name", ["O", "cylinder"])
def test_an_engine_held_by_its_pairs(name: str) -> None:
    """At the crank's own pin the torque is the driver's; along the cylinder it does the same work on another way."""
    case = cases.engine()
    motion = ck.solve(case.mechanism, case.values, **case.rates)
    driven, held = ck.force_analysis(motion), ck.force_analysis(motion, holding=name)
    assert held.held is not None
    rest = held.held.cannot_hold
    assert rest.any() == (name == "cylinder")
    assert np.all(np.isinf(held.held.effort[rest]))
    torque, rate = driven.drives["crank"].effort, motion.pairs[name].rate
    given = torque * motion.drives["crank"].rate
    assert np.allclose(held.held.effort[~rest] * rate[~rest], given[~rest], rtol=1e-10)
    assert np.allclose(held.held.power[~rest], driven.drives["crank"].power[~rest], rtol=1e-10)
    assert np.allclose(held.drives["crank"].effort[~rest], 0.0, atol=1e-11 * np.abs(torque).max())
    for link in ("crank", "rod", "piston"):
        assert np.max(np.abs(held.on(link).force[~rest])) < 1e-9
        assert np.max(np.abs(held.on(link).moment_about((0, 0))[~rest])) < 1e-9
    assert [one.name for one in held.on("crank" if name == "O" else "piston").of_kind("driver")][-1] == name


def test_a_press_is_held_at_its_ram() -> None:
    """The ram carries its load alone: no other pair has a force. Statics of a toggle press without weights."""
    case = cases.toggle_press()
    forces = ck.force_analysis(ck.solve(case.mechanism, case.values), inertia=False, holding="press")
    assert forces.held is not None
    assert np.allclose(forces.held.effort, 1e4, rtol=1e-9)
    assert max(np.max(np.abs(forces.pairs[name].force)) for name in forces.pairs) < 1e-7
    assert ck.verify(forces).passed


def test_what_cannot_hold() -> None:
    case = cases.engine()
    motion = ck.solve(case.mechanism, case.values, **case.rates)
    with pytest.raises(ck.errors.UnknownName, match="did you mean 'cylinder'"):
        ck.force_analysis(motion, holding="cylindre")
    rubbed = case.mechanism.replace(ck.friction("cylinder", 0.1))
    with pytest.raises(ck.errors.InvalidInput, match="without friction only"):
        ck.force_analysis(ck.solve(rubbed, case.values, **case.rates), holding="cylinder")
