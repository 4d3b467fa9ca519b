"""`plot`: quantities over the driver, the time or any other quantity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.forces import Forces, moved
from compoundkin.kinematics import Motion
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.marked_places import Events, at, events
from compoundkin.view.plot.mean_lines import mean_lines
from compoundkin.view.plot.plot_style import Plot
from compoundkin.view.plot.plotted_rows import Plotted, all_of, along
from compoundkin.view.plot.point_labels import PointLabel, number
from compoundkin.view.plot.solved_courses import PlottedCourse, PlottedExtreme, plotted_extremes
from compoundkin.view.plot.vertical_ranges import set_range

FIRST, EACH = 2.0, 2.0
# More curves than this in a panel, and values beside their extremes would be a crowd.
MOST_MARKED = 4
# How high the strip is that shows where single designs cannot be assembled.
STRIP = 0.1


@dataclass(frozen=True, eq=False)
class Panel:
    """One axes: its curves, and what its vertical axis is called."""

    title: Plotted
    curves: tuple[Plotted, ...]


@checked
def plot(
    motion: Motion | Forces,
    *names: str,
    against: str | None = None,
    stacked: bool = True,
    extremes: bool | None = None,
    designs: Sequence[str] = (),
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw quantities of a motion or its forces over driver, time or others.

    `names` as `quantity` takes them ("G.velocity", "crank.effort"), also "G.velocity.x", "G.velocity.length"; a vector
    is drawn as its components and its length; none means the mechanism's outputs.
    `against` is "time", "driver", "pose" or a quantity; without it the time of a motion in time, else the first driver
    that moves. Every quantity has a panel of its own; with ``stacked=False`` those of one unit share one. Angles are in
    degrees. The highest and lowest values are marked, between poses too, unless `extremes` is False or there are many
    curves; where a derivative jumps, the curve does. Designs are a family of curves, called `designs` if that is given.
    `size` is in inches.

    What cannot be assembled is shaded, poses next to limit positions are ringed, change points dashed. Raises
    UnknownName for names that the motion does not have, InvalidInput for a motion of a single pose, a vector to draw
    against, or without Matplotlib.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> picture = plot(solve(load_named("six-bar")), "bar.angle", "G.velocity")
    >>> [axes.get_ylabel() for axes in picture.figure.axes]
    ['bar.angle [deg]', 'G.velocity [mm/s]']
    """
    motion = moved(motion)
    x, is_input = along(motion, against)
    shown = arranged(all_of(motion, names), motion.inputs.designs, stacked)
    called = canvas.design_names(motion.shape, designs)
    if len(called) != motion.inputs.designs:
        told = f"there are {motion.inputs.designs} designs and {len(called)} names"
        raise InvalidInput(Problem("designs", told, "give one for each, or leave them out"))
    happened = events(motion)
    with plot_style.styled():
        height, text = FIRST + EACH * len(shown), motion.mechanism.title if title is None else title
        figure, axes = canvas.panels(len(shown), text, size or (canvas.WIDTH, height), sharex=True)
        labels: list[PointLabel] = []
        _across(axes, x, is_input)
        course, marks = PlottedCourse.of(motion, x), _marks(motion, x, shown, extremes)
        for one, panel in zip(axes, shown, strict=True):
            _draw(one, course, panel, happened, marks, labels)
            canvas.axis_labels(one, x if one is axes[-1] else None, panel.title, canvas.PANEL)
            _mark_events(one, x, happened, is_input)
        _legends(figure, axes, called, happened, is_input)
        return canvas.finished(figure, labels)


def arranged(shown: Sequence[Plotted], designs: int, stacked: bool) -> tuple[Panel, ...]:
    """Return the panels of quantities. One each, one for each unit, or with several designs one for each part."""
    if designs > 1:
        return tuple(Panel(part, (part,)) for one in shown for part in one.parts)
    if stacked:
        return tuple(Panel(one, one.parts) for one in shown)
    units = dict.fromkeys(one.unit for one in shown)
    found = []
    for unit in units:
        same = [one for one in shown if one.unit == unit]
        names = same[0].name if len(same) == 1 else ""
        parts = tuple(part for one in same for part in one.parts)
        found.append(Panel(Plotted(names, unit, same[0].values, scale=max(one.scale for one in same)), parts))
    return tuple(found)


