"""Interference of outlines against closed forms, symmetry, and brute force over fine poses."""

from __future__ import annotations

import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import compoundkin as ck
from compoundkin.cli import cli
from compoundkin.kinematics.extremes import between

FRAME, CRANK = ck.link("frame", A=(0, 0)), ck.link("crank", A=(0, 0), B=(9, 0))
BARE = ck.Mechanism("Crank", FRAME, CRANK, ck.drive("crank"))
ROCKER = ck.Mechanism(
    "Crank-rocker",
    ck.link("frame", A=(0, 0), D=(60, 0)),
    ck.link("crank", A=(0, 0), B=(25, 0)),
    ck.link("coupler", B=(0, 0), C=(55, 0), E=(30, 22)),
    ck.link("rocker", D=(0, 0), C=(45, 0)),
    ck.drive("crank"),
    unit="mm",
)


def spans(found: ck.results.Interference) -> list[tuple[str, str, float, float]]:
    return [(one.one, one.other, one.begin["crank"], one.end["crank"]) for one in found.touches]


def test_a_crank_touches_a_disc_where_trigonometry_says_so() -> None:
    """Beside the bar, sin of the angle is the sum of the half width and the radius over the distance."""
    stopped = BARE.replace(ck.outline("crank", 2), ck.outline("frame", at=(0, 8), radius=1))
    ((one, other, begin, end),) = spans(ck.interference(ck.solve(stopped)))
    half = np.arcsin(2.0 / 8.0)
    assert (one, other) == ("crank", "frame")
    assert abs(begin - (np.pi / 2 - half)) < 1e-8
    assert abs(end - (np.pi / 2 + half)) < 1e-8
    # beyond the end of the bar it is the law of cosines
    far = BARE.replace(ck.outline("crank", 2), ck.outline("frame", at=(-10, 0), radius=1))
    (touch,) = ck.interference(ck.solve(far)).touches
    half = np.arccos((9.0**2 + 10.0**2 - 2.0**2) / (2.0 * 9.0 * 10.0))
    assert abs(touch.begin["crank"] - (np.pi - half)) < 1e-8
    # where they touch first: on the line between both middles, half way between the edges, which is on both
    assert abs(abs(touch.at - 9.0 * np.exp(1j * touch.begin["crank"])) - 1.0) < 1e-6
    assert abs(abs(touch.at + 10.0) - 1.0) < 1e-6


def test_touches_between_two_poses_are_found() -> None:
    """Poses 90 degrees apart, a slender bar and a slender stop in the middle: 11 degrees of 360."""
    stopped = BARE.replace(ck.outline("crank", 0.5), ck.outline("frame", at=(4, 4), radius=0.3))
    motion = ck.solve(stopped, ck.deg([0, 90, 180, 270, 360]))
    ((_, _, begin, end),) = spans(ck.interference(motion))
    half = np.arcsin(0.55 / abs(4 + 4j))
    assert np.allclose([begin, end], [np.pi / 4 - half, np.pi / 4 + half], atol=1e-8)
    # a miss by a hundredth
    near = ck.interference(
        ck.solve(BARE.replace(ck.outline("crank", 0.5), ck.outline("frame", at=(9.56 * 1j), radius=0.3)))
    )
    assert near.passed
    assert near.least is not None
    assert abs(near.least.clearance - (9.56 - 9.0 - 0.25 - 0.3)) < 1e-12
    assert abs(near.least.drives["crank"] - np.pi / 2) < 1e-6


def test_what_parts_between_two_poses_is_told() -> None:
    """Two stops, one on each side: at both poses the crank touches one of them, and none half way."""
    stops = (ck.outline("frame", at=(8, 0), radius=1), ck.outline("frame", at=(0, 8), radius=1, name="other"))
    motion = ck.solve(BARE.replace(ck.outline("crank", 2), *stops), ck.deg([0, 90]))
    first, last = spans(ck.interference(motion))
    half = np.arcsin(2.0 / 8.0)
    assert np.allclose([first[2], first[3], last[2], last[3]], [0, half, np.pi / 2 - half, np.pi / 2], atol=1e-8)
    assert [(one.open_begin, one.open_end) for one in ck.interference(motion).touches] == [(True, False), (False, True)]


