"""`circuits`: every branch of every circuit of a mechanism as a curve over the driver.

Branches are solved from end to end of each segment, whose ends are the limit positions themselves.
"""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from types import MappingProxyType
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import TURN as FULL
from compoundkin.base.arrays import Number, degrees, turns_above, unwrapped
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import Pose
from compoundkin.configurations.circuit import Branch, Circuit, Limit
from compoundkin.configurations.circuit_search import Circuits
from compoundkin.configurations.circuit_search import circuits as all_circuits
from compoundkin.configurations.segments import CHANGE, NONE
from compoundkin.kinematics.configuration import dimensions_at, label
from compoundkin.kinematics.driver_values import Inputs, PoseGrid
from compoundkin.kinematics.quantities import quantity, whole_and_part
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.attributes import (
    ALIASES,
    ANGLE,
    DEGREES,
    DISPLACEMENT,
    VALUE,
    derivative_order,
    unit_of,
    unit_suffix,
    vector_and_part,
)
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.contract import Ends, Poses
from compoundkin.structure import Group, Structure
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.canvas import PointLabel, value_text
from compoundkin.view.plot.plot_style import Plot
from compoundkin.view.plot.plotted_rows import TURN, Plotted

# So many groups have a panel where no quantity is named.
MOST_PANELS = 3
# A legend of more entries than this is one of circuits, and then of that one circuit only.
MOST_ENTRIES = 12
# Characters in a line of the legend below.
WIDEST = 50
# Inches: room for the names of branches beside the panels.
WIDTH, FIRST, EACH = 8.4, 1.4, 2.8


