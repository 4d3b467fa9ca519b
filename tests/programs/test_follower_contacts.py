"""Followers of profiles in compiled paths: their contacts are found by the program itself, where `solve` has them."""

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.model.cam_mechanism import cam_mechanism
from compoundkin.programs import call_seeds
from compoundkin.programs.follower_contacts import CurvePolynomials
from tests.catalog import mechanism as loaded

WORDS = ("position", "velocity", "acceleration")
TURN = 2.0 * np.pi


@pytest.fixture
def alone(monkeypatch):
    """Fail where any design is solved."""

    def refuse(*_):
        raise AssertionError("a design is solved")

    monkeypatch.setattr(call_seeds, "_solved_seeds", refuse)


def outputs_of(mechanism):
    return [f"{letter}.{word}" for letter in mechanism.carriers for word in WORDS]


def agree(found, motion, letters, size=None):
    """Hold positions and rates at a unit speed against those of a motion, by its size, or the largest of their kind."""
    np.testing.assert_array_equal(found.assembled, motion.assembled)
    for word in WORDS:
        wanted = {letter: getattr(motion.points[letter], word) for letter in letters}
        scale = size or max(np.nanmax(np.abs(one)) for one in wanted.values())
        for letter, one in wanted.items():
            np.testing.assert_allclose(found[f"{letter}.{word}"], one, rtol=0.0, atol=1e-12 * scale)


# the guide with the roller, the face on a guide and on a pin, the slot, two profiles on one shaft
@pytest.mark.parametrize(
    ("name", "free", "backend"),
    [
        ("disc-cam-roller-program", {"guide.offset": 0.5, "follower/cam.radius": 0.5}, "numpy"),
        ("flat-faced-follower", {}, None),
        pytest.param("oscillating-flat-follower", {"frame.H.x": 0.3}, "numpy", marks=pytest.mark.full),
        pytest.param("groove-cam-plate", {"guide.angle": 0.05}, "numpy", marks=pytest.mark.full),
        pytest.param("conjugate-cams", {}, "numpy", marks=pytest.mark.full),
    ],
)
@pytest.mark.usefixtures("alone")
def test_contacts_of_followers_are_found_without_solving_where_solve_has_them(name, free, backend):
    mechanism = loaded(name)
    path = ck.compile(mechanism, outputs_of(mechanism), free=[*free], backend=backend)
    known = {one.name: float(path.programs.stated.own(one)) for one in path.programs.dimensions}
    dimensions = {word: known[word] + change * np.array([[0.0], [1.0], [-0.7]]) for word, change in free.items()}
    values = np.ravel(ck.solve(mechanism, order=0).inputs.drives[mechanism.drives[0].name][0])
    arc = np.linspace(values[0], values[-1], 60)
    for course in (arc, arc[18] + 0.013):
        motion = ck.solve(path.mechanism(dimensions), course, speed=1.0, acceleration=0.5)
        agree(path(course, dimensions, speed=1.0, acceleration=0.5), motion, mechanism.carriers, motion.size)


def cam_with(profile, *items, roller=0.3, unit=1.0, offset=0.2):
    """Return a cam that lifts a roller on an upright guide beside its axis."""
    guide = ck.slide("follower", on="frame", at="P", through="A", angle=0.5 * np.pi, offset=offset * unit)
    return ck.Mechanism(
        "cam", ck.link("cam", A=0), guide, ck.cam("follower", on="cam", at="P", profile=profile, radius=roller * unit),
        ck.drive("cam", values=np.linspace(0.0, TURN, 73)), *items,
    )  # fmt: skip


FRAME, FOLLOWER = ck.link("frame", A=0), ck.link("follower", P=0)


@pytest.mark.parametrize(("corners", "unit"), [(3.0, 1e-5), pytest.param(5.0, 3e4, marks=pytest.mark.full)])
def test_a_roller_on_a_star_leaps_over_its_hollows_as_in_solve(corners, unit):
    s = np.linspace(0.0, TURN, 80, endpoint=False)
    star = ck.profiles.profile(unit * np.exp(1j * s) * (2.0 + 0.35 * np.cos(corners * s)))
    mechanism = cam_with(star, FRAME, FOLLOWER, unit=unit, roller=0.8)
    course = np.linspace(0.1, TURN, 90)
    path = ck.compile(mechanism, outputs_of(mechanism), backend="numpy")
    agree(path(course, speed=2.0), ck.solve(mechanism, course, speed=2.0), mechanism.carriers)


