"""Trial designs: values and slopes of outputs for goals and constraints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.studies.responses.designs import Designs, refined_samples
from compoundkin.studies.responses.response import Response


@dataclass(frozen=True, eq=False, repr=False)
class DesignTrial(ShortRepr):
    """Some designs along the motion, and the unknowns (designs, unknowns) of one goal. Results are computed once."""

    designs: Designs
    responses: Mapping[str, Response]
    unknowns: Number
    _elsewhere: dict[tuple[bytes, ...], DesignTrial] = field(default_factory=dict, init=False, repr=False)

    @property
    def number(self) -> int:
        """The number of designs."""
        return self.designs.number

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The free coordinates by which slopes are taken."""
        return self.designs.path.coordinates

    @property
    def drivers(self) -> tuple[str, ...]:
        """The names of the drivers."""
        return tuple(self.designs.inputs.drives)

    def values(self, name: str) -> Number:
        """Return an output: (designs,) of a figure, (designs, poses) of a course; NaN where not assembled."""
        return self.responses[name].values(self.designs)

    def slopes(self, name: str) -> Number:
        """Return its slopes by the coordinates, the last axis."""
        return np.moveaxis(self.responses[name].slopes(self.designs), 0, -1)

    def driver_slopes(self, name: str, driver: str) -> Number:
        """Return the slopes of a course by a driver's value, (designs, poses)."""
        return np.asarray(self.designs.slopes[name, driver])

    def at(self, driver: str, values: Number) -> DesignTrial:
        """Return the same designs at other values of one driver, (poses,) or (designs, poses).

        All other drivers stay where the motion begins; rates that vary along the motion are those of its first pose.
        """
        placed = np.atleast_2d(np.asarray(values, dtype=float))
        key = (driver.encode(), placed.tobytes(), str(placed.shape).encode())
        if key not in self._elsewhere:
            inputs = self.designs.inputs
            first = {name: tuple(_first(one) for one in rates) for name, rates in inputs.drives.items()}
            drives = {**first, driver: (placed, *first[driver][1:])}
            elsewhere = inputs.of_poses(placed.shape[-1]).driven(drives)
            self._elsewhere[key] = replace(self, designs=self.designs.at(elsewhere))
        return self._elsewhere[key]

    @property
    def closely(self) -> DesignTrial:
        """The same designs with refined samples, where the poses of the motion are far apart."""
        places = refined_samples(self.designs.poses)
        if len(places) == self.designs.poses:
            return self
        key = (b"closely",)
        if key not in self._elsewhere:
            every = np.broadcast_to(places, (self.number, len(places)))
            self._elsewhere[key] = replace(self, designs=self.designs.between(np.arange(self.number), every))
        return self._elsewhere[key]

    def apart(self, driver: str, values: Number) -> PosesApart:
        """Return the same designs at separate values of one driver, (designs, poses).

        No motion joins them: limits between them are not searched, and turns of angles not counted.
        """
        rows = np.repeat(np.arange(self.number), values.shape[1])
        whole = replace(self, designs=self.designs.picked(rows))
        return PosesApart(whole.at(driver, values.reshape(-1, 1)), values.shape)


@dataclass(frozen=True, eq=False, repr=False)
class PosesApart(ShortRepr):
    """Separate poses of designs, each a design of one pose in `single`."""

    single: DesignTrial
    shape: tuple[int, int]

    def values(self, name: str) -> Number:
        """Return a course, (designs, poses)."""
        return self.single.values(name).reshape(self.shape)

    def slopes(self, name: str) -> Number:
        """Return its slopes by the coordinates, the last axis."""
        return self.single.slopes(name).reshape(*self.shape, -1)

    def driver_slopes(self, name: str, driver: str) -> Number:
        """Return its slopes by a driver's value, (designs, poses)."""
        return self.single.driver_slopes(name, driver).reshape(self.shape)


def _first(rate: Number) -> Number:
    return rate[..., :1] if np.ndim(rate) else rate


def real_parts(vectors: Number) -> Number:
    """Return complex residuals as real ones along the second axis: all x, then all y.

    >>> real_parts(np.array([[1 + 2j, 3 + 4j]])).tolist()
    [[1.0, 3.0, 2.0, 4.0]]
    """
    return np.concatenate([vectors.real, vectors.imag], axis=1) if np.iscomplexobj(vectors) else vectors
