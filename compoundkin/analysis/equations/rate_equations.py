"""The equations of velocities and accelerations: one matrix, two right-hand sides; in symbols and with numbers.

Sources: P. E. Nikravesh, Computer-Aided Analysis of Mechanical Systems, section 3.2; R. L. Norton, Design of Machinery,
sections 6.7 and 7.3.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.analysis.equations.expressions import Expression, total
from compoundkin.analysis.equations.factors import Rate
from compoundkin.analysis.equations.pose_values import given_values, pose_values
from compoundkin.analysis.equations.rate_solution import RateSolution, Scales, solution_of
from compoundkin.analysis.equations.reduced_system import ReducedSystem
from compoundkin.analysis.equations.row_derivatives import bend, slope
from compoundkin.base.arguments import checked, real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics import Motion
from compoundkin.kinematics.moving_lines import shape_of
from compoundkin.model.pairs.loop_terms import Sum, Unknown, Values
from compoundkin.structure import Structure


@dataclass(frozen=True, eq=False, repr=False)
class SymbolArray(ShortRepr):
    """A matrix of expressions, or a column of them: rows of entries.

    >>> from compoundkin.analysis.equations.loop_equations import loop_equations
    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> found = loop_equations(load_named("slider-crank"), order=2).acceleration
    >>> found.right_side.entries[0][0].text
    "OA crank'' sin(crank) + OA crank'^2 cos(crank) + AB rod'^2 cos(rod)"
    """

    entries: tuple[tuple[Expression, ...], ...]

    @property
    def rows(self) -> tuple[str, ...]:
        """Each row's entries as text, but those that are zero."""
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
        """Return the numbers, (..., rows, columns). Those of unknowns and rates go by their keys.

        Raises InvalidInput for what has no value.
        """
        entries = {(k, j): own for k, row in enumerate(self.entries) for j, own in enumerate(row) if not own.is_zero}
        try:
            numbers = {place: own.at(values) for place, own in entries.items()}
        except KeyError as error:
            raise InvalidInput(Problem("values", f"{error.args[0]} has none", "give all that is in it")) from None
        shape = np.broadcast_shapes(*map(np.shape, numbers.values()))
        found = np.zeros((*shape, len(self.entries), len(self.entries[0]) if self.entries else 0))
        for (k, j), number in numbers.items():
            found[..., k, j] = number
        return found


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
        """What each row is: a loop's x or y, a pair, a driver."""
        return tuple(row.name for row in self.system.rows)

    @property
    def is_square(self) -> bool:
        """Whether there are as many rows as unknowns."""
        return len(self.system.rows) == len(self.unknowns)

    @property
    def scales(self) -> Scales:
        """What makes pure numbers of rows and columns."""
        return self.system.scales(self.structure.mechanism.geometry.size)

    @property
    def rows(self) -> tuple[str, ...]:
        """The equations one by one, as text."""
        return tuple(
            f"{_row(self.system.unknowns, row, self.order).text} = {right.text}"
            for row, (right,) in zip(self.matrix.entries, self.right_side.entries, strict=True)
        )

    @checked
    def at(self, where: Motion | Mapping[str, Any]) -> RateSolution:
        """Return matrix, right-hand side and solution in numbers, at all poses of a motion.

        Arrays are of the motion's shape, with axes for rows and columns at the end; NaN where a pose is not assembled.
        Instead of a motion it may be the values of all unknowns and the rates of those given, by their keys.
        Raises InvalidInput for a motion that was not solved to the order of the equations or is of another mechanism,
        and for values left out or that do not broadcast.

        >>> from compoundkin.analysis.equations.loop_equations import loop_equations
        >>> from compoundkin.files.shipped_mechanisms import load_named
        >>> from compoundkin.kinematics import solve
        >>> m = load_named("slider-crank")
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
            values.update(given_values(where, self.system, order))
        return self._solved(where.shape, values)

    def _checked(self, values: Mapping[str, Any]) -> dict[str, Number]:
        rated = [own.rate_key(k) for own in self.system.given for k in range(1, self.order + 1)]
        placed = [own.key for own in (*self.unknowns, *self.system.given) if own.kind != "given"]
        missing = [key for key in (*placed, *rated) if key not in values]
        if missing:
            raise InvalidInput(Problem("values", f"{missing[0]} has none", "give all unknowns, and the rates given"))
        found = {key: real_numbers(key, value) for key, value in values.items()}
        # what is infinite is nowhere
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

    What is known goes to the right: the rates of given unknowns, and for accelerations the second derivative that is
    left where all rates are constant.
    """
    matrix = tuple(tuple(slope(row, unknown) for unknown in system.unknowns) for row in system.rows)
    right = []
    for row in system.rows:
        known = [slope(row, own).times(-1.0, Rate(Sum(0.0, ((1.0, own),)), order)) for own in system.given]
        right.append((total(*known, *([bend(row).times(-1.0)] if order == 2 else [])),))
    return RateEquations(structure, system, order, SymbolArray(matrix), SymbolArray(tuple(right)))


def _row(unknowns: Sequence[Unknown], row: Sequence[Expression], order: int) -> Expression:
    pairs = zip(unknowns, row, strict=True)
    return total(*(entry.times(1.0, Rate(Sum(0.0, ((1.0, own),)), order)) for own, entry in pairs))
