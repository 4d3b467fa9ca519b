"""Burmester's theory against planted linkages, published numbers and plain geometry."""

from __future__ import annotations

import time
import warnings
from itertools import pairwise

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.dimensional.dyads import circle_through
from compoundkin.dimensional.motion_generation import nearest_linkages
from compoundkin.dimensional.tasks import inside

# Computed by a prototype that eliminated by other equations than the package does, in (x, y, degrees), with the fixed
# centres of all dyads.
FOUR_RR = (
    [(0.496, -0.114, 36.72), (-0.581, 0.81, 15.64), (-0.966, -0.393, -16.48), (0.998, -0.476, 31.29),
     (0.698, 0.211, -56.82)],
    [(0.29655890651089256, 2.0996353384981785), (1.8744022983657969, -0.5722174258108629),
     (0.9547456955284186, -2.462212306854789), (-1.0896351149539882, 0.8497479154145334)],
)  # fmt: skip
TWO_RR = (
    [(0.266, 0.935, 50.91), (0.366, -0.217, -3.49), (-0.625, -0.308, 23.25), (0.022, 0.782, -47.14),
     (0.551, -0.364, -47.45)],
    [(-0.00986105805804699, -1.0012406634299893), (0.32587855832539103, -0.30687808153493246)],
)  # fmt: skip
NONE = (
    [(-0.829, -0.526, -13.05), (0.603, 0.164, 2.01), (-0.812, -0.134, -8.32), (-0.042, -0.681, 10.42),
     (0.469, -0.773, 28.54)],
    [],
)  # fmt: skip
# A body on a crank and a slider.
SLIDER = [
    (1.131470712796348, -0.5560049469505542, -31.91639761043978),
    (1.8248309453772782, -0.4732589575403786, 11.132755281436161),
    (1.9252677429109744, -0.4067590683629797, 20.735583199502962),
    (2.0529053527503267, -0.0768912399385984, 54.30561055723676),
    (2.0458925468834632, -0.038881163563711615, 57.62437057077041),
]


def radians(poses):
    return [(x, y, np.deg2rad(angle)) for x, y, angle in poses]


def parts(poses):
    x, y, angle = np.array(poses).T
    return x + 1j * y, np.exp(1j * angle)


def random_poses(rng, count):
    places = rng.uniform(-1, 1, (count, 2))
    return np.column_stack([places, rng.uniform(-np.pi, np.pi, count)])


@pytest.mark.parametrize("case", [FOUR_RR, TWO_RR, NONE], ids=["four", "two", "none"])
def test_all_cranks_through_five_poses(case):
    poses, centres = case
    found = ck.dyads(radians(poses))
    assert sorted((round(d.fixed.real, 8), round(d.fixed.imag, 8)) for d in found) == sorted(
        (round(x, 8), round(y, 8)) for x, y in centres
    )
    for dyad in found:
        assert np.max(np.abs(dyad.residual(*parts(radians(poses))))) < 1e-12


def test_a_slider_among_cranks():
    found = ck.dyads(radians(SLIDER))
    assert [dyad.kind for dyad in found] == ["RR", "RR", "RR", "PR"]
    slider = found[3]
    assert abs(slider.moving - (-0.24702683124545488 + 0.6038024139716145j)) < 1e-9
    assert np.isclose(np.tan(np.angle(slider.direction)), -0.06950372227058688)
    assert min(abs(dyad.fixed - (-0.9121171984730037 - 0.1955698405680233j)) for dyad in found) < 1e-9


def planted(rng, kind):
    """Five poses of a body on a planted dyad, and by how much another one is not it."""
    u = np.exp(1j * rng.uniform(-np.pi, np.pi, 5))
    fixed, moving = (complex(*rng.uniform(-2, 2, 2)) for _ in range(2))
    way, along = np.exp(1j * rng.uniform(-np.pi, np.pi)), rng.uniform(-2, 2, 5)
    if kind == "RR":
        length = rng.uniform(0.3, 2.0)
        z = fixed + length * np.exp(1j * rng.uniform(-np.pi, np.pi, 5)) - u * moving
        return z, u, lambda d: max(abs(d.fixed - fixed), abs(d.moving - moving), abs(d.length - length))
    if kind == "PR":
        z = fixed + way * along - u * moving
        return z, u, lambda d: max(abs(d.moving - moving), abs((np.conj(way) * (d.fixed - fixed)).imag))
    z = fixed - u * (moving + way * along)
    return z, u, lambda d: max(abs(d.fixed - fixed), abs((np.conj(way) * (d.moving - moving)).imag))


