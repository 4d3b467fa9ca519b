"""Cams, flat faces and curved slots against the linkages that they are equal to, to accelerations."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.model.profiles import Profile
from tests.support import reference

RADIUS, MIDDLE = 30.0, 8 + 3j
TURN = np.linspace(-1.0, 8.0, 61)


def of_points() -> Profile:
    return ck.profiles.profile(MIDDLE + RADIUS * np.exp(1j * np.linspace(0.0, 2 * np.pi, 400, endpoint=False)))


def of_formula() -> Profile:
    return ck.profiles.formula(lambda s: MIDDLE + RADIUS * np.exp(1j * s), 0.0, 2 * np.pi)


def backwards() -> Profile:
    return ck.profiles.formula(lambda s: MIDDLE + RADIUS * np.exp(-1j * s), 1.0, 1.0 + 2 * np.pi)


# A quintic spline through 400 points of a circle misses it by 1e-13 of the radius, its second derivative by 1e-8.
PROFILES = {
    "disc": (ck.profiles.disc(RADIUS, MIDDLE), 1e-11),
    "formula": (of_formula(), 1e-8),
    "backwards": (backwards(), 1e-8),
    "points": (of_points(), 1e-7),
}
profiles = pytest.mark.parametrize("shape", PROFILES)
modes = pytest.mark.parametrize("sign", [1, -1])


def cam_and(*items: Any, title: str = "cam", points: Any = None) -> ck.Mechanism:
    frame = ck.link("frame", A=0, **(points or {}))
    return ck.Mechanism(title, frame, ck.link("cam", A=0), ck.drive("cam", speed=2.0), *items)


def solved(mechanism: ck.Mechanism, **words: Any) -> ck.results.Motion:
    motion = ck.solve(mechanism, {"cam": TURN}, order=3, **words)
    assert motion.assembled.all()
    return motion


def nearer(found: ck.results.Motion, linkage: ck.Mechanism, *links: str) -> ck.results.Motion:
    """The linkage in that of its two modes which is nearer to a motion."""
    both = [solved(linkage.replace(ck.mode(sign, *links))) for sign in (1, -1)]
    return min(both, key=lambda motion: apart(found, motion))


def apart(one: ck.results.Motion, other: ck.results.Motion, point: str = "P") -> list[float]:
    """How far the motions of a point differ, by derivative, in parts of the disc's radius and the speed."""
    a, b = one.points[point], other.points[point]
    return [float(np.max(np.abs(a.derivative(k) - b.derivative(k)))) / RADIUS / 2.0**k for k in range(4)]


def slider(**words: Any) -> tuple[Any, ...]:
    return ck.link("follower", P=0), ck.slide("follower", on="frame", through="X", angle=ck.deg(80), name="guide")


@profiles
@modes
@pytest.mark.parametrize("roller", [0.0, 5.0])
def test_a_translating_roller_on_an_eccentric_is_a_slider_crank(shape: str, sign: int, roller: float) -> None:
    profile, limit = PROFILES[shape]
    pair = ck.cam("follower", on="cam", profile=profile, radius=roller)
    found = solved(cam_and(*slider(), pair, ck.mode(sign, "follower"), points={"X": 6 + 2j}))
    crank = ck.link("cam", A=0, M=MIDDLE)
    rod = ck.link("rod", M=0, P=RADIUS + roller)
    linkage = cam_and(*slider(), rod, points={"X": 6 + 2j}).replace(crank)
    closed = min(
        (solved(linkage.replace(ck.mode(s, "follower", "rod"))) for s in (1, -1)), key=lambda m: apart(found, m)
    )
    assert max(apart(found, closed)[:3]) < limit


