"""The corners of outlines of designs on trial, and their slopes: points follow their letters, places their link."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.model.attributes import ANGLE, AXES, POSITION
from compoundkin.model.geometry import FRAME
from compoundkin.model.outline_shapes import OutlineShape, Points
from compoundkin.studies.goals.design_trial import DesignTrial


@dataclass(frozen=True, eq=False, repr=False)
class OutlineVertices(ShortRepr):
    """The corners of a shape's core. `points` are those of its link in the mechanism as it stands."""

    shape: OutlineShape
    points: Mapping[str, complex]

    @classmethod
    def of(cls, shape: OutlineShape, points: Points) -> OutlineVertices:
        """Return those of a shape."""
        return cls(shape, points[shape.link])

    @property
    def _origin(self) -> str:
        """The point by which other places of the link are told."""
        return next(iter(self.points))

    @property
    def _has_places(self) -> bool:
        return not all(self.shape.letters) and self.shape.link != FRAME

    def outputs(self) -> Iterator[str]:
        """Yield what is asked of a trial for them."""
        yield from (f"{letter}.{POSITION}" for letter in self.shape.letters if letter)
        if self._has_places:
            yield f"{self._origin}.{POSITION}"
            yield f"{self.shape.link}.{ANGLE}"

    def values(self, trial: DesignTrial) -> Number:
        """Return where they are, (designs, poses, corners)."""
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
        """Return where the point of reference is on its link, which may be free, (designs, 1)."""
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
    """Return a place on the edge of a core as parts of its corners.

    They are (n, corners).

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
