"""A mechanism at one pose: the places, angles and links that other programs keep."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number, first_entry
from compoundkin.base.errors import InvalidInput, NotAssembled, NotDetermined, Problem
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import first_number
from compoundkin.kinematics import Motion
from compoundkin.kinematics.nearest_pose import exactly_drawn, pose_nearest_to_drawing
from compoundkin.kinematics.solution import quietly_solved
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.structure import Structure, decompose

# What the arithmetic of a pose leaves of a place, as a part of the size.
_LAST_DIGITS = 1e-12


@dataclass(frozen=True, eq=False)
class PosedMechanism:
    """A mechanism of one design at one pose.

    `poses` are those of all links, the parts of cylinders among them, numbers with their rates; `values` and `rates`
    those of the drivers. `motion` is over the drivers' own ranges, or at the pose asked for; None where it cannot be
    solved and is shown as drawn: then there are no values.
    """

    structure: Structure
    poses: Mapping[str, Pose]
    values: Mapping[str, float]
    rates: Mapping[str, float]
    motion: Motion | None = None

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism."""
        return self.structure.mechanism

    def place(self, link: str, point: str | complex) -> complex:
        """Return where a point of a link is.

        It is told by its letter or its place in the link's frame. A letter that is drawn there but for rounding is
        where it is drawn, so that files come back digit by digit.
        """
        if not isinstance(point, str):
            return complex(self.poses[link].at(point).c[0])
        place = complex(self.poses[link].at(self.points[link][point]).c[0])
        drawn = self.mechanism.sketch.get(point)
        if drawn is None or abs(first_entry(drawn) - place) > _LAST_DIGITS * self.mechanism.geometry.size:
            return place
        return complex(first_entry(drawn))

    def direction(self, link: str, own: complex) -> complex:
        """Return a direction of a link's frame in space."""
        return complex(self.poses[link].u.c[0] * own)

    @cached_property
    def points(self) -> Mapping[str, Mapping[str, complex]]:
        """The points of each link in its own frame."""
        placed = self.mechanism.geometry.points
        return {name: {k: complex(first_entry(p)) for k, p in own.items()} for name, own in placed.items()}

    @cached_property
    def ends(self) -> Mapping[str, tuple[Any, ...]]:
        """The sides of the pairs that are written out, by the pairs' names.

        They are numbers in the links' frames.
        """
        geometry = self.mechanism.geometry
        return {
            pair.name: tuple(End(*map(first_number, end)) for end in pair.ends(geometry))
            for pair in self.mechanism.written_pairs
        }

    @property
    def pairs(self) -> tuple[Pair, ...]:
        """The pairs that are written out: all but the pins."""
        return self.mechanism.written_pairs


def posed_mechanism(mechanism: Mechanism, at: Mapping[str, float] | None = None) -> PosedMechanism:
    """Return a mechanism at driver values (radians, lengths).

    Without them it is the pose that is drawn exactly, else the one of its motion nearest to the drawing. Raises
    InvalidInput for several designs, NotAssembled where there is no pose.
    """
    structure = decompose(mechanism)
    try:
        motion = quietly_solved(structure, at)
    except (InvalidInput, NotAssembled, NotDetermined):
        if at is None and set(mechanism.drawn_poses) >= set(mechanism.links):
            return PosedMechanism(structure, {k: p.entry((0, 0)) for k, p in mechanism.drawn_poses.items()}, {}, {})
        raise
    if motion.inputs.designs > 1:
        what = f"it has {motion.inputs.designs} designs, a file of another program holds one"
        raise InvalidInput(Problem(mechanism.title, what, "give the dimensions of one design"))
    if at is not None and motion.inputs.poses > 1:
        what = f"it is given {motion.inputs.poses} poses, a file of another program holds one"
        raise InvalidInput(Problem("at", what, "give one value of each driver"))
    exact = exactly_drawn(motion) if at is None else None
    shown, pose = (motion, pose_nearest_to_drawing(motion)) if exact is None else (exact, 0)
    return PosedMechanism(
        structure,
        {name: place.entry((0, pose)) for name, place in shown.poses.items()},
        {name: _entry(drive.value, pose) for name, drive in shown.drives.items()},
        {name: _entry(drive.rate, pose) for name, drive in shown.drives.items()},
        motion,
    )


def _entry(values: Number, pose: int) -> float:
    """Return a driver's number at a pose; one that is the same at all of them is told once."""
    row = np.ravel(values)
    return float(row[min(pose, row.size - 1)])
