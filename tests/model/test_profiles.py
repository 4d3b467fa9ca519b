"""Profiles made for a motion program: the mechanism with the cam moves by the program again."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.model.laws.motion_programs import Program
from compoundkin.model.profiles.synthesised import Synthesised, least_base, synthesise

SPEED = 2.0
ANGLES = np.linspace(-1.0, 12.0, 700)


def lift(amount: float, law: str = "cycloidal") -> Program:
    return ck.laws.program(
        ck.laws.dwell(ck.deg(60)),
        ck.laws.rise(amount, ck.deg(110), law),
        ck.laws.dwell(ck.deg(40)),
        ck.laws.fall(amount, ck.deg(90), law),
        ck.laws.dwell(ck.deg(60)),
    )


def mechanism(cam: Synthesised, profile: Any = None) -> ck.Mechanism:
    """The mechanism as the documentation of `synthesise` says to write it."""
    shape = profile or cam
    items: tuple[Any, ...]
    if cam.pivot is not None:
        items = (ck.link("frame", A=0, H=cam.pivot), ck.link("follower", H=0, P=cam.arm or 1j * cam.side * cam.face))
    else:
        guide = ck.slide("follower", on="frame", through="A", angle=cam.angle, offset=cam.offset, name="guide")
        items = (ck.link("frame", A=0), ck.link("follower", P=0), guide)
    if cam.follower != "flat":
        pair = ck.cam("follower", on="cam", at="P", profile=shape, radius=cam.roller)
    elif cam.oscillates:
        pair = ck.face("follower", on="cam", at="P", profile=shape, angle=0, side=-cam.side)  # type: ignore[assignment]
    else:
        pair = ck.face("follower", on="cam", at="P", profile=shape, angle=np.pi / 2, side=1)  # type: ignore[assignment]
    return ck.Mechanism("m", *items, ck.link("cam", A=0), pair, ck.drive("cam"), ck.mode(cam.mode, "follower"))


def wanted(cam: Synthesised, angles: Any) -> list[Any]:
    """The follower's coordinate and rates at the program's places, its home found by plain trigonometry."""
    at = np.mod((angles - cam.start) * (-1 if cam.clockwise else 1), 2 * np.pi)
    rate = -SPEED if cam.clockwise else SPEED
    from compoundkin.base.series import Series

    s = [cam.program.at(Series((at, rate, 0.0 * at, 0.0 * at))).derivative(k) for k in range(3)]
    prime = cam.base + cam.roller
    if cam.pivot is None:
        home = prime if cam.follower == "flat" else np.sqrt(prime**2 - cam.offset**2)
        return [home + s[0], *s[1:]]
    apart, toward = abs(cam.pivot), np.angle(-cam.pivot)
    if cam.follower == "flat":
        opening = np.arcsin((cam.base - cam.face) / apart)
    else:
        opening = np.arccos((cam.arm**2 + apart**2 - prime**2) / (2 * cam.arm * apart))
    return [toward + cam.side * (opening + s[0]), cam.side * s[1], cam.side * s[2]]


def errors(cam: Synthesised, profile: Any = None) -> list[float]:
    """How far the solved motion is from the program, in parts of the lift, away from the program's jumps."""
    motion = ck.solve(mechanism(cam, profile), {"cam": ANGLES}, speed=SPEED)
    assert motion.assembled.all()
    if cam.oscillates:
        link = motion.links["follower"]
        found = [link.angle, link.angular_velocity, link.angular_acceleration]
    else:
        guide = motion.pairs["guide"]
        found = [guide.value, guide.rate, guide.second]
    at = np.mod((ANGLES - cam.start) * (-1 if cam.clockwise else 1), 2 * np.pi)
    jumps = [one.place for one in cam.program.discontinuities(repeat=True)]
    smooth = np.all([np.abs(at - place) > 1e-9 for place in [0.0, 2 * np.pi, *jumps]], axis=0)
    out = []
    for k, (a, b) in enumerate(zip(found, wanted(cam, ANGLES), strict=True)):
        gap = a - b
        gap = gap - 2 * np.pi * np.round(gap / (2 * np.pi)) if cam.oscillates and k == 0 else gap
        out.append(float(np.max(np.abs(gap[smooth]))) / cam.program.lift / SPEED**k)
    return out


KINDS: dict[str, dict[str, Any]] = {
    "knife": {"base": 60, "offset": 7},
    "roller": {"base": 40, "follower": "roller", "roller": 10, "offset": -7, "angle": 1.0},
    "flat": {"base": 100, "follower": "flat", "angle": 2.0},
    "oscillating knife": {"base": 40, "pivot": (80, 20), "arm": 65},
    "oscillating roller": {"base": 40, "follower": "roller", "roller": 10, "pivot": -80, "arm": 65},
    "oscillating flat": {"base": 60, "follower": "flat", "face": 12, "pivot": 120},
}


