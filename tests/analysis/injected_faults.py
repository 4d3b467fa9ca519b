"""Motions that are wrong in a known way, made from right ones: what `verify` must tell from what is right."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series, constant
from compoundkin.kinematics import Motion
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.curve.followed_poses import FollowedPoses
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.solving_order import run
from compoundkin.model.geometry import FRAME

# Other configurations nearer than this (of the size, or radians) are the same: the pose is next to where they meet.
APART = 1e-3


@dataclass(frozen=True)
class Flipped:
    """The motion's own configurations, but another one for one group: its other sign, or a state."""

    followed: FollowedPoses
    designs: np.ndarray
    s: np.ndarray
    index: int
    state: np.ndarray | None

    def mode(self, block: Block, solver: GroupSolver) -> np.ndarray:
        if solver.index == self.index and self.state is not None:
            return self.state
        if solver.is_numbered:
            return self.followed.curve.paths[solver.index].seeds(self.designs, self.places)
        sign = self.followed.sign(solver.index, self.designs, self.s)
        return -sign if solver.index == self.index else sign

    def angle(self, solver: GroupSolver, link: str) -> np.ndarray | None:
        turns = self.followed.curve.turns.get(link)
        return None if turns is None else turns.near(self.designs, self.places)

    @property
    def places(self) -> np.ndarray:
        return self.followed.places_on_path(self.designs, self.s)


def flipped(motion: Motion, solver: GroupSolver, index: np.ndarray) -> tuple[np.ndarray, dict[str, Pose]]:
    """Poses with a group in another configuration, all that hangs on it assembled anew; and which of them exist."""
    designs, s = np.zeros((len(index), 1), dtype=int), index[:, None].astype(float)
    part = motion.inputs.pick(designs[:, 0], s[:, 0])
    order = motion.solving_order
    block = order.start(part.ends, part.series(motion.order), motion.order, (len(index), 1))
    state = None
    if solver.is_numbered:
        own = motion.block(part, 0, s, designs)
        state = another(solver, own)
    with np.errstate(all="ignore"):
        run(order, block, Flipped(motion.followed, designs, s, solver.index, state))
    there = np.broadcast_to(block.failed == 0, (len(index), 1))[:, 0]
    for link in solver.group.links:
        for c in (*block.world[link].z.c, *block.world[link].u.c):
            there = there & np.isfinite(np.broadcast_to(c, (len(index), 1))[:, 0])
    away = apart(motion, index, block.world, solver.group.links)
    return there & (away > APART), dict(block.world)


def another(solver: GroupSolver, block: Block) -> np.ndarray:
    """A state of a numbered group other than the one a block of poses is in, NaN where there is none."""
    every, equations = solver.every(block.leading()), solver.equations
    assert equations is not None
    own = [block.world[body.links[0]] for body in solver.group.bodies]
    best, found = np.full((len(every.real), 1), APART), np.full((len(every.real), 1, equations.width), np.nan)
    for j in range(every.real.shape[-1]):
        bodies = [Pose(constant(p.z.c[0][..., j]), constant(p.u.c[0][..., j])) for p in every.bodies.values()]
        away = sum(np.abs(b.u.c[0] - o.u.c[0]) for b, o in zip(bodies, own, strict=True))
        better = every.real[..., j] & (away > best)
        found = np.where(better[..., None], equations.state(bodies), found)
        best = np.where(better, away, best)
    return found


def apart(motion: Motion, index: np.ndarray, world: dict[str, Pose], links: tuple[str, ...]) -> np.ndarray:
    """How far links are from where the motion has them."""
    away = np.zeros(len(index))
    for link in links:
        for what, size in (("z", motion.size), ("u", 1.0)):
            here = np.broadcast_to(getattr(motion.poses[link], what).c[0], motion.failed.shape)[0, index]
            there = np.broadcast_to(getattr(world[link], what).c[0], (len(index), 1))[:, 0]
            away = np.maximum(away, np.abs(here - there) / size)
    return away


