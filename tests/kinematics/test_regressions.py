"""Failures that were found by trying to break things, each under its own name."""

import warnings
from pathlib import Path

import numpy as np
import pytest

import compoundkin as ck

FOUR_BAR = ck.Mechanism(
    "Four-bar",
    ck.link("frame", A=(0, 0), D=(7, 0)),
    ck.link("crank", A=0, B=4),
    ck.link("coupler", B=0, C=5),
    ck.link("rocker", D=0, C=3),
    ck.drive("crank"),
)


def test_both_components_of_an_unassembled_pose_are_not_a_number():
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(FOUR_BAR, {"crank": ck.deg([0.0, 80.0, 120.0])})
    assert motion.assembled.tolist() == [True, True, False]
    for array in (motion.points["C"].y, motion.points["C"].x, motion.points["C"].velocity.xy[:, 1]):
        assert np.isnan(array).tolist() == [False, False, True]
    assert np.isnan(motion.links["rocker"].angle[2])
    assert motion.drives["crank"].value[2] == ck.deg(120.0)


def test_two_letters_drawn_at_one_place_show_no_direction():
    good = ck.drawn(A=(0, 0), B=(0, 0), C=(3, 4))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        motion = ck.solve(FOUR_BAR.replace(good), {"crank": 0.5})
    assert motion.points["C"].position.imag > 0


def test_a_guide_toward_its_own_point_is_refused():
    mechanism = ck.Mechanism(
        "Guide without direction",
        ck.link("frame", A=0),
        ck.link("crank", A=0, B=1, Z=0),
        ck.link("block", S=0),
        ck.slide("block", on="crank", through="A", toward="Z"),
        ck.drive("crank"),
        ck.drive("block", on="crank", values=1.0),
    )
    with pytest.raises(ck.errors.InvalidMechanism, match="no direction"):
        ck.solve(mechanism)


def test_the_only_driver_needs_no_name():
    assert np.array_equal(ck.solve(FOUR_BAR, [0.1, 0.2]).drives["crank"].value, [0.1, 0.2])


@pytest.mark.parametrize(
    ("mechanism", "options"),
    [
        (FOUR_BAR, {"order": 2.0}),
        (FOUR_BAR, {"modes": -1}),
        (FOUR_BAR, {"modes": {"crank": 1}}),
        (FOUR_BAR, {"modes": {"coupler": 1, "rocker": -1}}),
        (FOUR_BAR, {"hint": {"C": (0, np.nan)}}),
        ("six-bar", {}),
    ],
)
def test_mistakes_of_a_call_are_told(mechanism, options):
    with pytest.raises(ck.errors.InvalidInput):
        ck.solve(mechanism, **options)


def test_outputs_of_what_there_is_not_are_found_at_once():
    items = [*FOUR_BAR.items, ck.expect("Q.velocity", 1.0, 0.1)]
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        ck.Mechanism("m", *items, outputs=("Z.x", "C.x", "crank.angle"))
    assert [problem.where for problem in caught.value.problems] == ["outputs[0]", "expected[0].quantity"]


@pytest.mark.parametrize("quantity", ["rocker", "C", "C.value"])
def test_a_published_number_says_whether_it_is_an_angle(quantity):
    with pytest.raises(ck.errors.InvalidMechanism, match="does not say of what kind"):
        FOUR_BAR.replace(ck.expect(quantity, 1.0, 0.1))


def test_the_angle_in_a_pin_is_written_in_degrees(tmp_path):
    mechanism = FOUR_BAR.replace(ck.expect("C.angle", ck.deg(30.0), 0.1, crank=0.5))
    ck.save(mechanism, tmp_path / "m.toml")
    assert "value = 30" in (tmp_path / "m.toml").read_text()
    assert ck.load(tmp_path / "m.toml") == mechanism
    motion = ck.solve(mechanism, {"crank": [0.1, 0.2]})
    assert np.array_equal(ck.quantity(motion, "C.angle").values, motion.pairs["C"].value)


