"""Configurations: one of a mechanism, where all its links are; and arrays of them, of a group's bodies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import wrapped
from compoundkin.base.display import Shows
from compoundkin.base.poses import Pose
from compoundkin.base.series import Number
from compoundkin.structure.kinematic_structure import Structure

BETWEEN = " / "
# The configuration of a mechanism of which every group has one.
ONLY = "only one"
# How the modes of a group with signs are written; zero at its limit position, where both are one.
SIGNS = {1: "+", -1: "-", 0: "±"}


@dataclass(frozen=True, eq=False)
class Configuration(Shows):
    """A mechanism assembled at one value of every driver (radians or lengths), in one way.

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
        """What it is called: the groups with more than one configuration, each with its sign or number."""
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


def label(structure: Structure, k: int) -> str:
    """What group `k` is called in a configuration's name: its kind and its first link."""
    group = structure.groups[k]
    return f"{group.name}({group.links[0]})"


def named(structure: Structure, modes: Mapping[int, str]) -> str:
    """The name of a configuration: signs as RRR(coupler)+, numbers as RRR-RRR(plate) 3."""
    parts = (f"{label(structure, k)}{' ' if mode.isdecimal() else ''}{mode}" for k, mode in sorted(modes.items()))
    return BETWEEN.join(parts) or ONLY


@dataclass(frozen=True)
class Configurations:
    """All configurations of a group: arrays (..., m) over poses and configurations, NaN where there are fewer.

    `turns` and `origins` (..., m, n) are the bodies' unit orientations and origins, for a configuration that is
    not `real` complex continuations without a picture. `count` (...) are found; `expected` is their number for
    generic dimensions (0 unknown), `exact` whether it is known by theory or from a generic instance solved numerically.
    """

    turns: Number
    origins: Number
    real: Number
    count: Number
    expected: int
    exact: bool

    @classmethod
    def of_bodies(cls, bodies: Sequence[Pose], real: Number, shape: tuple[int, ...]) -> Configurations:
        """Return those of closed forms: none is missing; all arrays with the configurations as their first axis."""
        z, u = (np.stack([np.broadcast_to(v, shape) for v in values], axis=-1) for values in (
            [pose.z.c[0] for pose in bodies], [pose.u.c[0] for pose in bodies]))  # fmt: skip
        turns, origins = np.moveaxis(u, 0, -2), np.moveaxis(z, 0, -2)
        count = np.full(shape[1:], shape[0])
        return cls(turns, origins, np.moveaxis(np.broadcast_to(real, shape), 0, -1), count, shape[0], True)

    @classmethod
    def of_states(cls, states: Number) -> Configurations:
        """Return those that a search found: states (..., m, 3 n), x, y, theta of each body, NaN pads."""
        theta = states[..., 2::3]
        real = np.isfinite(states).all(axis=-1)
        origins = states[..., 0::3] + 1j * states[..., 1::3]
        return cls(np.cos(theta) + 1j * np.sin(theta), origins, real, real.sum(axis=-1), 0, False)

    @property
    def certified(self) -> Number:
        """Where no configuration is missing, for as many were found as theory knows."""
        return self.exact & (self.count == self.expected)

    @property
    def real_count(self) -> Number:
        """The number of real configurations at every pose."""
        return self.real.sum(axis=-1)

    @property
    def states(self) -> Number:
        """The real configurations as states (..., most real ones, 3 n): x, y, theta of each body; NaN pads."""
        most = int(self.real_count.max(initial=0))
        shown = self.real[..., :most]
        z, u = self.origins[..., :most, :], self.turns[..., :most, :]
        states = np.stack([z.real, z.imag, np.angle(u)], axis=-1)
        return np.where(shown[..., None], states.reshape(*shown.shape, 3 * u.shape[-1]), np.nan)

    def poses(self, number: int) -> list[Pose]:
        """Return the bodies' poses (...) in one configuration; NaN at the poses where it is not real."""
        shown = self.real[..., number, None]
        z = np.where(shown, self.origins[..., number, :], np.nan)
        u = np.where(shown, self.turns[..., number, :], np.nan)
        return [Pose.of(z[..., b], u[..., b]) for b in range(z.shape[-1])]


def state_distance(one: Number, other: Number, size: float) -> Number:
    """Return how far states (..., 3 n) are from each other: parts of the size, radians; whole turns do not count."""
    gap = one - other
    turn = np.abs(wrapped(gap[..., 2::3]))
    shift = np.maximum(np.abs(gap[..., 0::3]), np.abs(gap[..., 1::3])) / size
    return np.maximum(turn, shift).max(axis=-1)