@pytest.mark.parametrize("count", [100, pytest.param(1000, marks=pytest.mark.full)])
def test_every_planted_dyad_is_found(count):
    rng = np.random.default_rng(1)
    began, worst = time.process_time(), 0.0
    for k in range(count):
        kind = ("RR", "PR", "RP")[k % 3]
        z, u, apart = planted(rng, kind)
        found = ck.dyads(np.column_stack([z.real, z.imag, np.angle(u)]))
        worst = max(worst, min(apart(dyad) for dyad in found if dyad.kind == kind))
    assert worst < 1e-9
    assert (time.process_time() - began) / count < 3e-3


def test_the_curve_through_four_poses_holds_its_equations_everywhere():
    """Each circle point lies on a circle about its centre, found from the four places of the point alone."""
    rng = np.random.default_rng(2)
    for _ in range(10):
        poses = random_poses(rng, 4)
        z, u = parts(poses)
        curve = ck.dyads(poses).curve
        assert len(curve) >= 990
        scale = 1.0 + curve.lengths + np.abs(curve.points)
        off = np.abs(np.abs(z[:, None] + u[:, None] * curve.points - curve.centres) - curve.lengths)
        assert np.max(off / scale) < 1e-10
        near = np.flatnonzero((curve.lengths < 3.0) & (np.abs(curve.points) < 3.0))[::25]
        for k in near:
            centre, radius, deviation = circle_through(z + u * curve.points[k])
            assert deviation < 1e-9 * radius
            assert abs(centre - curve.centres[k]) < 1e-6 * (1.0 + abs(centre))
        # it is a curve: from point to point it goes on, and it passes infinity twice, where the sliders are
        assert len(curve.breaks) == 2
        for piece, closed in curve.pieces():
            places = [(c - 0j) / (1.0 + abs(c)) for c in curve.centres[piece]]
            assert max(abs(b - a) for a, b in pairwise(places)) < 0.3, closed


def test_the_curve_passes_all_dyads_of_a_fifth_pose():
    """Whatever fifth pose is added, the dyads of all five lie on the curve of the first four."""
    rng = np.random.default_rng(4)
    for _ in range(20):
        poses = random_poses(rng, 5)
        four = ck.dyads(poses[:4])
        for dyad in ck.dyads(poses):
            if dyad.kind == "RR" and dyad.length < 10:
                again = four.with_centre(dyad.fixed)
                assert abs(again.moving - dyad.moving) < 1e-6 * (1.0 + abs(dyad.moving))
                apart = np.abs(four.curve.centres - dyad.fixed) + np.abs(four.curve.points - dyad.moving)
                assert np.min(apart) < 0.05 * (1.0 + dyad.length + abs(dyad.moving))


def test_sliders_of_four_poses_and_balls_point():
    poses = random_poses(np.random.default_rng(5), 4)
    found = ck.dyads(poses)
    assert [dyad.kind for dyad in found] == ["PR", "RP"]
    for dyad in found:
        assert np.max(np.abs(dyad.residual(*parts(poses)))) < 1e-12


def test_three_poses_have_a_dyad_for_each_centre_point_and_line():
    poses = random_poses(np.random.default_rng(6), 3)
    z, u = parts(poses)
    found = ck.dyads(poses)
    cranks, sliders = (
        (found.with_centre((0.3, 0.2)), found.with_point(0.3 + 0.2j)),
        map(found.with_line, (0.7, 0.7), ("PR", "RP")),
    )
    for dyad in (*cranks, *sliders):
        assert np.max(np.abs(dyad.residual(z, u))) < 1e-12
    centre, radius, _ = circle_through(z + u * (0.3 + 0.2j))
    by_point = found.with_point((0.3, 0.2))
    assert np.isclose(by_point.fixed, centre)
    assert np.isclose(by_point.length, radius)
    assert found.with_centre((0.3, 0.2)).fixed == pytest.approx(0.3 + 0.2j)


def test_a_pole_is_where_two_poses_agree():
    poses = random_poses(np.random.default_rng(7), 4)
    z, u = parts(poses)
    found = ck.dyads(poses).poles
    assert len(found) == 6
    for pole in found:
        i, j = pole.poses
        assert abs(z[i] + u[i] * pole.point - pole.place) < 1e-12
        assert abs(z[j] + u[j] * pole.point - pole.place) < 1e-12