WHEELS = (ck.link("frame", A=0, B=60), ck.link("one", A=0), ck.link("two", B=0), ck.drive("one"))
GUIDED = (
    ck.link("frame", A=0), ck.link("cam", A=0), ck.link("follower", P=0), ck.drive("cam"),
    ck.slide("follower", on="frame", through="A", angle=ck.deg(90)),
)  # fmt: skip


@pytest.mark.parametrize(
    ("where", "items"),
    [
        ("cams[0].radius", [*GUIDED, ck.cam("follower", on="cam", profile=ck.profiles.disc(30, 5), radius="10")]),
        ("cams[0].radius", [*GUIDED, ck.cam("follower", on="cam", profile=ck.profiles.disc(30, 5), radius=None)]),
        ("cams[0].radius", [*GUIDED, ck.cam("follower", on="cam", profile=ck.profiles.disc(30, 5), radius=1j)]),
        ("cams[0].profile.middle", [*GUIDED, ck.cam("follower", on="cam", profile=ck.profiles.disc(30, np.nan))]),
        ("arcs[0].radius", [*GUIDED[:3], ck.arc("follower", on="frame", centre_at="A", radius="x"), GUIDED[3]]),
        ("rollings[0].radius", [*GUIDED[:3], ck.roll("follower", on="frame", through="A", radius=None), GUIDED[3]]),
        ("gears[0].phase", [*WHEELS, ck.gear("one", "two", teeth=(20, 40), phase="30")]),
    ],
)
def test_texts_in_place_of_numbers_are_told_by_their_key(where, items):
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        ck.solve(ck.Mechanism("wrong", *items))
    assert where in [problem.where for problem in caught.value.problems]


def test_texts_in_place_of_flags_are_told_by_their_word():
    with pytest.raises(ck.errors.InvalidInput, match=r"inside: .*write True or False"):
        ck.cam("follower", on="cam", profile=ck.profiles.disc(30, 5), inside="no")
    with pytest.raises(ck.errors.InvalidInput, match=r"internal: .*write True or False"):
        ck.gear("one", "two", teeth=(20, 40), internal="no")


@pytest.mark.parametrize(
    ("make", "where"),
    [
        (lambda: ck.profiles.disc("x"), "radius"),
        (lambda: ck.profiles.disc([10, 20]), "radius"),
        (lambda: ck.profiles.profile(None), "profile.points"),
        (lambda: ck.profiles.profile(5), "profile.points"),
        (lambda: ck.profiles.formula(np.exp, "a", 1), "low"),
    ],
)
def test_what_is_no_profile_is_told(make, where):
    with pytest.raises((ck.errors.InvalidMechanism, ck.errors.InvalidInput), match=f"^(1 problem:\n *)?{where}: "):
        make()


LIFT = ck.laws.program(ck.laws.rise(20, over=ck.deg(180)), ck.laws.fall(20, over=ck.deg(180)))


@pytest.mark.parametrize(
    ("key", "value"), [("base", None), ("base", True), ("offset", 1j), ("angle", None), ("clockwise", "no")]
)
def test_a_cam_cannot_be_made_of_what_is_no_number(key, value):
    with pytest.raises(ck.errors.InvalidInput) as caught:
        ck.profiles.synthesise(LIFT, **{"base": 60, key: value})
    assert [problem.where for problem in caught.value.problems] == [key]


@pytest.mark.parametrize(
    "profile", [ck.profiles.profile([10, 20, 30, 40]), ck.profiles.formula(lambda s: 30 * np.cos(s) + 0j, 0, 2 * np.pi)]
)
def test_a_closed_profile_that_is_a_line_is_refused(profile):
    with pytest.raises(ck.errors.InvalidMechanism, match="no area"):
        ck.Mechanism("line", *GUIDED, ck.cam("follower", on="cam", profile=profile))


def test_a_formula_that_fails_is_told():
    with pytest.raises(ck.errors.InvalidMechanism, match="division by zero"):
        ck.Mechanism("m", *GUIDED, ck.cam("follower", on="cam", profile=ck.profiles.formula(lambda s: 1 / 0, 0, 1)))


