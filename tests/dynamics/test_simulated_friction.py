"""Simulations with Coulomb friction: blocks on inclines in closed form, sticking, release, a slider-crank."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.errors import InvalidInput
from tests.dynamics.cases import SI
from tests.dynamics.moving_cases import five_bar, slider_crank

SLOPE, FALL, WEIGHT = np.pi / 6, 9.81, 2.0


def incline(friction: float, *more: object) -> ck.Mechanism:
    """A block on a slope of 30 degrees."""
    return ck.Mechanism(
        "Block on an incline",
        ck.link("frame", O=(0, 0)),
        ck.link("block", P=(0, 0)),
        ck.slide("block", on="frame", at="P", through="O", angle=SLOPE, name="way"),
        ck.drive("block"),
        ck.mass("block", WEIGHT, at="P", inertia=0.0),
        ck.gravity(0, -FALL),
        ck.friction("way", friction),
        *more,
        units=SI,
    )


def test_block_slides_up_and_down_again() -> None:
    """It is braked on its way up by more than it is driven down, and turns at once where friction cannot hold it."""
    up, down = (FALL * (np.sin(SLOPE) + way * 0.2 * np.cos(SLOPE)) for way in (1, -1))
    found = ck.simulate(incline(0.2), start={"block": (0.0, 2.0)}, until=2.0)
    block, turn = found.motion.drives["block"], 2.0 / up
    assert block.value[-1] == pytest.approx(2.0 / up - down * (2.0 - turn) ** 2 / 2.0, rel=1e-10)
    assert block.second[0] == pytest.approx(-up, rel=1e-12)
    assert block.second[-1] == pytest.approx(-down, rel=1e-12)
    assert found.energy.worst < 1e-10


def test_friction_holds_and_lets_go() -> None:
    """Where it comes to rest it stays, until a load that grows overcomes friction."""
    held = ck.simulate(incline(0.7), start={"block": (0.0, 2.0)}, until=2.0)
    stop = 2.0 / (FALL * (np.sin(SLOPE) + 0.7 * np.cos(SLOPE)))
    assert [(event.name, event.time) for event in held.events] == [("sticks", pytest.approx(stop, rel=1e-9))]
    assert held.motion.drives["block"].value[-1] == pytest.approx(stop, rel=1e-9)
    pushed = incline(0.7, ck.force("block", (lambda t: 60.0 * t, 0), at="P"))
    found = ck.simulate(pushed, start={"block": 0.0}, until=1.0)
    least = WEIGHT * FALL * (np.sin(SLOPE) + 0.7 * np.cos(SLOPE)) / (np.cos(SLOPE) - 0.7 * np.sin(SLOPE)) / 60.0
    assert [event.name for event in found.events] == ["sticks", "slips"]
    assert found.events[1].time == pytest.approx(least, rel=1e-9)
    # what the force has more than at release accelerates it
    pace = 60.0 * (np.cos(SLOPE) - 0.7 * np.sin(SLOPE)) / WEIGHT
    assert found.motion.drives["block"].rate[-1] == pytest.approx(pace * (1.0 - least) ** 2 / 2.0, rel=1e-8)


def test_slider_crank_loses_energy_and_has_no_effort() -> None:
    """The forces of the motion, friction among them, leave nothing for the driver; the loss is friction's work."""
    rubbed = slider_crank().replace(ck.friction("guide", 0.1), ck.friction("A", 0.2, radius=0.01))
    found = ck.simulate(rubbed, start={"crank": ck.deg(60)}, until=0.3, tolerance=1e-8)
    moving = np.abs(found.motion.drives["crank"].rate) > 1e-6
    largest = np.max(np.abs(found.forces.pairs["A"].force)) * 0.1
    assert np.max(np.abs(found.forces.drives["crank"].effort[moving])) < 1e-9 * largest
    assert np.all(np.diff(found.energy.work) <= 1e-12)
    assert found.energy.work[-1] < -0.1
    assert found.energy.worst < 1e-6


def test_friction_of_several_drivers_is_refused() -> None:
    """It is said which."""
    with pytest.raises(InvalidInput, match="is simulated in mechanisms with one driver"):
        ck.simulate(
            five_bar().replace(ck.friction("P", 0.1, radius=0.01)), start={"left": 1.7, "right": 1.0}, until=1.0
        )
