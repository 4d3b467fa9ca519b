"""The equations of velocities and accelerations: one matrix, two right-hand sides; in symbols and with numbers.

A vector l e^(i a) has the derivative (l' + i l a') e^(i a), and at constant l' and a' the second one
(2 i l' a' - l a'^2) e^(i a): the Coriolis part and the centripetal one.

Sources: P. E. Nikravesh, Computer-Aided Analysis of Mechanical Systems, section 3.2; R. L. Norton, Design of Machinery,
sections 6.7 and 7.3.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np

from compoundkin.analysis.equations.expressions import (
    Expression,
    Length,
    Partial,
    Product,
    ProfilePart,
    Rate,
    SecondRate,
    total,
    turn_product,
)
from compoundkin.analysis.equations.reduced_system import (
    EquationRow,
    EquationScales,
    ReducedSystem,
    pose_values,
    prescribed_values,
)
from compoundkin.base.arguments import checked, real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.kinematics import Motion
from compoundkin.kinematics.groups.textbook_dyads import shape_of
from compoundkin.model.pairs.loop_terms import ProfileVector, Sum, Unknown, Values, Vector
from compoundkin.structure import Structure


@dataclass(frozen=True, eq=False, repr=False)
class SymbolArray(ShortRepr):
    """A matrix of expressions, or a column of them: rows of entries.

    >>> from compoundkin.analysis.equations.loop_equations import loop_equations
    >>> from compoundkin.files import load
    >>> found = loop_equations(load("slider-crank"), order=2).acceleration
    >>> found.right_side.entries[0][0].text
    "OA crank'' sin(crank) + OA crank'^2 cos(crank) + AB rod'^2 cos(rod)"
    """

    entries: tuple[tuple[Expression, ...], ...]

    @property
    def rows(self) -> tuple[str, ...]:
        """The entries of each row as text, without zeros."""
        return tuple(
            ", ".join(f"[{k}] {one.text}" for k, one in enumerate(row, 1) if not one.is_zero) for row in self.entries
        )

    @property
    def text(self) -> str:
        """Written as text, a line for each row, in columns."""
        rows = [[entry.text for entry in row] for row in self.entries]
        wide = [max(len(row[k].lstrip("-")) for row in rows) for k in range(len(rows[0]))] if rows else []
        signed = [[f"{'-' if one.startswith('-') else ' '}{one.lstrip('-')}" for one in row] for row in rows]
        lines = ["  ".join(one.ljust(wide[k] + 1) for k, one in enumerate(row)) for row in signed]
        return "\n".join(f"[ {line} ]" for line in lines)

    @property
    def latex(self) -> str:
        """Written as LaTeX."""
        rows = r" \\ ".join(" & ".join(entry.latex for entry in row) for row in self.entries)
        return rf"\begin{{bmatrix}} {rows} \end{{bmatrix}}"

    @checked
    def at(self, values: Mapping[str, Any]) -> Number:
        """Return the numbers, (..., rows, columns), from values of unknowns and rates by their keys.

        Raises InvalidInput for a missing value.
        """
        entries = {(k, j): own for k, row in enumerate(self.entries) for j, own in enumerate(row) if not own.is_zero}
        try:
            numbers = {place: own.at(values) for place, own in entries.items()}
        except KeyError as error:
            raise InvalidInput(
                Problem("values", f"{error.args[0]} has none", "give a value of every unknown and rate in it")
            ) from None
        shape = np.broadcast_shapes(*map(np.shape, numbers.values()))
        found = np.zeros((*shape, len(self.entries), len(self.entries[0]) if self.entries else 0))
        for (k, j), number in numbers.items():
            found[..., k, j] = number
        return found


# A matrix of pure numbers with a greater condition number is singular: an angle at a limit position is known to 1e-8,
# the square root of rounding, and rates would have less than three digits.
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


@dataclass(frozen=True, eq=False, repr=False)
class RateEquations(ShortRepr):
    """The equations of velocities or accelerations, a matrix times the unknown rates.

    `order` is 1 or 2. `unknowns` are the coordinates whose rates are unknown, in the order of the columns; `names` are
    those of the rows.
    """

    structure: Structure
    system: ReducedSystem
    order: int
    matrix: SymbolArray
    right_side: SymbolArray

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """The coordinates whose rates are unknown, a column of the matrix each."""
        return self.system.unknowns

    @property
    def names(self) -> tuple[str, ...]:
        """The name of each row: a loop's x or y, a pair, a driver."""
        return tuple(row.name for row in self.system.rows)

    @property
    def scales(self) -> EquationScales:
        """The divisors that make rows and columns pure numbers."""
        return self.system.scales(self.structure.mechanism.geometry.size)

    @property
    def rows(self) -> tuple[str, ...]:
        """The equations as text, one each."""
        return tuple(
            f"{_row(self.system.unknowns, row, self.order).text} = {right.text}"
            for row, (right,) in zip(self.matrix.entries, self.right_side.entries, strict=True)
        )

    @checked
    def at(self, where: Motion | Mapping[str, Any]) -> RateSolution:
        """Return matrix, right-hand side and solution in numbers, at all poses of a motion.

        Arrays are of the motion's shape, with axes for rows and columns at the end; NaN where a pose is not assembled.
        Instead of a motion `where` may be the values of all unknowns and the rates of the driven ones, by their keys.
        Raises InvalidInput for a motion that was not solved to the order of the equations or is of another mechanism,
        and for values left out or that do not broadcast.

        >>> from compoundkin.analysis.equations.loop_equations import loop_equations
        >>> from compoundkin.files import load
        >>> from compoundkin.kinematics import solve
        >>> m = load("slider-crank")
        >>> found = loop_equations(m, order=1).velocity
        >>> found.at(solve(m, {"crank": [np.pi / 2]}, speed=2.0)).solution.round(12).tolist()
        [[-0.0, -0.24]]
        >>> found.at({"crank": 0.0, "rod": 0.0, "s(stroke)": 0.38, "crank'": 1.3}).rate("rod").round(12)
        np.float64(-0.6)
        """
        if not isinstance(where, Motion):
            values = self._checked(where)
            return self._solved(shape_of(**values), values)
        if where.mechanism != self.structure.mechanism:
            remedy = "write the equations of its .mechanism"
            raise InvalidInput(Problem("where", "the motion is one of another mechanism", remedy))
        where.grid.require(self.order)
        values = pose_values(where)
        for order in range(1, self.order + 1):
            values.update(prescribed_values(where, self.system, order))
        return self._solved(where.shape, values)

    def _checked(self, values: Mapping[str, Any]) -> dict[str, Number]:
        rated = [own.rate_key(k) for own in self.system.given for k in range(1, self.order + 1)]
        placed = [own.key for own in (*self.unknowns, *self.system.given) if own.kind != "given"]
        missing = [key for key in (*placed, *rated) if key not in values]
        if missing:
            raise InvalidInput(Problem("values", f"{missing[0]} has none", "give all unknowns, and the rates given"))
        found = {key: real_numbers(key, value) for key, value in values.items()}
        # an infinite value marks a pose that is not assembled
        return {key: np.where(np.isinf(value), np.nan, value) for key, value in found.items()}

    def _solved(self, shape: tuple[int, ...], values: Values) -> RateSolution:
        found = {**values}
        if self.order == 2:
            slower = rate_equations(self.structure, self.system, 1)._solved(shape, values)
            found.update({own.rate_key(1): slower.solution[..., k] for k, own in enumerate(self.unknowns)})
        rows, columns = len(self.system.rows), len(self.unknowns)
        matrix = np.broadcast_to(self.matrix.at(found), (*shape, rows, columns))
        side = self.right_side.at(found)
        right = np.broadcast_to(side.reshape(side.shape[:-1]) if rows else np.zeros(0), (*shape, rows))
        return solution_of(self.unknowns, matrix, right, self.scales)