@profiles
@modes
def test_an_oscillating_roller_on_an_eccentric_is_a_four_bar(shape: str, sign: int) -> None:
    profile, limit = PROFILES[shape]
    arm = ck.link("follower", H=0, P=50)
    pair = ck.cam("follower", on="cam", at="P", profile=profile, radius=5.0)
    found = solved(cam_and(arm, pair, ck.mode(sign, "follower"), points={"H": 60 + 10j}))
    bars = ck.link("cam", A=0, M=MIDDLE), ck.link("coupler", M=0, P=35)
    linkage = cam_and(arm, bars[1], points={"H": 60 + 10j}).replace(bars[0])
    closed = nearer(found, linkage, "follower", "coupler")
    assert max(apart(found, closed)[:3]) < limit


@profiles
@pytest.mark.parametrize("side", [1, -1])
def test_a_flat_face_on_an_eccentric_is_a_scotch_yoke(shape: str, side: int) -> None:
    """s = R + q cos(cam + a): E. Soylemez, Mechanisms, section 8.4; on the other side it is seen from below."""
    profile, limit = PROFILES[shape]
    up = np.exp(1j * ck.deg(80))
    face = ck.face("follower", on="cam", profile=profile, angle=-np.pi / 2, side=-side)
    found = solved(cam_and(*slider(), face, points={"X": 6 + 2j}))
    turned = TURN + np.angle(MIDDLE) - ck.deg(80)
    q, lift = abs(MIDDLE), found.pairs["guide"]
    foot = ((6 + 2j) * np.conj(up)).real
    expected = [side * RADIUS + q * np.cos(turned) - foot, -2 * q * np.sin(turned), -4 * q * np.cos(turned)]
    for k, value in enumerate(expected):
        assert np.max(np.abs(lift.derivative(k) - value)) < limit * RADIUS * 2**k


@profiles
@modes
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("beyond", [0.0, 6.0, -20.0])
def test_an_oscillating_face_on_an_eccentric(shape: str, sign: int, side: int, beyond: float) -> None:
    """The face is at the distance R from the middle M: n . (M - H) = R + beyond, solved in closed form."""
    profile, limit = PROFILES[shape]
    arm = ck.link("follower", H=0, P=1j * beyond * -side)
    pair = ck.face("follower", on="cam", at="P", profile=profile, side=side)
    mechanism = cam_and(arm, pair, ck.mode(sign, "follower"), points={"H": 60 + 10j})
    found = solved(mechanism).links["follower"]
    toward = np.exp(1j * TURN) * MIDDLE - (60 + 10j)
    # the normal n = -1j side exp(i psi) points from the disc to the face; n . toward = beyond - R
    height = (beyond - RADIUS) / np.abs(toward)
    angle = np.angle(toward) + side * sign * (np.arcsin(height)) + (0.0 if sign > 0 else np.pi)
    assert np.max(np.abs(np.exp(1j * found.angle) - np.exp(1j * angle))) < limit
    yoke = mechanism.replace(ck.face("follower", on="cam", at="P", profile=ck.profiles.disc(RADIUS, MIDDLE), side=side))
    exact = solved(yoke).links["follower"]
    assert np.max(np.abs(found.angular_velocity - exact.angular_velocity)) < limit * 2
    assert np.max(np.abs(found.angular_acceleration - exact.angular_acceleration)) < 4 * limit


