"""Configurations: where all links are, of a group or a mechanism, one or all of them in an array."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number, Vectors, entry, wrapped
from compoundkin.base.display import DisplaysHtml, count_phrase
from compoundkin.base.errors import InvalidInput, NotAssembled, Problem, UnknownName, suggestion
from compoundkin.base.poses import Pose
from compoundkin.structure.kinematic_structure import Structure

BETWEEN = " / "


# The configuration of a mechanism of which every group has one.
ONLY = "only one"


# How the modes of a group with signs are written; zero at its limit position, where both are one.
SIGNS = {1: "+", -1: "-", 0: "±"}


@dataclass(frozen=True, eq=False)
class Configuration(DisplaysHtml):
    """A mechanism assembled at one value of every driver, in one way. The values are radians or lengths.

    `poses` are those of all links. `modes[k]` is, for groups with several configurations, "+", "-" ("±" at the limit
    position) or the number. `margins[k]` tells for groups with signs how far the limit position is (a squared sine).
    """

    structure: Structure
    values: Mapping[str, float]
    poses: Mapping[str, Pose]
    modes: Mapping[int, str]
    margins: Mapping[int, float]
    dimensions: Mapping[str, Mapping[str, complex]]

    @cached_property
    def name(self) -> str:
        """The name of the configuration. It has the groups with more than one, each with its sign or number."""
        return named(self.structure, self.modes)

    @cached_property
    def points(self) -> Mapping[str, complex]:
        """Where every point is."""
        placed = (
            (letter, self.poses[link].at(p).c[0]) for link, ps in self.dimensions.items() for letter, p in ps.items()
        )
        return {letter: complex(place) for letter, place in placed}

    @cached_property
    def angles(self) -> Mapping[str, float]:
        """The angle of every link, radians, between -pi and pi."""
        return {link: float(pose.u.angle().c[0]) for link, pose in self.poses.items()}

    def __repr__(self) -> str:
        return f"Configuration({self.name!r} at {', '.join(f'{k} = {v:.6g}' for k, v in self.values.items())})"


@dataclass(frozen=True, eq=False)
class RestingCurve(DisplaysHtml):
    """A curve of configurations: `links` move although all drivers stand still.

    `through` is one of them; its name says nothing, for the groups of those on a curve have no modes.
    """

    links: tuple[str, ...]
    through: Configuration

    def __repr__(self) -> str:
        return f"RestingCurve({', '.join(self.links)})"


def label(structure: Structure, k: int) -> str:
    """Return the name of group `k` in a configuration's. It has its kind and its first link."""
    group = structure.groups[k]
    return f"{group.name}({group.links[0]})"


def named(structure: Structure, modes: Mapping[int, str]) -> str:
    """Return the name of a configuration: signs as RRR(coupler)+, numbers as RRR-RRR(plate) 3."""
    parts = (f"{label(structure, k)}{' ' if mode.isdecimal() else ''}{mode}" for k, mode in sorted(modes.items()))
    return BETWEEN.join(parts) or ONLY


def placed_at(poses: Mapping[str, Pose], at: tuple[int, ...]) -> dict[str, Pose]:
    """Return the poses of links at one index of their arrays."""
    return {k: Pose.of(complex(entry(p.z.c[0], at)), complex(entry(p.u.c[0], at))) for k, p in poses.items()}


def numbers_at(values: Mapping[Any, Number], at: tuple[int, ...]) -> dict[Any, float]:
    """Return numbers at one index of their arrays."""
    return {name: float(entry(value, at)) for name, value in values.items()}


def dimensions_at(structure: Structure, design: int, pose: int) -> dict[str, dict[str, complex]]:
    """Return the points of all links, in their frames, of one design."""

    def one(value: Number) -> complex:
        if np.ndim(value) == 0:
            return complex(value)
        rows = np.reshape(value, (-1, np.shape(value)[-1]))
        return complex(rows[min(design, len(rows) - 1), min(pose, rows.shape[1] - 1)])

    placed = structure.mechanism.geometry.points
    return {link: {name: one(value) for name, value in points.items()} for link, points in placed.items()}


