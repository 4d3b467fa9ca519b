"""Numbers of driving laws as free dimensions: calls, slopes and gradients against `solve` of the changed mechanism."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import compoundkin as ck
from compoundkin import laws
from compoundkin.base.errors import InvalidInput, InvalidMechanism, UnassembledPoses, UnknownName
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.laws.law_numbers import law_numbers, law_slopes, law_with
from tests.catalog import mechanism as loaded

# No pose lies on a corner of the laws.
TIMES = np.linspace(0.013, 2.27, 29)
LIFT = laws.program(laws.rise(1.2, over=1.0), laws.dwell(0.4), laws.fall(0.7, over=0.9, law="4-5-6-7"), start=0.3)
QUICK = laws.program(
    laws.rise(1.0, law="least-time", speed=2.0, acceleration=9.0, jerk=60.0),
    laws.fall(1.4, over=0.7, law="modified-trapezoid"),
    repeat=True,
)
OUTPUTS = ["G.position", "G.velocity", "G.acceleration", "bar.angle"]


def driven(law, name="six-bar", driver="crank"):
    return loaded(name).replace(ck.drive(driver, law=law))


def differences(of, number):
    """Differences of the fourth power of the step of something that depends on a number."""
    step = 2e-3 * max(abs(number), 0.1)
    wide, narrow = ((of(number + h) - of(number - h)) / (2.0 * h) for h in (2.0 * step, step))
    return (4.0 * narrow - wide) / 3.0


def close(found, expected, part):
    np.testing.assert_allclose(found, expected, rtol=0, atol=part * max(1.0, np.max(np.abs(expected))))


def test_slopes_of_a_rise_are_those_of_its_formula():
    h, span = 1.2, 2.5
    t = np.linspace(0.0, span, 41)
    law = laws.program(laws.rise(h, over=span), start=0.3)
    # s = h (x - sin(2 pi x) / (2 pi)), x = t / T
    w, turn = 2.0 * np.pi / span, 2.0 * np.pi * t / span
    by_rise = [t / span - np.sin(turn) / (2 * np.pi), (1 - np.cos(turn)) / span, w * np.sin(turn) / span]
    by_span = [
        -h * t / span**2 * (1 - np.cos(turn)),
        -h / span**2 * (1 - np.cos(turn) + turn * np.sin(turn)),
        -h * w / span**2 * (2 * np.sin(turn) + turn * np.cos(turn)),
    ]
    for name, slopes in {"segments.0.rise": by_rise, "segments.0.over": by_span, "start": [1.0, 0.0, 0.0]}.items():
        for found, slope in zip(law_slopes(law, name, t, 2), slopes, strict=True):
            close(found, np.broadcast_to(slope, t.shape), 1e-12)


@pytest.mark.parametrize("law", [LIFT, QUICK, laws.constant_acceleration(0.7, speed=2.0, start=0.1)])
def test_slopes_of_laws_are_their_differences(law):
    times = TIMES * 3.0 if law is QUICK else TIMES
    for name, number in law_numbers(law).items():

        def moved(value, name=name):
            series = law_with(law, {name: value}).coordinate(times, 3)
            return np.array([np.broadcast_to(series.derivative(k), times.shape) for k in range(3)])

        found = np.array([np.broadcast_to(slope, times.shape) for slope in law_slopes(law, name, times, 2)])
        expected, scale = differences(moved, number), np.max(np.abs(moved(number)))
        # differences over a corner are none
        good = np.abs(found - expected) < 1e-6 * max(scale, np.max(np.abs(expected)))
        assert good.mean() > 0.9, name
        assert good[0].all(), name


def test_slopes_where_a_law_is_not_smooth_are_none():
    law = laws.program(laws.rise(1.0, law="least-time", speed=2.0, acceleration=4.0))  # just reaches its speed
    assert np.isnan(law_slopes(law, "segments.0.speed", TIMES, 1)[0]).all()
    assert "segments.0.over" not in law_numbers(law)
    faster = law_with(law, {"segments.0.acceleration": 16.0})
    assert faster.period == laws.least_time(1.0, speed=2.0, acceleration=16.0).period


@pytest.mark.parametrize(
    "law", [LIFT, laws.constant_speed(1.3, start=0.2), laws.constant_acceleration(0.0, speed=1.0, start=0.2)]
)
def test_calls_and_slopes_are_those_of_the_mechanism_with_another_law(law):
    free = [f"crank.law.{name}" for name in law_numbers(law)]
    path = ck.compile(driven(law), OUTPUTS, free=[*free, "plate.C.x"], values=[0.3])
    stated = path.programs.stated
    given = {
        free[0]: stated.own(stated.known[free[0]]) + 0.05,
        "plate.C.x": 1.02 * stated.own(stated.known["plate.C.x"]),
    }
    found = path.derivatives(None, given, time=TIMES)
    for name in path.free:
        own = given.get(name, stated.own(stated.known[name]))

        def at(value, name=name):
            motion = ck.solve(path.mechanism({**given, name: value}), time=TIMES, modes=path.modes)
            return [quantity(motion, output).values for output in OUTPUTS]

        for k, output in enumerate(OUTPUTS):
            close(path(None, given, time=TIMES)[output], at(own)[k], 1e-12)
            close(found[output, name], differences(lambda value, k=k: at(value)[k], own), 2e-7)


def test_designs_have_laws_of_their_own():
    path = ck.compile(driven(LIFT), OUTPUTS, free=["crank.law.segments.0.rise", "crank.law.start", "plate.C"])
    rises, starts = np.array([[1.2], [1.0], [0.8]]), np.array([[0.3], [0.2], [0.4]])
    given = {"crank.law.segments.0.rise": rises, "crank.law.start": starts}
    found = path(None, given, time=TIMES)
    sloped = path.derivatives(None, given, time=TIMES)
    target = np.array([1.0 + 1.0j])
    cost = path.objective(lambda at: abs(at["G.velocity"] - at["target"]) ** 2 + at["bar.angle"])
    value, slope = cost.gradient(None, given, time=TIMES, target=target)
    for k in range(3):
        own = {name: float(column[k, 0]) for name, column in given.items()}
        motion = ck.solve(path.mechanism(own), time=TIMES)
        close(found["G.acceleration"][k], motion.points["G"].acceleration, 1e-12)
        assert found.motion(k).mechanism.drives[0].law.segments[0].rise == rises[k, 0]
        alone, slopes = cost.gradient(None, own, time=TIMES, target=target)
        close(value[k], alone, 1e-12)
        for name in path.free:
            close(slope[name][k], slopes[name], 1e-12)
    for name in given:
        velocity, angle = sloped["G.velocity", name], sloped["bar.angle", name]
        whole = 2.0 * (np.conj(found["G.velocity"] - target) * velocity).real + angle
        close(slope[name], whole.sum(axis=1), 1e-12)


def test_constant_laws_of_designs_are_those_of_a_mechanism_of_designs():
    path = ck.compile(driven(laws.constant_speed(1.0)), "G.velocity", free=["crank.law.speed"], values=[0.0])
    given = {"crank.law.speed": np.array([[1.0], [2.0]])}
    close(
        path(None, given, time=TIMES)["G.velocity"],
        ck.solve(path.mechanism(given), time=TIMES).points["G"].velocity,
        1e-12,
    )


def test_the_mechanisms_own_times_are_those_of_the_changed_law():
    path = ck.compile(driven(LIFT), "G.velocity", free="crank.law.segments.0.over")
    given = {"crank.law.segments.0.over": 1.3}
    motion = ck.solve(path.mechanism(given))
    assert motion.time[-1] == pytest.approx(2.6, abs=1e-12)
    close(path(None, given)["G.velocity"], motion.points["G"].velocity, 1e-12)
    with pytest.raises(InvalidInput, match="time"):
        path(None, {"crank.law.segments.0.over": np.array([[1.0], [1.3]])})


def test_a_general_group_follows_a_law():
    mechanism = loaded("stephenson-ii")
    driver = mechanism.drives[0].name
    start = float(np.ravel(ck.solve(mechanism, order=0).inputs.drives[driver][0])[0])
    law = laws.program(laws.rise(0.1, over=2.5), start=start)
    output, name, times = f"{list(mechanism.carriers)[-1]}.velocity", f"{driver}.law.segments.0.rise", TIMES[::4]
    path = ck.compile(mechanism.replace(ck.drive(driver, law=law)), output, free=name)

    def at(rise):
        return quantity(ck.solve(path.mechanism({name: rise}), time=times), output).values

    expected = differences(at, 0.1)
    assert np.max(np.abs(expected)) > 0.1
    close(path.derivatives(time=times)[output, name], expected, 1e-7)


def test_lost_poses_of_designs_stay_lost():
    lever = ck.Mechanism(
        "m",
        ck.link("frame", A=0, D=3),
        ck.link("crank", A=0, B=2),
        ck.link("rod", B=2, C=2 + 2j),
        ck.link("rocker", D=3, C=2 + 2j),
        ck.drive("crank", law=laws.program(laws.rise(1.0, over=2.3), start=0.2)),
    )
    path = ck.compile(lever, "C", free=["crank.law.segments.0.rise"])
    rises = np.array([[1.0], [3.5]])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnassembledPoses)
        found = path.derivatives(None, {path.free[0]: rises}, time=TIMES)
        cost = path.objective(lambda at: np.where(at.assembled, at["C"].real, 0.0))
        value, slope = cost.gradient(None, {path.free[0]: rises}, time=TIMES)
    for k in range(2):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            motion = ck.solve(path.mechanism({path.free[0]: float(rises[k, 0])}), time=TIMES, modes=path.modes)
        np.testing.assert_array_equal(found.assembled[k], motion.assembled)
        close(value[k], np.nansum(motion.points["C"].x), 1e-12)
        close(slope[path.free[0]][k], np.nansum(found["C", path.free[0]][k].real), 1e-12)
    assert found.assembled[0].all()
    assert not found.assembled[1].all()


def test_mistakes_are_told():
    path = ck.compile(driven(LIFT), "G", free=["crank.law.start", "crank.law.segments.0.over"])
    with pytest.raises(UnknownName, match=r"crank\.law\.start"):
        ck.compile(driven(LIFT), "G", free="crank.law.stort")
    with pytest.raises(UnknownName, match=r"segments.1.rise.*no such dimension"):
        ck.compile(driven(LIFT), "G", free="crank.law.segments.1.rise")  # a dwell
    for law in (laws.time_table([0, 1, 2], [0, 0.1, 0.3]), lambda t: 0.1 * t):
        assert not any(".law." in name for name in ck.compile(driven(law), "G", values=[0.3]).programs.stated.known)
    with pytest.raises(InvalidInput, match="values are given"):
        path([0.3], {"crank.law.start": 0.4})
    with pytest.raises(InvalidInput, match="along the motion"):
        path(None, {"crank.law.start": TIMES}, time=TIMES)
    with pytest.raises(InvalidInput, match="not a span"):
        path(None, {"crank.law.segments.0.over": -1.0}, time=TIMES)
    with pytest.raises(InvalidMechanism):
        path.mechanism({"crank.law.segments.0.over": -1.0})
    np.testing.assert_array_equal(path.derivatives([0.3, 0.4])["G", "crank.law.start"], 0.0)
