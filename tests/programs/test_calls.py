"""Calls of compiled paths: what they take and tell, quickly or slowly, in the form that `solve` has."""

from __future__ import annotations

import contextlib
import copy
import pickle

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import InvalidInput, LikelySlip, UnknownName
from compoundkin.kinematics.curve.change_points import NEAR
from compoundkin.programs.limit_screening import LimitScreening
from compoundkin.programs.path_programs import PathPrograms
from tests.catalog import mechanism as loaded
from tests.test_wrong_objects import WRONG

OUTPUTS = ["G.position", "G.acceleration", "bar.angle"]
CRANK = np.linspace(0.3, 7.0, 200)
COLUMN = np.array([[14.0 + 0j], [13.5 + 0.5j], [14.2 - 0.3j]])


@pytest.fixture(scope="module")
def path():
    return ck.compile(loaded("six-bar"), OUTPUTS, free=["crank.D", "plate.A.y"])


@pytest.fixture(scope="module")
def arm():
    upper, fore = ck.link("upper", A=0, B=2), ck.link("fore", B=0, P=1)
    arm = ck.Mechanism("arm", ck.link("frame", A=0), upper, fore, ck.drive("upper"), ck.drive("fore", on="upper"))
    return ck.compile(arm, ["P", "P.velocity"], free="fore.P")


def solved(motion, name):
    if name.startswith("bar"):
        return motion.links["bar"].angle
    return np.asarray(getattr(motion.points["G"], name.partition(".")[2]))


@pytest.mark.parametrize(
    ("dimensions", "rates"),
    [
        ({}, {}),
        ({"crank.D": 14.1}, {"speed": 10.0}),
        ({"crank.D": COLUMN}, {"speed": 10, "acceleration": 2.0}),
        ({"crank.D": COLUMN, "plate.A.y": COLUMN.imag + 0.1}, {"speed": 0.0}),
        ({"plate.A.y": -0.2, "crank.D": (14.0, 0.2)}, {"speed": 10 + CRANK}),
        ({"crank.D": 14.0 + 0.01j * CRANK}, {"speed": {"crank": 2.0}}),
    ],
)
def test_a_call_is_what_solve_finds_of_the_mechanism_with_its_dimensions(path, dimensions, rates):
    motion = ck.solve(path.mechanism(dimensions), CRANK, modes=path.modes, **rates)
    for values in (CRANK, {"crank": CRANK}, CRANK.tolist()):
        found = path(values, dimensions, **rates)
        assert found.shape == motion.shape
        for name in OUTPUTS:
            expected = solved(motion, name)
            np.testing.assert_allclose(found[name], expected, atol=1e-11 * np.abs(expected).max(), rtol=0)


@pytest.mark.filterwarnings("ignore")
def test_one_driver_stands_while_another_comes_to_a_limit():
    path = ck.compile(loaded("five-bar"), [f"{point}.velocity" for point in loaded("five-bar").carriers], free=[])
    one, two = (drive.name for drive in loaded("five-bar").drives)
    values = {one: np.linspace(0.0, 6.0, 40), two: np.linspace(0.0, 5.0, 7)[:, None]}
    found, motion = path(values), ck.solve(loaded("five-bar"), values, modes=path.modes)
    np.testing.assert_array_equal(found.assembled, motion.assembled)
    assert 0 < np.count_nonzero(found.assembled) < found.assembled.size
    for name in path.names:
        solved = np.asarray(motion.points[name.partition(".")[0]].velocity)
        np.testing.assert_allclose(found[name], solved, rtol=1e-9, atol=1e-9)


def test_a_configuration_without_a_name_is_given_itself():
    mechanism = loaded("class-iii-six-bar")
    path = ck.compile(mechanism, [f"{point}.position" for point in mechanism.carriers])
    values = np.ravel(path.programs.reference.inputs.drives[mechanism.drives[0].name][0])[5:20]
    found, motion = path(values), ck.solve(path.mechanism(), values, modes=path.modes)
    for name in path.names:
        np.testing.assert_allclose(found[name], motion.points[name.partition(".")[0]].position, atol=1e-11)


