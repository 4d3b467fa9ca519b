"""The equations of all pairs of a motion in the poses of all links, in solving order, and about one pose.

They do without the closed forms of groups that solved the motion: a Jacobian has a column for x, y and the angle of
each link, and is block triangular, with a block for each group on its diagonal.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from compoundkin.analysis.singularity import STILL
from compoundkin.base.arrays import Number, wrapped
from compoundkin.base.newton import StoppingRule, gauss_newton
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series
from compoundkin.kinematics import Motion
from compoundkin.kinematics.configuration import dimensions_at
from compoundkin.kinematics.driver_values import fit, mapped
from compoundkin.kinematics.extremes.motion_between import between, inputs_between
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends, constraint_scales
from compoundkin.structure.redundancy.constraint_equations import ConstraintEquations

# Singular values of the whole Jacobian below this are zero: a singular pose is known to 1e-6, of which the Jacobian's
# slope by the pose makes a few times as much.
ZERO = 1e-5
# Links farther away than so many sizes are on their way to infinity, as between guides that become parallel: the least
# singular value falls there, though nothing is singular.
FAR = 200.0
# Corrections take so many steps at most, and leave no more.
STEPS, CLOSED = 40, 1e-9
REST = StoppingRule(exact=1e-15, rounding=1e-12, longest=0.3, patience=10, gain=0.9)


class PairRow(NamedTuple):
    """A row of the Jacobian: which entry of which pair, and which driver prescribes it; None where it is held.

    `scale` is the unit of a length, 1 of an angle.
    """

    pair: int
    entry: int
    driver: str | None
    sign: float
    scale: float
    level: int


class GroupBlock(NamedTuple):
    """The rows and links of a group: a block on the diagonal. `kept` is the rank that it has where it is regular."""

    rows: tuple[PairRow, ...]
    links: tuple[str, ...]
    kept: int


@dataclass(frozen=True, eq=False)
class MotionEquations:
    """The equations of all pairs and drivers of a motion in the poses of all moving links, in solving order."""

    motion: Motion

    @cached_property
    def _equations(self) -> ConstraintEquations:
        return ConstraintEquations(self.motion.mechanism)

    @cached_property
    def level(self) -> Mapping[str, int]:
        """When each link is known: 0 with the frame, k with the k-th group."""
        structure = self.motion.structure
        known = dict.fromkeys(structure.ground.links, 0)
        for k, group in enumerate(structure.groups, start=1):
            known.update(dict.fromkeys(group.links, k))
        return {FRAME: 0, **known}

    @cached_property
    def unit(self) -> float:
        """The unit of lengths: that of the longest moving link, so that turning and shifting it count alike."""
        points = self.motion.mechanism.geometry.points
        own = [
            np.stack([np.ravel(p)[0] for p in points[name].values()]) for name in self.links if len(points[name]) > 1
        ]
        return max((float(np.abs(row[:, None] - row).max()) for row in own), default=0.0) or self.motion.size

    @cached_property
    def links(self) -> tuple[str, ...]:
        """The moving links in solving order."""
        return tuple(sorted(self._equations.links, key=lambda name: self.level[name]))

    @cached_property
    def column(self) -> Mapping[str, int]:
        """The first column of every moving link."""
        return {name: 3 * k for k, name in enumerate(self.links)}

    @cached_property
    def pairs(self) -> tuple[Pair, ...]:
        """All pairs, then that of each driver."""
        return (*self._equations.pairs, *self._equations.driven)

    @cached_property
    def rows(self) -> tuple[PairRow, ...]:
        """All rows: what pairs hold, then the drivers' coordinates."""
        free = len(self._equations.pairs)
        found = [
            PairRow(k, i, None, 1.0, scale, self._last(pair))
            for k, pair in enumerate(self.pairs[:free])
            for i, scale in enumerate(constraint_scales(pair, self.unit))
        ]
        drives = zip(self.motion.mechanism.drives, self._equations.driven, strict=True)
        for k, (drive, pair) in enumerate(drives, start=free):
            sign, scale = float(pair.driven_by(drive.link)), 1.0 if pair.free_is_angle else self.unit
            found.append(PairRow(k, pair.held, drive.name, sign, scale, self._last(pair)))
        return tuple(found)

    def _last(self, pair: Pair) -> int:
        return max(self.level[name] for name in pair.members)

    @cached_property
    def blocks(self) -> tuple[GroupBlock, ...]:
        """The block of each group."""
        found, idle = [], [one.link for one in self.motion.structure.passive]
        for k, group in enumerate(self.motion.structure.groups, start=1):
            links = tuple(name for name in self.links if self.level[name] == k)
            rows = tuple(row for row in self.rows if row.level == k)
            found.append(GroupBlock(rows, links, 3 * len(links) - sum(name in idle for name in group.links)))
        return tuple(found)

    @cached_property
    def ends(self) -> Mapping[str, Ends]:
        """The sides of all pairs over designs and poses, by their index as a text."""
        shape, geometry, found = fit(self.motion.shape), self.motion.mechanism.geometry, {}
        for k, pair in enumerate(self.pairs):
            own = self.motion.solving_order.pairs.get(pair.name)
            # those that solved the motion count the turns of wheels
            same = own is not None and type(own) is type(pair) and own.members == pair.members
            found[str(k)] = (self.motion.inputs.ends[pair.name] if same
                             else tuple(mapped(end, shape) for end in pair.ends(geometry)))  # fmt: skip
        return found

    def at(self, design: int, places: Number) -> PosesAtPlaces:
        """Return the poses and sides at places along one design, in arrays (n,)."""
        designs = np.full(len(places), design)
        there = between(self.motion, designs, places, 1)
        part = replace(self.motion.inputs, ends=self.ends).pick(designs, places)
        ends = tuple(tuple(mapped(end, np.ravel) for end in part.ends[str(k)]) for k in range(len(self.pairs)))
        poses = {name: _leading(pose, len(places)) for name, pose in there.poses.items()}
        return PosesAtPlaces(poses, ends, there.failed.ravel() == 0)

    def near(self, block: GroupBlock, there: PosesAtPlaces) -> Number:
        """Return at which places a group is assembled, and no link at it on its way to infinity."""
        found = there.good
        for name in {name for row in block.rows for name in self.pairs[row.pair].members}:
            found = found & (np.abs(there.links[name].z.c[0]) < FAR * self.motion.size)
        return found

    def tables(self, poses: Mapping[str, Pose], ends: Sequence[Ends], count: int) -> list[Number]:
        """Return the Jacobian of every pair, (count, rows, 3 members), x and y in parts of the unit."""
        size, found = self.unit, []
        for pair, sides in zip(self.pairs, ends, strict=True):
            own = pair.jacobian(sides, tuple(poses[name] for name in pair.members))
            own = np.asarray(own) * np.tile([size, size, 1.0], len(pair.members))
            found.append(np.broadcast_to(own, (count, *own.shape[-2:])))
        return found

    def matrix(self, rows: Sequence[PairRow], links: Sequence[str], tables: Sequence[Number]) -> Number:
        """Return rows by some links, (count, rows, 3 links). Rows are radians, or parts of the unit."""
        at = {name: 3 * k for k, name in enumerate(links)}
        found = np.zeros((len(tables[0]), len(rows), 3 * len(links)))
        for i, row in enumerate(rows):
            for side, name in enumerate(self.pairs[row.pair].members):
                if name in at:
                    part = tables[row.pair][:, row.entry, 3 * side : 3 * side + 3]
                    found[:, i, at[name] : at[name] + 3] += part * (row.sign / row.scale)
        return found


