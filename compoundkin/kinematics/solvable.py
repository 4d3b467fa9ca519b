"""Structures that can be solved: without what is redundant, where a mechanism moves although it is overconstrained."""

from __future__ import annotations

from compoundkin.kinematics.groups import DYADS
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import Structure, decompose
from compoundkin.structure.redundancy import without_redundancy


def solvable(mechanism: Mechanism) -> Structure:
    """Take a mechanism apart, without what is redundant where it moves although it is overconstrained.

    `faults` are those that remain: of what does not move, and of drivers that are too many or missing.
    """
    return relaxed(decompose(mechanism))


def relaxed(structure: Structure) -> Structure:
    """Return the structure without what is redundant, in groups with closed forms where it can.

    The structure itself where nothing is overconstrained, or nothing moves.
    """
    return without_redundancy(structure, DYADS)