def test_defaults_are_those_of_solve(path, arm):
    np.testing.assert_allclose(path()["G.position"], ck.solve(loaded("six-bar")).points["G"].position, atol=1e-12)
    values, rates = {"upper": CRANK}, {"fore": 2.0}
    motion = ck.solve(arm.mechanism(), {**values, "fore": CRANK[:, None]}, speed=rates)
    found = arm({**values, "fore": CRANK[:, None]}, speed=rates)
    np.testing.assert_allclose(found["P.velocity"], motion.points["P"].velocity, atol=1e-12)


def test_driver_values_along_several_axes_of_designs(path):
    values = np.linspace(0.1, 1.0, 4) + np.array([0.0, 0.3])[:, None, None]
    column = 14.0 + np.array([[0.0], [0.5]]) + 0j
    motion = ck.solve(path.mechanism({"crank.D": column}), values, modes=path.modes)
    np.testing.assert_allclose(
        path(values, {"crank.D": column})["G.position"], solved(motion, "G.position"), atol=1e-11
    )
    assert path(np.ones((2, 3, 4)))["bar.angle"].shape == (2, 3, 4)


def test_drivers_with_laws_move_in_time():
    law = ck.laws.program(ck.laws.rise(1.0, over=2.0))
    crank = ck.Mechanism("m", ck.link("frame", A=0), ck.link("crank", A=0, B=2), ck.drive("crank", law=law))
    path = ck.compile(crank, ["B", "B.acceleration"], free="crank.B")
    for given in ({}, {"time": np.linspace(0.0, 1.5, 9)}, {"time": [0.5]}):
        motion = ck.solve(crank, **given)
        np.testing.assert_allclose(path(**given)["B.acceleration"], motion.points["B"].acceleration, atol=1e-12)
    assert path([0.1, 0.2])["B"].shape == (2,)


def test_results_are_written_into_arrays_given(path):
    made = {"G.position": np.empty((3, 200), complex), "bar.angle": np.empty((3, 200))}
    found, expected = path(CRANK, {"crank.D": COLUMN}, out=made), path(CRANK, {"crank.D": COLUMN})
    for name, array in made.items():
        assert np.shares_memory(found[name], array)
        np.testing.assert_array_equal(array, expected[name])
    np.testing.assert_array_equal(found["G.acceleration"], expected["G.acceleration"])


def test_results_of_an_earlier_call_take_those_of_a_later_one(path):
    earlier, expected = path(CRANK, speed=1.0), path(CRANK, speed=2.0)
    array = earlier["G.acceleration"]
    found = path(CRANK, speed=2.0, out=earlier)
    for name in OUTPUTS:
        assert np.shares_memory(found[name], earlier[name])
        np.testing.assert_array_equal(found[name], expected[name])
    assert np.shares_memory(found["G.acceleration"], array)
    with pytest.raises(InvalidInput, match=r"its shape is \(200,\), that of the call \(199,\)"):
        path(CRANK[1:], speed=2.0, out=earlier)
    # a speed that is constant fills no array that could be written pose by pose
    resting = ck.compile(loaded("six-bar"), ["crank.angular_velocity", "G"])(CRANK, speed=2.0)
    with pytest.raises(InvalidInput):
        path(CRANK, out=resting)


