"""`plot`: quantities over the driver, the time or any other quantity; several motions share their panels.

Between poses, curves are solved again: they are smooth, go up to limit positions, and jump where the motion does.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, degrees
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.forces import Forces, motion_of
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import Places, between, extremes, places_of_jumps
from compoundkin.kinematics.extremes.stretches import SAME_PLACE, Stretches, stretches_of
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import EFFORT, FLANK, LENGTH, OF_FORCES, POWER, TIME, derivative_order, motion_figure
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.canvas import AxisScales, PointLabel, set_range, value_text
from compoundkin.view.plot.plot_style import Plot
from compoundkin.view.plot.plotted_rows import (
    CONSTANT,
    POSE,
    Events,
    Plotted,
    events,
    horizontal_axis,
    interpolated,
    plotted_quantities,
)

FIRST, EACH = 2.0, 2.0


@checked
def plot(
    motion: Motion | Forces | Sequence[Motion | Forces],
    *names: str,
    against: str | None = None,
    stacked: bool = True,
    extremes: bool | None = None,
    designs: Sequence[str] = (),
    xlim: tuple[float, float] | None = None,
    ylim: tuple[float, float] | None = None,
    log: str | None = None,
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw quantities of a motion or its forces over driver, time or others.

    `names` as `quantity` takes them ("G.velocity", "crank.effort"), also "G.velocity.x", "G.velocity.length"; a vector
    is drawn as its components and its length; none means the mechanism's outputs.
    `against` is "time", "driver", "pose" or a quantity; without it the time of a motion in time, else the first driver
    that moves. Every quantity has a panel of its own; with ``stacked=False`` those of one unit share one. Angles are in
    degrees. The highest and lowest values are marked, between poses too, unless `extremes` is False or there are many
    curves; where a derivative jumps, the curve does; between poses it is solved, so that it is smooth. Designs are a
    family of curves, called `designs` if that is given; so are several motions, whose quantities have one unit.
    `xlim` and `ylim` are the ends of the axes in the units that are shown, `log` is "x", "y" or "xy". `size` is in
    inches.

    What cannot be assembled is shaded, poses next to limit positions are ringed, change points dashed. Raises
    UnknownName for names that the motion does not have, InvalidInput for a motion of a single pose, a vector to draw
    against, units that differ, a logarithmic axis of values that are not positive, or without Matplotlib.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> picture = plot(solve(load("six-bar")), "bar.angle", "G.velocity")
    >>> [axes.get_ylabel() for axes in picture.figure.axes]
    ['bar.angle [°]', 'G.velocity [mm/s]']
    """
    motions = [motion_of(one) for one in ([motion] if isinstance(motion, Motion | Forces) else motion)]
    known, scales = names_of_curves(motions, tuple(designs)), AxisScales.checked(xlim, ylim, log)
    drawn = motions_of_plot(motions, names, against, stacked)
    panels = [QuantityPanel(drawn, k, scales, extremes) for k in range(len(drawn[0].panels))]
    scales.check_fit(
        [one.x for one in drawn], [one.title for one in panels], [curve for one in panels for curve in one.curves]
    )
    heading = (motions[0].mechanism.title if len(motions) == 1 else "") if title is None else title
    with plot_style.styled():
        height = FIRST + EACH * len(panels)
        figure, axes = canvas.panels(len(panels), heading, size or (canvas.WIDTH, height), sharex=True)
        set_horizontal_range(axes[0], drawn, scales)
        labels = _draw(axes, panels, scales)
        draw_legends(figure, axes, drawn, known)
        return canvas.finished(figure, labels)


def _draw(axes: Sequence[Any], panels: Sequence[QuantityPanel], scales: AxisScales) -> list[PointLabel]:
    """Draw the panels, and return the labels that are to be placed."""
    labels: list[PointLabel] = []
    for one, panel in zip(axes, panels, strict=True):
        scales.make_log(one)
        panel.draw(one, labels)
        canvas.axis_labels(one, panel.across if one is axes[-1] else None, panel.title, canvas.PANEL)
        scales.ticks(one)
        panel.events(one)
    return labels