@checked
def circuits(
    what: Mechanism | Structure | Circuits,
    *names: str,
    driver: str | None = None,
    values: Mapping[str, Any] | None = None,
    between: Sequence[float] | None = None,
    design: int = 0,
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw every branch of every circuit as a curve over the driver's whole range. The input-output curve.

    `names` are positions as `quantity` takes them ("rocker.angle", "G.x", "slot.displacement"; "G" is both its
    coordinates), a panel each. Without any they are those that the mechanism states as its outputs; else, of up to
    three groups that have several configurations, the coordinate of a pair to the frame, or the angle of the first
    link: in these the branches differ. `driver`, `values`, `between` and `design` as `compoundkin.circuits` takes them.

    A circuit has a colour, its branches differ in their dashes; the circuit on which solving begins is wide, and a
    diamond is where it does. Dots are limit positions with the group responsible: there two branches meet. Rings are
    change points. Angles are in degrees and within one turn. `size` is in inches.

    Raises UnknownName for names that the mechanism does not have, InvalidInput for rates, and what `circuits` raises.
    Source: T. R. Chase and J. A. Mirth, Circuits and branches of single-degree-of-freedom planar linkages, Journal of
    Mechanical Design 115 (1993).

    >>> from compoundkin.files import load
    >>> picture = circuits(load("triple-rocker"), "rocker.angle")
    >>> [text.get_text() for text in picture.figure.legends[0].get_texts()]
    ['circuit 1, branch 1', 'circuit 1, branch 2']
    """
    plot_style.require_matplotlib()
    found = _circuits_of(what, driver, values, between, design)
    positions = segment_positions(found)
    quantities = [one for name in names or _default(found) for one in segment_quantity(positions, name)]
    quantities = quantities if names else quantities[:MOST_PANELS]
    drawn = BranchDrawing.of(positions, quantities[0])
    with plot_style.styled():
        text = _title(positions) if title is None else title
        wide = size or (WIDTH, FIRST + EACH * len(quantities))
        figure, axes = canvas.panels(len(quantities), text, wide, sharex=True)
        labels: list[PointLabel] = []
        for one, quantity in zip(axes, quantities, strict=True):
            drawn.panel(one, quantity, labels)
            canvas.axis_labels(one, drawn.across if one is axes[-1] else None, quantity, canvas.PANEL)
        _legends(drawn, figure)
        return canvas.finished(figure, labels)


def _circuits_of(
    what: Mechanism | Structure | Circuits,
    driver: str | None,
    values: Mapping[str, Any] | None,
    between: Sequence[float] | None,
    design: int,
) -> Circuits:
    """The circuits given, or those of a mechanism."""
    if not isinstance(what, Circuits):
        return all_circuits(what, driver, values, between=between, design=design)
    given = {"driver": driver is not None, "values": bool(values), "between": between is not None, "design": design}
    for option in (option for option, is_given in given.items() if is_given):
        raise InvalidInput(Problem(option, "the circuits are found already", "give it to circuits(mechanism, ...)"))
    return what


def _title(positions: Positions) -> str:
    """The mechanism's title, and where the other drivers stand."""
    found, unit = positions.circuits, positions.mechanism.unit
    parts = [positions.mechanism.title]
    for name, value in found.fixed.items():
        is_angle = positions.drives[name].is_angle
        at = value_text(float(degrees(value)) if is_angle else value)
        parts.append(f"{name} at {at}{unit_suffix(is_angle, unit)}")
    return ", ".join(parts)


def _default(found: Circuits) -> tuple[str, ...]:
    """The quantities that are drawn by default."""
    outputs = tuple(name for name in found.structure.mechanism.outputs if not derivative_order(name))
    if outputs:
        return outputs
    groups, solving_order = found.structure.groups, found.placing.sweep.solving_order
    several = [groups[k] for k, solver in enumerate(solving_order.solvers) if solver.modes != 1]
    return tuple(_group_output(group) for group in (several or groups)[:MOST_PANELS]) or (f"{found.driver}.{VALUE}",)


def _group_output(group: Group) -> str:
    """The angle of a link that is pinned to the frame, the displacement of one that slides on it; else any angle."""
    for pair in group.outer:
        if FRAME in pair.members and pair.is_simple:
            link = next(name for name in pair.members if name != FRAME)
            return f"{link}.{ANGLE}" if pair.free_is_angle else f"{pair.name}.{DISPLACEMENT}"
    return f"{group.links[0]}.{ANGLE}"


def _legends(drawn: BranchDrawing, figure: Any) -> None:
    """Draw the legends of branches and of marks."""
    from matplotlib.lines import Line2D

    handles = [Line2D([], [], **look, label=text) for text, look in _entries(drawn)]
    if len(handles) > 1:
        figure.legend(handles=handles, loc="outside right upper")
    marks = [Line2D([], [], label=textwrap.fill(text, WIDEST), **look) for text, look in _meanings(drawn)]
    if marks:
        figure.legend(handles=marks, loc="outside lower right", ncols=len(marks))


def _entries(drawn: BranchDrawing) -> list[tuple[str, dict[str, Any]]]:
    """The entries of the legend: branches; of many the circuits; of many of these the one where solving begins."""
    shown = drawn.circuits.circuits
    if len(drawn.circuits.branches) <= MOST_ENTRIES:
        return [(_branch_names(c, (b,)), drawn.look(c, b)) for c in shown for b in c.branches]
    if not drawn.is_crowd:
        return [(_branch_names(c, c.branches), drawn.look(c, c.branches[0])) for c in shown]
    own = [c for c in shown if c.number == drawn.own]
    entries = [(_branch_names(c, c.branches), drawn.look(c, c.branches[0])) for c in own]
    others = next(c for c in shown if c.number != drawn.own)
    text = f"{len(shown) - len(own)} other circuits" if own else f"{len(shown)} circuits"
    return [*entries, (text, drawn.look(others, others.branches[0]))]


def _meanings(drawn: BranchDrawing) -> list[tuple[str, dict[str, Any]]]:
    found: list[tuple[str, dict[str, Any]]] = []
    if drawn.responsible:
        of = "" if drawn.are_named else f" of {', '.join(drawn.responsible)}"
        look = {"linestyle": "none", "marker": "o", "markersize": DOT, "color": plot_style.GREY}
        found.append((f"limit position{of}", look))
    if any(circuit.changes for circuit in drawn.circuits.circuits):
        found.append(("change point", {**canvas.RING, "color": plot_style.INK}))
    if drawn.circuits.start is not None:
        found.append(("where solving begins", {**START, "color": plot_style.INK}))
    return found


def _branch_names(circuit: Circuit, branches: Sequence[Branch]) -> str:
    """The name of some branches of a circuit."""
    first, last = branches[0].number, branches[-1].number
    return f"circuit {circuit.number}, " + (f"branch {first}" if first == last else f"branches {first} to {last}")


# Branches of one circuit one after another, and again from the first.
DASHES: tuple[Any, ...] = ("-", (0, (5, 2)), (0, (5, 1.5, 1, 1.5)), (0, (1, 1.2)))
# The circuit on which solving begins is a wide line on which the others can be seen where they coincide.
OWN, OTHER, ALONE = 2.8, 1.3, 1.6
# A place nearer to the end of a turn than this (degrees) is there.
AT_END = 1e-6
# More limit positions than this in a panel, and the names beside them would be a crowd.
MOST_NAMED = 8
# Free space beside curves, and above and below them for names; parts of their range.
BRANCH_MARGIN, BESIDE, NAME_MARGIN = 0.06, 0.16, 0.12
DOT = 5.5
START: Mapping[str, Any] = MappingProxyType({"linestyle": "none", "marker": "D", "markersize": 5.5})


@dataclass(frozen=True, eq=False)
class BranchDrawing:
    """The data of all panels: circuits, the horizontal axis, and where the turn of a periodic driver begins."""

    positions: Positions
    across: Plotted
    low: float | None

    @classmethod
    def of(cls, positions: Positions, quantity: Plotted) -> BranchDrawing:
        """Return the drawing of circuits."""
        found = positions.circuits
        is_angle = positions.drives[found.driver].is_angle
        unit = DEGREES if is_angle else unit_of(found.structure.mechanism.unit, "length")
        curves = [branch_curve(positions, branch, quantity).x for branch in found.branches]
        low = turn_seam(curves, OF_DRIVERS) if found.period else None
        return cls(positions, Plotted(found.driver, unit, positions.values), low)

    @property
    def circuits(self) -> Circuits:
        """The circuits."""
        return self.positions.circuits

    @property
    def own(self) -> int:
        """The number of the circuit on which solving begins; 0 for none."""
        return 0 if self.circuits.start is None else self.circuits.start.circuit

    @property
    def responsible(self) -> tuple[str, ...]:
        """The groups that make limit positions."""
        return tuple(dict.fromkeys(label(self.circuits.structure, limit.group) for limit in self.circuits.limits))

    @property
    def are_named(self) -> bool:
        """Whether the group is written beside each limit position: several groups, and no crowd."""
        return len(self.responsible) > 1 and len(self.circuits.limits) <= MOST_NAMED

    @property
    def is_crowd(self) -> bool:
        """Whether there are more circuits than colours."""
        return len(self.circuits.circuits) > len(plot_style.COLOURS)

    def look(self, circuit: Circuit, branch: Branch) -> dict[str, Any]:
        """Return what the curve of a branch looks like."""
        own, k = circuit.number == self.own, circuit.branches.index(branch)
        width = ALONE if len(self.circuits.circuits) == 1 else OWN if own else OTHER
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
        branches = [(circuit, branch) for circuit in self.circuits.circuits for branch in circuit.branches]
        curves = [branch_curve(self.positions, branch, quantity) for _, branch in branches]
        low = turn_seam([curve.y for curve in curves], OF_ANGLES) if quantity.is_angle else None
        for (circuit, branch), curve in zip(branches, curves, strict=True):
            axes.plot(*self._cut(curve.x, curve.y, low), **self.look(circuit, branch))
            self._marks(axes, curve, low, self.colour(circuit))
        self._start(axes, quantity, low)
        self._frame(axes, curves, low, quantity)
        if self.are_named:
            labels += self._names(axes, curves, low)

    def _cut(self, x: Number, y: Number, low: float | None) -> tuple[Number, Number]:
        """A curve with its angles in one turn, along both axes."""
        if self.low is not None:
            x, y = wrapped_curve(x, y, self.low)
        return (x, y) if low is None else wrapped_curve(y, x, low)[::-1]

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
        """A place within the turns that are shown."""
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
                text = label(self.circuits.structure, limit.group)
                one = PointLabel(axes, float(x), float(y), text, 1.0 if limit.greatest else -1.0, plot_style.INK)
                found.setdefault(id(limit), one)
        return list(found.values())

    def _start(self, axes: Any, quantity: Plotted, low: float | None) -> None:
        """A diamond where solving begins."""
        start = start_position(self.circuits)
        if start is not None:
            x = degrees(start.values) if self.across.is_angle else start.values
            y = next(one for one in segment_quantity(start, quantity.name) if one.name == quantity.name).values
            at = self._at(np.ravel(x), np.ravel(y), low)
            axes.plot(*at, **START, color=plot_style.INK, zorder=6, clip_on=False)

    def _frame(self, axes: Any, curves: Sequence[BranchCurve], low: float | None, quantity: Plotted) -> None:
        """The ranges of both axes: a whole turn where a curve is cut at its ends."""
        if self.low is not None and any(np.ptp(turns_above(curve.x, self.low, TURN)) for curve in curves):
            axes.set_xlim(self.low, self.low + TURN)
        else:
            axes.margins(x=BESIDE if self.are_named else BRANCH_MARGIN)
        if low is not None and any(np.ptp(turns_above(curve.y, low, TURN)) for curve in curves):
            axes.set_ylim(low, low + TURN)
        else:
            values = np.concatenate([curve.y for curve in curves])
            canvas.set_vertical_margins(axes, values, quantity.scale, NAME_MARGIN)


# Where the one turn begins in which angles are shown, degrees; of equally good ones the first is taken.
OF_DRIVERS, OF_ANGLES = (0.0, -180.0), (-180.0, 0.0, -90.0)


def segment_quantity(positions: Positions, name: str) -> tuple[Plotted, ...]:
    """Return a quantity by its name, (segments, places), angles in degrees. A point as its coordinates.

    Raises UnknownName with the nearest name there is, InvalidInput for rates.
    """
    vector, _ = vector_and_part(name)
    if derivative_order(vector):
        owner = vector.rpartition(".")[0]
        what = quantity(positions, owner)
        position = "x" if what.is_vector else next(iter(ALIASES[what.dimension]))
        remedy = f"take {owner}.{position}, or plot a motion: solve() it"
        raise InvalidInput(Problem(name, "circuits show positions, not rates", remedy))
    found, part = whole_and_part(positions, name)
    # angles go on from place to place, without leaps by a turn
    values = unwrapped(found.values) if found.is_angle else found.values
    one = Plotted(**vars(replace(found, values=values).shown))
    if part:
        return (one.part(part),)
    return (one.part("x"), one.part("y")) if one.is_vector else (one,)


@dataclass(frozen=True, eq=False)
class BranchCurve:
    """A quantity along a branch, in the order of its circuit. The driver `x`, the quantity `y`, and special places.

    `limits` are the indices of its ends that are limit positions, with these; `changes` those of change points.
    """

    branch: Branch
    x: Number
    y: Number
    limits: tuple[tuple[int, Limit], ...]
    changes: tuple[int, ...]


def branch_curve(positions: Positions, branch: Branch, one: Plotted) -> BranchCurve:
    """Return the curve of a branch."""
    found, visits = positions.circuits, branch.visits
    x = np.concatenate([positions.values[v.row][:: v.sense] + v.periods * found.period for v in visits])
    y = np.concatenate([one.values[v.row][:: v.sense] for v in visits])
    ends = branch.ends if visits[0].sense > 0 else branch.ends[::-1]
    limits = tuple((k, end) for k, end in zip((0, len(x) - 1), ends, strict=True) if end is not None)
    kinds = found.placing.segments.kind
    count = positions.values.shape[1]
    changes = tuple(count * (i + 1) - 1 for i, v in enumerate(visits) if kinds[v.row, v.left] == CHANGE)
    driver = degrees(x) if positions.drives[found.driver].is_angle else x
    return BranchCurve(branch, driver, np.rad2deg(unwrapped(np.deg2rad(y))) if one.is_angle else y, limits, changes)


def turn_seam(curves: Sequence[Number], candidates: Sequence[float]) -> float:
    """Return the angle, of some, at which the fewest of several curves are cut. Of those, where they take least room.

    >>> turn_seam([np.array([-80.0, 80.0])], (0.0, -180.0))
    -180.0
    """

    def room(low: float) -> tuple[int, float]:
        inside = np.concatenate([curve - turns_above(curve, low, TURN) for curve in curves])
        span = np.ptp(inside[np.isfinite(inside)]) if np.isfinite(inside).any() else 0.0
        # in steps of degrees, so that rounding does not decide
        return sum(len(_cuts(turns_above(curve, low, TURN))) for curve in curves), round(float(span))

    return min(candidates, key=room)


def wrapped_curve(first: Number, second: Number, low: float) -> tuple[Number, Number]:
    """Return a curve, its first coordinate brought into the turn from `low`. It is NaN where it is cut.

    >>> [part.tolist() for part in wrapped_curve(np.array([350.0, 370.0]), np.array([0.0, 1.0]), 0.0)]
    [[350.0, 360.0, nan, 0.0, 10.0], [0.0, 0.5, nan, 0.5, 1.0]]
    """
    away = turns_above(first, low, TURN)
    k = _cuts(away)
    border = low + np.maximum(away[k], away[k + 1])
    share = (border - first[k]) / (first[k + 1] - first[k])
    between = second[k] + share * (second[k + 1] - second[k])
    where, blank = np.repeat(k + 1, 3), np.full(len(k), np.nan)
    crossed = np.stack([border - away[k], blank, border - away[k + 1]], axis=1).ravel()
    return np.insert(first - away, where, crossed), np.insert(
        second, where, np.stack([between, blank, between], 1).ravel()
    )


def _cuts(away: Number) -> Number:
    """The places after which a curve goes into another turn."""
    return np.flatnonzero(np.isfinite(away[1:] - away[:-1]) & (away[1:] != away[:-1]))


# Places on a segment for a turn of the driver's period: equal steps on a half circle whose diameter is the segment's
# interval, so that they lie close where curves are steep.
PLACES = 360


@dataclass(frozen=True, eq=False)
class _CoordinateValues:
    """A coordinate at all places."""

    values: Number
    is_angle: bool = True

    def derivative(self, _: int) -> Number:
        """Return the coordinate itself: there are no others."""
        return self.values


class _PointCoordinates(_CoordinateValues):
    """A point at all places."""

    @property
    def x(self) -> Number:
        """The first coordinate."""
        return np.real(self.values)

    @property
    def y(self) -> Number:
        """The second coordinate."""
        return np.imag(self.values)


@dataclass(frozen=True, eq=False)
class Positions:
    """The positions on all segments: `values` of the driver (rows, places), and the poses of the links there."""

    circuits: Circuits
    values: Number
    world: Mapping[str, Pose]

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism."""
        return self.circuits.structure.mechanism

    @property
    def solving_order(self) -> SolvingOrder:
        """The order in which its groups are solved."""
        return self.circuits.placing.sweep.solving_order

    @property
    def inputs(self) -> Inputs:
        """The dimensions."""
        return Inputs(self.values.shape, self.circuits.placing.sweep.ends, {})

    @property
    def poses(self) -> Mapping[str, Pose]:
        """The poses of the links."""
        return self.world

    @property
    def grid(self) -> PoseGrid:
        """How its numbers are shown: there are no derivatives."""
        return PoseGrid(self.values.shape, 0, np.zeros(self.values.shape, dtype=int))

    @property
    def regular(self) -> Number:
        """Which poses have finite rates: circuits show none."""
        return np.ones(self.values.shape, dtype=bool)

    @cached_property
    def points(self) -> Mapping[str, _PointCoordinates]:
        """The points."""
        dimensions = dimensions_at(self.circuits.structure, self.circuits.placing.design, 0)
        places = {letter: (links[0], dimensions[links[0]][letter]) for letter, links in self.mechanism.carriers.items()}
        return {
            letter: _PointCoordinates(self._full(self.world[link].at(p).c[0])) for letter, (link, p) in places.items()
        }

    @cached_property
    def links(self) -> Mapping[str, _CoordinateValues]:
        """The angles of the links."""
        return {name: _CoordinateValues(self._full(self.world[name].angle.c[0])) for name in self.mechanism.links}

    @cached_property
    def pairs(self) -> Mapping[str, _CoordinateValues]:
        """The coordinates of the pairs."""
        sweep = self.circuits.placing.sweep
        found = {}
        for name, pair in sweep.solving_order.pairs.items():
            ends: Ends = sweep.ends[name]
            poses: Poses = tuple(self.world[member] for member in pair.members)
            with np.errstate(all="ignore"):
                found[name] = _CoordinateValues(self._full(pair.coordinate(ends, poses).c[0]), pair.free_is_angle)
        return found

    @cached_property
    def drives(self) -> Mapping[str, _CoordinateValues]:
        """The values of the drivers."""
        sweep = self.circuits.placing.sweep
        values = {**sweep.fixed, sweep.driver: self.values}
        driven = self.circuits.structure.driven.items()
        return {name: _CoordinateValues(self._full(values[name]), step.pair.free_is_angle) for name, step in driven}

    def _full(self, value: Number) -> Number:
        return np.broadcast_to(value, self.values.shape)


def segment_positions(found: Circuits) -> Positions:
    """Return every segment from end to end."""
    segments = found.placing.segments
    count = PLACES * max(1, round(found.period / FULL)) + 1
    rows, phi = np.arange(segments.rows), np.linspace(0.0, np.pi, count)
    sides = np.full(count, NONE)
    sides[0], sides[-1] = 0, 1
    return _positions(found, rows, segments.at(rows, phi[None]), sides)


def start_position(found: Circuits) -> Positions | None:
    """Return where solving begins; None where nothing is assembled there."""
    if found.start is None:
        return None
    return _positions(found, np.array([found.start.visit.row]), np.array([[found.start.inside]]), np.array([NONE]))


def _positions(found: Circuits, rows: Number, values: Number, sides: Number) -> Positions:
    with np.errstate(all="ignore"):
        run = found.placing.sweep.run(found.placing.segments, rows, values, sides=sides)
    return Positions(found, values, run.world)
