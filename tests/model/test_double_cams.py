"""Conjugate cams and cams of constant breadth: both ends in contact, measured without the formulas that made them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import compoundkin as ck
from compoundkin.model.laws import Program, dwell, fall, program, rise
from compoundkin.model.profiles.double_cams import DoubleCam
from compoundkin.profiles import cam_mechanism, conjugate, constant_breadth

TURN = 2.0 * np.pi
# Lengths are about 100.
CLOSED = 1e-9


def lift(height: float) -> Program:
    """No symmetry, and two laws."""
    parts = (rise(height, ck.deg(120)), dwell(ck.deg(40)), fall(height, ck.deg(110), "3-4-5"), dwell(ck.deg(90)))
    return program(*parts)


def slow(height: float) -> Program:
    return program(rise(height, ck.deg(150)), dwell(ck.deg(30)), fall(height, ck.deg(180)))


STEEP = program(rise(10, 1.1), fall(10, TURN - 1.1))
# A yoke's: each rise is answered by an equal fall half a turn later.
EVEN = program(
    rise(8, ck.deg(60), "3-4-5"), dwell(ck.deg(30)), rise(17, ck.deg(90)),
    fall(8, ck.deg(60), "3-4-5"), dwell(ck.deg(30)), fall(17, ck.deg(90)),
)  # fmt: skip
WAYS: dict[str, Callable[..., DoubleCam]] = {
    "translating rollers": lambda **more: conjugate(
        lift(30), base=40, second_base=45, roller=10, second_roller=8, offset=-8, angle=0.3, **more
    ),
    "translating faces": lambda **more: conjugate(slow(10), base=60, second_base=70, follower="flat", **more),
    "rocker, two rollers": lambda **more: conjugate(
        lift(ck.deg(25)), base=40, second_base=30, roller=10, pivot=(80, 10), arm=60, second_arm=65, **more
    ),
    "rocker, clockwise rise": lambda **more: conjugate(
        lift(ck.deg(25)), base=40, roller=10, pivot=(80, 10), arm=60, side=-1, **more
    ),
    "rocker, two faces": lambda **more: conjugate(
        slow(ck.deg(5)), base=50, pivot=(130, 0), face=5, second_face=3, follower="flat", **more
    ),
    "yoke, faces": lambda **more: constant_breadth(EVEN, base=90, **more),
    "yoke, rollers": lambda **more: constant_breadth(EVEN, base=50, follower="roller", roller=10, angle=0.3, **more),
}
OTHER = {"clockwise": True, "start": 0.4}
CASES = [*((name, {}) for name in WAYS), ("translating rollers", OTHER), ("rocker, two faces", OTHER)]


def nearest(made: Any, place: complex) -> float:
    """The distance from a curve, by trying its points."""
    return _least(lambda s: np.abs(made.curve.at(s).c[0] - place))


def breadth(made: Any, direction: float) -> float:
    """How far the curve reaches in a direction, by trying its points."""
    return -_least(lambda s: -(made.curve.at(s).c[0] * np.exp(-1j * direction)).real)


def _least(f: Callable[[Any], Any]) -> float:
    s = np.linspace(0.0, TURN, 4001)
    k = int(np.argmin(f(s)))
    found = minimize_scalar(
        f, bounds=(s[max(k - 1, 0)], s[min(k + 1, 4000)]), method="bounded", options={"xatol": 1e-9}
    )
    return float(min(found.fun, f(s[k])))


@pytest.mark.parametrize(("name", "turning"), CASES)
def test_both_ends_touch_and_the_follower_keeps_its_program(name: str, turning: dict[str, Any]) -> None:
    cams = WAYS[name](**turning)
    made = cam_mechanism(cams)
    motion = ck.solve(made)
    assert motion.assembled.all()
    assert [pair.name for pair in motion.structure.redundant] == ["follower/cam 2"]
    # the program, as it was written
    sense = -1.0 if turning else 1.0
    angle = motion.drives["cam"].value
    wanted = _values(cams.first.program, sense * (angle - cams.first.start))
    rocks = cams.oscillates
    along = motion.points["P"].position * np.exp(-1j * cams.first.angle)
    coordinate = cams.first.side * motion.links["follower"].angle if rocks else along.real
    np.testing.assert_allclose(coordinate - coordinate[0], wanted - wanted[0], atol=CLOSED)
    # the second end, measured in the frame of the disc
    for k in (3, 30, 55):
        turn = np.exp(-1j * angle[k])
        if cams.first.follower != "flat":
            gap = nearest(cams.second, motion.points["Q"].position[k] * turn) - cams.second.roller
        else:
            gap = _off_face(cams, motion, k)
        assert abs(gap) < CLOSED


def _values(wanted: Program, q: Any) -> Any:
    return wanted.coordinate(np.mod(q, TURN), 0).c[0]


def _off_face(cams: DoubleCam, motion: Any, k: int) -> float:
    """How far the second face is from the second disc, along the face's normal away from it."""
    q, angle = motion.points["Q"].position[k], motion.drives["cam"].value[k]
    # a face is square to the line from the first to the second one, or lies along the second arm
    turned = motion.links["follower"].angle[k] - cams.first.side * cams.apart
    normal = turned - cams.first.side * np.pi / 2 if cams.oscillates else cams.first.angle + np.pi
    return float((q * np.exp(-1j * normal)).real - breadth(cams.second, normal - angle))


