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
        assert with_gap.followed.change_points == {}


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
    assert motion.followed.change_points
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


# --- whatever the grid: issue 13, item 3 ----------------------------------------------------------------------

OFFSETS = [10.0**-k for k in range(1, 13)]
DRAWINGS = {"parallel": DRAWN, "crossed": CROSSED}


def coupler_of(drawn, q):
    """The coupler's angle and its derivatives by the crank's: none, or twice those of the diagonal from B to D."""
    if drawn == "parallel":
        return [np.zeros_like(q)] * 4
    turned = 2.0 * np.exp(1j * q)
    w = 5.0 - turned
    first = -1j * turned / w
    second = turned / w - first**2
    third = 1j * turned / w + 1j * turned**2 / w**2 - 2.0 * first * second
    return [2.0 * np.angle(w), *(2.0 * rate.imag for rate in (first, second, third))]


def assert_exact(drawn, values, speed=1.0, **options):
    """The plain root loses 1e-16 / h^(k + 1); within 0.003 of a change point nothing is lost any more."""
    motion = ck.solve(parallelogram(DRAWINGS[drawn]), {"crank": values}, speed=speed, order=3, **options)
    coupler = motion.links["coupler"]
    found = coupler.angle, coupler.angular_velocity, coupler.angular_acceleration, coupler.angular_jerk
    expected = coupler_of(drawn, np.asarray(values, dtype=float))
    assert np.abs(np.exp(1j * found[0]) - np.exp(1j * expected[0])).max() < 1e-13
    for k, limit in ((1, 1e-11), (2, 2e-9), (3, 1e-6)):
        assert np.abs(found[k] - expected[k] * speed**k).max() < limit
    return motion


@pytest.mark.parametrize("at", [0.0, np.pi, 2 * np.pi])
@pytest.mark.parametrize("drawn", DRAWINGS)
def test_a_fan_of_offsets_comes_out_alike(drawn, at):
    fan = at + np.array(sorted([*OFFSETS, *(-x for x in OFFSETS), 0.0]))
    assert_exact(drawn, fan)
    assert_exact(drawn, fan[::-1], -1.0)
    assert_exact(drawn, np.random.default_rng(0).permutation(fan))


@pytest.mark.parametrize("offset", [0.0, *OFFSETS])
@pytest.mark.parametrize("drawn", DRAWINGS)
def test_poses_beside_a_change_point(drawn, offset):
    """Single ones, two on either side of it, an ordinary sweep, one that turns back, one that begins or ends there."""
    for sign in (1.0, -1.0):
        beside = np.pi + sign * offset
        assert_exact(drawn, [beside])
        assert_exact(drawn, [beside], -1.0)
        pair = [np.pi - sign * offset, np.pi + sign * offset][: 2 if offset else 1]
        assert_exact(drawn, [np.pi - 0.5 * sign, *pair, np.pi + 0.5 * sign], sign)
        assert_exact(drawn, beside + sign * ck.deg(np.arange(-20.0, 21.0, 5.0)), sign)
        assert_exact(drawn, [np.pi - 0.5, np.pi - 0.2, beside, np.pi - 0.2, np.pi - 0.5])
        assert_exact(drawn, beside + sign * np.array([0.0, 0.05, 0.1]), sign)
        assert_exact(drawn, beside - sign * np.array([0.1, 0.05, 0.0]), sign)


def timed(*segments, poses=251):
    mechanism = ck.load("parallelogram").replace(ck.drive("crank", law=ck.laws.program(*segments)))
    motion = ck.solve(mechanism, time=np.linspace(0.0, sum(each.over for each in segments), poses), order=3)
    coupler = motion.links["coupler"]
    for k, limit in enumerate((1e-12, 1e-10, 1e-8, 1e-6)):
        assert np.abs((coupler.angle, coupler.angular_velocity, coupler.angular_acceleration, coupler.angular_jerk)[k]
                      ).max() < limit  # fmt: skip
    return motion


def half_turn(by=0.0):
    return ck.laws.rise(np.pi + by, 1.0, "4-5-6-7")


@pytest.mark.parametrize("back", [False, True])
def test_a_rest_at_a_change_point_is_warned_about_once_and_gone_through(back):
    """251 times over 2.5 s came out as the antiparallelogram without a word."""
    last = ck.laws.fall(np.pi, 1.0, "4-5-6-7") if back else half_turn()
    with pytest.warns(ck.errors.ChangePointWarning, match="pose 100, crank = 180 degrees") as caught:
        timed(half_turn(), ck.laws.dwell(0.5), last)
    assert len(caught) == 1


@pytest.mark.parametrize("by", [1e-5, 1e-6, 1e-7, 1e-8, 1e-9, -1e-6, -1e-9])
def test_a_rest_beside_a_change_point_is_nothing_special(by):
    timed(half_turn(by), ck.laws.dwell(0.5), half_turn(-by))


