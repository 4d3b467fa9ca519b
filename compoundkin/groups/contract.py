"""What every kind of Assur group answers; each kind lives in one file of this folder.

A kernel closes a group by one textbook formula in series arithmetic. It sees a body of the group as its
pose, unknown, and the sides of pairs in the body's own frame, known; and of the outside only the sides of
the outer pairs in the world.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar, NamedTuple

import numpy as np

from compoundkin.poses import End, Pose
from compoundkin.series import Number, Series

# Below this fraction of its largest terms a discriminant is zero: rounding of a limit position, where
# the group is stretched or folded. A few hundred units in the last place of the terms it is the difference of.
LIMIT = 1e-13


class Attachment(NamedTuple):
    """An outer pair: its side in the world, and its side in the frame of the group's body."""

    world: End
    local: End


class Closed(NamedTuple):
    """A group solved: the poses of its two bodies, and the margin, negative where it cannot be assembled."""

    poses: tuple[Pose, Pose]
    margin: Number


class Dyad(ABC):
    """A group of two bodies, solved in closed form."""

    name: ClassVar[str]
    modes: ClassVar[int]  # how many assembly modes it has
    sign_means: ClassVar[str]  # what mode +1 is
    follows_inner: ClassVar[bool] = False  # whether the first body must carry the inner pair's first member

    @staticmethod
    @abstractmethod
    def close(
        first: Attachment, inner: tuple[End, End], second: Attachment, sign: Number, limit: float = LIMIT
    ) -> Closed:
        """Solve the group; `inner` is the inner pair's side on the first and on the second body.

        `limit` is the fraction of overlap treated as touching; infinity gives the nearest approach instead.
        """

    @staticmethod
    @abstractmethod
    def explain(first: Attachment, inner: tuple[End, End], second: Attachment, at: int, names: tuple[str, str, str]) -> str:
        """Why the group cannot be assembled at the flat pose index `at`; `names` are the letters of its pairs."""


def root(discriminant: Series, scale: Number, limit: float) -> tuple[Series, Number]:
    """The square root, with zero for a discriminant that is zero but for rounding; and the margin.

    >>> from compoundkin.series import constant
    >>> value, margin = root(constant(np.array([4.0, -1e-15])), 1.0, LIMIT)
    >>> value.c[0].tolist()
    [2.0, 0.0]
    """
    lead = discriminant.c[0]
    slack = limit * scale if limit != np.inf else np.inf
    margin = lead + slack
    clipped = np.where((lead < 0) & (margin >= 0), 0.0, lead)
    return Series((clipped, *discriminant.c[1:])).sqrt(), margin


def placed_at(point: Series, u: Series, local: Series | Number) -> Pose:
    """The pose with orientation `u` that has the body's point `local` at `point`."""
    return Pose(Pose(point, u).at(-local), u)


def text(value: Number, at: int) -> str:
    """One element of a number or array, for a sentence."""
    flat = np.asarray(value).ravel()
    return f"{flat[at if flat.size > 1 else 0]:.6g}"