def made(kind: str, law: str = "cycloidal", **more: Any) -> Synthesised:
    words = {**KINDS[kind], **more}
    amount = ck.deg(8.0) if kind == "oscillating flat" else ck.deg(20.0) if "pivot" in words else 20.0
    return synthesise(lift(amount, law), **words)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("law", ["cycloidal", "modified-trapezoid", "4-5-6-7", "parabolic", "harmonic"])
def test_every_follower_moves_by_its_program(kind: str, law: str) -> None:
    cam = made(kind, law, start=0.7)
    found = errors(cam)
    assert found[0] < 1e-12
    assert found[1] < 1e-12
    assert found[2] < 1e-11


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("clockwise", [False, True])
@pytest.mark.parametrize("side", [1, -1])
def test_ways_of_turning_and_sides(kind: str, clockwise: bool, side: int) -> None:
    more = {"side": side} if "pivot" in KINDS[kind] else {"angle": side * 1.2}
    assert max(errors(made(kind, clockwise=clockwise, start=-2.0, **more))) < 1e-11


@pytest.mark.parametrize("kind", KINDS)
def test_a_cam_through_points_of_the_made_one(kind: str) -> None:
    """720 points: a hundredth of a micrometre on a lift of 20 mm."""
    cam = made(kind)
    points = cam.curve.at(np.linspace(0.0, 2 * np.pi, 720, endpoint=False)).c[0]
    found = errors(cam, ck.profiles.profile(points))
    assert found[0] < 1e-6
    assert found[1] < 1e-4


@pytest.mark.parametrize("kind", KINDS)
def test_the_parameter_is_the_angle_of_the_cam(kind: str) -> None:
    cam = made(kind, start=0.3)
    motion = ck.solve(mechanism(cam), {"cam": np.linspace(0.1, 6.1, 61)})
    parameter = ck.figures.cam_analysis(motion, "follower/cam").parameter
    assert np.max(np.abs(parameter - np.linspace(0.1, 6.1, 61))) < 1e-9


def test_the_base_circle_is_the_least_radius() -> None:
    """In a dwell at the bottom the cam is its base circle about the axis, at the top one greater by the lift."""
    for kind in ("knife", "roller", "flat", "oscillating roller"):
        cam = made(kind)
        radii = np.abs(cam.curve.samples.points)
        assert abs(np.min(radii) - cam.base) < 1e-12 * cam.base
    for kind in ("roller", "flat"):
        assert abs(np.max(np.abs(made(kind, offset=0.0).curve.samples.points)) - made(kind).base - 20.0) < 1e-9


def test_the_radius_under_a_flat_face() -> None:
    """rho = base + S + S'', least 11.796987 at 73.668 degrees: cycloidal rise of 20 over 100 degrees, base 35."""
    program = ck.laws.program(
        ck.laws.rise(20, ck.deg(100)),
        ck.laws.dwell(ck.deg(80)),
        ck.laws.fall(20, ck.deg(100)),
        ck.laws.dwell(ck.deg(80)),
    )
    cam = synthesise(program, base=35, follower="flat")
    s = np.linspace(0.0, ck.deg(100), 10_001)
    u = s / ck.deg(100)
    rise = 20 * (u - np.sin(2 * np.pi * u) / (2 * np.pi))
    bend = 20 * 2 * np.pi * np.sin(2 * np.pi * u) / ck.deg(100) ** 2
    assert np.max(np.abs(cam.envelope.radius(s) - (35 + rise + bend))) < 1e-10
    assert abs(np.min(cam.envelope.radius(s)) - 11.796987) < 1e-5


def test_the_least_base_circle_under_a_flat_face() -> None:
    """-(S + S'') at most: found by search and by the formula."""
    program = ck.laws.program(
        ck.laws.rise(20, ck.deg(100)),
        ck.laws.dwell(ck.deg(80)),
        ck.laws.fall(20, ck.deg(100)),
        ck.laws.dwell(ck.deg(80)),
    )
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        synthesise(program, base=20, follower="flat")
    (problem,) = caught.value.problems
    assert "hollow" in problem.what
    least = 35 - 11.796987
    assert f"a base circle of {least:.2f}"[:-1] in problem.remedy
    assert abs((least_base(Synthesised(program, 20.0, "flat")) or 0.0) - least) < 1e-4


def test_the_least_base_circle_of_a_roller() -> None:
    """The pitch curve of a radial follower at the top of a harmonic rise: rho = (p + h)^2 / (p + h - S'')."""
    program = ck.laws.program(
        ck.laws.rise(20, ck.deg(90), "harmonic"), ck.laws.fall(20, ck.deg(90), "harmonic"), ck.laws.dwell(np.pi)
    )
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        synthesise(program, base=2, follower="roller", roller=30)
    (problem,) = caught.value.problems
    assert "undercut" in problem.what
    least = least_base(Synthesised(program, 2.0, "roller", 30.0))
    assert least is not None
    # S'' = -h / 2 (pi / beta)^2 = -40 at the top: (p + 20)^2 = 30 (p + 20 + 40)
    top = (30 + np.sqrt(30**2 + 4 * 30 * 40)) / 2
    assert abs(least + 30 - (top - 20)) < 1e-3
    between = problem.what.split("angles of ")[1].split(" degrees")[0]
    low, high = (float(v) for v in between.split(" to "))
    assert low < 90 < high
    synthesise(program, base=least, follower="roller", roller=30)


