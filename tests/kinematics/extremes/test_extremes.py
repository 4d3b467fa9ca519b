"""Extremes and zeros between poses, held against closed forms and against finer poses."""

from __future__ import annotations

import warnings
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import compoundkin as ck
from compoundkin.analysis.characteristics.outputs import chosen_outputs
from compoundkin.base.arrays import Number
from compoundkin.kinematics.extremes import between, extremes, zeros
from compoundkin.kinematics.quantities import quantity
from tests.catalog import THIRD, each, mechanism
from tests.catalog import motion as solved
from tests.support import examples

CRANK, ROD, OFFSET = 40.0, 120.0, -20.0
# The greatest velocity, acceleration and jerk of the standard laws, times lift / span^k. Source: R. L. Norton, Cam
# Design and Manufacturing Handbook, 2nd ed., table 3-2 and the laws' own formulas; parabolic: s = 2 u^2.
PEAKS = {
    "parabolic": (2.0, 4.0, 0.0),
    "harmonic": (np.pi / 2.0, np.pi**2 / 2.0, np.pi**3 / 2.0),
    "cycloidal": (2.0, 2.0 * np.pi, 4.0 * np.pi**2),
    "3-4-5": (15.0 / 8.0, 10.0 / np.sqrt(3.0), 60.0),
    "4-5-6-7": (35.0 / 16.0, 84.0 * np.sqrt(5.0) / 25.0, 52.5),
}
LIFT, SPAN, WAIT = 10.0, np.deg2rad(97.3), 0.3


def slider(step: float, **how: object) -> ck.results.Motion:
    crank = mechanism("slider-crank-offset")
    return ck.solve(crank, np.deg2rad(np.arange(0.0, 360.0 + step / 2, step)), **how)  # type: ignore[arg-type]


@pytest.mark.parametrize("step", [5.0, 7.5, 0.1])
def test_stroke_of_an_offset_slider_crank(step: float) -> None:
    """Stroke and dead points: the rod in line with the crank. Source: Norton, Design of Machinery, section 3.6."""
    found, rate = extremes(slider(step), "B.x", "B.speed")
    low, high = (np.sqrt((ROD + sign * CRANK) ** 2 - OFFSET**2) for sign in (-1.0, 1.0))
    assert np.allclose([found.least.value[0], found.greatest.value[0]], [low, high], rtol=1e-14)
    at = [np.arcsin(OFFSET / (ROD - CRANK)) + np.pi, np.arcsin(OFFSET / (ROD + CRANK)) + 2 * np.pi]
    places = [one.at.drives["crank"][0] for one in (found.least, found.greatest)]
    assert np.allclose(places, at, atol=1e-9)
    assert abs(rate.least.value[0]) < 1e-9 * rate.greatest.value[0]  # the length of a vector that passes zero
    dead = zeros(slider(step), "B.velocity.x")
    assert np.allclose(dead.at.drives["crank"], at, atol=1e-11)
    assert dead.sense.tolist() == [1.0, -1.0]


# Quantities of all orders, some lengths of vectors; of mechanisms whose driver turns.
SMOOTH = {
    "slider-crank-offset": ("B.x", "B.velocity.x", "B.acceleration.x", "rod.angle"),
    "crank-rocker": ("rocker.angle", "C.acceleration.length", "rocker.angular_acceleration", "C.jerk.length"),
    "six-bar": ("G.x", "bar.angle", "G.velocity.y", "G.acceleration.length"),
}
PARTS = {"slider-crank-offset": 72, "crank-rocker": 90, "six-bar": 120}