@pytest.mark.parametrize("accelerated", [False, True])
def test_infinitely_near_poses_are_the_limit_of_near_ones(accelerated):
    rng = np.random.default_rng(3)
    poses = random_poses(rng, 3 if accelerated else 4)
    speed, gain = rng.uniform(-1, 1, (2, 3))
    step = 1e-4
    steps = (step, -step) if accelerated else (step,)
    beside = [poses[0] + speed * h + (gain * h * h / 2 if accelerated else 0) for h in steps]
    limit = ck.dyads(poses, velocities={0: speed}, accelerations={0: gain} if accelerated else None)
    near = ck.dyads(np.vstack([poses, beside]))
    assert len(limit) == len(near) > 0
    for one, other in zip(limit, near, strict=True):
        assert abs(one.fixed - other.fixed) + abs(one.moving - other.moving) < 1e-2 * (1.0 + one.length)


def test_five_poses_give_verified_mechanisms_that_pass_them():
    poses = radians(SLIDER)
    answer = ck.synthesise(ck.tasks.poses("plate", poses))
    assert answer.complete == "4 real dyads of 4, 6 linkages"
    assert len(answer) + len(answer.rejected) == 6
    assert len(answer) == 4
    z, u = parts(poses)
    for one, mechanism in zip(answer, answer.mechanisms, strict=True):
        motion = ck.solve(mechanism, {one.driver: one.values})
        assert np.max(np.abs(motion.links["plate"].origin.position - z)) < 1e-9
        assert np.max(np.abs(np.exp(1j * motion.links["plate"].angle) - u)) < 1e-9
        assert np.all(np.diff(one.values) > 0) or np.all(np.diff(one.values) < 0)
        assert ck.verify(one.motion).passed
    angles = [one.transmission for one in answer]
    assert angles == sorted(angles, reverse=True)


def test_defects_are_those_of_the_motion():
    """A branch defect: the driver, turned either way to some position, does not get there."""
    answer = ck.synthesise(ck.tasks.poses("plate", radians(SLIDER)))
    stopped = [one for one in answer.rejected if one.reason == "branch"]
    assert stopped
    for one in stopped:
        values = one.candidate.drivers[one.driver]
        z = one.candidate.z["plate"]
        arrives = []
        for value, place in zip(values[1:], z[1:], strict=True):
            turn = np.mod(value - values[0], 2 * np.pi)
            ways = (np.linspace(values[0], values[0] + t, 200) for t in (turn, turn - 2 * np.pi))
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
                motions = [ck.solve(one.mechanism, {one.driver: way}, order=0) for way in ways]
            arrives.append(
                any(m.assembled.all() and abs(m.links["plate"].origin.position[-1] - place) < 1e-6 for m in motions)
            )
        assert not all(arrives)


def test_conditions_are_held():
    task = ck.tasks.poses("plate", radians(SLIDER))
    answer = ck.synthesise(task, region=[(-4, -4), (4, 4)], lengths=(0.1, 5), transmission=ck.deg(30))
    assert 0 < len(answer) < 4
    assert {one.reason for one in answer.rejected} >= {"region"}
    for one in answer:
        assert all(abs(p.real) <= 4 and abs(p.imag) <= 4 for p in one.candidate.pivots)
        assert one.transmission >= ck.deg(30)
    ranked = ck.synthesise(task, prefer="compactness")
    assert [one.size for one in ranked] == sorted(one.size for one in ranked)


def test_three_poses_with_two_given_pivots():
    """As every textbook begins: an inversion and two perpendicular bisectors."""
    poses = [(0, 0, 0), (1, 0.4, 0.35), (1.6, 1.1, 0.7)]
    pivots = [(-0.6, -1.2), (1.4, -1.0)]
    answer = ck.synthesise(ck.tasks.poses("plate", poses), ground=pivots)
    (linkage,) = [one.candidate for one in (*answer, *answer.rejected)]
    z, u = parts(poses)
    for pivot, dyad in zip(pivots, sorted(linkage.dyads, key=lambda d: d.fixed.real), strict=True):
        seen = np.conj(u) * (complex(*pivot) - z)  # the pivot as the body sees it
        assert abs(dyad.moving - circle_through(seen)[0]) < 1e-9


