"""Forces by name: links, pins, components by kind of pair, and lift-off of contacts."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import compoundkin as ck
from tests import catalog
from tests.dynamics import cases
from tests.support import reference


def test_all_that_acts_on_a_link_is_in_balance() -> None:
    """Named entries of a free body add up to zero, force and moment, about any point."""
    forces = cases.six_bar("dynamic", True).forces
    for link in set(forces.mechanism.links) - {"frame"}:
        body = forces.on(link)
        assert np.max(np.abs(body.force)) < 1e-13
        for point in ("G", (0.3, -0.2)):
            assert np.max(np.abs(body.moment_about(point))) < 1e-14
    bar = forces.on("bar")
    assert [(one.kind, one.name) for one in bar] == [
        ("pair", "F"), ("pair", "slot"), ("force", "force on bar"), ("weight", "bar"), ("inertia", "bar"),
    ]  # fmt: skip
    assert bar["F"].by == "frame"
    assert bar["force on bar"].at == "G"
    assert np.allclose(bar["force on bar"].place, forces.motion.points["G"].position, rtol=0, atol=1e-15)
    assert np.allclose(bar[3].force, 0.06 * -9.81j)
    crank = forces.on("crank")
    assert [one.kind for one in crank] == ["pair", "pair", "driver", "weight", "inertia"]
    assert np.max(np.abs(crank["E"].moment)) < 1e-15
    assert np.array_equal(crank["crank"].moment, forces.drives["crank"].effort)
    assert forces.on("bar") is bar


def test_a_pair_from_both_sides() -> None:
    forces = cases.six_bar("dynamic", True).forces
    slot = forces.pairs["slot"]
    assert (slot.link, slot.by, slot.at) == ("block", "bar", "C")
    other = slot.on("bar")
    assert np.array_equal(other.force, -slot.force)
    assert np.array_equal(other.moment, -slot.moment)
    about = slot.moment_about("F")
    arm = slot.place - forces.motion.points["F"].position
    assert np.allclose(about, slot.moment + np.imag(np.conj(arm) * slot.force), rtol=0, atol=1e-15)
    assert slot.force.xy.shape == (5, 2)
    with pytest.raises(ck.errors.UnknownName, match="known: bar and block"):
        slot.on("rocker")
    with pytest.raises(ck.errors.UnknownName, match="slot"):
        forces.pairs["slop"]
    with pytest.raises(ck.errors.UnknownName, match="no such link"):
        forces.on("beam")


def test_a_pin_of_three_links() -> None:
    """Its force on each link is that of the reference, whichever two pairs stand for it."""
    case, entry = cases.toggle_press(), reference("toggle_press_static", "forces")
    forces = case.forces
    pin = forces.pins["B"]
    assert pin.links == ("AB", "CB", "BD")
    for link in pin.links:
        expected = [complex(*row["pin_B_on"][link]) for row in entry["expected"]["rows"]]
        assert np.allclose(pin.on(link).force, expected, rtol=0, atol=1e-8)
    assert np.allclose(forces.pins["O"].on("crank").moment, forces.drives["crank"].effort, rtol=0, atol=1e-9)
    with pytest.raises(ck.errors.UnknownName, match="known: AB, CB, BD"):
        pin.on("crank")


def test_a_load_on_a_pin_is_passed_on_to_its_links() -> None:
    """The pin's forces on its links add up to the load, and do not depend on which of them carries it."""
    case, load = cases.toggle_press(), 3000.0 - 2000.0j
    on_pin = ck.force_analysis(ck.solve(case.mechanism.replace(ck.force("B", load)), case.values)).pins["B"]
    assert np.allclose(sum(on_pin.on(link).force for link in on_pin.links), load)
    for link in on_pin.links:
        at = case.mechanism.replace(ck.force(link, load, at="B"))
        other = ck.force_analysis(ck.solve(at, case.values)).pins["B"]
        for one in on_pin.links:
            carried = load if one == link else 0.0
            assert np.allclose(other.on(one).force + carried, on_pin.on(one).force, rtol=0, atol=1e-8)