# More curves than this in a panel, and values beside their extremes would be a crowd.
MOST_MARKED = 4
# How high the strip is that shows where single designs cannot be assembled.
STRIP = 0.1


@dataclass(frozen=True, eq=False)
class DrawnCurve:
    """A curve of a panel. It is of a motion and a design, and has a line and a colour."""

    of: PlottedMotion
    curve: Plotted
    design: int
    line: tuple[Number, Number]
    colour: Any


@dataclass(frozen=True, eq=False)
class QuantityPanel:
    """One panel: the same quantities of all motions. With `extremes` they are marked."""

    motions: tuple[PlottedMotion, ...]
    number: int
    scales: AxisScales
    extremes: bool | None

    @property
    def title(self) -> Plotted:
        """The quantity that names its vertical axis."""
        return self.motions[0].panels[self.number].title

    @property
    def across(self) -> Plotted:
        """The quantity that names its horizontal axis, for all motions."""
        names = dict.fromkeys(one.x.name for one in self.motions)
        return replace(self.motions[0].x, name=", ".join(names))

    @property
    def designs(self) -> int:
        """The number of designs of all motions."""
        return sum(one.designs for one in self.motions)

    @property
    def curves(self) -> Sequence[Plotted]:
        """All curves, each of all designs of a motion."""
        return [curve for one in self.motions for curve in one.panels[self.number].curves]

    def lines(self) -> Iterator[DrawnCurve]:
        """Go through all curves and designs."""
        shades = curve_colours(self.motions, len(self.curves))
        for one in self.motions:
            for k, curve in enumerate(one.panels[self.number].curves):
                for d in range(one.designs):
                    shade = shades[k if self.designs == 1 else one.before + d]
                    yield DrawnCurve(one, curve, d, one.course.line(curve, d), shade)

    def draw(self, axes: Any, labels: list[PointLabel]) -> None:
        """Draw the curves, their extremes, and rings beside limit positions."""
        drawn, found = list(self.lines()), list[PointLabel]()
        near = any(curve.has_poles for curve in self.curves)
        near = near or any(any(blank.limits) for one in self.motions for blank in one.events.blanks)
        window = set_range(axes, self.curves, [one.line for one in drawn], self.scales, near)
        are_marked = self.extremes or (self.extremes is None and len(drawn) <= MOST_MARKED)
        for one in drawn:
            name = one.curve.name.removeprefix(f"{self.title.name}.")
            axes.plot(
                *one.line,
                color=one.colour,
                label=name if self.designs == 1 else f"_design {one.of.before + one.design}",
            )
            beside = one.of.events.beside(one.design, one.of.x.values.shape[1])
            canvas.draw_rings(
                axes, one.of.x.values[one.design][beside], one.curve.values[one.design][beside], one.colour
            )
            if are_marked and not one.curve.poles[one.design].any():
                self._mark(axes, one, window, found)
        if self.designs == 1:
            mean_lines(axes, self.motions[0].course, self.curves, [one.colour for one in drawn])
        # the outermost ones take their places first
        labels.extend(sorted(found, key=lambda label: -label.y * label.towards.imag))

    def _mark(self, axes: Any, one: DrawnCurve, window: tuple[float, float] | None, labels: list[PointLabel]) -> None:
        for mark in one.of.extremes.get(one.curve.name, {}).get(one.design, ()):
            if self.scales.shows(mark.x, mark.y) and (window is None or window[0] < mark.y < window[1]):
                canvas.draw_dots(axes, mark.x, mark.y, one.colour)
                towards = 1j if mark.is_highest else -1j
                text = value_text(mark.y, one.curve.scale)
                labels.append(PointLabel(axes, mark.x, mark.y, text, towards, one.colour))

    def events(self, axes: Any) -> None:
        """Draw shades where nothing is assembled, and dashes at change points."""
        alone = self.designs == 1
        shades = [plot_style.SHADE] if alone else curve_colours(self.motions, 1)
        for one in self.motions:
            for blank in one.events.blanks if one.is_input else ():
                k, row = one.before + blank.design, one.x.values[blank.design]
                low, high = (0.0, 1.0) if alone else np.array([k, k + 1]) * STRIP / self.designs
                axes.axvspan(
                    interpolated(row, blank.begin),
                    interpolated(row, blank.end),
                    low,
                    high,
                    color=shades[k],
                    lw=0,
                    zorder=0.5,
                )
            for design, place in one.events.changes:
                where = interpolated(one.x.values[design], place)
                colour = plot_style.GREY if alone else shades[one.before + design]
                if np.isfinite(where) and self.scales.reaches(where):
                    axes.axvline(where, color=colour, linestyle="--", linewidth=1.0, zorder=1)


