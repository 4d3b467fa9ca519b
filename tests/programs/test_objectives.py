"""Objectives of compiled paths and their gradients against `solve` and its central differences."""

import warnings

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.kinematics.quantities import quantity
from tests.catalog import mechanism as loaded

ANGLES = np.deg2rad(np.linspace(10.0, 340.0, 7))
STEP = 1e-6


def with_points(mechanism, places):
    """The mechanism with some points elsewhere: numbers, or columns of designs."""
    for name, place in places.items():
        link, _, letter = name.partition(".")
        mechanism = mechanism.replace(ck.link(link, **{**mechanism.links[link].points, letter: place}))
    return mechanism


def places_of(mechanism, names):
    """Where points are in the mechanism as it stands."""
    return {name: complex(mechanism.geometry.points[name.partition(".")[0]][name.partition(".")[2]]) for name in names}


def differences(mechanism, at, name, cost):
    """The slope of a sum over the poses by a point, from four changed mechanisms solved at once."""
    here = at[name] + STEP * np.array([[1.0], [-1.0], [1j], [-1j]])
    east, west, north, south = cost(with_points(mechanism, {**at, name: here}))
    return (east - west) / (2.0 * STEP) + 1j * (north - south) / (2.0 * STEP)


@pytest.mark.parametrize(
    ("name", "out", "free"),
    [
        ("six-bar", ["G.velocity", "G", "bar.angle"], ["crank.D", "plate.C", "plate.A", "frame.F"]),
        ("crank-rocker", ["C", "C.acceleration"], ["crank.B", "coupler.C", "frame.D"]),
        ("slider-crank", ["B", "B.velocity"], ["crank.A", "rod.B"]),
    ],
)
def test_a_gradient_is_that_of_changed_mechanisms(name, out, free):
    """Values to 1e-12 and slopes to 1e-7 of what `solve` gives, for two designs with targets of their own."""
    mechanism = loaded(name)
    free = [each for each in free if each.partition(".")[2] in mechanism.links[each.partition(".")[0]].points]
    path = ck.compile(mechanism, out, free=free)
    drive = mechanism.drives[0].name
    target = np.array([1.0 + 2.0j, -0.5j])[:, None] + np.cos(ANGLES)
    base = places_of(mechanism, free)
    shift = {each: place + abs(place) * np.array([0.0, 0.01 - 0.02j]) for each, place in base.items()}

    def function(at):
        first, second = at[out[0]], at[out[1]]
        return (
            at["weight"] * abs(first - at["target"]) ** 2 + abs(second) / (1.0 + at["weight"]) - (first * second).imag
        )

    cost = path.objective(function)
    rates = {"speed": 2.0, "acceleration": 0.5}
    given = {"target": target, "weight": 0.3}
    value, slope = cost.gradient({drive: ANGLES}, {k: v[:, None] for k, v in shift.items()}, **rates, **given)
    assert (value.shape, set(slope)) == ((2,), set(free))
    np.testing.assert_array_equal(
        value, cost({drive: ANGLES}, {k: v[:, None] for k, v in shift.items()}, **rates, **given)
    )
    for d in range(2):
        at = {each: complex(place[d]) for each, place in shift.items()}

        def summed(changed, d=d):
            motion = ck.solve(changed, {drive: ANGLES}, **rates)
            seen = {each: quantity(motion, each).values for each in out}
            return np.sum(function({**seen, "target": target[d], "weight": 0.3}), axis=-1)

        np.testing.assert_allclose(value[d], summed(with_points(mechanism, at)), rtol=1e-12)
        size = max(abs(each[d]) for each in slope.values())
        for each in free:
            np.testing.assert_allclose(slope[each][d], differences(mechanism, at, each, summed), atol=1e-7 * size)


