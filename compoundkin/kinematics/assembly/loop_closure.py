"""The loop equations of a group: origins along a spanning tree, one equation for every other connection."""

from __future__ import annotations

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.assembly.group_geometry import GroupGeometry, GroupGraph
from compoundkin.kinematics.assembly.rotation_equations import BodyRotations, RotationEquations, isotropic


def rotation_equations_of(geometry: GroupGeometry) -> RotationEquations:
    """Write the loop equations of a group at all its poses. Lengths are divided by its size.

    >>> from compoundkin.kinematics.assembly.group_geometry import Connection
    >>> dyad = GroupGeometry(2, (
    ...     Connection((None, 0), (0, 0)), Connection((0, 1), (3, 0)), Connection((None, 1), (4, 2))), 1.0)
    >>> loops = rotation_equations_of(dyad)
    >>> loops.constant[..., 0], loops.columns[..., 0].ravel().tolist()
    (array([-4.+0.j]), [(3+0j), (2+0j)])
    """
    found = geometry.connections
    points = [np.stack(np.broadcast_arrays(*map(isotropic, c.points)), axis=-2) / geometry.size for c in found]
    ones = isotropic(np.ones(2))
    directions = [
        ones if c.directions is None else np.stack(np.broadcast_arrays(*map(isotropic, c.directions)), axis=-2)
        for c in found
    ]
    return _closed(geometry.graph(), _stacked(points), _stacked(directions))


def random_equations(graph: GroupGraph, rng: np.random.Generator) -> RotationEquations:
    """Write the loop equations of a generic complex instance."""
    return _closed(graph, *graph.random(rng))


def _stacked(arrays: list[Number]) -> Number:
    return np.stack(np.broadcast_arrays(*arrays), axis=-3)


def _closed(graph: GroupGraph, points: Number, directions: Number) -> RotationEquations:
    """Place origins along a spanning tree, then write one equation for every connection that is not in it."""
    body_rotations, guides = _body_rotations(graph, directions)
    batch = np.broadcast_shapes(points.shape[:-3], directions.shape[:-3])
    frames = _Frames(graph, points, directions, body_rotations, guides, batch)
    tree, chords = graph.tree()
    for k, new in tree:
        side = graph.bodies[k].index(new)
        across = frames.end(k, 1 - side) + frames.slide(k) * (1 if side else -1)
        frames.origins[new] = across - frames.arm(k, side)
    loops = [frames.end(k, 0) + frames.slide(k) - frames.end(k, 1) for k in chords]
    equations = np.stack(loops, axis=-3) if loops else np.zeros((*batch, 0, 1 + frames.unknowns, 2), complex)
    moved = np.moveaxis(equations, -3, -2)
    origins = np.stack([frames.origins[b] for b in range(graph.n)], axis=-3)
    return RotationEquations(moved[..., 0, :, :], moved[..., 1:, :, :], guides, body_rotations, origins)


class _Frames:
    """Positions as arrays (..., 1 + unknowns, 2), linear in 1, the rotations and the displacements."""

    def __init__(
        self,
        graph: GroupGraph,
        points: Number,
        directions: Number,
        body_rotations: BodyRotations,
        guides: tuple[int | None, ...],
        batch: tuple[int, ...],
    ) -> None:
        self.graph, self.points, self.directions, self.body_rotations = graph, points, directions, body_rotations
        self.rotations = 1 + max((k for k in body_rotations.rotation if k is not None), default=-1)
        self.unknowns = self.rotations + len(guides)
        self.batch = batch
        slides = [k for k, slide in enumerate(graph.slides) if slide]
        self.displacement = {k: 1 + self.rotations + i for i, k in enumerate(slides)}
        self.origins: dict[int | None, Number] = {None: self._zero()}

    def _zero(self) -> Number:
        return np.zeros((*self.batch, 1 + self.unknowns, 2), dtype=complex)

    def arm(self, k: int, side: int) -> Number:
        """Return the way from the origin of a body to its point of connection `k`."""
        return self._turned(self.graph.bodies[k][side], self.points[..., k, side, :])

    def end(self, k: int, side: int) -> Number:
        """Return where a body's point of connection `k` is."""
        return self.origins[self.graph.bodies[k][side]] + self.arm(k, side)

    def slide(self, k: int) -> Number:
        """Return the displacement of a slide along its guide; zero for a pin."""
        out = self._zero()
        if k in self.displacement:
            guide = self.graph.bodies[k][0]
            factor = 1.0 if guide is None else self.body_rotations.factors[..., guide, :]
            out[..., self.displacement[k], :] = factor * self.directions[..., k, 0, :]
        return out

    def _turned(self, body: int | None, vector: Number) -> Number:
        out = self._zero()
        rotation = None if body is None else self.body_rotations.rotation[body]
        factor = 1.0 if body is None else self.body_rotations.factors[..., body, :]
        out[..., 0 if rotation is None else 1 + rotation, :] = factor * vector
        return out


def _body_rotations(graph: GroupGraph, directions: Number) -> tuple[BodyRotations, tuple[int | None, ...]]:
    """Give all bodies that slides join one rotation, walking along the slides from a first body."""
    unit = np.ones((*directions.shape[:-3], 2), dtype=complex)
    factors: dict[int | None, Number] = {None: unit}
    rotation: dict[int | None, int | None] = {None: None}
    _spread(graph, directions, None, factors, rotation)
    count = 0
    for body in range(graph.n):
        if body not in factors:
            factors[body], rotation[body] = unit, count
            count += 1
            _spread(graph, directions, body, factors, rotation)
    guides = tuple(rotation[graph.bodies[k][0]] for k, slide in enumerate(graph.slides) if slide)
    if count + len(guides) != 2 * (len(graph.bodies) - graph.n):
        raise InvalidInput(Problem("slides", "a chain of slides alone holds the same angle twice"))
    bodies = range(graph.n)
    return BodyRotations(tuple(rotation[b] for b in bodies), np.stack([factors[b] for b in bodies], axis=-2)), guides


def _spread(
    graph: GroupGraph,
    directions: Number,
    start: int | None,
    factors: dict[int | None, Number],
    rotation: dict[int | None, int | None],
) -> None:
    """Give all bodies that slides join to `start` its rotation."""
    reached = [start]
    for body in reached:
        for k, (a, b) in enumerate(graph.bodies):
            if graph.slides[k] and body in (a, b):
                new, own = (b, 0) if body == a else (a, 1)
                if new not in factors:
                    along = directions[..., k, own, :] * directions[..., k, 1 - own, ::-1]
                    factors[new], rotation[new] = factors[body] * along, rotation[start]
                    reached.append(new)
