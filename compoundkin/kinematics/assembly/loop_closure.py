"""Loop closure of a group: its bodies as plain numbers, origins along a spanning tree, an equation per closing pair."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import End
from compoundkin.base.series import Series
from compoundkin.kinematics.assembly.rotation_equations import BodyRotations, RotationEquations, isotropic
from compoundkin.kinematics.block import Block, size_in
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import as_turn_counting
from compoundkin.structure.mobility_count import Group


def rotation_equations_of(geometry: GroupGeometry) -> RotationEquations:
    """Write the loop equations of a group at all its poses. Lengths are divided by its size.

    >>> from compoundkin.kinematics.assembly.loop_closure import Connection
    >>> dyad = GroupGeometry(2, (
    ...     Connection((None, 0), (0, 0)), Connection((0, 1), (3, 0)), Connection((None, 1), (4, 2))), 1.0)
    >>> loops = rotation_equations_of(dyad)
    >>> loops.constant[..., 0], loops.columns[..., 0].ravel().tolist()
    (array([-4.+0.j]), [(3+0j), (2+0j)])
    """
    found = geometry.connections
    points = [np.stack(np.broadcast_arrays(*map(isotropic, c.points)), axis=-2) / geometry.unit for c in found]
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


# Two points of a body nearer than this part of the size are one pin: rounding of a few additions.
SAME = 1e-12


@dataclass(frozen=True)
class Connection:
    """A pin or a slide between two bodies, or to what is known.

    `bodies` are two indices, None for what is known. A pin holds `points[0]` of the first on `points[1]` of the
    second. With `directions` it is a slide: the first carries a guide through its point, along which the
    second's point runs, and the second's direction stays along the guide. Points and unit directions are
    complex, each in its own body, or in the world where known; scalars or arrays over poses.
    """

    bodies: tuple[int | None, int | None]
    points: tuple[Number, Number]
    directions: tuple[Number, Number] | None = None


@dataclass(frozen=True)
class GroupGeometry:
    """Bodies 0 to `n` - 1 with the `connections` that fix them all.

    There are exactly as many as needed; `size` is a typical length, perhaps of each pose.

    Raises `InvalidInput` where the number of connections does not fit.

    >>> dyad = GroupGeometry(2, (
    ...     Connection((None, 0), (0, 0)), Connection((0, 1), (3, 0)), Connection((None, 1), (4, 2))), 4.0)
    >>> dyad.loops
    1
    """

    n: int
    connections: tuple[Connection, ...]
    size: Number = 1.0

    def __post_init__(self) -> None:
        if 2 * len(self.connections) != 3 * self.n:
            what = f"{len(self.connections)} connections do not fix {self.n} bodies in finitely many ways"
            raise InvalidInput(Problem("connections", what, "give three for every two bodies"))

    @property
    def loops(self) -> int:
        """The number of independent loops."""
        return len(self.connections) - self.n

    @property
    def unit(self) -> Number:
        """The size, at each pose of an array with two more axes."""
        return np.reshape(self.size, (*np.shape(self.size), 1, 1))

    def pins(self) -> tuple[tuple[int, int], ...]:
        """Number the points of connections on each body, both sides: coinciding points have one."""
        seen: dict[int | None, list[Number]] = {}
        return tuple(
            (self._pin(seen, c.bodies[0], c.points[0]), self._pin(seen, c.bodies[1], c.points[1]))
            for c in self.connections
        )

    def _pin(self, seen: dict[int | None, list[Number]], body: int | None, point: Number) -> int:
        known = seen.setdefault(body, [])
        for k, other in enumerate(known):
            if np.all(np.abs(point - other) <= SAME * self.size):
                return k
        known.append(point)
        return len(known) - 1

    def graph(self) -> GroupGraph:
        """Return what does not depend on dimensions.

        It tells which bodies are joined, by what, and which pins coincide.
        """
        slides = tuple(c.directions is not None for c in self.connections)
        return GroupGraph(self.n, tuple(c.bodies for c in self.connections), slides, self.pins())


@dataclass(frozen=True)
class GroupGraph:
    """A group without its dimensions. It can be hashed, so that what depends on it alone is found once."""

    n: int
    bodies: tuple[tuple[int | None, int | None], ...]
    slides: tuple[bool, ...]
    pins: tuple[tuple[int, int], ...]

    def tree(self) -> tuple[tuple[tuple[int, int], ...], tuple[int, ...]]:
        """Build a spanning tree outward from what is known.

        It has (connection, new body) in order, and the other connections.

        Breadth first, so that loops are short.
        """
        reached: list[int | None] = [None]
        steps: list[tuple[int, int]] = []
        for body in reached:
            for k, new in self._around(body):
                if new is not None and new not in reached:
                    reached.append(new)
                    steps.append((k, new))
        if len(steps) < self.n:
            raise InvalidInput(Problem("connections", "some bodies are not attached to what is known"))
        used = {k for k, _ in steps}
        return tuple(steps), tuple(k for k in range(len(self.bodies)) if k not in used)

    def _around(self, body: int | None) -> Iterator[tuple[int, int | None]]:
        for k, (a, b) in enumerate(self.bodies):
            if body == a:
                yield k, b
            elif body == b:
                yield k, a

    def random(self, rng: np.random.Generator) -> tuple[Number, Number]:
        """Draw random dimensions with the same coinciding pins.

        They are points and directions (connections, 2 sides, 2).

        In isotropic coordinates, the two of a point independent, as a generic complex instance needs.
        """
        m = len(self.bodies)
        points = np.empty((m, 2, 2), dtype=complex)
        seen: dict[tuple[int | None, int], Number] = {}
        for k in range(m):
            for side in range(2):
                key = (self.bodies[k][side], self.pins[k][side])
                if key not in seen:
                    seen[key] = rng.standard_normal(2) + 1j * rng.standard_normal(2)
                points[k, side] = seen[key]
        direction = np.exp(2j * np.pi * rng.random((m, 2)) + 0.3 * rng.standard_normal((m, 2)))
        return points, np.stack([direction, 1 / direction], axis=-1)


def from_group(group: Group, block: Block, size: float) -> GroupGeometry:
    """Return the group as it is attached in a block, at all its poses. Body k is the group's body k.

    A composite body is taken in the frame of its base link, `links[0]`, with its shape at each pose. Raises
    `InvalidInput` where the group holds higher pairs, whose configurations are not finitely many rotations.
    """
    where = {link: k for k, body in enumerate(group.bodies) for link in body.links}
    connections = tuple(_connection(pair, where, block) for pair in (*group.inner, *group.outer))
    return GroupGeometry(len(group.bodies), connections, size_in(block.ends, size))


def _connection(pair: Pair, where: dict[str, int], block: Block) -> Connection:
    # what rolls holds two coordinates too, one of which counts turns
    if pair.held != 2 or len(pair.members) != 2 or as_turn_counting(pair):
        what = f"all configurations are known for groups of lower pairs only, not with a {pair.title}"
        raise InvalidInput(Problem(pair.name, what))
    first, second = (
        _in_body(link, end, where, block) for link, end in zip(pair.members, block.ends[pair.name], strict=True)
    )
    bodies = where.get(pair.members[0]), where.get(pair.members[1])
    points = _leading(first.point), _leading(second.point)
    directions = None if pair.free_is_angle else (_leading(first.direction), _leading(second.direction))
    return Connection(bodies, points, directions)


def _in_body(link: str, end: End, where: dict[str, int], block: Block) -> End:
    """Return a link's side of a pair in its composite body, or in the world where it is known."""
    frame = block.local.get(link) if link in where else block.world[link]
    return end if frame is None else frame.carry(end)


def _leading(value: Series | Number) -> Number:
    return value.c[0] if isinstance(value, Series) else value