def test_shaking_force_is_that_of_the_masses() -> None:
    """Sum of weights and loads less that of masses times accelerations; about any point."""
    case = cases.six_bar("dynamic", True)
    forces = case.forces
    total = sum(
        one.force for link in forces.mechanism.links if link != "frame"
        for one in forces.on(link) if one.kind not in ("pair", "driver")
    )  # fmt: skip
    assert np.allclose(forces.shaking.force, total, rtol=0, atol=1e-13)
    expected = [row["on_frame"]["moment_about_origin"] for row in case.rows]
    assert np.allclose(forces.shaking.moment_about((0, 0)), expected, rtol=0, atol=1e-12)
    assert [one.name for one in forces.shaking.reactions] == ["crank"]
    assert forces.shaking.external == ()
    pushed = ck.force_analysis(ck.solve(case.mechanism.replace(ck.force("frame", (5, 0), at="B")), case.values))
    assert [one.name for one in pushed.shaking.external] == ["force on frame"]
    assert np.allclose(pushed.on("frame").force - pushed.shaking.force, 5.0)


def test_an_effort_along_a_pair_is_a_load_and_no_driver() -> None:
    forces = ck.force_analysis(ck.solve(ck.load("engine-gas-pressure"), {"crank": [1.0]}))
    assert [one.kind for one in forces.on("piston")] == ["pair", "pair", "effort", "inertia"]
    assert [one.name for one in forces.shaking.reactions] == ["crank"]
    drawn = ck.draw(forces, kind="free-bodies", link="piston").svg
    assert "gas " in drawn
    assert "loads and weights" in drawn


def test_power_and_units() -> None:
    forces = cases.six_bar("dynamic", True).forces
    crank = forces.drives["crank"]
    assert (crank.unit, forces.units.power) == ("N m", "W")
    assert np.allclose(crank.power, 10.0 * crank.effort)
    inches = ck.Mechanism("m", ck.link("frame", A=0), units={"length": "in", "mass": "blob", "force": "lbf"}).units
    assert inches is not None
    assert (inches.moment, inches.power) == ("lbf in", "lbf in/s")


def test_unassembled_poses_are_no_numbers() -> None:
    case = cases.engine()
    short = ck.Mechanism(
        "short", ck.link("frame", O=0), ck.link("crank", O=0, A=2), ck.link("rod", A=0, B=1), ck.link("piston", B=0),
        ck.slide("piston", on="frame", at="B", through="O"), ck.drive("crank"), ck.force("piston", (1, 0), at="B"),
        units=cases.SI,
    )  # fmt: skip
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(short, {"crank": ck.deg([0, 10, 90])})
    forces = ck.force_analysis(motion)
    for shown in (
        forces.pairs["B"].force,
        forces.pairs["B"].moment,
        forces.drives["crank"].effort,
        forces.on("rod").force,
    ):
        assert np.isnan(shown).tolist() == [False, False, True]
    assert case.motion.assembled.all()


def test_designs_copies_and_pickles() -> None:
    case = cases.six_bar("dynamic", True)
    several = case.mechanism.replace(ck.link("crank", E=(0, 0), D=(np.array([[0.014], [0.012]]), 0)))
    forces = ck.force_analysis(ck.solve(several, case.values, **case.rates))
    assert forces.pairs["F"].force.shape == (2, 5) == forces.on("bar")[3].moment.shape
    assert np.allclose(forces.pairs["F"].force[0], case.forces.pairs["F"].force, rtol=0, atol=1e-13)
    for other in (pickle.loads(pickle.dumps(forces)), copy.deepcopy(forces), copy.copy(forces)):
        assert np.array_equal(other.on("bar").force, forces.on("bar").force)
        assert np.array_equal(other.drives["crank"].power, forces.drives["crank"].power)


UNITS = {"length": "mm", "mass": "kg", "force": "N"}
GRAVITY = ck.gravity(0, -9.81)


def eight_bar_pin(*more: Any) -> ck.Mechanism:
    """A four-bar with a second dyad at its pin C, which joins three links."""
    return ck.Mechanism(
        "Three links at C",
        ck.link("frame", A=0, D=100, E=(50, -60)), ck.link("a", A=0, B=40), ck.link("b", B=0, C=120),
        ck.link("c", D=0, C=80), ck.link("d", C=0, F=130), ck.link("e", E=0, F=90), ck.drive("a", name="motor"),
        ck.mass("b", 2), ck.mass("d", 2), GRAVITY, *more, units=UNITS,
    )  # fmt: skip


def efforts(name: str) -> Any:
    plan = eight_bar_pin(ck.friction(name, 0.1, radius=5))
    return ck.force_analysis(ck.solve(plan, {"motor": [0.5, 1.5]})).drives["motor"].effort