class PosesAtPlaces(NamedTuple):
    """Poses of all links and sides of all pairs at places, and which are assembled."""

    links: Mapping[str, Pose]
    ends: tuple[Ends, ...]
    good: Number


def _leading(pose: Pose, count: int) -> Pose:
    """Return a pose at places, without rates."""
    if pose is FIXED:
        return pose
    return pose.mapped(lambda series: Series((np.broadcast_to(series.c[0], (1, count))[0].copy(),)))


class DriverWay(NamedTuple):
    """How drivers go through a pose: a unit vector of their path (radians, parts of the unit), and how it bends.

    `across` are unit vectors in the other directions, in rows.
    """

    along: Number
    bend: Number
    across: Number


@dataclass(frozen=True, eq=False)
class EquationsAtPose:
    """The equations about one pose. A state is by how much links are moved from there: x, y in units, and angles."""

    system: MotionEquations
    poses: Mapping[str, Pose]
    ends: tuple[Ends, ...]
    points: Mapping[str, Mapping[str, complex]]
    way: DriverWay

    def moved(self, states: Number) -> dict[str, Pose]:
        """Return the poses in states (n, 3 links) times t, up to t squared; of one state at t = 1."""
        size, found = self.system.unit, {FRAME: FIXED}
        series = states.ndim > 1
        for name, k in self.system.column.items():
            pose = self.poses[name]
            z, u, theta = pose.z.c[0], pose.u.c[0], None if pose.theta is None else pose.theta.c[0]
            shift, turn = (states[..., k] + 1j * states[..., k + 1]) * size, states[..., k + 2]
            if series:
                zero = 0.0 * turn
                turned = Series((u + zero, 1j * u * turn, -0.5 * u * turn**2))
                counted = None if theta is None else Series((theta + zero, turn, zero))
                found[name] = Pose(Series((z + zero, shift, 0j * zero)), turned, counted)
            else:
                counted = None if theta is None else Series((theta + turn,))
                found[name] = Pose(Series((z + shift,)), Series((u * np.exp(1j * turn),)), counted)
        return found

    def values(self, states: Number, order: int) -> Number:
        """Return coefficients of all rows, scaled as their Jacobian, (n, rows) or (rows,)."""
        poses, found = self.moved(states), []
        known: dict[int, tuple[Series, ...]] = {}
        for row in self.system.rows:
            pair = self.system.pairs[row.pair]
            if row.pair not in known:
                own = self.ends[row.pair], tuple(poses[name] for name in pair.members)
                known[row.pair] = (pair.coordinate(*own),) if row.driver is not None else pair.closure(*own)
            c = known[row.pair][0 if row.driver is not None else row.entry].c
            value = np.real(c[order]) * (row.sign / row.scale) if order < len(c) else 0.0
            found.append(np.broadcast_to(value, states.shape[:-1]))
        return np.stack(found, axis=-1)

    @cached_property
    def whole(self) -> Number:
        """All rows by all links at the pose."""
        return self._matrix(self.poses)

    def _matrix(self, poses: Mapping[str, Pose]) -> Number:
        tables = self.system.tables(poses, self.ends, 1)
        return self.system.matrix(self.system.rows, self.system.links, tables)[0]

    @cached_property
    def start(self) -> Number:
        """The values of all rows at the pose."""
        return self.values(np.zeros(len(self.system.links) * 3), 0)

    @cached_property
    def driven(self) -> Number:
        """Which rows drivers prescribe."""
        return np.array([row.driver is not None for row in self.system.rows], dtype=bool)

    def with_free_driver(self, rows: Number) -> Number:
        """Return what pairs hold and what drivers hold across their path, of rows or values of all."""
        return np.concatenate([rows[~self.driven], self.way.across @ rows[self.driven]])

    def pace(self, tangent: Number) -> float:
        """Return how fast the drivers move along their path."""
        return float(self.way.along @ (self.whole[self.driven] @ tangent))

    def second(self, states: Number) -> Number:
        """Return the second derivatives of the held rows along states (n, 3 links), (n, rows)."""
        values = 2.0 * self.values(states, 2)
        paces = self.whole[self.driven] @ states.T
        bent = (self.way.along @ paces)[:, None] ** 2 * self.way.bend
        return np.concatenate([values[:, ~self.driven], (values[:, self.driven] - bent) @ self.way.across.T], axis=1)

    def bending(self, state: Number) -> Number:
        """Return the second derivatives of the drivers' coordinates along one state."""
        return 2.0 * self.values(state[None], 2)[0, self.driven]

    def corrected(self, state: Number) -> Number | None:
        """Return the nearest state that closes, drivers on their path. None where none is near."""

        def system(x: Number) -> tuple[Number, Number]:
            away = self.values(x, 0) - np.where(self.driven, self.start, 0.0)
            angles = np.array(
                [r.driver is not None and self.system.pairs[r.pair].free_is_angle for r in self.system.rows]
            )
            away = np.where(angles, wrapped(away), away)
            return self.with_free_driver(away), self.with_free_driver(self._matrix(self.moved(x)))

        found = gauss_newton(system, lambda m, r: np.linalg.lstsq(m, r, rcond=REST.rounding)[0], state, STEPS, REST)
        return found.x if found.residual < CLOSED else None