def test_a_complex_law_is_refused():
    crank = ck.Mechanism("c", *GUIDED[:2], ck.drive("cam", law=lambda t: np.exp(1j * t)))
    with pytest.raises(ck.errors.InvalidInput, match="does not return numbers; return an array of reals"):
        ck.solve(crank, time=[0.0, 1.0])


def test_a_roller_that_the_profile_is_not_made_for_is_warned_about():
    made = ck.profiles.synthesise(LIFT, base=60, follower="roller", roller=10)
    said = [
        ck.figures.cam_analysis(
            ck.solve(ck.Mechanism("m", *GUIDED, ck.cam("follower", on="cam", profile=made, radius=radius))),
            "follower/cam",
        ).warnings
        for radius in (10, 12)
    ]
    assert not any("made for" in text for text in said[0])
    assert any("made for a roller of radius 10, not 12" in text for text in said[1])


@pytest.mark.parametrize("speed", [[1.0, 2.0], [0.0, 1.0, 2.0]])
def test_a_law_does_not_change_along_the_motion(speed):
    with pytest.raises(ck.errors.InvalidMechanism, match=r"law.speed.*along the motion"):
        ck.laws.constant_speed(speed)


def test_a_rise_in_a_file_says_how_far(tmp_path):
    law = ck.laws.program(ck.laws.rise(1.0, over=1), ck.laws.dwell(1), ck.laws.rise(0.0, over=1))
    mechanism = ck.Mechanism("c", *GUIDED[:2], ck.drive("cam", law=law))
    path = tmp_path / "m.toml"
    ck.save(mechanism, path)
    text = path.read_text()
    assert ck.load(path) == mechanism
    assert text.count("rise") == 2
    path.write_text(text.replace(", rise = 0", ""))
    with pytest.raises(ck.errors.InvalidMechanism, match=r"segments\[2\].rise .line 10, column 3.: it is missing"):
        ck.load(path)


def test_a_law_is_asked_for_no_more_derivatives_than_the_motion_has() -> None:
    """The third derivative of t^2.5 is infinite at 0, the second is not."""
    crank = ck.Mechanism(
        "m", ck.link("frame", A=0), ck.link("crank", A=0, B=1), ck.drive("crank", law=lambda t: t**2.5)
    )
    motion = ck.solve(crank, time=[0.0, 1.0], order=2)
    assert motion.links["crank"].angular_acceleration.tolist() == [0.0, 3.75]
    with pytest.raises(ck.errors.InvalidInput):
        ck.solve(crank, time=[0.0, 1.0], order=3)


def test_a_face_along_its_own_guide_is_told() -> None:
    """It never comes nearer to the cam, whatever the displacement."""
    cam = ck.Mechanism(
        "m",
        ck.link("frame", A=0),
        ck.link("cam", A=0),
        ck.link("follower", P=0),
        ck.slide("follower", on="frame", through="A", angle=ck.deg(90)),
        ck.face(
            "follower", on="cam", profile=ck.profiles.formula(lambda s: 3 * np.cos(s) + 2j * np.sin(s), 0, 2 * np.pi)
        ),
        ck.drive("cam", values=[0.0, 0.5]),
    )
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(cam)
    assert "along its own guide" in ck.gaps(motion)[0].reason


def test_differences_do_not_reach_across_a_change_point() -> None:
    """A parallelogram in steps so fine that its neighbours are nearer than the stencil is wide."""
    parallelogram = ck.load("parallelogram")
    for start in (100.03, 179.9):
        for step in (1.0, 0.01):
            motion = ck.solve(parallelogram, {"crank": ck.deg(start + step * np.arange(90))})
            assert ck.verify(motion).passed, (start, step)