@modes
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("sense", [1, -1])
def test_an_oscillating_face_on_an_ellipse_keeps_its_mode_up_to_its_limits(sign: int, side: int, sense: int) -> None:
    """By the ellipse's support function h: h(phi) - n . c = d, c being the pin; the contact is h' - (i n) . c ahead.

    At a limit position both contacts meet in a direction that is not opposite to the middle of the ellipse.
    """
    a, b, away, far = 3.0, 2.0, 5.0, 7.5
    profile = ck.profiles.formula(lambda s: a * np.cos(sense * s) + 1j * b * np.sin(sense * s), 0.0, 2 * np.pi)
    arm = ck.link("follower", H=0, P=-1j * side * far)
    pair = ck.face("follower", on="cam", at="P", profile=profile, side=side)
    mechanism = cam_and(arm, pair, ck.mode(sign, "follower"), points={"H": away})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
        motion = ck.solve(mechanism, {"cam": np.linspace(0.0, 2 * np.pi, 241)}, order=0)
    good, phi = motion.assembled, np.linspace(-np.pi, np.pi, 4001)
    turned = motion.drives["cam"].value

    def gap(phi: Any, turned: Any) -> Any:
        h = np.sqrt((a * np.cos(phi - turned)) ** 2 + (b * np.sin(phi - turned)) ** 2)
        return h - away * np.cos(phi) - far

    highest = gap(phi, turned[:, None]).max(axis=1)
    assert np.array_equal(good, highest > 0)
    assert 0.2 < good.mean() < 0.8
    n = np.exp(1j * motion.links["follower"].angle[good]) * -1j * side
    assert np.abs(gap(np.angle(n), turned[good])).max() < 1e-9
    slope = (gap(np.angle(n) + 1e-6, turned[good]) - gap(np.angle(n) - 1e-6, turned[good])) / 2e-6
    assert (sign * side * slope > 0).all()
    assert np.abs(slope).min() < 0.5


@pytest.mark.parametrize("shape", ["disc", "formula", "points"])
@modes
@pytest.mark.parametrize("kind", ["slide", "reversed slide", "pin", "profile on the slide", "profile on the pin"])
def test_modes_are_those_of_the_linkage_for_a_disc(shape: str, sign: int, kind: str) -> None:
    """A disc is solved as a dyad, other profiles by searching them: the same mode gives the same pose."""

    def mechanism(profile: Profile) -> ck.Mechanism:
        crank = ck.link("crank", A=0, Q=20)
        base = [ck.link("frame", A=0, H=60 + 10j, X=6), crank, ck.drive("crank", values=TURN)]
        item: list[Any]
        if "profile" in kind:
            item = [ck.link("follower", H=0, P=50)] if "pin" in kind else [ck.link("follower", P=0)]
            item += [ck.cam("crank", at="Q", on="follower", profile=profile, radius=5)]
            item += [] if "pin" in kind else [ck.slide("follower", on="frame", at="P", through="X", angle=0.3, turn=1)]
        else:
            item = [ck.link("follower", H=0, P=50)] if kind == "pin" else [ck.link("follower", P=0)]
            item += [ck.cam("follower", at="P", on="crank", profile=profile, radius=5)]
        if kind == "slide":
            item += [ck.slide("follower", on="frame", through="X", angle=0.3)]
        if kind == "reversed slide":
            item += [ck.slide("frame", on="follower", at="X", through="P", angle=0.3, turn=1)]
        return ck.Mechanism(kind, *base, *item, ck.mode(sign, "follower"))

    middle = 50.0 if kind == "profile on the pin" else 8.0
    shapes = {
        "disc": ck.profiles.disc(30, middle),
        "formula": ck.profiles.formula(lambda s: middle + 30 * np.exp(1j * s), 0.0, 2 * np.pi),
        "points": ck.profiles.profile(middle + 30 * np.exp(1j * np.linspace(0.0, 2 * np.pi, 400, endpoint=False))),
    }
    found, exact = ck.solve(mechanism(shapes[shape])), ck.solve(mechanism(ck.profiles.disc(30, middle)))
    assert exact.assembled.all()
    assert np.max(np.abs(found.points["P"].position - exact.points["P"].position)) < 1e-6
    gap = np.exp(1j * found.links["follower"].angle) - np.exp(1j * exact.links["follower"].angle)
    assert np.max(np.abs(gap)) < 1e-8


