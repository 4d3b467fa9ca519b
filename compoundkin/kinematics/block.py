"""A block of poses while it is solved, and how a motion is cut into blocks."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from math import factorial

import numpy as np

from compoundkin.base.poses import Pose
from compoundkin.base.series import Number, Series
from compoundkin.kinematics.groups.general import Setting, trimmed
from compoundkin.structure.parts import Body


@dataclass
class Run:
    """A block of poses while it is solved: what is known so far, and the first group that did not close.

    `failed` holds that group's index plus one, 0 where all is closed so far.
    """

    setting: Setting
    world: dict[str, Pose]
    order: int
    drives: Mapping[str, Series]
    failed: Number = 0
    margins: dict[int, Number] = field(default_factory=dict)

    def copy(self) -> Run:
        """The same block, to try a group on."""
        world = dict(self.world)
        setting = Setting(self.setting.ends, world, self.setting.local)
        return Run(setting, world, self.order, self.drives, self.failed)

    def leading(self, names: Iterable[str]) -> Run:
        """The same block without derivatives, to try a group on: of what is known the named links only."""
        world = {name: trimmed(self.world[name], 0) for name in names if name in self.world}
        local = {name: trimmed(pose, 0) for name, pose in self.setting.local.items()}
        return Run(Setting(self.setting.ends, world, local), world, 0, self.drives, self.failed)

    def links_of(self, body: Body, pose: Pose) -> dict[str, Pose]:
        """The poses of a body's links from that of its base."""
        local = self.setting.local
        return {link: pose.compose(local[link]) if link in local else pose for link in body.links}

    def publish(self, body: Body, pose: Pose) -> None:
        """Add the links of a body whose pose is found to what is known."""
        self.world.update(self.links_of(body, pose))


def rates(values: tuple[Number, ...], order: int) -> Series:
    """A driver's series from its value and rates (value, speed, acceleration, jerk).

    >>> rates((1.0, 2.0, 6.0, 0.0), 2).c
    (1.0, 2.0, 3.0)
    """
    padded = [*values[: order + 1], *[0.0] * (order + 1 - len(values))]
    return Series(tuple([v / factorial(k) if k > 1 else v for k, v in enumerate(padded)]))


def places(designs: slice, poses: slice) -> tuple[Number, Number]:
    """The places along the motion (a row) and the design indices (a column) of a block.

    >>> [array.shape for array in places(slice(0, 2), slice(4, 7))]
    [(1, 3), (2, 1)]
    """
    return np.arange(poses.start, poses.stop, dtype=float)[None], np.arange(designs.start, designs.stop)[:, None]


def blocks(designs: int, poses: int, size: int) -> Iterator[tuple[slice, slice]]:
    """Rectangles of at most `size` poses, much of one width, that cover designs x poses, along the motion first.

    >>> list(blocks(1, 5, 3))
    [(slice(0, 1, None), slice(0, 3, None)), (slice(0, 1, None), slice(3, 5, None))]
    """
    high = max(1, size // max(poses, 1))
    wide = -(-poses // -(-poses // size)) if poses else size
    for d in range(0, designs, high):
        for m in range(0, poses, wide):
            yield slice(d, min(d + high, designs)), slice(m, min(m + wide, poses))
