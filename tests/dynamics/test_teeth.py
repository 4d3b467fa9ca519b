"""Forces at teeth, strands, rollers and contacts: references, closed forms by hand, and what does no work."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.loaded_block import loaded_blocks
from compoundkin.dynamics.reactions.reverse_pass import accompanying, all_reactions, reverse_pass
from compoundkin.model.pairs.contract import as_transmitting_pair
from compoundkin.results import Forces
from tests.support import reference

SI = {"length": "m", "mass": "kg", "force": "N"}


def planetary(sun_torque: float, **words: Any) -> ck.Mechanism:
    """The train of the reference: radii 0.016, 0.010, 0.036; the ring is the frame's."""
    own = reference("planetary_train_torques", "forces")["dimensions"]
    radii, inertia = own["radii"], own["inertia"]
    return ck.Mechanism(
        "Planetary train",
        ck.link("frame", O=0),
        ck.link("arm", O=0, P=radii["arm"]),
        ck.link("sun", O=0),
        ck.link("planet", P=0),
        ck.gear("sun", "planet", carrier="arm", radii=(radii["sun"], radii["planet"]), **words),
        ck.gear("planet", "frame", carrier="arm", radii=(radii["planet"], radii["ring"]), internal=True, **words),
        ck.drive("arm"),
        ck.mass("sun", 1.0, at="O", inertia=inertia["sun"]),
        ck.mass("arm", 1.0, at="O", inertia=inertia["arm about the axis"]),
        ck.mass("planet", own["planet_mass"], at="P", inertia=inertia["planet"]),
        ck.torque("sun", sun_torque),
        units=SI,
    )


@pytest.mark.parametrize("k", range(4))
def test_teeth_of_a_planetary_train(k: int) -> None:
    row = reference("planetary_train_torques", "forces")["expected"]["rows"][k]
    plan = planetary(row["sun_torque_from_outside"], pressure_angle=ck.deg(20))
    rates = {"speed": row["arm_speed"], "acceleration": row["arm_acceleration"]}
    forces = ck.force_analysis(ck.solve(plan, {"arm": [ck.deg(row["arm_deg"])]}, **rates))
    assert forces.drives["arm"].effort[0] == pytest.approx(row["driver_torque_on_arm"], rel=1e-9)
    greatest = abs(row["tooth_force_on_planet_from_sun"]["tangential"])
    for name, key in (("sun/planet", "sun"), ("planet/frame", "ring")):
        tooth = forces.pairs[name].on("planet")
        assert abs(tooth.force[0] - complex(*row[f"tooth_force_on_planet_from_{key}"]["force"])) < 1e-9 * greatest
    pin = forces.pairs["P"].on("planet")
    assert abs(pin.force[0] - complex(*row["planet_pin"]["force"])) < 1e-9 * greatest
    ring = forces.pairs["planet/frame"].on("frame")
    assert ring.moment_about("O")[0] == pytest.approx(row["torque_of_the_train_on_the_ring"], rel=1e-9)
    assert np.max(np.abs(forces.on("planet").force)) < 1e-12 * greatest
    assert ck.verify(forces).passed


def transmitted(forces: Forces) -> dict[str, Any]:
    """What each pair of teeth or strands transmits."""
    found = {}
    for name, wrench in forces.wrenches.items():
        if pair := as_transmitting_pair(forces.solving_order.pairs[name]):
            poses = tuple(forces.poses[link] for link in pair.members)
            found[name] = pair.transmitted(forces.inputs.ends[name], poses, wrench)
    return found


def test_what_teeth_transmit_does_not_depend_on_the_pressure_angle() -> None:
    turn = {"arm": np.linspace(0.0, 6.0, 7)}
    wide, none = (
        ck.force_analysis(ck.solve(planetary(-10.0, pressure_angle=angle), turn, speed=20.0)) for angle in (0.4, 0.0)
    )
    for name, tangential in transmitted(none).items():
        assert np.allclose(transmitted(wide)[name], tangential, rtol=1e-12)
        assert np.allclose(np.abs(wide.pairs[name].force), np.abs(tangential[0]) / np.cos(0.4), rtol=1e-12)
        assert np.allclose(np.abs(none.pairs[name].force), np.abs(tangential[0]), rtol=1e-12)
    assert np.allclose(wide.drives["arm"].effort, none.drives["arm"].effort, rtol=1e-12)


def rack_and_pinion(torque: float, side: int) -> ck.Mechanism:
    """A pinion of radius 0.2 on a driven block along a rack of the frame that runs along 30 degrees."""
    return ck.Mechanism(
        "Pinion",
        ck.link("frame", O=0),
        ck.link("block", C=0),
        ck.link("pinion", C=0),
        ck.slide("block", on="frame", through="O", angle=ck.deg(30), offset=0.2 * side, name="guide"),
        ck.rack("frame", "pinion", through="O", angle=ck.deg(30), radius=0.2, side=side, pressure_angle=0.3,
                name="rack"),
        ck.drive("block", values=[0.1, 0.5]),
        ck.torque("pinion", torque),
        units=SI,
    )  # fmt: skip


