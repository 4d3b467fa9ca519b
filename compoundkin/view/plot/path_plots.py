"""Curves in the plane of the mechanism: paths of points, centrodes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np

from compoundkin.analysis.coupler.centrodes import pole
from compoundkin.analysis.coupler.relative_motion import place as place_on
from compoundkin.analysis.coupler.relative_motion import relative_link, relative_point
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import first_entry
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.kinematics import Motion
from compoundkin.model.attributes import unit_of
from compoundkin.model.elements import FRAME
from compoundkin.view.plot import canvas, planar, plot_style
from compoundkin.view.plot.plot_style import Plot
from compoundkin.view.plot.point_labels import PointLabel, number

SIZE = (6.4, 5.8)
# A letter of the mechanism, or a link and a place (complex or x, y) in its own frame.
Point: TypeAlias = str | tuple[str, Any]
# Poles farther from a link than this many lengths of the mechanism are not drawn: centrodes run to infinity.
FAR = 2.5


@checked
def paths(
    motion: Motion,
    *points: Point,
    on: str = FRAME,
    every: int | None = None,
    designs: Sequence[str] = (),
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw the paths of points, as an observer on a link sees them. Coupler curves.

    A point is a letter, or a link and a place in its frame: ``("coupler", (3, 1))``. Equal scales; a dot every so many
    poses with the driver's value or the time; the points of the observing link are drawn as crosses. Raises UnknownName
    for points and links that are not there.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> picture = paths(solve(load_named("jansen-leg")), "foot")
    >>> picture.figure.axes[0].get_aspect()
    1.0
    """
    motion.mechanism.link(on)
    names = [point if isinstance(point, str) else _called(motion, *point) for point in points] or _moving(motion, on)
    curves = [_path(motion, point, on) for point in (points or names)]
    shared = planar.drawing(motion, designs, every)
    with plot_style.styled():
        figure, axes = canvas.panels(1, motion.mechanism.title if title is None else title, size or SIZE)
        planar.curves(axes[0], shared, curves, names)
        fixed_points(axes[0], motion, on, shared)
        unit = unit_of(motion.mechanism.unit, "length")
        canvas.plane(axes[0], f"x [{unit}]", f"y [{unit}]")
        planar.finish(figure, axes, shared, True)
        return canvas.finished(figure, shared.labels)


def fixed_points(axes: Any, motion: Motion, on: str, shared: planar.SharedCurves) -> None:
    """Draw the points of the observing link, as crosses with their letters. Those of the first design."""
    for letter, place in motion.mechanism.geometry.points[on].items():
        z = complex(np.ravel(place)[0])
        axes.plot([z.real], [z.imag], marker="x", markersize=6, color=plot_style.INK, linestyle="none", zorder=6)
        shared.labels.insert(0, PointLabel(axes, z.real, z.imag, letter, -1j))


def _moving(motion: Motion, on: str) -> list[str]:
    """The letters of all points that are not on the observing link."""
    return [name for name in motion.points if name not in motion.mechanism.geometry.points[on]]


def _called(motion: Motion, link: str, point: Any) -> str:
    motion.mechanism.link(link)
    z = complex(first_entry(place_on(motion, link, point)))
    return f"{link} ({number(z.real)}, {number(z.imag)})"


def _path(motion: Motion, point: Point, on: str) -> Number:
    shape = (motion.inputs.designs, motion.inputs.poses)
    if not isinstance(point, str):
        return np.asarray(relative_point(motion, point[0], point[1], on).position).reshape(shape)
    world = motion.points[point].position
    if on == FRAME:
        return np.asarray(world).reshape(shape)
    return np.asarray(relative_link(motion, FRAME, on).at(world).position).reshape(shape)


