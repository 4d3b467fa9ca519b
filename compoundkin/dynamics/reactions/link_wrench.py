"""A wrench on a link with its name, its kind and its point of attack."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number, Vectors, cross
from compoundkin.base.display import ShortRepr
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.reactions.reverse_pass import UndeterminedPart
from compoundkin.kinematics.extremes import extended_to
from compoundkin.kinematics.motion import Motion
from compoundkin.model.geometry import vector

# Kinds of wrenches on a link besides loads, which have kinds of their own.
PAIR, DRIVER, WEIGHT, INERTIA, FRICTION = "pair", "driver", "weight", "inertia", "friction"
UNKNOWN_VECTOR = complex(np.nan, np.nan)


@dataclass(frozen=True, eq=False, repr=False)
class LinkWrench(ShortRepr):
    """A wrench on a link, in the mechanism's units.

    Arrays have the motion's shape, NaN where not assembled. `kind` is "pair", "driver", "weight", "inertia",
    "friction" or the kind of a load; `by` is the link it comes from, if it comes from one; `at` names the point of
    attack; `whole` is the wrench about the world's origin (designs, poses), `attack` the point of attack in the world.
    Parts that equilibrium does not determine (`open`) are NaN; `whole` is then one of the possible wrenches.
    """

    motion: Motion = field(repr=False)
    kind: str
    name: str
    on: str
    by: str
    at: str
    whole: Wrench = field(repr=False)
    attack: Number = field(repr=False)
    open: UndeterminedPart | None = field(default=None, repr=False)

    @property
    def determined(self) -> Wrench:
        """The wrench about the world's origin, NaN where equilibrium leaves it open, (designs, poses)."""
        if self.open is None:
            return self.whole
        with np.errstate(invalid="ignore"):
            moment = np.where(self.open.moment, np.nan, self.whole.about(self.attack))
        return Wrench.at(self.attack, np.where(self.open.force, UNKNOWN_VECTOR, self.whole.force), moment)

    @property
    def wrench(self) -> Wrench:
        """The wrench, its moment about the world's origin."""
        return Wrench(self.force, self.motion.grid.known(self.determined.moment))

    @property
    def force(self) -> Vectors:
        """The force, complex; `.xy` gives (..., 2)."""
        return as_vectors(self.motion, self.determined.force)

    @property
    def place(self) -> Vectors:
        """The point of attack in the world."""
        return as_vectors(self.motion, self.attack)

    @property
    def moment(self) -> Number:
        """The moment about the point of attack."""
        with np.errstate(invalid="ignore"):  # infinite forces have no moment
            about = self.whole.about(self.attack)
        return self.motion.grid.known(about if self.open is None else np.where(self.open.moment, np.nan, about))

    def moment_about(self, point: Any) -> Number:
        """Return the moment about a letter or a place of the world."""
        return moment_about(self.motion, self.determined, point)


def as_vectors(motion: Motion, value: Number) -> Vectors:
    """Return planar vectors in a motion's shape. NaN where poses are not assembled."""
    found: Vectors = np.asarray(motion.grid.known(value)).astype(complex, copy=False).view(Vectors)
    return found


def moment_about(motion: Motion, wrench: Wrench, point: Any) -> Number:
    """Return a wrench's moment about a letter or a place of the world.

    The wrench is one over (designs, poses). Raises UnknownName for an unknown letter.
    """
    place = motion.points[point].position if isinstance(point, str) else vector("point", point)
    shown = motion.grid.known
    with np.errstate(invalid="ignore"):
        return np.asarray(shown(wrench.moment) - cross(np.asarray(place), np.asarray(shown(wrench.force))))


def place_in_world(motion: Motion, link: str, point: str | Number) -> Number:
    """Return where a point of a link is, (designs, poses). It is a letter or a place in the link."""
    own = motion.mechanism.geometry.points[link][point] if isinstance(point, str) else point
    return motion.poses[link].at(extended_to(motion, own)).c[0]


def line_of_action(motion: Motion, link: str, wrench: Wrench) -> Number:
    """Return the point of a line of action nearest to a link's origin. It is the origin where there is no force."""
    origin, force = motion.poses[link].z.c[0], wrench.force
    square = np.abs(force) ** 2
    arm = -1j * force * wrench.about(origin) / np.where(square == 0.0, 1.0, square)
    return origin + arm
