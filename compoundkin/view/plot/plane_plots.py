"""Curves in a plane: paths, centrodes, phase plots, hodographs, polar plots and polar diagrams of bearing loads.

All have equal scales, arrows in the direction of motion, and marks at every so many poses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np

from compoundkin.analysis.coupler.centrodes import pole
from compoundkin.analysis.coupler.relative_motion import local_point as place_on
from compoundkin.analysis.coupler.relative_motion import relative_link, relative_point
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, first_entry
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.forces import Forces, motion_of
from compoundkin.kinematics import Motion
from compoundkin.model.attributes import FORCE, LENGTH, OF_FORCES, PARTS, typeset_unit, unit_of
from compoundkin.model.geometry import FRAME
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.canvas import PointLabel, value_text
from compoundkin.view.plot.plot_style import Plot
from compoundkin.view.plot.plotted_rows import (
    Events,
    Plotted,
    events,
    horizontal_axis,
    moving_driver,
    plotted_quantities,
    plotted_quantity,
    rate_name,
)
from compoundkin.view.plot.quantity_plot import switches

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

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> picture = paths(solve(load("jansen-leg")), "foot")
    >>> picture.figure.axes[0].get_aspect()
    1.0
    """
    motion.mechanism.link(on)
    names = [point if isinstance(point, str) else _called(motion, *point) for point in points]
    names = names or [name for name in motion.points if name not in motion.mechanism.geometry.points[on]]
    curves = [_path(motion, point, on) for point in (points or names)]
    shared = shared_curves_of(motion, designs, every)
    with plot_style.styled():
        figure, axes = canvas.panels(1, motion.mechanism.title if title is None else title, size or SIZE)
        draw_curves(axes[0], shared, curves, names)
        fixed_points(axes[0], motion, on, shared)
        unit = unit_of(motion.mechanism.unit, "length")
        canvas.plane_axes(axes[0], f"x [{unit}]", f"y [{unit}]")
        draw_plane_legends(figure, axes, shared, True)
        return canvas.finished(figure, shared.labels)


def fixed_points(axes: Any, motion: Motion, on: str, shared: SharedCurves) -> None:
    """Draw the points of the observing link, as crosses with their letters. Those of the first design."""
    for letter, place in motion.mechanism.geometry.points[on].items():
        z = complex(np.ravel(place)[0])
        axes.plot([z.real], [z.imag], marker="x", markersize=6, color=plot_style.INK, linestyle="none", zorder=6)
        shared.labels.insert(0, PointLabel(axes, z.real, z.imag, letter, -1j))