def test_loads_on_pins_balance() -> None:
    forces = ck.force_analysis(ck.solve(eight_bar_pin(ck.force("C", (1, 200)), ck.force("B", (3, 4)))))
    assert ck.verify(forces).passed
    for letter, load in (("B", 3 + 4j), ("C", 1 + 200j)):
        pin = forces.pins[letter]
        np.testing.assert_allclose(sum(pin.on(link).force for link in pin.links), load, atol=1e-9)


def test_frictions_have_every_name_of_their_pin() -> None:
    for names in (("A", "motor", "A(frame-a)", "A(a-frame)"), ("C(b-c)", "C(c-b)")):
        first, *others = map(efforts, names)
        for other in others:
            np.testing.assert_array_equal(other, first)


def test_frictions_at_a_pin_that_no_pair_has_are_refused() -> None:
    with pytest.raises(ck.errors.InvalidInput, match=r"name C\(b-c\), C\(b-d\), or C for all"):
        efforts("C(c-d)")
    with pytest.raises(ck.errors.InvalidMechanism, match="'motor' has a friction already"):
        eight_bar_pin(ck.friction("A", 0.1, radius=5), ck.friction("motor", 0.1, radius=5))
    twice = eight_bar_pin(ck.friction("C", 0.1, radius=5), ck.friction("C(c-b)", 0.1, radius=5))
    with pytest.raises(ck.errors.InvalidInput, match=r"C\(b-c\) has a friction already, by the name 'C'"):
        ck.force_analysis(ck.solve(twice))


def led_five_bar(*more: Any) -> ck.Mechanism:
    """A five-bar whose pin P is led by both of its coordinates."""
    masses = [ck.mass(name, 1.0, at=(40, 7), inertia=800) for name in ("left", "right", "outer", "other")]
    return ck.Mechanism(
        "Led", ck.link("frame", A=0, E=118), ck.link("left", A=0, B=90), ck.link("right", E=0, D=90),
        ck.link("outer", B=0, P=90), ck.link("other", D=0, P=90), ck.drawn(B=(-20, 80), D=(130, 80), P=(60, 150)),
        ck.drive("P", x=lambda t: 60 + 10 * np.sin(t), y=lambda t: 140 + 10 * np.cos(t)),
        *masses, GRAVITY, *more, units=UNITS,
    )  # fmt: skip


def test_what_leads_a_pin_balances_it() -> None:
    rubbing = led_five_bar(ck.force("P", (3, 4)), ck.friction("A", 0.1, radius=5))
    forces = ck.force_analysis(ck.solve(rubbing, time=np.linspace(0, 1, 9)))
    assert ck.verify(forces).passed
    pin = forces.pins["P"]
    drives = forces.drives["P.x"].effort + 1j * forces.drives["P.y"].effort
    np.testing.assert_allclose(sum(pin.on(link).force for link in pin.links), 3 + 4j + drives, rtol=1e-12)


def test_what_rubs_at_a_led_pin_is_refused() -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match="the motion of the pin P is prescribed"):
        led_five_bar(ck.friction("P", 0.1, radius=5))
    with pytest.raises(ck.errors.InvalidMechanism, match=r"name two of them: P\(outer-other\)"):
        led_five_bar(ck.damper(pair="P", rate=0.1))


def with_roller(*items: Any) -> ck.results.Motion:
    return ck.solve(catalog.mechanism("disc-cam-offset-roller").replace(*items, unit="", units=UNITS))


def test_a_mass_centre_off_the_pin_of_a_roller_is_refused() -> None:
    for mass in (ck.mass("roller", 1.0, at=(3, 1)), ck.mass("roller", 1.0)):
        with pytest.raises(ck.errors.InvalidInput, match=r'roller turns freely about P.*put it at the pin: at="P"'):
            ck.force_analysis(with_roller(mass))


def test_what_would_turn_a_roller_is_left_aside() -> None:
    loads = ck.torque("roller", 3), ck.force("roller", (1, 0), at=(2, 2)), ck.mass("roller", 1.0, at="P", inertia=500)
    forces = ck.force_analysis(with_roller(*loads))
    assert ck.verify(forces).passed