GOOD = lift(20.0)


@pytest.mark.parametrize(
    ("program", "words", "place", "what"),
    [
        (GOOD, {"base": 30, "offset": 40}, "offset", "does not meet the prime circle"),
        (GOOD, {"base": -3}, "base", "radius -3"),
        (GOOD, {"base": np.nan}, "base", "not a finite number"),
        (GOOD, {"base": [30, 40]}, "base", "is no number"),
        (GOOD, {"base": 30, "follower": "rollr"}, "follower", "no follower 'rollr'"),
        (GOOD, {"base": 30, "follower": "roller"}, "roller", "radius 0"),
        (GOOD, {"base": 30, "roller": 4}, "roller", "a knife follower has no roller"),
        (GOOD, {"base": 30, "arm": 4}, "arm", "translating follower has no arm"),
        (GOOD, {"base": 30, "pivot": 80, "arm": 60, "offset": 3}, "offset", "no offset"),
        (GOOD, {"base": 30, "pivot": 80, "arm": 60, "side": 2}, "side", "not a side"),
        (lift(0.2), {"base": 30, "pivot": 80, "arm": 20}, "arm", "does not reach the prime circle of radius 30"),
        (lift(0.2), {"base": 30, "pivot": 80}, "arm", "length 0"),
        (lift(3.0), {"base": 30, "pivot": 80, "arm": 60}, "arm", "beyond its stretched position"),
        (lift(0.2), {"base": 90, "pivot": 80, "follower": "flat"}, "face", "does not reach the base circle"),
        (lift(1.2), {"base": 50, "pivot": 80, "follower": "flat"}, "program", "must stay below 90"),
        (lift(0.2), {"base": 30, "pivot": 0, "arm": 30}, "pivot", "on the axis"),
        (lift(0.2), {"base": 30, "pivot": "x", "arm": 30}, "pivot", "not a point"),
        (
            ck.laws.program(ck.laws.rise(9, 3.0), ck.laws.fall(9, 3.0)),
            {"base": 30},
            "program",
            "add up to 343.775 degrees",
        ),
        (
            ck.laws.program(ck.laws.rise(9, np.pi), ck.laws.fall(7, np.pi)),
            {"base": 30},
            "program",
            "ends 2 above its beginning",
        ),
        (
            ck.laws.program(ck.laws.fall(9, np.pi), ck.laws.rise(9, np.pi)),
            {"base": 30},
            "program",
            "9 below the base circle",
        ),
        (lift(9, "constant-velocity"), {"base": 30, "follower": "flat"}, "program", "velocity jumps at 60, 170"),
        ("rise", {"base": 30}, "program", "is no program"),
    ],
)
def test_what_cannot_be_made_says_why(program: Any, words: dict[str, Any], place: str, what: str) -> None:
    with pytest.raises((ck.errors.InvalidMechanism, ck.errors.InvalidInput)) as caught:
        synthesise(program, **words)
    found = [(p.where, str(p)) for p in caught.value.problems]
    assert any(where == place and what in text for where, text in found), found


def test_a_mechanism_names_the_place_of_a_profile_that_cannot_be_made() -> None:
    bad = Synthesised(GOOD, 30.0, offset=40.0)
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        mechanism(Synthesised(GOOD, 30.0, offset=10.0), bad)
    assert [p.where for p in caught.value.problems] == ["cams[0].profile.offset"]


def test_a_heart_cam_has_corners_and_a_knife_edge_follows_it() -> None:
    """Constant velocity up and down: two arcs of the spiral of Archimedes."""
    program = ck.laws.program(
        ck.laws.rise(30, np.pi, "constant-velocity"), ck.laws.fall(30, np.pi, "constant-velocity")
    )
    cam = synthesise(program, base=20)
    assert max(errors(cam)[:2]) < 1e-9


def test_a_program_that_starts_above_the_base_circle() -> None:
    program = ck.laws.program(ck.laws.fall(9, np.pi), ck.laws.rise(9, np.pi), start=9.0)
    cam = synthesise(program, base=30)
    assert max(errors(cam)) < 1e-11
    assert abs(abs(complex(cam.curve.at(np.pi).c[0])) - 30.0) < 1e-12


def test_profiles_are_equal_by_what_they_say() -> None:
    assert made("roller") == made("roller")
    assert made("roller") != made("roller", start=0.1)
    assert ck.profiles.disc(3) == ck.profiles.disc(3.0)
    assert ck.profiles.profile([1, 1j, -1, -1j]) == ck.profiles.profile([(1, 0), (0, 1), (-1, 0), (0, -1)])
