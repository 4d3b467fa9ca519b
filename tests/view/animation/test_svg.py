"""Animations as SVG: keyframes against the solver, at poses and between them."""

from __future__ import annotations

import re
import warnings
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from functools import cache

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files import load
from compoundkin.view.animation.timeline import Timeline
from compoundkin.view.sketch.centre_pictures import TOGETHER
from compoundkin.view.sketch.shapes import ArcShape, Band, CircleShape, Polygon, Polyline, Shape, Strokes
from compoundkin.view.sketch.shapes import leaves as shapes_in
from tests import catalog

# What moves is where it should be within this, picture units; its shapes are rounded to tenths as in all pictures.
NEAR, ROUNDED = 0.2, 0.08
SVG = "{http://www.w3.org/2000/svg}"
# A map of the plane, p -> turn p + by.
Map = tuple[complex, complex]


def sampled(values: str) -> np.ndarray:
    return np.array([[float(number) for number in re.findall(r"-?[\d.]+", key)] for key in values.split(";")])


def at(how: ET.Element, share: float) -> np.ndarray:
    """The value of an animation at a part of its time, as the specification of SMIL has it."""
    values = sampled(how.attrib["values"])
    steady = how.get("calcMode") == "discrete"
    even = np.arange(len(values)) / len(values) if steady else np.linspace(0.0, 1.0, len(values))
    times = np.array([float(t) for t in how.attrib["keyTimes"].split(";")]) if "keyTimes" in how.attrib else even
    assert times[0] == 0.0
    assert np.all(np.diff(times) >= 0.0)
    assert steady or times[-1] == 1.0
    if steady:
        return values[np.searchsorted(times, share, side="right") - 1]
    return np.array([np.interp(share, times, column) for column in values.T])


def moved(group: ET.Element, share: float) -> Map:
    """What a group does to its contents."""
    how = group.find(f"{SVG}animateTransform")
    found = re.fullmatch(r"(\w+)\((.*)\)", group.get("transform", ""))
    if found is None:
        return 1 + 0j, 0j
    numbers = sampled(found[2])[0] if how is None else at(how, share)
    if found[1] == "rotate":
        return complex(np.exp(1j * np.deg2rad(numbers[0]))), 0j
    return 1 + 0j, complex(*numbers)


def leaves(element: ET.Element, share: float, seen: Map = (1 + 0j, 0j)) -> Iterator[tuple[ET.Element, Map]]:
    """All elements with their maps."""
    for child in element:
        turn, by = moved(child, share) if child.tag == f"{SVG}g" else (1 + 0j, 0j)
        here = seen[0] * turn, seen[0] * by + seen[1]
        yield child, here
        yield from leaves(child, share, here)


def drawn(svg: ET.Element, share: float) -> Iterator[list[complex]]:
    """The places that all lines, circles and texts are made of, in their order."""
    for element, (turn, by) in leaves(svg, share):
        if element.tag == f"{SVG}path":
            how = element.find(f"{SVG}animate")
            numbers = path(element.attrib["d"]) if how is None else at(how, share)
            yield [turn * complex(x, y) + by for x, y in numbers.reshape(-1, 2)]
        elif element.tag in (f"{SVG}circle", f"{SVG}text"):
            x, y = ("cx", "cy") if element.tag == f"{SVG}circle" else ("x", "y")
            yield [turn * complex(float(element.attrib[x]), float(element.attrib[y])) + by]


def path(d: str) -> np.ndarray:
    """The places in a path; of an arc its ends."""
    return sampled(re.sub(r"A[\d.]+ [\d.]+ 0 0 \d ", "L", d))[0]


def made_of(shape: Shape) -> list[complex]:
    """The same of a shape."""
    if isinstance(shape, Polyline | Polygon | Band):
        return list(shape.points)
    if isinstance(shape, Strokes):
        return [point for line in shape.lines for point in line]
    if isinstance(shape, ArcShape):
        return [shape.start, shape.stop]
    return [shape.centre if isinstance(shape, CircleShape) else shape.at]  # type: ignore[union-attr]


def off(animation: ck.results.Animation, svg: ET.Element, share: float, pose: int) -> float:
    """By how much the worst of all places is off at a pose."""
    assert not animation.arrows
    shapes = list(shapes_in(animation.sketch.shapes(pose)))[1:]
    found = list(drawn(svg, share))[1:]
    worst = 0.0
    for shape, places in zip(shapes, found, strict=False):
        wanted = made_of(shape)
        assert len(wanted) == len(places)
        worst = max(worst, *(abs(a - b) for a, b in zip(wanted, places, strict=True)))
    return worst