TIMED = [
    ([(-1.2511726504404788, 1.1266012983528082), (-2.302965674914767, 1.734387401830098),
      (-2.6801727829331967, -0.5986549604690821), (-2.4708768822765235, -0.9216995481397195),
      (-2.438825232772971, -0.9610791126740932)],
     [44.27005495938842, 118.78684393876502, 227.79225813857258, 242.7566149816177, 244.77035801904805],
     (2.6158397804860014 + 0.8091740672751998j, 1.0, 3.0763287029438864, 2.686541739626677)),
    ([(2.026153928934298, -0.8574277536773985), (-0.6634736758198918, -1.1216566224097633),
      (1.249280135018293, -1.920785058002291), (1.4290325685106722, -1.8259246209823776),
      (1.7580430377996188, -1.5673399804818038)],
     [1.8955096436069008, 168.45658302373948, 286.94499435073664, 295.64223061779586, 314.47924034265424],
     (3.3927546662188433 + 1.049502004293686j, 1.0, 3.2501909332093337, 3.7944276019391507)),
]  # fmt: skip


@pytest.mark.parametrize("case", TIMED)
def test_a_planted_path_with_timing_is_found(case):
    points, angles, (pivot, crank, coupler, rocker) = case
    answer = ck.synthesise(ck.tasks.points(points, at=np.deg2rad(angles)))
    assert answer.complete == "4 dyads of 4, 12 linkages"
    every = [one.candidate for one in (*answer, *answer.rejected)]

    def apart(one):
        first, second = one.dyads
        numbers = first.length - crank, abs(first.moving - second.moving) - coupler, second.length - rocker
        return max(abs(first.fixed), abs(second.fixed - pivot), *map(abs, numbers))

    assert min(map(apart, every)) < 1e-9
    for one in answer:
        motion = ck.solve(one.mechanism, {"input": one.values})
        assert np.max(np.abs(motion.points["P"].position - [complex(*p) for p in points])) < 1e-9
        turned = np.exp(1j * (one.values - one.values[0] - np.deg2rad(np.array(angles) - angles[0])))
        assert np.max(np.abs(turned - 1.0)) < 1e-9


@pytest.mark.full
def test_three_points_with_timing_leave_a_family():
    answer = ck.synthesise(ck.tasks.points([(0, 0), (1, 0.8), (2, 0)], at=ck.deg([0, 60, 120])))
    assert "family" in answer.complete
    assert len(answer) > 5


def test_bodies_that_only_turn_or_shift():
    turning = ck.dyads([(1, 0, 0), (0, 1, np.pi / 2), (-1, 0, np.pi)])
    assert turning.note == "the body only turns: a pin at (0, 0) takes it through all poses"
    answer = ck.synthesise(ck.tasks.poses("plate", [(1, 0, 0), (0, 1, np.pi / 2), (-1, 0, np.pi)]))
    assert not len(answer)
    assert "a pin at" in answer.nearest
    shifting = ck.synthesise(ck.tasks.poses("plate", [(0, 0, 0), (1, 0.2, 0), (1.5, 1, 0)]))
    assert "parallel cranks" in shifting.note
    assert len(shifting) > 0
    for one in shifting:
        assert np.allclose(one.motion.links["plate"].angle, 0.0, atol=1e-9)
    in_line = ck.synthesise(ck.tasks.poses("plate", [(0, 0, 0), (1, 1, 0), (2, 2, 0)]))
    assert not len(in_line)
    assert "a slide does" in in_line.nearest


def test_wrong_poses():
    poses = [(0, 0, 0), (1, 0, 0.5), (0, 0, 0)]
    with pytest.raises(ck.errors.InvalidInput, match="pose 0 and pose 2 are equal"):
        ck.tasks.poses("plate", poses)
    with pytest.raises(ck.errors.InvalidInput, match="four poses have one"):
        _ = ck.dyads(radians(SLIDER)).curve
    with pytest.raises(ck.errors.InvalidInput, match="infinitely many dyads"):
        ck.dyads([(0, 0, 0), (1, 0, 0.5)]).with_centre((0, 1))
    with pytest.raises(ck.errors.InvalidInput, match="no area"):
        ck.synthesise(ck.tasks.poses("plate", radians(SLIDER)), region=[(0, 0), (1, 1), (2, 2)])
    with pytest.raises(ck.errors.InvalidInput, match="no method meets plate through 2 poses"):
        ck.synthesise(ck.tasks.poses("plate", poses[:2]))


