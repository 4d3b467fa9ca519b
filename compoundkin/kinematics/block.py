"""Blocks: some designs x some poses while they are solved, their limit positions, and how they are joined again."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import factorial
from typing import TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.buffers import arrays_of_one_buffer
from compoundkin.base.poses import FIXED, End, Pose
from compoundkin.base.series import Series
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs.contract import Ends
from compoundkin.structure.mobility_count import Body

# So many poses are solved at once: their arrays stay in a second-level cache of 2 MB, and the calls take far less
# time than the work.
BLOCK = 16384


# Below this fraction of its largest terms a discriminant is zero: rounding of a limit position, where
# the group is stretched or folded. A few hundred units in the last place of the terms it is the difference of.
LIMIT = 1e-13


def clipped_root(discriminant: Series, scale: Number) -> tuple[Series, Number]:
    """Return the square root and the margin.

    The root is zero for a discriminant that is zero but for rounding, NaN below it.

    >>> from compoundkin.base.series import constant
    >>> value, margin = clipped_root(constant(np.array([4.0, -1e-15])), 1.0)
    >>> value.c[0].tolist()
    [2.0, 0.0]
    """
    margin = np.divide(discriminant.c[0], scale) + LIMIT
    clipped = np.where(margin >= 0, np.maximum(discriminant.c[0], 0.0), np.nan)
    return Series((clipped, *discriminant.c[1:])).sqrt(), margin


# The name under which the sizes of designs go with the sides of pairs, where they are not alike. No pair has it.
SIZES = ""


def size_in(ends: Mapping[str, Ends], size: float) -> Number:
    """Return the length scale of each design by the sides of pairs, (designs, 1); or that which all share.

    >>> float(size_in({SIZES: (End(np.array([[2.0], [3.0]])),)}, 3.0)[0, 0]), size_in({}, 3.0)
    (2.0, 3.0)
    """
    own = ends.get(SIZES)
    return size if own is None else own[0].point


# Corrections above this (of the size, or radians) leave the region where Newton's answer is a neighbour.
LEAP = 0.5


@dataclass(frozen=True)
class LimitRule:
    """The rule at limit positions.

    It tells the root of closed forms, how far Newton may go from where it begins, and whether a state from which Newton
    does not converge is kept as it is, instead of none.
    """

    root: Root
    leap: float = LEAP
    keeps_states: bool = False


# Beyond a limit there is no pose.
CLIPPED = LimitRule(clipped_root)


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

    def leading(self, names: Iterable[str] | None = None, order: int = 0) -> Block:
        """Return the same block to an order only. What is known is of the named links only, or of all.

        Groups name theirs: work on all links for every group would grow as the square of the links.
        """
        names = None if names is None else tuple(names)
        world, local = (
            {name: known[name].trimmed(order) for name in (known if names is None else names) if name in known}
            for known in (self.world, self.local)
        )
        return replace(self, world=world, local=local, order=order, margins={})

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
            new = np.ravel(other.c[k]) if k < len(other.c) else 0.0
            old = series.c[k] if k < len(series.c) else 0.0 * series.c[0]
            full = np.array(np.broadcast_to(old, shape), dtype=np.result_type(old, new))
            full[at] = new
            out.append(full)
        return Series(tuple(out))

    def mended(pose: Pose, other: Pose) -> Pose:
        known = pose.theta is not None and other.theta is not None
        return Pose(put(pose.z, other.z), put(pose.u, other.u), put(pose.angle, other.angle) if known else None)

    return {name: pose if name == FRAME else mended(pose, others[name]) for name, pose in poses.items()}


# Rounds in which the smooth root of a square settles: each gains a power of the way to its zero, some hundredths.
ROUNDS = 8


# A seed is at its configuration within this (of the size, or radians), or Newton has left it.
ASTRAY = 0.1


# How a closed form takes the square root of a discriminant: (discriminant, scale) -> (root, margin).
Root: TypeAlias = Callable[[Series, Number], tuple[Series, Number]]


def nearest_root(discriminant: Series, scale: Number) -> tuple[Series, Number]:
    """Return the square root, or zero. That is the nearest approach where a group cannot be assembled."""
    lead = np.maximum(discriminant.c[0], 0.0)
    return Series((lead, *discriminant.c[1:])).sqrt(), np.ones_like(lead)


def edge_root(discriminant: Series, scale: Number) -> tuple[Series, Number]:
    """Return the square root, zero beyond a limit position.

    The margin itself, whose zero is the limit, is returned too.
    """
    lead = np.maximum(discriminant.c[0], 0.0)
    return Series((lead, *discriminant.c[1:])).sqrt(), np.divide(discriminant.c[0], scale)


def recorded_root(notes: list[Series]) -> Root:
    """Return the clipped root that notes its discriminants, in parts of their scale."""

    def root(discriminant: Series, scale: Number) -> tuple[Series, Number]:
        notes.append(Series(tuple(np.divide(c, scale) for c in discriminant.c)))
        return clipped_root(discriminant, scale)

    return root


def signed_root(where: Number, sign: Number) -> Root:
    """Return the root that is smooth where asked: the discriminant is its square.

    It has a sign, before which its first rate is positive.
    """

    def root(discriminant: Series, scale: Number) -> tuple[Series, Number]:
        plain, margin = clipped_root(discriminant, scale)
        size = np.sqrt(scale)
        smooth = [c * size * sign for c in root_of_square(tuple(np.divide(c, scale) for c in discriminant.c))]
        both = zip([*smooth, np.zeros_like(margin)], plain.c, strict=True)
        return Series(tuple([np.where(where, t, p) for t, p in both])), margin

    return root


def root_of_square(c: tuple[Number, ...]) -> list[Number]:
    """Return the coefficients, one fewer, of a smooth function whose square has these.

    The function is near its zero, and grows: of the square itself nothing is left there but rounding, so that all is
    taken from its rates. Each round takes on another power of the way to the zero; the last coefficients need those
    that are not known, and mean less.

    >>> [float(r) for r in root_of_square((0.0001, 0.02, 1.0, 0.0, 0.0))]  # of 0.01 + t
    [0.01, 1.0, 0.0, 0.0]
    """
    n = len(c) - 1
    r: list[Number] = [0.0] * (n + 1)
    for _ in range(ROUNDS):
        r[1] = np.sqrt(c[2] - 2.0 * r[0] * r[2])
        half = 0.5 / r[1]
        r[0] = c[1] * half
        for j in range(2, n):
            inner = sum((r[i] * r[j + 1 - i] for i in range(2, j)), 2.0 * r[0] * r[j + 1])
            r[j] = (c[j + 1] - inner) * half
    return r[:n]


# Beyond a limit a closed form is at its nearest approach: to choose between modes.
NEAREST = LimitRule(nearest_root)


# Poses are known to be at a limit or before it; Newton cannot converge at the limit itself.
EDGE = LimitRule(edge_root, ASTRAY, keeps_states=True)


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
        # a block of all is kept as it is
        self._all: Mapping[str, Pose] | None = None
        self._fixed: dict[str, bool] = {}
        # by link and z, u or theta: the coefficients over all blocks
        self._found: dict[tuple[str, str], list[Number]] = {}

    def take(self, block: Block, designs: slice, poses: slice) -> None:
        """Add a block."""
        self.failed[designs, poses] = block.failed
        if block.shape == self.shape:
            self._all = block.world
            return
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
        if self._all is not None:
            return dict(self._all)

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


def rectangle(value: Number, designs: slice, poses: slice) -> Number:
    """Return what of a value belongs to a rectangle of designs and poses."""
    if np.ndim(value) == 0:
        return value
    return value[designs if value.shape[0] > 1 else slice(None), poses if value.shape[1] > 1 else slice(None)]


def repeated(value: Number, copies: int) -> Number:
    """Return a value of several copies of all designs, one after another; what all designs share stays as it is.

    >>> repeated(np.array([[1.0], [2.0]]), 2).tolist(), repeated(3.0, 2)
    ([[1.0], [2.0], [1.0], [2.0]], 3.0)
    """
    return np.tile(value, (copies, 1)) if copies > 1 and np.ndim(value) and len(value) > 1 else value


def between_poses(value: Number, i: Number, weight: Number) -> Number:
    """Return a value of all designs between the poses `i` and the next ones."""
    if np.ndim(value) == 0 or value.shape[1] == 1:
        return value
    return value[:, i] * (1.0 - weight) + value[:, i + 1] * weight


def picked(value: Number, designs: Number, i: Number, weight: Number) -> Number:
    """Return a value of some designs after their poses `i`, as a column."""
    if np.ndim(value) == 0:
        return value
    if value.shape[1] == 1:
        return value[_rows(value, designs), :1]
    if len(value) == 1:
        # a row is read in less time than a table
        before, after = value[0].take(i), value[0].take(i + 1)
    else:
        before, after = value[designs, i], value[designs, i + 1]
    return (before * (1.0 - weight) + after * weight)[:, None]


def picked_slope(value: Number, designs: Number, i: Number) -> Number:
    """Return by how much values of some designs change after their poses `i`."""
    if np.ndim(value) == 0 or value.shape[1] == 1:
        return 0.0
    rows = _rows(value, designs)
    return (value[rows, i + 1] - value[rows, i])[:, None]


def _rows(value: Number, designs: Number) -> Number:
    return designs if value.shape[0] > 1 else np.zeros_like(designs)


def slope(value: Number, i: Number) -> Number:
    """Return by how much a value of all designs changes after the poses `i`."""
    if np.ndim(value) == 0 or value.shape[1] == 1:
        return 0.0
    return value[:, i + 1] - value[:, i]
