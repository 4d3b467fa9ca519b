"""Coupler curves: the paths of points in the plane."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np

from compoundkin.analysis.coupler.relative_motion import relative_link, relative_point
from compoundkin.base.series import Number
from compoundkin.kinematics import Motion
from compoundkin.model.attributes import unit_of
from compoundkin.model.elements import FRAME
from compoundkin.view.plot import canvas, planar, plot_style
from compoundkin.view.plot.plot_picture import Plot
from compoundkin.view.plot.point_labels import PointLabel, number

SIZE = (6.4, 5.8)
# A letter of the mechanism, or a link and a place (complex or x, y) in its own frame.
Point: TypeAlias = str | tuple[str, Any]


def paths(
    motion: Motion,
    *points: Point,
    on: str = FRAME,
    every: int | None = None,
    designs: Sequence[str] = (),
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw the paths of points, as an observer on a link sees them: coupler curves.

    A point is a letter, or a link and a place in its frame: ``("coupler", (3, 1))``. Equal scales; a dot every so many
    poses with the driver's value or the time; the points of the observing link are drawn as crosses. Raises UnknownName
    for points and links that are not there.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> picture = paths(solve(load_named("jansen-leg")), "foot")
    >>> picture.figure.axes[0].get_aspect()
    1.0
    """
    names = [point if isinstance(point, str) else _called(*point) for point in points] or _moving(motion, on)
    curves = [_path(motion, point, on) for point in (points or names)]
    shared = planar.drawing(motion, designs, every)
    with plot_style.styled():
        figure, axes = canvas.panels(1, motion.mechanism.title if title is None else title, size or SIZE)
        shades: Any = plot_style.colours(len(curves), shared.designs)
        for k, rows in enumerate(curves):
            for d in range(shared.designs):
                colour = shades[k if shared.designs == 1 else d]
                planar.curve(axes[0], shared, d, rows[d], colour, names[k])
                planar.marks(axes[0], shared, d, rows[d], colour, shared.designs == len(curves) == 1)
        fixed_points(axes[0], motion, on, shared)
        unit = unit_of(motion.mechanism.unit, "length")
        canvas.plane(axes[0], f"x [{unit}]", f"y [{unit}]")
        planar.finish(figure, axes, shared, True)
        return canvas.finished(figure, shared.labels)


def fixed_points(axes: Any, motion: Motion, on: str, shared: planar.SharedCurves) -> None:
    """The points of the observing link, as crosses with their letters; those of the first design."""
    for letter, place in motion.mechanism.geometry.points[on].items():
        z = complex(np.ravel(place)[0])
        axes.plot([z.real], [z.imag], marker="x", markersize=6, color=plot_style.INK, linestyle="none", zorder=6)
        shared.labels.insert(0, PointLabel(axes, z.real, z.imag, letter, -1j))


def _moving(motion: Motion, on: str) -> list[str]:
    """The letters of all points that are not on the observing link."""
    return [name for name in motion.points if name not in motion.mechanism.geometry.points[on]]


def _called(link: str, place: Any) -> str:
    z = complex(*place) if np.ndim(place) else complex(place)
    return f"{link} ({number(z.real)}, {number(z.imag)})"


def _path(motion: Motion, point: Point, on: str) -> Number:
    shape = (motion.inputs.designs, motion.inputs.poses)
    if not isinstance(point, str):
        return np.asarray(relative_point(motion, point[0], point[1], on).position).reshape(shape)
    world = motion.points[point].position
    if on == FRAME:
        return np.asarray(world).reshape(shape)
    return np.asarray(relative_link(motion, FRAME, on).at(world).position).reshape(shape)
