"""Singular poses and the branches that meet there, against closed forms and against motions on the other branch."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

import compoundkin as ck
from compoundkin.analysis.singularities import singular_poses
from compoundkin.analysis.singularity import Singularities, Singularity
from compoundkin.base.linear import zeros_of_forms
from compoundkin.kinematics.extremes.dead_points import driver_dead_points
from tests.support import examples

pytestmark = pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses",
                                        "ignore::compoundkin.base.errors.ChangePointWarning")  # fmt: skip
TURN = np.deg2rad(np.arange(0.0, 361.0, 5.0))


def four_bar(a: float, b: float, c: float, d: float, values: object = TURN, **drawn: complex) -> ck.Mechanism:
    parts = [ck.link("frame", A=0, D=d), ck.link("crank", A=0, B=a), ck.link("coupler", B=0, C=b),
             ck.link("rocker", D=0, C=c), ck.drive("crank", values=values)]  # fmt: skip
    return ck.Mechanism("Four-bar", *parts, *([ck.drawn(**drawn)] if drawn else []))


def slider_crank(crank: float, rod: float, values: object = TURN) -> ck.Mechanism:
    parts = (ck.link("frame", A=0), ck.link("crank", A=0, B=crank), ck.link("rod", B=0, C=rod), ck.link("block", C=0))
    guide = ck.slide("block", on="frame", at="C", through="A", angle=0, name="guide")
    return ck.Mechanism("Slider-crank", *parts, guide, ck.drive("crank", values=values))


def found(mechanism: ck.Mechanism) -> Singularities:
    return singular_poses(ck.solve(mechanism))


def ratios(one: Singularity, *links: str) -> list[list[float]]:
    """The angular velocities of links along each branch."""
    return [[branch.twists[name].angular_velocity for name in links] for branch in one.branches]


# --- change points ------------------------------------------------------------------------------------------


@settings(max_examples=8, deadline=None)
@given(a=st.floats(0.3, 0.9), d=st.floats(1.0, 5.0), start=st.floats(-1.0, -0.01), poses=st.integers(7, 60))
def test_a_parallelogram_meets_its_crossed_form_at_both_flat_poses(
    a: float, d: float, start: float, poses: int
) -> None:
    """Of cranks a on a frame d the other one turns by -(d + a) / (d - a) of it at 0, by the inverse at 180 degrees."""
    values = np.linspace(start, start + 2.0 * np.pi, poses)
    at_start = four_bar(a, d, a, d, values, B=a * np.exp(1j * start), C=d + a * np.exp(1j * start))
    one, other = found(at_start)
    for singular, value, ratio in ((one, 0.0, -(d + a) / (d - a)), (other, np.pi, -(d - a) / (d + a))):
        assert singular.kind == "change point"
        assert singular.drivers["crank"] == pytest.approx(value, abs=1e-9)
        assert singular.links == ("coupler", "rocker")
        assert singular.finite
        assert len(singular.openings) == 1
        assert singular.openings[0].drivers["crank"] == pytest.approx(0.0, abs=1e-9)
        assert [branch.followed for branch in singular.branches] == [True, False]
        assert [branch.number for branch in singular.branches] == [1, 2]
        np.testing.assert_allclose(ratios(singular, "crank", "rocker"), [[1.0, 1.0], [1.0, ratio]], rtol=1e-7)


def test_the_other_branch_is_the_motion_of_the_crossed_form() -> None:
    """The antiparallelogram is solved through the same pose by itself."""
    par, anti = ck.solve(ck.load("parallelogram")), ck.solve(ck.load("antiparallelogram"))
    one = singular_poses(par)[0]
    for branch, motion in zip(one.branches, (par, anti), strict=True):
        speed = motion.links["crank"].angular_velocity[0]
        for name in ("coupler", "follower"):
            rate = motion.links[name].angular_velocity[0] / speed
            assert branch.twists[name].angular_velocity == pytest.approx(rate, abs=1e-8)
        point = complex(motion.points["C"].velocity[0]) / speed
        assert branch.velocities["C"] == pytest.approx(point, abs=1e-6)
    assert [b.followed for b in singular_poses(anti)[0].branches] == [True, False]
    assert ratios(singular_poses(anti)[0], "follower")[0] == pytest.approx([-3.0])


@pytest.mark.parametrize("poses", [24, 25, 60])
def test_a_kite_folds_onto_its_frame(poses: int) -> None:
    """At 0 both outer pins coincide: folded links turn alike while the crank rests; else the rocker by 1/2 + a / b."""
    (one,) = found(four_bar(2.0, 1.5, 1.5, 2.0, np.linspace(0.7, -0.7, poses)))
    assert one.drivers["crank"] == pytest.approx(0.0, abs=1e-9)
    assert one.kind == "change point"
    kite, folded = ratios(one, "crank", "coupler", "rocker")
    np.testing.assert_allclose(kite, [1.0, 0.5 - 2.0 / 3.0, 0.5 + 2.0 / 3.0], atol=1e-7)
    assert one.branches[0].followed
    np.testing.assert_allclose(folded, [0.0, 1.0, 1.0], atol=1e-7)
    assert one.branches[1].drivers == {"crank": 0.0}


def test_a_slider_crank_of_equal_arms_changes_where_the_rod_lies_on_the_crank() -> None:
    """Either the rod mirrors the crank and the block shifts by 2 a, or it turns with the crank and the block rests."""
    one, other = found(slider_crank(1.0, 1.0, np.linspace(0.3, 6.8, 73)))
    for singular, value, sense in ((one, np.pi / 2, -1.0), (other, 3 * np.pi / 2, 1.0)):
        assert singular.drivers["crank"] == pytest.approx(value, abs=1e-9)
        np.testing.assert_allclose(ratios(singular, "rod"), [[-1.0], [1.0]], atol=1e-8)
        np.testing.assert_allclose([b.velocities["C"] for b in singular.branches], [2.0 * sense, 0.0], atol=1e-8)


@pytest.mark.parametrize(("stages", "poses"), [(1, 40), (2, 50), (2, 51), (3, 51)])
def test_a_scissor_through_its_flat_pose_has_one_branch_besides_the_free_turning_of_its_stages(
    stages: int, poses: int
) -> None:
    """Its arms of length 2 turn by half the speed of the roller, or each folded stage turns freely: a family."""
    values = np.linspace(1.5, -1.5, poses)
    parts, drawn = [ck.link("frame", P0=0), ck.link("roller", Q0=0)], {"Q0": 1.2 + 0j}
    for k in range(stages):
        parts += [ck.link(f"a{k}", **{f"P{k}": 0, f"M{k}": 1, f"Q{k + 1}": 2}),
                  ck.link(f"b{k}", **{f"Q{k}": 0, f"M{k}": 1, f"P{k + 1}": 2})]  # fmt: skip
        drawn |= {f"P{k + 1}": 1.6j * (k + 1), f"Q{k + 1}": 1.2 + 1.6j * (k + 1), f"M{k}": 0.6 + 0.8j + 1.6j * k}
    guide = ck.slide("roller", on="frame", at="Q0", through="P0", angle=0, name="g")
    drive = ck.drive("roller", pair="g", values=values)
    (one,) = found(ck.Mechanism("Scissor", *parts, guide, drive, ck.drawn(**drawn)))
    assert one.drivers["roller"] == pytest.approx(0.0, abs=1e-8)
    assert len(one.groups) == stages
    assert len(one.openings) == stages
    assert one.branches[0].followed
    np.testing.assert_allclose(ratios(one, "a0", "b0")[0], [-0.5, 0.5], atol=1e-6)
    if stages == 1:
        assert one.finite
        assert ratios(one, "a0", "b0")[1] == pytest.approx([1.0, 1.0])
    else:
        assert not one.finite
        assert len(one.branches) == 1
        assert "family" in one.meeting


def test_a_third_crank_leaves_one_branch() -> None:
    """All three cranks in line, more opens in velocity, but no other branch: second derivatives of two loops differ."""
    one, other = found(ck.load("parallelogram-third-crank"))
    for singular in (one, other):
        assert singular.kind == "shaky pose"
        assert len(singular.branches) == 1
        assert singular.branches[0].followed
        assert len(singular.openings) == 1


def test_nearly_equal_rods_have_no_change_point() -> None:
    """A parallelogram with a rod longer by 1e-3 passes or stops: never at a pose where branches meet."""
    for longer in (1e-3, -1e-3):
        assert all(one.kind == "limit position" for one in found(four_bar(1.0, 3.0 + longer, 1.0, 3.0, B=1j, C=3 + 1j)))


# --- limit positions ----------------------------------------------------------------------------------------


@settings(max_examples=8, deadline=None)
@given(a=st.floats(3.5, 4.4), b=st.floats(4.0, 4.9), c=st.floats(2.6, 3.5), poses=st.integers(40, 90))
def test_a_triple_rocker_stops_where_coupler_and_rocker_are_in_line(a: float, b: float, c: float, poses: int) -> None:
    """The law of cosines tells where; there the driver rests, and both ends of the coupler's line move across it."""
    d = 7.0
    one, other = found(four_bar(a, b, c, d, np.linspace(-3.0, 3.0, poses)))
    limit = np.arccos((a * a + d * d - (b + c) ** 2) / (2.0 * a * d))
    for singular, value in ((one, -limit), (other, limit)):
        assert singular.kind == "limit position"
        assert singular.turns_back
        assert singular.drivers["crank"] == pytest.approx(value, abs=1e-12)
        (branch,) = singular.branches
        assert branch.drivers == {"crank": 0.0}
        turns = branch.twists
        # v(C) = w(coupler) b from B, which rests, and -w(rocker) c seen the other way round
        assert turns["coupler"].angular_velocity * b == pytest.approx(-turns["rocker"].angular_velocity * c, abs=1e-9)
        assert branch.followed


