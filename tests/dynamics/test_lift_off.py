"""Contacts that let go: contact forces of a disc cam, where and at which speed it lifts off, preloads that keep it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import compoundkin as ck
from tests.dynamics import cases
from tests.support import reference

ENTRY = reference("disc_cam_contact_force", "forces")
OWN, EXPECTED = ENTRY["dimensions"], ENTRY["expected"]
# At this height of the roller's middle the spring has its preload.
LOWEST = EXPECTED["lowest_lift"]


def disc_cam() -> ck.Mechanism:
    """The disc cam of the reference. Its spring is fixed far above, and pushes."""
    far = 10.0
    return ck.Mechanism(
        "disc cam", ck.link("frame", A=0, S=(OWN["offset"], far + LOWEST)), ck.link("cam", A=0),
        ck.link("follower", P=0),
        ck.slide("follower", on="frame", at="P", through="A", angle=np.pi / 2, offset=-OWN["offset"], turn=-np.pi / 2,
                 name="guide"),
        ck.cam("follower", on="cam", at="P", profile=ck.profiles.disc(OWN["R"], (OWN["e"], 0)), radius=OWN["roller"],
               name="contact"),
        ck.drive("cam"), ck.mode(1, "follower"), ck.mass("follower", OWN["mass"], at="P", inertia=1e-5),
        ck.gravity(*OWN["gravity"]),
        ck.spring("follower", "P", at="S", stiffness=OWN["spring"], free_length=far, preload=-OWN["preload_at_lowest"],
                  name="spring"),
        units=cases.SI,
    )  # fmt: skip


def closed_form(angle: np.ndarray, speed: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the height of the roller's middle and its acceleration, of the equal slider-crank."""
    rod, e, offset = OWN["R"] + OWN["roller"], OWN["e"], OWN["offset"]
    x, dx, ddx = e * np.cos(angle) - offset, -e * np.sin(angle), -e * np.cos(angle)
    root = np.sqrt(rod**2 - x**2)
    second = -(dx**2 + x * ddx) / root - x**2 * dx**2 / root**3
    return e * np.sin(angle) + root, (-e * np.sin(angle) + second) * speed**2


def pressing(angle: np.ndarray, speed: float, preload: float) -> np.ndarray:
    """Return what the follower presses down with: weight, inertia and spring."""
    height, acceleration = closed_form(angle, speed)
    return OWN["mass"] * (9.81 + acceleration) + OWN["spring"] * (height - LOWEST) + preload


def turning(speed: float) -> ck.results.Motion:
    return ck.solve(disc_cam(), {"cam": ck.deg(np.arange(0.0, 361.0, 5.0))}, speed=speed)


def test_contact_forces_of_a_disc_cam() -> None:
    rows = EXPECTED["rows"]
    motion = ck.solve(disc_cam(), {"cam": ck.deg([row["cam_deg"] for row in rows])}, speed=OWN["speed"])
    forces = ck.force_analysis(motion)
    contact, guide = forces.pairs["contact"], forces.pairs["guide"]
    assert contact.at == "contact"
    for k, row in enumerate(rows):
        assert contact.normal[k] == pytest.approx(row["contact"]["normal_force"], rel=1e-11)
        assert contact.force[k] == pytest.approx(complex(*row["contact"]["force"]), rel=1e-11)
        assert contact.place[k] == pytest.approx(complex(*row["contact"]["at"]), rel=1e-11)
        assert guide.force[k].real == pytest.approx(row["guide"]["side_force_x"], abs=1e-9)
        assert forces.drives["cam"].effort[k] == pytest.approx(row["driver"], rel=1e-10)
    assert len(contact.lift_off.zeros.at.place) == 0


def test_speed_and_place_of_lift_off() -> None:
    """From a motion at another speed, with poses every five degrees."""
    found = ck.force_analysis(turning(20.0)).pairs["contact"].lift_off.speed
    assert found.value[0] == pytest.approx(EXPECTED["lift_off"]["speed"], rel=1e-10)
    assert np.rad2deg(found.at.drives["cam"][0]) == pytest.approx(EXPECTED["lift_off"]["at_cam_deg"], abs=1e-4)
    light = [item for item in disc_cam().items if type(item).__name__ != "Mass"]
    weightless = ck.Mechanism("weightless", *light, units=cases.SI)
    still = ck.force_analysis(ck.solve(weightless, {"cam": ck.deg([0, 90, 180])}, speed=20.0))
    assert still.pairs["contact"].lift_off.speed.value[0] == np.inf


def test_where_it_lifts_off_and_what_keeps_it() -> None:
    """Ten per cent beyond that speed: zeros and preloads are those of the closed form."""
    speed = 1.1 * EXPECTED["lift_off"]["speed"]
    forces = ck.force_analysis(turning(speed))
    lift = forces.pairs["contact"].lift_off
    leaves, returns = lift.leaves.drives["cam"], lift.returns.drives["cam"]
    assert (len(leaves), len(returns)) == (1, 1)
    assert leaves[0] < np.deg2rad(EXPECTED["lift_off"]["at_cam_deg"]) < returns[0]
    force = OWN["mass"] * speed**2 * OWN["e"]
    for place in (leaves[0], returns[0]):
        assert abs(pressing(place, speed, OWN["preload_at_lowest"])) < 1e-9 * force
    worst = minimize_scalar(lambda t: float(pressing(t, speed, 0.0)), bracket=(1.2, 1.5, 1.8), tol=1e-12)
    assert lift.preload("spring")[0] == pytest.approx(worst.fun, rel=1e-9)  # pushes: its pull is negative
    assert lift.preload()[0] == pytest.approx(-worst.fun - OWN["preload_at_lowest"], rel=1e-9)
    assert lift.least.value[0] < 0.0
    assert np.all(ck.force_analysis(turning(50.0)).pairs["contact"].lift_off.preload() == 0.0)


def test_what_is_not_told() -> None:
    forces = ck.force_analysis(turning(50.0))
    with pytest.raises(ck.errors.UnknownName, match="known: contact"):
        _ = forces.pairs["guide"].lift_off
    with pytest.raises(ck.errors.UnknownName, match="no such spring"):
        forces.pairs["contact"].lift_off.preload("sprung")
    damped = forces.mechanism.replace(ck.damper("follower", "P", at="S", rate=1.0))
    motion = ck.solve(damped, {"cam": ck.deg([0, 120, 240, 360])}, speed=5.0)
    with pytest.raises(ck.errors.InvalidInput, match="depends on rates"):
        _ = ck.force_analysis(motion).pairs["contact"].lift_off.speed
