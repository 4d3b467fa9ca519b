"""`circuits`: all circuits and branches of a mechanism as curves over the driver."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.configurations.circuit_search import Circuits
from compoundkin.configurations.circuit_search import circuits as all_circuits
from compoundkin.kinematics.quantities import degrees
from compoundkin.model.attributes import ANGLE, DISPLACEMENT, VALUE, after_number, order_of
from compoundkin.model.elements import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import Group, Structure
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.branch_curves import BranchDrawing
from compoundkin.view.plot.branch_lines import Positions, all_positions, shown
from compoundkin.view.plot.plot_picture import Plot
from compoundkin.view.plot.point_labels import PointLabel, number

# So many groups have a panel where no quantity is named.
MOST_PANELS = 3
# Inches: room for the names of branches beside the panels.
WIDTH, FIRST, EACH = 8.4, 1.4, 2.8


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
    """Draw every branch of every circuit as a curve over the driver's whole range: the input-output curve.

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
        drawn.legends(figure)
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
        if not isinstance(what, Mechanism | Structure):
            raise InvalidInput(Problem("circuits", f"{what!r} is no mechanism", "load() one from a file"))
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
    groups, plan = found.structure.groups, found.placing.sweep.plan
    several = [groups[k] for k, solver in enumerate(plan.solvers) if solver.modes != 1]
    return tuple(_of_group(group) for group in (several or groups)[:MOST_PANELS]) or (f"{found.driver}.{VALUE}",)


def _of_group(group: Group) -> str:
    """The angle of a link that is pinned to the frame, the displacement of one that slides on it; else any angle."""
    for pair in group.outer:
        if FRAME in pair.members and pair.is_simple:
            link = next(name for name in pair.members if name != FRAME)
            return f"{link}.{ANGLE}" if pair.free_is_angle else f"{pair.name}.{DISPLACEMENT}"
    return f"{group.links[0]}.{ANGLE}"
