"""Constraint that links keep clear of each other by their outlines.

The corners of an outline depend on a design: points follow their letters, places their link.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.analysis.clearances import (
    ComparedBodies,
    compared_outlines,
    geometries,
    nearest_places,
    shape_clearance,
    shapely,
)
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.kinematics.motion import Motion
from compoundkin.model.attributes import ANGLE, AXES, POSITION
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import values_of_design
from compoundkin.model.outline_shapes import OutlineShape, Points, outline_shapes
from compoundkin.studies.goals.design_trial import DesignTrial
from compoundkin.studies.goals.goal import DesignConstraint


@dataclass(frozen=True)
class ClearanceConstraint(DesignConstraint):
    """The least clearance of the outlines of links at all poses.

    Between two links, between one and all others, or between all.
    """

    value: float
    links: tuple[str, ...]

    @property
    def description(self) -> str:
        """The links and the least clearance."""
        return f"{' and '.join(self.links) or 'links'} at least {self.value:g} clear"

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the positions of all corners. Raises InvalidInput where no outlines are compared."""
        shapely("goals.clearance")
        bodies = [*self._compared(motion)]
        known = {name for one in _all(motion) for name in (one.one, one.other)}
        for name in self.links:
            if name not in known:
                what = "no outline of it is compared with another"
                raise UnknownName(Problem(f"goals.clearance.{name}", what, suggestion(name, sorted(known))))
        if not bodies:
            what, remedy = "no two links with outlines share a layer", 'write some: outline("crank", 8)'
            raise InvalidInput(Problem("goals.clearance", what, remedy))
        points = _points(motion)
        corners = (OutlineVertices.of(shape, points) for one in bodies for two in one.shapes for shape in two)
        return tuple(dict.fromkeys(name for one in corners for name in one.outputs()))

    def _compared(self, motion: Motion) -> Iterator[ComparedBodies]:
        for one in _all(motion):
            if set(self.links) <= {one.one, one.other}:
                yield one

    def margins(self, trial: DesignTrial) -> Number:
        """Return the clearance of each two bodies less the required one."""
        return (
            np.stack([clearances.min(axis=(1, 2)) for clearances, _ in self._pair_clearances(trial)], axis=1)
            - self.value
        )

    def _pair_clearances(self, trial: DesignTrial) -> Iterator[tuple[Number, ComparedBodies]]:
        """Yield each two bodies with their clearances, (designs, shapes, poses)."""
        there, motion = trial.closely, trial.designs.path.reference
        for bodies in self._compared(motion):
            yield np.stack([_clearances(there, _points(motion), two) for two in bodies.shapes], axis=1), bodies

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of the margins at their poses; zero where cores cross, as they are unknown."""
        there, points = trial.closely, _points(trial.designs.path.reference)
        found = []
        for clearances, bodies in self._pair_clearances(trial):
            flat = clearances.reshape(len(clearances), -1)
            best, pose = np.divmod(np.where(np.isnan(flat).any(axis=1), 0, flat.argmin(axis=1)), clearances.shape[2])
            slopes = np.full((len(clearances), len(trial.coordinates)), np.nan)
            for k, two in enumerate(bodies.shapes):
                rows = np.flatnonzero((best == k) & np.isfinite(flat).all(axis=1))
                both = [OutlineVertices.of(shape, points) for shape in two]
                slopes[rows] = _slopes(there, both, rows, pose[rows])
            found.append(slopes)
        return np.stack(found, axis=1)


def _all(motion: Motion) -> tuple[ComparedBodies, ...]:
    """Return all compared bodies of the original mechanism."""
    points = _points(motion)
    shapes = outline_shapes(motion.mechanism, points, motion.shape)
    return compared_outlines(motion.mechanism, shapes, points).compared


def _points(motion: Motion) -> Points:
    points: Points = values_of_design(motion.mechanism.geometry.points, motion.shape, 0)
    return points


def _clearances(trial: DesignTrial, points: Points, two: tuple[object, object]) -> Number:
    """Return the clearance of two shapes, (designs, poses); NaN where a design is not assembled."""
    one, other = (OutlineVertices.of(shape, points) for shape in two)  # type: ignore[arg-type]
    a, b = one.values(trial), other.values(trial)
    known = np.isfinite(a).all(axis=-1) & np.isfinite(b).all(axis=-1)
    found = np.full(known.shape, np.nan)
    cores = geometries(a[known], one.shape.closed), geometries(b[known], other.shape.closed)
    found[known] = shape_clearance(one.shape, other.shape, cores)
    return found


def _slopes(trial: DesignTrial, both: list[OutlineVertices], rows: Number, pose: Number) -> Number:
    """Return the slopes of the clearance of two shapes at one pose of each of some designs."""
    vertices = [one.values(trial)[rows, pose] for one in both]
    first, second = (geometries(own, one.shape.closed) for one, own in zip(both, vertices, strict=True))
    ends = nearest_places((first, second))
    apart = ends[:, 1] - ends[:, 0]
    with np.errstate(invalid="ignore", divide="ignore"):
        unit = np.where(apart == 0.0, 0.0, np.conjugate(apart) / np.abs(apart))
    moved = [np.einsum("nv,nvc->nc", nearest_weights(own, one.shape.closed, ends[:, k]), one.slopes(trial)[rows, pose])
             for k, (one, own) in enumerate(zip(both, vertices, strict=True))]  # fmt: skip
    return np.asarray((unit[:, None] * (moved[1] - moved[0])).real)


@checked
def clearance(at_least: float, one: str | None = None, other: str | None = None) -> DesignConstraint:
    """Return the constraint that links keep clear of each other by their outlines.

    Between two links, between `one` and all others on its layers, or between all links: those that `interference`
    compares, at steps of at most ten degrees along the motion. Raises InvalidInput for a negative or infinite number.

    >>> clearance(2.0, "crank", "frame").description
    'crank and frame at least 2 clear'
    """
    if not np.isfinite(at_least) or at_least < 0.0:
        raise InvalidInput(Problem("goals.clearance", f"{at_least} is no clearance", "give 0 or more"))
    return ClearanceConstraint(float(at_least), tuple(name for name in (one, other) if name is not None))


@dataclass(frozen=True, eq=False, repr=False)
class OutlineVertices(ShortRepr):
    """The corners of a shape's core. `points` are those of its link in the original mechanism."""

    shape: OutlineShape
    points: Mapping[str, complex]

    @classmethod
    def of(cls, shape: OutlineShape, points: Points) -> OutlineVertices:
        """Return the corners of a shape."""
        return cls(shape, points[shape.link])

    @property
    def _origin(self) -> str:
        """The reference point of other places on the link."""
        return next(iter(self.points))

    @property
    def _has_places(self) -> bool:
        return not all(self.shape.letters) and self.shape.link != FRAME

    def outputs(self) -> Iterator[str]:
        """Yield the outputs of a trial that they need."""
        yield from (f"{letter}.{POSITION}" for letter in self.shape.letters if letter)
        if self._has_places:
            yield f"{self._origin}.{POSITION}"
            yield f"{self.shape.link}.{ANGLE}"

    def values(self, trial: DesignTrial) -> Number:
        """Return their positions, (designs, poses, corners)."""
        places = [self._place(trial, q) if not letter else trial.values(f"{letter}.{POSITION}")
                  for q, letter in zip(self.shape.core, self.shape.letters, strict=True)]  # fmt: skip
        shape = trial.number, trial.designs.poses
        return np.stack([np.broadcast_to(one, shape) for one in places], axis=-1)

    def _place(self, trial: DesignTrial, q: complex) -> Number:
        if self.shape.link == FRAME:
            return np.array([[q]])
        turn = np.exp(1j * trial.values(f"{self.shape.link}.{ANGLE}"))
        return trial.values(f"{self._origin}.{POSITION}") + turn * (q - self._own(trial))

    def _own(self, trial: DesignTrial) -> Number:
        """Return the place of the reference point on its link, which may be a free dimension, (designs, 1)."""
        name, given = f"{self.shape.link}.{self._origin}", trial.designs.dimensions
        if name in given:
            return np.reshape(given[name], (-1, 1))
        own = self.points[self._origin]
        x, y = (given.get(f"{name}.{part}", number) for part, number in zip(AXES, (own.real, own.imag), strict=True))
        return np.reshape(x + 1j * np.asarray(y), (-1, 1))

    def slopes(self, trial: DesignTrial) -> Number:
        """Return their slopes, (designs, poses, corners, coordinates)."""
        shape = trial.number, trial.designs.poses, len(trial.coordinates)
        found = [self._place_slopes(trial, q) if not letter else trial.slopes(f"{letter}.{POSITION}")
                 for q, letter in zip(self.shape.core, self.shape.letters, strict=True)]  # fmt: skip
        return np.stack([np.broadcast_to(one, shape) for one in found], axis=2)

    def _place_slopes(self, trial: DesignTrial, q: complex) -> Number:
        if self.shape.link == FRAME:
            return np.zeros(1, dtype=complex)
        angle, off = f"{self.shape.link}.{ANGLE}", q - self._own(trial)
        turn = np.exp(1j * trial.values(angle))[..., None]
        names = [f"{self.shape.link}.{self._origin}.{part}" for part in AXES]
        moved = np.array([dict(zip(names, (1.0, 1j), strict=True)).get(one, 0.0) for one in trial.coordinates])
        turned = 1j * trial.slopes(angle) * np.broadcast_to(off, turn.shape[:2])[..., None]
        return trial.slopes(f"{self._origin}.{POSITION}") + turn * (turned - moved)


def nearest_weights(vertices: Number, closed: bool, place: Number) -> Number:
    """Return the weights of corners (n, corners) for places on the edge of a core.

    >>> nearest_weights(np.array([[0j, 4 + 0j]]), False, np.array([1 + 0j])).tolist()
    [[0.75, 0.25]]
    """
    count = vertices.shape[-1]
    if count == 1:
        return np.ones((len(place), 1))
    start = np.arange(count if closed else count - 1)
    stop = (start + 1) % count
    a, b = vertices[:, start], vertices[:, stop]
    part = np.clip(((place[:, None] - a) * np.conjugate(b - a)).real / np.abs(b - a) ** 2, 0.0, 1.0)
    side = np.abs(a + part * (b - a) - place[:, None]).argmin(axis=1)
    rows, found = np.arange(len(place)), np.zeros((len(place), count))
    found[rows, start[side]] = 1.0 - part[rows, side]
    found[rows, stop[side]] += part[rows, side]
    return found