def _marks(
    motion: Motion, x: Plotted, shown: Sequence[Panel], asked: bool | None
) -> dict[str, tuple[tuple[PlottedExtreme, ...], ...]]:
    """The extremes of all curves that are marked, found at once."""
    designs = len(x.values)
    marked = [panel for panel in shown if asked or (asked is None and len(panel.curves) * designs <= MOST_MARKED)]
    return plotted_extremes(motion, x, [curve for panel in marked for curve in panel.curves])


def _draw(
    axes: Any,
    course: PlottedCourse,
    panel: Panel,
    happened: Events,
    marks: dict[str, tuple[tuple[PlottedExtreme, ...], ...]],
    labels: list[PointLabel],
) -> None:
    """The curves of a panel, their extremes, and rings beside limit positions."""
    x = course.x
    designs = len(x.values)
    shades = plot_style.colours(len(panel.curves), designs)
    unbounded = any(curve.has_poles for curve in panel.curves)
    near = unbounded or any(any(blank.limits) for blank in happened.blanks)
    window = set_range(axes, panel.curves, panel.title.scale, near)
    found: list[PointLabel] = []
    for k, (curve, d) in enumerate((curve, d) for curve in panel.curves for d in range(designs)):
        name = curve.name.removeprefix(f"{panel.title.name}.") if designs == 1 else f"_design {d}"
        axes.plot(*course.line(curve, d), color=shades[k], label=name)
        beside = happened.beside(d, x.values.shape[1])
        canvas.ring(axes, x.values[d][beside], curve.values[d][beside], shades[k])
        marked = curve.name in marks and not curve.poles[d].any()
        _mark_extremes(axes, marks[curve.name][d] if marked else (), curve, window, shades[k], found)
    mean_lines(axes, course, panel.curves, shades)
    # the outermost ones take their places first
    labels.extend(sorted(found, key=lambda label: -label.y * label.towards.imag))


def _mark_extremes(
    axes: Any,
    marks: Sequence[PlottedExtreme],
    curve: Plotted,
    window: tuple[float, float] | None,
    colour: Any,
    labels: list[PointLabel],
) -> None:
    for one in marks:
        if window is None or window[0] < one.y < window[1]:
            canvas.dot(axes, one.x, one.y, colour)
            towards = 1j if one.is_highest else -1j
            labels.append(PointLabel(axes, one.x, one.y, number(one.y, curve.scale), towards, colour))


def _mark_events(axes: Any, x: Plotted, happened: Events, is_input: bool) -> None:
    """Shades where nothing is assembled, and dashes at change points."""
    designs = len(x.values)
    shades = [plot_style.SHADE] if designs == 1 else plot_style.colours(1, designs)
    for blank in happened.blanks if is_input else ():
        row = x.values[blank.design]
        begin, end = at(row, blank.begin), at(row, blank.end)
        low, high = (0.0, 1.0) if designs == 1 else np.array([blank.design, blank.design + 1]) * STRIP / designs
        axes.axvspan(begin, end, low, high, color=shades[blank.design], linewidth=0, zorder=0.5)
    for design, place in happened.changes:
        where = at(x.values[design], place)
        colour = plot_style.GREY if designs == 1 else shades[design]
        if np.isfinite(where):
            axes.axvline(where, color=colour, linestyle="--", linewidth=1.0, zorder=1)


def _across(axes: Sequence[Any], x: Plotted, is_input: bool) -> None:
    """The horizontal axis from end to end of what drives the motion."""
    if is_input and np.ptp(known := x.values[np.isfinite(x.values)]) > 0:
        axes[0].set_xlim(known.min(), known.max())


def _legends(figure: Any, axes: Sequence[Any], called: Sequence[str], happened: Events, is_input: bool) -> None:
    if len(called) > 1:
        canvas.designs_legend(figure, axes, called)
    else:
        for one in axes:
            canvas.legend(one)
    limits = any(any(blank.limits) for blank in happened.blanks)
    canvas.events_legend(figure, bool(happened.blanks) and is_input, limits, bool(happened.changes))
