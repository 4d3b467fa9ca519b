"""The unknowns of loop equations as the poses of a motion show them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from compoundkin.analysis.equations.pair_terms import pair_terms
from compoundkin.analysis.equations.reduced_system import ReducedSystem
from compoundkin.base.arrays import Number, cross, unwrapped
from compoundkin.kinematics import Motion
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.loop_terms import LoopTerms, Unknown, Values, Vector, rotated
from compoundkin.structure import Structure


def pose_values(motion: Motion) -> dict[str, Number]:
    """Return the values of all unknowns by their keys, arrays of the motion's shape."""
    return unknown_values(
        motion.structure,
        {name: link.angle for name, link in motion.links.items()},
        lambda link, point: np.asarray(motion.links[link].at(point).position),
        lambda pair: motion.pairs[pair.name].value,
    )


def unknown_values(
    structure: Structure,
    angles: Mapping[str, Number],
    place: Callable[[str, Number], Number],
    coordinate: Callable[[Pair], Number],
) -> dict[str, Number]:
    """Return the values of all unknowns by their keys.

    They come from the angles of links, the places of their points, and coordinates of pairs. What pairs leave free is
    what the places of their points leave of their vectors.
    """
    values = dict(angles)
    geometry = structure.mechanism.geometry
    for pair in structure.pairs:
        terms = pair_terms(pair, pair.ends(geometry))
        if terms.unknowns:
            first, second = (place(name, p) for name, p in zip(pair.members, terms.points, strict=False))
            values.update(_left_free(terms, values, second - first, partial(coordinate, pair)))
    return values


def given_values(motion: Motion, system: ReducedSystem, order: int) -> dict[str, Number]:
    """Return the rates that drivers give, or at order 0 the values. They go by their keys."""
    found = {}
    for unknown, equation in system.given.items():
        value = motion.drives[equation.driver].derivative(order)
        found[unknown.rate_key(order)] = system.given_by(unknown, value, order)
    return found


def _left_free(terms: LoopTerms, angles: Values, gap: Number, coordinate: Callable[[], Number]) -> Mapping[str, Number]:
    """The unknowns of a pair between whose points is a gap."""
    arms = [arm for arm in terms.arms if isinstance(arm, Vector) and not arm.symbol]
    moved = {unknown for arm in arms for _, unknown in arm.length.parts}
    turning = [own for own in terms.unknowns if own.kind == "direction" and any(_turns(arm, own) for arm in terms.arms)]
    found = {own.key: coordinate() for own in terms.unknowns if own not in moved and own not in turning}
    zero = {**angles, **found, **{own.key: 0.0 for own in (*moved, *turning)}}
    for own in turning:
        arm = next(arm for arm in terms.arms if _turns(arm, own))
        return {own.key: unwrapped(np.angle(gap / np.asarray(arm.at(zero))))}
    if not moved:
        return found
    rest = gap - sum((arm.at(zero) for arm in terms.arms), 0j)
    return {**found, **_lengths(arms, zero, rest)}


def _turns(arm: object, unknown: Unknown) -> bool:
    return isinstance(arm, Vector) and bool(arm.angle.slope(unknown))


def _lengths(arms: list[Vector], values: Values, rest: Number) -> dict[str, Number]:
    """The lengths of one vector or two of known directions that make up the rest."""
    along = [rotated(arm.angle.at(values), float(arm.sign)) for arm in arms]
    keys = [unknown.key for arm in arms for _, unknown in arm.length.parts]
    if len(arms) == 1:
        return {keys[0]: (rest * np.conj(along[0])).real}
    determinant = cross(along[0], along[1])
    return {keys[0]: cross(rest, along[1]) / determinant, keys[1]: cross(along[0], rest) / determinant}
