"""Pictures of dimensional synthesis: answers side by side with their task, Burmester's curves, cognates."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import count_phrase
from compoundkin.dimensional.burmester_curve import BurmesterCurve
from compoundkin.dimensional.candidates import POINT
from compoundkin.dimensional.cognates import Cognates
from compoundkin.dimensional.dyads import Dyads
from compoundkin.dimensional.synthesis import Answer
from compoundkin.dimensional.tasks import CurveTask, MixedTask, PointTask, PoseTask, Task, TimedPointTask, extent
from compoundkin.kinematics import Motion
from compoundkin.view.sketch.kinematic_sketch import by_links, in_layers, layered, point_path, window_on
from compoundkin.view.sketch.painter import Painter
from compoundkin.view.sketch.picture import (
    PAPER_WIDTH,
    Picture,
    PicturePart,
    headed_part,
    in_rows,
    with_notes,
)
from compoundkin.view.sketch.picture_options import scene_in
from compoundkin.view.sketch.scene import MARGIN, Scene, Window, fitted_window, simplified
from compoundkin.view.sketch.shapes import CircleShape, Polyline, Shape, Text, shape_corners

# So many answers are drawn, the best; a panel is no larger than this in picture units, and no narrower.
MOST, NARROWEST = 12, 200.0
# Panels are no larger than this: few of them such that two stand side by side, else three.
LARGEST, SMALLER, FEW = 300.0, 215.0, 4
# The axes of a pose, in picture units, and the dot of a point.
AXIS, DOT = 22.0, 3.2
# Curves are shown so many extents of the poses around their middle, on so many picture units.
AROUND, CURVES = 2.2, 420.0


def synthesis_picture(answer: Answer, *, size: float | None = None) -> Picture:
    """Draw the solutions of a task side by side, the best first, with its poses or points; of four poses their curves.

    A family's dyads are dots on the centre-point curve: filled where they are part of a solution.
    """
    largest = LARGEST if len(answer) <= FEW else SMALLER
    parts = [_panel(answer.task, one.motion, f"{k}", one.candidate.title, largest)
             for k, one in enumerate(answer.solutions[:MOST], start=1)]  # fmt: skip
    found = None if answer.candidates is None else answer.candidates.found
    if isinstance(found, Dyads) and found.freedom == 1:
        used = [dyad.fixed for one in answer.solutions for dyad in one.candidate.dyads]
        parts.append(headed_part("dyads", *_curves(found, used)))
    if not parts:
        parts.append(headed_part("task", *_task_alone(answer.task)))
    shapes, width, height = in_rows(parts, widest=PAPER_WIDTH)
    more = [f"and {len(answer) - MOST} more"] if len(answer) > MOST else []
    lost = [f"{count} rejected for {reason}" for reason, count in answer.reasons.items()]
    notes = [answer.task.in_words, answer.complete, *more, *lost]
    described = f"{count_phrase(len(answer), 'mechanism')} for {answer.task.in_words}"
    return with_notes(shapes, width, height, notes, "Synthesis", described, size, legible=True)


def dyads_picture(found: Dyads, *, size: float | None = None) -> Picture:
    """Draw poses and poles, dyads at the first pose, and of four poses the centre-point and circle-point curves.

    The circle-point curve (blue) is that of the body at its first pose. A black edge has the part whose cranks pass
    the poses in order.
    """
    shapes, width, height = _curves(found, [dyad.fixed for dyad in found])
    notes = [repr(found).removeprefix("Dyads(").removesuffix(")")]
    if found.freedom == 1:
        notes += [
            "red: fixed centres, edged black: crank in order",
            "blue: moving points, first pose",
        ]
    return with_notes(shapes, width, height, notes, "Dyads", found.task.in_words, size, legible=True)


def cognates_picture(found: Cognates, *, size: float | None = None) -> Picture:
    """Draw the linkages at one place of their curve, with the triangle of their fixed pivots (Cayley's)."""
    index = len(found[0].z) // 8
    place = complex(found[0].z[index])
    scenes = [scene_in(one.motion, None, int(np.argmin(np.abs(one.z - place))), 0) for one in found]
    first = window_on(scenes[0], scenes[1:])
    points = [shape_corners(layered(Painter(scene, first))) for scene in scenes]
    window = fitted_window(first, np.concatenate([*points, first.at(found[0].z)]))
    shapes: list[Shape] = []
    corners = tuple(complex(window.at(p)) for p in found.triangle)
    if len(corners) > 2:
        shapes.append(Polyline((*corners, corners[0]), "ray"))
    shapes.append(Polyline(window.line(found[0].z), "path"))
    for scene in scenes[::-1]:
        shapes += by_links(in_layers(Painter(scene, window)))
    shapes.append(CircleShape(complex(window.at(place)), DOT, "centre"))
    notes = [f"{count_phrase(len(found), 'linkage')} for {found.point}", f"apart by {found.deviation:.1e} at most",
             "dashed: the triangle of the fixed pivots"]  # fmt: skip
    title = f"{found[0].mechanism.title}: cognates"
    return with_notes(shapes, window.width, window.height, notes, title, title, size, legible=True)


def _panel(task: Task, motion: Motion, heading: str, title: str, largest: float) -> PicturePart:
    """Return one mechanism at its first pose with the path of its point and the task."""
    scene = scene_in(motion, None, 0, 0)
    traced = [POINT] if POINT in scene.mechanism.carriers else []
    window = _scaled_window(scene, traced, _places_of(task), largest)
    shapes: list[Shape] = [line for letter in traced for line in point_path(scene, window, letter)]
    shapes += by_links(in_layers(Painter(scene, window)))
    shapes += marks_of(task, window)
    return headed_part(f"{heading}  {title}", shapes, window.width, window.height)


def _scaled_window(scene: Scene, traced: Sequence[str], places: Number, largest: float) -> Window:
    """Return the window on a scene and a task, on a panel."""
    first = window_on(scene, paths=traced)
    points = np.concatenate([shape_corners(layered(Painter(scene, first))), first.at(places),
                             *(first.at(scene.places(letter)) for letter in traced)])  # fmt: skip
    wide = max(np.ptp(points.real), np.ptp(points.imag), 1.0)
    scale = min(1.0, (largest - 2.0 * MARGIN) / wide)
    whole = Window(first.scale * scale, first.corner, 0.0, 0.0)
    points = np.concatenate([shape_corners(layered(Painter(scene, whole))), whole.at(places),
                             *(whole.at(scene.places(letter)) for letter in traced)])  # fmt: skip
    return fitted_window(whole, points, NARROWEST)


def _places_of(task: Task) -> Number:
    if isinstance(task, PoseTask):
        return task.z
    if isinstance(task, MixedTask):
        return np.concatenate([task.z, task.points])
    if isinstance(task, PointTask | TimedPointTask | CurveTask):
        return task.points
    return np.zeros(0, complex)


def marks_of(task: Task, window: Window) -> list[Shape]:
    """Return the poses of a task as numbered pairs of axes, its points as numbered dots, its curve."""
    shapes: list[Shape] = []
    poses = zip(task.z, task.u, strict=True) if isinstance(task, PoseTask | MixedTask) else ()
    count = 0
    for z, u in poses:
        at, way = complex(window.at(complex(z))), complex(u).conjugate()
        shapes += [Polyline((at, at + AXIS * way), "drive"), Polyline((at, at - 1j * AXIS * way), "edge")]
        shapes.append(Text(at + AXIS * 1.5 * way, str(count + 1), "note"))
        count += 1
    if isinstance(task, CurveTask):
        along = window.at(np.append(task.points, task.points[:1]) if task.closed else task.points)
        shapes.append(Polyline(tuple(map(complex, along)), "dashed2"))
    points = task.points if isinstance(task, PointTask | TimedPointTask | MixedTask) else ()
    for place in points:
        at = complex(window.at(complex(place)))
        shapes += [CircleShape(at, DOT, "centre"), Text(at + 10.0 - 8.0j, str(count + 1), "note")]
        count += 1
    return shapes


def _task_alone(task: Task) -> tuple[list[Shape], float, float]:
    """Return a task without an answer."""
    places = _places_of(task)
    if not len(places):
        return [Text(complex(LARGEST / 2.0, MARGIN), "no mechanism", "note")], LARGEST, 2.0 * MARGIN
    window = _window_around(places, extent(places) / 2.0)
    return marks_of(task, window), window.width, window.height


def _window_around(places: Number, half: float) -> Window:
    middle = complex((places.real.min() + places.real.max()) / 2, (places.imag.min() + places.imag.max()) / 2)
    room = CURVES - 2.0 * MARGIN
    scale = room / (2.0 * half)
    corner = middle + half * (-1 + 1j) + MARGIN * (-1 + 1j) / scale
    return Window(scale, corner, CURVES, CURVES)


def _curves(found: Dyads, used: Sequence[complex]) -> tuple[list[Shape], float, float]:
    """Return poses, poles, dyads and curves of a body; `used` are fixed centres to be filled."""
    task = found.task
    near = [p.place for p in found.poles if abs(p.place - np.mean(task.z)) < AROUND * extent(task.z)]
    places = np.concatenate([task.z, np.array(near, dtype=complex)])
    window = _window_around(places, AROUND * extent(task.z))
    shapes: list[Shape] = []
    if found.freedom == 1:
        curve, z, u = found.curve, complex(task.z[0]), complex(task.u[0])
        shapes += [Polyline(line, "line1") for line in _lines(curve, z + u * curve.points, window)]
        bold = np.where(passes_in_order(curve, task), curve.centres, np.nan)
        shapes += [Polyline(line, "bold") for line in _lines(curve, bold, window)]
        shapes += [Polyline(line, "path") for line in _lines(curve, curve.centres, window)]
    for pole in found.poles:
        at = complex(window.at(pole.place))
        if window.holds(at, DOT):
            i, j = pole.poses
            shapes += [CircleShape(at, DOT, "dot"), Text(at + 12.0 - 8.0j, f"P{i + 1}{j + 1}", "note")]
    for dyad in found:
        ends = [complex(window.at(p)) for p in (dyad.fixed, complex(task.z[0] + task.u[0] * dyad.moving))]
        if all(window.holds(at) for at in ends):
            shapes += [Polyline(tuple(ends), "ink"), *(CircleShape(at, DOT, "pin") for at in ends)]
    for centre in dict.fromkeys(used):
        at = complex(window.at(centre))
        if window.holds(at, DOT):
            shapes.append(CircleShape(at, DOT, "centre"))
    shapes += marks_of(task, window)
    return shapes, window.width, window.height


def passes_in_order(curve: BurmesterCurve, task: PoseTask) -> Number:
    """Return whether the cranks of a curve pass the poses in order, turning one way by less than a turn, (n,)."""
    with np.errstate(invalid="ignore"):
        arms = task.z[:, None] + task.u[:, None] * curve.points - curve.centres
        steps = np.mod(np.angle(arms[1:] / arms[:-1]), 2.0 * np.pi)
        turned = np.sum(steps, axis=0)
        back = np.sum(2.0 * np.pi - steps, axis=0)
    found: Number = (turned < 2.0 * np.pi) | (back < 2.0 * np.pi)
    return found


def _lines(curve: BurmesterCurve, places: Number, window: Window) -> Iterator[tuple[complex, ...]]:
    """Yield the parts of a curve that are in a window, each a line."""
    for indices, closed in curve.pieces():
        along = places[np.append(indices, indices[0]) if closed else indices]
        with np.errstate(invalid="ignore"):
            at = window.at(along)
            known = np.isfinite(at) & (at.real > 0.0) & (at.real < window.width)
            known &= (at.imag > 0.0) & (at.imag < window.height)
        for run in np.split(np.arange(len(at)), np.flatnonzero(np.diff(known.astype(int))) + 1):
            if len(run) > 1 and known[run[0]]:
                yield simplified(at[run])
