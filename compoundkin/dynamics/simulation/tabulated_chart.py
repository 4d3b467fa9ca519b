"""One free driver in a table of its coordinate: the same equation of motion, read off instead of solved."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.arrays import TURN, Number
from compoundkin.base.errors import InvalidInput
from compoundkin.base.poses import Pose
from compoundkin.dynamics.loaded_block import loaded_blocks
from compoundkin.dynamics.simulation.drive_table import DriveTable, drive_table
from compoundkin.dynamics.simulation.driver_chart import DriverChart
from compoundkin.dynamics.simulation.driver_state import Rates
from compoundkin.dynamics.simulation.loaded_state import loaded_state
from compoundkin.dynamics.simulation.table_piece import TablePiece
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.configuration import Configuration, dimensions_at, placed_at
from compoundkin.model.loads.contract import Load

# A pair that moves so many times as fast as a driver (each by its scale) is better to go on with: squares of this enter
# the equation of motion, and twice as many of its digits are lost.
FASTER = 30.0
# Poses a whole turn apart are the same within this part of the size.
SAME = 1e-9
# A table reaches so far to both sides: half a turn, or this part of the size.
REACH = 0.5


class TabulatedChart(DriverChart):
    """The chart of one free driver. Where its table does not hold, states are solved as ever."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.is_angle = self.start.structure.driven_angles[self.free[0]]
        self.reach = TURN / 2.0 if self.is_angle else REACH * self.order.size
        self.timeless = tuple(tuple(load for load in loads if self._is_timeless(load)) for loads in self.loads)
        self.others = tuple(tuple(load for load in loads if load not in known)
                            for loads, known in zip(self.loads, self.timeless, strict=True))  # fmt: skip
        self.table: DriveTable | None = None
        self.wraps = False
        first = {name: float(np.ravel(v[0])[0]) for name, v in self.start.inputs.drives.items()}[self.free[0]]
        self._tabulate(first, self.start.poses)

    def _is_timeless(self, load: Load) -> bool:
        """Whether a load depends on the pose alone."""
        if load.needs_rates:
            return False
        try:
            list(load.wrenches(next(iter(loaded_blocks(self.start)))))
        except InvalidInput:  # it asks for the time, and the first pose has none
            return False
        return True

    def rates(self, time: float, values: Number, speeds: Number) -> Rates:
        """Return what a state grows by."""
        value, speed = float(values[0]), float(speeds[0])
        piece, value = self._piece(value)
        if piece is None:
            return super().rates(time, values, speeds)
        basis = piece.basis(value)
        inertia, bias, stored, other = (piece.terms @ basis).tolist()
        if self.has_others:
            more = self._exact(piece, basis, time, values, speed)
            stored, other = stored + more[0], other + more[1]
        return Rates(np.array([(stored + other - bias * speed * speed) / inertia]), other * speed)

    @cached_property
    def has_others(self) -> bool:
        """Whether some loads depend on time or speed."""
        return any(self.others)

    def _exact(self, piece: TablePiece, basis: Number, time: float, values: Number, speed: float) -> list[float]:
        """Return the forces of loads that depend on time or speed."""
        columns = _Columns(piece, basis, speed)
        block = Block((2, 1), self.ends, columns, {}, 1)
        at = loaded_state(self.start, block, time, 1, lambda pair, angle: self.turns_of(pair, angle, values))
        return [float(at.along(loads)[0]) for loads in self.others]

    @property
    def memory(self) -> tuple[Any, ...]:
        """What keeps the configuration, the table among it."""
        return (*super().memory, self.table, self.wraps)

    def recall(self, memory: tuple[Any, ...]) -> None:
        """Go back to a configuration that was kept."""
        super().recall(memory)
        self.table, self.wraps = memory[3:]

    def accept(self, time: float, values: Number, speeds: Number) -> None:
        """Follow the configuration to a state that is reached."""
        value = float(values[0])
        table = self.table
        if self.turned or table is None or self._piece(value)[0] is None:
            super().accept(time, values, speeds)
        if table is not None and not self.wraps and not table.low < value < table.high:
            self._tabulate(value, self.state(time, values, speeds).block.world)

    def sign(self, k: int, values: Number) -> float:
        """Return the sign of a dyad's mode. It changes where the motion of the table passes a change point."""
        table = self.table
        if table is None or k not in table.motion.change_points:
            return super().sign(k, values)
        value = table.low + (float(values[0]) - table.low) % TURN if self.wraps else float(values[0])
        return table.sign(k, value)

    def is_regular(self, values: Number) -> bool:
        """Tell whether no pair moves much faster than the driver."""
        piece, _ = self._piece(float(values[0]))
        return piece is not None and piece.ratio < FASTER

    def _piece(self, value: float) -> tuple[TablePiece | None, float]:
        table = self.table
        if table is None:
            return None, value
        if self.wraps:
            value = table.low + (value - table.low) % TURN
        return table.piece(value), value

    def _tabulate(self, value: float, poses: Mapping[str, Pose]) -> None:
        """Make the table around a pose."""
        structure, name = self.start.structure, self.free[0]
        here = Configuration(structure, {name: value}, placed_at(poses, (0, 0)), {}, {},
                             dimensions_at(structure, 0, 0))  # fmt: skip
        ends = value - self.reach, value + self.reach
        self.table = drive_table(here, name, *ends, self.timeless, self.candidates)
        self.wraps = self.table is not None and self.is_angle and not self.order.turning and self._comes_back()

    def _comes_back(self) -> bool:
        """Whether all poses are the same after a whole turn."""
        assert self.table is not None
        motion = self.table.motion
        if motion.failed.any():
            return False
        for pose in motion.poses.values():
            for series, scale in ((pose.z, motion.size), (pose.u, 1.0)):
                row = np.ravel(series.c[0])
                if not abs(row[-1] - row[0]) < SAME * scale:
                    return False
        return True


class _Columns(dict[str, Pose]):
    """The poses of a piece at a value, made when asked for."""

    def __init__(self, piece: TablePiece, basis: Number, speed: float) -> None:
        super().__init__()
        self.piece, self.basis, self.speed = piece, basis, speed

    def __missing__(self, link: str) -> Pose:
        found = self[link] = self.piece.pose(link, self.basis, self.speed)
        return found
