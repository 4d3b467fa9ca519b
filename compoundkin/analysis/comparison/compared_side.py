"""One of two mechanisms that are compared, as it moves by itself and at the pose nearest to its drawing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics import Motion
from compoundkin.kinematics.nearest_pose import exactly_drawn, pose_nearest_to_drawing
from compoundkin.kinematics.quiet_solution import quietly_solved
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import Structure


@dataclass(frozen=True, eq=False)
class ComparedSide:
    """A mechanism solved over its drivers' own ranges. Its lengths count `scale` times.

    `there` is one pose of it: the drawn one, or where that is not exact, the one of its motion nearest to the drawing.
    """

    motion: Motion
    there: Motion
    scale: float = 1.0

    @property
    def structure(self) -> Structure:
        """What it is made of."""
        return self.motion.structure

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism."""
        return self.structure.mechanism

    @cached_property
    def letters(self) -> tuple[str, ...]:
        """The points, without those that are only thought."""
        thought = self.mechanism.auxiliary_links
        return tuple(k for k, names in self.mechanism.carriers.items() if not thought.issuperset(names))

    @cached_property
    def fixed(self) -> frozenset[str]:
        """The points of the frame."""
        return frozenset(k for k in self.letters if FRAME in self.mechanism.carriers[k])

    @cached_property
    def marks(self) -> tuple[str, ...]:
        """The points that a pose is known by. Those are the moving pins, or where there are none what moves."""
        moving = [k for k in self.letters if k not in self.fixed]
        return tuple(k for k in moving if k in self.mechanism.pins) or tuple(moving)

    @cached_property
    def tracers(self) -> tuple[str, ...]:
        """The moving points of one link that no pair has."""
        used = {k for pair in self.mechanism.written_pairs for k in pair.letters}.union(self.fixed, self.mechanism.pins)
        return tuple(k for k in self.letters if k not in used)

    @property
    def shown(self) -> dict[str, float]:
        """The drivers' values at the pose nearest to the drawing."""
        return _values(self.there, 0)

    @property
    def size(self) -> float:
        """The length scale."""
        return self.motion.size * self.scale

    def values(self, pose: int) -> dict[str, float]:
        """Return the drivers' values at a pose of its own motion."""
        return _values(self.motion, pose)

    def speed(self, name: str) -> float:
        """Return the speed of a driver at the start of its own motion."""
        return float(np.ravel(self.motion.drives[name].rate)[0])

    def at(self, values: Mapping[str, Number], order: int = 1) -> Motion:
        """Return its motion at other values of the drivers, quietly."""
        return quietly_solved(self.structure, {k: np.atleast_1d(v) for k, v in values.items()}, order)

    def rates(self, values: Mapping[str, float]) -> tuple[Number, Number]:
        """Return where its points are, and how fast drivers move them.

        Rates are those by each driver alone at unit speed, (points, drivers).
        """
        rates = np.zeros((len(self.letters), len(values)), dtype=complex)
        motion = self.there
        for column, moved in enumerate(values):
            motion = quietly_solved(self.structure, values, 1, {name: float(name == moved) for name in values})
            rates[:, column] = [np.ravel(motion.points[k].velocity)[0] for k in self.letters]
        return self.places(motion)[0], rates * self.scale

    def places(self, motion: Motion) -> Number:
        """Return where its points are, (poses, points)."""
        found = [np.broadcast_to(motion.points[k].position, motion.shape).ravel() for k in self.letters]
        return np.stack(found, axis=-1) * self.scale

    def scaled(self, scale: float) -> ComparedSide:
        """Return it in another unit."""
        return replace(self, scale=scale)


def compared_side(structure: Structure) -> ComparedSide:
    """Return a mechanism as it moves by itself. Raises InvalidInput for several designs, and as `solve`."""
    motion = quietly_solved(structure, None, 1)
    if motion.inputs.designs > 1:
        what = f"it has {motion.inputs.designs} designs"
        raise InvalidInput(Problem(motion.mechanism.title, what, "compare one design of it"))
    drawn = exactly_drawn(motion)
    if drawn is None:
        drawn = quietly_solved(structure, _values(motion, pose_nearest_to_drawing(motion)), 1)
    return ComparedSide(motion, drawn)


def _values(motion: Motion, pose: int) -> dict[str, float]:
    """Return the drivers' values at a pose of a motion."""
    return {name: float(np.ravel(drive.value)[pose]) for name, drive in motion.drives.items()}
