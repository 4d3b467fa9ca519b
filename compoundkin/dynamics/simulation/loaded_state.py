"""One state of a simulation with all that loads ask for, and the forces along the drivers' coordinates."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series
from compoundkin.dynamics.loaded_block import LoadedBlock
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.motion import Motion
from compoundkin.model.loads.contract import Load
from compoundkin.model.pairs import Pair

ONLY = slice(0, 1)


class TrueRates(dict[str, Pose]):
    """Poses as plain numbers, made when asked for. Their rates are the true ones, the last of each column."""

    def __init__(self, world: dict[str, Pose]) -> None:
        super().__init__()
        self.columns = world

    def __missing__(self, link: str) -> Pose:
        pose = self.columns[link]
        found = self[link] = pose if pose is FIXED else Pose(_true(pose.z), _true(pose.u))
        return found


@dataclass(frozen=True, eq=False)
class LoadedState(LoadedBlock):
    """A single pose. It answers what loads ask for, and what they do along each of `count` coordinates.

    Each pose of `columns` has in its rates those at unit rate of every coordinate, and last the true ones; the block
    has these alone. `turns` gives an angle of a pair the full turns that it has made.
    """

    columns: dict[str, Pose] | None = None
    seconds: float = 0.0
    count: int = 0
    turns: Callable[[str, float], float] | None = None

    @property
    def time(self) -> Number | None:
        """The time in seconds."""
        return np.array([[self.seconds]])

    def fitted(self, value: Any, where: str = "load") -> Number:
        """Return a single number. Raises InvalidInput for an array along a motion."""
        if isinstance(value, float | complex | int):
            return value
        if np.size(value) != 1:
            what = "it is given pose by pose, and the poses of a simulation are not known before"
            raise InvalidInput(Problem(where, what, "give a number, a function of time or a table"))
        return np.ravel(value)[0].item()

    def along(self, loads: Iterable[Load]) -> Number:
        """Return the forces of loads along each coordinate."""
        total = np.zeros(self.count)
        for load in loads:
            for link, wrench in load.wrenches(self):
                total += np.ravel(self.freed(link, wrench).power(self._unit(link)))
        return total

    def _unit(self, link: str) -> Pose:
        """Return the pose of a link with its rates at unit rate of each coordinate."""
        assert self.columns is not None
        pose = self.columns[link]
        return pose if pose is FIXED else Pose(self._rows(pose.z), self._rows(pose.u))

    def _rows(self, series: Series) -> Series:
        rates = [np.ravel(c)[: self.count] for c in series.c[1:2]]
        return Series((_number(series.c[0]), *rates))

    def _counted(self, pair: Pair) -> Number:
        """Return an angle with its turns."""
        assert self.turns is not None
        found = pair.coordinate(self._ends(pair), self._poses(pair))
        return self.turns(pair.name, float(np.ravel(found.c[0])[0]))


def loaded_state(
    motion: Motion, block: Block, seconds: float, count: int, turns: Callable[[str, float], float]
) -> LoadedState:
    """Return what loads ask for at a state of a block of columns."""
    true = Block((1, 1), block.ends, TrueRates(block.world), {}, 1)
    return LoadedState(motion, true, ONLY, ONLY, columns=block.world, seconds=seconds, count=count, turns=turns)


def _true(series: Series) -> Series:
    return Series((_number(series.c[0]), *[_number(c, -1) for c in series.c[1:2]]))


def _number(value: Number, at: int = 0) -> Number:
    return value.item(at) if isinstance(value, np.ndarray) else value
