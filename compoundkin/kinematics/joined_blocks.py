"""Blocks put together again: the arrays of a motion that was solved in several, in one buffer."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.buffers import arrays_of_one_buffer
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series
from compoundkin.kinematics.block import Block


class JoinedBlocks:
    """The arrays to which blocks are added; complete when all blocks have been.

    A coefficient that is a number in every block stays one, and one that does not change with the design
    or along the motion is kept at its own size. The arrays share one buffer, and links share those that are one.

    >>> found = JoinedBlocks(1, 4)
    >>> for m in (slice(0, 2), slice(2, 4)):
    ...     world = {"slider": Pose(Series((np.array([[0j, 1j]]), 1j)), FIXED.u)}
    ...     found.take(Block((1, 2), {}, world, {}, 1), slice(0, 1), m)
    >>> found.poses()["slider"].z.c
    (array([[0.+0.j, 0.+1.j, 0.+0.j, 0.+1.j]]), 1j)
    """

    def __init__(self, designs: int, poses: int) -> None:
        self.shape = (designs, poses)
        self.failed = np.empty(self.shape, dtype=np.int32)
        self._fixed: dict[str, bool] = {}
        # by link and z, u or theta: the coefficients over all blocks
        self._found: dict[tuple[str, str], list[Number]] = {}

    def take(self, block: Block, designs: slice, poses: slice) -> None:
        """Add a block."""
        self.failed[designs, poses] = block.failed
        self._fixed.update({link: pose is FIXED for link, pose in block.world.items()})
        parts = dict(_series(block.world))
        if not self._found:
            self._begin(parts, designs, poses)
        # what is in which array now: links may share one, and one that no longer does gets its own
        filled: dict[int, Number] = {}
        for key, series in parts.items():
            found = self._found.setdefault(key, [None] * len(series.c))
            for k, part in enumerate(series.c):
                there = filled.get(id(found[k]))
                if there is None or there is not part:
                    whole = found[k] if there is None else found[k].copy()
                    found[k] = self._with(whole, part, designs, poses)
                if isinstance(found[k], np.ndarray):
                    filled[id(found[k])] = part

    def poses(self) -> dict[str, Pose]:
        """Return the links' poses over all blocks."""

        def gathered(link: str, name: str) -> Series:
            return Series(tuple(self._found[link, name]))

        def angle(link: str) -> Series | None:
            return gathered(link, "theta") if (link, "theta") in self._found else None

        return {
            link: FIXED if fixed else Pose(gathered(link, "z"), gathered(link, "u"), angle(link))
            for link, fixed in self._fixed.items()
        }

    def _begin(self, parts: Mapping[tuple[str, str], Series], designs: slice, poses: slice) -> None:
        """Make room for the arrays of a first block: fresh memory costs most where it comes in many pieces."""
        arrays = {id(c): c for series in parts.values() for c in series.c if np.ndim(c)}
        wanted = ((self._needed(c.shape, designs, poses), c.dtype) for c in arrays.values())
        rooms = dict(zip(arrays, arrays_of_one_buffer(tuple(wanted)), strict=True))
        self._found = {key: [rooms.get(id(c)) for c in series.c] for key, series in parts.items()}

    def _with(self, whole: Number, part: Number, designs: slice, poses: slice) -> Number:
        """Return a coefficient with the part of a block put in; None where there is none yet."""
        if np.ndim(part) == 0 and (whole is None or np.ndim(whole) == 0):
            return part
        shape = np.broadcast_shapes(np.shape(whole), self._needed(np.shape(part), designs, poses))
        if whole is None:
            whole = np.empty(shape, dtype=np.result_type(part))
        elif np.shape(whole) != shape:
            whole = np.array(np.broadcast_to(whole, shape), dtype=np.result_type(part, whole))
        rows, columns = whole.shape
        whole[designs if rows > 1 else slice(None), poses if columns > 1 else slice(None)] = part
        return whole

    def _needed(self, part: tuple[int, ...], designs: slice, poses: slice) -> tuple[int, ...]:
        """Return the shape over all blocks; a block of one row does not show that all rows are equal."""
        block = (designs.stop - designs.start, poses.stop - poses.start)
        return tuple(n if p > 1 or b == 1 else 1 for n, p, b in zip(self.shape, part, block, strict=bool(part)))


def _series(world: Mapping[str, Pose]) -> Iterator[tuple[tuple[str, str], Series]]:
    for link, pose in world.items():
        for name, series in (("z", pose.z), ("u", pose.u), ("theta", pose.theta)):
            if series is not None:
                yield (link, name), series
