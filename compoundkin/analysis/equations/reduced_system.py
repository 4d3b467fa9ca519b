"""The position equations row by row, in the unknowns that are left after substitution, with values of the unknowns.

Substituted is what an equation plainly says: an unknown that is a driver's value, the angle of a block on a guide,
whether that stands still or moves. What is left is what textbooks write: two rows a loop, and as many unknowns; gears,
belts, and drivers between two moving links keep their rows.
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
from compoundkin.base.errors import Problem, UnknownName, suggestion
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

    def scales(self, size: float) -> EquationScales:
        """Return what makes pure numbers of rows and columns."""
        profiles = [term for row in self.rows for term in row.terms if isinstance(term, ProfileVector)]
        known = {unknown: own.scale for own in profiles for _, unknown in own.argument.parts}
        rows = [size if row.is_length else 1.0 for row in self.rows]
        columns = [size if unknown.is_length else known.get(unknown, 1.0) for unknown in self.unknowns]
        return EquationScales(np.array(rows), np.array(columns))

    def given_by(self, unknown: Unknown, value: Number, order: int = 0) -> Number:
        """Return a given unknown, or a rate of it, from that of its driver."""
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
    """Return the rows in the unknowns that are left."""
    ties = [own for own in auxiliary if isinstance(own, Auxiliary) and own.along is None and not own.counts_turns]
    sums: dict[Unknown, Sum] = {unknown: Sum(0.0, ((1.0, unknown),)) for unknown in unknowns}
    used = {id(own) for own in ties if _tie(own.sum, sums)}
    given = {}
    for own in drivers:
        plain = _sum_substituted(own.sum, sums).parts
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
    """A sum with unknowns put in; factors that cancel are left out."""
    constant, parts = of.constant, dict[Unknown, Number]()
    for factor, unknown in of.parts:
        own = sums.get(unknown, Sum(0.0, ((1.0, unknown),)))
        constant = constant + factor * own.constant
        for inner, other in own.parts:
            parts[other] = parts.get(other, 0.0) + factor * inner
    return Sum(constant, tuple((factor, unknown) for unknown, factor in parts.items() if np.any(factor != 0.0)))


def substituted(terms: Iterable[Term], sums: Mapping[Unknown, Sum], along: Sum | None = None) -> Iterator[Term]:
    """Return vectors with unknowns put in. A direction, if any, turns them back."""
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


def prescribed_values(motion: Motion, system: ReducedSystem, order: int) -> dict[str, Number]:
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


# A matrix of pure numbers with a greater condition is singular: an angle at a limit position is known to 1e-8, the
# root of what rounding leaves, and rates would have less than three digits.
SINGULAR = 1e6


@dataclass(frozen=True, eq=False, repr=False)
class RateSolution(ShortRepr):
    """The numbers of rate equations at all poses.

    `matrix` is (..., rows, columns), `right_side` (..., rows), `solution` (..., columns). `condition` is that of the
    matrix with all lengths in parts of the mechanism's size. Where it is beyond 1e6 the matrix is `singular` and the
    solution NaN: a limit position. A matrix with more rows than columns has no determinant (NaN); its solution fits all
    rows in the sense of least squares, exactly where they agree.
    """

    unknowns: tuple[Unknown, ...]
    matrix: Number
    right_side: Number
    solution: Number
    determinant: Number
    condition: Number
    singular: Number

    def rate(self, key: str) -> Number:
        """Return the rate of one unknown by its key. Raises UnknownName for one that is not among the unknowns."""
        keys = [unknown.key for unknown in self.unknowns]
        if key not in keys:
            raise UnknownName(Problem(key, "there is no such unknown", suggestion(key, keys)))
        return self.solution[..., keys.index(key)]


class EquationScales(NamedTuple):
    """What makes pure numbers of rows and columns. It is the size for lengths, else one."""

    rows: Number
    columns: Number


def solution_of(unknowns: Sequence[Unknown], matrix: Number, right: Number, scale: EquationScales) -> RateSolution:
    """Solve the equations at all poses."""
    rows, columns = matrix.shape[-2:]
    known = np.isfinite(matrix).all(axis=(-2, -1))
    pure = matrix * scale.columns / scale.rows[:, None]
    condition = np.full(known.shape, np.nan)
    condition[known] = condition_number(pure[known])
    singular = known & ~(condition <= SINGULAR)
    fine = known & ~singular & np.isfinite(right).all(axis=-1)
    solution, determinant = np.full((*known.shape, columns), np.nan), np.full(known.shape, np.nan)
    if rows >= columns:
        solution[fine] = scale.columns * least_squares(pure[fine], right[fine] / scale.rows)
    if rows == columns:
        determinant[known] = np.linalg.det(matrix[known])
    return RateSolution(tuple(unknowns), matrix, right, solution, determinant, condition, singular)


def least_squares(matrix: Number, right: Number) -> Number:
    """Return the solutions of systems. Of more rows than columns it is that of least squares."""
    if matrix.shape[-2] == matrix.shape[-1]:
        return np.linalg.solve(matrix, right[..., None])[..., 0]
    return np.einsum("...ij,...j->...i", np.linalg.pinv(matrix), right)


def condition_number(matrix: Number) -> Number:
    """Return the greatest singular value over the least; infinite for fewer rows than columns."""
    rows, columns = matrix.shape[-2:]
    if not columns:
        return np.ones(matrix.shape[:-2])
    if rows < columns:
        return np.full(matrix.shape[:-2], np.inf)
    values = np.linalg.svd(matrix, compute_uv=False)
    with np.errstate(divide="ignore"):
        return values[..., 0] / values[..., -1]