def _called(motion: Motion, link: str, point: Any) -> str:
    motion.mechanism.link(link)
    z = complex(first_entry(place_on(motion, link, point)))
    return f"{link} ({value_text(z.real)}, {value_text(z.imag)})"


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

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> picture = centrodes(solve(load("elliptic-trammel")), "rod")
    >>> [line.get_label() for line in picture.figure.axes[0].get_lines()[:1]]
    ['fixed centrode (frame)']
    """
    shared = shared_curves_of(motion, (), every)
    _check_indices(motion, pose, design)
    fixed, moving, body = _curves(motion, link, on, design, pose)
    with plot_style.styled():
        figure, axes = canvas.panels(1, motion.mechanism.title if title is None else title, size or SIZE)
        one, shades = axes[0], plot_style.COLOURS
        draw_curve(one, shared, design, fixed, shades[0], f"fixed centrode ({on})")
        draw_marks(one, shared, design, fixed, shades[0])
        draw_curve(one, shared, design, moving, shades[1], f"moving centrode ({link})")
        _pole(one, shared, fixed[pose])
        fixed_points(one, motion, on, shared)
        _moving_points(one, body, shades[1], shared)
        unit = unit_of(motion.mechanism.unit, "length")
        canvas.plane_axes(one, f"x [{unit}]", f"y [{unit}]")
        canvas.draw_legend(one)
        where = f"every {shared.every} poses: {shared.x.label}"
        canvas.events_legend(figure, False, bool(shared.events.blanks), False, where)
        return canvas.finished(figure, shared.labels)


def _moving_points(axes: Any, body: dict[str, complex], colour: Any, shared: SharedCurves) -> None:
    """The points of the moving link at the pose, as crosses with their letters."""
    for letter, z in body.items():
        axes.plot([z.real], [z.imag], marker="x", markersize=6, color=colour, linestyle="none", zorder=6)
        shared.labels.append(PointLabel(axes, z.real, z.imag, letter, 1j, colour))


def _check_indices(motion: Motion, pose: int, design: int) -> None:
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


def _pole(axes: Any, shared: SharedCurves, z: complex) -> None:
    if np.isfinite(z):
        canvas.draw_dots(axes, [z.real], [z.imag], plot_style.INK, 6.0)
        shared.labels.insert(0, PointLabel(axes, z.real, z.imag, "pole", 1 - 1j))


# Sizes in inches.
PHASE, HODOGRAPH, POLAR = (6.0, 5.0), (6.0, 5.6), (5.6, 5.8)
# What Matplotlib leaves out of legends begins so.
ZERO = "_zero"
# Where the radii may be written, degrees, between the lines of angles.
FREE_ANGLES = np.arange(15.0, 375.0, 30.0)
# Free space inside the lowest and outside the highest value, as a part of their distance.
MARGIN = 0.08


@checked
def phase(
    motion: Motion | Forces,
    name: str,
    rate: str | None = None,
    *,
    every: int | None = None,
    designs: Sequence[str] = (),
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw a quantity against its rate: "rocker.angle" against "rocker.angular_velocity".

    `rate` is any other quantity to take in place of the rate. A dot every so many poses tells the driver's value or the
    time, the arrow the direction of the motion; designs are a family of curves. Raises UnknownName for names that the
    motion does not have and for quantities without a rate (take a component of a vector: "G.velocity.x"), InvalidInput
    for vectors and where the motion's order is too low.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> picture = phase(solve(load("crank-rocker")), "rocker.angle")
    >>> picture.figure.axes[0].get_ylabel()
    'rocker.angular_velocity [rad/s]'
    """
    motion = motion_of(motion)
    x, y = plotted_quantity(motion, name), plotted_quantity(motion, rate or rate_name(motion, name))
    for one in (x, y):
        if one.is_vector:
            raise InvalidInput(Problem(one.name, "it is a vector", f"take a component: {one.name}.{next(iter(PARTS))}"))
    shared = shared_curves_of(motion, designs, every)
    with plot_style.styled():
        figure, axes = canvas.panels(1, motion.mechanism.title if title is None else title, size or PHASE)
        shades: Any = plot_style.colours(1, shared.designs)
        for d in range(shared.designs):
            z = x.values[d] + 1j * y.values[d]
            draw_curve(axes[0], shared, d, z, shades[d], shared.names[d])
            draw_marks(axes[0], shared, d, z, shades[d], shared.designs == 1)
        axes[0].margins(0.1)
        canvas.axis_labels(axes[0], x, y, canvas.WHOLE)
        draw_plane_legends(figure, axes, shared, True)
        return canvas.finished(figure, shared.labels)


