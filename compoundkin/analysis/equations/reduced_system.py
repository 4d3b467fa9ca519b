"""The position equations row by row, in the unknowns that remain after substitution, with values of the unknowns.

Ties of one or two unknowns are substituted: an unknown that is a driver's value, the angle of a block on a guide,
whether that stands still or moves. Textbooks write the rest: two rows a loop, and as many unknowns; gears, belts, and
drivers between two moving links keep their rows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np

from compoundkin.analysis.equations.vector_loops import DriverEquation, VectorLoop, pair_terms
from compoundkin.base.arrays import Number, cross, unwrapped, wrapped
from compoundkin.base.display import ShortRepr
from compoundkin.kinematics import Motion
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.loop_terms import (
    Auxiliary,
    Implicit,
    LoopTerms,
    ProfileVector,
    Sum,
    Term,
    Unknown,
    Values,
    Vector,
    difference,
    rotated,
)
from compoundkin.structure import Structure

# A factor nearer to one than this is one: the angles that a slide ties have the factors 1 and -1 alone.
ONE = 1e-12
NOTHING = Sum()


class EquationScales(NamedTuple):
    """Divisors that make rows and columns pure numbers: the size for lengths, else one."""

    rows: Number
    columns: Number


@dataclass(frozen=True, eq=False)
class EquationRow:
    """One scalar equation: a sum, the real or imaginary part of a sum of vectors, or a function is zero.

    `sums` are the unknowns of a function in terms of the remaining ones.
    """

    name: str
    sum: Sum = NOTHING
    terms: tuple[Term, ...] = ()
    is_imaginary: bool = False
    function: Implicit | None = None
    sums: Mapping[Unknown, Sum] = field(default_factory=dict)
    is_angle: bool = False

    def at(self, values: Values) -> Number:
        """Return the residual, within half a turn where full turns are not counted."""
        if self.function is not None:
            return self.function.at({unknown.key: own.at(values) for unknown, own in self.sums.items()})
        vector = sum((term.at(values) for term in self.terms), 0j)
        found = self.sum.at(values) + (vector.imag if self.is_imaginary else vector.real)
        return wrapped(found) if self.is_angle else found

    @cached_property
    def unknowns(self) -> frozenset[Unknown]:
        """All unknowns that it depends on."""
        sums = [self.sum, *self.sums.values()]
        for term in self.terms:
            sums += [term.angle, term.argument if isinstance(term, ProfileVector) else term.length]
        return frozenset(unknown for own in sums for _, unknown in own.parts)

    @property
    def is_length(self) -> bool:
        """Whether the residual is a length."""
        if self.function is not None:
            return not self.function.is_angle
        return bool(self.terms) or any(unknown.is_length for _, unknown in self.sum.parts)


@dataclass(frozen=True, eq=False, repr=False)
class ReducedSystem(ShortRepr):
    """Rows, and the unknowns that remain in them.

    `given` are those whose values and rates drivers prescribe, each with its driver's equation; `sums` has all unknowns
    in terms of the remaining and the prescribed ones.
    """

    rows: tuple[EquationRow, ...]
    unknowns: tuple[Unknown, ...]
    given: Mapping[Unknown, DriverEquation]
    sums: Mapping[Unknown, Sum]

    @property
    def tied(self) -> tuple[tuple[Unknown, Sum], ...]:
        """The substituted unknowns, each with its sum."""
        return tuple((unknown, own) for unknown, own in self.sums.items() if own.parts != ((1.0, unknown),))

    def scales(self, size: float) -> EquationScales:
        """Return the divisors that make rows and columns pure numbers."""
        profiles = [term for row in self.rows for term in row.terms if isinstance(term, ProfileVector)]
        known = {unknown: own.scale for own in profiles for _, unknown in own.argument.parts}
        rows = [size if row.is_length else 1.0 for row in self.rows]
        columns = [size if unknown.is_length else known.get(unknown, 1.0) for unknown in self.unknowns]
        return EquationScales(np.array(rows), np.array(columns))

    def prescribed_value(self, unknown: Unknown, value: Number, order: int = 0) -> Number:
        """Return a driven unknown, or a rate of it, from that of its driver."""
        if unknown.kind == "given":
            return value
        own = _sum_substituted(self.given[unknown].sum, self.sums)
        return (value - (0.0 if order else own.constant)) / own.slope(unknown)


def reduced_system(
    loops: Sequence[VectorLoop],
    auxiliary: Sequence[Auxiliary | Implicit],
    drivers: Sequence[DriverEquation],
    unknowns: Sequence[Unknown],
) -> ReducedSystem:
    """Return the rows in the remaining unknowns."""
    ties = [own for own in auxiliary if isinstance(own, Auxiliary) and own.along is None and not own.counts_turns]
    sums: dict[Unknown, Sum] = {unknown: Sum(0.0, ((1.0, unknown),)) for unknown in unknowns}
    used = {id(own) for own in ties if _substitute_tie(own.sum, sums)}
    given = {}
    for own in drivers:
        plain = _sum_substituted(own.sum, sums).parts
        if len(plain) == 1 and _is_one(plain[0][0]) and plain[0][1] not in given:
            given[plain[0][1]] = own
            used.add(id(own))
    # a row without unknowns repeats another tie
    rows = [row for k, loop in enumerate(loops, 1) for row in _of_loop(loop, k, sums)]
    rows += [_of_auxiliary(own, sums) for own in auxiliary if id(own) not in used]
    for own in drivers:
        if id(own) not in used:
            value = Unknown("given", own.driver)
            given[value] = own
            rows.append(_of_driver(own, value, sums))
    left = tuple(unknown for unknown in unknowns if unknown not in given and sums[unknown].parts == ((1.0, unknown),))
    return ReducedSystem(tuple(row for row in rows if row.unknowns), left, given, sums)


def _substitute_tie(of: Sum, sums: dict[Unknown, Sum]) -> bool:
    """Substitute the first unknown of a tie of one or two everywhere; return False where the sum is no such tie."""
    found = _sum_substituted(of, sums)
    if not found.parts or len(found.parts) > 2 or not all(_is_one(factor) for factor, _ in found.parts):
        return False
    (factor, unknown), *others = found.parts
    # factor x + others + constant = 0, the factor being 1 or -1
    value = Sum(found.constant, tuple(others)).times(-factor)
    for name, own in sums.items():
        if own.slope(unknown) != 0:
            sums[name] = _sum_substituted(own, {unknown: value})
    return True


def _is_one(factor: Number) -> bool:
    return bool(np.all(np.abs(np.abs(factor) - 1.0) <= ONE))


def _sum_substituted(of: Sum, sums: Mapping[Unknown, Sum]) -> Sum:
    """Return a sum after substitution, without unknowns whose factors cancel."""
    constant, parts = of.constant, dict[Unknown, Number]()
    for factor, unknown in of.parts:
        own = sums.get(unknown, Sum(0.0, ((1.0, unknown),)))
        constant = constant + factor * own.constant
        for inner, other in own.parts:
            parts[other] = parts.get(other, 0.0) + factor * inner
    return Sum(constant, tuple((factor, unknown) for unknown, factor in parts.items() if np.any(factor != 0.0)))


def substituted(terms: Iterable[Term], sums: Mapping[Unknown, Sum], along: Sum | None = None) -> Iterator[Term]:
    """Yield vectors after substitution, as seen from the direction `along` if it is given."""
    for term in terms:
        angle = _sum_substituted(term.angle if along is None else difference(along, term.angle), sums)
        if isinstance(term, ProfileVector):
            yield replace(term, argument=_sum_substituted(term.argument, sums), angle=angle)
        else:
            yield Vector(term.symbol, _sum_substituted(term.length, sums), angle, term.sign)


def _of_loop(loop: VectorLoop, number: int, sums: Mapping[Unknown, Sum]) -> Iterator[EquationRow]:
    terms = tuple(substituted(loop.terms, sums))
    yield EquationRow(f"loop {number} x", terms=terms)
    yield EquationRow(f"loop {number} y", terms=terms, is_imaginary=True)


def _of_auxiliary(own: Auxiliary | Implicit, sums: Mapping[Unknown, Sum]) -> EquationRow:
    if isinstance(own, Implicit):
        unknowns = (*own.unknowns, *(() if own.result is None else (own.result,)))
        return EquationRow(own.pair, function=own, sums={unknown: sums[unknown] for unknown in unknowns})
    terms = () if own.along is None else tuple(substituted(own.path, sums, own.along))
    return EquationRow(own.pair, _sum_substituted(own.sum, sums), terms, is_angle=not own.counts_turns)


def _of_driver(own: DriverEquation, value: Unknown, sums: Mapping[Unknown, Sum]) -> EquationRow:
    found = _sum_substituted(own.sum, sums)
    return EquationRow(own.driver, Sum(found.constant, (*found.parts, (-1.0, value))), is_angle=own.is_angle)


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

    They come from the angles of links, the places of their points, and coordinates of pairs. A pair's unknowns close
    its vectors between the places of its points.
    """
    values = dict(angles)
    geometry = structure.mechanism.geometry
    for pair in structure.pairs:
        terms = pair_terms(pair, pair.ends(geometry))
        if terms.unknowns:
            first, second = (place(name, p) for name, p in zip(pair.members, terms.points, strict=False))
            values.update(_free_unknowns(terms, values, second - first, partial(coordinate, pair)))
    return values


def prescribed_values(motion: Motion, system: ReducedSystem, order: int) -> dict[str, Number]:
    """Return the rates that drivers prescribe, or at order 0 the values, by their keys."""
    found = {}
    for unknown, equation in system.given.items():
        value = motion.drives[equation.driver].derivative(order)
        found[unknown.rate_key(order)] = system.prescribed_value(unknown, value, order)
    return found


def _free_unknowns(
    terms: LoopTerms, angles: Values, gap: Number, coordinate: Callable[[], Number]
) -> Mapping[str, Number]:
    """Return the unknowns of a pair from the vector between its points."""
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
    """Return the lengths of one or two vectors of known directions whose sum is the rest."""
    along = [rotated(arm.angle.at(values), float(arm.sign)) for arm in arms]
    keys = [unknown.key for arm in arms for _, unknown in arm.length.parts]
    if len(arms) == 1:
        return {keys[0]: (rest * np.conj(along[0])).real}
    determinant = cross(along[0], along[1])
    return {keys[0]: cross(rest, along[1]) / determinant, keys[1]: cross(along[0], rest) / determinant}
