"""Panels of quantities: their curves, the extremes and events on them, one panel for the same of several motions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from compoundkin.base.series import Number
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.axis_scales import AxisScales
from compoundkin.view.plot.marked_places import at
from compoundkin.view.plot.mean_lines import mean_lines
from compoundkin.view.plot.plotted_motions import PlottedMotion
from compoundkin.view.plot.plotted_rows import Plotted
from compoundkin.view.plot.point_labels import PointLabel, number
from compoundkin.view.plot.vertical_ranges import set_range

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
    """How the panel of a number is drawn: the same quantities of all motions. `extremes` tells whether to mark them."""

    motions: tuple[PlottedMotion, ...]
    number: int
    scales: AxisScales
    extremes: bool | None

    @property
    def title(self) -> Plotted:
        """What its vertical axis is called."""
        return self.motions[0].panels[self.number].title

    @property
    def across(self) -> Plotted:
        """What its horizontal axis is called: by all that motions run along."""
        names = dict.fromkeys(one.x.name for one in self.motions)
        return replace(self.motions[0].x, name=", ".join(names))

    @property
    def designs(self) -> int:
        """How many designs all motions have."""
        return sum(one.designs for one in self.motions)

    @property
    def curves(self) -> Sequence[Plotted]:
        """All curves, each of all designs of a motion."""
        return [curve for one in self.motions for curve in one.panels[self.number].curves]

    def lines(self) -> Iterator[DrawnCurve]:
        """Go through all curves and designs."""
        shades = shades_of(self.motions, len(self.curves))
        for one in self.motions:
            for k, curve in enumerate(one.panels[self.number].curves):
                for d in range(one.designs):
                    shade = shades[k if self.designs == 1 else one.before + d]
                    yield DrawnCurve(one, curve, d, one.course.line(curve, d), shade)

    def draw(self, axes: Any, labels: list[PointLabel]) -> None:
        """Draw the curves, their extremes, and rings beside limit positions."""
        drawn, found = list(self.lines()), list[PointLabel]()
        near = any(curve.has_poles for curve in self.curves)
        near = near or any(any(blank.limits) for one in self.motions for blank in one.happened.blanks)
        window = set_range(axes, self.curves, [one.line for one in drawn], self.scales, near)
        are_marked = self.extremes or (self.extremes is None and len(drawn) <= MOST_MARKED)
        for one in drawn:
            name = one.curve.name.removeprefix(f"{self.title.name}.")
            axes.plot(
                *one.line,
                color=one.colour,
                label=name if self.designs == 1 else f"_design {one.of.before + one.design}",
            )
            beside = one.of.happened.beside(one.design, one.of.x.values.shape[1])
            canvas.ring(axes, one.of.x.values[one.design][beside], one.curve.values[one.design][beside], one.colour)
            if are_marked and not one.curve.poles[one.design].any():
                self._mark(axes, one, window, found)
        if self.designs == 1:
            mean_lines(axes, self.motions[0].course, self.curves, [one.colour for one in drawn])
        # the outermost ones take their places first
        labels.extend(sorted(found, key=lambda label: -label.y * label.towards.imag))

    def _mark(self, axes: Any, one: DrawnCurve, window: tuple[float, float] | None, labels: list[PointLabel]) -> None:
        for mark in one.of.extremes.get(one.curve.name, {}).get(one.design, ()):
            if self.scales.shows(mark.x, mark.y) and (window is None or window[0] < mark.y < window[1]):
                canvas.dot(axes, mark.x, mark.y, one.colour)
                towards = 1j if mark.is_highest else -1j
                text = number(mark.y, one.curve.scale)
                labels.append(PointLabel(axes, mark.x, mark.y, text, towards, one.colour))

    def events(self, axes: Any) -> None:
        """Draw shades where nothing is assembled, and dashes at change points."""
        alone = self.designs == 1
        shades = [plot_style.SHADE] if alone else shades_of(self.motions, 1)
        for one in self.motions:
            for blank in one.happened.blanks if one.is_input else ():
                k, row = one.before + blank.design, one.x.values[blank.design]
                low, high = (0.0, 1.0) if alone else np.array([k, k + 1]) * STRIP / self.designs
                axes.axvspan(at(row, blank.begin), at(row, blank.end), low, high, color=shades[k], lw=0, zorder=0.5)
            for design, place in one.happened.changes:
                where = at(one.x.values[design], place)
                colour = plot_style.GREY if alone else shades[one.before + design]
                if np.isfinite(where) and self.scales.reaches(where):
                    axes.axvline(where, color=colour, linestyle="--", linewidth=1.0, zorder=1)


def shades_of(motions: Sequence[PlottedMotion], curves: int) -> Sequence[Any]:
    """Return the colours of curves. Several motions have those of several curves, designs go from dark to light."""
    designs = sum(one.designs for one in motions)
    if 1 < len(motions) == designs <= len(plot_style.COLOURS):
        return plot_style.colours(designs, 1)
    return plot_style.colours(curves, designs)


def across(axes: Any, motions: Sequence[PlottedMotion], scales: AxisScales) -> None:
    """Set the ends of the horizontal axis. They are as asked for, else those of what drives the motions."""
    values = np.concatenate([one.x.values.ravel() for one in motions])
    known = values[np.isfinite(values)]
    if scales.xlim is not None:
        axes.set_xlim(*scales.xlim)
    elif all(one.is_input for one in motions) and np.ptp(known) > 0:
        axes.set_xlim(known.min(), known.max())


def legends(figure: Any, axes: Sequence[Any], motions: Sequence[PlottedMotion], names: Sequence[str]) -> None:
    """Draw the legends of curves, motions and designs, and of events along them."""
    if len(names) > 1:
        canvas.designs_legend(figure, axes, names, shades_of(motions, 1), beside=len(motions) == 1)
    else:
        for one in axes:
            canvas.legend(one)
    blanks = [blank for one in motions for blank in one.happened.blanks]
    shaded = any(one.happened.blanks and one.is_input for one in motions)
    limits = any(any(blank.limits) for blank in blanks)
    canvas.events_legend(figure, shaded, limits, any(one.happened.changes for one in motions))