@pytest.mark.parametrize("directions", [np.linspace(0.1, 3.0, 12)])
def test_the_breadth_of_a_yoke_cam_is_the_same_in_every_direction(directions: Any) -> None:
    """By the support function, whose sum over both directions is the breadth (L. Euler 1778; Rademacher, Toeplitz)."""
    cams = WAYS["yoke, faces"]()
    wide = [breadth(cams.first, a) + breadth(cams.first, a + np.pi) for a in directions]
    assert cams.apart == pytest.approx(2 * 90 + 25)
    np.testing.assert_allclose(wide, cams.apart, atol=CLOSED)
    # Barbier's theorem: the circumference of a curve of constant breadth is pi times that
    assert cams.first.curve.length == pytest.approx(np.pi * cams.apart, rel=1e-6)
    rollers = WAYS["yoke, rollers"]()
    pitch = rollers.first.pitch_curve
    assert pitch is not None
    across = np.abs(pitch.at(directions).c[0] - pitch.at(directions + np.pi).c[0])
    np.testing.assert_allclose(across, rollers.apart, atol=CLOSED)
    assert rollers.apart == pytest.approx(2 * 60 + 25)


def test_the_harmonic_yoke_is_an_eccentric_disc() -> None:
    """With flat faces s = e (1 - cos q) is made by a disc of radius base + e, off its axis by e."""
    wave = program(rise(20, np.pi, "harmonic"), fall(20, np.pi, "harmonic"))
    cams = constant_breadth(wave, base=30)
    points = cams.first.curve.at(np.linspace(0, TURN, 50)).c[0]
    np.testing.assert_allclose(np.abs(points + 10j), 40.0, atol=1e-12)
    both = conjugate(wave, base=30, second_base=35, follower="flat")
    second = both.second.curve.at(np.linspace(0, TURN, 50)).c[0]
    np.testing.assert_allclose(np.abs(second + 10j), 45.0, atol=1e-12)


def test_they_are_written_to_files_and_read_again(tmp_path: Path) -> None:
    for name, way in WAYS.items():
        made = cam_mechanism(way(), unit="mm", title=name)
        ck.save(made, tmp_path / "cams.toml")
        assert ck.load(tmp_path / "cams.toml") == made
    single = cam_mechanism(ck.profiles.synthesise(lift(30), base=40))
    assert len(ck.solve(single).structure.groups) == 1


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: constant_breadth(lift(20), base=60), "degrees it rises to .* less than .* together, 20;"),
        (
            lambda: constant_breadth(program(rise(9, 3), fall(9, TURN - 3)), base=40),
            "degrees it rises to .* less than .* together, 9;",
        ),
        (lambda: constant_breadth(program(rise(9, 3), fall(8, TURN - 3)), base=40), "does not return"),
        (lambda: constant_breadth(program(rise(9, 3), fall(9, 3)), base=40), "not to a turn of 360"),
        (lambda: conjugate(STEEP, base=60, second_base=20, follower="flat"), "second base: the face would"),
        (lambda: conjugate(lift(30), base=-4, roller=10), "base circle"),
        (lambda: conjugate(lift(0.4), base=40, roller=10, pivot=80, arm=60, second_arm=2), "second arm: .*reach"),
        (lambda: conjugate(lift(30), base=40, follower=cast(Any, "flatt")), "flat"),
    ],
)
def test_what_cannot_be_made_says_why_and_where(make: Callable[[], DoubleCam], words: str) -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match=words) as caught:
        make()
    assert all(problem.remedy for problem in caught.value.problems)


def test_both_contacts_are_on_the_same_side_of_a_break() -> None:
    """At the ends of a dwell the jerk jumps: both cams take that of the segment that begins there."""
    motion = ck.solve(ck.load("conjugate-cams"), order=3)
    assert ck.verify(motion).passed
