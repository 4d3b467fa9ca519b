"""Flat parallelograms and their kin: the smooth motion goes through, and so do all its derivatives."""

import warnings

import numpy as np
import pytest

import compoundkin as ck

DRAWN = ck.drawn(B=(1.0, 1.75), C=(6.0, 1.75))
CROSSED = ck.drawn(B=(1.0, 1.75), C=(4.2, -1.8))


def parallelogram(*more):
    return ck.Mechanism(
        "Parallelogram",
        ck.link("frame", A=0, D=5),
        ck.link("crank", A=0, B=2),
        ck.link("coupler", B=0, C=5),
        ck.link("rocker", D=0, C=2),
        ck.drive("crank"),
        *more,
    )


def isosceles(length):
    return ck.Mechanism(
        "Isosceles slider-crank",
        ck.link("frame", A=0),
        ck.link("crank", A=0, B=length),
        ck.link("rod", B=0, C=length),
        ck.link("slider", C=0),
        ck.slide("slider", on="frame", through="A"),
        ck.drive("crank"),
    )


RANGES = {
    "change points at samples": np.arange(0.0, 361.0, 5.0),
    "change points between samples": np.arange(-3.0, 760.0, 7.0),
    "beginning at one": np.array([180.0, 185.0, 190.0]),
    "ending at one": np.array([150.0, 170.0, 180.0]),
    "backward": np.arange(360.0, -1.0, -5.0),
    "drawn outside the range": np.arange(190.0, 350.0, 5.0),
    "one pose beyond one": np.array([240.0]),
}


@pytest.mark.parametrize("values", RANGES.values(), ids=RANGES.keys())
def test_the_coupler_of_a_parallelogram_stays_parallel(values):
    speed = 2.0 if values[-1] >= values[0] else -2.0
    motion = ck.solve(
        parallelogram(DRAWN), {"crank": ck.deg(values)}, speed=speed, acceleration=0.7, jerk=-0.3, order=3
    )
    coupler, rocker = motion.links["coupler"], motion.links["rocker"]
    # a root loses digits near its zero, each derivative of it once more; at the zero itself none are lost
    height = np.abs(np.sin(motion.drives["crank"].value))
    height = np.where(height < 1e-6, 1.0, height)
    expected = (None, (speed, 0.0), (0.7, 0.0), (-0.3, 0.0))
    assert (np.abs(coupler.angle) * height).max() < 1e-13
    for k, name in ((1, "angular_velocity"), (2, "angular_acceleration"), (3, "angular_jerk")):
        for link, value in zip((rocker, coupler), expected[k], strict=True):
            assert (np.abs(getattr(link, name) - value) * height ** (k + 1)).max() < 1e-12
    assert ck.verify(motion).passed


def test_the_crossed_motion_is_held_too():
    motion = ck.solve(parallelogram(CROSSED), {"crank": ck.deg(np.arange(0.0, 361.0, 5.0))}, order=3)
    angle, rate = motion.links["rocker"].angle, motion.links["rocker"].angular_velocity
    # the antiparallelogram's rates: -1 at its middle, by the rolling ellipses (1 - e)/(1 + e) at its ends
    assert rate[0] == pytest.approx(-(5 + 2) / (5 - 2) if rate[0] < -1 else -(5 - 2) / (5 + 2), abs=1e-9)
    assert np.abs(np.diff(angle)).max() < 0.25
    differences = (angle[2:] - angle[:-2]) / (2 * np.deg2rad(5.0))
    assert np.abs(differences - rate[1:-1]).max() < 0.05
    assert ck.verify(motion).passed


def test_the_isosceles_slider_crank_slides_through_its_pivot():
    motion = ck.solve(isosceles(2.0), order=3)
    q, c = motion.drives["crank"].value, motion.points["C"]
    assert np.abs(c.position - 4 * np.cos(q)).max() < 1e-12
    assert np.abs(c.velocity + 4 * np.sin(q)).max() < 1e-11
    assert np.abs(c.acceleration + 4 * np.cos(q)).max() < 1e-11
    assert np.abs(c.jerk - 4 * np.sin(q)).max() < 1e-10


def test_a_near_miss_keeps_its_mode():
    """A linkage that almost becomes flat does turn back; it must not be taken through."""
    for ground in (5.0 + 1e-6, 5.0 + 1e-4, 5.01):
        mechanism = parallelogram(DRAWN).replace(ck.link("frame", A=0, D=ground), ck.link("coupler", B=0, C=5.0 - 1e-6))
        with_gap = ck.solve(mechanism, {"crank": ck.deg(np.arange(30.0, 151.0, 5.0))})
        assert with_gap.tracker.flips == {}


def test_designs_pass_at_their_own_places():
    turned = np.array([0.0, 0.3, 0.7])
    frame = ck.link("frame", A=0, D=(5 * np.cos(turned)[:, None], 5 * np.sin(turned)[:, None]))
    c = 1.0 + 1.75j + 5 * np.exp(1j * turned)[:, None]
    drawing = ck.drawn(B=(1.0, 1.75), C=c)
    motion = ck.solve(parallelogram(drawing).replace(frame), {"crank": ck.deg(np.arange(60.0, 300.0, 5.0))})
    for k, angle in enumerate(turned):
        assert np.abs(motion.links["coupler"].angle[k] - angle).max() < 1e-12