def test_a_run_through_the_first_pose_of_a_cycle_is_one() -> None:
    motion = ck.solve(BARE.replace(ck.outline("crank", 2), ck.outline("frame", at=(8, 0), radius=1)))
    ((_, _, begin, end),) = spans(ck.interference(motion))
    half = np.arcsin(2.0 / 8.0)
    assert np.allclose([begin, end], [2 * np.pi - half, half], atol=1e-8)
    # seen in a mirror it is the same: begin and end change places
    assert abs((2 * np.pi - begin) - end) < 1e-8
    (touch,) = ck.interference(motion).touches
    assert not touch.open_begin
    assert not touch.open_end
    assert ck.interference(motion).at(0) == ck.interference(motion).touches
    assert ck.interference(motion).at(20) == ()


def segments_apart(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """The distance of the segments ab and cd: of their ends from the other one, or zero where they cross."""

    def off(p: np.ndarray, q: np.ndarray, r: np.ndarray) -> np.ndarray:
        t = np.clip(((p - q) * np.conjugate(r - q)).real / np.abs(r - q) ** 2, 0.0, 1.0)
        return np.abs(p - q - t * (r - q))

    def side(p: np.ndarray, q: np.ndarray, r: np.ndarray) -> np.ndarray:
        return ((r - p) * np.conjugate(q - p)).imag

    cross = (side(a, b, c) * side(a, b, d) < 0) & (side(c, d, a) * side(c, d, b) < 0)
    return np.where(cross, 0.0, np.min([off(a, c, d), off(b, c, d), off(c, a, b), off(d, a, b)], axis=0))


def test_two_bars_are_as_far_apart_as_their_segments() -> None:
    """Crank and rocker of one layer, which no pin joins, over poses fifty times as fine."""
    wide = ROCKER.replace(ck.outline("crank", 6), ck.outline("rocker", 8))
    fine = ck.solve(ROCKER, ck.deg(np.arange(0, 360, 0.1)), order=0)
    places = [np.asarray(fine.points[letter].position) for letter in "ABDC"]
    apart = segments_apart(*[np.broadcast_to(place, places[1].shape) for place in places])
    found = ck.interference(ck.solve(wide)).least
    assert found is not None
    assert 0.0 <= float(apart.min()) - 7.0 - found.clearance < 1e-4
    assert found.clearance > 0.0
    # as wide as it takes to touch: where the segments are 33 apart, by the fine poses to a step of them
    ((_, _, begin, end),) = spans(
        ck.interference(ck.solve(ROCKER.replace(ck.outline("crank", 33), ck.outline("rocker", 33))))
    )
    below = np.flatnonzero(apart <= 33.0)
    assert abs(np.rad2deg(begin) - 0.1 * below[0]) < 0.11
    assert abs(np.rad2deg(end) - 0.1 * below[-1]) < 0.11
    # and exactly: the segments there are 33 apart
    there = between(ck.solve(ROCKER), 0, np.rad2deg([begin, end]) / 5.0, 0)
    at = [np.broadcast_to(np.asarray(there.points[letter].position), 2) for letter in "ABDC"]
    assert np.allclose(segments_apart(*at), 33.0, atol=1e-6)


def test_plates_and_polygons_against_fine_poses() -> None:
    """Coupler plate, polygon of the frame, several shapes of a link: brute force by shapely's own buffers."""
    shapely = pytest.importorskip("shapely")
    bed = [(-10, -30), (75, -30), (75, -12), (20, -18)]
    full = ROCKER.replace(
        ck.outline("coupler", 6), ck.outline("coupler", at="E", radius=7), ck.outline("frame", polygon=bed)
    )
    found = ck.interference(ck.solve(full))
    fine = ck.solve(full, ck.deg(np.arange(0, 360, 0.25)), order=0)
    b, c, e = (np.asarray(fine.points[letter].position) for letter in "BCE")
    rings = shapely.linearrings(np.stack([np.stack([p.real, p.imag], -1) for p in (b, c, e)], axis=1))
    plate = shapely.buffer(shapely.polygons(rings), 3.0, quad_segs=64)
    eye = shapely.buffer(shapely.points(e.real, e.imag), 7.0, quad_segs=64)
    touching = shapely.intersects(shapely.union(plate, eye), shapely.Polygon(bed))
    edges = np.flatnonzero(np.diff(touching.astype(int)))
    told = sorted(np.rad2deg(place) for span in spans(found) for place in span[2:])
    assert len(edges) == len(told) > 0
    assert np.abs(np.array(told) - 0.25 * (edges + 0.5)).max() < 0.2


def test_layers_pass_each_other_and_pins_do_not() -> None:
    stop = ck.outline("frame", at=(0, 12), radius=2, layer=1)
    crank = BARE.replace(ck.outline("crank", 2, layer=0), stop)
    crank = crank.replace(ck.link("crank", A=(0, 0), B=(12, 0)))
    assert ck.interference(ck.solve(crank)).passed
    above = ROCKER.replace(
        ck.outline("crank", 5, pin=4, layer=0), ck.outline("coupler", 5, layer=2),
        ck.outline("frame", at=(0, 30), radius=2, layer=1),
    )  # fmt: skip
    # the pin B on layers 0 to 2 goes round at 25: it comes to 30 - 25 - 2 - 2 of the stop, which no link shares
    found = ck.interference(ck.solve(above))
    assert (found.clearances[0].one, found.clearances[0].other) == ("pin B", "frame")
    assert abs(found.clearances[0].clearance - 1.0) < 1e-9
    taller = above.replace(ck.outline("crank", 5, pin=7, layer=0))
    (touch,) = ck.interference(ck.solve(taller)).touches
    assert touch.one == "pin B"
    assert abs(touch.begin["crank"] + touch.end["crank"] - np.pi) < 1e-7


def test_layers_may_be_far_apart() -> None:
    far = ROCKER.replace(
        ck.outline("crank", 5, pin=7, layer=-(10**12)), ck.outline("coupler", 5, layer=10**12),
        ck.outline("frame", at=(0, 30), radius=2, layer=7),
    )  # fmt: skip
    (touch,) = ck.interference(ck.solve(far)).touches
    assert (touch.one, touch.other, touch.layers) == ("pin B", "frame", (7,))


def test_neighbours_are_told_from_collisions() -> None:
    """Both bars at a pin overlap by nature; the frame's stop away from the pin does not."""
    both = ROCKER.replace(ck.outline("crank", 6), ck.outline("coupler", 6), ck.outline("frame", 4, through=["A", "D"]))
    found = ck.interference(ck.solve(both))
    assert ("crank", "coupler") in found.neighbours
    assert ("crank", "frame") in found.neighbours
    assert "coupler" in {name for one in (*found.touches, *found.clearances) for name in (one.one, one.other)}
    with_stop = both.replace(ck.outline("frame", at=(-20, 0), radius=2, name="stop"))
    assert ("crank", "frame") in ck.interference(ck.solve(with_stop)).touching


def test_several_designs_and_drivers() -> None:
    stop = ck.outline("frame", at=(0, 8), radius=[[1.0], [2.0]])
    found = ck.interference(ck.solve(BARE.replace(ck.outline("crank", 2), stop)))
    half = [np.pi / 2 - one.begin["crank"] for one in found.touches]
    assert [one.design for one in found.touches] == [0, 1]
    assert np.allclose(half, np.arcsin([2.0 / 8.0, 3.0 / 8.0]), atol=1e-8)
    upper, fore = ck.link("upper", A=0, B=6), ck.link("fore", B=0, P=5)
    arm = ck.Mechanism("Arm", FRAME, upper, fore, ck.drive("upper"), ck.drive("fore", on="upper"))
    arm = arm.replace(ck.outline("fore", 1), ck.outline("frame", at=(9, 5), radius=1))
    motion = ck.solve(arm, {"upper": ck.deg(np.linspace(0, 60, 13)), "fore": ck.deg(np.linspace(0, 30, 13))})
    (touch,) = ck.interference(motion).touches
    # both drivers at the place that is told: there the bar is 1.5 from the middle of the disc
    for there in (touch.begin, touch.end):
        at = ck.solve(arm, {name: [value] for name, value in there.items()}, order=0)
        b, p = (complex(at.points[letter].position[0]) for letter in "BP")
        t = np.clip(((9 + 5j - b) * np.conjugate(p - b)).real / abs(p - b) ** 2, 0, 1)
        assert abs(abs(9 + 5j - b - t * (p - b)) - 1.5) < 1e-6


def test_poses_that_are_not_assembled_are_left_out() -> None:
    double = ck.Mechanism(
        "Triple rocker", ck.link("frame", A=(0, 0), D=(7, 0)), ck.link("crank", A=(0, 0), B=(4, 0)),
        ck.link("coupler", B=(0, 0), C=(5, 0)), ck.link("rocker", D=(0, 0), C=(3, 0)), ck.drive("crank"),
        ck.outline("crank", 0.5), ck.outline("rocker", 0.5),
    )  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        motion = ck.solve(double)
    found = ck.interference(motion)
    assert found.missing == int(np.count_nonzero(motion.failed)) > 0
    assert found.poses + found.missing == motion.failed.size
    assert all(np.isfinite([one.clearance, one.at.real]).all() for one in found.clearances)
    assert f"{found.missing} poses that cannot be assembled are left out" in found._repr_html_()


def test_the_jaws_of_the_crusher_come_to_their_gap() -> None:
    """The faces of both jaws as segments, over poses ten times as fine."""
    crusher = ck.load("jaw-crusher")
    found = ck.interference(ck.solve(crusher))
    assert found.passed
    assert found.least is not None
    assert (found.least.one, found.least.other) == ("frame", "jaw")
    fine = ck.solve(crusher, ck.deg(np.arange(0, 360, 0.5)), order=0)
    above, corner = (np.asarray(fine.links["jaw"].at(place).position) for place in ((-45, -40), (930, -75)))
    face = (np.full(len(corner), place) for place in (-620 + 190j, -415 - 800j))
    gap = segments_apart(above, corner, *face)
    assert 0.0 <= gap.min() - found.least.clearance < 1e-3
    assert abs(np.rad2deg(found.least.drives["eccentric"]) - 0.5 * gap.argmin()) < 0.5


def test_a_single_pose_is_looked_at() -> None:
    stopped = BARE.replace(ck.outline("crank", 2), ck.outline("frame", at=(0, 8), radius=1))
    assert ck.interference(ck.solve(stopped, {"crank": [np.pi / 2]})).touching == (("crank", "frame"),)
    assert ck.interference(ck.solve(stopped, {"crank": [0.0]})).passed


def test_what_cannot_be_compared_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ck.errors.InvalidInput, match="no link has an outline"):
        ck.interference(ck.solve(BARE))
    stopped = ck.solve(BARE.replace(ck.outline("crank", 2)))
    monkeypatch.setitem(sys.modules, "shapely", None)
    with pytest.raises(ck.errors.InvalidInput, match=r"pip install 'compoundkin\[interference\]'"):
        ck.interference(stopped)
    assert "Outlines were not compared" in ck.report(stopped).text()


def test_reports_and_checks_say_it(tmp_path: Path) -> None:
    stopped = BARE.replace(ck.outline("crank", 2), ck.outline("frame", at=(0, 8), radius=1, layer=[0, 1]))
    found = ck.interference(ck.solve(stopped))
    assert repr(found) == "Interference('Crank' at 73 poses: 1 pair of links touch)"
    assert "crank and frame on layer 0 touch from crank 75.5224878° to 104.477512°" in found._repr_html_()
    text = ck.report(stopped).text().replace("\n", " ")
    assert "1 pair of links touch" in text
    free = stopped.replace(ck.outline("frame", at=(0, 8), radius=1, layer=2))
    ck.save(stopped, tmp_path / "stopped.toml")
    ck.save(free, tmp_path / "free.toml")
    stopped_by, passed = (
        CliRunner().invoke(cli, ["check", str(tmp_path / name)]) for name in ("stopped.toml", "free.toml")
    )
    assert stopped_by.exit_code == 4
    assert "FAILED: interference: crank and frame on layer 0 touch" in stopped_by.stderr
    assert passed.exit_code == 0