@pytest.mark.full
@settings(max_examples=examples(12))
@given(st.sampled_from(list(SMOOTH)), st.floats(-1.0, 1.0), st.integers(-8, -1))
@example("slider-crank-offset", 0.3, -2)
@example("slider-crank-offset", -0.3, -2)
def test_extremes_do_not_move_with_the_grid(name: str, part: float, exponent: int) -> None:
    """Poses a little beside each extreme in turn, to 1e-9 of the range in value and place, through the seam too.

    Within 0.005 of a pose the pose was reported for the vertex, its value too low by 1e-8 of the range.
    """
    turn, count, names = 2.0 * np.pi, PARTS[name], SMOOTH[name]

    def found(first: float) -> tuple[ck.results.Motion, list[tuple[float, float, float]]]:
        motion = ck.solve(mechanism(name), first + turn / count * np.arange(count + 1), speed=1.0)
        (driver,) = motion.drives
        return motion, [(end.value[0], end.at.drives[driver][0], one.stroke[0])
                        for one in extremes(motion, *names) for end in (one.least, one.greatest)]  # fmt: skip

    _, before = found(0.123)
    for k, (_, at, _) in enumerate(before):
        for ahead in (0, 20):
            _, after = found(at - (ahead + part * 10.0**exponent) * turn / count)
            value, place, range_ = after[k]
            assert abs(value - before[k][0]) < 1e-9 * range_, (names[k // 2], k % 2)
            away = abs(np.mod(place - at + 0.5 * turn, turn) - 0.5 * turn)
            assert away < 1e-9 * turn, (names[k // 2], k % 2, away)


@pytest.mark.parametrize("beside", [0.0, 1e-7, 1e-5, 1e-3, 0.003, 0.007])
def test_extremes_beside_poses_are_zeros_of_rates(beside: float) -> None:
    """The same places by the search for zeros of the rates: it knows no vertices."""
    crank, step = mechanism("crank-rocker"), np.deg2rad(4.0)
    places = zeros(ck.solve(crank, speed=1.0), "C.velocity.y").at.drives["crank"]
    for at in places:
        motion = ck.solve(crank, at - step * (10.0 + beside) + step * np.arange(91), speed=1.0)
        (found,) = extremes(motion, "C.y")
        dead = zeros(motion, "C.velocity.y").at.place
        ends = np.array([found.least.at.place[0], found.greatest.at.place[0]])
        # ends of a closed cycle are one place
        apart = np.mod(ends[:, None] - dead + 45.0, 90.0) - 45.0
        assert np.abs(apart).min(axis=1).max() < 1e-8


def programs(law: str) -> tuple[ck.laws.Law, ck.laws.Law]:
    """A rise and a fall in time, and over a turn of a cam; they begin and end between poses."""
    both = ck.laws.rise(LIFT, over=SPAN, law=law), ck.laws.dwell(WAIT), ck.laws.fall(LIFT, over=SPAN, law=law)
    first = ck.laws.dwell(2.0 * np.pi - 2.0 * SPAN - WAIT)
    return ck.laws.program(ck.laws.dwell(0.4), *both), ck.laws.program(first, *both)


@pytest.mark.parametrize("law", PEAKS)
def test_peaks_of_laws_on_both_sides_of_their_jumps(law: str) -> None:
    in_time, of_cam = programs(law)
    slide = ck.slide("block", on="frame", through="A", angle=0)
    block = ck.Mechanism("block", ck.link("frame", A=0), ck.link("block", B=0), slide, ck.drive("block", law=in_time))
    profile = ck.profiles.synthesise(of_cam, base=40, follower="roller", roller=5)
    cam = ck.Mechanism(
        "cam", ck.link("frame", A=0), ck.link("cam", A=0), ck.link("follower", P=0),
        ck.slide("follower", on="frame", through="A", angle=np.pi / 2),
        ck.cam("follower", on="cam", profile=profile, radius=5), ck.drive("cam"),
    )  # fmt: skip
    driven = ck.solve(block, time=np.linspace(0.0, in_time.period, 40))
    names = [f"{'block/frame'}.{word}" for word in ("rate", "second", "third")]
    lifted = ck.solve(cam, speed=1.0)
    for found in (extremes(driven, *names), extremes(lifted, "P.velocity.y", "P.acceleration.y", "P.jerk.y")):
        for k, (one, peak) in enumerate(zip(found, PEAKS[law], strict=True), 1):
            ends = np.array([-one.least.value[0], one.greatest.value[0]]) * SPAN**k / LIFT
            assert np.allclose(ends, peak, rtol=1e-8, atol=1e-8), (law, k, ends)


def shown(motion: ck.results.Motion) -> Iterator[str]:
    for name in chosen_outputs(motion):
        found = quantity(motion, name)
        yield from (f"{name}.{part}" for part in ("x", "y", "length")) if found.is_vector else (name,)


# Forces jump where their loads set in and let go, between the poses: what is least or greatest beside is less sure.
ONE_WAY = {"jaw-crusher-loaded", "shaper-cutting-force"}


@each(THIRD)
def test_extremes_do_not_depend_on_the_poses(name: str) -> None:
    """At the file's own step, and with four poses between every two: to 1e-6 of the range."""
    coarse = solved(name)
    names = tuple(shown(coarse))
    fine = finer(coarse, 5)
    close = 1e-5 if name in ONE_WAY else 1e-6
    for one, other in zip(extremes(coarse, *names), extremes(fine, *names), strict=True):
        # what is constant has rounding for its range: next to change points some eleven digits are right
        size = max(abs(other.greatest.value[0]), abs(other.least.value[0]), 1.0)
        range_ = max(other.stroke[0], 1e-4 * size)
        for a, b in ((one.least, other.least), (one.greatest, other.greatest)):
            assert abs(a.value[0] - b.value[0]) <= close * range_, (one.name, a.value, b.value)


def finer(motion: ck.results.Motion, parts: int) -> ck.results.Motion:
    last = motion.inputs.poses - 1
    s = np.linspace(0.0, last, last * parts + 1)
    values = {name: np.interp(s, np.arange(last + 1), np.broadcast_to(drive.value, motion.shape))
              for name, drive in motion.drives.items()}  # fmt: skip
    with warnings.catch_warnings(action="ignore"):
        if motion.time is not None:
            return ck.solve(motion.mechanism, time=np.interp(s, np.arange(last + 1), motion.time))
        return ck.solve(motion.mechanism, values)


def test_a_motion_between_is_the_motion_at_its_poses() -> None:
    for name in ("six-bar", "parallelogram", "oscillating-roller-follower", "class-iii-six-bar", "sun-and-planet"):
        whole = solved(name)
        places = np.arange(whole.inputs.poses)[::-1]
        table = between(whole, 0, places).table()
        for column in whole.table().columns:
            if column.name in table.names:
                values: Number = table[column.name].values
                size = max(1.0, np.nanmax(np.abs(column.values)))
                assert np.allclose(values, column.values[::-1], rtol=0, atol=1e-11 * size, equal_nan=True), column.name


def test_designs_gaps_and_still_drivers() -> None:
    with warnings.catch_warnings(action="ignore"):
        rods = ck.solve(_slider(np.array([[100.0], [120.0]])), speed=0.0, order=0)
        rocker = ck.solve(mechanism("triple-rocker"), np.deg2rad(np.arange(-180.0, 181.0, 5.0)))
    (found,) = extremes(rods, "B.x")
    stroke = [np.subtract(*(np.sqrt((rod + s * CRANK) ** 2 - OFFSET**2) for s in (1, -1))) for rod in (100.0, 120.0)]
    assert np.allclose(found.stroke, stroke, rtol=1e-13)
    angle, rate = extremes(rocker, "rocker.angle", "rocker.angular_velocity")
    # the rocker's rate grows without limit towards both limit positions
    assert np.isinf([rate.least.value[0], rate.greatest.value[0]]).all()
    assert np.isfinite([angle.least.value[0], angle.greatest.value[0]]).all()


def _slider(rod: Number) -> ck.Mechanism:
    return ck.Mechanism(
        "sliders", ck.link("frame", O=0, H=1j * OFFSET), ck.link("crank", O=0, A=CRANK), ck.link("rod", A=0, B=rod),
        ck.link("piston", B=0), ck.slide("piston", on="frame", through="H", angle=0), ck.drive("crank"),
    )  # fmt: skip


def test_what_has_no_extremes_says_so() -> None:
    one = ck.solve(mechanism("crank-rocker"), {"crank": [1.0]})
    with pytest.raises(ck.errors.InvalidInput, match="a single pose has no extremes"):
        extremes(one, "rocker.angle")
    with pytest.raises(ck.errors.InvalidInput, match=r"C.velocity.x or C.velocity.y"):
        extremes(solved("crank-rocker"), "C.velocity")
    with pytest.raises(ck.errors.UnknownName, match="rocker"):
        zeros(solved("crank-rocker"), "rokcer.angle")
    with pytest.raises(ck.errors.InvalidInput, match="99 is no place"):
        between(solved("crank-rocker"), 0, [99.0])


def test_a_pole_exactly_at_a_pose_is_without_limit_on_both_sides() -> None:
    # at the dead points 0 and 180 degrees, which are poses, the piston's rate changes sign
    (found,) = extremes(solved("slider-crank"), "stroke.advantage")
    assert found.least.value == -np.inf
    assert found.greatest.value == np.inf


def test_the_greatest_rate_of_a_motion_that_mostly_rests_is_finite() -> None:
    from compoundkin.model.cam_mechanism import cam_mechanism

    lift = ck.laws.program(
        ck.laws.rise(0.4, over=1.4),
        ck.laws.dwell(over=0.6),
        ck.laws.fall(0.4, over=2.2),
        ck.laws.dwell(over=2.0 * np.pi - 4.2),
    )
    cam = cam_mechanism(ck.profiles.synthesise(lift, base=1.6, follower="roller", roller=0.3))
    motion = ck.solve(cam, np.linspace(4.0, 2.0 * np.pi + 0.75, 20), speed=1.0)
    assert np.mean(np.abs(motion.points["P"].velocity) < 1e-9) > 0.5
    # the greatest rate of a cycloidal rise is twice the mean
    assert ck.quantity(motion, "P.velocity.length.greatest").values[0] == pytest.approx(0.8 / 1.4, rel=1e-9)
    studied = ck.study(cam, {"follower/cam.radius": (0.2, 0.3)}, ["P.velocity.length.greatest"],
                       count=4, values=np.linspace(4.0, 2.0 * np.pi + 0.75, 20), speed=1.0)  # fmt: skip
    found = studied.run()["P.velocity.length.greatest"]
    assert np.allclose(found, 0.8 / 1.4, rtol=0.05, atol=0.0)


def test_beside_a_gap_ranges_are_those_between_the_poses_too() -> None:
    """What grows without limit at the ends of a gap does not hide the least value elsewhere."""
    path = ck.compile(mechanism("six-bar"), ["bar.angle"], free=["frame.B.x"])
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(path.mechanism({"frame.B.x": 24.0}))
    speed, turning = extremes(motion, "G.velocity.length", "slot.coriolis.length")
    (place,) = zeros(motion, "bar.angular_velocity").at.place
    for found in (speed, turning):
        assert found.least.value[0] == pytest.approx(0.0, abs=1e-6)
    assert speed.least.at.place[0] == pytest.approx(place, abs=1e-6)
