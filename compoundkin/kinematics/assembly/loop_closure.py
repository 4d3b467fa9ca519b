"""The loop equations of an assembly: origins along a spanning tree, one equation for every other connection."""

from __future__ import annotations

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.kinematics.assembly.group_geometry import Assembly, Structure
from compoundkin.kinematics.assembly.rotation_equations import Loops, Turning, isotropic


def loops_of(assembly: Assembly) -> Loops:
    """The loop equations of an assembly at all its poses, lengths divided by its size.

    >>> from compoundkin.kinematics.assembly.group_geometry import Connection
    >>> dyad = Assembly(2, (
    ...     Connection((None, 0), (0, 0)), Connection((0, 1), (3, 0)), Connection((None, 1), (4, 2))), 1.0)
    >>> loops = loops_of(dyad)
    >>> loops.constant[..., 0], loops.columns[..., 0].ravel().tolist()
    (array([-4.+0.j]), [(3+0j), (2+0j)])
    """
    found = assembly.connections
    points = [np.stack(np.broadcast_arrays(*map(isotropic, c.points)), axis=-2) / assembly.size for c in found]
    ones = isotropic(np.ones(2))
    directions = [
        ones if c.directions is None else np.stack(np.broadcast_arrays(*map(isotropic, c.directions)), axis=-2)
        for c in found
    ]
    return _closed(assembly.structure(), _stacked(points), _stacked(directions))


def random_loops(structure: Structure, rng: np.random.Generator) -> Loops:
    """The loop equations of a generic complex instance of a structure."""
    return _closed(structure, *structure.random(rng))


def _stacked(arrays: list[Number]) -> Number:
    return np.stack(np.broadcast_arrays(*arrays), axis=-3)


def _closed(structure: Structure, points: Number, directions: Number) -> Loops:
    """Origins along a spanning tree, then one equation for every connection that is not in it."""
    turning, guides = _turning(structure, directions)
    batch = np.broadcast_shapes(points.shape[:-3], directions.shape[:-3])
    frames = _Frames(structure, points, directions, turning, guides, batch)
    tree, chords = structure.tree()
    for k, new in tree:
        side = structure.bodies[k].index(new)
        across = frames.end(k, 1 - side) + frames.slide(k) * (1 if side else -1)
        frames.origins[new] = across - frames.arm(k, side)
    loops = [frames.end(k, 0) + frames.slide(k) - frames.end(k, 1) for k in chords]
    equations = np.stack(loops, axis=-3) if loops else np.zeros((*batch, 0, 1 + frames.unknowns, 2), complex)
    moved = np.moveaxis(equations, -3, -2)
    origins = np.stack([frames.origins[b] for b in range(structure.n)], axis=-3)
    return Loops(moved[..., 0, :, :], moved[..., 1:, :, :], guides, turning, origins)


class _Frames:
    """Positions as arrays (..., 1 + unknowns, 2), linear in 1, the rotations and the displacements."""

    def __init__(
        self,
        structure: Structure,
        points: Number,
        directions: Number,
        turning: Turning,
        guides: tuple[int | None, ...],
        batch: tuple[int, ...],
    ) -> None:
        self.structure, self.points, self.directions, self.turning = structure, points, directions, turning
        self.rotations = 1 + max((k for k in turning.rotation if k is not None), default=-1)
        self.unknowns = self.rotations + len(guides)
        self.batch = batch
        slides = [k for k, slide in enumerate(structure.slides) if slide]
        self.displacement = {k: 1 + self.rotations + i for i, k in enumerate(slides)}
        self.origins: dict[int | None, Number] = {None: self._zero()}

    def _zero(self) -> Number:
        return np.zeros((*self.batch, 1 + self.unknowns, 2), dtype=complex)

    def arm(self, k: int, side: int) -> Number:
        """From the origin of a body to its point of connection `k`."""
        return self._turned(self.structure.bodies[k][side], self.points[..., k, side, :])

    def end(self, k: int, side: int) -> Number:
        """Where a body's point of connection `k` is."""
        return self.origins[self.structure.bodies[k][side]] + self.arm(k, side)

    def slide(self, k: int) -> Number:
        """The displacement of a slide along its guide; zero for a pin."""
        out = self._zero()
        if k in self.displacement:
            guide = self.structure.bodies[k][0]
            factor = 1.0 if guide is None else self.turning.factors[..., guide, :]
            out[..., self.displacement[k], :] = factor * self.directions[..., k, 0, :]
        return out

    def _turned(self, body: int | None, vector: Number) -> Number:
        out = self._zero()
        rotation = None if body is None else self.turning.rotation[body]
        factor = 1.0 if body is None else self.turning.factors[..., body, :]
        out[..., 0 if rotation is None else 1 + rotation, :] = factor * vector
        return out


def _turning(structure: Structure, directions: Number) -> tuple[Turning, tuple[int | None, ...]]:
    """One rotation for all bodies that slides join, by walking along the slides from a first body."""
    unit = np.ones((*directions.shape[:-3], 2), dtype=complex)
    factors: dict[int | None, Number] = {None: unit}
    rotation: dict[int | None, int | None] = {None: None}
    _spread(structure, directions, None, factors, rotation)
    count = 0
    for body in range(structure.n):
        if body not in factors:
            factors[body], rotation[body] = unit, count
            count += 1
            _spread(structure, directions, body, factors, rotation)
    guides = tuple(rotation[structure.bodies[k][0]] for k, slide in enumerate(structure.slides) if slide)
    if count + len(guides) != 2 * (len(structure.bodies) - structure.n):
        raise InvalidInput(Problem("slides", "a chain of slides alone holds the same angle twice"))
    bodies = range(structure.n)
    return Turning(tuple(rotation[b] for b in bodies), np.stack([factors[b] for b in bodies], axis=-2)), guides


def _spread(
    structure: Structure,
    directions: Number,
    start: int | None,
    factors: dict[int | None, Number],
    rotation: dict[int | None, int | None],
) -> None:
    """Give all bodies that slides join to `start` its rotation."""
    reached = [start]
    for body in reached:
        for k, (a, b) in enumerate(structure.bodies):
            if structure.slides[k] and body in (a, b):
                new, own = (b, 0) if body == a else (a, 1)
                if new not in factors:
                    along = directions[..., k, own, :] * directions[..., k, 1 - own, ::-1]
                    factors[new], rotation[new] = factors[body] * along, rotation[start]
                    reached.append(new)
