"""One configuration of a mechanism: where all its links are; and how configurations are called."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number, entry
from compoundkin.base.display import DisplaysHtml
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
class ConfigurationCurve(DisplaysHtml):
    """A curve of configurations: `links` move although all drivers stand still.

    `through` is one of them; its name says nothing, for the groups of those on a curve have no modes.
    """

    links: tuple[str, ...]
    through: Configuration

    def __repr__(self) -> str:
        return f"ConfigurationCurve({', '.join(self.links)})"


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
