"""What every kind of Assur group answers; each kind lives in one file of this folder.

A kernel closes a group by one textbook formula in series arithmetic. It sees a body of the group as its
pose, unknown, and the sides of pairs in the body's own frame, known; and of the outside only the sides of
the outer pairs in the world.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import ClassVar, NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Number, Series

# Below this fraction of its largest terms a discriminant is zero: rounding of a limit position, where
# the group is stretched or folded. A few hundred units in the last place of the terms it is the difference of.
LIMIT = 1e-13
# Outer pins nearer to each other than this part of a link coincide but for rounding, which must not choose
# the direction of that link.
COINCIDENT = 1e-13


# How a kernel takes the square root of a discriminant: (discriminant, scale) -> (root, margin).
Root: TypeAlias = Callable[[Series, Number], tuple[Series, Number]]


class Attachment(NamedTuple):
    """An outer pair: its side in the world, and its side in the frame of the group's body."""

    world: End
    local: End


class Closed(NamedTuple):
    """A group solved: the poses of its two bodies, and the margin, negative where it cannot be assembled.

    For a group of two modes the margin is the squared sine of the angle in which the modes differ. `meeting`
    is a squared length whose zero leaves the pose undetermined, for groups that have such a place.
    """

    poses: tuple[Pose, Pose]
    margin: Number
    meeting: Number | None = None


class Dyad(ABC):
    """A group of two bodies, solved in closed form."""

    name: ClassVar[str]
    modes: ClassVar[int]  # how many assembly modes it has
    sign_means: ClassVar[str]  # what mode +1 is
    follows_inner: ClassVar[bool] = False  # whether the first body must carry the inner pair's first member

    @staticmethod
    @abstractmethod
    def close(first: Attachment, inner: tuple[End, End], second: Attachment, sign: Number, root: Root = ...) -> Closed:
        """Solve the group; `inner` is the inner pair's side on the first and on the second body.

        `root` takes the square root of the discriminant, given a scale of its terms, and gives the margin.
        """

    @staticmethod
    @abstractmethod
    def explain(
        first: Attachment, inner: tuple[End, End], second: Attachment, at: int, names: tuple[str, str, str]
    ) -> str:
        """Why the group cannot be assembled at the flat pose index `at`; `names` are the letters of its pairs."""


def clipped_root(discriminant: Series, scale: Number) -> tuple[Series, Number]:
    """The square root, with zero for a discriminant that is zero but for rounding; and the margin.

    >>> from compoundkin.base.series import constant
    >>> value, margin = clipped_root(constant(np.array([4.0, -1e-15])), 1.0)
    >>> value.c[0].tolist()
    [2.0, 0.0]
    """
    margin = np.divide(discriminant.c[0], scale) + LIMIT
    clipped = np.where(margin >= 0, np.maximum(discriminant.c[0], 0.0), np.nan)
    return Series((clipped, *discriminant.c[1:])).sqrt(), margin


def nearest_root(discriminant: Series, scale: Number) -> tuple[Series, Number]:
    """The square root, or zero: where a group cannot be assembled, its nearest approach."""
    lead = np.maximum(discriminant.c[0], 0.0)
    return Series((lead, *discriminant.c[1:])).sqrt(), np.ones_like(lead)


def double_root(where: Number) -> Root:
    """The root that takes, where asked, the discriminant to be a square: zero, and so is its first rate.

    There the root is ``t sqrt(c[2] + c[3] t + ...)``: the group passes through its limit position without
    turning back. Two coefficients are lost: the last two of the result mean nothing.
    """

    def root(discriminant: Series, scale: Number) -> tuple[Series, Number]:
        plain, margin = clipped_root(discriminant, scale)
        inner = Series(discriminant.c[2:]).sqrt().c
        through = (np.zeros_like(margin), *inner, np.zeros_like(margin))
        return Series(tuple([np.where(where, t, p) for t, p in zip(through, plain.c, strict=True)])), margin

    return root


def placed_at(point: Series, u: Series, local: Series | Number) -> Pose:
    """The pose with orientation `u` that has the body's point `local` at `point`."""
    return Pose(Pose(point, u).at(-local), u)


def element(value: Number, at: int) -> float:
    """One element, by its flat index, of an array; or the number that holds for all."""
    flat = np.asarray(value).ravel()
    return float(flat[at if flat.size > 1 else 0])


def text(value: Number, at: int) -> str:
    """One element of a number or array, for a sentence."""
    return f"{element(value, at):.6g}"