@pytest.mark.parametrize(
    ("out", "text"),
    [
        ({"G": np.empty(200, complex)}, "out.G: there is no such output; known: G.position, "),
        ({"G.position": np.empty(200)}, "out.G.position: an array of float64 is not an array of complex128"),
        ({"bar.angle": np.empty(199)}, "out.bar.angle: its shape is (199,), that of the call (200,)"),
        ({"bar.angle": np.empty(400)[::2]}, "it cannot be written, or is not contiguous"),
        ({"bar.angle": [0.0] * 200}, "is not an array of float64"),
        ([], "out: [] is no table by name"),
        (dict.fromkeys(["G.position", "G.acceleration"], np.empty(200, complex)), "it is in the memory of out.G.pos"),
    ],
)
def test_arrays_that_cannot_hold_results_are_told(path, out, text):
    with pytest.raises(InvalidInput) as told:
        path(CRANK, out=out)
    assert text in str(told.value)


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"values": {"crnk": CRANK}}, "values.crnk: there is no driver 'crnk'; did you mean 'crank'?"),
        ({"values": np.array([0.0, np.nan])}, "crank: the value is empty or not finite"),
        ({"values": np.array([0.0, np.inf])}, "crank: the value is empty or not finite"),
        ({"values": []}, "crank: the value is empty or not finite"),
        ({"values": "round"}, "a text is no number"),
        ({"values": CRANK, "dimensions": {"crank.D": np.ones((3, 7))}}, "shape (3, 7) does not broadcast with (200,)"),
        (
            {"values": CRANK, "dimensions": {"crank.D": COLUMN * np.nan}},
            "dimensions.crank.D: the value is empty or not",
        ),
        ({"values": CRANK, "dimensions": {"plate.A.y": 1j}}, "plate.A.y: complex numbers are no real ones"),
        ({"values": CRANK, "dimensions": {"plate.C": 1.0}}, "this dimension is not free; compile("),
        ({"values": CRANK, "speed": np.nan}, "crank: the value is empty or not finite"),
        ({"values": CRANK, "speed": {"bar": 1.0}}, "there is no driver 'bar'"),
        ({"values": CRANK, "threads": 0}, "threads: 0 is not a number of threads"),
        ({"values": CRANK, "threads": 1.5}, "threads: 1.5 is not a number of threads"),
        ({"values": CRANK, "speed": 10**400}, "crank: int(...) is not a number or an array of numbers"),
        ({"values": CRANK, "dimensions": {"plate.A.y": 10**400}}, "plate.A.y: int(...) is not a number or an array"),
        ({"values": CRANK, "dimensions": CRANK}, "is no table by name"),
        ({"time": [np.inf]}, "time"),
    ],
)
def test_what_does_not_fit_is_told(path, given, text):
    with pytest.raises(InvalidInput) as told:
        path(**given)
    assert text in str(told.value)


def test_values_without_a_margin_that_they_could_spoil_are_held_too():
    crank = ck.Mechanism("m", ck.link("frame", A=0), ck.link("crank", A=0, B=2), ck.drive("crank"))
    for value in (np.nan, np.inf):
        with pytest.raises(InvalidInput, match="not finite"):
            ck.compile(crank, "B")(np.array([0.0, value]))


@pytest.mark.parametrize("speed", [3.0, np.array(3.0)])  # a quick call, and one that is not
def test_what_is_found_does_not_change_with_the_arrays_that_were_given(path, speed):
    values, column = CRANK.copy(), COLUMN.copy()
    found, own = path(values, {"crank.D": column}, speed=speed), path(values, speed=speed)
    values += 1.0
    column *= 0.9
    np.testing.assert_allclose(found.motion(1).points["G"].position[0], found["G.position"][1], atol=1e-10)
    np.testing.assert_allclose(own.motion().points["G"].position[0], own["G.position"], atol=1e-10)


@pytest.mark.parametrize("name", ["class-iii-six-bar", "flat-faced-follower"])
def test_what_is_searched_does_not_change_with_the_values_that_were_given_either(name):
    mechanism = loaded(name)
    point = [*mechanism.carriers][-1]
    path = ck.compile(mechanism, f"{point}.position", backend="numpy")
    for _ in range(2):  # read in full, and by its plan
        values = np.linspace(0.3, 0.9, 20)
        found = path(values)
        values += 1.0
        (position,) = found.motion().points[point].position
        np.testing.assert_allclose(position, found[f"{point}.position"], atol=1e-10 * np.abs(position).max())