def test_a_class_iii_group_behind_a_change_point_is_tracked_again():
    """The platform's legs hang on the rocker of a parallelogram: it must follow the smooth motion."""
    b = ck.polar(2, ck.deg(60))
    c = b + 5
    k = c + 6j
    legs = (
        ck.link("leg", "C", "K"),
        ck.link("plate", "K", "L", "M"),
        ck.link("second", "L", "Q"),
        ck.link("third", "M", "S"),
    )
    mechanism = ck.Mechanism(
        "Platform on a parallelogram",
        ck.link("frame", "A", "D", "Q", "S"),
        ck.link("crank", "A", "B"),
        ck.link("coupler", "B", "C"),
        ck.link("rocker", "D", "C"),
        *legs,
        ck.drawn(A=0, B=b, C=c, D=5, K=k, L=k + 3, M=k + 1.5 + 2j, Q=k + 3 - 8j, S=k - 7 + 6j),
        ck.drive("crank"),
    )
    motion = ck.solve(mechanism, {"crank": ck.deg(np.linspace(60.0, 230.0, 57))}, order=1)
    assert [group.class_ for group in motion.structure.groups] == [2, 3]
    assert motion.tracker.flips
    assert np.abs(motion.links["coupler"].angle).max() < 1e-12
    assert np.abs(np.diff(motion.links["plate"].angle)).max() < 0.2
    assert ck.verify(motion).passed


def whitworth():
    """A turning guide whose crank is as long as its pivots are apart: the block passes through the guide's pivot."""
    return ck.Mechanism(
        "Turning guide of equal lengths",
        ck.link("frame", A=0, D=1),
        ck.link("crank", A=0, B=1),
        ck.link("block", B=0),
        ck.link("guide", D=0, E=3),
        ck.slide("block", on="guide", through="D"),
        ck.drive("crank"),
    )


def test_a_guide_goes_on_when_its_block_passes_its_pivot():
    values = ck.deg(np.arange(92.5, 700.0, 5.0))
    motion = ck.solve(whitworth(), {"crank": values})
    # the guide turns at half the speed of the crank: the angle at the circumference
    assert np.abs(motion.links["guide"].angular_velocity - 0.5).max() < 1e-10
    assert np.abs(np.diff(motion.links["guide"].angle) - np.deg2rad(2.5)).max() < 1e-10
    assert ck.verify(motion).passed


def test_the_pose_in_which_the_pivots_coincide_is_masked_and_explained():
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(whitworth(), {"crank": ck.deg([350.0, 355.0, 360.0, 365.0, 370.0])})
    assert motion.assembled.tolist() == [True, True, False, True, True]
    assert "coincide" in ck.gaps(motion)[0].reason
    good = motion.assembled
    assert np.abs(motion.links["guide"].angular_velocity[good] - 0.5).max() < 1e-10
    assert np.abs(np.diff(motion.links["guide"].angle[good])).max() < 0.1


def test_a_rhombus_goes_on_when_its_outer_pins_pass_each_other():
    mechanism = ck.Mechanism(
        "Rhombus",
        ck.link("frame", A=0, D=1),
        ck.link("crank", A=0, B=1),
        ck.link("coupler", B=0, C=1),
        ck.link("rocker", D=0, C=1),
        ck.drive("crank"),
        ck.drawn(B=(0, 1), C=(1, 1)),
    )
    motion = ck.solve(mechanism, {"crank": ck.deg(np.arange(92.5, 700.0, 5.0))})
    assert np.abs(motion.links["rocker"].angular_velocity - 1.0).max() < 1e-9
    assert ck.verify(motion).passed


@pytest.mark.parametrize("values", [[60.0, 90.0, 270.0, 300.0], [90.0, 91.0, 269.0], [60.0, 100.0, 220.0, 260.0]])
def test_coarse_poses_pass_change_points_too(values):
    """What lies between two poses is searched however far apart they are."""
    motion = ck.solve(parallelogram(DRAWN), {"crank": ck.deg(values)})
    assert np.abs(motion.links["coupler"].angle).max() < 1e-12
    assert np.abs(np.exp(1j * motion.links["rocker"].angle) - np.exp(1j * ck.deg(values))).max() < 1e-12


def test_a_coarse_isosceles_slider_crank_slides_on():
    values = ck.deg(np.arange(15.0, 346.0, 30.0))
    assert np.abs(ck.solve(isosceles(1.0), {"crank": values}).points["C"].x - 2 * np.cos(values)).max() < 1e-12


@pytest.mark.parametrize("start", [-42.0, -40.0])
def test_a_turning_guide_is_on_the_same_branch_on_every_grid(start):
    """Also where a pose is the very place at which its block passes its pivot."""
    values = ck.deg(np.arange(start, 41.0, 5.0))
    mechanism = ck.Mechanism(
        "Turning guide",
        ck.link("frame", O=0, Q=1),
        ck.link("crank", O=0, A=1),
        ck.link("block", A=0),
        ck.link("bar", Q=0, E=2),
        ck.slide("block", on="bar", through="Q"),
        ck.drive("crank", values=values),
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
        motion = ck.solve(mechanism)
    good = motion.assembled
    expected = np.exp(1j * (values / 2 - np.pi / 2))
    assert np.abs(motion.points["E"].position - (1 + 2 * expected))[good].max() < 1e-12