def with_poses(motion: Motion, index: np.ndarray, which: np.ndarray, world: dict[str, Pose]) -> Motion:
    """The motion with some of the poses put in its place."""

    def some(series: Series) -> Series:
        return Series(tuple(np.broadcast_to(c, (len(index), 1))[which] for c in series.c))

    poses = {
        name: pose
        if pose is FIXED
        else Pose(some(pose.z), some(pose.u), None if pose.theta is None else some(pose.theta))
        for name, pose in world.items()
    }
    return _as_certain(motion.mended(np.zeros(int(which.sum()), dtype=int), index[which], poses), motion)


def _as_certain(wrong: Motion, motion: Motion) -> Motion:
    """The estimate of errors depends on the mechanism alone, and need not be found for every fault anew."""
    wrong.__dict__["_errors"] = motion._errors
    return wrong


def flips(motion: Motion, most: int) -> Iterator[tuple[str, Motion]]:
    """Motions with one group on another configuration: at one pose, from one pose on, and throughout."""
    known = np.flatnonzero(motion.failed[0] == 0)
    free = [solver for solver in motion.solving_order.solvers if solver.modes != 1]
    for solver in free[:most]:
        there, world = flipped(motion, solver, known)
        name = "/".join(solver.group.links[:2])
        # a pose whose neighbours are there too, not the last
        inner = there & np.roll(there, 1) & np.roll(there, -1)
        inner[[0, -1]] = False
        if inner.any():
            one = np.zeros_like(there)
            one[np.flatnonzero(inner)[inner.sum() // 2]] = True
            yield f"{name} at one pose", with_poses(motion, known, one, world)
        ends = np.flatnonzero(~there)
        begin = max(len(there) // 2, int(ends[-1]) + 1 if len(ends) else 0)
        if begin < len(there) and solver.is_numbered is False:
            yield f"{name} from one pose on", with_poses(motion, known, np.arange(len(there)) >= begin, world)
        chosen = motion.chosen_by.get(solver.index) in ("drawing", "sign")
        if there.all() and chosen and not solver.is_numbered:
            yield f"{name} throughout", with_poses(motion, known, there, world)


def shifted(motion: Motion, link: str, what: str, change: complex, k: int, at: int) -> Motion:
    """The motion with one coefficient of a link's pose changed at one pose, by a part of the size or a factor."""
    pose = motion.poses[link]
    coefficients = list(getattr(pose, what).c)
    coefficients += [0j] * (motion.order + 1 - len(coefficients))
    array = np.array(np.broadcast_to(coefficients[k], motion.failed.shape), dtype=complex)
    array[0, at] = array[0, at] * change if k or what == "u" else array[0, at] + change * motion.size
    coefficients[k] = array
    parts = {"z": pose.z, "u": pose.u, what: Series(tuple(coefficients))}
    poses = {**motion.poses, link: Pose(parts["z"], parts["u"], pose.theta)}
    return _as_certain(replace(motion, poses=poses), motion)


def link_faults(motion: Motion) -> Iterator[tuple[str, Motion]]:
    """Motions with one link 1e-6 of the size or radians off at one pose, or its velocity by 0.1 %."""
    regular = np.flatnonzero(motion.regular[0])
    at = int(regular[len(regular) // 3])
    speeds = {n: _speed(motion, n, "z", at) for n in motion.poses}
    turns = {n: _speed(motion, n, "u", at) * motion.size for n in motion.poses}
    fastest = max([*speeds.values(), *turns.values()])
    for link in motion.poses:
        if link == FRAME:
            continue
        yield f"{link} moved", shifted(motion, link, "z", 1e-6 * np.exp(0.7j), 0, at)
        yield f"{link} turned", shifted(motion, link, "u", np.exp(1e-6j), 0, at)
        for what, part in (("z", speeds), ("u", turns)):
            if part[link] > 0.01 * fastest:
                yield f"velocity of {link}.{what}", shifted(motion, link, what, 1.001, 1, at)


def _speed(motion: Motion, link: str, what: str, at: int) -> float:
    c = getattr(motion.poses[link], what).c
    return float(np.abs(np.broadcast_to(c[1], motion.failed.shape)[0, at])) if len(c) > 1 else 0.0