def curve_colours(motions: Sequence[PlottedMotion], curves: int) -> Sequence[Any]:
    """Return the colours of curves. Several motions have those of several curves, designs go from dark to light."""
    designs = sum(one.designs for one in motions)
    if 1 < len(motions) == designs <= len(plot_style.COLOURS):
        return plot_style.colours(designs, 1)
    return plot_style.colours(curves, designs)


def set_horizontal_range(axes: Any, motions: Sequence[PlottedMotion], scales: AxisScales) -> None:
    """Set the ends of the horizontal axis. They are the given limits, else those of what drives the motions."""
    values = np.concatenate([one.x.values.ravel() for one in motions])
    known = values[np.isfinite(values)]
    if scales.xlim is not None:
        axes.set_xlim(*scales.xlim)
    elif all(one.is_input for one in motions) and np.ptp(known) > 0:
        axes.set_xlim(known.min(), known.max())


def draw_legends(figure: Any, axes: Sequence[Any], motions: Sequence[PlottedMotion], names: Sequence[str]) -> None:
    """Draw the legends of curves, motions and designs, and of events along them."""
    if len(names) > 1:
        canvas.designs_legend(figure, axes, names, curve_colours(motions, 1), beside=len(motions) == 1)
    else:
        for one in axes:
            canvas.draw_legend(one)
    blanks = [blank for one in motions for blank in one.events.blanks]
    shaded = any(one.events.blanks and one.is_input for one in motions)
    limits = any(any(blank.limits) for blank in blanks)
    canvas.events_legend(figure, shaded, limits, any(one.events.changes for one in motions))


# A mean nearer to zero than this part of the greatest value is zero but for rounding.
NOTHING = 1e-9


def mean_lines(axes: Any, course: PlottedCurve, curves: Sequence[Plotted], shades: Sequence[Any]) -> None:
    """Draw the mean of each effort and power, of one design, with its value."""
    for k, curve in enumerate(curves):
        if len(curve.values) == 1 and curve.name.rpartition(".")[2] in (EFFORT, POWER):
            mean = _mean(*course.line(curve, 0))
            if np.isfinite(mean):
                axes.axhline(
                    mean, color=shades[k], linestyle=(0, (5, 3)), linewidth=1.0, label=f"mean {value_text(mean)}"
                )


def _mean(x: Any, y: Any) -> float:
    """The mean of a curve along its axis, pieces that are known only."""
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    steps, middle = np.diff(x), (y[1:] + y[:-1]) / 2.0
    known = np.isfinite(middle) & np.isfinite(steps)
    way = float(np.sum(np.abs(steps[known])))
    found = float(np.sum(middle[known] * np.abs(steps[known]))) / way if way else np.nan
    largest = float(np.max(np.abs(y), initial=0.0, where=np.isfinite(y)))
    return 0.0 if abs(found) <= NOTHING * largest else found