def rate_equations(structure: Structure, system: ReducedSystem, order: int) -> RateEquations:
    """Return the equations of velocities or accelerations of a system of rows.

    The right-hand side has the rates of the driven unknowns, and for accelerations the second derivative at constant
    rates.
    """
    matrix = tuple(tuple(row_derivative(row, unknown) for unknown in system.unknowns) for row in system.rows)
    right = []
    for row in system.rows:
        known = [row_derivative(row, own).times(-1.0, Rate(Sum(0.0, ((1.0, own),)), order)) for own in system.given]
        right.append((total(*known, *([second_row_derivative(row).times(-1.0)] if order == 2 else [])),))
    return RateEquations(structure, system, order, SymbolArray(matrix), SymbolArray(tuple(right)))


def _row(unknowns: Sequence[Unknown], row: Sequence[Expression], order: int) -> Expression:
    entries = zip(unknowns, row, strict=True)
    return total(*(entry.times(1.0, Rate(Sum(0.0, ((1.0, own),)), order)) for own, entry in entries))


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
    """Return the solutions of linear systems, those of least squares where there are more rows than columns."""
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


# A number and a rate that it multiplies.
Rated: TypeAlias = tuple[Number, Rate]


def row_derivative(row: EquationRow, unknown: Unknown) -> Expression:
    """Return the derivative of a row by an unknown."""
    if unknown not in row.unknowns:
        return Expression()
    if row.function is not None:
        function, sums = row.function, row.sums
        return total(*(Product(own.slope(unknown), (Partial(function, by, sums),)) for by, own in sums.items()))
    parts = [part for term in row.terms for part in _derivative_terms(term, unknown, row.is_imaginary)]
    return total(Product(row.sum.slope(unknown)), *parts)