def test_limit_positions_are_those_of_circuits() -> None:
    """Circuits follow closed forms of groups along the driver, singular poses are zeros of the whole Jacobian."""
    mechanism = ck.load("stephenson-iii-driven-at-rocker")
    motion = ck.solve(mechanism, np.linspace(-np.pi, np.pi, 181))
    limits = (one for one in singular_poses(motion).found if one.kind == "limit position")
    own = sorted(one.drivers[mechanism.drives[0].name] for one in limits)
    known = np.array([limit.value for limit in ck.circuits(mechanism).limits])
    for value in own:
        assert np.min(np.abs(np.angle(np.exp(1j * (known - value))))) < 1e-9


def three_rrr(values: np.ndarray, platform: float) -> ck.Mechanism:
    """Three equal legs around the origin, all cranks driven alike: a platform that turns about the origin."""
    thirds = np.exp(2j * np.pi * np.arange(3) / 3.0)
    base, pins = 3.0 * thirds, thirds
    parts = [ck.link("frame", A=base[0], B=base[1], C=base[2]), ck.link("platform", D=pins[0], E=pins[1], F=pins[2])]
    drawn = {}
    for k, (p, q, r) in enumerate(zip("ABC", "GHI", "DEF", strict=True)):
        parts += [ck.link(f"crank-{k}", **{p: 0, q: 1.5}), ck.link(f"rod-{k}", **{q: 0, r: 1.6})]
        turned = np.exp(2j * np.pi * k / 3.0)
        drawn |= {q: turned * (3.0 + 1.5 * np.exp(1j * values[0])), r: turned * np.exp(1j * platform)}
    drives = [ck.drive(f"crank-{k}", values=values + 2.0 * np.pi * k / 3.0) for k in range(3)]
    return ck.Mechanism("3-RRR", *parts, *drives, ck.drawn(**drawn))