@dataclass(frozen=True, eq=False)
class Panel:
    """One axes: the title of its vertical axis, and its curves."""

    title: Plotted
    curves: tuple[Plotted, ...]


@dataclass(frozen=True, eq=False)
class PlottedMotion:
    """A motion in a plot; its designs follow `before` others."""

    motion: Motion
    panels: tuple[Panel, ...]
    is_input: bool
    events: Events
    course: PlottedCurve
    before: int

    @property
    def x(self) -> Plotted:
        """The quantity of its horizontal axis."""
        return self.course.x

    @cached_property
    def extremes(self) -> Mapping[str, Mapping[int, tuple[PlottedExtreme, ...]]]:
        """The highest and lowest values of all curves, by name and design."""
        found = plotted_extremes(self.motion, self.x, [curve for panel in self.panels for curve in panel.curves])
        return {name: dict(enumerate(rows)) for name, rows in found.items()}

    @property
    def designs(self) -> int:
        """The number of its designs."""
        return len(self.x.values)


def motions_of_plot(
    motions: Sequence[Motion], names: Sequence[str], against: str | None, stacked: bool
) -> tuple[PlottedMotion, ...]:
    """Return the motions of a plot.

    Raises UnknownName for names that one of them does not have, InvalidInput where their units differ.
    """
    if not motions:
        raise InvalidInput(Problem("motion", "none is given", "give one or several, as solve() returns them"))
    found: list[PlottedMotion] = []
    designs = sum(motion.inputs.designs for motion in motions)
    chosen = names or [one.name for one in plotted_quantities(motions[0], ())]
    for motion in motions:
        x, is_input = horizontal_axis(motion, against)
        panels = arranged_panels(plotted_quantities(motion, chosen), designs, stacked)
        before = sum(one.designs for one in found)
        course = PlottedCurve.of(motion, x, [curve.name for panel in panels for curve in panel.curves])
        found.append(PlottedMotion(motion, panels, is_input, events(motion), course, before))
        _check_units(found[0], found[-1])
    return tuple(found)


def arranged_panels(shown: Sequence[Plotted], designs: int, stacked: bool) -> tuple[Panel, ...]:
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


def names_of_curves(motions: Sequence[Motion], given: Sequence[str]) -> tuple[str, ...]:
    """Return what the curves are called: as given, else by mechanism and design. Raises InvalidInput."""
    designs = sum(motion.inputs.designs for motion in motions)
    if given and len(given) != designs:
        what = f"there are {designs} designs and {len(given)} names"
        raise InvalidInput(Problem("designs", what, "give one for each, or leave them out"))
    if given or len(motions) == 1:
        return canvas.design_names(motions[0].shape, given)
    titles = [motion.mechanism.title for motion in motions]
    if len(set(titles)) < len(titles):
        titles = [f"{title} ({k})" for k, title in enumerate(titles, start=1)]
    pairs = zip(motions, titles, strict=True)
    return tuple(
        title if motion.inputs.designs == 1 else f"{title}, {name}"
        for motion, title in pairs
        for name in canvas.design_names(motion.shape, ())
    )


def _check_units(first: PlottedMotion, other: PlottedMotion) -> None:
    """Raise InvalidInput where another motion cannot be drawn in the panels of the first."""
    rows = [(first.x, other.x), *((a.title, b.title) for a, b in zip(first.panels, other.panels, strict=False))]
    for one, another in rows:
        if one.unit != another.unit:
            units = f"{one.unit or 'a number'} of one mechanism and {another.unit or 'a number'} of another"
            remedy = "give the mechanisms one unit of length, and draw quantities of one kind"
            raise InvalidInput(Problem(another.name, f"it would be in {units} on one axis", remedy))
    if len(first.panels) != len(other.panels):
        names = ", ".join(panel.title.name for panel in first.panels)
        raise InvalidInput(
            Problem(names, "they are vectors in one mechanism and numbers in another", "draw other ones")
        )