@pytest.mark.parametrize(
    "load",
    [
        ck.damper(pair="A", rate=1),
        ck.force("b", (0, 4), at="B", while_moving=(0, -1)),
        ck.effort("D", 3, only="back"),
        ck.friction("C", 0.1, radius=3),
    ],
)
def test_loads_that_ask_for_velocities_need_some(load: Any) -> None:
    motion = ck.solve(eight_bar_pin(load), order=0)
    with pytest.raises(ck.errors.InvalidInput, match="solved to order 0, and its velocities are needed by"):
        ck.force_analysis(motion, inertia=False)


def test_complex_numbers_are_no_torque() -> None:
    motion = ck.solve(eight_bar_pin(ck.effort("D", lambda q: 1j * q)))
    with pytest.raises(ck.errors.InvalidInput, match="effort along D: the function returns complex numbers"):
        ck.force_analysis(motion)


def test_wedged_poses_are_not_verified() -> None:
    long_crank = ck.Mechanism(
        "Nearly as long as its rod",
        ck.link("frame", A=0), ck.link("crank", A=0, B=109), ck.link("rod", B=0, C=110), ck.link("ram", C=0),
        ck.slide("ram", on="frame", through="A", angle=np.pi / 2, name="stroke"), ck.drive("crank", speed=8),
        ck.mass("ram", 2.0), GRAVITY, ck.friction("stroke", 0.3, length=10), ck.friction("C", 0.1, radius=20),
        units=UNITS,
    )  # fmt: skip
    with pytest.warns(ck.errors.WedgedPoses):
        forces = ck.force_analysis(ck.solve(long_crank))
    wedged = int(np.isnan(forces.drives["crank"].effort).sum())
    check = ck.verify(forces)
    assert check.passed
    assert 0 < wedged == check.singular < check.poses


def test_a_slide_has_a_normal_force_where_it_acts_and_two_contacts() -> None:
    """Force and moment of the reference; the contacts have the same force and moment, by definition of both."""
    case = cases.yoke()
    slot = case.forces.pairs["slot"]
    assert slot.parts == ("normal", "eccentricity")
    for k, row in enumerate(case.rows):
        expected = row["pairs"]["slot"]
        assert slot.normal[k] == pytest.approx(expected["normal"], rel=1e-11)
        assert slot.moment[k] == pytest.approx(expected["moment"], abs=1e-11)
        assert slot.eccentricity[k] == pytest.approx(expected["moment"] / expected["normal"], abs=1e-11)
    both = slot.contacts(length=0.04)
    assert np.allclose(both.first + both.second, slot.normal)
    assert np.allclose((both.second - both.first) * 0.02, slot.moment)
    assert np.allclose(slot.on("yoke").normal, slot.normal)
    with pytest.raises(ck.errors.InvalidInput, match="guide need its length"):
        slot.contacts()
    stated = ck.force_analysis(
        ck.solve(case.mechanism.replace(ck.friction("slot", 0.0, length=0.04)), case.values, **case.rates)
    )
    assert np.allclose(stated.pairs["slot"].contacts().first, both.first)
    with pytest.raises(ck.errors.UnknownName, match="known: normal, eccentricity"):
        _ = slot.flank
    with pytest.raises(ck.errors.UnknownName, match="a revolute pair has none; it has force, moment"):
        ck.quantity(case.forces, "A.normal")
    assert ck.quantity(case.forces, "slot.normal").unit == "N"
    assert ck.quantity(case.forces, "slot.eccentricity").unit == "m"


def test_a_wheel_that_rolls_down_a_slope() -> None:
    """A homogeneous cylinder on a slope of 20 degrees needs tan(20) / 3.

    Source: e.g. J. L. Meriam and L. G. Kraige, Engineering Mechanics: Dynamics, sample problem 6/5: friction of
    m g sin(slope) / 3, acceleration of 2 g sin(slope) / 3.
    """
    slope, g, radius, m = np.deg2rad(20.0), 9.81, 0.1, 3.0
    mechanism = ck.Mechanism(
        "wheel", ck.link("frame", O=0), ck.link("wheel", C=0),
        ck.roll("wheel", on="frame", through="O", at="C", radius=radius, angle=-slope, name="rolls"),
        ck.drive("wheel"), ck.mass("wheel", m, at="C", inertia=0.5 * m * radius**2), ck.gravity(0, -g), units=cases.SI,
    )  # fmt: skip
    motion = ck.solve(mechanism, {"wheel": [0.0, 0.3]}, speed=1.0, acceleration=2.0 / 3.0 * g * np.sin(slope))
    rolls = ck.force_analysis(motion).pairs["rolls"]
    assert np.allclose(ck.force_analysis(motion).drives["wheel"].effort, 0.0, atol=1e-13)
    assert np.allclose(rolls.normal, m * g * np.cos(slope))
    assert np.allclose(rolls.tangential, -m * g * np.sin(slope) / 3.0)
    assert np.allclose(rolls.needed_friction, np.tan(slope) / 3.0)
    assert rolls.at == "contact"
    lifted = mechanism.replace(ck.force("wheel", (0.0, 2.0 * m * g), at="C"))
    assert np.all(np.isinf(ck.force_analysis(ck.solve(lifted, {"wheel": [0.0]})).pairs["rolls"].needed_friction))