def _way(system: MotionEquations, design: int, place: float) -> DriverWay:
    """Return how the drivers go through a place; where they rest, as they do next."""
    motion, names = system.motion, list(system.motion.drives)
    units = np.array([1.0 if drive.is_angle else system.unit for drive in motion.drives.values()])
    last = motion.inputs.poses - 1.0
    if not names:
        return DriverWay(np.zeros(0), np.zeros(0), np.zeros((0, 0)))
    values = np.stack([np.broadcast_to(motion.inputs.drives[n][0], motion.failed.shape)[design] for n in names], axis=1)
    moving = np.ptp(values, axis=0) > 0.0
    bend = np.zeros(len(names))
    if moving.sum() <= 1:
        along = np.where(moving, 1.0, 0.0) if moving.any() else np.eye(len(names))[0]
    else:
        part = inputs_between(motion, np.array([design]), np.array([place]), 2, by_place=True)
        rows = [[float(np.ravel(v)[0]) for v in (*part.drives[n], 0.0, 0.0)[1:3]] for n in names]
        along, curved = np.array(rows).T / units
        if np.linalg.norm(along) < STILL * np.linalg.norm(np.ptp(values, axis=0) / units) / max(last, 1.0):
            away = (values - values[round(place)]) / units
            far = np.flatnonzero(np.linalg.norm(away, axis=1) > 0.0)
            along = away[far[int(np.argmin(np.abs(far - place)))]]
        else:
            bend = curved / float(along @ along)
    along = along / np.linalg.norm(along)
    across = np.linalg.svd(along[None], full_matrices=True)[2][1:]
    return DriverWay(along, bend, across)