def test_a_turn_without_a_rest_returns_as_it_came():
    motion = timed(half_turn(), ck.laws.fall(np.pi, 1.0, "4-5-6-7"), poses=201)
    assert np.count_nonzero(motion.change_points[0] == 100.0) == 2


def chain_of_parallelograms(turned=0.0):
    """The rocker of one parallelogram is the crank of the next, whose frame is turned by an angle."""
    base, b = np.exp(1j * turned), 2.0 * np.exp(1j)
    places = {"B": b, "C": b + 5.0, "E": 5.0 + 1.5 * np.exp(1j), "F": 5.0 + 1.5 * np.exp(1j) + 4.0 * base}
    return ck.Mechanism(
        "Parallelograms",
        ck.link("frame", A=0, D=5, G=5 + 4 * base),
        ck.link("crank", A=0, B=2),
        ck.link("coupler", B=0, C=5),
        ck.link("rocker", D=0, C=2, E=1.5),
        ck.link("second", E=0, F=4),
        ck.link("last", G=0, F=1.5),
        ck.drive("crank"),
        ck.drawn(**places),
    )


@pytest.mark.parametrize("turned", [0.0, 1e-9, 1e-7, 1e-5, 0.3])
def test_groups_in_a_row_have_each_their_change_points(turned):
    beside = np.pi + np.array([-1e-7, 0.0, 1e-9, 1e-3])
    for values in (np.arange(0.0, 4.0, 0.1), beside, [2.0, *beside, 4.0], [np.pi + 1e-8], [np.pi]):
        motion = ck.solve(chain_of_parallelograms(turned), {"crank": values})
        assert np.abs(motion.links["coupler"].angle).max() < 1e-12
        assert np.abs(np.exp(1j * motion.links["second"].angle) - np.exp(1j * turned)).max() < 1e-10
        assert np.abs(motion.links["last"].angular_velocity - 1.0).max() < 1e-8
        assert np.abs(motion.links["last"].angular_acceleration).max() < 1e-5


def test_some_designs_have_change_points_and_others_have_none():
    frames = np.array([5.0, 4.9, 5.0])[:, None]
    mechanism = parallelogram(DRAWN).replace(ck.link("frame", A=0, D=frames))
    motion = ck.solve(mechanism, {"crank": np.pi + np.array([-0.2, -1e-7, 1e-7, 0.2])}, modes={"coupler": -1})
    other = parallelogram(DRAWN).replace(ck.link("frame", A=0, D=4.9))
    alone = ck.solve(other, {"crank": motion.drives["crank"].value[1]}, modes={"coupler": -1})
    assert np.abs(motion.links["coupler"].angle[[0, 2]]).max() < 1e-12
    assert np.abs(motion.links["coupler"].angle[1] - alone.links["coupler"].angle).max() < 1e-13
    assert np.isfinite(motion.change_points[0]).sum(axis=1).tolist() == [1, 0, 1]


def test_two_drivers_pass_where_one_of_them_does():
    """The parallelogram stands on a table that turns as well: only the crank's angle from the table counts."""
    b = 2.0 * np.exp(1j)
    mechanism = ck.Mechanism(
        "On a table",
        ck.link("frame", O=0),
        ck.link("table", O=0, A=1, D=6),
        ck.link("crank", A=0, B=2),
        ck.link("coupler", B=0, C=5),
        ck.link("rocker", D=0, C=2),
        ck.drive("table"),
        ck.drive("crank", on="table"),
        ck.drawn(O=0, A=1, D=6, B=1 + b, C=6 + b),
    )
    s = np.linspace(0.0, 1.0, 40)
    for crank in (np.pi + (s - 0.5), np.pi + 1e-7 * (s - 0.5), np.pi - 0.3 * np.abs(s - s[20])):
        speeds = {"table": 0.8, "crank": 1.0}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ck.errors.ChangePointWarning)
            motion = ck.solve(mechanism, {"table": 0.8 * s, "crank": crank}, speed=speeds)
        assert np.abs(motion.links["coupler"].angle - 0.8 * s).max() < 1e-12
        assert np.abs(motion.links["coupler"].angular_velocity - 0.8).max() < 1e-9


def test_where_nothing_chooses_a_pose_at_a_change_point_belongs_to_the_open_loop():
    for first in (0.0, 180.0, 360.0):
        for speed in (1.0, -1.0):
            for values in ([first], first + speed * np.arange(0.0, 30.0, 5.0)):
                motion = ck.solve(parallelogram(), {"crank": ck.deg(values)}, speed=speed)
                assert np.abs(motion.links["coupler"].angle).max() < 1e-12
                assert np.abs(motion.links["coupler"].angular_velocity).max() < 1e-9