def test_poses_that_are_not_assembled_are_left_out_where_masked():
    """The sum of what is assembled and its slope, one design of it wholly; NaN for a design with gaps else."""
    mechanism = loaded("crank-rocker")
    path = ck.compile(mechanism, "C", free=["coupler.C", "frame.D"])
    whole = np.deg2rad(np.arange(0.0, 360.0, 9.0))
    places = {"coupler.C": np.array([[5.0 + 0j], [2.2 + 0j]])}
    masked = path.objective(lambda at: np.where(at.assembled, abs(at["C"] - at["target"]) ** 2, 0.0))
    plain = path.objective(lambda at: abs(at["C"] - at["target"]) ** 2)
    value, slope = masked.gradient({"crank": whole}, places, target=5.0 + 4.0j)
    with pytest.warns(ck.errors.UnassembledPoses, match="1 of 2 designs"):
        told, other = plain.gradient({"crank": whole}, places, target=5.0 + 4.0j)
    assert np.isnan([told[1], other["coupler.C"][1].real, other["coupler.C"][1].imag]).all()
    assert np.isfinite(value).all()
    assert (told[0], other["coupler.C"][0]) == (value[0], slope["coupler.C"][0])

    def summed(changed):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
            motion = ck.solve(changed, {"crank": whole})
        assert 0 < motion.assembled[0].sum() < len(whole)
        return np.nansum(abs(motion.points["C"].position - (5.0 + 4.0j)) ** 2, axis=-1)

    at = {"coupler.C": 2.2 + 0j, "frame.D": 5.5 + 0j}
    np.testing.assert_allclose(value[1], summed(with_points(mechanism, {k: np.array([[v]]) for k, v in at.items()}))[0])
    for each in at:
        np.testing.assert_allclose(slope[each][1], differences(mechanism, at, each, summed), rtol=1e-6)


@pytest.mark.parametrize(
    "function",
    [
        lambda x: x**-3 + x**2.5 + x**-1.5 + x**40 + x**0,
        lambda x: np.tanh(20.0 * (x - 1.1)) + np.log10(x) + np.reciprocal(x) + np.fabs(1.0 - x),
        lambda x: np.clip(x, 1.0, 1.2) + np.clip(x, None, 1.1) + np.degrees(x) + np.radians(x),
    ],
)
def test_functions_of_numbers_are_those_of_numpy(function):
    """Values and slopes of an objective, by NumPy itself and its differences."""
    path = ck.compile(loaded("crank-rocker"), "rocker.angle", free="coupler.C.x")
    own = float(path.programs.stated.own(path.programs.dimensions[0]))
    value, slope = path.objective(lambda at: function(at["rocker.angle"])).gradient(ANGLES)
    less, here, more = (
        function(path(ANGLES, {"coupler.C.x": own + away})["rocker.angle"]).sum() for away in (-STEP, 0.0, STEP)
    )
    np.testing.assert_allclose(value, here, rtol=1e-12)
    np.testing.assert_allclose(slope["coupler.C.x"], (more - less) / (2.0 * STEP), rtol=1e-6)


def test_what_is_chosen_where_its_root_is_real_has_slopes_once_it_is_clipped():
    """As the page on compiled programs advises: a root that is none elsewhere would leave no slope."""
    path = ck.compile(loaded("crank-rocker"), "rocker.angle", free="coupler.C.x")
    least = float(np.median(path(ANGLES)["rocker.angle"])) + 1e-3
    cost = path.objective(
        lambda at: np.where(at["rocker.angle"] > least, np.sqrt(np.maximum(at["rocker.angle"] - least, 0.0)), 0.0)
    )
    own = float(path.programs.stated.own(path.programs.dimensions[0]))
    less, more = (float(cost(ANGLES, {"coupler.C.x": own + away})) for away in (-STEP, STEP))
    np.testing.assert_allclose(cost.gradient(ANGLES)[1]["coupler.C.x"], (more - less) / (2.0 * STEP), rtol=1e-6)


def test_slips_in_objectives_are_told():
    """Each with its place and remedy, by the errors of the package."""
    path = ck.compile(loaded("crank-rocker"), ["C", "rocker.angle"], free="coupler.C")
    cost = path.objective(lambda at: abs(at["C"] - at["target"]) ** 2)
    with pytest.raises(ck.errors.UnknownName, match=r"tragt.*did you mean 'target'"):
        cost([0.1], target=1.0, tragt=2.0)
    with pytest.raises(ck.errors.UnknownName, match="target: it is neither an output"):
        cost([0.1])
    with pytest.raises(ck.errors.InvalidInput, match=r"target: shape .* does not broadcast"):
        cost([0.1, 0.2], target=[1.0, 2.0, 3.0])
    with pytest.raises(ck.errors.InvalidInput, match="target"):
        cost([0.1], target="x")
    with pytest.raises(ck.errors.InvalidInput, match=r"target: .*not finite"):
        cost([0.1], target=np.nan)
    for name in ("rocker.angle", "assembled"):
        with pytest.raises(ck.errors.InvalidInput, match=f"{name}: the pose has this name itself"):
            path.objective(lambda at, name=name: at[name])([0.1], **{name: 1.0})
    for wrong, told in (
        (lambda at: at["C"], "complex"),
        (lambda at: 1.0 if at["rocker.angle"] > 0 else 0.0, "truth value"),
        (lambda at: np.any(at["rocker.angle"] > 0), "all poses"),
        (lambda at: np.sin(at["C"]), "sin"),
        (lambda at: at["rocker.angle"] ** 0.3, "whole powers"),
        (lambda at: abs(at["C"] ** 0.5), "roots of real numbers"),
        (lambda at: at["C"] > 0.0, "vectors have no order"),
        (lambda at: np.fft.fft(at["C"]), "cannot be recorded"),
        (lambda at: at["C"].mean(), "cannot be recorded"),
        (lambda at: "x", "cannot be recorded"),
        (lambda at: None, "cannot be recorded"),
        (lambda: 0.0, "cannot be recorded"),
    ):
        with pytest.raises(ck.errors.InvalidInput, match=told):
            path.objective(wrong)([0.1])