def crank_angle(platform: float) -> float:
    """The angle of a crank by that of the platform, by the law of cosines."""
    away = np.exp(1j * platform) - 3.0
    inner = np.arccos((1.5**2 + abs(away) ** 2 - 1.6**2) / (2.0 * 1.5 * abs(away)))
    return float(np.mod(np.angle(away) + inner, 2.0 * np.pi))


def test_a_robot_is_singular_where_the_lines_of_its_rods_meet_in_one_point() -> None:
    """The second kind of Gosselin and Angeles: by symmetry they meet in the middle, and the platform turns about it."""

    def moment(platform: float) -> float:
        pin = np.exp(1j * platform)
        rod = pin - 3.0 - 1.5 * np.exp(1j * crank_angle(platform))
        return float((np.conj(pin) * rod).imag)

    at = brentq(moment, -0.9, -0.2, xtol=1e-14)
    limit, begin = crank_angle(at), crank_angle(-0.2)
    values = np.linspace(begin, limit + 0.3 * (limit - begin), 41)
    one = singular_poses(ck.solve(three_rrr(values, -0.2)))[0]
    assert one.kind == "limit position"
    assert one.drivers["crank-0"] == pytest.approx(limit, abs=1e-9)
    (branch,) = one.branches
    assert branch.twists["platform"].angular_velocity != 0.0
    assert abs(branch.twists["platform"].velocity) < 1e-7 * abs(branch.twists["platform"].angular_velocity)
    assert all(abs(rate) < 1e-7 for rate in branch.drivers.values())