@dataclass(frozen=True)
class PlottedExtreme:
    """A highest or lowest value `y` of a curve, with its `x`."""

    x: float
    y: float
    is_highest: bool


def plotted_extremes(
    motion: Motion, x: Plotted, curves: Sequence[Plotted]
) -> dict[str, tuple[tuple[PlottedExtreme, ...], ...]]:
    """Return the highest and lowest values of curves by name, for each design. A constant has none.

    Rates that grow without limit towards a limit position have none there.
    """
    named = {curve.name: curve for curve in curves if not motion_figure(curve.name)[1]}
    found = {}
    for one in extremes(motion, *named):
        curve, rows = named[one.name], []
        both = tuple(_displayed_values(curve, side.value) for side in (one.greatest, one.least))
        at = tuple(axis_values_at(motion, x, side.at) for side in (one.greatest, one.least))
        for d, (high, low) in enumerate(zip(*both, strict=True)):
            size = max(curve.scale, abs(high), abs(low)) if np.isfinite([high, low]).all() else curve.scale
            level = high - low <= CONSTANT * size
            marks = (PlottedExtreme(float(at[k][d]), float(y), k == 0) for k, y in enumerate((high, low)))
            rows.append(() if level else tuple(mark for mark in marks if np.isfinite(mark.y)))
        found[one.name] = tuple(rows)
    return found


def axis_values_at(motion: Motion, x: Plotted, at: Places) -> Number:
    """Return the values of the horizontal axis at places; NaN at missing places."""
    if x.name == POSE:
        return at.place
    if x.name == TIME and motion.time is not None:
        return at.time
    if x.name in motion.drives:
        return _displayed_values(x, at.drives[x.name])
    known = np.isfinite(at.place)
    out = np.full(at.place.shape, np.nan)
    out[known] = plotted_values_at(motion, x, at.some(known))
    return out


def plotted_values_at(motion: Motion, curve: Plotted, at: Places) -> Number:
    """Return a plotted quantity at places, solved there."""
    with np.errstate(all="ignore"):
        there = between(motion, at.design, at.place, max(motion.order, derivative_order(curve.name)))
    return _displayed_values(curve, np.asarray(quantity(there, curve.name).values))


def _displayed_values(curve: Plotted, values: Number) -> Number:
    return np.asarray(degrees(values) if curve.is_angle else values)


@dataclass(frozen=True, eq=False)
class PlottedCurve:
    """The curves of a motion: smooth, as solved between poses, and through both sides of jumps."""

    motion: Motion
    x: Plotted
    more: CurvePlaces
    solved: Any

    @classmethod
    def of(cls, motion: Motion, x: Plotted, names: Sequence[str]) -> PlottedCurve:
        """Return the curves of a motion, solved between its poses for the named quantities."""
        more = CurvePlaces.of(motion)
        order = max([motion.order, *map(derivative_order, (*names, x.name))])
        with np.errstate(all="ignore"):
            return cls(motion, x, more, between(motion, more.at.design, more.at.place, order))

    def line(self, curve: Plotted, design: int) -> tuple[Number, Number]:
        """Return x and y of a curve. It goes as far as limit positions, unless it grows without limit there.

        A pose at a jump gives way to its two sides, which NaN parts, as it does what passes infinity.
        """
        x, y = self.x.values[design], curve.values[design]
        mine = self.more.at.design == design
        if curve.is_unbounded or self.x.is_unbounded:
            mine &= ~self.more.to_limits
        if not mine.any() or motion_figure(curve.name)[1]:
            return curve.parted(self.x, x, y)
        place, poses = self.more.at.place[mine], np.arange(len(x), dtype=float)
        kept = np.abs(poses[:, None] - place).min(axis=1) > SAME_PLACE
        order = np.argsort(np.concatenate([poses[kept], place]))
        new = (axis_values_at(self.motion, self.x, self.more.at.some(mine)), self._values(curve)[mine])
        across, up = (np.concatenate([row[kept], one])[order] for row, one in zip((x, y), new, strict=True))
        there = np.concatenate([poses[kept], place])[order]
        jumps = (np.diff(there) <= SAME_PLACE) & (np.abs(np.diff(up)) > JUMP * curve.scale)
        jumps |= _switches(curve, up)
        after = np.flatnonzero(jumps) + 1
        return curve.parted(self.x, np.insert(across, after, across[after]), np.insert(up, after, np.nan))

    def _values(self, curve: Plotted) -> Number:
        found = np.asarray(quantity(self.solved, curve.name).values)
        return np.broadcast_to(_displayed_values(curve, found).reshape(-1), self.more.at.place.shape)