@pytest.mark.parametrize("torque", [-4.0, 4.0])
@pytest.mark.parametrize("side", [-1, 1])
def test_teeth_of_a_rack(torque: float, side: int) -> None:
    """Torque by radius along the line, and apart; the guide and the drive hold against both."""
    forces = ck.force_analysis(ck.solve(rack_and_pinion(torque, side)))
    e = np.exp(1j * ck.deg(30))
    along, apart = -side * torque / 0.2, 20.0 * np.tan(0.3)
    tooth = forces.pairs["rack"].on("pinion")
    assert np.allclose(tooth.force, e * along + 1j * e * side * apart, rtol=1e-12)
    assert np.allclose(forces.drives["block"].effort, -along, rtol=1e-12)
    guide = forces.pairs["guide"].on("block")
    assert np.allclose((np.conj(e) * guide.force).imag, -side * apart, rtol=1e-12)
    assert ck.verify(forces).passed


def pulleys(torque: Any, tension: Any, crossed: bool = False, apart: Any = 1.0) -> ck.Mechanism:
    """A motor pulley of 0.1 and a drum of 0.3, 1 m apart along x, with a load on the drum."""
    more = () if tension is None else (ck.pretension("belt", tension),)
    return ck.Mechanism(
        "Belt",
        ck.link("frame", M=0, D=apart),
        ck.link("motor", M=0),
        ck.link("drum", D=0),
        ck.belt("motor", "drum", radii=(0.1, 0.3), crossed=crossed, name="belt"),
        ck.drive("motor", values=[0.0, 1.0]),
        ck.torque("drum", torque),
        *more,
        units=SI,
    )


@pytest.mark.parametrize("crossed", [False, True])
@pytest.mark.parametrize("torque", [-60.0, 60.0])
def test_strands_with_and_without_pretension(torque: float, crossed: bool) -> None:
    """The drum's bearing carries both strands: by their angle, pulls 200 apart, and together 200 or 600."""
    sine = 0.4 if crossed else 0.2
    cosine, sense = np.sqrt(1.0 - sine**2), 1.0 if crossed else -1.0
    for tension, total in ((None, 200.0), (300.0, 600.0)):
        forces = ck.force_analysis(ck.solve(pulleys(torque, tension, crossed)))
        found = forces.pairs["belt"].on("drum")
        # the first strand leaves the motor above; it comes to the drum from below where the belt is crossed
        difference = torque / 0.3 * sense
        first, second = (total + difference) / 2.0, (total - difference) / 2.0
        pull = first * complex(-cosine, sine * sense) + second * complex(-cosine, -sine * sense)
        assert np.allclose(found.force, pull, rtol=1e-12)
        assert np.allclose(found.moment_about("D"), -torque, rtol=1e-12)
        assert np.allclose(forces.pairs["D"].on("drum").force, -pull, rtol=1e-12)
        assert np.allclose(forces.drives["motor"].effort, torque / 3.0 * sense, rtol=1e-12)
        assert ck.verify(forces).passed


def test_pretension_of_several_designs() -> None:
    forces = ck.force_analysis(ck.solve(pulleys(-60.0, np.array([[300.0], [400.0], [500.0]]), apart=np.ones((3, 1)))))
    assert forces.pairs["belt"].force.shape == (3, 2)
    cosine = np.sqrt(1.0 - 0.2**2)
    assert np.allclose(forces.pairs["belt"].force.real[:, 0], -cosine * np.array([600.0, 800.0, 1000.0]))


def test_pretension_presses_bearings_that_rub() -> None:
    """Both bearings carry twice the pretension by the strands' angle, whatever the belt transmits."""
    plan = pulleys(-60.0, 300.0)
    rough = (ck.friction(name, 0.1, radius=0.02) for name in ("M", "D"))
    plan = ck.Mechanism(plan.title, *plan.items, *rough, units=SI)
    forces = ck.force_analysis(ck.solve(plan, speed=3.0))
    pressed = forces.pairs["M"].on("motor").force[0], forces.pairs["D"].on("drum").force[0]
    moments = [0.1 * 0.02 * abs(force) for force in pressed]
    difference = 200.0 + moments[1] / 0.3
    assert abs(pressed[1]) == pytest.approx(abs(complex(600.0 * np.sqrt(0.96), 0.2 * difference)), rel=1e-9)
    # the belt turns both alike, the drum a third as fast: so does its friction count at the motor
    assert forces.drives["motor"].effort[0] == pytest.approx(20.0 + moments[0] + moments[1] / 3.0, rel=1e-9)


