"""The clearances of all compared bodies of one design along its motion: at its poses, and at places between them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np

from compoundkin.analysis.interference.compared_bodies import ComparedBodies, OutlineComparison
from compoundkin.analysis.interference.outline_places import between_outlines, clearance, core_at
from compoundkin.analysis.interference.shape_pairs import ShapePairs, pairs_alike
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import between
from compoundkin.model.outline_shapes import OutlineShape

# The way of a point between two poses is at most so many times its chord: half a circle is 1.57 times its diameter.
LONGER = 1.6

# Origins and orientations of links by their names, (n,).
Placed: TypeAlias = Mapping[str, tuple[Number, Number]]


@dataclass(frozen=True, eq=False, repr=False)
class ClearanceCourse(ShortRepr):
    """The clearances of one design.

    Arrays over the poses are of the assembled ones, whose indices are `known`.
    """

    motion: Motion
    design: int
    comparison: OutlineComparison

    @cached_property
    def known(self) -> Number:
        """The indices of the assembled poses."""
        failed = np.broadcast_to(self.motion.failed, (self.motion.inputs.designs, self.motion.inputs.poses))
        return np.flatnonzero(failed[self.design] == 0)

    @cached_property
    def _placed(self) -> Placed:
        """Origin and orientation of each link at the known poses."""
        return {name: (self._row(pose.z), self._row(pose.u)) for name, pose in self.motion.poses.items()}

    def _row(self, part: Series) -> Number:
        rows = np.atleast_2d(part.c[0])
        own = rows[min(self.design, len(rows) - 1)]
        return np.broadcast_to(own[self.known] if len(own) > 1 else own, self.known.shape)

    @cached_property
    def ways(self) -> Number:
        """By how much clearances can change to the next pose, (bodies, poses - 1)."""
        rows = [self._way(one) for one in self.comparison.compared]
        return np.array(rows).reshape(len(rows), max(len(self.known) - 1, 0))

    def _way(self, bodies: ComparedBodies) -> Number:
        """Return the longest way of a point of the second body as seen from the first."""
        moved = [np.zeros(max(len(self.known) - 1, 0))]
        for one, other in bodies.shapes:
            (z, u), (far, turned) = self._placed[one.link], self._placed[other.link]
            corners = np.conjugate(u) * (far + turned * np.array(other.core)[:, None] - z)
            moved.append(np.abs(np.diff(corners, axis=-1)).max(axis=0))
        return LONGER * np.max(moved, axis=0)

    @cached_property
    def at_poses(self) -> Number:
        """The clearances at the known poses, (bodies, poses).

        Where two bodies are far from each other it is a bound below which the clearance is not.
        """
        rows = [self._exact_where_near(one) for one in self.comparison.compared]
        return np.array(rows).reshape(len(self.comparison.compared), len(self.known))

    def _exact_where_near(self, bodies: ComparedBodies) -> Number:
        low = np.min([self._bound(*two) for two in bodies.shapes], axis=0)
        if not len(low):
            return low
        first = np.array([np.argmin(low)])
        least = float(self._exact(bodies, first)[0])
        near = np.flatnonzero(low <= max(least, 0.0) + self._way(bodies).max(initial=0.0))
        found = low.copy()
        found[near] = self._exact(bodies, near)
        return found

    def _bound(self, one: OutlineShape, other: OutlineShape) -> Number:
        """Return the clearance of the circles around two shapes."""
        middles, reach = [], one.radius + other.radius
        for shape in (one, other):
            core = np.array(shape.core)
            middle = 0.5 * (core[np.argmin(core.real)] + core[np.argmax(core.real)])
            z, u = self._placed[shape.link]
            middles.append(z + u * middle)
            reach += float(np.abs(core - middle).max())
        return np.abs(middles[1] - middles[0]) - reach

    def _exact(self, bodies: ComparedBodies, index: Number) -> Number:
        placed = {link: (z[index], u[index]) for link, (z, u) in self._placed.items()}
        return least_clearance(bodies, placed)

    def between(self, which: Number, places: Number) -> Number:
        """Return the clearances of bodies, by their indices, at places along the motion, (n,).

        NaN where the motion is not assembled.
        """
        moved = between(self.motion, self.design, places, 0)
        found = np.full(len(places), np.nan)
        kept = np.flatnonzero(moved.failed[0] == 0)
        z, u = (
            np.array([_picked(part, kept) for part in parts]).reshape(-1, len(kept))
            for parts in ([moved.poses[link].z for link in self._rows], [moved.poses[link].u for link in self._rows])
        )
        least = np.full(len(kept), np.inf)
        for pairs in self._alike:
            pairs.lower(least, which[kept].astype(int), z, u)
        found[kept] = least
        return found

    @cached_property
    def _rows(self) -> Mapping[str, int]:
        """The rows of the links whose shapes are compared."""
        links = dict.fromkeys(s.link for one in self.comparison.compared for two in one.shapes for s in two)
        return {link: row for row, link in enumerate(links)}

    @cached_property
    def _alike(self) -> tuple[ShapePairs, ...]:
        return tuple(pairs_alike(self.comparison.compared, self._rows))

    def middles(self, which: Number, places: Number) -> Number:
        """Return the places between bodies where they are nearest to each other, complex (n,)."""
        moved = between(self.motion, self.design, places, 0)
        found = np.full(len(places), complex(np.nan, np.nan))
        for n, (k, is_lost) in enumerate(zip(which, moved.failed[0] != 0, strict=True)):
            bodies, index = self.comparison.compared[int(k)], np.array([n])
            if not is_lost:
                placed = poses_of(moved.poses, bodies, index)
                cores = [tuple(core_at(shape, *placed[shape.link]) for shape in two) for two in bodies.shapes]
                values = [clearance(*two, both)[0] for two, both in zip(bodies.shapes, cores, strict=True)]
                nearest = int(np.argmin(values))
                found[n] = between_outlines(*bodies.shapes[nearest], cores[nearest])[0]
        return found


def least_clearance(bodies: ComparedBodies, placed: Placed) -> Number:
    """Return the clearance of two bodies where their links have origins and orientations, (n,)."""
    known: dict[int, Any] = {}
    for shape in (shape for two in bodies.shapes for shape in two):
        if id(shape) not in known:
            known[id(shape)] = core_at(shape, *placed[shape.link])
    found = [clearance(one, other, (known[id(one)], known[id(other)])) for one, other in bodies.shapes]
    return np.asarray(np.min(found, axis=0))


def poses_of(poses: Mapping[str, Pose], bodies: ComparedBodies, index: Number) -> Placed:
    """Return origins and orientations of the links of two bodies at some places, (n,)."""
    links = {shape.link for two in bodies.shapes for shape in two}
    return {link: (_picked(poses[link].z, index), _picked(poses[link].u, index)) for link in links}


def _picked(part: Series, index: Number) -> Number:
    row = np.ravel(part.c[0])
    return np.broadcast_to(row[index] if len(row) > 1 else row, index.shape)
