"""Axes as they are asked for: their ends in the units that are shown, and which of them are logarithmic."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.model.attributes import readable
from compoundkin.view.plot.plotted_rows import Plotted
from compoundkin.view.plot.point_labels import number

# What may be logarithmic, and what a logarithmic axis has ticks at, parts of a power of ten.
LOG, SUBS = ("x", "y", "xy"), (1.0, 2.0, 5.0)
# From how many times its lower end on an axis has ticks at powers of ten only, and about at how many.
FEW, DECADES = 500.0, 8
# What is below this part of a quantity's size is zero but for rounding.
ROUNDING = 1e-12


@dataclass(frozen=True)
class AxisScales:
    """The ends of both axes, and which are logarithmic. An end is None where it follows from the curves."""

    xlim: tuple[float, float] | None = None
    ylim: tuple[float, float] | None = None
    log: str = ""

    @classmethod
    def asked(cls, xlim: tuple[float, float] | None, ylim: tuple[float, float] | None, log: str | None) -> AxisScales:
        """Return the axes that are asked for. Raises InvalidInput for ends or words that are none."""
        if log is not None and log not in LOG:
            raise InvalidInput(Problem("log", f"{log!r} is no axis", 'write "x", "y" or "xy"'))
        for name, ends in (("x", xlim), ("y", ylim)):
            if ends is None:
                continue
            if not (np.isfinite(ends).all() and ends[0] < ends[1]):
                told = f"from {ends[0]:g} to {ends[1]:g} is no range"
                raise InvalidInput(Problem(f"{name}lim", told, "give the lower end and the upper one"))
            if name in (log or "") and ends[0] <= 0.0:
                told = f"it begins at {ends[0]:g}, and the axis is logarithmic"
                raise InvalidInput(Problem(f"{name}lim", told, "begin above zero"))
        return cls(xlim, ylim, log or "")

    def hold(self, across: Sequence[Plotted], titles: Sequence[Plotted], curves: Iterable[Plotted]) -> None:
        """Raise InvalidInput where limits or scales do not fit.

        They do not where limits are meant for several units, or an axis cannot be logarithmic.
        """
        units = list(dict.fromkeys(readable(one.unit) or "numbers" for one in titles))
        if self.ylim is not None and len(units) > 1:
            told = f"the panels are in {', '.join(units)}"
            raise InvalidInput(Problem("ylim", told, "draw quantities of one unit, or leave it out"))
        values = np.concatenate([one.values.ravel() for one in across])
        if self.xlim is not None and not np.any((values >= self.xlim[0]) & (values <= self.xlim[1])):
            told = f"{across[0].name} goes from {number(np.nanmin(values))} to {number(np.nanmax(values))}"
            raise InvalidInput(Problem("xlim", f"no pose is between {self.xlim[0]:g} and {self.xlim[1]:g}", told))
        for name, rows in (("x", across), ("y", curves)):
            for one in rows if name in self.log else ():
                _hold_positive(one)

    def visible(self, x: Number, y: Number) -> Number:
        """Return the values of a curve that are within the horizontal limits."""
        return y if self.xlim is None else y[(x >= self.xlim[0]) & (x <= self.xlim[1])]

    def drawable(self, values: Number, scale: float) -> Number:
        """Return the values that a vertical axis can show. A logarithmic one shows what is not nothing."""
        return values[values > ROUNDING * scale] if "y" in self.log else values

    def shows(self, x: float, y: float) -> bool:
        """Tell whether a place of a curve is within the limits."""
        return self.reaches(x) and (self.ylim is None or self.ylim[0] <= y <= self.ylim[1])

    def reaches(self, x: float) -> bool:
        """Tell whether a place of the horizontal axis is within its limits."""
        return self.xlim is None or self.xlim[0] <= x <= self.xlim[1]

    def make_log(self, axes: Any) -> None:
        """Make axes logarithmic."""
        for name in self.log:
            axes.set(**{f"{name}scale": "log"})

    def ticks(self, axes: Any) -> None:
        """Put plain numbers at the ticks of logarithmic axes."""
        from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

        for name in self.log:
            axis = axes.xaxis if name == "x" else axes.yaxis
            low, high = axis.get_view_interval()
            axis.set_major_locator(LogLocator(subs=SUBS) if high < FEW * low else LogLocator(numticks=DECADES))
            axis.set_major_formatter(FuncFormatter(lambda value, _: number(value)))
            axis.set_minor_formatter(NullFormatter())


def _hold_positive(one: Plotted) -> None:
    known = one.values[np.isfinite(one.values)]
    if len(known) and known.min() <= ROUNDING * one.scale:
        low, high = (number(float(end), one.scale) for end in (known.min(), known.max()))
        told = f"{one.name} goes from {low} to {high}, and a logarithmic axis has positive values only"
        remedy = "leave it out, or draw what is positive, such as a length"
        raise InvalidInput(Problem("log", told, remedy))