def second_row_derivative(row: EquationRow) -> Expression:
    """Return the second derivative of a row by time at constant rates of all unknowns."""
    if row.function is not None:
        return total(Product(1.0, (SecondRate(row.function, row.sums),)))
    return total(*(part for term in row.terms for part in _constant_rate_terms(term, row.is_imaginary)))


def _derivative_terms(term: Vector | ProfileVector, unknown: Unknown, is_imaginary: bool) -> Iterator[Product]:
    turning = term.angle.slope(unknown)
    if isinstance(term, ProfileVector):
        yield _profile(term, 1, is_imaginary, 0, term.argument.slope(unknown))
        yield _profile(term, 0, is_imaginary, 1, turning)
        return
    yield turn_product(term.sign * term.length.slope(unknown), (), term.angle, is_imaginary)
    yield _across(term, term.sign * turning, is_imaginary, (Length(term.symbol, term.length),))


def _constant_rate_terms(term: Vector | ProfileVector, is_imaginary: bool) -> Iterator[Product]:
    sign, turning = term.sign, _rate(term.angle)
    if isinstance(term, ProfileVector):
        passing = _rate(term.argument)
        if passing:
            yield _profile(term, 2, is_imaginary, 0, *_squared(passing))
        if passing and turning:
            factor, rates = _times(2.0, passing, turning)
            yield _profile(term, 1, is_imaginary, 1, factor, *rates)
        if turning:
            yield _profile(term, 0, is_imaginary, 2, *_squared(turning))
    elif turning:
        factor, square = _squared(turning)
        yield turn_product(-sign * factor, (Length(term.symbol, term.length), square), term.angle, is_imaginary)
        sliding = _rate(term.length)
        if sliding:
            yield _across(term, 2.0 * sign * sliding[0] * turning[0], is_imaginary, (sliding[1], turning[1]))


def _rate(of: Sum) -> Rated | None:
    """Return the rate of a sum as a number times a rate; None for a constant."""
    if len(of.parts) == 1:
        return of.parts[0][0], Rate(Sum(0.0, ((1.0, of.parts[0][1]),)))
    return (1.0, Rate(Sum(0.0, of.parts))) if of.parts else None


def _times(number: float, one: Rated, other: Rated) -> tuple[Number, tuple[Rate, ...]]:
    """Return a number times two rates, which are a square if they are of one unknown."""
    factor = number * one[0] * other[0]
    if len(one[1].sum.parts) == 1 and one[1].sum.parts == other[1].sum.parts:
        return factor, (replace(one[1], is_squared=True),)
    return factor, (one[1], other[1])


def _squared(of: Rated) -> Rated:
    return of[0] ** 2, replace(of[1], is_squared=True)


def _across(term: Vector, number: float, is_imaginary: bool, factors: tuple[Length | Rate, ...]) -> Product:
    """Return the real or imaginary part of i e^(i a): minus the sine, or the cosine."""
    return turn_product(number if is_imaginary else -number, factors, term.angle, not is_imaginary)


def _profile(
    term: ProfileVector, order: int, is_imaginary: bool, quarters: int, number: float, *rates: Rate
) -> Product:
    """Return a part of a profile's derivative turned by quarters: Re(i z) = -Im(z)."""
    for _ in range(quarters):
        number = number if is_imaginary else -number
        is_imaginary = not is_imaginary
    return Product(np.multiply(term.sign, number)[()], (*rates, ProfilePart(term, order, is_imaginary)))