@pytest.mark.parametrize("sign", [1, -1])
def test_circuits_begin_where_a_written_mode_has_the_mechanism(sign: int) -> None:
    """The start was sought without the modes that the mechanism names."""
    four_bar = ck.Mechanism(
        "Crank-rocker", ck.link("frame", A=(0, 0), D=(4, 0)), ck.link("crank", A=0, B=1), ck.link("coupler", B=0, C=3),
        ck.link("rocker", D=0, C=3), ck.drive("crank", values=ck.deg(range(0, 361, 30))),
        ck.mode(sign, "coupler", "rocker"))  # fmt: skip
    found, motion = ck.circuits(four_bar), ck.solve(four_bar)
    assert found.start is not None
    begun = found.branches[found.start.branch - 1].configuration
    own = motion.points["C"].position[0]
    # the crank-rocker's two circuits are mirror images: C above or below the diagonal
    assert np.sign(begun.points["C"].imag) == np.sign(own.imag)
    for modes, circuit in ((None, found.start.circuit), ({"coupler": -sign}, 3 - found.start.circuit)):
        told = ck.report(ck.solve(four_bar, modes=modes)).text()
        assert f"Solving begins on circuit {circuit}," in " ".join(told.split())


@pytest.mark.full
def test_circuits_of_many_groups_are_refused_at_once() -> None:
    """Each of twenty dyads doubles the branches: the search went on for ten minutes and more."""
    with pytest.raises(ck.errors.InvalidInput, match="the groups multiply them"):
        ck.circuits(ck.chains.random_mechanism(20, seed=3, kinds=("RRR",)))


def test_a_file_name_with_a_slash_at_its_end_is_no_file(tmp_path: Path) -> None:
    """It was written to the file of that name without the slash."""
    with pytest.raises(ck.errors.InvalidInput, match="name of a folder"):
        ck.draw(ck.load("six-bar")).save(f"{tmp_path}/six-bar.svg/")
    assert not list(tmp_path.iterdir())


# --- a block states its shape: a group whose surroundings' origins stand still is solved at all poses ---


def on_three_slots(**dimensions) -> ck.Mechanism:
    """A floater whose three pins run in slots, one on the crank and two on the frame; the crank's origin rests."""
    return ck.Mechanism(
        "Floater on three slots",
        ck.link("frame", A=(0, 0), D=(4, 0), E=(5, 0), F=(4, 2), G=(4, 3)),
        ck.link("crank", A=(0, 0), B=dimensions.get("B", (1, 0))),
        ck.link("floater", P=(0, 0), Q=(3, 0), R=(3, 1.5)),
        ck.slot("floater", name="s1", on="crank", at="P", through="B", angle=1.2),
        ck.slot("floater", name="s2", on="frame", at="Q", through="D", toward="E"),
        ck.slot("floater", name="s3", on="frame", at="R", through="F", toward="G"),
        ck.drive("crank"),
    )


def test_configurations_of_a_floater_on_three_slots_at_several_values_are_those_at_each():
    values = np.linspace(0.1, 0.9, 4)
    found = ck.configurations(on_three_slots(), {"crank": values})
    assert found.real.shape == (4, 2)
    for k, value in enumerate(values):
        alone = ck.configurations(on_three_slots(), {"crank": value})
        assert found.real_count[k] == alone.real_count == 2
        assert found.angle("floater")[k] == pytest.approx(alone.angle("floater"), abs=1e-12)
        assert found.points("P")[k] == pytest.approx(alone.points("P"), abs=1e-12)


def test_circuits_of_a_floater_on_three_slots():
    found = ck.circuits(on_three_slots())
    assert found.consistent
    values = np.linspace(-3.0, 3.0, 37)
    counted = ck.configurations(found.structure, {"crank": values}).real_count
    crossed = [
        sum(b.low < v + turn < b.high for b in found.branches for turn in (-2 * np.pi, 0.0, 2 * np.pi)) for v in values
    ]
    assert counted.tolist() == crossed


def test_designs_of_a_floater_on_three_slots_are_solved_each():
    places = np.array([[1.0], [1.1], [1.2]])
    found = ck.configurations(on_three_slots(B=places + 0j), {"crank": [0.1, 0.2]})
    assert found.real.shape == (3, 2, 2)
    for k, place in enumerate(places[:, 0]):
        alone = ck.configurations(on_three_slots(B=complex(place)), {"crank": [0.1, 0.2]})
        assert found.angle("floater")[k] == pytest.approx(alone.angle("floater"), abs=1e-12)