# Loads that act one way only set in and end between two places: there a force changes by so many times more than
# before and after, and by this part of its range.
SUDDEN, LARGE = 20.0, 0.02


def _switches(curve: Plotted, up: Number) -> Number:
    """Return between which places a force is switched on or off, or changes flanks."""
    steps = np.nan_to_num(np.abs(np.diff(up)))
    word = curve.name.removesuffix(f".{LENGTH}").rpartition(".")[2]
    if word == FLANK:
        return steps > 0.0
    return switches(up) if curve.dimension in OF_FORCES else np.zeros(len(steps), dtype=bool)


def switches(values: Number) -> Number:
    """Return between which places the values of a force, real or vectors as complex numbers, change suddenly.

    >>> switches(np.array([0.0, 0.1, 0.2, 9.0, 9.1])).tolist()
    [False, False, True, False]
    """
    steps = np.nan_to_num(np.abs(np.diff(values)))
    if len(steps) < 3:
        return np.zeros(len(steps), dtype=bool)
    beside = np.maximum(np.append(steps[1:], steps[-2]), np.append(steps[1], steps[:-1]))
    known = values[np.isfinite(values)]
    extent = float(np.hypot(np.ptp(known.real), np.ptp(known.imag))) if len(known) else 0.0
    return (steps > SUDDEN * beside) & (steps > LARGE * extent)


# Curves of fewer poses than these are solved between them, so that they are smooth; many designs together no more often
# than so.
SMOOTH, MOST = 240, 20000
# Values of both sides of a place that differ by more than this part of the scale are a jump, and no line joins them.
JUMP = 1e-9
# So many places lead from the last pose to a limit position, towards which curves bend.
TO_LIMITS = 12


@dataclass(frozen=True, eq=False)
class CurvePlaces:
    """Places besides poses, in order. `to_limits` marks those between a pose and a limit position."""

    at: Places
    to_limits: Number

    @classmethod
    def of(cls, motion: Motion) -> CurvePlaces:
        """Return those of a motion."""
        s, jumps, poses = stretches_of(motion), places_of_jumps(motion), motion.inputs.poses
        beyond = ((s.first < 0) & s.limits[:, 0]) | ((s.last < 0) & s.limits[:, 1])
        parts = max(1, min(-(-SMOOTH // (poses - 1)), MOST // (motion.inputs.designs * poses)))
        inner = _inside(s, np.flatnonzero(~beyond), np.linspace(-1.0, 1.0, parts + 1)[1:-1])
        outer = _inside(s, np.flatnonzero(beyond), np.linspace(-1.0, 1.0, TO_LIMITS + 1))
        rows = np.concatenate([np.stack([jumps.design, jumps.place]), inner, outer], axis=1)
        to_limits = np.arange(rows.shape[1]) >= rows.shape[1] - outer.shape[1]
        order = np.lexsort((rows[1], rows[0]))
        return cls(Places(motion, rows[0, order].astype(int), rows[1, order]), to_limits[order])


def _inside(s: Stretches, which: Number, t: Number) -> Number:
    """Designs and places on stretches, (2, n), without the poses at their ends."""
    place = s.places(t, which)
    design = np.broadcast_to(s.design[which][:, None], place.shape)
    return np.stack([design, place])[:, place != np.rint(place)]