def test_a_region_is_a_polygon():
    shape = np.array([0, 2, 2 + 2j, 1 + 1j, 2j])
    places = np.array([1 + 0.5j, 1 + 1.5j, 0.2 + 1j, 3 + 1j, -0.1 + 0.1j])
    assert inside(places, shape).tolist() == [True, False, True, False, False]


def coupler_poses(count, noise):
    """Poses of the coupler of a known crank-rocker, with errors."""
    links = ck.link("crank", A=0, B=2), ck.link("rocker", D=0, C=4), ck.link("coupler", B=0, C=5, P=(2, 1.5))
    mechanism = ck.Mechanism("m", ck.link("frame", A=0, D=5), *links, ck.drive("crank"))
    motion = ck.solve(mechanism, {"crank": np.linspace(0.2, 2.5, count)})
    place, angle = motion.points["P"].position, motion.links["coupler"].angle
    exact = np.column_stack([place.real, place.imag, angle])
    return exact + noise * np.random.default_rng(0).normal(size=exact.shape) * [1, 1, 0.3]


def test_many_poses_of_one_linkage_give_it_back():
    answer = ck.synthesise(ck.tasks.poses("plate", coupler_poses(12, 0.0), tolerance=1e-6))
    best = answer[0]
    assert sorted(np.round(best.candidate.lengths, 6)) == [2, 4, 5]
    assert best.error < 1e-9


def test_poses_with_errors_are_approached_and_the_tolerance_that_would_do_is_said():
    poses = coupler_poses(12, 1e-3)
    exact = ck.synthesise(ck.tasks.poses("plate", poses))
    assert not len(exact)
    enough = float(exact.nearest.split()[3])
    assert exact.nearest == f"a tolerance of {enough:.4g} would do"
    assert enough < 5e-3
    answer = ck.synthesise(ck.tasks.poses("plate", poses, tolerance=enough))
    assert len(answer)
    best = answer[0]
    # by another way: the distance of each pose from a dense motion is the error, or less
    dense = ck.solve(
        best.mechanism, {best.driver: np.linspace(best.values[0] - 0.2, best.values[-1] + 0.2, 20001)}, order=0
    )
    z, u = parts(poses)
    place, turn = dense.links["plate"].origin.position, np.exp(1j * dense.links["plate"].angle)
    size = max(abs(a - b) for a in z for b in z)
    apart = [np.min(np.hypot(np.abs(place - a), size * np.abs(turn - b))) for a, b in zip(z, u, strict=True)]
    assert max(apart) < best.error * 1.001
    assert max(apart) > best.error * 0.9


def test_poses_that_nothing_takes_have_a_nearest_linkage():
    answer = ck.synthesise(ck.tasks.poses("plate", radians(NONE[0])))
    assert answer.note == "no linkage takes these poses exactly"
    assert "the nearest linkage misses the task by" in answer.nearest or "would do" in answer.nearest


def test_a_motion_of_cardan_has_sliders_in_every_direction():
    """A ladder of length 3 between floor and wall, known by five poses."""
    angle = np.array([0.2, 0.5, 0.8, 1.1, 1.4])
    poses = np.column_stack([3 * np.cos(angle), 0 * angle, np.pi - angle])
    found = ck.dyads(poses)
    assert "Cardan motion" in found.note
    for dyad in found:
        assert np.max(np.abs(dyad.residual(*parts(poses)))) < 1e-9
    answer = ck.synthesise(ck.tasks.poses("ladder", poses))
    assert "of a family" in answer.complete
    assert {one.candidate.title for one in answer} >= {"Elliptic trammel"}