def follower(own_roller: bool, inertia: float = 0.0) -> ck.Mechanism:
    """The disc cam of the reference, its roller a point of the follower or a link of its own."""
    own = reference("disc_cam_contact_force", "forces")["dimensions"]
    lowest = reference("disc_cam_contact_force", "forces")["expected"]["lowest_lift"]
    roller = [ck.link("roller", P=0), ck.mass("roller", 0.1, at="P", inertia=inertia)] if own_roller else []
    return ck.Mechanism(
        "Disc cam",
        ck.link("frame", A=0, Q=own["offset"]),
        ck.link("cam", A=0),
        ck.link("follower", P=0),
        *roller,
        ck.slide("follower", on="frame", at="P", through="Q", angle=ck.deg(90), name="guide"),
        ck.cam("roller" if own_roller else "follower", on="cam", at="P", name="contact", radius=own["roller"],
               profile=ck.profiles.disc(own["R"], (own["e"], 0))),
        ck.drive("cam"),
        ck.mass("follower", own["mass"] - 0.1 * own_roller, at="P", inertia=0.0),
        ck.gravity(0, -9.81),
        ck.spring(pair="guide", stiffness=own["spring"], free=lowest, preload=own["preload_at_lowest"]),
        units=SI,
    )  # fmt: skip


@pytest.mark.parametrize("own_roller", [False, True])
def test_contact_force_of_a_disc_cam(own_roller: bool) -> None:
    rows = reference("disc_cam_contact_force", "forces")["expected"]["rows"]
    plan = follower(own_roller, inertia=0.5)
    forces = ck.force_analysis(ck.solve(plan, {"cam": ck.deg([row["cam_deg"] for row in rows])}, speed=50.0))
    contact, guide = forces.pairs["contact"].on("roller" if own_roller else "follower"), forces.pairs["guide"]
    for k, row in enumerate(rows):
        told, greatest = row["contact"], abs(row["contact"]["normal_force"])
        assert abs(contact.force[k] - complex(*told["force"])) < 1e-9 * greatest
        about = contact.wrench.about(complex(*told["at"]))
        assert abs(np.ravel(about)[k]) < 1e-9 * greatest * 0.03
        assert abs(guide.on("follower").force[k].real - row["guide"]["side_force_x"]) < 1e-9 * greatest
        assert abs(guide.on("follower").moment[k] - row["guide"]["moment_about_roller_centre"]) < 1e-9 * greatest
        assert abs(forces.drives["cam"].effort[k] - row["driver"]) < 1e-9 * greatest * 0.03
    assert ck.verify(forces).passed


def rocker_with_roller(inertia: float, torque: float) -> ck.Mechanism:
    return ck.Mechanism(
        "Rocker",
        ck.link("frame", A=0, B=0.1),
        ck.link("cam", A=0),
        ck.link("arm", B=0, P=0.08),
        ck.link("roller", P=0),
        ck.cam("roller", on="cam", at="P", name="contact", radius=0.01, profile=ck.profiles.disc(0.04, (0.01, 0))),
        ck.drive("cam", values=np.linspace(0.0, 6.0, 5), speed=30.0),
        ck.mass("arm", 0.3, at=(0.04, 0), inertia=2e-4),
        ck.mass("roller", 0.05, at="P", inertia=inertia),
        ck.torque("arm", 3.0),
        *([ck.torque("roller", torque)] if torque else []),
        units=SI,
    )


def test_nothing_turns_a_roller_that_turns_freely() -> None:
    """The spin of a roller is nobody's coordinate: neither its inertia nor a torque on it is passed on."""
    still, spun = (ck.force_analysis(ck.solve(rocker_with_roller(*given))) for given in ((1e-9, 0.0), (1.0, 7.0)))
    for name in still.wrenches:
        assert np.allclose(still.pairs[name].force, spun.pairs[name].force, rtol=1e-12)
    assert np.allclose(still.drives["cam"].effort, spun.drives["cam"].effort, rtol=1e-12)
    assert np.max(np.abs(np.ravel(spun.wrenches["P"].about(spun.motion.points["P"].position)))) < 1e-12


def test_the_reverse_pass_alone_is_linear() -> None:
    """Without what comes with teeth: twice the loads are twice the forces, and the other way round."""
    (at,) = loaded_blocks(ck.solve(planetary(-10.0), {"arm": [0.3]}))
    loads = {"sun": Wrench(0j, 1.0)}
    one = reverse_pass(at.motion.solving_order, at.block, loads)
    back = reverse_pass(at.motion.solving_order, at.block, {"sun": Wrench(0j, -2.0)})
    for name, wrench in one.pairs.items():
        assert np.allclose(back.pairs[name].force, -2.0 * wrench.force, rtol=1e-12)
    whole = all_reactions(at, loads)
    again = accompanying(at, whole)
    for name, beside in accompanying(at, one).items():
        assert np.allclose(again[name].force, beside.force, rtol=1e-12)
        assert np.allclose(whole.pairs[name].force, one.pairs[name].force + beside.force, rtol=1e-12)