def solved(name: str, values: np.ndarray, **more: object) -> ck.results.Motion:
    mechanism = load(name)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
        return ck.solve(mechanism, {mechanism.drives[0].name: values}, **more)


TURN = ck.deg(np.arange(0.0, 361.0, 5.0))
CASES = {
    "turn": lambda: solved("six-bar", TURN),
    "leg": lambda: solved("jansen-leg", TURN),
    "uneven": lambda: solved("six-bar", 2.0 * np.pi * np.linspace(0.0, 1.0, 200) ** 1.5),
    "there and back": lambda: solved("six-bar", ck.deg(np.arange(20.0, 200.0, 3.0))),
    "gaps": lambda: solved("double-rocker", ck.deg(np.arange(0.0, 361.0))),
    "across the seam": lambda: solved("triple-rocker", ck.deg(np.arange(0.0, 361.0, 2.0))),
    "planets": lambda: catalog.motion("planetary-train"),
    "far apart": lambda: solved("six-bar", ck.deg(np.arange(0.0, 361.0, 40.0))),
}


@cache
def case(name: str) -> ck.results.Motion:
    return CASES[name]()


def poses_alone(timeline: Timeline) -> np.ndarray:
    """Some of the poses that are shown at a time of their own: where the picture leaps, two have one time."""
    apart = np.diff(timeline.times) > 0
    alone = np.concatenate([[True], apart]) & np.concatenate([apart, [True]])
    steps = np.flatnonzero(alone & ((timeline.times < 1.0) | (not timeline.returns)))
    return steps[:: max(1, len(steps) // 25)]


@pytest.mark.parametrize("name", CASES)
def test_every_part_is_where_the_solver_puts_it(name: str) -> None:
    animation = case(name).animate()
    timeline, svg = animation.timeline, ET.fromstring(animation.svg)
    is_steady = "discrete" in animation.svg and not timeline.has_seam
    assert is_steady == (name == "far apart")
    for k in poses_alone(timeline):
        share = float(timeline.times[k]) + (1e-4 if is_steady else 0.0)
        assert off(animation, svg, share, int(timeline.poses[k])) < NEAR + ROUNDED


def circles(svg: ET.Element, share: float) -> np.ndarray:
    """Where the middles of all circles are."""
    places = [(e, turn, by) for e, (turn, by) in leaves(svg, share) if e.tag == f"{SVG}circle"]
    return np.array([turn * complex(float(e.attrib["cx"]), float(e.attrib["cy"])) + by for e, turn, by in places])


def test_between_poses_pins_are_where_the_solver_would_put_them() -> None:
    coarse, fine = (solved("jansen-leg", ck.deg(np.linspace(0.0, 360.0, n))) for n in (73, 721))
    animation = coarse.animate()
    svg = ET.fromstring(animation.svg)
    for pose in range(3, 721, 37):
        drawn_there = circles(svg, pose / 720.0)
        for letter in fine.mechanism.carriers:
            place = animation.sketch.window.at(fine.points[letter].position[pose])
            assert np.min(np.abs(drawn_there - place)) < NEAR


def test_arrows_are_those_of_the_solver_and_turn_round_on_the_way_back() -> None:
    motion = case("there and back")
    animation = motion.animate(vectors=("velocity", "acceleration"), labels=False)
    svg = ET.fromstring(animation.svg)
    assert {arrows.scale.kind for arrows in animation.arrows} == {"velocity", "acceleration"}
    parts = len(list(shapes_in(animation.sketch.shapes(0))))
    for k in poses_alone(animation.timeline):
        pose, way, share = (
            int(animation.timeline.poses[k]),
            int(animation.timeline.directions[k]),
            animation.timeline.times[k],
        )
        shown = list(drawn(svg, share))[parts:]
        for arrows, kinds in zip(animation.arrows, (shown, shown[2 * len(animation.arrows[0].rates) :]), strict=True):
            for n, letter in enumerate(arrows.rates):
                derivative = motion.points[letter].derivative(1 if arrows.scale.kind == "velocity" else 2)[pose]
                rate = derivative * (way if arrows.scale.kind == "velocity" else 1)
                start = animation.sketch.window.at(motion.points[letter].position[pose])
                tip = start + np.conjugate(rate) * arrows.scale.per_unit
                assert abs(kinds[2 * n][0] - start) < NEAR
                assert abs(kinds[2 * n + 1][0] - tip) < NEAR


def test_centres_are_those_of_the_circle_diagram_while_they_are_on_the_picture() -> None:
    motion = case("turn")
    animation = motion.animate(centres=True)
    window, svg = animation.sketch.window, ET.fromstring(animation.svg)
    centres = ck.instant_centres(motion)
    seen = 0
    for pose in range(1, 72, 5):
        drawn_there = circles(svg, pose / 72.0)
        framed = np.array([s.centre for s in shapes_in(animation.frame(pose).shapes) if isinstance(s, CircleShape)])
        for pair in centres:
            point = complex(centres[pair].point[pose])
            place = complex(window.at(point)) if np.isfinite(point) else complex(np.inf)
            beside = [window.at(p) for p in centres[pair].point[[pose - 1, pose + 1]] if np.isfinite(p)]
            # where it comes or goes, it is on the picture and not at the same time
            if window.holds(place, 3.0) and len(beside) == 2 and all(window.holds(p, 3.0) for p in beside):
                seen += 1
                assert np.min(np.abs(drawn_there - place)) < NEAR + TOGETHER
                assert np.min(np.abs(framed - place)) < TOGETHER
        outside = [p for p in drawn_there if p.real > -500 and not window.holds(p) and p.imag < window.height]
        assert not outside
    assert seen > 100


def test_nothing_spins_the_wrong_way() -> None:
    """The crank turns evenly through its turn, against the sense of clocks; gears turn through all of theirs."""
    turns = re.findall(r'type="rotate"[^>]*values="([^"]*)"', case("turn").animate().svg)
    crank = max((sampled(values)[:, 0] for values in turns), key=np.ptp)
    assert crank[-1] - crank[0] == -360.0
    assert np.all(np.diff(crank) < 0.0)
    svg = case("planets").animate(back=False).svg
    spans = {float(np.ptp(sampled(values))) for values in re.findall(r'type="rotate"[^>]*values="([^"]*)"', svg)}
    motion = case("planets")
    arm, planet, sun = (np.rad2deg(np.ptp(motion.links[link].angle)) for link in ("arm", "planet", "sun"))
    # the planet, which turns the other way, is led round by the arm and turned back
    for turn in (arm, sun, planet + arm):
        assert any(abs(span - turn) < 0.02 for span in spans)


def test_without_support_it_shows_the_first_pose() -> None:
    animation = case("turn").animate()
    bare = ET.fromstring(re.sub(r"<animate[^>]*>", "", animation.svg))
    pose = int(animation.timeline.poses[0])
    assert off(animation, bare, 0.0, pose) < NEAR + ROUNDED


def test_it_is_made_for_light_and_dark_paper_and_says_what_it_is() -> None:
    animation = case("turn").animate()
    assert "@media (prefers-color-scheme: dark)" in animation.svg
    root = ET.fromstring(animation.svg)
    assert root.find(f"{SVG}title").text == "Six-bar of Example 3-4"  # type: ignore[union-attr]
    assert animation.svg == case("turn").animate().svg
    used = {name for classes in re.findall(r'class="([^"]*)"', animation.svg) for name in classes.split()}
    assert all(f".{name}{{" in animation.svg for name in used)


def test_a_long_motion_makes_no_larger_file_than_a_short_one() -> None:
    long = solved("six-bar", 2.0 * np.pi * np.arange(36_001) / 36_000).animate()
    assert len(long.svg) < 1.2 * len(case("turn").animate().svg)
    assert len(long) == 100


@catalog.each(catalog.THIRD)
def test_every_mechanism_moves(name: str) -> None:
    animation = ck.animate(catalog.motion(name))
    root = ET.fromstring(animation.svg)
    assert root.iter(f"{SVG}animateTransform")
    assert len(animation.svg) < 400_000
    assert off(animation, root, 1e-9, int(animation.timeline.poses[0])) < NEAR + ROUNDED


def test_the_arrow_of_a_rolling_wheel_does_not_turn_with_it() -> None:
    animation = ck.animate(load("rolling-wheel"))
    heads = []
    for k in range(0, len(animation), 9):
        drive = [s for s in shapes_in(animation.frame(k).shapes) if isinstance(s, Polyline) and s.style == "drive"]
        heads.append(drive[0].points[-1] - drive[0].points[0])
    assert np.ptp(np.angle(heads)) < 1e-9
