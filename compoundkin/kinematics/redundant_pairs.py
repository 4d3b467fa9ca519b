"""Mechanisms that move although they are overconstrained: solved without redundant pairs, which are then checked."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import NotAssembled, NotDetermined, Problem
from compoundkin.kinematics.motion import Motion
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import constraint_scales
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.redundancy import mobility_analysis
from compoundkin.structure.redundancy.constraint_equations import ROUNDED


def rank_diagnosis(structure: Structure) -> str:
    """Say what the dimensions make of an overconstrained mechanism. The words are to be added to a heading."""
    if not any(fault.kind == "over" for fault in structure.faults):
        return ""
    found = mobility_analysis(structure)
    return f" ({found.verdict})" if found.finite is not None or found.gap else ""


@contextmanager
def diagnosing(structure: Structure) -> Iterator[None]:
    """Raise NotDetermined with the reason where a group has no pose. Its dimensions are special there."""
    try:
        yield
    except NotAssembled as error:
        found = mobility_analysis(structure)
        if found.finite is None or found.finite == found.gruebler:
            raise error
        heading = f"{structure.mechanism.title!r} cannot be solved"
        raise NotDetermined(Problem("structure", found.verdict), heading=heading) from None


def check_redundant(motion: Motion) -> None:
    """Raise NotAssembled, naming them, unless every redundant pair is closed at all assembled poses."""
    opened = [(pair, opening(motion, pair)) for pair in motion.structure.redundant]
    wrong = [_problem(motion, pair, gap) for pair, gap in opened if np.nanmax(gap) > ROUNDED.closed * motion.size]
    if wrong:
        raise NotAssembled(wrong, heading=f"{motion.mechanism.title!r} does not move like this")


def opening(motion: Motion, pair: Pair) -> Number:
    """Return the residual of a redundant pair at each pose (designs x poses).

    It is a length in the user's unit, an angle the arc of it at the mechanism's size; 0 where not assembled.
    """
    poses = tuple(motion.poses[name] for name in pair.members)
    held = pair.closure(motion.inputs.ends[pair.name], poses)
    parts = [one.c[0] / scale for one, scale in zip(held, constraint_scales(pair, motion.size), strict=True)]
    squares = sum(np.abs(np.broadcast_to(part, motion.failed.shape)) ** 2 for part in parts)
    return np.where(motion.failed == 0, np.sqrt(squares) * motion.size, 0.0)


def _problem(motion: Motion, pair: Pair, gap: Number) -> Problem:
    at = int(np.nanargmax(gap)) % max(motion.inputs.poses, 1)
    what = f"the pair opens by {float(np.nanmax(gap)):.6g} at pose {at}: other pairs do not hold it there"
    remedy = "the dimensions or the assembly mode do not allow this motion: draw an assembled pose"
    return Problem(pair.name, what, remedy)