# --- rings, slots, carriers ---------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", ["disc", "formula"])
def test_a_roller_inside_a_ring(shape: str) -> None:
    """Its middle is R - r from that of the ring."""
    profile = PROFILES[shape][0]
    pair = ck.cam("follower", on="cam", profile=profile, radius=5.0, inside=True)
    found = solved(cam_and(*slider(), pair, points={"X": 6 + 2j}))
    middle = np.exp(1j * TURN) * MIDDLE
    assert np.max(np.abs(np.abs(found.points["P"].position - middle) - (RADIUS - 5.0))) < 1e-9
    assert ck.verify(found).passed


@pytest.mark.parametrize("radius", [31, np.array([[32.0], [31.0]])], ids=["one", "of several designs"])
def test_a_roller_that_does_not_fit_into_its_ring(radius: Any) -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match=r"of radius 3[12] does not fit into a ring of radius 30"):
        cam_and(
            *slider(),
            ck.cam("follower", on="cam", profile=ck.profiles.disc(30), radius=radius, inside=True),
            points={"X": 0},
        )


def test_a_design_of_several_whose_roller_does_not_fit() -> None:
    ring = ck.cam("follower", on="cam", profile=ck.profiles.disc(30), radius=np.array([[10.0], [31.0]]), inside=True)
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(cam_and(*slider(), ring, points={"X": 0}))
    assert motion.assembled[0].all()
    assert not motion.assembled[1].any()
    assert [gap.reason for gap in ck.gaps(motion)] == ["a roller of radius 31 does not fit into a ring of radius 30"]


@pytest.mark.parametrize("shape", ["points", "formula"])
def test_a_pin_in_a_parabolic_slot(shape: str) -> None:
    """The slot y = x^2 / 40 of a plate that slides along x lifts a pin on the vertical through x = 10."""
    x = np.linspace(-40.0, 40.0, 81)
    slot = {
        "points": ck.profiles.profile(x + 1j * x**2 / 40, closed=False),
        "formula": ck.profiles.formula(lambda s: s + 1j * s**2 / 40, -40.0, 40.0, closed=False),
    }[shape]
    mechanism = ck.Mechanism(
        "Slot",
        ck.link("frame", A=0, X=10),
        ck.link("plate", O=0),
        ck.link("pin", P=0),
        ck.slide("plate", on="frame", through="A"),
        ck.slide("pin", on="frame", through="X", angle=np.pi / 2, name="lift"),
        ck.cam("pin", on="plate", profile=slot),
        ck.drive("plate", values=np.linspace(-25.0, 45.0, 71), speed=3.0),
    )
    motion = ck.solve(mechanism)
    u = 10.0 - np.linspace(-25.0, 45.0, 71)
    lift = motion.pairs["lift"]
    limit = 1e-9 if shape == "formula" else 1e-6
    assert np.max(np.abs(lift.value - u**2 / 40)) < limit
    assert np.max(np.abs(lift.rate + 3 * u / 20)) < limit * 10
    assert np.max(np.abs(lift.second - 9 / 20)) < limit * 100
    assert ck.verify(motion).passed