@checked
def centrodes(
    motion: Motion,
    link: str,
    on: str = FRAME,
    *,
    pose: int = 0,
    design: int = 0,
    every: int | None = None,
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw the fixed and the moving centrode of a link as seen from another. The moving one is where it is at a pose.

    Both in the frame of `on`; they touch at the pole of that pose. `design` is an index where there are several. Poles
    farther from the link than two and a half lengths of the mechanism are left out. Raises UnknownName for links that
    are not there, InvalidInput for a pose or design that is not there, where no driver moves, or below order 1.
    Source: E. A. Dijksman, Motion Geometry of Mechanisms (1976).

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> picture = centrodes(solve(load_named("elliptic-trammel")), "rod")
    >>> [line.get_label() for line in picture.figure.axes[0].get_lines()[:1]]
    ['fixed centrode (frame)']
    """
    shared = planar.drawing(motion, (), every)
    _check(motion, pose, design)
    fixed, moving, body = _curves(motion, link, on, design, pose)
    with plot_style.styled():
        figure, axes = canvas.panels(1, motion.mechanism.title if title is None else title, size or SIZE)
        one, shades = axes[0], plot_style.COLOURS
        planar.curve(one, shared, design, fixed, shades[0], f"fixed centrode ({on})")
        planar.marks(one, shared, design, fixed, shades[0])
        planar.curve(one, shared, design, moving, shades[1], f"moving centrode ({link})")
        _pole(one, shared, fixed[pose])
        fixed_points(one, motion, on, shared)
        _moving_points(one, body, shades[1], shared)
        unit = unit_of(motion.mechanism.unit, "length")
        canvas.plane(one, f"x [{unit}]", f"y [{unit}]")
        canvas.legend(one)
        where = f"every {shared.every} poses: {shared.x.label}"
        canvas.events_legend(figure, False, bool(shared.happened.blanks), False, where)
        return canvas.finished(figure, shared.labels)


def _moving_points(axes: Any, body: dict[str, complex], colour: Any, shared: planar.SharedCurves) -> None:
    """The points of the moving link at the pose, as crosses with their letters."""
    for letter, z in body.items():
        axes.plot([z.real], [z.imag], marker="x", markersize=6, color=colour, linestyle="none", zorder=6)
        shared.labels.append(PointLabel(axes, z.real, z.imag, letter, 1j, colour))


def _check(motion: Motion, pose: int, design: int) -> None:
    for what, index, count in (("pose", pose, motion.inputs.poses), ("design", design, motion.inputs.designs)):
        if not 0 <= index < count:
            raise InvalidInput(Problem(what, f"there is no {what} {index}", f"0 to {count - 1}"))


def _curves(motion: Motion, link: str, on: str, design: int, pose: int) -> tuple[Number, Number, dict[str, complex]]:
    """The fixed centrode, the moving one at a pose, and the points of the moving link there."""
    found, seen = pole(motion, link, on), relative_link(motion, link, on)
    rows = (motion.inputs.designs, motion.inputs.poses)

    def row(values: Any) -> Number:
        return np.broadcast_to(values, motion.shape).reshape(rows)[design]

    fixed, moving = row(found.fixed), row(found.moving)
    origin, turn = complex(row(seen.origin.position)[pose]), complex(np.exp(1j * row(seen.angle)[pose]))
    own, other = _places(motion, link, design), _places(motion, on, design)
    body = {letter: origin + turn * place for letter, place in own.items()}
    fixed, moving = _near(fixed, other, motion.size), _near(moving, own, motion.size)
    return fixed, origin + turn * moving, body


def _places(motion: Motion, link: str, design: int) -> dict[str, complex]:
    """The points of a link in its own frame, of one design at its first pose."""
    known = motion.mechanism.geometry.points[link]
    rows = {
        name: np.broadcast_to(place, motion.shape).reshape(motion.inputs.designs, -1) for name, place in known.items()
    }
    return {name: complex(row[design, 0]) for name, row in rows.items()}


def _near(curve: Number, points: dict[str, complex], size: float) -> Number:
    """A curve with poles far from a link's points and at infinity left out."""
    middle = np.mean(list(points.values())) if points else 0j
    with np.errstate(invalid="ignore"):
        near = np.isfinite(curve) & (np.abs(curve - middle) <= FAR * size)
    return np.where(near, curve, complex(np.nan, np.nan))


def _pole(axes: Any, shared: planar.SharedCurves, z: complex) -> None:
    if np.isfinite(z):
        canvas.dot(axes, [z.real], [z.imag], plot_style.INK, 6.0)
        shared.labels.insert(0, PointLabel(axes, z.real, z.imag, "pole", 1 - 1j))