# --- stretches, dead points, what is regular -----------------------------------------------------------------


def test_a_dyad_that_is_always_stretched_is_singular_all_along() -> None:
    """Crank and rocker turn about one pin, and the dyad is as long as the crank: in line in every pose."""
    parts = (ck.link("frame", A=0), ck.link("crank", A=0, B=3), ck.link("rod", B=0, C=2), ck.link("arm", A=0, C=1))
    (one,) = found(
        ck.Mechanism("Stretched", *parts, ck.drive("crank", values=np.linspace(0, 1, 9)), ck.drawn(B=3, C=1))
    )
    assert one.kind == "architecture"
    assert (one.place, one.until) == (0.0, 8.0)
    assert one.links == ("rod", "arm")


def test_a_robot_of_parallel_legs_is_singular_where_it_stands() -> None:
    """Three equal cranks and rods on equal triangles: the platform is not held, with a family of directions."""
    base, turned = 2.0 * np.exp(2j * np.pi * np.arange(3) / 3.0), np.exp(0.2j)
    parts = [ck.link("frame", A=base[0], B=base[1], C=base[2]), ck.link("platform", D=base[0], E=base[1], F=base[2])]
    drawn = {}
    for k, (p, q, r) in enumerate(zip("ABC", "GHI", "DEF", strict=True)):
        parts += [
            ck.link(f"crank-{k}", **{p: 0, q: 1}),
            ck.link(f"rod-{k}", **{q: 0, r: 1.5}),
            ck.drive(f"crank-{k}", values=0.2),
        ]
        drawn |= {q: base[k] + turned, r: base[k] + turned + 1.5 * np.exp(1.2j)}
    (one,) = found(ck.Mechanism("Parallel", *parts, ck.drawn(**drawn)))
    (opening,) = one.openings
    assert opening.twists["platform"].angular_velocity == pytest.approx(0.0, abs=1e-9)
    assert len({round(opening.twists[f"rod-{k}"].angular_velocity, 9) for k in range(3)}) == 1


def test_dead_points_of_a_slider_crank() -> None:
    """In line at 0 and 180 degrees; at every dead point the full system moves while the output's velocity is zero."""
    all_found = ck.singularities(slider_crank(1.0, 2.5), ["guide.value"])
    assert [one.kind for one in all_found] == ["dead point"] * 2
    np.testing.assert_allclose([one.drivers["crank"] for one in all_found], [0.0, np.pi], atol=1e-9)
    for one in all_found:
        assert one.output.startswith("guide.")
        (branch,) = one.branches
        assert branch.drivers["crank"] == 1.0
        assert abs(branch.velocities["C"]) < 1e-7
        assert abs(branch.velocities["B"]) == pytest.approx(1.0)


@pytest.mark.parametrize(
    "name",
    [
        *("crank-rocker", "slider-crank", "six-bar", "3-rrr", "class-iii-six-bar", "geneva-wheel"),
        *("disc-cam-roller-program", "planetary-train", "roberts-cognates"),
    ],
)
def test_regular_motions_have_no_singular_pose(name: str) -> None:
    assert not singular_poses(ck.solve(ck.load(name)))


