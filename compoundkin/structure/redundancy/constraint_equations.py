"""What all pairs of a mechanism hold, as equations in the poses of all moving links; drivers are free."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import first_entry
from compoundkin.base.poses import FIXED, End, Pose
from compoundkin.base.series import constant
from compoundkin.model.definition import Pins, driven_pair
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Drivable, Ends
from compoundkin.structure.parts import LINK_FREEDOMS
from compoundkin.structure.system import generic_jacobian

Array = np.ndarray[Any, np.dtype[np.float64]]

SEED = 20260101


class Tolerance(NamedTuple):
    """Bounds of closed and dependent: residuals by the size, singular values by the largest."""

    closed: float
    rank: float


# Rounding of exact dimensions.
STRICT = Tolerance(1e-9, 1e-9)
# Dimensions given to some five digits, as in print: pairs that ought to close open by as much, and what ought to be
# dependent is so nearly.
ROUNDED = Tolerance(1e-5, 1e-4)


@dataclass(frozen=True)
class Rows:
    """The rows of a Jacobian that belong to one pair. They tell which pair, and where they begin and end."""

    pair: Pair
    first: int
    last: int


@dataclass(frozen=True)
class ConstraintEquations:
    """The equations of a mechanism: first what its pairs hold, then the drivers' coordinates.

    A state holds x, y (in parts of `size`) and theta (radians) of every moving link, in the order of the mechanism. A
    multiple pin is a star of pairs around the first of its links. Rows are scaled to the length 1.
    """

    mechanism: Mechanism
    tolerance: Tolerance = STRICT

    @cached_property
    def links(self) -> tuple[str, ...]:
        """The moving links."""
        return tuple(name for name in self.mechanism.links if name != FRAME)

    @cached_property
    def pairs(self) -> tuple[Pair, ...]:
        """Every pair, the pins first."""
        return (*self.pins, *self.mechanism.written_pairs)

    @cached_property
    def pins(self) -> tuple[Pair, ...]:
        """The pairs at pins."""
        pins = Pins(self.mechanism)
        named = self.mechanism.pins.items()
        return tuple(pins.pair(letter, names[0], name) for letter, names in named for name in names[1:])

    @cached_property
    def driven(self) -> tuple[Drivable, ...]:
        """The pair of every driver."""
        pins = Pins(self.mechanism)
        return tuple(driven_pair(pins, drive) for drive in self.mechanism.drives)

    @cached_property
    def size(self) -> float:
        """The mechanism's length scale."""
        return self.mechanism.geometry.size

    @cached_property
    def rows(self) -> tuple[Rows, ...]:
        """The rows of each pair."""
        found, first = [], 0
        for pair in self.pairs:
            found.append(Rows(pair, first, first + pair.held))
            first += pair.held
        return tuple(found)

    @property
    def held(self) -> int:
        """How many coordinates the pairs hold."""
        return self.rows[-1].last if self.rows else 0

    @property
    def width(self) -> int:
        """How many numbers a state has."""
        return LINK_FREEDOMS * len(self.links)

    @cached_property
    def column(self) -> dict[str, int]:
        """The first column of every moving link."""
        return {name: LINK_FREEDOMS * k for k, name in enumerate(self.links)}

    @cached_property
    def ends(self) -> dict[str, Ends]:
        """The dimensions of every pair. Of several designs they are those of the first, at the first pose."""
        geometry = self.mechanism.geometry
        return {p.name: tuple(map(_first, p.ends(geometry))) for p in (*self.pairs, *self.driven)}

    def state(self, poses: Mapping[str, Pose]) -> Array:
        """Return the state in which the links have the given poses."""
        placed = (poses[name] for name in self.links)
        parts = [(p.z.c[0].real / self.size, p.z.c[0].imag / self.size, p.angle.c[0]) for p in placed]
        return np.array(parts, dtype=float).ravel()

    def poses(self, state: Array) -> dict[str, Pose]:
        """Return the poses of all links in a state."""
        found = {FRAME: FIXED}
        for name, k in self.column.items():
            angle = constant(float(state[k + 2]))
            found[name] = Pose(constant(complex(state[k], state[k + 1]) * self.size), angle.turn(), angle)
        return found

    def place(self, poses: dict[str, Pose], link: str, letter: str) -> complex:
        """Return where a point of a link is."""
        return complex(poses[link].at(_number(self.mechanism.geometry.points[link][letter])).c[0])

    def closures(self, state: Array) -> Array:
        """Return by how much every held coordinate is open, lengths in the user's unit."""
        poses = self.poses(state)
        return np.array(
            [
                float(np.real(c.c[0]))
                for pair in self.pairs
                for c in pair.closure(self.ends[pair.name], _of(pair, poses))
            ]
        )

    def coordinates(self, state: Array) -> Array:
        """Return the drivers' coordinates, as the drivers count them."""
        poses = self.poses(state)
        found = []
        for drive, pair in zip(self.mechanism.drives, self.driven, strict=True):
            value = pair.coordinate(self.ends[pair.name], _of(pair, poses)).c[0]
            found.append(float(np.real(value)) * pair.driven_by(drive.link))
        return np.array(found)

    def is_properly_assembled(self, state: Array) -> bool:
        """Tell whether every closed pair is in the way that is meant."""
        poses = self.poses(state)
        return all(
            bool(np.all(pair.is_properly_assembled(self.ends[pair.name], _of(pair, poses)))) for pair in self.pairs
        )

    def jacobian(self, state: Array) -> tuple[Array, Array]:
        """Return the rows of all pairs by the state, each of the length 1. Return also by what each was divided."""
        poses = self.poses(state)
        tables = ((pair, pair.jacobian(self.ends[pair.name], _of(pair, poses))) for pair in self.pairs)
        return self._scaled(self._filled((pair, table[..., : pair.held, :]) for pair, table in tables), self.size)

    def driving(self, state: Array) -> Array:
        """Return the rows of the drivers' coordinates, each of the length 1. They are by the state."""
        poses = self.poses(state)
        tables = ((pair, pair.jacobian(self.ends[pair.name], _of(pair, poses))) for pair in self.driven)
        coordinate = ((pair, table[..., pair.held : pair.held + 1, :]) for pair, table in tables)
        return self._scaled(self._filled(coordinate), self.size)[0]

    @cached_property
    def generic(self) -> Array:
        """The rows of all pairs at random geometry. They are the same kinds of pairs between the same links."""
        rng = np.random.default_rng(SEED)
        places: dict[str, Ends] = {}
        tables = []
        for number, pair in enumerate(self.pairs):
            # all links on a pin share its one place
            at = f"pin {pair.letters[0]}" if number < len(self.pins) else f"pair {pair.name}"
            ends = places.setdefault(at, pair.generic(rng))
            tables.append((pair, generic_jacobian(pair, ends)[..., : pair.held, :]))
        return self._scaled(self._filled(tables), 1.0)[0]

    def _filled(self, tables: Iterable[tuple[Pair, Any]]) -> Array:
        blocks = [(pair, np.asarray(one, float).reshape(-1, LINK_FREEDOMS * len(pair.members))) for pair, one in tables]
        filled, first = np.zeros((sum(len(block) for _, block in blocks), self.width)), 0
        for pair, block in blocks:
            rows = filled[first : first + len(block)]
            first += len(block)
            for side, name in enumerate(pair.members):
                if name in self.column:
                    part = block[:, LINK_FREEDOMS * side : LINK_FREEDOMS * (side + 1)]
                    rows[:, self.column[name] : self.column[name] + LINK_FREEDOMS] += part
        return filled

    def _scaled(self, matrix: Array, size: float) -> tuple[Array, Array]:
        matrix = matrix * np.tile([size, size, 1.0], len(self.links))
        lengths = np.linalg.norm(matrix, axis=1)
        lengths = np.where(lengths > 0.0, lengths, 1.0)
        return matrix / lengths[:, None], lengths


def _of(pair: Pair, poses: dict[str, Pose]) -> tuple[Pose, ...]:
    return tuple(poses[name] for name in pair.members)


def _first(end: End) -> End:
    return End(*(None if value is None else _number(value) for value in end))


def _number(value: Any) -> Any:
    return np.asarray(first_entry(value)).item()
