"""Machines against numbers that books and papers print."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck


def flywheel(inertia: float, *loads: object) -> ck.Mechanism:
    return ck.Mechanism(
        "Flywheel",
        ck.link("frame", O=(0, 0)),
        ck.link("rotor", O=(0, 0), B=(1, 0)),
        ck.drive("rotor"),
        ck.mass("rotor", 1.0, at="O", inertia=inertia),
        *loads,
        units={"length": "m", "mass": "kg", "force": "N"},
    )


@pytest.mark.full
def test_a_punch_press_with_its_flywheel_on_the_shaft_of_an_induction_motor() -> None:
    """R. Budynas, J. Nisbett, Shigley's Mechanical Engineering Design, chapter 16, flywheel on the motor's shaft.

    The motor's line is T = 2690.4 - 21.41 w lbf in, a punch of 1560 lbf in lasts half a second of ten; of the cycle
    that repeats itself the book prints 124.41 and 117.81 rad/s, the energy 88,508 lbf in, the part 0.0545 of the mean
    speed. Inertia 110.72 lbf in s^2; any consistent set of units will do.
    """
    press = flywheel(
        110.72,
        ck.motor("rotor", stall=2690.4, no_load=2690.4 / 21.41),
        ck.effort("rotor", lambda t: np.where(np.mod(t, 10.0) < 0.5, -1560.0, 0.0)),
    )
    run = ck.simulate(press, start={"rotor": (0.0, 124.41)}, until=20.5, times=np.array([0.0, 0.5, 10.0, 10.5, 20.0]))
    speed = run.motion.drives["rotor"].rate
    assert np.all(np.abs(speed[[0, 2, 4]] - 124.41) < 0.01)
    assert np.all(np.abs(speed[[1, 3]] - 117.81) < 0.01)
    low, high = float(speed[3]), float(speed[2])
    assert abs((high - low) / (0.5 * (high + low)) - 0.0545) < 1e-4
    assert abs(0.5 * 110.72 * (high**2 - low**2) - 88508.0) < 100.0


def test_the_run_up_of_that_press_is_an_exponential() -> None:
    press = flywheel(110.72, ck.motor("rotor", stall=2690.4, no_load=2690.4 / 21.41))
    run = ck.simulate(press, start={"rotor": (0.0, 0.0)}, until=15.0)
    exact = 2690.4 / 21.41 * -np.expm1(-run.times * 21.41 / 110.72)
    assert np.max(np.abs(run.motion.drives["rotor"].rate - exact)) < 1e-8 * exact[-1]


def test_a_riveting_machine_with_a_motor_of_constant_power() -> None:
    """R. S. Khurmi, J. K. Gupta, Theory of Machines, chapter 16: 3 kW, 150 kg at 0.6 m, 10,000 N m a rivet in a second.

    From 300 rpm the flywheel comes to 257.6 rpm.
    """
    machine = flywheel(
        150 * 0.6**2,
        ck.motor("rotor", torque=1e4, power=3000.0),
        ck.effort("rotor", lambda w: -10000.0 / w),
    )
    run = ck.simulate(machine, start={"rotor": (0.0, 300 * np.pi / 30)}, until=1.0)
    assert abs(run.motion.drives["rotor"].rate[-1] * 30 / np.pi - 257.6) < 0.05


def test_a_load_that_jumps_at_the_end_of_a_simulation() -> None:
    """It was a division by zero: behind the jump no time is left."""
    pushed = flywheel(2.0, ck.effort("rotor", lambda t: np.where(t < 0.5, 3.0, -1.0)))
    run = ck.simulate(pushed, start={"rotor": (0.0, 1.0)}, until=0.5)
    assert run.times[-1] == 0.5
    assert abs(run.motion.drives["rotor"].rate[-1] - 1.75) < 1e-12


@pytest.mark.full
def test_a_laboratory_trebuchet_of_three_phases() -> None:
    """E. Horsdal, F. Johansen, J. Rasmussen, The swinging counterweight trebuchet, arXiv:2502.19442, tables 1 to 3.

    The stone slides in its trough until nothing presses there, swings, and flies. Printed, as it is quoted elsewhere: a
    longest range of 42.8 m without friction and drag; it is that from the axle.
    """
    height, long, short, hanger, sling, tilt, trough = 0.831, 0.975, 0.25, 0.515, 0.87, 0.55, 100.0
    axle, down = 1j * height, np.exp(-1j * (np.pi / 2 + tilt))
    tip, end = axle + long * down, axle - short * down
    machine = ck.Mechanism(
        "Laboratory trebuchet",
        *(ck.link("frame", O=axle, F=0), ck.link("beam", O=0, T=long, B=-short), ck.link("weight", B=0, W=hanger)),
        ck.link("sling", T=0, S=sling),
        # the floor is a disc so large that it is flat to a millimetre
        ck.cam("sling", on="frame", at="S", profile=ck.profiles.disc(trough, (0, -trough)), name="trough"),
        *(ck.drive("beam"), ck.drive("weight", on="beam")),
        ck.drawn(O=axle, T=tip, S=tip.real + np.sqrt(sling**2 - tip.imag**2), B=end, W=end - 1j * hanger),
        ck.mass("beam", 4.86, at=(0.465, 0), inertia=1.85 - 4.86 * 0.465**2),
        *(ck.mass("weight", 53.9, at="W", inertia=0), ck.mass("sling", 0.717, at="S", inertia=0)),
        *(ck.gravity(0, -9.81), ck.release("trough"), ck.release("T", until=0.5764)),
        units={"length": "m", "mass": "kg", "force": "N"},
    )
    start = {"beam": float(np.angle(down)), "weight": float(-np.pi / 2 - np.angle(down))}
    shot = ck.simulate(machine, start=start, until=3.3, events={"ground": _above_ground}, stop="ground")
    assert [event.name for event in shot.events] == ["opens", "opens", "ground"]
    swung, flown = (shot.phases[k].motion.points["S"] for k in (1, 2))
    late = shot.phases[1].motion.time > 0.5
    place, velocity = swung.position[late], swung.velocity[late]
    fall = (velocity.imag + np.sqrt(velocity.imag**2 + 2 * 9.81 * place.imag)) / 9.81
    reach = place.real + velocity.real * fall
    # released at the best time: before it every shot is shorter
    assert reach[-1] == pytest.approx(np.nanmax(reach), rel=1e-4)
    assert flown.position[-1] == pytest.approx(42.8, abs=0.05)
    assert reach[-1] == pytest.approx(flown.position[-1].real, abs=1e-6)
    assert shot.energy.worst < 1e-9


def _above_ground(state: Any) -> float:
    """Return the height of a stone in flight."""
    return float(state["S.y"]) if state.time > 1.0 else 1.0
