"""The Jacobian from drivers to outputs at every pose, by unit rates of each driver, and its singular poses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, NamedTuple, Protocol

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.bracketing import bisect_brackets
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem, UnknownName
from compoundkin.kinematics.block import Block, JoinedBlocks, blocks, places
from compoundkin.kinematics.curve.double_roots import rates_at
from compoundkin.kinematics.curve.followed_poses import FollowedPoses
from compoundkin.kinematics.driver_values import Inputs
from compoundkin.kinematics.quantities import AtPoses, Quantity, quantity, whole_and_part
from compoundkin.model.attributes import LENGTH, RATE_OF, derivative_order, unit_of
from compoundkin.structure.kinematic_structure import Structure

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


class Solved(AtPoses, Protocol):
    """A solved motion, which can be solved again with other inputs."""

    is_whole: ClassVar[bool]

    @property
    def inputs(self) -> Inputs:
        """The numbers it was solved for."""

    @property
    def structure(self) -> Structure:
        """The structure it was solved by."""

    @property
    def regular(self) -> Number:
        """Which poses have finite rates, (designs, poses)."""

    @property
    def size(self) -> float:
        """The mechanism's length scale."""

    @property
    def followed(self) -> FollowedPoses:
        """Its poses on the configuration curve."""

    def block(self, part: Inputs, order: int, s: Number, designs: Number) -> Block:
        """Solve a block of other inputs in its configuration."""


class Row(NamedTuple):
    """A row of a Jacobian. A real quantity, its rate by name, and whether it is a length."""

    name: str
    rate: str
    is_length: bool


def rows_of(motion: Solved, names: tuple[str, ...]) -> tuple[Row, ...]:
    """Return the rows of quantities by name, two of a vector. Raises UnknownName, InvalidInput for what has no rate."""
    wanted = names or tuple(name for name in motion.mechanism.outputs if derivative_order(name) == 0)
    if not wanted:
        raise InvalidInput(Problem("outputs", "nothing is named", 'name some: motion.jacobian("G", "bar.angle")'))
    return tuple(row for name in wanted for row in _rows(motion, name))


def _rows(motion: Solved, name: str) -> tuple[Row, ...]:
    if derivative_order(name) if isinstance(name, str) else False:
        told = "it is a rate itself, and a Jacobian tells the rates of places and angles"
        raise InvalidInput(Problem(name, told, "name what it is the rate of, such as a point or a link's angle"))
    whole, part = whole_and_part(motion, name)
    if whole.is_vector and not part:
        owner = _split(name)[0]
        return tuple(_row(motion, f"{owner}.{xy}", whole) for xy in ("x", "y"))
    if part == LENGTH:
        raise InvalidInput(Problem(name, "the length of a vector has no rate by name", "name the vector, or its .x"))
    return (_row(motion, name, whole),)


def _row(motion: Solved, name: str, whole: Quantity) -> Row:
    owner, rest = _split(name)
    for word in RATE_OF.get(rest, ()):
        try:
            quantity(motion, f"{owner}.{word.partition('.')[0]}")
        except UnknownName:
            continue
        except InvalidInput:  # known, but beyond the order that the motion was solved to
            pass
        return Row(name, f"{owner}.{word}", whole.dimension == "length")
    remedy = "name points, their .x and .y, angles of links, displacements of slides"
    raise InvalidInput(Problem(name, "its rate has no name, so that no driver's share in it can be told", remedy))


def _split(name: str) -> tuple[str, str]:
    """Return the owner and what follows it. A component of a position has two words."""
    owner, _, word = name.partition(".") if name.count(".") < 2 else _of_two(name)
    return owner, word


def _of_two(name: str) -> tuple[str, str, str]:
    owner, word, part = name.rsplit(".", 2)
    return (owner, ".", f"{word}.{part}") if f"{word}.{part}" in RATE_OF else (f"{owner}.{word}", ".", part)


def units_of(motion: Solved, rows: tuple[Row, ...]) -> tuple[tuple[str, ...], ...]:
    """Return the unit of every entry, by rows. It is empty for a plain ratio."""
    length = motion.mechanism.unit

    def unit(row: Row, driver: str) -> str:
        over, under = (unit_of(length, "length" if is_length else "angle")
                       for is_length in (row.is_length, not motion.drives[driver].is_angle))  # fmt: skip
        return "" if over == under else f"{over}/{under}"

    return tuple(tuple(unit(row, driver) for driver in motion.drives) for row in rows)


def moved_alone(motion: Solved, driver: str) -> Any:
    """Return the motion with one driver at unit speed, the others at rest."""
    return moved_together(motion, {driver: 1.0})


def moved_together(
    motion: Solved, speeds: Mapping[str, Number], order: int = 1, beyond: Mapping[str, Number] | None = None
) -> Any:
    """Return the motion with its drivers at other speeds, which do not change.

    Those not named are at rest; drivers may be `beyond` their values by something, in the same configuration.
    """
    given, more = motion.inputs, beyond or {}
    drives = {name: (v[0] + more.get(name, 0.0), speeds.get(name, 0.0)) for name, v in given.drives.items()}
    return _solved(motion, given.driven(drives), None, order)


def matrix_at(motion: Solved, rows: tuple[Row, ...], given: Inputs, s: Number | None = None) -> Number:
    """Return the Jacobian (..., rows, drivers) at inputs. They are the motion's own, or those at its places `s`."""
    columns = []
    for moved in given.drives:
        alone = given.driven({name: (v[0], float(name == moved)) for name, v in given.drives.items()})
        unit = _solved(motion, alone, s)
        columns.append(np.stack([np.asarray(quantity(unit, row.rate).values) for row in rows], axis=-1))
    return np.stack(columns, axis=-1)


def _solved(motion: Solved, given: Inputs, s: Number | None, order: int = 1) -> Any:
    """Return the motion with drivers moving at other speeds."""
    designs, poses = given.designs, given.poses
    store = JoinedBlocks(designs, poses)
    with np.errstate(all="ignore"):
        for d, m in blocks(designs, poses):
            at, index = places(d, m)
            store.take(motion.block(given.cut(d, m), order, at if s is None else s[None, m], index), d, m)
    again: Any = motion
    found = replace(again, order=order, inputs=given, poses=store.poses(), failed=store.failed, time=None)
    if s is None and motion.is_whole and len(given.drives) == 1 and motion.followed.expanded is not None:
        with np.errstate(all="ignore"):
            return found.mended(*rates_at(given, motion.followed, order))
    return found


def undetermined(motion: Solved) -> Number:
    """Return the change points where drivers together tell the rates, (designs, poses)."""
    found = np.zeros(motion.assembled.shape, dtype=bool).reshape(motion.inputs.designs, motion.inputs.poses)
    if motion.followed.expanded is not None and len(motion.inputs.drives) > 1:
        found[motion.followed.expanded[:2]] = True
    return found