@pytest.mark.parametrize("poses", [200, 5000])
def test_results_may_be_written_over_the_values_that_were_given(poses):
    path, values = ck.compile(loaded("six-bar"), ["G.x", "G.y"]), np.linspace(0.3, 7.0, poses)
    expected = path(values, speed=2.0)
    for _ in range(2):  # read in full, and by its plan
        whole = np.concatenate([values, values])
        for given, out in ((whole[:poses], whole[:poses]), (whole[:poses], whole[3 : poses + 3])):
            given[:] = values
            found = path(given, speed=2.0, out={"G.x": out, "G.y": np.empty(poses)})
            for name in expected:
                np.testing.assert_array_equal(found[name], expected[name])
            np.testing.assert_allclose(found.motion().points["G"].position[0].real, out, atol=1e-10)


def test_several_drivers_go_by_name(arm):
    with pytest.raises(InvalidInput, match="there is more than one driver"):
        arm(CRANK)
    with pytest.raises(InvalidInput, match="there are several drivers"):
        arm({"upper": CRANK}, speed=2.0)


def test_values_that_look_like_degrees_are_warned_of(path):
    with pytest.warns(LikelySlip, match="look like degrees"):
        path(np.arange(0.0, 361.0, 5.0))


def test_designs_of_the_mechanism_itself_are_to_be_free():
    crank = ck.Mechanism("m", ck.link("frame", A=0), ck.link("crank", A=0, B=COLUMN), ck.drive("crank"))
    with pytest.raises(InvalidInput, match=r"crank.B: it has several values: .*; compile\(..., free=\['crank.B'\]\)"):
        ck.compile(crank, "B")
    np.testing.assert_allclose(ck.compile(crank, "B", free="crank.B")([0.0, 0.0])["B"], COLUMN + np.zeros(2))


def test_compile_tells_what_it_does_not_take():
    bar = loaded("crank-rocker")
    with pytest.raises(InvalidInput, match="outputs: no output is named"):
        ck.compile(bar, [])
    with pytest.raises(InvalidInput, match="backend: there is no back end 'fortran'"):
        ck.compile(bar, "B", backend="fortran")
    with pytest.raises(UnknownName):
        ck.compile(bar, "nothing")


def test_what_is_found_goes_by_name(path):
    found = path(CRANK)
    assert list(found) == OUTPUTS
    assert [values.shape for values in found.values()] == [(200,)] * 3
    with pytest.raises(UnknownName, match=r"bar\.angles: there is no such output; did you mean 'bar.angle'"):
        found["bar.angles"]


def test_a_path_is_copied_and_pickled(path):
    assert copy.deepcopy(path) is copy.copy(path) is path
    other = pickle.loads(pickle.dumps(path))
    np.testing.assert_array_equal(other(CRANK)["G.position"], path(CRANK)["G.position"])
    assert (other.names, other.free, other.modes) == (path.names, path.free, path.modes)
    assert (
        repr(other)
        == "CompiledPath('Six-bar of Example 3-4': G.position, G.acceleration, bar.angle of crank.D, plate.A.y)"
    )


def test_results_are_pickled_for_other_processes(path):
    given = {"crank.D": COLUMN}
    for found in (path(CRANK, given), path(CRANK, given, speed=2.0)):
        other = pickle.loads(pickle.dumps(found))
        for name, values in found.items():
            np.testing.assert_array_equal(other[name], values)
        np.testing.assert_array_equal(other.assembled, found.assembled)
        solved = [each.motion(design=1).points["G"].position for each in (other, found)]
        np.testing.assert_array_equal(*solved)
    slopes = path.derivatives(CRANK)
    other = pickle.loads(pickle.dumps(slopes))
    np.testing.assert_array_equal(other["bar.angle", "plate.A.y"], slopes["bar.angle", "plate.A.y"])
    cost = path.objective(_height)
    sums = cost(CRANK)
    other = pickle.loads(pickle.dumps(cost))
    assert other(CRANK) == sums
    assert (
        repr(other)
        == "PathObjective('Six-bar of Example 3-4': G.position, G.acceleration, bar.angle by crank.D, plate.A.y)"
    )