def test_where_a_slot_ends_the_pin_is_lost() -> None:
    slot = ck.profiles.formula(lambda s: s + 1j * s**2 / 40, -40.0, 40.0, closed=False)
    mechanism = ck.Mechanism(
        "Slot",
        ck.link("frame", A=0, X=10),
        ck.link("plate", O=0),
        ck.link("pin", P=0),
        ck.slide("plate", on="frame", through="A"),
        ck.slide("pin", on="frame", through="X", angle=np.pi / 2),
        ck.cam("pin", on="plate", profile=slot),
        ck.drive("plate", values=np.linspace(0.0, 60.0, 61)),
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
        (gap,) = ck.gaps(ck.solve(mechanism))
    assert abs(gap.begin["plate"] - 50.0) < 1e-7
    assert gap.reason == "on its way P does not meet the profile of plate between its ends (-40, 40) and (40, 40)"


def test_a_follower_whose_path_misses_the_profile() -> None:
    """A guide 45 from the axis of an oval that reaches less far for a part of the turn, a roller of 5 on it."""
    oval = ck.profiles.formula(lambda s: 30 * np.cos(s) + 24j * np.sin(s) + 12, 0.0, 2 * np.pi)
    items = ck.link("follower", P=0), ck.slide("follower", on="frame", through="X", angle=np.pi / 2)
    mechanism = cam_and(*items, ck.cam("follower", on="cam", profile=oval, radius=5), points={"X": 45})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
        (gap,) = ck.gaps(ck.solve(mechanism, {"cam": np.linspace(0.0, np.pi, 181)}))
    assert gap.reason == "on its way P does not meet the profile of cam"
    # the farthest point to the right of the turned oval is sqrt(30^2 cos^2 + 24^2 sin^2) + 12 cos = 40 away
    a = gap.begin["cam"]
    assert abs(np.hypot(30 * np.cos(a), 24 * np.sin(a)) + 12 * np.cos(a) - 40.0) < 1e-6


def test_a_cam_carried_by_the_moving_follower() -> None:
    """An arm with a profile rests on a fixed pin: the distance of the pin from the arm's disc stays what it is."""
    oval = ck.profiles.formula(lambda s: 30 * np.cos(s) + 20j * np.sin(s) + 50, 0.0, 2 * np.pi)
    mechanism = ck.Mechanism(
        "Inverted cam",
        ck.link("frame", A=0, G=(60, 10)),
        ck.link("crank", A=0, Q=20),
        ck.link("follower", G=0, E=50),
        ck.cam("crank", at="Q", on="follower", profile=oval, radius=5),
        ck.drive("crank", speed=3.0),
    )
    motion = ck.solve(mechanism, {"crank": TURN}, order=3)
    assert motion.assembled.all()
    assert ck.verify(motion).passed
    pin = motion.links["follower"]
    local = (motion.points["Q"].position - (60 + 10j)) / np.exp(1j * pin.angle)
    s = np.linspace(0.0, 2 * np.pi, 200001)
    curve = 30 * np.cos(s) + 20j * np.sin(s) + 50
    nearest = [np.min(np.abs(curve - p)) for p in np.asarray(local)]
    assert np.max(np.abs(np.array(nearest) - 5.0)) < 1e-6
    found = ck.figures.cam_analysis(motion, "crank/follower")
    assert found.follower == "follower"
    assert found.oscillates is True


def test_a_cam_on_a_moving_carrier() -> None:
    """Cam, pivot and roller on a coupler: relative to it the follower moves as it does on the frame."""
    oval = ck.profiles.formula(lambda s: 30 * np.cos(s) + 22j * np.sin(s) + 4, 0.0, 2 * np.pi)
    parts = ck.link("cam", C=0), ck.link("follower", H=0, P=50)
    pair = ck.cam("follower", on="cam", at="P", profile=oval, radius=5)
    moving = ck.Mechanism(
        "Carried",
        ck.link("frame", A=0),
        ck.link("arm", A=0, C=(100, 0), H=(160, 10)),
        *parts,
        pair,
        ck.drive("arm", speed=0.7),
        ck.drive("cam", on="arm", speed=2.0),
    )
    fixed = ck.Mechanism("Fixed", ck.link("frame", C=0, H=(60, 10)), *parts, pair, ck.drive("cam", speed=2.0))
    carried = ck.solve(moving, {"arm": 0.35 * TURN, "cam": TURN})
    still = ck.solve(fixed, {"cam": TURN})
    gap = carried.links["follower"].angle - carried.links["arm"].angle - still.links["follower"].angle
    assert np.max(np.abs(np.exp(1j * gap) - 1)) < 1e-12
    for k in ("angular_velocity", "angular_acceleration"):
        own = getattr(carried.links["follower"], k) - getattr(carried.links["arm"], k)
        assert np.max(np.abs(own - getattr(still.links["follower"], k))) < 1e-10
    assert ck.verify(carried).passed


# --- rollers, structure --------------------------------------------------------------------------------------


def with_roller() -> tuple[ck.Mechanism, ck.Mechanism]:
    """The same mechanism with the roller as a link of its own, and as a radius of the follower."""
    oval = ck.profiles.formula(lambda s: 30 * np.cos(s) + 22j * np.sin(s) + 4, 0.0, 2 * np.pi)
    own = ck.link("roller", P=0), ck.cam("roller", on="cam", profile=oval, radius=5)
    slide = ck.link("follower", P=0), ck.slide("follower", on="frame", at="P", through="A", angle=np.pi / 2)
    return cam_and(*slide, *own), cam_and(*slide, ck.cam("follower", on="cam", profile=oval, radius=5))


def test_a_roller_as_a_link_turns_without_effect() -> None:
    """`dec_roller_cam`: two freedoms by the count of Gruebler, one of them the idle spin of the roller."""
    entry = reference("dec_roller_cam", "decomposition")
    rolling, plain = with_roller()
    structure = ck.decompose(rolling)
    assert structure.mobility.freedoms == entry["expected"]["gruebler_F"] - 1
    (passive,) = structure.passive
    assert (passive.link, passive.on, passive.at) == ("roller", "follower", "P")
    assert not structure.faults
    one, other = solved(rolling), solved(plain)
    assert max(apart(one, other)) < 1e-12
    assert np.max(np.abs(one.links["roller"].angular_velocity)) < 1e-12
    found = ck.figures.cam_analysis(one, "roller/cam")
    assert found.follower == "follower"
    assert np.allclose(found.pressure_angle, ck.figures.cam_analysis(other, "follower/cam").pressure_angle, atol=1e-12)


def test_a_roller_on_a_rod_of_a_larger_group() -> None:
    """A bell crank's rod runs on the cam: rod and lever are found together, without a closed form."""
    oval = ck.profiles.formula(lambda s: 20 * np.cos(s) + 15j * np.sin(s) + 3, 0.0, 2 * np.pi)
    mechanism = ck.Mechanism(
        "Rod on a cam",
        ck.link("frame", A=0, H=(70, 0), X=(0, 18)),
        ck.link("cam", A=0),
        ck.link("lever", H=0, J=40),
        ck.link("rod", J=0, R=55, S=(80, 0)),
        ck.link("block", S=0),
        ck.slide("block", on="frame", through="X", angle=0),
        ck.cam("rod", on="cam", at="R", profile=oval, radius=4),
        ck.drive("cam", values=np.linspace(0.0, 2 * np.pi, 73), speed=2.0),
        ck.drawn(H=(70, 0), J=(60, 38.7), R=(10, 25), S=(-17, 18)),
    )
    motion = ck.solve(mechanism)
    assert (
        "F" in "".join(g.name for g in ck.decompose(mechanism).groups)
        or len(ck.decompose(mechanism).groups[0].bodies) == 3
    )
    assert motion.assembled.all()
    assert ck.verify(motion).passed


def test_designs_of_rollers() -> None:
    """An array of radii: each design is the mechanism with its own radius."""
    oval = ck.profiles.formula(lambda s: 30 * np.cos(s) + 22j * np.sin(s) + 4, 0.0, 2 * np.pi)
    radii = np.array([2.0, 5.0, 9.0])

    def mechanism(radius: Any) -> ck.Mechanism:
        return cam_and(*slider(), ck.cam("follower", on="cam", profile=oval, radius=radius), points={"X": 6})

    together = ck.solve(mechanism(radii[:, None]), {"cam": TURN})
    assert together.shape == (3, TURN.size)
    for k, radius in enumerate(radii):
        alone = ck.solve(mechanism(float(radius)), {"cam": TURN})
        for name in ("position", "velocity", "acceleration"):
            own, other = getattr(together.points["P"], name)[k], getattr(alone.points["P"], name)
            assert np.max(np.abs(own - other)) < 1e-9


def test_instant_centres_by_the_common_normal() -> None:
    """The centre of cam and follower is where the common normal meets the line square to the guide through the axis."""
    motion = solved(with_roller()[1])
    centre = ck.instant_centres(motion)["cam", "follower"].point
    found = ck.figures.cam_analysis(motion, "follower/cam")
    middle = motion.points["P"].position
    normal = (middle - found.contact) / 5.0
    assert np.max(np.abs(np.abs(normal) - 1.0)) < 1e-9
    assert np.max(np.abs((np.conj(normal) * (np.asarray(centre) - middle)).imag)) < 1e-9
    assert np.max(np.abs(np.asarray(centre).imag)) < 1e-9
    # the follower has the velocity of the cam's point at the centre
    assert np.max(np.abs(2.0j * np.asarray(centre) - motion.points["P"].velocity)) < 1e-9


def test_a_profile_that_crosses_itself_is_refused_with_the_place() -> None:
    eight = ck.profiles.formula(lambda s: 30 * np.sin(s) + 1j * 20 * np.sin(2 * s), 0.0, 2 * np.pi)
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        cam_and(*slider(), ck.cam("follower", on="cam", profile=eight), points={"X": 0})
    (problem,) = caught.value.problems
    assert problem.where == "cams[0].profile"
    x, y = (float(v) for v in problem.what.split("(")[1].rstrip(")").split(","))
    assert abs(complex(x, y)) < 1e-6


@pytest.mark.parametrize(
    ("words", "place", "what"),
    [
        ({"link": "fllower"}, "cams[0].link", "no link 'fllower'"),
        ({"on": "follower"}, "cams[0].on", "cannot run on itself"),
        ({"at": "Q"}, "cams[0].at", "no point 'Q'"),
        ({"radius": -1.0}, "cams[0].radius", "is not a length"),
        ({"radius": np.nan}, "cams[0].radius", "not finite"),
        ({"profile": ck.profiles.disc(-3)}, "cams[0].profile.radius", "not a positive length"),
        ({"profile": ck.profiles.profile([0, 1, 1j])}, "cams[0].profile.points", "3 points are too few"),
    ],
)
def test_mistakes_in_a_cam_have_a_place(words: dict[str, Any], place: str, what: str) -> None:
    given = {"link": "follower", "on": "cam", "profile": ck.profiles.disc(30), **words}
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        cam_and(*slider(), ck.cam(**given), points={"X": 0})
    assert any(p.where == place and what in p.what for p in caught.value.problems), caught.value


def test_a_word_is_no_profile() -> None:
    with pytest.raises(ck.errors.InvalidInput, match=r"profile: 'oval' is no profile; profiles\.disc"):
        ck.cam("follower", on="cam", profile="oval")  # type: ignore[arg-type]


def test_a_larger_group_says_where_its_slot_may_end() -> None:
    """The rod's pin runs in an open groove of the turning plate, which it leaves as the plate turns on."""
    x = np.linspace(-6.0, 30.0, 13)
    mechanism = ck.Mechanism(
        "Rod in a groove",
        ck.link("frame", A=0, H=(70, 0), X=(0, 18)),
        ck.link("plate", A=0),
        ck.link("lever", H=0, J=40),
        ck.link("rod", J=0, R=55, S=(80, 0)),
        ck.link("block", S=0),
        ck.slide("block", on="frame", through="X", angle=0),
        ck.cam("rod", on="plate", at="R", profile=ck.profiles.profile(x + 1j * (23 + x**2 / 400), closed=False)),
        ck.drive("plate", values=ck.deg(np.arange(0.0, 61.0, 2.0))),
        ck.drawn(H=(70, 0), J=(60, 38.7), R=(10, 25), S=(-17, 18)),
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
        motion = ck.solve(mechanism)
        found = ck.gaps(motion)
    assert motion.assembled[0]
    assert found
    assert "or where R leaves the profile of plate at an end" in found[-1].reason
