"""Taking a mechanism apart. Driven links, then Assur groups in solving order, and what stands in the way.

Constraints are assigned to the unknowns they determine (a maximum matching); an unknown depends on the
other members of the constraints assigned to it; the strongly connected components of that dependency, in
order, are the groups. They are the fine blocks of Dulmage and Mendelsohn, whichever matching was found.
A matching alone can be fooled (s links may hold at most 3 s - 3 among themselves, loops of slides less than
they count), so each component is confirmed by the rank of its constraint Jacobian at a random generic pose.

Sources: A. L. Dulmage and N. S. Mendelsohn, Canad. J. Math. 10 (1958) 517; A. Sljoka, O. Shai and
W. Whiteley, Checking mobility and decomposition of linkages via pebble game algorithm, ASME DETC 2011.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidMechanism
from compoundkin.base.linear import one_thread
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure.assur_groups import Binder, all_pairs
from compoundkin.structure.composites import composites
from compoundkin.structure.faults import closed_drives, counted_faults, rank_faults
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.matching import (
    Matching,
    maximum_matching,
    overdetermined,
    solving_order,
    strong_components,
    underdetermined,
)
from compoundkin.structure.mobility_count import Fault, Group, Relaxation, mobility_of
from compoundkin.structure.rank import RankTest, Subsystem
from compoundkin.structure.system import System, system_of


@checked
@one_thread
def decompose(mechanism: Mechanism) -> Structure:
    """Take a mechanism apart into driven links and Assur groups in solving order.

    Nothing is raised for a mechanism that is over- or under-constrained: `faults` name the links, by how
    much, and a remedy. One that moves though it is overconstrained is taken apart as it is solved, without what is
    redundant, which `relaxation` names; that alone depends on dimensions. The work grows about linearly with the number
    of links.

    >>> from compoundkin.model.elements import drive, link
    >>> four_bar = Mechanism(
    ...     "Four-bar",
    ...     link("frame", A=(0, 0), D=(4, 0)),
    ...     link("crank", A=(0, 0), B=(1, 0)),
    ...     link("coupler", B=(0, 0), C=(3, 0)),
    ...     link("rocker", D=(0, 0), C=(3, 0)),
    ...     drive("crank"),
    ... )
    >>> [(group.name, group.links) for group in decompose(four_bar).groups]
    [('RRR', ('coupler', 'rocker'))]
    """
    with _without_collection():
        structure = decomposed(mechanism)
    if not any(fault.kind == "over" for fault in structure.faults):
        return structure
    if mechanism.unplaced:
        return replace(structure, faults=tuple(map(_at_general_dimensions, structure.faults)))
    # what looks at dimensions is loaded for those few that need it
    from compoundkin.structure.redundancy.diagnosis import without_redundancy

    return without_redundancy(structure, decomposed)


def _at_general_dimensions(fault: Fault) -> Fault:
    """Return a fault of a mechanism without dimensions, which say whether what is too much follows from the rest."""
    if fault.kind != "over":
        return fault
    return replace(fault, remedy=f"{fault.remedy}, or give dimensions at which it moves")


def without_leads(structure: Structure) -> Structure:
    """Return the structure of the mechanism itself, nothing led."""
    try:
        return (
            decompose(structure.mechanism.without_prescribed_motion())
            if structure.mechanism.prescribed_motions
            else structure
        )
    except InvalidMechanism:  # of links that nothing else joins
        return structure


@contextmanager
def _without_collection() -> Iterator[None]:
    """Pause Python's collector of cycles. Nothing here makes any, and at 100,000 links it takes a third of the time."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


def decomposed(mechanism: Mechanism, relaxation: Relaxation | None = None) -> Structure:
    """Take a mechanism apart whatever its dimensions, some parts of pairs left out."""
    dropped = relaxation.dropped if relaxation else ()
    bodies = composites(mechanism)
    system = system_of(mechanism, bodies, dropped)
    matching = maximum_matching(system.rows, system.freedoms)
    coarse = _Coarse(overdetermined(matching), underdetermined(matching))
    groups, faults = _groups(system, matching, coarse)
    faults = [*closed_drives(system), *counted_faults(system, matching, coarse.over, coarse.under), *faults]
    pairs = all_pairs(system, groups, [part.kept for part in dropped if part.kept is not None])
    mobility = mobility_of(mechanism, pairs, bodies.passive)
    found = tuple(groups), mobility, tuple(faults), bodies.passive
    return Structure(mechanism, pairs, bodies.ground, *found, relaxation)


@dataclass(frozen=True)
class _Coarse:
    """Which unknowns are overconstrained and which are left free. The others are well determined."""

    over: list[bool]
    under: list[bool]


def _groups(system: System, matching: Matching, coarse: _Coarse) -> tuple[list[Group], list[Fault]]:
    """Return the groups in solving order, and faults of components that only seem determined."""
    binder, test = Binder(system), RankTest(system)
    _locate_overdetermined(system, binder, coarse.over)
    groups: list[Group] = []
    faults: list[Fault] = []
    for part in _parts_in_order(system, matching, coarse):
        binder.locate(part.unknowns, part.constraints)
        if not system.is_body(part.unknowns[0]):
            continue
        found = test.deficiency(part)
        if found is None:
            groups.append(binder.group(part.unknowns, part.constraints))
        else:
            faults += rank_faults(system, part, found)
    return groups, faults


def _locate_overdetermined(system: System, binder: Binder, over: list[bool]) -> None:
    unknowns = [k for k, marked in enumerate(over) if marked]
    if unknowns:
        held = [c for c in system.constraints if c.unknowns and all(over[u] for u in c.unknowns)]
        binder.locate(unknowns, held)


def _parts_in_order(system: System, matching: Matching, coarse: _Coarse) -> list[Subsystem]:
    determined = [not (o or u) for o, u in zip(coarse.over, coarse.under, strict=True)]
    successors = [_depends_on(matching, u, determined) if yes else [] for u, yes in enumerate(determined)]
    components = [c for c in strong_components(successors) if determined[c[0]]]
    # a pin on its own is located the moment its body is
    rank = [c[0] if system.is_body(c[0]) else -1 for c in components]
    order = solving_order(components, successors, rank)
    return [_part(system, matching, components[k]) for k in order]


def _depends_on(matching: Matching, unknown: int, determined: Sequence[bool]) -> list[int]:
    members = [v for row in matching.owned[unknown] for v in matching.rows[row] if determined[v]]
    return [v for v in dict.fromkeys(members) if v != unknown]


def _part(system: System, matching: Matching, unknowns: Sequence[int]) -> Subsystem:
    numbers = sorted({system.constraint_of[row] for u in unknowns for row in matching.owned[u]})
    return Subsystem(tuple(unknowns), tuple([system.constraints[k] for k in numbers]))