def _height(at):
    return at["G.position"].imag


def test_results_do_not_depend_on_threads(path):
    one, two = (path(CRANK, {"crank.D": COLUMN}, threads=threads)["G.acceleration"] for threads in (1, 2))
    np.testing.assert_array_equal(one, two)


@pytest.mark.filterwarnings("ignore")
def test_wrong_objects_in_a_call_are_refused_by_errors_of_the_package():
    path = ck.compile(loaded("crank-rocker"), ["C", "rocker.angle"], free=["crank.B", "rocker.C.x"])
    given = {"values": 1.0, "dimensions": {}, "speed": 1.0, "acceleration": 0.0, "jerk": 0.0, "time": None, "out": {}}
    tried = [(key, wrong, {**given, key: wrong}) for key in (*given, "threads") for wrong in WRONG]
    for wrong in WRONG:
        tried += [(key, wrong, {**given, "dimensions": {key: wrong}}) for key in ("crank.B", "rocker.C.x")]
        tried += [(key, wrong, {**given, "out": {key: wrong}}) for key in ("C", "rocker.angle")]
    offenders = []
    for key, wrong, arguments in tried:
        try:
            path(**arguments)
        except ck.errors.CompoundkinError:
            pass
        except Exception as error:
            offenders.append(f"{key}={wrong!r:.40}: {type(error).__name__}: {str(error)[:80]}")
    assert not offenders, "\n".join(offenders)


FORMS = {
    "array": (CRANK, {}),
    "one pose": (0.7, {}),
    "list": (CRANK.tolist(), {}),
    "by name": ({"crank": CRANK}, {"speed": {"crank": 2.0}}),
    "number of NumPy": (np.array(0.7), {"speed": np.float64(2.0), "acceleration": 0}),
    "designs": (CRANK, {"dimensions": {"crank.D": COLUMN, "plate.A.y": 0.1}}),
    "axes of designs": (CRANK + np.array([0.0, 0.1])[:, None, None], {"dimensions": {"crank.D": COLUMN}, "speed": 3.0}),
    "time": (0.2, {"time": np.linspace(0.0, 1.0, 40), "speed": 2.0, "acceleration": 0.3}),
    "uniform motion": (0.2, {"time": np.linspace(0.0, 1.0, 40), "speed": 2.0}),
    "a point as a pair": (CRANK, {"dimensions": {"crank.D": (14, np.float64(0.1)), "plate.A.y": 0.1}}),
    "many poses": (np.linspace(0.3, 7.0, 5000), {"speed": 2.0}),
}


@pytest.mark.parametrize("form", FORMS)
def test_a_call_by_its_plan_is_that_which_was_read_in_full(form):
    values, more = FORMS[form]
    path = ck.compile(loaded("six-bar"), OUTPUTS, free=["crank.D", "plate.A.y"])
    first = path(values, **more)
    (plan,) = path.programs.plans.known
    second, motion = path(values, **more), path(values, **more).motion()
    assert path.programs.plans.known == (plan,)
    for name in OUTPUTS:
        np.testing.assert_array_equal(second[name], first[name])
        one = first[name].reshape(-1, first.shape[-1] if first.shape else 1)[0]
        np.testing.assert_allclose(solved(motion, name).ravel(), one, atol=1e-11 * np.abs(one).max(), rtol=0)