def test_a_solved_mechanism_has_the_velocities_that_were_asked_for():
    """Four poses of a known coupler, and the direction of its motion at one of them: it is among the answers."""
    links = ck.link("crank", A=0, B=2), ck.link("rocker", D=0, C=4), ck.link("coupler", B=0, C=5, P=(2, 1.5))
    mechanism = ck.Mechanism("m", ck.link("frame", A=0, D=5), *links, ck.drive("crank"))
    known = ck.solve(mechanism, {"crank": [0.2, 1.1, 2.3, 3.9]})
    coupler, place = known.links["coupler"], known.points["P"]
    poses = np.column_stack([place.position.real, place.position.imag, coupler.angle])
    speed = np.array([*place.velocity.xy[1], coupler.angular_velocity[1]])
    answer = ck.synthesise(ck.tasks.poses("plate", poses, velocities={1: 3.0 * speed}))
    assert min(np.max(np.abs(np.sort(one.candidate.lengths) - [2, 4, 5])) for one in answer) < 1e-6
    for one in answer:
        plate = ck.solve(one.mechanism, {one.driver: one.values}).links["plate"]
        twist = np.array([*plate.origin.velocity.xy[1], plate.angular_velocity[1]])
        assert np.isclose(abs(twist @ speed), np.linalg.norm(twist) * np.linalg.norm(speed), rtol=1e-9)


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_answers_do_not_depend_on_the_unit(scale):
    task = [ck.tasks.poses("plate", [(s * x, s * y, angle) for x, y, angle in radians(SLIDER)]) for s in (1, scale)]
    one, other = map(ck.synthesise, task)
    assert [a.candidate.title for a in one] == [b.candidate.title for b in other]
    assert np.allclose([a.size * scale for a in one], [b.size for b in other])
    assert one.reasons == other.reasons


def test_nearest_linkages_do_not_depend_on_the_unit():
    """Of a power of two nothing is rounded; steps of differences, which are absolute, must not tell the unit."""
    course, scale = np.linspace(0.0, 3.0, 7), 2.0**-20
    poses = np.stack([np.cos(course), 0.5 * np.sin(course + 0.1), 0.3 * np.sin(course)], axis=-1)
    one, other = (list(nearest_linkages(ck.tasks.poses("plate", poses * [s, s, 1.0]))) for s in (1, scale))
    assert len(one) > 0
    assert np.allclose([a.error * scale for a in one], [b.error for b in other], rtol=1e-9, atol=0.0)
    assert np.allclose([a.span * scale for a in one], [b.span for b in other], rtol=1e-9, atol=0.0)


@pytest.mark.parametrize("count", [3, 4])
def test_one_given_pivot_is_used_by_all_candidates(count):
    poses = radians(SLIDER)[:count]
    place = (-0.9, -0.2)
    if count == 4:
        centre = ck.dyads(poses).curve.centres[200]
        place = (centre.real, centre.imag)
    answer = ck.synthesise(ck.tasks.poses("plate", poses), ground=[place])
    every = [*(one.candidate for one in answer), *(one.candidate for one in answer.rejected)]
    assert len(every) > 5
    for one in every:
        assert min(abs(pivot - complex(*place)) for pivot in one.pivots) < 1e-6
    off = ck.synthesise(ck.tasks.poses("plate", poses), ground=[(60, -70)])
    assert count == 3 or {one.reason for one in off.rejected} == {"region"}


def test_two_poses_and_a_velocity_have_a_dyad_for_each_centre():
    poses = random_poses(np.random.default_rng(12), 2)
    z, u = parts(poses)
    for speed in ((1, 0, 0), (0.3, -0.5, 0.8)):
        crank = ck.dyads(poses, velocities={0: speed}).with_centre((0.3, 0.4))
        assert np.max(np.abs(crank.residual(z, u))) < 1e-12
        moved = complex(*speed[:2]) + 1j * speed[2] * u[0] * crank.moving
        arm = z[0] + u[0] * crank.moving - crank.fixed
        assert abs((np.conj(moved) * arm).real) < 1e-12 * abs(moved) * abs(arm) + 1e-13


@pytest.mark.parametrize("link", ["frame", "input", "output", "", "a.b", " plate"])
def test_a_body_has_a_name_of_its_own(link: str) -> None:
    with pytest.raises(ck.errors.InvalidInput, match="link: "):
        ck.tasks.poses(link, [(0, 0, 0), (1, 0.4, 0.35), (1.6, 1.1, 0.7)])
    with pytest.raises(ck.errors.InvalidInput, match="link: "):
        ck.tasks.mixed(poses=[(0, 0, 0), (1, 0, 0.5)], points=[(2, 1)], link=link)


def test_two_fixed_pivots_are_at_two_places() -> None:
    lid = ck.tasks.poses("lid", [(0, 0, 0), (1, 0.4, 0.35), (1.6, 1.1, 0.7)])
    with pytest.raises(ck.errors.InvalidInput, match="ground: a place is given twice"):
        ck.synthesise(lid, ground=[(-0.6, -1.2), (-0.6, -1.2)])
