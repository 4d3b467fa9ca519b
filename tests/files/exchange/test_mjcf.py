"""Models for MuJoCo, which closes their loops, moves their points and drives them as we do."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import InvalidInput
from compoundkin.files.exchange.mjcf.mjcf_format import FORMAT
from compoundkin.files.exchange.shown_mechanism import ShownMechanism, shown_mechanism
from compoundkin.results import Motion
from tests.dynamics.cases import SI
from tests.dynamics.test_mujoco import heavy, some_poses
from tests.files.exchange.mujoco_models import MujocoModel
from tests.files.exchange.references import entry
from tests.files.exchange.shown_catalog import shown

# What no model can say: cams whose profile is no circle, faces on such, points that are led.
REFUSED = {
    *("conjugate-cams", "constant-breadth-yoke", "disc-cam-roller-program", "five-bar-led", "flat-faced-follower"),
    *("groove-cam-plate", "oscillating-flat-follower", "oscillating-roller-follower"),
}
# Loops at pins; gears, one of them on a carrier that turns; a slot; a rack; halves of links; a tied slide; cylinders.
LOADED = (
    *("class-iii-six-bar", "belt-coupled-cranks", "sun-and-planet", "geneva-wheel", "rack-and-pinion-steering"),
    *("wedge-press", "rolling-wheel", "hydraulic-digger", "quick-return-pin-in-slot"),
)


def good_poses(motion: Motion) -> np.ndarray:
    """Some poses far from limit positions, where rates have all digits."""
    turning = [np.broadcast_to(motion.links[name].angular_velocity, motion.shape) for name in motion.mechanism.links]
    fast = np.max(np.abs(turning), axis=0)
    good = np.flatnonzero(np.ravel(motion.regular) & np.isfinite(fast) & (fast <= 4.0 * np.nanmedian(fast) + 1e-9))
    return good[(np.array([0.05, 0.3, 0.7, 0.9]) * (len(good) - 1)).astype(int)]


def held_against_mujoco(shown: ShownMechanism) -> None:
    """Compare joints, loops, places and velocities at some poses of a motion."""
    run, motion = MujocoModel(shown), shown.motion
    assert motion is not None
    size, qpos, rates = motion.size * run.length, run.qpos(motion), run.rates(motion)
    # a roller that may spin without moving anything else is held still here, but not there
    spinning = {passive.link for passive in shown.structure.passive}
    told = np.array([not spinning.issuperset(motion.mechanism.carriers[letter]) for letter, _ in run.sites])
    places, velocities = (
        np.array([np.broadcast_to(getattr(motion.points[letter], which), motion.shape) for letter, _ in run.sites])
        for which in ("position", "velocity")
    )
    for k in good_poses(motion):
        run.place(qpos[k])
        assert run.gap < 1e-12 * max(size, 1.0)
        assert np.abs(run.places - places[:, k] * run.length).max() < 1e-12 * size
        found, known = run.velocities(run.speeds(rates[k])) / run.length, velocities[:, k]
        assert np.abs(found - known)[told].max() <= 1e-9 * np.abs(known).max()


def test_the_catalog_moves_the_same() -> None:
    for name in ck.catalog.names():
        if name not in REFUSED:
            held_against_mujoco(shown(name))


def test_what_no_model_can_say_is_refused() -> None:
    for name in ("five-bar-led", "flat-faced-follower", "oscillating-roller-follower"):
        with pytest.raises(InvalidInput, match="cannot be said in MJCF"):
            FORMAT.write(shown(name))


@pytest.mark.parametrize("name", LOADED)
def test_drivers_take_the_same_efforts(name: str) -> None:
    """With random masses and gravity, at poses with speeds and accelerations."""
    motion, _ = some_poses(heavy(name))
    forces = ck.force_analysis(motion)
    at = {name: float(np.ravel(motion.drives[name].value)[0]) for name in motion.drives}
    run = MujocoModel(shown_mechanism(motion.mechanism, at))
    qpos, rates, accelerations = run.qpos(motion), run.rates(motion), run.rates(motion, "second")
    for k in range(motion.shape[-1]):
        found = run.efforts(qpos[k], rates[k], accelerations[k])
        known = run.signs * [forces.drives[one].effort[k] for one in motion.drives]
        assert np.abs(found - known).max() <= 1e-8 * np.abs(known).max()


def test_the_four_bar_that_mujoco_computed() -> None:
    """The sample's numbers, once by our forces and once by the model that is written here."""
    sample = entry("mujoco_four_bar")
    four_bar = ck.Mechanism(
        "four-bar",
        ck.link("frame", A=(0, 0), D=(4, 0)),
        ck.link("crank", A=(0, 0), B=(1, 0)),
        ck.link("coupler", B=(0, 0), C=(3, 0), P=(1.5, 1)),
        ck.link("rocker", D=(0, 0), C=(3, 0)),
        ck.drive("crank", speed=2.0),
        ck.mass("crank", 1, at=(0.5, 0), inertia=0.09),
        ck.mass("coupler", 2, at=(1.5, 0.4), inertia=1.6),
        ck.mass("rocker", 2, at=(1.5, 0), inertia=1.5),
        ck.gravity(0, -9.81),
        units=SI,
    )
    rows = sample["expected"]["rows"]
    motion = ck.solve(four_bar, {"crank": np.deg2rad([row["crank_deg"] for row in rows])})
    torques = ck.force_analysis(motion).drives["crank"].effort
    run = MujocoModel(shown_mechanism(four_bar, {"crank": 1.0}))
    qpos, one = run.qpos(motion), [name for name, _ in run.sites].index("P")
    for k, row in enumerate(rows):
        effort = run.efforts(qpos[k], np.array([2.0]), np.array([0.0]))[0]
        velocity = run.velocities(run.data.qvel)[one]
        for found, known in (
            (torques[k], row["crank_torque"]),
            (effort, row["crank_torque"]),
            (run.places[one], complex(*row["P"])),
            (velocity, complex(*row["P_velocity"])),
        ):
            assert abs(found - known) < sample["tolerance"]