def test_numbers_of_a_known_form_are_held_to_what_they_must_be(path):
    column, times = COLUMN.copy(), np.linspace(0.0, 1.0, 9)
    for _ in range(2):
        path(CRANK, {"crank.D": column}, speed=2.0)
        path(0.1, time=times)
    for given in ({"values": CRANK * np.nan}, {"speed": np.inf}, {"dimensions": {"crank.D": column * np.nan}}):
        with pytest.raises(InvalidInput, match="not finite"):
            path(**{"values": CRANK, "dimensions": {"crank.D": column}, "speed": 2.0, **given})
    with pytest.raises(InvalidInput, match="not finite"):
        path(0.1, time=times * np.nan)
    with pytest.warns(LikelySlip, match="look like degrees"):
        path(np.arange(200.0) * 5.0, {"crank.D": column}, speed=2.0)
    # a rate that is zero in one call of a form and not in the next
    resting, moving = (path(CRANK, {"crank.D": column}, speed=speed)["G.acceleration"] for speed in (0.0, 2.0))
    assert np.all(resting == 0.0)
    assert np.all(moving != 0.0)


def test_sums_by_a_plan_are_those_that_were_read_in_full(path):
    cost = path.objective(lambda at: abs(at["G.position"] - at["target"]) ** 2)
    target = path(CRANK)["G.position"] + 1.0
    for aim in (target, target.real):
        (one, slopes), (two, again) = (cost.gradient(CRANK, {"crank.D": 14.1}, target=aim) for _ in range(2))
        assert one == two == cost(CRANK, {"crank.D": 14.1}, target=aim)
        assert slopes == again
        step = 1e-6
        beside = [cost(CRANK, {"crank.D": 14.1 + d}, target=aim) for d in (step, -step)]
        np.testing.assert_allclose(slopes["crank.D"].real, (beside[0] - beside[1]) / (2.0 * step), rtol=1e-6)
    with pytest.raises(InvalidInput, match="target: the value is empty or not finite"):
        cost(CRANK, {"crank.D": 14.1}, target=target * np.nan)
    with pytest.raises(UnknownName, match="aim"):
        cost(CRANK, {"crank.D": 14.1}, aim=target)