def test_each_design_has_its_own() -> None:
    """Lengths of several designs: the ratios are those of each."""
    a = np.array([[0.5], [1.0], [2.0]])
    parts = [ck.link("frame", A=0, D=3), ck.link("crank", A=0, B=a), ck.link("coupler", B=0, C=3),
             ck.link("rocker", D=0, C=a), ck.drive("crank", values=TURN), ck.drawn(B=1j * a, C=3 + 1j * a)]  # fmt: skip
    every = found(ck.Mechanism("Three", *parts))
    assert [one.design for one in every] == [(0,), (0,), (1,), (1,), (2,), (2,)]
    other = [ratios(one, "rocker")[1][0] for one in every[::2]]
    np.testing.assert_allclose(other, -(3 + a[:, 0]) / (3 - a[:, 0]), rtol=1e-7)
    speeds = [abs(one.branches[0].velocities["B"]) for one in every[::2]]
    np.testing.assert_allclose(speeds, a[:, 0], rtol=1e-9)


def test_a_motion_that_rests_at_a_change_point_is_no_architecture() -> None:
    values = [-0.2, -0.1, 0.0, 0.0, 0.0, 0.1, 0.2]
    (one,) = found(four_bar(1.0, 3.0, 1.0, 3.0, values, B=np.exp(-0.2j), C=3 + np.exp(-0.2j)))
    assert one.kind == "change point"
    assert (one.place, one.until) == (2.0, 4.0)


def test_every_branch_can_be_followed() -> None:
    """Second way: poses at which all pairs close and the driver has gone on lie on each tangent."""
    one = found(four_bar(1.0, 3.0, 1.0, 3.0, B=1j, C=3 + 1j))[0]
    for branch in one.branches:
        step = 1e-4
        turned = {name: step * twist.angular_velocity for name, twist in branch.twists.items()}
        B = np.exp(1j * step)
        C = 4.0 + step * branch.velocities["C"]
        # the coupler's and the rocker's lengths change by the square of the step only, and so do the angles
        assert abs(abs(C - B) - 3.0) < 20.0 * step**2
        assert abs(abs(C - 3.0) - 1.0) < 20.0 * step**2
        assert np.angle(C - 3.0) == pytest.approx(turned["rocker"], abs=20.0 * step**2)
        exact = crossing(B, branch.twists["rocker"].angular_velocity * step)
        assert np.angle(exact - 3.0) / step == pytest.approx(branch.twists["rocker"].angular_velocity, abs=1e-3)


def crossing(B: complex, near: float) -> complex:
    """The place of C for a crank's pin, of both the one nearest to an angle of the rocker."""
    away = 3.0 - B
    along = (3.0**2 - 1.0 + abs(away) ** 2) / (2.0 * abs(away))
    across = np.sqrt(max(3.0**2 - along**2, 0.0))
    both = [B + away / abs(away) * (along + sign * 1j * across) for sign in (1, -1)]
    return min(both, key=lambda c: abs(np.angle(c - 3.0) - near))


@pytest.mark.parametrize("seed", [3, 9, 57, 94, 140, 419])
def test_limit_positions_of_random_mechanisms_are_all_that_is_singular(seed: int) -> None:
    """The motion stops where a group does not close: found by bisection there, by the whole Jacobian here.

    Dyads of slides among them run to infinity where their guides become parallel: no singular pose.
    """
    mechanism = ck.chains.random_mechanism(1 + seed % 6, seed)
    start = float(mechanism.drives[0].values)
    motion = ck.solve(mechanism, np.linspace(start - 3.1, start + 3.1, 73))
    every = singular_poses(motion)
    assert {one.kind for one in every} <= {"limit position"}
    assert all(one.branches[0].followed for one in every)
    stops = driver_dead_points(motion).place
    np.testing.assert_allclose([one.place for one in every], np.sort(stops), atol=1e-9)


# --- zeros of quadratic forms ----------------------------------------------------------------------------------