def test_sensitivities_are_those_of_changed_mechanisms():
    """Slopes of all outputs at every pose by points, and by the driver, with its rates kept."""
    mechanism = loaded("six-bar")
    out, base = ["G.acceleration", "bar.angular_velocity"], places_of(mechanism, ["plate.C", "crank.D"])
    rates = {"speed": 2.0, "acceleration": 0.5}
    found = ck.compile(mechanism, out, free=list(base)).derivatives({"crank": ANGLES}, **rates)

    def solved(changed, angles=ANGLES):
        motion = ck.solve(changed, {"crank": angles}, **rates)
        return {each: quantity(motion, each).values for each in out}

    steps = {"x": STEP * np.array([[1.0], [-1.0]]), "y": STEP * np.array([[1j], [-1j]])}
    for name, place in base.items():
        for part, step in steps.items():
            ends = solved(with_points(mechanism, {**base, name: place + step}))
            for each in out:
                slope = (ends[each][0] - ends[each][1]) / (2.0 * STEP)
                np.testing.assert_allclose(found[each, f"{name}.{part}"], slope, atol=1e-7 * abs(slope).max())
    ends = solved(mechanism, ANGLES + STEP * np.array([[1.0], [-1.0]]))
    for each in out:
        slope = (ends[each][0] - ends[each][1]) / (2.0 * STEP)
        np.testing.assert_allclose(found[each, "crank"], slope, atol=1e-7 * abs(slope).max())
        np.testing.assert_allclose(found[each], solved(mechanism)[each], rtol=1e-11)
    assert found.by == ("plate.C.x", "plate.C.y", "crank.D.x", "crank.D.y", "crank")
    some = ck.compile(mechanism, out, free=list(base)).derivatives({"crank": ANGLES}, by=["plate.C", "crank"], **rates)
    assert some.by == ("plate.C.x", "plate.C.y", "crank")
    assert set(some) == {*out, *((each, by) for each in out for by in some.by)}
    assert (out[0], "crank") in some
    assert (out[0], "crank.D.x") not in some
    np.testing.assert_array_equal(some[out[0], "plate.C.y"], found[out[0], "plate.C.y"])
    with pytest.raises(ck.errors.UnknownName, match=r"did you mean 'plate.C.[xy]'"):
        found["G.acceleration", "plate.C.z"]


# Between them all kinds of pairs and groups, with all their dimensions: points, angles, offsets, turns, radii, phases.
EVERY_KIND = {
    "whitworth-quick-return": 8,  # blocks in slots
    "rack-driven-double-slider": 12,  # racks
    "geared-five-bar": 8,  # gears with phases
    "belt-coupled-cranks": 8,  # belts
    "rolling-wheel": 8,
    "geneva-wheel": 8,  # pins in slots
    "oldham-coupling": 8,  # cross slides
    "hydraulic-crane": 8,  # cylinders
    "cam-return-spring": 8,  # discs
    "flat-faced-follower": 8,  # profiles, whose contact is found outside
    "sun-and-planet": 4,  # counted turns
    "class-iii-six-bar": 4,  # groups without a closed form
}
# What changes how wheels fit together.
FITTED = ("teeth", "radii", "module", "pressure_angle", "radius")