@pytest.mark.parametrize("poses", [4096, 5003])
def test_many_poses_are_those_of_few(path, poses):
    crank = np.linspace(0.3, 6.0, poses)
    whole, parts = path(crank, speed=2.0), [path(part, speed=2.0) for part in np.array_split(crank, 7)]
    for name in OUTPUTS[:2]:
        np.testing.assert_array_equal(whole[name], np.concatenate([part[name] for part in parts]))
    # one step that is too long for a margin is found among many
    far = crank.copy()
    far[poses // 2 :] += 2.0
    motion = ck.solve(path.mechanism(), far, modes=path.modes)
    np.testing.assert_allclose(path(far)["G.position"], motion.points["G"].position, atol=1e-11)
    assert path(far).screened is not None
    assert whole.screened is None


def test_one_pose_after_another_is_known_to_be_clear(monkeypatch):
    mechanism = loaded("six-bar")
    path = ck.compile(mechanism, OUTPUTS, free=["crank.D"])
    looks = looked_at(monkeypatch)
    for point in (14.0, 13.5):
        looks.clear()
        for value in np.linspace(0.2, 9.0, 40):
            found = path(value, {"crank.D": point})
            motion = ck.solve(path.mechanism({"crank.D": point}), value, modes=path.modes)
            np.testing.assert_allclose(found["G.position"], solved(motion, "G.position").item(), atol=1e-11)
        # the approach to the first pose, which may be read in full first, then how far this design is clear both ways
        assert len(looks) <= 4


def looked_at(monkeypatch):
    """Return the approaches whose margins are looked at from now on."""
    looks = []
    margins_on = LimitScreening._margins_on
    monkeypatch.setattr(LimitScreening, "_margins_on", lambda *given: looks.append(given[-1]) or margins_on(*given))
    return looks


@pytest.mark.parametrize("name", ["crank-rocker", "crank-shaper", "hand-pump"])
def test_one_motion_after_another_beside_the_drawing_is_known_to_be_clear(name, monkeypatch):
    mechanism = loaded(name)
    (drive,), letter = mechanism.drives, list(mechanism.carriers)[-1]
    path = ck.compile(mechanism, letter)
    home = float(path.programs.approach.drawn(drive.name))
    unit = 1.0 if path.programs.reference.structure.driven_angles[drive.name] else 0.02 * path.programs.reference.size
    looks = looked_at(monkeypatch)
    for begin in (0.2, 0.3, -0.5, 0.25, -0.4):
        values = home + unit * (begin + np.linspace(0.0, 0.15, 9))
        found = path(values)
        motion = ck.solve(mechanism, values, modes=path.modes)
        np.testing.assert_allclose(found[letter], motion.points[letter].position, atol=1e-11 * motion.size)
    # the first is read in full, the second is looked at, and then how far the design is clear
    assert len(looks) <= 6


@pytest.mark.parametrize("name", ["balanced-lamp", "klann-leg", "peaucellier", "windscreen-wiper"])
def test_poses_near_a_limit_are_computed_where_no_change_point_is_passed_on_the_way(name, monkeypatch):
    mechanism = loaded(name)
    (drive,), letters = mechanism.drives, list(mechanism.carriers)
    path = ck.compile(mechanism, letters)
    own = float(np.ravel(path.programs.reference.inputs.drives[drive.name][0])[0])
    poses = [own + step for step in (0.0, 1e-4, 0.01)]
    monkeypatch.setattr(PathPrograms, "solve", lambda *_, **__: pytest.fail("a design is solved"))
    found = [path(value) for value in poses]
    monkeypatch.undo()
    for value, one in zip(poses, found, strict=True):
        way = path.programs.approach.values({drive.name: np.array([[value]])})
        assert path.programs.limits._margins_on(one.numbers, way).min() < NEAR
        motion = ck.solve(mechanism, value)
        for letter in letters:
            np.testing.assert_allclose(one[letter], motion.points[letter].position, atol=1e-9 * motion.size)


@pytest.mark.parametrize("name", ["five-bar", "five-bar-led", "excavator-arm", "pantograph"])
@pytest.mark.filterwarnings("ignore")
def test_a_pose_of_several_drivers_is_that_of_solve(name):
    mechanism = loaded(name)
    letter = list(mechanism.carriers)[-1]
    path = ck.compile(mechanism, letter)
    own, angles = path.programs.reference, path.programs.reference.structure.driven_angles
    start = {drive.name: float(np.ravel(own.inputs.drives[drive.name][0])[0]) for drive in mechanism.drives}
    rng = np.random.default_rng(7)
    several = 0
    for _ in range(25):
        values = {
            key: one + rng.uniform(-0.6, 0.6) * (1.0 if angles[key] else 0.2 * own.size) for key, one in start.items()
        }
        found, assembled = path(values), False
        with contextlib.suppress(ck.errors.NotAssembled):
            motion = ck.solve(mechanism, values)
            assembled = bool(np.all(motion.assembled))
        assert bool(found.assembled) == assembled
        if assembled:
            several += 1
            np.testing.assert_allclose(found[letter], motion.points[letter].position, atol=1e-10 * motion.size)
            # the same looked at along the drivers' path, as motions are
            approach = path.programs.approach
            columns = {key: np.array([[value]]) for key, value in values.items()}
            straight = approach.values(columns)
            whole = approach.values({key: np.repeat(value, 2, axis=1) for key, value in columns.items()})
            for key in straight:
                for end in (0, -1):
                    assert straight[key][0, end] == pytest.approx(whole[key][0, end], abs=1e-9)
    assert several >= 5


def test_the_way_from_the_drawing_is_the_shortest_one():
    path = ck.compile(loaded("crank-rocker"), "C")
    approach = path.programs.approach
    drawn = float(approach.drawn("crank"))
    rng = np.random.default_rng(4)
    for _ in range(300):
        first, last = drawn + rng.uniform(-9.0, 9.0, 2)
        values = np.linspace(first, last, 5)[None] if abs(last - first) < 6.0 else np.array([[first]])
        if approach.is_passed({"crank": values}):
            continue
        way = approach.way({"crank": values})
        # any turn of the drawing, to any of the values
        turns = drawn + 2.0 * np.pi * np.arange(-4, 5)
        shortest = np.abs(values.ravel()[:, None] - turns).min()
        assert abs(way.far) == pytest.approx(shortest, abs=1e-12)
        assert np.sin(0.5 * (way.home - drawn)) == pytest.approx(0.0, abs=1e-12)
        assert np.abs(values - way.values["crank"][0, -1]).min() < 1e-12


@pytest.mark.filterwarnings("ignore")
def test_poses_beyond_a_limit_are_not_taken_for_clear_ones():
    mechanism = loaded("double-rocker")
    (drive,) = mechanism.drives
    path = ck.compile(mechanism, [f"{point}.position" for point in mechanism.carriers])
    for value in [*np.linspace(-3.2, 3.2, 33), 0.5]:
        found, assembled = path(value), False
        with contextlib.suppress(ck.errors.NotAssembled):
            motion = ck.solve(mechanism, {drive.name: value}, modes=path.modes)
            assembled = bool(np.all(motion.assembled))
        assert bool(found.assembled) == assembled
        for name in path.names if assembled else ():
            np.testing.assert_allclose(
                found[name], motion.points[name.partition(".")[0]].position, atol=1e-9 * motion.size
            )


@pytest.mark.filterwarnings("ignore")
def test_poses_beyond_a_gap_are_computed_without_solving(monkeypatch):
    mechanism = loaded("geared-five-bar")
    path = ck.compile(mechanism, [f"{point}.position" for point in mechanism.carriers], backend="numpy")
    way = np.linspace(float(path.programs.approach.drawn("crank")), 2.0, 60)
    solved = {value: ck.solve(mechanism, [value]) for value in (2.0, -4.59)}
    assert not np.all(ck.solve(mechanism, way).assembled)
    monkeypatch.setattr(PathPrograms, "solve", lambda *_: pytest.fail("a design is solved"))
    for value, motion in solved.items():
        for name, found in path([value]).items():
            wanted = motion.points[name.partition(".")[0]].position
            np.testing.assert_allclose(found, wanted, rtol=0.0, atol=1e-12 * motion.size)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", ["parallelogram", pytest.param("roberts-cognates", marks=pytest.mark.full)])
def test_change_points_of_a_design_are_searched_once(monkeypatch, name):
    mechanism = loaded(name)
    path = ck.compile(mechanism, [f"{point}.velocity" for point in mechanism.carriers], backend="numpy")
    # poses at change points and next to them, the ways to single poses, both senses, another turn
    courses = [np.linspace(0.0, 2.0 * np.pi, 49), np.array([4.0]), np.linspace(4.4, -0.2, 30), np.array([8.9])]
    motions = [ck.solve(mechanism, course, speed=2.0) for course in courses]
    # of whole turns both ways where the design is asked for again, farther than before
    path(np.linspace(2.0, 4.0, 9)), path(courses[0])
    monkeypatch.setattr(
        "compoundkin.kinematics.solution.pass_through", lambda *_: pytest.fail("change points are searched")
    )
    for course, motion in zip(courses, motions, strict=True):
        for key, found in path(course, speed=2.0).items():
            wanted = motion.points[key.partition(".")[0]].velocity
            np.testing.assert_allclose(found, wanted, rtol=0.0, atol=1e-9 * motion.size)


def test_single_poses_beyond_a_change_point_on_the_way_are_in_the_mode_of_solve():
    """Asked for again and again, so that what is known of the way from the drawing counts."""
    mechanism = loaded("parallelogram")
    path = ck.compile(mechanism, [f"{point}.position" for point in mechanism.carriers], backend="numpy")
    for value in (1.0, 4.0, 4.1, 1.1, 4.2, -0.5):
        motion = ck.solve(mechanism, [value])
        for name, found in path([value]).items():
            wanted = motion.points[name.partition(".")[0]].position
            np.testing.assert_allclose(found, wanted, rtol=0.0, atol=1e-9 * motion.size)
