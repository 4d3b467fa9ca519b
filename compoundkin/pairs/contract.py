"""What every kind of kinematic pair answers; each kind lives in one file of this folder.

A pair reports the relative coordinates between its links. The first `held` of them must stay zero (the
constraint); the others are free, and are what a drive may prescribe.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from typing import ClassVar, NamedTuple

import numpy as np

from compoundkin.errors import Problem
from compoundkin.geometry import Geometry
from compoundkin.keys import Key
from compoundkin.poses import End, Pose
from compoundkin.series import Number, Series


class Point(NamedTuple):
    """A relative instant centre at ``(x / w, y / w)``, at infinity in the direction (x, y) where w is zero.

    The free coordinate's rate times (x, y, w) is the motion of the second member relative to the first: the
    velocity of the point p is ``1j * (w * p - (x + 1j * y))`` times that rate.
    """

    x: Number
    y: Number
    w: Number


class Line(NamedTuple):
    """The line ``a x + b y + c w = 0`` that a relative instant centre lies on, such as a common normal."""

    a: Number
    b: Number
    c: Number


class Pair(ABC):
    """A kinematic pair between two links; subclasses are frozen dataclasses, one file each."""

    code: ClassVar[str]  # the letter in a group's name
    title: ClassVar[str]  # "revolute pair"
    held: ClassVar[int]  # how many relative coordinates stay zero
    free: ClassVar[tuple[str, ...]]  # the names of the others
    free_is_angle: ClassVar[bool]  # whether the free coordinate is an angle (else a length)
    table: ClassVar[str] = ""  # its table in a mechanism file; "" for pairs that are not written out
    keys: ClassVar[tuple[Key, ...]] = ()

    name: str

    @property
    @abstractmethod
    def members(self) -> tuple[str, str]:
        """The two links, the one that carries the reference first."""

    @property
    @abstractmethod
    def letters(self) -> tuple[str, ...]:
        """The names of the points it uses; the first is where it is drawn."""

    @abstractmethod
    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """What is wrong with the pair as written; `links` maps each link to its point names."""

    def completed(self, links: Mapping[str, tuple[str, ...]]) -> Pair:
        """The pair with what its words leave to be understood filled in."""
        return self

    @abstractmethod
    def ends(self, geometry: Geometry) -> tuple[End, End]:
        """The pair's side on each member, in the members' own frames."""

    @abstractmethod
    def closure(self, ends: tuple[End, End], poses: tuple[Pose, Pose]) -> tuple[Series, ...]:
        """The held relative coordinates as series: zero where the pair is closed."""

    @abstractmethod
    def coordinate(self, ends: tuple[End, End], poses: tuple[Pose, Pose]) -> Series:
        """The free relative coordinate as a series."""

    def drawn_coordinate(self, sketch: Mapping[str, Number]) -> Number | None:
        """The free coordinate as drawn points alone show it, without the links' poses; None where they do not."""
        return None

    @abstractmethod
    def jacobian(self, ends: tuple[End, End], poses: tuple[Pose, Pose]) -> Number:
        """The derivatives of `closure` and then `coordinate` by x, y, theta of the first member, then of the second.

        Shape (..., held + 1, 6), at the leading coefficient of the poses.
        """

    def centre(self, ends: tuple[End, End], poses: tuple[Pose, Pose]) -> Point | Line | None:
        """Where the relative instant centre is: a point, or the line it must lie on (higher pairs), or nothing.

        At the leading coefficient of the poses; which of the three it is depends on the kind of pair only.
        """
        return None

    @abstractmethod
    def placed(self, ends: tuple[End, End], free: Series) -> Pose:
        """The pose of the second member in the first one's frame when the free coordinate is `free`."""

    @abstractmethod
    def generic(self, rng: np.random.Generator) -> tuple[End, End]:
        """Ends of random geometry in the world at a pose where the pair is closed, for rank tests."""

    @abstractmethod
    def driven_by(self, link: str) -> int:
        """+1 if driving `link` drives the free coordinate itself, -1 if its opposite."""


def table(*rows: tuple[Number, ...]) -> Number:
    """Jacobian rows of six entries each, numbers or arrays, as one array (..., rows, 6).

    >>> table((1.0, 0.0, np.zeros(2), 0.0, 0.0, 0.0)).shape
    (2, 1, 6)
    """
    shape = np.broadcast_shapes(*[np.shape(entry) for row in rows for entry in row])
    out = np.empty((*shape, len(rows), 6))
    for i, row in enumerate(rows):
        for j, entry in enumerate(row):
            out[..., i, j] = entry
    return out