@pytest.mark.parametrize("name", EVERY_KIND)
def test_slopes_by_every_kind_of_dimension(name):
    """Each at three poses against `solve` of mechanisms that differ in one dimension, all solved at once."""
    mechanism = loaded(name)
    whole = ck.compile(mechanism, next(iter(mechanism.carriers)))
    known = [
        one for one in whole.programs.stated.known.values() if one.word not in FITTED and one.part not in ("x", "y")
    ]
    free = [one for one in known if not one.is_of_link] + [one for one in known if one.is_of_link]
    free = free[: EVERY_KIND[name]]
    out = [f"{point}.{word}" for point in mechanism.carriers for word in ("position", "velocity")]
    path = ck.compile(mechanism, out, free=[one.name for one in free], backend="numpy")
    driven = path.programs.reference.inputs.drives
    values = {each: (np.ravel(v[0])[3] + np.array([0.013, 0.2, 0.31])) for each, v in driven.items()}
    speed = dict.fromkeys(values, 1.3)
    found = path.derivatives(values, speed=speed, by=None)
    by = [each for each in found.by if each not in values]
    step = {each: STEP * (1.0 if each.endswith(("angle", "turn")) else mechanism.geometry.size) for each in by}
    places = {}
    for one in free:
        place = np.full((2 * len(by), 1), path.programs.stated.own(one), dtype=complex if one.is_vector else float)
        for k, each in enumerate(by):
            if each.removesuffix(".x").removesuffix(".y") == one.name:
                change = step[each] * (1j if one.is_vector and each.endswith(".y") else 1.0)
                place[2 * k : 2 * k + 2] += change * np.array([[1.0], [-1.0]])
        places[one.name] = place
    modes = {path.programs.reference.structure.groups[k].links[0]: sign for k, sign in path.programs.signs.items()}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        motion = ck.solve(path.mechanism(places), values, speed=speed, modes=modes)
    for each in out:
        ends = quantity(motion, each).values
        size = max(abs(ends).max(), mechanism.geometry.size)
        for k, word in enumerate(by):
            slope = (ends[2 * k] - ends[2 * k + 1]) / (2.0 * step[word])
            size_of = size if word.endswith(("angle", "turn")) else size / mechanism.geometry.size
            np.testing.assert_allclose(found[each, word], slope, atol=1e-7 * max(size_of, abs(slope).max()))


def test_a_gradient_is_the_sum_of_slopes_at_every_pose():
    """Reverse equals forward to 1e-12: points, numbers, and groups that march along the motion."""
    for name, free in (("whitworth-quick-return", ["slot.angle"]), ("class-iii-six-bar", [])):
        mechanism = loaded(name)
        link = next(iter(mechanism.rigid_links.values()))
        point = f"{link.name}.{next(iter(link.points))}"
        output = f"{next(reversed(mechanism.carriers))}.velocity"
        path = ck.compile(mechanism, output, free=[*free, point])
        values = {each: np.ravel(v[0])[:25] for each, v in path.programs.reference.inputs.drives.items()}
        speed = dict.fromkeys(values, 1.3)
        _, slope = path.objective(lambda at, o=output: abs(at[o] - at["target"]) ** 2).gradient(
            values, speed=speed, target=1.0 + 2.0j
        )
        found = path.derivatives(values, speed=speed)
        for each in (*free, f"{point}.x", f"{point}.y"):
            chained = np.sum(2.0 * ((found[output] - (1.0 + 2.0j)).conj() * found[output, each]).real)
            part = (
                slope[point].real if each.endswith(".x") else slope[point].imag if each.endswith(".y") else slope[each]
            )
            scale = np.sum(abs(found[output] - (1.0 + 2.0j)) * abs(found[output, each]))
            assert abs(part - chained) <= 1e-12 * max(scale, 1e-300)


@pytest.mark.parametrize("name", ["parallelogram", "antiparallelogram"])
def test_slopes_go_on_beyond_change_points(name):
    """Slopes by the driver are velocities at unit speed, as solve has them; a gradient sums the slopes of all poses."""
    mechanism = loaded(name)
    angles = np.deg2rad(np.arange(5.0, 720.0, 13.0))
    path = ck.compile(mechanism, "C", free=["coupler.C", "follower.D"])
    found = path.derivatives(angles)
    velocity = ck.solve(mechanism, angles, speed=1.0, modes=path.modes).points["C"].velocity
    np.testing.assert_allclose(found["C", "crank"], velocity, rtol=1e-10, atol=1e-10 * abs(velocity).max())
    target = 20.0 + 30.0j
    _, slope = path.objective(lambda at: abs(at["C"] - at["target"]) ** 2).gradient(angles, target=target)
    for each, parts in slope.items():
        summed = [np.sum(2.0 * ((found["C"] - target).conj() * found["C", f"{each}.{x}"]).real) for x in "xy"]
        np.testing.assert_allclose(parts, complex(*summed), rtol=1e-10)


def test_a_distance_that_is_zero_has_the_slope_zero():
    """Where the least of a distance is reached its slope is no number; none is given for it, as for any least."""
    path = ck.compile(loaded("crank-rocker"), ["C", "C.x"], free="coupler.C")
    target = path(ANGLES)["C"]
    value, slope = path.objective(lambda at: abs(at["C"] - at["target"])).gradient(ANGLES, target=target)
    assert (float(value), complex(slope["coupler.C"])) == (0.0, 0j)
