"""Gathers the poses of the links, solved block by block, into arrays over all designs and poses."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Number, Series


class Gathering:
    """The arrays to which blocks are added; complete when all blocks have been.

    A coefficient that is a number in every block stays one, and one that does not change with the design
    or along the motion is kept at its own size.

    >>> found = Gathering(1, 4)
    >>> for m in (slice(0, 2), slice(2, 4)):
    ...     world = {"slider": Pose(Series((np.array([[0j, 1j]]), 1j)), FIXED.u)}
    ...     found.take(world, np.zeros((1, 2)), slice(0, 1), m)
    >>> found.poses()["slider"].z.c
    (array([[0.+0.j, 0.+1.j, 0.+0.j, 0.+1.j]]), 1j)
    """

    def __init__(self, designs: int, poses: int) -> None:
        self.shape = (designs, poses)
        self.failed = np.empty(self.shape, dtype=np.int32)
        self._fixed: dict[str, bool] = {}
        # by link and z or u: the coefficients over all blocks
        self._found: dict[tuple[str, str], list[Number]] = {}

    def take(self, world: Mapping[str, Pose], failed: Number, designs: slice, poses: slice) -> None:
        """Add a block."""
        self.failed[designs, poses] = failed
        for link, pose in world.items():
            self._fixed[link] = pose is FIXED
            sides = (("z", pose.z), ("u", pose.u), ("theta", pose.theta))
            for name, series in ((name, series) for name, series in sides if series is not None):
                found = self._found.setdefault((link, name), [None] * len(series.c))
                for k, c in enumerate(series.c):
                    found[k] = self._with(found[k], c, designs, poses)

    def poses(self) -> dict[str, Pose]:
        """The links' poses over all blocks."""

        def gathered(link: str, name: str) -> Series:
            return Series(tuple(self._found[link, name]))

        def angle(link: str) -> Series | None:
            return gathered(link, "theta") if (link, "theta") in self._found else None

        return {
            link: FIXED if fixed else Pose(gathered(link, "z"), gathered(link, "u"), angle(link))
            for link, fixed in self._fixed.items()
        }

    def _with(self, whole: Number, part: Number, designs: slice, poses: slice) -> Number:
        """A coefficient with the part of a block put in; None where there is none yet."""
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
        """The shape over all blocks; a block of one row does not show that all rows are equal."""
        block = (designs.stop - designs.start, poses.stop - poses.start)
        return tuple(n if p > 1 or b == 1 else 1 for n, p, b in zip(self.shape, part, block, strict=bool(part)))