def equations_at(system: MotionEquations, design: int, place: float) -> EquationsAtPose:
    """Return the equations about the pose at a place along one design."""
    there = system.at(design, np.array([place]))
    poses = {name: pose.entry((0,)) for name, pose in there.links.items()}
    ends = tuple(tuple(mapped(end, _number) for end in sides) for sides in there.ends)
    points = dimensions_at(system.motion.structure, design, round(place))
    return EquationsAtPose(system, poses, ends, points, _way(system, design, place))


def _number(value: Number) -> Number:
    return np.ravel(value)[0].item() if np.ndim(value) else value


def null_spaces(matrix: Number) -> tuple[Number, Number]:
    """Return orthonormal bases of the null space and of the left one, in columns."""
    left, values, right = np.linalg.svd(matrix)
    rank = int(np.sum(values > ZERO))
    return right[rank:].T, left[:, rank:]


def idle_motions(pose: EquationsAtPose) -> Number:
    """Return the turning of passive links, such as rollers, in columns."""
    system, motion = pose.system, pose.system.motion
    found = np.zeros((3 * len(system.links), len(motion.structure.passive)))
    for k, one in enumerate(motion.structure.passive):
        own = pose.poses[one.link]
        arm = 1j * (own.z.c[0] - own.at(pose.points[one.link][one.at]).c[0]) / system.unit
        first = system.column[one.link]
        found[first : first + 3, k] = arm.real, arm.imag, 1.0
    return np.linalg.qr(found)[0] if found.size else found


def without_motions(basis: Number, idle: Number) -> Number:
    """Return a basis of what is orthogonal to idle motions in the space of some orthonormal columns."""
    if not idle.shape[1] or not basis.shape[1]:
        return basis
    _, values, right = np.linalg.svd(idle.T @ basis)
    return np.asarray(basis @ right[int(np.sum(values > 0.5)) :].T)
