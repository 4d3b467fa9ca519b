"""Rates of quantities when each driver alone moves at unit speed: the columns of a Jacobian, in a motion's poses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar, NamedTuple, Protocol

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem, UnknownName
from compoundkin.kinematics.block import Block, blocks, places
from compoundkin.kinematics.double_roots import rates_at
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.joined_blocks import JoinedBlocks
from compoundkin.kinematics.quantities import Quantity, quantity, whole_and_part
from compoundkin.kinematics.table import AtPoses
from compoundkin.kinematics.tracking import Tracker
from compoundkin.model.attributes import LENGTH, RATE_OF, derivative_order, unit_of
from compoundkin.structure.kinematic_structure import Structure


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
    def tracker(self) -> Tracker:
        """What keeps its configuration."""

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
    if s is None and motion.is_whole and len(given.drives) == 1 and motion.tracker.expanded is not None:
        with np.errstate(all="ignore"):
            return found.mended(*rates_at(given, motion.tracker, order))
    return found


def undetermined(motion: Solved) -> Number:
    """Return the change points where drivers together tell the rates, (designs, poses)."""
    found = np.zeros(motion.assembled.shape, dtype=bool).reshape(motion.inputs.designs, motion.inputs.poses)
    if motion.tracker.expanded is not None and len(motion.inputs.drives) > 1:
        found[motion.tracker.expanded[:2]] = True
    return found
