"""Solving what moves though it is overconstrained: a structure in which nothing is held twice.

What is left out is checked along the whole motion. It is chosen so that what remains falls into groups with closed
forms where it can.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from compoundkin.structure.decomposition import decomposed
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.parts import Group, Relaxation
from compoundkin.structure.redundancy.diagnosis import WIDEST, Examined, examined
from compoundkin.structure.redundancy.self_stress import Candidate, chosen, strength

# How many structures are compared, and by how much weaker than the first choice others may be.
COMPARED = 400
WEAKER = 0.1
# A group without a closed form takes so many times as long as a dyad, and more with the number of its bodies.
GENERAL = 10


def without_redundancy(structure: Structure, closed: Collection[str]) -> Structure:
    """Return the structure without what is redundant, where its mechanism moves although it is overconstrained.

    The structure itself where nothing is overconstrained, or nothing moves. `closed` are the names of the groups that
    have closed forms: what remains falls into these where it can.
    """
    mechanism = structure.mechanism
    if not any(fault.kind == "over" for fault in structure.faults) or 3 * len(mechanism.links) > WIDEST:
        return structure
    with np.errstate(all="ignore"):
        found = examined(mechanism)
        if not found.assembly.is_closed or found.flex.along.shape[1] <= len(structure.passive):
            return structure
        return _chosen(structure, found, closed)


def _chosen(structure: Structure, found: Examined, closed: Collection[str]) -> Structure:
    states = found.stress.shape[1]
    picked = chosen(found.candidates, states)
    if not picked:
        return structure
    pose = _pose(found)
    limit, order = WEAKER * strength(picked), found.candidates
    best = _made(structure, picked, pose)
    least, left = _cost(best, picked, order, closed), COMPARED
    improved = True
    while improved and left > 0:
        improved = False
        for other in _neighbours(picked, order):
            if left <= 0:
                break
            if sum(len(one.forces) for one in other) != states or strength(other) < limit:
                continue
            left -= 1
            trial = _made(structure, other, pose)
            cost = _cost(trial, other, order, closed)
            if cost < least:
                best, least, picked, improved = trial, cost, other, True
                break
    return best if _excess(best) < _excess(structure) else structure


def _neighbours(picked: Sequence[Candidate], order: Sequence[Candidate]) -> list[list[Candidate]]:
    """The choices in which one part is exchanged, the last written first."""
    found = []
    for k in range(len(picked)):
        rest = [*picked[:k], *picked[k + 1 :]]
        taken = {one.place for one in rest}
        found += [[*rest, other] for other in reversed(order) if other.place not in taken and other is not picked[k]]
    return found


def _made(structure: Structure, picked: Sequence[Candidate], pose: Relaxation) -> Structure:
    return decomposed(structure.mechanism, replace(pose, dropped=tuple(one.dropped for one in picked)))


def _cost(
    made: Structure, picked: Sequence[Candidate], order: Sequence[Candidate], closed: Collection[str]
) -> tuple[int, ...]:
    """What is left undecomposed or may fail at some poses, how hard the groups are to solve, and how early what is left
    out was written."""
    places = list(dict.fromkeys(one.place for one in order))
    early = sum(len(places) - places.index(one.place) for one in picked)
    oblique = sum(not one.is_aligned for one in picked)
    return _excess(made), oblique, sum(_effort(group, closed) for group in made.groups), early


def _excess(structure: Structure) -> int:
    return sum(fault.amount for fault in structure.faults)


def _effort(group: Group, closed: Collection[str]) -> int:
    count = len(group.bodies)
    is_closed = group.name in closed or (count == 1 and len(group.outer) == 2)
    return count if is_closed else GENERAL * count * count


def _pose(found: Examined) -> Relaxation:
    """The assembled pose; where nothing is drawn, one that is not special."""
    equations = found.equations
    drawn = bool(equations.mechanism.sketch)
    poses = equations.poses(found.assembly.state if drawn else found.flex.state)
    carriers = equations.mechanism.carriers
    places = {letter: equations.place(poses, names[0], letter) for letter, names in carriers.items()}
    return Relaxation((), places, poses)
