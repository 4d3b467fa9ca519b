"""The Jacobian from drivers to outputs at every pose of a motion, solved exactly, and its singular poses.

Sources: T. Yoshikawa, Manipulability of robotic mechanisms, Int. J. Robotics Research 4 (1985); C. Gosselin and
J. Angeles, Singularity analysis of closed-loop kinematic chains, IEEE Trans. Robotics and Automation 6 (1990).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.bracketing import bisect_brackets
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.unit_rates import Solved, matrix_at, rows_of, undetermined, units_of

# A Jacobian free of units has lost its rank where its least singular value is below this part of its largest: rates
# are right to some 1e-12 of the largest.
RANK = 1e-9
# Halvings between two poses, to rounding.
FINE = 50


@dataclass(frozen=True, eq=False, repr=False)
class Jacobian(ShortRepr):
    """How fast outputs move when each driver alone moves at unit speed.

    `matrix` (..., rows, drivers) has the motion's shape before its rows; NaN where a pose is not assembled or has no
    finite rates. The unit of an entry is `units[row][driver]`.
    """

    motion: Solved
    matrix: Number
    rows: tuple[str, ...]
    drivers: tuple[str, ...]
    units: tuple[tuple[str, ...], ...]
    # how many lengths an entry has: one of a row that is a length, less one of a driver that is
    lengths: Number

    @property
    def assembled(self) -> Number:
        """Which poses are assembled, a bool array of the motion's shape."""
        return self.motion.assembled

    @property
    def is_square(self) -> bool:
        """Whether there are as many rows as drivers."""
        return len(self.rows) == len(self.drivers)

    def scaled(self, length: float | None = None) -> Jacobian:
        """Return it free of units, lengths divided by a characteristic one.

        That is the mechanism's size if left out.
        """
        unit = self.motion.size if length is None else float(length)
        if not (np.isfinite(unit) and unit > 0.0):
            raise InvalidInput(Problem("length", f"{unit:g} is no length to divide by", "give a positive one"))
        nothing = tuple(("",) * len(self.drivers) for _ in self.rows)
        matrix = self.matrix / unit**self.lengths
        return replace(self, matrix=matrix, units=nothing, lengths=np.zeros_like(self.lengths))

    @cached_property
    def singular_values(self) -> Number:
        """The singular values, (..., least of rows and drivers). The largest first; NaN where the matrix is."""
        known = np.isfinite(self.matrix).all(axis=(-2, -1))
        values = np.linalg.svd(np.where(known[..., None, None], self.matrix, 0.0), compute_uv=False)
        return np.where(known[..., None], values, np.nan)

    @property
    def condition(self) -> Number:
        """The condition number in the 2-norm, infinite where the rank is lost.

        Where rows or drivers mix lengths and angles it depends on the unit of length; that of `scaled()` does not.
        """
        values = self.singular_values
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = values[..., 0] / values[..., -1]
        return np.where(self.singular, np.inf, ratio)

    @property
    def determinant(self) -> Number:
        """The determinant of a square Jacobian; raises InvalidInput for another."""
        if not self.is_square:
            what = f"{len(self.rows)} rows by {len(self.drivers)} drivers have no determinant"
            raise InvalidInput(Problem("determinant", what, "take .manipulability"))
        return _determinant(self.matrix)

    @property
    def manipulability(self) -> Number:
        """The product of the singular values. Yoshikawa's sqrt(det(J J^T)), the size of a determinant."""
        return np.prod(self.singular_values, axis=-1)

    @cached_property
    def singular(self) -> Number:
        """Where it loses its rank. No driver moves the outputs in some direction: the first kind, serial."""
        values = self.scaled().singular_values if np.any(self.lengths) else self.singular_values
        return self.assembled & (values[..., -1] <= RANK * values[..., 0])

    @property
    def at_limit(self) -> Number:
        """Where it is infinite. Outputs may move though all drivers rest: the second kind, parallel."""
        return self.assembled & ~np.isfinite(self.matrix).all(axis=(-2, -1))

    @cached_property
    def crossings(self) -> tuple[Number, ...]:
        """The places where the determinant passes through zero. An array for each design.

        A place 3.25 is a quarter of the way from pose 3 to pose 4; found to rounding, for a square Jacobian of a
        motion of rigid links. Limit positions, where the sign changes through infinity, do not count.
        """
        value = self.determinant.reshape(self.motion.inputs.designs, -1)
        designs, index = np.nonzero(value[:, :-1] * value[:, 1:] < 0.0)
        before, after = value[designs, index], value[designs, index + 1]
        inside, _ = bisect_brackets(lambda s: self._at(designs, s) * before > 0.0, index + 0.0, index + 1.0, FINE)
        ends = np.minimum(np.abs(before), np.abs(after))
        zero = np.abs(self._at(designs, inside)) < ends
        return tuple(inside[zero & (designs == d)] for d in range(len(value)))

    def _at(self, designs: Number, s: Number) -> Number:
        """Return the determinant of designs at places along the motion."""
        given = self.motion.inputs.at(s).of_poses(len(s))
        rows = rows_of(self.motion, self.rows)
        if not len(s):
            return s
        return _determinant(matrix_at(self.motion, rows, given, s)).reshape(-1, len(s))[designs, np.arange(len(s))]

    def times(self, speeds: Mapping[str, Number]) -> Number:
        """Return the rates of the rows (..., rows). Speeds are of drivers by name; those left out rest."""
        unknown = [name for name in speeds if name not in self.drivers]
        if unknown:
            raise InvalidInput(Problem("speeds", f"there is no driver {unknown[0]!r}", f"known: {self.drivers}"))
        given = [np.broadcast_to(speeds.get(name, 0.0), self.assembled.shape) for name in self.drivers]
        return (self.matrix @ np.stack(given, axis=-1)[..., None])[..., 0]

    def __repr__(self) -> str:
        rows, drivers = ", ".join(self.rows), ", ".join(self.drivers)
        return f"Jacobian({rows} by {drivers} at {self.assembled.shape} poses)"


def jacobian_of(motion: Solved, *outputs: str) -> Jacobian:
    """Return the Jacobian from drivers to outputs by name. See `Motion.jacobian`."""
    if not motion.inputs.drives:
        what = "the mechanism has no driver, so that nothing moves its outputs"
        raise InvalidInput(Problem("jacobian", what, 'give it one: compoundkin.drive("crank")'))
    rows = rows_of(motion, outputs)
    matrix = matrix_at(motion, rows, motion.inputs)
    # where the motion's own rates have lost their digits those of its drivers have too
    known = (motion.regular & ~undetermined(motion)).reshape(motion.shape)
    matrix = np.where(known[..., None, None], matrix, np.nan)
    drivers = tuple(motion.inputs.drives)
    per_driver = np.array([float(not motion.drives[name].is_angle) for name in drivers])
    lengths = np.array([float(row.is_length) for row in rows])[:, None] - per_driver
    return Jacobian(motion, matrix, tuple(row.name for row in rows), drivers, units_of(motion, rows), lengths)


def _determinant(matrix: Number) -> Number:
    with np.errstate(invalid="ignore"):
        return np.linalg.det(matrix)
