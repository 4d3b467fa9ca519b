"""The clearances of outlines along a motion: which shapes are compared, and how far apart they are at many places.

Compared are shapes on one layer of links that are not joined, and the parts of joined links that lie apart from their
joint. Shapes whose cores have equally many corners are compared in one call of Shapely, which an extra of the package
brings and which is imported when it is needed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from importlib import import_module
from itertools import combinations
from typing import Any, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import missing_extra
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import between
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.outline_shapes import OutlineShape, Points

# The path of a point between two poses is at most so many times its chord: half a circle is 1.57 times its diameter.
LONGER = 1.6
# Origins and orientations of links by their names, (n,).
Placed: TypeAlias = Mapping[str, tuple[Number, Number]]


@dataclass(frozen=True, eq=False, repr=False)
class ClearanceCourse(ShortRepr):
    """The clearances of one design. Arrays over poses are over the assembled ones, with the indices `known`."""

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
    def changes(self) -> Number:
        """Bounds of the change of clearances to the next pose, (bodies, poses - 1)."""
        rows = [self._change(one) for one in self.comparison.compared]
        return np.array(rows).reshape(len(rows), max(len(self.known) - 1, 0))

    def _change(self, bodies: ComparedBodies) -> Number:
        """Return a bound of the longest path of a point of the second body relative to the first."""
        moved = [np.zeros(max(len(self.known) - 1, 0))]
        for one, other in bodies.shapes:
            (z, u), (far, turned) = self._placed[one.link], self._placed[other.link]
            corners = np.conjugate(u) * (far + turned * np.array(other.core)[:, None] - z)
            moved.append(np.abs(np.diff(corners, axis=-1)).max(axis=0))
        return LONGER * np.max(moved, axis=0)

    @cached_property
    def at_poses(self) -> Number:
        """The clearances at the known poses, (bodies, poses), where two bodies are far apart a lower bound."""
        rows = [self._exact_where_near(one) for one in self.comparison.compared]
        return np.array(rows).reshape(len(self.comparison.compared), len(self.known))

    def _exact_where_near(self, bodies: ComparedBodies) -> Number:
        low = np.min([self._bound(*two) for two in bodies.shapes], axis=0)
        if not len(low):
            return low
        first = np.array([np.argmin(low)])
        least = float(self._exact(bodies, first)[0])
        near = np.flatnonzero(low <= max(least, 0.0) + self._change(bodies).max(initial=0.0))
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
        """Return the clearances of bodies, by their indices, at places along the motion, (n,), NaN without assembly."""
        # many bodies are compared at the same places: these are solved once
        there, at = np.unique(places, return_inverse=True)
        moved = between(self.motion, self.design, there, 0)
        found = np.full(len(places), np.nan)
        closed = np.flatnonzero(moved.failed[0][at] == 0)
        z, u = (
            np.array([np.broadcast_to(np.ravel(part.c[0]), there.shape) for part in parts]).reshape(-1, len(there))
            for parts in ([moved.poses[link].z for link in self._rows], [moved.poses[link].u for link in self._rows])
        )
        least = np.full(len(closed), np.inf)
        for pairs in self._alike:
            pairs.lower(least, which[closed].astype(int), z, u, at[closed])
        found[closed] = least
        return found

    @cached_property
    def _rows(self) -> Mapping[str, int]:
        """The rows of the links whose shapes are compared."""
        links = dict.fromkeys(s.link for one in self.comparison.compared for two in one.shapes for s in two)
        return {link: row for row, link in enumerate(links)}

    @cached_property
    def _alike(self) -> tuple[ShapePairs, ...]:
        return tuple(grouped_shape_pairs(self.comparison.compared, self._rows))

    def middles(self, which: Number, places: Number) -> Number:
        """Return the places midway between bodies where they are nearest, complex (n,)."""
        moved = between(self.motion, self.design, places, 0)
        found = np.full(len(places), complex(np.nan, np.nan))
        for n, (k, is_lost) in enumerate(zip(which, moved.failed[0] != 0, strict=True)):
            bodies, index = self.comparison.compared[int(k)], np.array([n])
            if not is_lost:
                placed = poses_of(moved.poses, bodies, index)
                cores = [tuple(core_at(shape, *placed[shape.link]) for shape in two) for two in bodies.shapes]
                values = [shape_clearance(*two, both)[0] for two, both in zip(bodies.shapes, cores, strict=True)]
                nearest = int(np.argmin(values))
                found[n] = between_outlines(*bodies.shapes[nearest], cores[nearest])[0]
        return found


def least_clearance(bodies: ComparedBodies, placed: Placed) -> Number:
    """Return the clearances of two bodies at origins and orientations of their links, (n,)."""
    known: dict[int, Any] = {}
    for shape in (shape for two in bodies.shapes for shape in two):
        if id(shape) not in known:
            known[id(shape)] = core_at(shape, *placed[shape.link])
    found = [shape_clearance(one, other, (known[id(one)], known[id(other)])) for one, other in bodies.shapes]
    return np.asarray(np.min(found, axis=0))


def poses_of(poses: Mapping[str, Pose], bodies: ComparedBodies, index: Number) -> Placed:
    """Return origins and orientations of the links of two bodies at some places, (n,)."""
    links = {shape.link for two in bodies.shapes for shape in two}
    return {link: (_at_places(poses[link].z, index), _at_places(poses[link].u, index)) for link in links}


def _at_places(part: Series, index: Number) -> Number:
    row = np.ravel(part.c[0])
    return np.broadcast_to(row[index] if len(row) > 1 else row, index.shape)


# A point within this distance of a shape, a part of the size, is reached by it.
WITHIN = 1e-9


@dataclass(frozen=True, eq=False, repr=False)
class ComparedBodies(ShortRepr):
    """Two bodies, links or pins, and shapes that share a layer."""

    one: str
    other: str
    shapes: list[tuple[OutlineShape, OutlineShape]] = field(default_factory=list)

    @property
    def layers(self) -> tuple[int, ...]:
        """The layers that they share."""
        return tuple(sorted({layer for a, b in self.shapes for layer in set(a.layers) & set(b.layers)}))


@dataclass(frozen=True, eq=False, repr=False)
class OutlineComparison(ShortRepr):
    """The compared bodies of one design; `neighbours` are joined links with shapes at their joints that are not."""

    compared: tuple[ComparedBodies, ...]
    neighbours: tuple[tuple[str, str], ...]


def compared_outlines(mechanism: Mechanism, shapes: tuple[OutlineShape, ...], points: Points) -> OutlineComparison:
    """Return the shapes of a mechanism that are compared.

    Shapes of one link move together. Shapes of links joined by a pin or slide that both reach its points always
    overlap, as do all shapes of links that another pair joins: wheels touch where they mesh.
    """
    joints = _joints(mechanism)
    reached = [_reached(shape, points, WITHIN * mechanism.geometry.size) for shape in shapes]
    found: dict[tuple[str, str], ComparedBodies] = {}
    left: dict[tuple[str, str], None] = {}
    for i, j in combinations(range(len(shapes)), 2):
        one, other = shapes[i], shapes[j]
        if not set(one.layers) & set(other.layers) or set(one.links) & set(other.links):
            continue
        key = one.body, other.body
        if (other.body, one.body) in found:
            key, one, other = (other.body, one.body), other, one
        letters = joints.get(frozenset((one.link, other.link)), ()) if not (one.is_pin or other.is_pin) else ()
        if any(_overlap(letter, reached[i], reached[j]) for letter in letters):
            left[key] = None
        else:
            found.setdefault(key, ComparedBodies(*key)).shapes.append((one, other))
    return OutlineComparison(tuple(found.values()), tuple(left))


def _joints(mechanism: Mechanism) -> Mapping[frozenset[str], list[tuple[str, ...]]]:
    """Return the points of all joints of two links, none for a joint whose shapes always touch."""
    found: dict[frozenset[str], list[tuple[str, ...]]] = {}
    for letter, links in mechanism.real_pins.items():
        for two in combinations(links, 2):
            found.setdefault(frozenset(two), []).append((letter,))
    for pair in mechanism.real_pairs:
        letters = pair.letters if pair.is_simple else ()
        found.setdefault(frozenset(pair.members[:2]), []).append(letters)
    return found


def _overlap(letters: tuple[str, ...], one: frozenset[str], other: frozenset[str]) -> bool:
    """Return whether two shapes both reach a joint."""
    return not letters or bool(one.intersection(letters) and other.intersection(letters))


def _reached(shape: OutlineShape, points: Points, slack: float) -> frozenset[str]:
    """Return the points of its link within a shape."""
    own: Any = points[shape.link]
    core, library = core_at(shape), shapely()
    apart = ((letter, library.distance(core, library.Point(p.real, p.imag))) for letter, p in own.items())
    return frozenset(letter for letter, distance in apart if distance <= shape.radius + slack)


@dataclass(frozen=True, eq=False, repr=False)
class ShapePairs(ShortRepr):
    """Pairs of shapes with equally many corners, (pairs,), in order of their bodies.

    `cores` and `closed` are of the first and of the second shapes, `links` the rows of their links.
    """

    bodies: Number
    links: tuple[Number, Number]
    cores: tuple[Number, Number]
    closed: tuple[bool, bool]
    reach: Number

    def lower(self, found: Number, which: Number, z: Number, u: Number, places: Number) -> None:
        """Lower the values `found` (n,) to the clearances of bodies, by their indices, at places by their indices.

        `z` and `u` are the origins and orientations of all links, (links, places).
        """
        first, last = np.searchsorted(self.bodies, which, "left"), np.searchsorted(self.bodies, which, "right")
        count = last - first
        at = np.repeat(np.arange(len(which)), count)
        pair = np.arange(len(at)) + np.repeat(first - np.cumsum(count) + count, count)
        there = places[at]
        if len(at):
            one, other = (
                geometries(z[rows[pair], there][:, None] + u[rows[pair], there][:, None] * core[pair], closed)
                for rows, core, closed in zip(self.links, self.cores, self.closed, strict=True)
            )
            np.minimum.at(found, at, shapely().distance(one, other) - self.reach[pair])


def grouped_shape_pairs(compared: Sequence[ComparedBodies], rows: Mapping[str, int]) -> Iterator[ShapePairs]:
    """Yield all pairs of shapes of bodies, grouped by their corners. `rows` are those of links."""
    found: dict[tuple[tuple[int, bool], ...], list[tuple[int, tuple[OutlineShape, OutlineShape]]]] = {}
    for k, bodies in enumerate(compared):
        for two in bodies.shapes:
            found.setdefault(tuple((len(one.core), one.closed) for one in two), []).append((k, two))
    for ((_, closed), (_, other_closed)), of_one in found.items():
        ones, others = zip(*(two for _, two in of_one), strict=True)
        yield ShapePairs(
            np.array([k for k, _ in of_one]),
            (np.array([rows[one.link] for one in ones]), np.array([rows[one.link] for one in others])),
            (np.array([one.core for one in ones]), np.array([one.core for one in others])),
            (closed, other_closed),
            np.array([one.radius + other.radius for one, other in zip(ones, others, strict=True)]),
        )


def core_at(shape: OutlineShape, z: Number = 0j, u: Number = 1 + 0j) -> Any:
    """Return the cores of a shape as geometries (n,), at origins `z` and orientations `u` of its link."""
    return geometries(np.asarray(z)[..., None] + np.asarray(u)[..., None] * np.array(shape.core), shape.closed)


def geometries(vertices: Number, closed: bool) -> Any:
    """Return points, lines or polygons of these vertices, (n, vertices)."""
    library = shapely()
    placed = np.stack([vertices.real, vertices.imag], axis=-1)
    if placed.shape[-2] == 1:
        return library.points(placed[..., 0, :])
    return library.polygons(library.linearrings(placed)) if closed else library.linestrings(placed)


def shape_clearance(one: OutlineShape, other: OutlineShape, cores: tuple[Any, Any]) -> Number:
    """Return the clearances of two shapes (n,) from their cores, negative where their edges overlap.

    Crossing cores give minus the sum of both radii.
    """
    return np.asarray(shapely().distance(*cores)) - (one.radius + other.radius)


def nearest_places(cores: tuple[Any, Any]) -> Number:
    """Return the nearest places of two cores, complex (n, 2)."""
    library = shapely()
    lines = np.atleast_1d(library.shortest_line(*cores))
    ends = library.get_coordinates(lines).reshape(len(lines), 2, 2)
    return np.asarray(ends[..., 0] + 1j * ends[..., 1])


def between_outlines(one: OutlineShape, other: OutlineShape, cores: tuple[Any, Any]) -> Number:
    """Return the places midway between the edges of two shapes, complex (n,)."""
    ends = nearest_places(cores)
    distance = np.abs(ends[:, 1] - ends[:, 0])
    with np.errstate(invalid="ignore", divide="ignore"):
        part = np.where(distance > 0.0, 0.5 * (1.0 + (one.radius - other.radius) / distance), 0.0)
    return np.asarray(ends[:, 0] + part * (ends[:, 1] - ends[:, 0]))


def shapely(where: str = "interference") -> Any:
    """Return `shapely`. Raises InvalidInput for `where` if it is not installed."""
    try:
        return import_module("shapely")
    except ImportError:
        raise missing_extra(where, "this needs shapely", "interference") from None
