"""A block: some designs x some poses while they are solved; and how a motion is cut into blocks."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import factorial

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import FIXED, End, Pose
from compoundkin.base.series import Series
from compoundkin.kinematics.limits import CLIPPED, LimitRule, Root
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs.contract import Ends
from compoundkin.structure.parts import Body

# So many poses are solved at once: their arrays stay in a second-level cache of 2 MB, and the calls take far less
# time than the work.
BLOCK = 16384


@dataclass
class Block:
    """Some designs x some poses while they are solved. What is known so far, margins and the first failure.

    `ends[pair]` are the pair's sides on its links, `world[link]` the known poses, `local[link]` the pose of a link in
    its composite body (absent for the body's own base); all have derivatives to `order`. `shape` is designs x poses,
    before them an axis for each group of which several configurations are tried side by side: what is known may be
    smaller, where it does not change. `failed` is the index of the first group that does not close plus one, else 0;
    `margins` and the `meetings` of pins are by the groups' indices. `limits` holds at limit positions, but for groups
    that have `roots` of their own.
    """

    shape: tuple[int, ...]
    ends: Mapping[str, Ends]
    world: dict[str, Pose]
    local: Mapping[str, Pose]
    order: int
    limits: LimitRule = CLIPPED
    roots: Mapping[int, Root] = field(default_factory=dict)
    failed: Number = 0
    margins: dict[int, Number] = field(default_factory=dict)
    meetings: dict[int, Series] = field(default_factory=dict)

    def copy(self) -> Block:
        """Return the same block, to try a group on."""
        return replace(self, world=dict(self.world), margins={})

    def leading(self, names: Iterable[str] | None = None) -> Block:
        """Return the same block without derivatives. What is known is of the named links only, or of all."""
        names = self.world if names is None else names
        world = {name: self.world[name].trimmed(0) for name in names if name in self.world}
        local = {name: pose.trimmed(0) for name, pose in self.local.items()}
        return replace(self, world=world, local=local, order=0, margins={})

    def links_of(self, body: Body, pose: Pose) -> dict[str, Pose]:
        """Return the poses of a body's links from that of its base."""
        return {link: pose.compose(self.local[link]) if link in self.local else pose for link in body.links}

    def publish(self, body: Body, pose: Pose) -> None:
        """Add the links of a body whose pose is found to what is known."""
        self.world.update(self.links_of(body, pose))

    def in_body(self, link: str, end: End) -> End:
        """Return a link's side of a pair in its body's frame. The frame is that of the body's base link."""
        return self.local[link].carry(end) if link in self.local else end

    def root(self, index: int) -> Root:
        """Return how a group takes the square root in its closed form."""
        return self.roots.get(index, self.limits.root)

    def fail(self, good: Number, index: int) -> None:
        """Note that a group does not close where `good` is false. One that failed before it stays noted."""
        self.failed = np.where(good | (self.failed != 0), self.failed, index + 1)

    def extent(self, links: Iterable[str]) -> tuple[int, ...]:
        """Return the shape over which some known links vary. It is one in the axes of groups that do not move them."""
        values = (np.shape(c[0]) for name in links for c in (self.world[name].z.c, self.world[name].u.c))
        return np.broadcast_shapes((1,) * (len(self.shape) - 2) + self.shape[-2:], *values)


def rates(values: tuple[Number, ...], order: int) -> Series:
    """Return a driver's series from its value and rates (value, speed, acceleration, jerk).

    >>> rates((1.0, 2.0, 6.0, 0.0), 2).c
    (1.0, 2.0, 3.0)
    """
    padded = [*values[: order + 1], *[0.0] * (order + 1 - len(values))]
    return Series(tuple([v / factorial(k) if k > 1 else v for k, v in enumerate(padded)]))


def places(designs: slice, poses: slice) -> tuple[Number, Number]:
    """Return the places along the motion and the design indices of a block. The first is a row, the second a column.

    >>> [array.shape for array in places(slice(0, 2), slice(4, 7))]
    [(1, 3), (2, 1)]
    """
    return np.arange(poses.start, poses.stop, dtype=float)[None], np.arange(designs.start, designs.stop)[:, None]


def blocks(designs: int, poses: int, size: int = BLOCK) -> Iterator[tuple[slice, slice]]:
    """Yield rectangles of at most `size` poses that cover designs x poses.

    They are much of one width, along the motion first.

    >>> list(blocks(1, 5, 3))
    [(slice(0, 1, None), slice(0, 3, None)), (slice(0, 1, None), slice(3, 5, None))]
    """
    high = max(1, size // max(poses, 1))
    wide = -(-poses // -(-poses // size)) if poses else size
    for d in range(0, designs, high):
        for m in range(0, poses, wide):
            yield slice(d, min(d + high, designs)), slice(m, min(m + wide, poses))


def poses_at(poses: Mapping[str, Pose], shape: tuple[int, ...], designs: Number, index: Number) -> dict[str, Pose]:
    """Pick the poses of links at some designs and indices, as columns.

    >>> slider = Pose(Series((np.array([[0j, 1j]]), 1j)), FIXED.u)
    >>> poses_at({"slider": slider}, (1, 2), np.array([0]), np.array([1]))["slider"].z.c[0]
    array([[0.+1.j]])
    """

    def some(series: Series) -> Series:
        return Series(tuple([np.broadcast_to(c, shape)[designs, index][:, None] for c in series.c]))

    return {name: pose if pose is FIXED else pose.mapped(some) for name, pose in poses.items()}


def with_poses(
    poses: Mapping[str, Pose], shape: tuple[int, int], order: int, at: tuple[Number, Number], others: Mapping[str, Pose]
) -> dict[str, Pose]:
    """Return poses of links with others in their place, at some designs and indices."""

    def put(series: Series, other: Series) -> Series:
        out = []
        for k in range(order + 1):
            full = np.array(np.broadcast_to(series.c[k] if k < len(series.c) else 0.0 * series.c[0], shape))
            full[at] = np.ravel(other.c[k]) if k < len(other.c) else 0.0
            out.append(full)
        return Series(tuple(out))

    def mended(pose: Pose, other: Pose) -> Pose:
        known = pose.theta is not None and other.theta is not None
        return Pose(put(pose.z, other.z), put(pose.u, other.u), put(pose.angle, other.angle) if known else None)

    return {name: pose if name == FRAME else mended(pose, others[name]) for name, pose in poses.items()}
