"""Panels on which every branch is a curve over the driver: colours and dashes, marks and legends."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from types import MappingProxyType
from typing import Any

import numpy as np

from compoundkin.base.arrays import degrees, turns_above
from compoundkin.base.series import Number
from compoundkin.configurations.circuit import Branch, Circuit
from compoundkin.configurations.circuit_search import Circuits
from compoundkin.kinematics.configuration import label
from compoundkin.model.attributes import DEGREES, unit_of
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.branch_lines import (
    OF_ANGLES,
    OF_DRIVERS,
    BranchCurve,
    curve_of,
    seam,
    shown,
    wrapped,
)
from compoundkin.view.plot.branch_positions import Positions, start_position
from compoundkin.view.plot.plotted_rows import TURN, Plotted
from compoundkin.view.plot.point_labels import PointLabel

# Branches of one circuit one after another, and again from the first.
DASHES: tuple[Any, ...] = ("-", (0, (5, 2)), (0, (5, 1.5, 1, 1.5)), (0, (1, 1.2)))
# The circuit on which solving begins is a wide line on which the others can be seen where they coincide.
OWN, OTHER, ALONE = 2.8, 1.3, 1.6
# A place nearer to the end of a turn than this (degrees) is there.
AT_END = 1e-6
# More limit positions than this in a panel, and the names beside them would be a crowd.
MOST_NAMED = 8
# Free space beside curves, and above and below them for names; parts of their range.
MARGIN, BESIDE, ROOM = 0.06, 0.16, 0.12
DOT = 5.5
START: Mapping[str, Any] = MappingProxyType({"linestyle": "none", "marker": "D", "markersize": 5.5})


@dataclass(frozen=True, eq=False)
class BranchDrawing:
    """What all panels share. The circuits, the horizontal axis, and where the one turn of a periodic driver begins."""

    positions: Positions
    across: Plotted
    low: float | None

    @classmethod
    def of(cls, positions: Positions, quantity: Plotted) -> BranchDrawing:
        """Return the drawing of circuits."""
        found = positions.found
        is_angle = positions.drives[found.driver].is_angle
        unit = DEGREES if is_angle else unit_of(found.structure.mechanism.unit, "length")
        curves = [curve_of(positions, branch, quantity).x for branch in found.branches]
        low = seam(curves, OF_DRIVERS) if found.period else None
        return cls(positions, Plotted(found.driver, unit, positions.values), low)

    @property
    def found(self) -> Circuits:
        """The circuits."""
        return self.positions.found

    @property
    def own(self) -> int:
        """The number of the circuit on which solving begins; 0 for none."""
        return 0 if self.found.start is None else self.found.start.circuit

    @property
    def responsible(self) -> tuple[str, ...]:
        """The groups that make limit positions."""
        return tuple(dict.fromkeys(label(self.found.structure, limit.group) for limit in self.found.limits))

    @property
    def are_named(self) -> bool:
        """Whether the group is written beside each limit position: several groups, and no crowd."""
        return len(self.responsible) > 1 and len(self.found.limits) <= MOST_NAMED

    @property
    def is_crowd(self) -> bool:
        """Whether there are more circuits than colours."""
        return len(self.found.circuits) > len(plot_style.COLOURS)

    def look(self, circuit: Circuit, branch: Branch) -> dict[str, Any]:
        """Return what the curve of a branch looks like."""
        own, k = circuit.number == self.own, circuit.branches.index(branch)
        width = ALONE if len(self.found.circuits) == 1 else OWN if own else OTHER
        look = {"color": self.colour(circuit), "linestyle": DASHES[k % len(DASHES)], "linewidth": width}
        # thin lines on the wide one, but for a crowd of grey ones
        return {**look, "zorder": 2.0 if own and not self.is_crowd else 2.5 + own, "dash_capstyle": "butt"}

    def colour(self, circuit: Circuit) -> str:
        """Return the colour of a circuit."""
        if self.is_crowd:
            # grey, but for the one on which solving begins
            return plot_style.COLOURS[0] if circuit.number == self.own else plot_style.FAINT
        return plot_style.COLOURS[circuit.number - 1]

    def panel(self, axes: Any, quantity: Plotted, labels: list[PointLabel]) -> None:
        """Draw all branches in one panel, their limit positions and change points."""
        branches = [(circuit, branch) for circuit in self.found.circuits for branch in circuit.branches]
        curves = [curve_of(self.positions, branch, quantity) for _, branch in branches]
        low = seam([curve.y for curve in curves], OF_ANGLES) if quantity.is_angle else None
        for (circuit, branch), curve in zip(branches, curves, strict=True):
            axes.plot(*self._cut(curve.x, curve.y, low), **self.look(circuit, branch))
            self._marks(axes, curve, low, self.colour(circuit))
        self._start(axes, quantity, low)
        self._frame(axes, curves, low, quantity)
        if self.are_named:
            labels += self._names(axes, curves, low)

    def _cut(self, x: Number, y: Number, low: float | None) -> tuple[Number, Number]:
        """A curve brought into one turn of what is an angle, both ways."""
        if self.low is not None:
            x, y = wrapped(x, y, self.low)
        return (x, y) if low is None else wrapped(y, x, low)[::-1]

    def _marked(
        self, axes: Any, curve: BranchCurve, at: Sequence[int], low: float | None, look: Mapping[str, Any]
    ) -> None:
        """Marks at places of a curve; one at an end of a turn is at its other end too."""
        if not at:
            return
        x, y = self._at(curve.x[list(at)], curve.y[list(at)], low)
        for one, other in product(self._again(x, self.low), self._again(y, low)):
            axes.plot(one, other, **look, zorder=5, clip_on=False)

    def _again(self, values: Number, low: float | None) -> list[Number]:
        """Values, and those at an end of a turn at its other end, NaN for the rest."""
        if low is None:
            return [values]
        up, down = values < low + AT_END, values > low + TURN - AT_END
        both = [(values, values == values), (values + TURN, up), (values - TURN, down)]
        return [np.where(known, v, np.nan) for v, known in both if np.any(known)]

    def _at(self, x: Number, y: Number, low: float | None) -> tuple[Number, Number]:
        """A place as it is shown."""
        x = x if self.low is None else x - turns_above(x, self.low, TURN)
        return x, (y if low is None else y - turns_above(y, low, TURN))

    def _marks(self, axes: Any, curve: BranchCurve, low: float | None, colour: str) -> None:
        dot = {"linestyle": "none", "marker": "o", "markersize": DOT, "color": colour}
        self._marked(axes, curve, [k for k, _ in curve.limits], low, dot)
        self._marked(axes, curve, curve.changes, low, {**canvas.RING, "color": plot_style.INK})

    def _names(self, axes: Any, curves: Sequence[BranchCurve], low: float | None) -> list[PointLabel]:
        """The groups responsible, each limit position once."""
        found: dict[int, PointLabel] = {}
        for curve in curves:
            for k, limit in curve.limits:
                x, y = self._at(curve.x[k], curve.y[k], low)
                text = label(self.found.structure, limit.group)
                one = PointLabel(axes, float(x), float(y), text, 1.0 if limit.greatest else -1.0, plot_style.INK)
                found.setdefault(id(limit), one)
        return list(found.values())

    def _start(self, axes: Any, quantity: Plotted, low: float | None) -> None:
        """A diamond where solving begins."""
        start = start_position(self.found)
        if start is not None:
            x = degrees(start.values) if self.across.is_angle else start.values
            y = next(one for one in shown(start, quantity.name) if one.name == quantity.name).values
            at = self._at(np.ravel(x), np.ravel(y), low)
            axes.plot(*at, **START, color=plot_style.INK, zorder=6, clip_on=False)

    def _frame(self, axes: Any, curves: Sequence[BranchCurve], low: float | None, quantity: Plotted) -> None:
        """The ranges of both axes: a whole turn where a curve is cut at its ends."""
        if self.low is not None and any(np.ptp(turns_above(curve.x, self.low, TURN)) for curve in curves):
            axes.set_xlim(self.low, self.low + TURN)
        else:
            axes.margins(x=BESIDE if self.are_named else MARGIN)
        still = canvas.steady(np.concatenate([curve.y for curve in curves]), quantity.scale)
        if low is not None and any(np.ptp(turns_above(curve.y, low, TURN)) for curve in curves):
            axes.set_ylim(low, low + TURN)
        elif still is not None:
            axes.set_ylim(*still)
        else:
            axes.margins(y=ROOM)
