"""Ties: wheels whose turns, and the ways of what they roll on, are in proportion, as sums over joints of a tree."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from compoundkin.base.arrays import first_entry
from compoundkin.files.exchange.mjcf.elementary_joints import ElementaryJoint, JointChain
from compoundkin.files.exchange.mjcf.joint_tree import JointTree
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends

# Hinges nearer to an axis than this part of the way from it are at it; numbers below are zero.
_ROUNDING = 1e-12


def geared_tie(tree: JointTree, pair: Pair, ends: Ends) -> Mapping[str, float]:
    """Return the tie of two wheels.

    Seen from the carrier, the second turns back by the ratio for one turn of the first.
    """
    first, second, carrier = pair.members
    ratio = float(first_entry(ends[0].measure) / first_entry(ends[1].measure))
    terms = [(joint, ratio * sign) for joint, sign in tree.between(carrier, first)]
    terms += [(joint, 1.0 * sign) for joint, sign in tree.between(carrier, second)]
    return _summed((joint.name, number) for joint, number in terms if joint.is_hinge)


def straight_tie(tree: JointTree, chain: JointChain) -> Mapping[str, float] | None:
    """Return the tie of a wheel on a line.

    The way between them is of slides, then of hinges at its axis. None where it is another way, on
    which what the wheel rolls is no sum of coordinates.
    """
    along, *_, axis = chain.joints
    way = list(tree.between(*chain.members))
    slides = [joint for joint, _ in way if not joint.is_hinge]
    hinges = [joint for joint, _ in way if joint.is_hinge]
    if along.is_hinge or [joint for joint, _ in way] != slides + hinges or not _at(hinges, axis.axis):
        return None
    terms = []
    for joint, sign in way:
        part = chain.tie[axis.name] if joint.is_hinge else float((along.axis.conjugate() * joint.axis).real)
        terms.append((joint.name, sign * part))
    return _summed(terms)


def _at(hinges: Iterable[ElementaryJoint], place: complex) -> bool:
    return all(abs(joint.axis - place) <= _ROUNDING * max(abs(joint.axis), abs(place)) for joint in hinges)


def _summed(terms: Iterable[tuple[str, float]]) -> dict[str, float]:
    found: dict[str, float] = {}
    for name, number in terms:
        found[name] = found.get(name, 0.0) + number
    return {name: number for name, number in found.items() if not np.isclose(number, 0.0, rtol=0.0, atol=_ROUNDING)}
