"""What only some kinds of pairs have of forces: normal forces, guides' contacts, rolling, teeth, strands."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from tests.dynamics import cases
from tests.support import reference


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
    assert not chain.pairs["belt"].is_slack.any()
    tight = ck.force_analysis(ck.solve(mechanism.replace(ck.pretension("belt", 150.0)), {"motor": [0.0]}))
    assert np.allclose(np.sort(np.ravel(tight.pairs["belt"].strands)), [50.0, 250.0])
    slack = ck.force_analysis(ck.solve(mechanism.replace(ck.pretension("belt", 80.0)), {"motor": [0.0]}))
    assert np.allclose(np.sort(np.ravel(slack.pairs["belt"].strands)), [-20.0, 180.0])
    assert slack.pairs["belt"].is_slack.all()