def train(sun: float) -> ck.Mechanism:
    """The planetary train of the reference, its ring on the frame, with a torque on the sun from outside."""
    return ck.Mechanism(
        "train", ck.link("frame", O=0), ck.link("arm", O=0, P=(0.026, 0)), ck.link("sun", O=0), ck.link("planet", P=0),
        ck.gear("planet", "sun", carrier="arm", teeth=(20, 32), name="on sun"),
        ck.gear("planet", "frame", carrier="arm", teeth=(20, 72), internal=True, name="in ring"),
        ck.drive("arm"), ck.torque("sun", sun),
        ck.mass("sun", 1.0, at="O", inertia=4e-5), ck.mass("arm", 1.0, at="O", inertia=2e-4),
        ck.mass("planet", 0.12, at="P", inertia=1.5e-5), units=cases.SI,
    )  # fmt: skip


def test_teeth_of_a_planetary_train() -> None:
    """Tangential and separating forces of the reference, and the flank, which changes with the load's sign."""
    for row in reference("planetary_train_torques", "forces")["expected"]["rows"]:
        values, rates = {"arm": [np.deg2rad(row["arm_deg"])]}, (row["arm_speed"], row["arm_acceleration"])
        outside = row["sun_torque_from_outside"]
        forces, other = (
            ck.force_analysis(ck.solve(train(sun), values, speed=rates[0], acceleration=rates[1]))
            for sun in (outside, -4.0 * outside)
        )
        assert forces.drives["arm"].effort[0] == pytest.approx(row["driver_torque_on_arm"], rel=1e-12)
        assert forces.pairs["P"].on("planet").force[0] == pytest.approx(complex(*row["planet_pin"]["force"]), rel=1e-12)
        for name, key in (("on sun", "sun"), ("in ring", "ring")):
            expected, found = row[f"tooth_force_on_planet_from_{key}"], forces.pairs[name]
            assert abs(found.tangential[0]) == pytest.approx(abs(expected["tangential"]), rel=1e-12)
            assert found.separating[0] == pytest.approx(expected["separating"], rel=1e-12)
            assert found.on("planet").force[0] == pytest.approx(complex(*expected["force"]), rel=1e-12)
            assert found.tooth_force[0] == pytest.approx(abs(complex(*expected["force"])), rel=1e-12)
            assert found.flank[0] == np.sign(found.tangential[0]) == -other.pairs[name].flank[0]
            assert other.pairs[name].separating[0] > 0.0


def test_strands_of_a_belt() -> None:
    """The moment over the radius is the difference of the pulls; with pretension their mean is that."""
    mechanism = ck.Mechanism(
        "belt", ck.link("frame", A=0, B=(0.5, 0)), ck.link("motor", A=0), ck.link("drum", B=0),
        ck.belt("motor", "drum", radii=(0.05, 0.15), name="belt"), ck.drive("motor"),
        ck.torque("drum", -30.0), units=cases.SI,
    )  # fmt: skip
    chain = ck.force_analysis(ck.solve(mechanism, {"motor": [0.0, 1.0]}))
    one, two = chain.pairs["belt"].strands
    assert np.allclose(np.sort([one[0], two[0]]), [0.0, 30.0 / 0.15])
    tight = ck.force_analysis(ck.solve(mechanism.replace(ck.pretension("belt", 150.0)), {"motor": [0.0]}))
    assert np.allclose(np.sort(np.ravel(tight.pairs["belt"].strands)), [50.0, 250.0])
    slack = ck.force_analysis(ck.solve(mechanism.replace(ck.pretension("belt", 80.0)), {"motor": [0.0]}))
    assert np.allclose(np.sort(np.ravel(slack.pairs["belt"].strands)), [-20.0, 180.0])


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