def test_a_follower_that_leaves_its_profile_is_not_assembled():
    arch = ck.profiles.profile(np.linspace(-1.0, 1.0, 9) + 1j * (2.0 - np.linspace(-1.0, 1.0, 9) ** 2), closed=False)
    mechanism = cam_with(arch, FRAME, FOLLOWER, roller=0.2)
    course = np.linspace(-1.2, 1.2, 31)
    with pytest.warns(ck.errors.UnassembledPoses):
        found = ck.compile(mechanism, ["P.position"], backend="numpy")(course)
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(mechanism, course)
    assert 0 < np.count_nonzero(found.assembled) < 31
    np.testing.assert_array_equal(found.assembled, motion.assembled)
    np.testing.assert_allclose(found["P.position"], motion.points["P"].position, rtol=0.0, atol=1e-12)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("bow", [-0.5, 0.5])
def test_a_turning_face_has_no_contact_in_a_hollow(bow):
    x = np.linspace(-1.0, 1.0, 9)
    arch = ck.profiles.profile(x + 1j * (2.0 + bow * x**2), closed=False)
    mechanism = ck.Mechanism(
        "arch", ck.link("frame", A=0, H=4 + 0.5j), ck.link("cam", A=0), ck.link("follower", H=0, P=-2.0),
        ck.face("follower", on="cam", at="P", profile=arch), ck.drive("cam"),
    )  # fmt: skip
    course = np.linspace(-0.4, 0.4, 9)
    motion = ck.solve(mechanism, course)
    assert motion.assembled.all() == (bow > 0.0)
    assert motion.assembled.any() == (bow > 0.0)
    np.testing.assert_array_equal(ck.compile(mechanism, "P", backend="numpy")(course).assembled, motion.assembled)


def test_a_design_without_the_inner_contact_of_its_path_is_solved():
    s = np.linspace(0.0, TURN, 160, endpoint=False)
    clover = ck.profiles.profile(np.exp(1j * s) * (2.0 + 0.9 * np.cos(3.0 * s)))
    mechanism = cam_with(clover, FRAME, FOLLOWER, roller=0.0, offset=1.15)
    course, hint = np.linspace(0.0, 0.2, 9), {"P": -1.15 + 0.6j}
    path = ck.compile(mechanism, "P.position", free="follower/frame.offset", hint=hint, backend="numpy")
    for offset in (1.15, 0.3):
        motion = ck.solve(path.mechanism({"follower/frame.offset": offset}), course, hint=hint)
        found = path(course, {"follower/frame.offset": offset})
        np.testing.assert_allclose(found["P.position"], motion.points["P"].position, rtol=0.0, atol=1e-12)


def test_a_dyad_behind_a_follower_keeps_the_side_that_solve_has():
    oval = ck.profiles.formula(lambda s: 2.0 * np.cos(s) + 1j * 1.6 * np.sin(s), 0.0, TURN)
    frame = ck.link("frame", A=0, D=4 + 3j)
    follower = ck.link("follower", B=1j, P=0)
    dyad = ck.link("coupler", B=0, C=3), ck.link("rocker", C=2.6, D=0), ck.mode(1, "coupler", "rocker")
    mechanism = cam_with(oval, frame, follower, *dyad)
    path = ck.compile(mechanism, outputs_of(mechanism), free="frame.D", backend="numpy")
    for place in (4 + 3j, 4 + 2.6j, 3.2 + 5.2j):
        for course in (np.array([2.0]), np.linspace(1.0, 5.0, 50)):
            motion = ck.solve(path.mechanism({"frame.D": place}), course, speed=2.0)
            agree(path(course, {"frame.D": place}, speed=2.0), motion, mechanism.carriers)


def test_a_dyad_behind_a_follower_goes_through_the_change_point_on_the_way_from_the_drawing():
    """It is stretched where the follower is highest, at a quarter turn, and there goes over to its other mode."""
    oval = ck.profiles.formula(lambda s: 2.0 * np.cos(s) + 1j * 1.6 * np.sin(s), 0.0, TURN)
    items = (
        ck.link("frame", A=0, D=1.3j), ck.link("cam", A=0, Q=1), ck.link("follower", P=0, B=1),
        ck.link("coupler", B=0, C=1), ck.link("rocker", C=1, D=0), ck.drive("cam"),
        ck.slide("follower", on="frame", at="P", through="A", angle=0.5 * np.pi),
        ck.cam("follower", on="cam", at="P", profile=oval, radius=0.3),
    )  # fmt: skip
    start = ck.solve(ck.Mechanism("stretched", *items, ck.mode(1, "coupler", "rocker")), [0.9])
    drawn = {letter: complex(point.position[0]) for letter, point in start.points.items()}
    mechanism = ck.Mechanism("stretched", *items, ck.drawn(**drawn))
    path = ck.compile(mechanism, "C.position", backend="numpy")
    for angle in (1.2, 2.4, 2.5, 1.3):
        wanted = ck.solve(mechanism, [angle]).points["C"].position
        assert (wanted[0].real > 0.0) == (angle > 0.5 * np.pi)
        np.testing.assert_allclose(path([angle])["C.position"], wanted, rtol=0.0, atol=1e-12)


@pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")
@pytest.mark.parametrize("kind", ["face", "roller"])
def test_a_contact_beyond_another_one_is_left_to_solve(kind):
    """Another wave of the profile is in the way of a face, and of a roller that leaves an open profile."""
    if kind == "face":
        s = np.linspace(0.0, TURN, 80, endpoint=False)
        profile = ck.profiles.profile(np.exp(1j * s) * (2.0 + 0.286 * np.cos(5.0 * s)))
        items = ck.link("follower", H=0), ck.face("follower", on="cam", at="H", profile=profile)
        course, pivot = np.linspace(0.0, TURN, 120), -2.97 + 2.53j
    else:
        x = np.linspace(-1.5, 1.5, 25)
        profile = ck.profiles.profile(x + 1j * (2.0 + 0.179 * np.cos(6.0 * x)), closed=False)
        items = ck.link("follower", H=0, P=2.281), ck.cam("follower", on="cam", at="P", profile=profile, radius=0.837)
        course, pivot = np.linspace(0.0, 0.8, 120), -3.213 - 1.121j
    mechanism = ck.Mechanism(
        kind, ck.link("frame", A=0, H=pivot), ck.link("cam", A=0), *items, ck.drive("cam"), ck.mode(1, "follower"),
    )  # fmt: skip
    path = ck.compile(mechanism, "follower.angle", backend="numpy")
    for values in (course, *course[::9, None]):
        wanted = ck.solve(mechanism, values).links["follower"].angle
        np.testing.assert_allclose(path(values)["follower.angle"], wanted, rtol=0.0, atol=1e-12)


def test_at_a_joint_of_pieces_accelerations_are_those_of_the_side_that_solve_takes():
    law = ck.laws.program(
        ck.laws.rise(0.3, over=1.4, law="parabolic"), ck.laws.dwell(over=0.6),
        ck.laws.fall(0.3, over=2.2, law="parabolic"), ck.laws.dwell(over=TURN - 4.2),
    )  # fmt: skip
    mechanism = cam_mechanism(ck.profiles.synthesise(law, base=1.2, follower="roller", roller=0.2, start=5.3))
    path = ck.compile(mechanism, "P.acceleration", backend="numpy")
    for joint in (0.0, 0.7, 1.4, 2.0, 3.1, 4.2):
        found, motion = path([5.3 + joint], speed=2.0), ck.solve(mechanism, [5.3 + joint], speed=2.0)
        np.testing.assert_allclose(found["P.acceleration"], motion.points["P"].acceleration, rtol=0.0, atol=1e-12)


@pytest.mark.usefixtures("alone")
def test_a_contact_at_the_first_sample_is_the_same_in_a_long_motion():
    path = ck.compile(loaded("oscillating-flat-follower"), "P.position", backend="numpy")
    whole, first = path(np.linspace(0.0, TURN, 1500)), path([0.0])
    np.testing.assert_allclose(whole["P.position"][[0, -1]], first["P.position"][0], rtol=0.0, atol=1e-12)


def test_polynomials_are_the_profile():
    law = ck.laws.program(ck.laws.rise(0.4, over=2.0), ck.laws.fall(0.4, over=2.0), ck.laws.dwell(over=TURN - 4.0))
    curve = ck.profiles.synthesise(law, base=1.0, follower="roller", roller=0.2).curve
    known = CurvePolynomials.of(curve)
    s = np.linspace(curve.low, curve.high, 500, endpoint=False) + 1e-3
    at = np.searchsorted(known.edges, s, side="right") - 1
    away = s - 0.5 * (known.edges[at] + known.edges[at + 1])
    assert known.are_exact
    np.testing.assert_allclose(np.polyval(known.coefficients[::-1, at], away), curve.at(s).c[0], rtol=0, atol=4e-15)
