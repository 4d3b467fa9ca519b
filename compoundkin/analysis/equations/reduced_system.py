"""The equations of positions row by row, in the unknowns that are left once the plain ones are put in.

Put in is what an equation plainly says: an unknown that is a driver's value, the angle of a block on a guide, whether
that stands still or moves. What is left is what textbooks write: two rows a loop, and as many unknowns; gears, belts,
and drivers between two moving links keep their rows.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from compoundkin.analysis.equations.rate_solution import Scales
from compoundkin.analysis.equations.vector_loops import DriverEquation, VectorLoop
from compoundkin.base.arrays import Number, wrapped
from compoundkin.base.display import ShortRepr
from compoundkin.model.pairs.loop_terms import (
    Auxiliary,
    Implicit,
    ProfileVector,
    Sum,
    Term,
    Unknown,
    Values,
    Vector,
    difference,
)

# A factor nearer to one than this is one: of angles that a slide ties, factors are one and nothing else.
ONE = 1e-12
NOTHING = Sum()


@dataclass(frozen=True, eq=False)
class EquationRow:
    """One scalar equation. A sum, parts of vectors, or a function is to be zero.

    Of vectors it is the real part, or the imaginary one. `sums` are the unknowns of a function in terms of those left.
    """

    name: str
    sum: Sum = NOTHING
    terms: tuple[Term, ...] = ()
    is_imaginary: bool = False
    function: Implicit | None = None
    sums: Mapping[Unknown, Sum] = field(default_factory=dict)
    is_angle: bool = False

    def at(self, values: Values) -> Number:
        """Return what is to be zero. Whole turns are left out where they are not counted."""
        if self.function is not None:
            return self.function.at({unknown.key: own.at(values) for unknown, own in self.sums.items()})
        vector = sum((term.at(values) for term in self.terms), 0j)
        found = self.sum.at(values) + (vector.imag if self.is_imaginary else vector.real)
        return wrapped(found) if self.is_angle else found

    @cached_property
    def unknowns(self) -> frozenset[Unknown]:
        """All that it depends on."""
        sums = [self.sum, *self.sums.values()]
        for term in self.terms:
            sums += [term.angle, term.argument if isinstance(term, ProfileVector) else term.length]
        return frozenset(unknown for own in sums for _, unknown in own.parts)

    @property
    def is_length(self) -> bool:
        """Whether what is to be zero is a length."""
        if self.function is not None:
            return not self.function.is_angle
        return bool(self.terms) or any(unknown.is_length for _, unknown in self.sum.parts)


@dataclass(frozen=True, eq=False, repr=False)
class ReducedSystem(ShortRepr):
    """Rows, and the unknowns that are left in them.

    `given` are those whose values and rates drivers give, each with its driver's equation; `sums` has all unknowns in
    terms of those left and those given.
    """

    rows: tuple[EquationRow, ...]
    unknowns: tuple[Unknown, ...]
    given: Mapping[Unknown, DriverEquation]
    sums: Mapping[Unknown, Sum]

    @property
    def tied(self) -> tuple[tuple[Unknown, Sum], ...]:
        """What was put in besides drivers: an unknown, and what it is."""
        return tuple((unknown, own) for unknown, own in self.sums.items() if own.parts != ((1.0, unknown),))

    def scales(self, size: float) -> Scales:
        """Return what makes pure numbers of rows and columns."""
        profiles = [term for row in self.rows for term in row.terms if isinstance(term, ProfileVector)]
        known = {unknown: own.scale for own in profiles for _, unknown in own.argument.parts}
        rows = [size if row.is_length else 1.0 for row in self.rows]
        columns = [size if unknown.is_length else known.get(unknown, 1.0) for unknown in self.unknowns]
        return Scales(np.array(rows), np.array(columns))

    def given_by(self, unknown: Unknown, value: Number, order: int = 0) -> Number:
        """Return a given unknown, or a rate of it, from that of its driver."""
        if unknown.kind == "given":
            return value
        own = _put(self.given[unknown].sum, self.sums)
        return (value - (0.0 if order else own.constant)) / own.slope(unknown)


def reduced(
    loops: Sequence[VectorLoop],
    auxiliary: Sequence[Auxiliary | Implicit],
    drivers: Sequence[DriverEquation],
    unknowns: Sequence[Unknown],
) -> ReducedSystem:
    """Return the rows in the unknowns that are left."""
    ties = [own for own in auxiliary if isinstance(own, Auxiliary) and own.along is None and not own.counts_turns]
    sums: dict[Unknown, Sum] = {unknown: Sum(0.0, ((1.0, unknown),)) for unknown in unknowns}
    used = {id(own) for own in ties if _tie(own.sum, sums)}
    given = {}
    for own in drivers:
        plain = _put(own.sum, sums).parts
        if len(plain) == 1 and _is_one(plain[0][0]) and plain[0][1] not in given:
            given[plain[0][1]] = own
            used.add(id(own))
    # a row of which nothing is left is one of two ties that say the same
    rows = [row for k, loop in enumerate(loops, 1) for row in _of_loop(loop, k, sums)]
    rows += [_of_auxiliary(own, sums) for own in auxiliary if id(own) not in used]
    for own in drivers:
        if id(own) not in used:
            value = Unknown("given", own.driver)
            given[value] = own
            rows.append(_of_driver(own, value, sums))
    left = tuple(unknown for unknown in unknowns if unknown not in given and sums[unknown].parts == ((1.0, unknown),))
    return ReducedSystem(tuple(row for row in rows if row.unknowns), left, given, sums)


def _tie(of: Sum, sums: dict[Unknown, Sum]) -> bool:
    """Put in the first unknown of a tie of one or two, wherever it is; False where it is none."""
    found = _put(of, sums)
    if not found.parts or len(found.parts) > 2 or not all(_is_one(factor) for factor, _ in found.parts):
        return False
    (factor, unknown), *others = found.parts
    # factor x + others + constant = 0, the factor being 1 or -1
    value = Sum(found.constant, tuple(others)).times(-factor)
    for name, own in sums.items():
        if own.slope(unknown) != 0:
            sums[name] = _put(own, {unknown: value})
    return True


def _is_one(factor: Number) -> bool:
    return bool(np.all(np.abs(np.abs(factor) - 1.0) <= ONE))


def _put(of: Sum, sums: Mapping[Unknown, Sum]) -> Sum:
    """A sum with unknowns put in; factors that cancel are left out."""
    constant, parts = of.constant, dict[Unknown, Number]()
    for factor, unknown in of.parts:
        own = sums.get(unknown, Sum(0.0, ((1.0, unknown),)))
        constant = constant + factor * own.constant
        for inner, other in own.parts:
            parts[other] = parts.get(other, 0.0) + factor * inner
    return Sum(constant, tuple((factor, unknown) for unknown, factor in parts.items() if np.any(factor != 0.0)))


def resolved(terms: Iterable[Term], sums: Mapping[Unknown, Sum], along: Sum | None = None) -> Iterator[Term]:
    """Return vectors with unknowns put in. A direction, if any, turns them back."""
    for term in terms:
        angle = _put(term.angle if along is None else difference(along, term.angle), sums)
        if isinstance(term, ProfileVector):
            yield replace(term, argument=_put(term.argument, sums), angle=angle)
        else:
            yield Vector(term.symbol, _put(term.length, sums), angle, term.sign)


def _of_loop(loop: VectorLoop, number: int, sums: Mapping[Unknown, Sum]) -> Iterator[EquationRow]:
    terms = tuple(resolved(loop.terms, sums))
    yield EquationRow(f"loop {number} x", terms=terms)
    yield EquationRow(f"loop {number} y", terms=terms, is_imaginary=True)


def _of_auxiliary(own: Auxiliary | Implicit, sums: Mapping[Unknown, Sum]) -> EquationRow:
    if isinstance(own, Implicit):
        unknowns = (*own.unknowns, *(() if own.result is None else (own.result,)))
        return EquationRow(own.pair, function=own, sums={unknown: sums[unknown] for unknown in unknowns})
    terms = () if own.along is None else tuple(resolved(own.path, sums, own.along))
    return EquationRow(own.pair, _put(own.sum, sums), terms, is_angle=not own.counts_turns)


def _of_driver(own: DriverEquation, value: Unknown, sums: Mapping[Unknown, Sum]) -> EquationRow:
    found = _put(own.sum, sums)
    return EquationRow(own.driver, Sum(found.constant, (*found.parts, (-1.0, value))), is_angle=own.is_angle)