@dataclass(frozen=True, eq=False)
class Configurations(DisplaysHtml):
    """All configurations of a group or a mechanism. They are arrays (..., m) over poses and, last, configurations.

    `bodies` are the poses (..., m) of a group's bodies by their numbers, or of a mechanism's links by their names; NaN
    where there are fewer, and without a picture where they are not `real`. `count` (...) are found: of a group over the
    complex numbers, of a mechanism the real ones. `possible` is their number over the complex numbers for generic
    dimensions (0 unknown). Where they are `certified` none is missing: closed forms, or as many were found as theory
    knows. Those of a mechanism are kept where they are real somewhere; they have their driver `values`, the `modes` of
    the groups of each, and the `margins` of the groups with signs. Where a group has fewer than are possible, some may
    be a `curve`, on which links move at the first driver values; those that are listed stand alone.
    """

    bodies: Mapping[Any, Pose]
    real: Number
    count: Number
    possible: int
    certified: Any
    of: Structure | None = None
    values: Mapping[str, Number] = field(default_factory=dict)
    modes: tuple[Mapping[int, str], ...] = ()
    margins: Mapping[int, Number] = field(default_factory=dict)
    curve: RestingCurve | None = None

    @classmethod
    def of_closed_form(cls, bodies: Sequence[Pose], real: Number, shape: tuple[int, ...]) -> Configurations:
        """Return those of closed forms, none of which is missing. The first axis of all arrays is theirs."""

        def last(value: Number) -> Number:
            return np.moveaxis(np.broadcast_to(value, shape), 0, -1)

        poses = {k: Pose.of(last(pose.z.c[0]), last(pose.u.c[0])) for k, pose in enumerate(bodies)}
        return cls(poses, last(real), np.full(shape[1:], shape[0]), shape[0], np.full(shape[1:], True))

    @classmethod
    def of_states(cls, states: Number) -> Configurations:
        """Return those that a search found. Their states are (..., m, 3 n), x, y, theta of each body, NaN pads."""
        theta, z = states[..., 2::3], states[..., 0::3] + 1j * states[..., 1::3]
        u, real = np.cos(theta) + 1j * np.sin(theta), np.isfinite(states).all(axis=-1)
        bodies = {k: Pose.of(z[..., k], u[..., k]) for k in range(z.shape[-1])}
        return cls(bodies, real, real.sum(axis=-1), 0, np.full(real.shape[:-1], False))

    @property
    def structure(self) -> Structure:
        """The structure of the mechanism; raises InvalidInput for configurations of a group alone."""
        if self.of is None:
            raise InvalidInput(Problem("configurations", "they are those of a group, not of a mechanism"))
        return self.of

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the poses: for a mechanism of the driver values and dimensions."""
        return np.shape(self.real)[:-1]

    @property
    def real_count(self) -> Number:
        """How many can be assembled, (...)."""
        return self.real.sum(axis=-1)

    @property
    def count_in_words(self) -> str:
        """How many are real at the first driver values, and whether any is missing."""
        real = sum(1 for _ in self)
        if not self.possible:
            return f"{count_phrase(real, 'real configuration')} found by a search, which may have missed some."
        text = f"{real} real of {self.possible} possible over the complex numbers"
        return f"{text}; none is missing." if self.certified else f"{text}, as far as found numerically."

    @property
    def turns(self) -> Number:
        """The unit orientations of the bodies, (..., m, n)."""
        return np.stack([pose.u.c[0] for pose in self.bodies.values()], axis=-1)

    @property
    def origins(self) -> Number:
        """The origins of the bodies, (..., m, n)."""
        return np.stack([pose.z.c[0] for pose in self.bodies.values()], axis=-1)

    @property
    def states(self) -> Number:
        """The real configurations as states (..., most real ones, 3 n). They are x, y, theta of each body; NaN pads."""
        most = int(self.real_count.max(initial=0))
        shown = self.real[..., :most]
        z, u = self.origins[..., :most, :], self.turns[..., :most, :]
        states = np.stack([z.real, z.imag, np.angle(u)], axis=-1)
        return np.where(shown[..., None], states.reshape(*shown.shape, 3 * u.shape[-1]), np.nan)

    def poses(self, number: int) -> list[Pose]:
        """Return the bodies' poses (...) in one configuration. They are NaN at the poses where it is not real."""
        shown, bodies = self.real[..., number], self.bodies.values()
        pairs = ((np.where(shown, v.c[0][..., number], np.nan) for v in (pose.z, pose.u)) for pose in bodies)
        return [Pose.of(z, u) for z, u in pairs]

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The names of the configurations.

        They have a sign for each group with two modes, for other groups a number.
        """
        return tuple(named(self.structure, modes) for modes in self.modes)

    def points(self, name: str) -> Vectors:
        """Return where a point is, complex (..., m)."""
        mechanism = self.structure.mechanism
        if name not in mechanism.carriers:
            raise UnknownName(Problem(name, "there is no such point", suggestion(name, list(mechanism.carriers))))
        link = mechanism.carriers[name][0]
        dimension = np.broadcast_to(mechanism.geometry.points[link][name], self.shape)[..., None]
        found: Vectors = np.where(self.real, self.bodies[link].at(dimension).c[0], np.nan).view(Vectors)
        return found

    def angle(self, link: str) -> Number:
        """Return the angle of a link, radians between -pi and pi, (..., m)."""
        self.structure.mechanism.link(link)
        return np.where(self.real, np.angle(self.bodies[link].u.c[0]), np.nan)

    def margin(self, group: int) -> Number:
        """Return how far a group with signs is from its limit position. It is a squared sine, (..., m)."""
        if group not in self.margins:
            raise UnknownName(Problem(f"group {group}", "it tells no margin"))
        return self.margins[group]

    def pick(self, which: int | str, at: tuple[int, ...] | int = 0) -> Configuration:
        """Return one configuration at an index of the driver values. It goes by its index or name.

        Raises UnknownName for a name or index that none has, NotAssembled where it cannot be assembled there.
        """
        k, shape = self._index(which), self.shape or (1,)
        place = tuple(int(i) for i in np.unravel_index(at, shape)) if isinstance(at, int) else at
        if not self.real.reshape(*shape, -1)[(*place, k)]:
            what = f"{self.names[k]} cannot be assembled there"
            raise NotAssembled(Problem("configuration", what, "choose one that is real"))
        design, pose = divmod(int(np.ravel_multi_index(place, shape)), shape[-1])
        index = (*(place if self.shape else ()), k)
        values, margins = numbers_at(self.values, (design, pose)), numbers_at(self.margins, index)
        dimensions = dimensions_at(self.structure, design, pose)
        return Configuration(self.structure, values, placed_at(self.bodies, index), self.modes[k], margins, dimensions)

    def __len__(self) -> int:
        return int(np.shape(self.real)[-1])

    def __iter__(self) -> Iterator[Configuration]:
        """Return the real ones at the first driver value."""
        first = self.real.reshape(-1, len(self))[0] if len(self) else ()
        return (self.pick(k) for k in range(len(self)) if first[k])

    def _index(self, which: int | str) -> int:
        if isinstance(which, str):
            if which not in self.names:
                raise UnknownName(Problem(which, "there is no such configuration", suggestion(which, self.names)))
            return self.names.index(which)
        if not -len(self) <= which < len(self):
            raise UnknownName(Problem(str(which), f"there are {len(self)} configurations"))
        return which % len(self)

    def __repr__(self) -> str:
        if self.of is None:
            return f"Configurations({len(self)} of {len(self.bodies)} bodies at {self.shape} poses)"
        return f"Configurations({', '.join(map(repr, self.names))})"


def state_distance(one: Number, other: Number, size: Number) -> Number:
    """Return how far states (..., 3 n) are from each other.

    It is in parts of the size, radians; whole turns do not count.
    """
    gap = one - other
    turn = np.abs(wrapped(gap[..., 2::3]))
    shift = np.maximum(np.abs(gap[..., 0::3]), np.abs(gap[..., 1::3])) / size
    return np.maximum(turn, shift).max(axis=-1)