def test_two_conics_meet_in_four_points() -> None:
    """x^2 + y^2 = 2 z^2 and x y = 1/2 z^2 by elimination: x^2 is 1 + or - sqrt(3) / 2."""
    circle = np.diag([1.0, 1.0, -2.0])
    hyperbola = np.array([[0.0, 0.5, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, -0.5]])
    roots, finite = zeros_of_forms(np.stack([circle, hyperbola]))
    assert finite
    assert [times for _, times in roots] == [1] * 4
    points = sorted((v[0] / v[2], v[1] / v[2]) for v, _ in roots)
    x = np.sqrt(1.0 + np.sqrt(3.0) / 2.0), np.sqrt(1.0 - np.sqrt(3.0) / 2.0)
    np.testing.assert_allclose(points, sorted([x, x[::-1], (-x[0], -x[1]), (-x[1], -x[0])]), atol=1e-9)


def test_numbers_of_roots() -> None:
    definite, touching, crossing = np.diag([1.0, 1.0]), np.diag([1.0, 0.0]), np.diag([1.0, -1.0])
    assert zeros_of_forms(definite[None]) == ([], True)
    ((root, times),), finite = zeros_of_forms(touching[None])
    assert (times, finite) == (2, True)
    np.testing.assert_allclose(root, [0.0, 1.0])
    assert len(zeros_of_forms(crossing[None])[0]) == 2
    # x z = 0 and y z = 0: the line z = 0 and a point besides
    one, other = np.zeros((3, 3)), np.zeros((3, 3))
    one[0, 2] = one[2, 0] = other[1, 2] = other[2, 1] = 0.5
    roots, finite = zeros_of_forms(np.stack([one, other]))
    assert not finite
    np.testing.assert_allclose([root for root, _ in roots], [[0.0, 0.0, 1.0]], atol=1e-9)


@settings(max_examples=examples(12), deadline=None)
@given(st.integers(0, 10**6), st.integers(3, 5))
def test_as_many_real_zeros_as_there_can_be(seed: int, n: int) -> None:
    """n - 1 forms of n unknowns have an even number of real zeros, at most 2^(n - 1), and one that is built in."""
    rng = np.random.default_rng(seed)
    known = rng.standard_normal(n)
    forms = rng.standard_normal((n - 1, n, n))
    forms = forms + forms.transpose(0, 2, 1)
    values = np.einsum("i,kij,j->k", known, forms, known) / (known @ known)
    forms -= values[:, None, None] * np.eye(n)
    roots, finite = zeros_of_forms(forms)
    assert finite
    assert len(roots) % 2 == 0
    assert 0 < len(roots) <= 2 ** (n - 1)
    assert max(abs(root @ known) for root, _ in roots) == pytest.approx(np.linalg.norm(known))
    for root, _ in roots:
        assert np.abs(np.einsum("i,kij,j->k", root, forms, root)).max() < 1e-9


# --- how they are shown ----------------------------------------------------------------------------------------


def test_a_report_has_the_section_only_where_there_are_any() -> None:
    keys = [section.key for section in ck.report(ck.load("parallelogram")).sections]
    assert keys.index("singularities") == keys.index("checks") - 1
    assert "singularities" not in [section.key for section in ck.report(ck.load("crank-rocker")).sections]


def test_pictures_have_a_panel_for_each_branch() -> None:
    motion = ck.solve(ck.load("parallelogram"))
    every = ck.draw(motion, kind="singularities")
    assert every.svg.count("velocity of C") == 4
    assert every.svg.count("branch 2</text>") == 2
    one = ck.draw(ck.singularities(motion)[0])
    assert one.svg.count("velocity of C") == 2
    with pytest.raises(ck.errors.InvalidInput, match="no pose along the motion is singular"):
        ck.draw(ck.load("crank-rocker"), kind="singularities")
    with pytest.raises(ck.errors.InvalidInput, match="leave the kind out"):
        ck.draw(ck.singularities(motion)[0], kind="graph")


def test_text_and_html() -> None:
    with warnings.catch_warnings(action="ignore"):
        none, some = (
            ck.singularities(ck.load("crank-rocker"), ["crank.angle"]),
            singular_poses(ck.solve(ck.load("parallelogram"))),
        )
    assert none.text() == "No pose along the motion is singular."
    assert some[0].name == "change point 1"
    assert "2 branches meet" in some.text()
    assert "change point" in str(some._repr_html_())
