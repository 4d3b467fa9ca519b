"""`circuits`: all circuits and branches of a mechanism as curves over the driver."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import degrees
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.configurations.circuit import Branch, Circuit
from compoundkin.configurations.circuit_search import Circuits
from compoundkin.configurations.circuit_search import circuits as all_circuits
from compoundkin.model.attributes import ANGLE, DISPLACEMENT, VALUE, after_number, order_of
from compoundkin.model.elements import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import Group, Structure
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.branch_curves import DOT, START, BranchDrawing
from compoundkin.view.plot.branch_lines import shown
from compoundkin.view.plot.branch_positions import Positions, all_positions
from compoundkin.view.plot.plot_style import Plot
from compoundkin.view.plot.point_labels import PointLabel, number

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

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> picture = circuits(load_named("triple-rocker"), "rocker.angle")
    >>> [text.get_text() for text in picture.figure.legends[0].get_texts()]
    ['circuit 1, branch 1', 'circuit 1, branch 2']
    """
    plot_style.require_matplotlib()
    found = _found(what, driver, values, between, design)
    positions = all_positions(found)
    quantities = [one for name in names or _default(found) for one in shown(positions, name)]
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


def _found(
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
    found, unit = positions.found, positions.mechanism.unit
    parts = [positions.mechanism.title]
    for name, value in found.fixed.items():
        is_angle = positions.drives[name].is_angle
        at = number(float(degrees(value)) if is_angle else value)
        parts.append(f"{name} at {at}{after_number(is_angle, unit)}")
    return ", ".join(parts)


def _default(found: Circuits) -> tuple[str, ...]:
    """What is drawn where no quantity is named."""
    outputs = tuple(name for name in found.structure.mechanism.outputs if not order_of(name))
    if outputs:
        return outputs
    groups, solving_order = found.structure.groups, found.placing.sweep.solving_order
    several = [groups[k] for k, solver in enumerate(solving_order.solvers) if solver.modes != 1]
    return tuple(_of_group(group) for group in (several or groups)[:MOST_PANELS]) or (f"{found.driver}.{VALUE}",)


def _of_group(group: Group) -> str:
    """The angle of a link that is pinned to the frame, the displacement of one that slides on it; else any angle."""
    for pair in group.outer:
        if FRAME in pair.members and pair.is_simple:
            link = next(name for name in pair.members if name != FRAME)
            return f"{link}.{ANGLE}" if pair.free_is_angle else f"{pair.name}.{DISPLACEMENT}"
    return f"{group.links[0]}.{ANGLE}"


def _legends(drawn: BranchDrawing, figure: Any) -> None:
    """Which line is which branch, and what the marks mean."""
    from matplotlib.lines import Line2D

    handles = [Line2D([], [], **look, label=text) for text, look in _entries(drawn)]
    if len(handles) > 1:
        figure.legend(handles=handles, loc="outside right upper")
    marks = [Line2D([], [], label=textwrap.fill(text, WIDEST), **look) for text, look in _meanings(drawn)]
    if marks:
        figure.legend(handles=marks, loc="outside lower right", ncols=len(marks))


def _entries(drawn: BranchDrawing) -> list[tuple[str, dict[str, Any]]]:
    """The branches; of many of them the circuits, of many circuits that on which solving begins."""
    shown = drawn.found.circuits
    if len(drawn.found.branches) <= MOST_ENTRIES:
        return [(_called(c, (b,)), drawn.look(c, b)) for c in shown for b in c.branches]
    if not drawn.is_crowd:
        return [(_called(c, c.branches), drawn.look(c, c.branches[0])) for c in shown]
    own = [c for c in shown if c.number == drawn.own]
    entries = [(_called(c, c.branches), drawn.look(c, c.branches[0])) for c in own]
    others = next(c for c in shown if c.number != drawn.own)
    text = f"{len(shown) - len(own)} other circuits" if own else f"{len(shown)} circuits"
    return [*entries, (text, drawn.look(others, others.branches[0]))]


def _meanings(drawn: BranchDrawing) -> list[tuple[str, dict[str, Any]]]:
    found: list[tuple[str, dict[str, Any]]] = []
    if drawn.responsible:
        of = "" if drawn.are_named else f" of {', '.join(drawn.responsible)}"
        look = {"linestyle": "none", "marker": "o", "markersize": DOT, "color": plot_style.GREY}
        found.append((f"limit position{of}", look))
    if any(circuit.changes for circuit in drawn.found.circuits):
        found.append(("change point", {**canvas.RING, "color": plot_style.INK}))
    if drawn.found.start is not None:
        found.append(("where solving begins", {**START, "color": plot_style.INK}))
    return found


def _called(circuit: Circuit, branches: Sequence[Branch]) -> str:
    """What some branches of a circuit are called."""
    first, last = branches[0].number, branches[-1].number
    return f"circuit {circuit.number}, " + (f"branch {first}" if first == last else f"branches {first} to {last}")