@checked
def hodograph(
    motion: Motion | Forces,
    *names: str,
    every: int | None = None,
    designs: Sequence[str] = (),
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw the curves of vectors' tips, all from one origin: "G.velocity".

    Equal scales; a dot every so many poses with the driver's value or the time. Vectors of one plot have one unit.
    Raises UnknownName for names that the motion does not have, InvalidInput for other quantities or other units.
    Source: W. R. Hamilton, The Hodograph (1847).

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> hodograph(solve(load("six-bar")), "G.velocity").figure.axes[0].get_xlabel()
    'G.velocity, x [mm/s]'
    """
    motion = motion_of(motion)
    vectors = plotted_quantities(motion, names)
    for one in vectors:
        if not one.is_vector:
            raise InvalidInput(Problem(one.name, "it is not a vector", "a hodograph takes vectors such as G.velocity"))
    _check_one_unit(vectors)
    shared = shared_curves_of(motion, designs, every)
    with plot_style.styled():
        figure, axes = canvas.panels(1, motion.mechanism.title if title is None else title, size or HODOGRAPH)
        forces = vectors[0].dimension in OF_FORCES
        draw_curves(axes[0], shared, [one.values for one in vectors], [one.name for one in vectors], forces)
        axes[0].plot([0.0], [0.0], marker="+", markersize=11, color=plot_style.INK, linestyle="none", zorder=6)
        unit, names_ = typeset_unit(vectors[0].unit), ", ".join(one.name for one in vectors)
        canvas.plane_axes(axes[0], f"{names_}, x [{unit}]", f"y [{unit}]")
        draw_plane_legends(figure, axes, shared, True)
        return canvas.finished(figure, shared.labels)


@checked
def polar(
    motion: Motion | Forces,
    *names: str,
    around: str | None = None,
    designs: Sequence[str] = (),
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw quantities as radii over an angle: the first driver that moves, or `around`.

    Vectors are drawn by their length. Radii begin at zero, or with negative values below the lowest one; then the zero
    circle is drawn. All quantities of a plot have one unit. Raises UnknownName for names that the motion does not
    have, InvalidInput where units differ or `around` is not an angle.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> polar(solve(load("crank-shaper")), "E.velocity").figure.axes[0].name
    'polar'
    """
    motion = motion_of(motion)
    radii = tuple(one.part(LENGTH) if one.is_vector else one for one in plotted_quantities(motion, names))
    angle = moving_driver(motion) if around is None else plotted_quantity(motion, around)
    if not angle.is_angle:
        raise InvalidInput(Problem(angle.name, "it is not an angle", 'name one: around="crank.angle"'))
    _check_one_unit(radii)
    shared = shared_curves_of(motion, designs, None)
    with plot_style.styled():
        text = motion.mechanism.title if title is None else title
        figure, axes = canvas.panels(1, text, size or POLAR, subplot_kw={"projection": "polar"})
        shades: Any = plot_style.colours(len(radii), shared.designs)
        for k, one in enumerate(radii):
            for d in range(shared.designs):
                colour = shades[k if shared.designs == 1 else d]
                _line(axes[0], shared, d, angle, one, colour)
        _rings(axes[0], radii)
        axes[0].set_rlabel_position(_free_angle(axes[0]))
        axes[0].set_xlabel(f"{replace(radii[0], name=', '.join(one.name for one in radii)).label} over {angle.label}")
        draw_plane_legends(figure, axes, shared, False)
        return canvas.finished(figure, [])


def _check_one_unit(quantities: Sequence[Plotted]) -> None:
    first = quantities[0]
    for one in quantities:
        if one.unit != first.unit:
            what = f"its unit is {one.unit}, that of {first.name} {first.unit}"
            raise InvalidInput(Problem(one.name, what, "draw them one by one"))


def _line(axes: Any, shared: SharedCurves, d: int, angle: Plotted, radius: Plotted, colour: Any) -> None:
    around, out = radius.curve(d, angle)
    axes.plot(np.deg2rad(around), out, color=colour, label=radius.name)
    beside = shared.events.beside(d, angle.values.shape[1])
    canvas.draw_rings(axes, np.deg2rad(angle.values[d][beside]), radius.values[d][beside], colour)


def _rings(axes: Any, radii: Sequence[Plotted]) -> None:
    """The range of radii and few rings, the zero circle among them where it lies inside."""
    from matplotlib.ticker import MaxNLocator

    values = np.concatenate([one.values[np.isfinite(one.values)] for one in radii])
    scale = max(one.scale for one in radii)
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    low = 0.0 if low >= 0.0 else low
    pad = MARGIN * (high - low) or scale
    axes.set_rlim(low - pad if low < 0.0 else 0.0, high + pad)
    axes.yaxis.set_major_locator(MaxNLocator(4, steps=(1, 2, 2.5, 5, 10)))
    axes.set_thetagrids(range(0, 360, 30))
    axes.tick_params(axis="y", labelcolor=plot_style.GREY)
    axes.spines["polar"].set_color("#c8c8c8")
    if low < 0.0:
        turn = np.linspace(0.0, 2.0 * np.pi, 181)
        axes.plot(turn, np.zeros(len(turn)), color=plot_style.GREY, linewidth=1.0, zorder=0.4, label=ZERO)


def _free_angle(axes: Any) -> float:
    """The angle, of those between the lines of angles, at which the rings are farthest from all curves."""
    low, high = axes.get_ylim()
    rings = np.array([r for r in axes.yaxis.get_majorticklocs() if low < r < high])
    free = np.full(len(FREE_ANGLES), np.inf)
    for line in axes.get_lines():
        known = np.isfinite(line.get_ydata()) & (line.get_label() != ZERO)
        angle, radius = np.asarray(line.get_xdata())[known], np.asarray(line.get_ydata())[known]
        if len(angle) and len(rings):
            apart = np.abs(np.exp(1j * angle) - np.exp(1j * np.deg2rad(FREE_ANGLES))[:, None])
            distance = np.abs(radius[:, None] - rings).min(axis=1) / (high - low)
            free = np.minimum(free, np.min(apart + distance, axis=1))
    return float(FREE_ANGLES[np.argmax(free)])


# So wide and high is a panel, inches.
PANEL, HEIGHT = 4.6, 5.0
# How far a title stands above its axes where a legend is between, in points.
ABOVE_LEGEND = 24.0


@checked
def bearing_loads(
    motion: Motion | Forces,
    *pairs: str,
    every: int | None = None,
    designs: Sequence[str] = (),
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw polar diagrams of bearing loads, the force on each pair's second link.

    A panel shows the force in the frame, another one in the axes of each moving link of the pair, where it tells on
    which side a journal or a bush is worn; in the first link's axes it is the opposite force, which acts on that link.
    `pairs` are names; several are in one panel in the frame's axes only. A dot every so many poses has the driver's
    value or the time.

    Raises UnknownName for pairs that are unknown, InvalidInput where none is named. Source: polar load diagrams of
    engine bearings, e.g. C. F. Taylor, The Internal-Combustion Engine in Theory and Practice.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.loads.gravity import gravity
    >>> from compoundkin.model.loads.mass import mass
    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.kinematics import solve
    >>> items = link("frame", A=0), link("crank", A=0, B=2), drive("crank"), mass("crank", 1.0, at="B")
    >>> units = {"length": "m", "mass": "kg", "force": "N"}
    >>> picture = bearing_loads(solve(Mechanism("m", *items, gravity(0, -9.81), units=units), speed=3.0), "A")
    >>> [axes.get_title() for axes in picture.figure.axes]
    ['in the frame', 'in the axes of crank']
    """
    if not pairs:
        raise InvalidInput(Problem("pairs", "no pair is named", 'name some: bearing_loads(forces, "A")'))
    forces = motion if isinstance(motion, Forces) else motion.forces
    panels = _panels(forces, pairs)
    shared = shared_curves_of(forces.motion, designs, every)
    with plot_style.styled():
        text = forces.mechanism.title if title is None else title
        figure, axes = canvas.panels(1, text, size or (PANEL * len(panels), HEIGHT), columns=len(panels))
        unit = forces.units.force
        for one, (said, drawn) in zip(axes, panels, strict=True):
            draw_curves(one, shared, drawn, [f"{name}.{FORCE}" for name in pairs], switched=True)
            one.plot([0.0], [0.0], marker="+", markersize=11, color=plot_style.INK, linestyle="none", zorder=6)
            canvas.plane_axes(one, f"{', '.join(pairs)}: force, x [{unit}]", f"y [{unit}]")
            # above the legend, which stands where there is more than one curve
            one.set_title(said, fontsize="medium", pad=ABOVE_LEGEND if len(pairs) > 1 else None)
        draw_plane_legends(figure, axes, shared, True)
        return canvas.finished(figure, shared.labels)


def _panels(forces: Forces, pairs: Sequence[str]) -> list[tuple[str, list[Number]]]:
    """The titles of the panels with their curves, (designs, poses)."""
    rows = [_rows(forces, forces.pairs[name].force) for name in pairs]
    found = [("in the frame", rows)]
    if len(pairs) > 1:
        return found
    held = forces.pairs[pairs[0]]
    for side, link in enumerate(held.pair.members[:2]):
        if link != FRAME:
            turned = _rows(forces, np.exp(-1j * np.asarray(forces.links[link].angle)))
            found.append((f"in the axes of {link}", [(rows[0] if side else -rows[0]) * turned]))
    return found


def _rows(forces: Forces, values: Number) -> Number:
    return np.broadcast_to(np.asarray(values), forces.shape).reshape(forces.inputs.designs, -1)


# About so many marks along a curve, where it is not said after how many poses they come.
MARKS = 12
# Nearer than this part of a curve's size to the first one, the last mark is the same.
SAME = 1e-6


@dataclass(frozen=True, eq=False)
class SharedCurves:
    """The data that all curves of a plot share: driver or time, events, names of designs, labels to be placed."""

    x: Plotted
    events: Events
    names: Sequence[str]
    every: int
    labels: list[PointLabel]

    @property
    def designs(self) -> int:
        """The number of designs."""
        return len(self.x.values)


def shared_curves_of(motion: Motion, designs: Sequence[str], every: int | None) -> SharedCurves:
    """Return what the curves of a plot share. Raises InvalidInput for wrong names or distances of marks."""
    x, _ = horizontal_axis(motion, None)
    called = canvas.design_names(motion.shape, designs)
    if every is not None and every < 1:
        raise InvalidInput(Problem("every", f"{every} is not a number of poses", "give 1 or more, or leave it out"))
    default = max(1, round((motion.inputs.poses - 1) / MARKS))
    return SharedCurves(x, events(motion), called, every or default, [])


def draw_curve(
    axes: Any, shared: SharedCurves, d: int, z: Number, colour: Any, name: str, switched: bool = False
) -> None:
    """Draw one curve with an arrow, and rings next to limit positions. The curve is complex, pose by pose.

    No line goes through where forces are `switched` on or off by loads that act one way only.
    """
    line = np.insert(z, np.flatnonzero(switches(z)) + 1, complex(np.nan, np.nan)) if switched else z
    axes.plot(line.real, line.imag, color=colour, label=name)
    canvas.draw_arrow(axes, z.real, z.imag, colour)
    beside = shared.events.beside(d, len(z))
    canvas.draw_rings(axes, z.real[beside], z.imag[beside], colour)


def draw_curves(
    axes: Any, shared: SharedCurves, drawn: Sequence[Number], names: Sequence[str], switched: bool = False
) -> None:
    """Draw curves of all designs with their marks, in their colours, as `draw_curve` does.

    The colours are their own or, where there are several, of designs.
    """
    shades: Any = plot_style.colours(len(drawn), shared.designs)
    for k, (rows, name) in enumerate(zip(drawn, names, strict=True)):
        for d in range(shared.designs):
            colour = shades[k if shared.designs == 1 else d]
            draw_curve(axes, shared, d, rows[d], colour, name, switched)
            draw_marks(axes, shared, d, rows[d], colour, shared.designs == len(drawn) == 1)


def draw_marks(axes: Any, shared: SharedCurves, d: int, z: Number, colour: Any, labelled: bool = True) -> None:
    """Draw dots at every so many poses, with the driver's value or time. Large families have none."""
    if shared.designs > canvas.LISTED:
        return
    index = np.arange(0, len(z), shared.every)
    index = index[np.isfinite(z[index])]
    if not len(index):
        return
    known = z[np.isfinite(z)]
    size = float(np.max(np.abs(known - known[0])))
    index = index[(index == index[0]) | (np.abs(z[index] - z[index[0]]) > SAME * size)]
    canvas.draw_dots(axes, z[index].real, z[index].imag, colour, 3.5)
    middle = complex(np.mean(known))
    unit = "°" if shared.x.is_angle else ""
    for k in index if labelled else ():
        away = complex(z[k]) - middle
        text = value_text(float(shared.x.values[d, k]), shared.x.scale) + unit
        shared.labels.append(PointLabel(axes, z[k].real, z[k].imag, text, away if away else 1j, plot_style.GREY))


def draw_plane_legends(figure: Any, axes: Sequence[Any], shared: SharedCurves, marked: bool) -> None:
    """Draw the legends of curves, designs, rings and marks."""
    if shared.designs > 1:
        canvas.designs_legend(figure, axes, shared.names)
    else:
        for one in axes:
            canvas.draw_legend(one)
    limits = any(any(blank.limits) for blank in shared.events.blanks)
    what = f"every {shared.every} poses: {shared.x.label}" if shared.every > 1 else f"every pose: {shared.x.label}"
    canvas.events_legend(figure, False, limits, False, what if marked and shared.designs <= canvas.LISTED else "")
