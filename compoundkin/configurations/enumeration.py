"""`configurations`: every way in which a mechanism can be assembled at given driver values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import prod
from typing import Any

import numpy as np

from compoundkin.base.arrays import TURN
from compoundkin.base.bracketing import bisected
from compoundkin.base.display import Shows
from compoundkin.base.errors import NotAssembled, Problem, UnknownName, nearest
from compoundkin.base.poses import Pose
from compoundkin.base.series import Number, constant
from compoundkin.configurations.all_modes import AllModes, first_values
from compoundkin.configurations.driver_range import reach_of
from compoundkin.kinematics.configuration import Configuration, named
from compoundkin.kinematics.inputs import Inputs, by_name, inputs
from compoundkin.kinematics.quantities import degrees
from compoundkin.kinematics.results import Vectors
from compoundkin.kinematics.solution import plan_of
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure.kinematic_structure import Structure

# Where nothing can be assembled, so many values of each driver are tried, and the nearest that can is refined.
TRIED = 721
HALVINGS = 40


@dataclass(frozen=True, eq=False)
class AllConfigurations(Shows):
    """All configurations of a mechanism: arrays (..., m) over driver values and, last, configurations.

    Only those that are real somewhere are kept; NaN where one is not. `names` tells them apart: a sign for each
    group with two modes, for other groups a number in the order of its bodies' angles.
    """

    structure: Structure
    inputs: Inputs
    names: tuple[str, ...]
    choices: AllModes
    kept: Number

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the driver values and dimensions."""
        return self.inputs.shape

    @cached_property
    def real(self) -> Number:
        """Which configurations can be assembled, bool (..., m)."""
        return self._shaped(self.choices.real[self.kept])

    @property
    def real_count(self) -> Number:
        """How many can be assembled, (...)."""
        return self.real.sum(axis=-1)

    @property
    def possible(self) -> int:
        """How many there are over the complex numbers, for generic dimensions; 0 where that is not known."""
        return prod(self.choices.expected.values())

    @property
    def certified(self) -> bool:
        """Whether none is missing at any pose: closed forms, or as many were found as theory knows."""
        return all(bool(np.all(found)) for found in self.choices.certified.values())

    def points(self, name: str) -> Vectors:
        """Where a point is, complex (..., m)."""
        carriers = self.structure.mechanism.carriers
        if name not in carriers:
            raise UnknownName(Problem(name, "there is no such point", nearest(name, list(carriers))))
        link = carriers[name][0]
        where = self.choices.block.world[link].at(self._dimension(link, name)).c[0]
        found: Vectors = np.where(self.real, self._shaped(self.choices.full(where)[self.kept]), np.nan).view(Vectors)
        return found

    def angle(self, link: str) -> Number:
        """The angle of a link, radians between -pi and pi, (..., m)."""
        self.structure.mechanism.link(link)
        angle = np.angle(self.choices.block.world[link].u.c[0])
        return np.where(self.real, self._shaped(self.choices.full(angle)[self.kept]), np.nan)

    def margin(self, group: int) -> Number:
        """How far a group with signs is from its limit position, a squared sine, (..., m)."""
        if group not in self.choices.block.margins:
            raise UnknownName(Problem(f"group {group}", "it tells no margin"))
        return self._shaped(self.choices.full(self.choices.block.margins[group])[self.kept])

    def pick(self, which: int | str, at: tuple[int, ...] | int = 0) -> Configuration:
        """One configuration, by its index or name, at an index of the driver values.

        Raises UnknownName for a name or index that none has, NotAssembled where it cannot be assembled there.
        """
        k = self._index(which)
        place = np.unravel_index(at, self.shape or (1,)) if isinstance(at, int) else at
        if not self.real.reshape(*(self.shape or (1,)), -1)[(*place, k)]:
            what = f"{self.names[k]} cannot be assembled there"
            raise NotAssembled(Problem("configuration", what, "choose one that is real"))
        flat = int(np.ravel_multi_index(place, self.shape or (1,)))
        return self._configuration(k, flat // self.inputs.poses, flat % self.inputs.poses)

    def __len__(self) -> int:
        return len(self.names)

    def __iter__(self) -> Iterator[Configuration]:
        """The real ones at the first driver value."""
        first = self.real.reshape(-1, len(self))[0]
        return (self.pick(k) for k in range(len(self)) if first[k])

    def _configuration(self, k: int, design: int, pose: int) -> Configuration:
        def one(array: Number) -> Number:
            return self.choices.full(array)[self.kept[k], design, pose]

        world = self.choices.block.world
        poses = {
            name: Pose(constant(complex(one(p.z.c[0]))), constant(complex(one(p.u.c[0])))) for name, p in world.items()
        }
        margins = {group: float(one(margin)) for group, margin in self.choices.block.margins.items()}
        values = first_values({name: v[0] for name, v in self.inputs.drives.items()}, (design, pose))
        modes = self.choices.names_of()[int(self.kept[k])]
        return Configuration(self.structure, values, poses, modes, margins, dimensions_at(self.structure, design, pose))

    def _index(self, which: int | str) -> int:
        if isinstance(which, str):
            if which not in self.names:
                raise UnknownName(Problem(which, "there is no such configuration", nearest(which, self.names)))
            return self.names.index(which)
        if not -len(self) <= which < len(self):
            raise UnknownName(Problem(str(which), f"there are {len(self)} configurations"))
        return which % len(self)

    def _dimension(self, link: str, name: str) -> Number:
        from_points = self.structure.mechanism.geometry.points[link][name]
        return np.broadcast_to(from_points, self.shape).reshape(self.choices.block.shape[-2:])

    def _shaped(self, found: Number) -> Number:
        return np.moveaxis(found, 0, -1).reshape(*self.shape, len(found))

    def __repr__(self) -> str:
        return f"AllConfigurations({', '.join(map(repr, self.names))})"


def dimensions_at(structure: Structure, design: int, pose: int) -> dict[str, dict[str, complex]]:
    """The points of all links, in their frames, of one design."""

    def one(value: Number) -> complex:
        if np.ndim(value) == 0:
            return complex(value)
        rows = np.reshape(value, (-1, np.shape(value)[-1]))
        return complex(rows[min(design, len(rows) - 1), min(pose, rows.shape[1] - 1)])

    placed = structure.mechanism.geometry.points
    return {link: {name: one(value) for name, value in points.items()} for link, points in placed.items()}


def configurations(mechanism: Mechanism | Structure, values: Mapping[str, Any] | None = None) -> AllConfigurations:
    """All configurations of a mechanism at driver values (radians or lengths; arrays; those of `solve` if left out).

    Groups of pins and slides give all their configurations; others those that a search finds, so that `certified` is
    False. Raises NotDetermined where the structure cannot be solved, InvalidInput for values that do not fit,
    NotAssembled where there is no configuration at all, naming the nearest driver value that has any.

    >>> from compoundkin.model.elements import drive, link
    >>> four_bar = Mechanism(
    ...     "Four-bar", link("frame", A=(0, 0), D=(4, 0)), link("crank", A=(0, 0), B=(1, 0)),
    ...     link("coupler", B=(0, 0), C=(3, 0)), link("rocker", D=(0, 0), C=(3, 0)), drive("crank"))
    >>> found = configurations(four_bar, {"crank": 1.0})
    >>> found.names, int(found.real_count), found.possible
    (('RRR(coupler)+', 'RRR(coupler)-'), 2, 2)
    """
    plan = plan_of(mechanism)
    with np.errstate(all="ignore"):
        given = inputs(plan, by_name(plan.structure.mechanism, values), None, None, None)
        choices = AllModes.of(plan, given)
        real = choices.real
        kept = np.flatnonzero(real.any(axis=(1, 2)))
        if not len(kept):
            raise NotAssembled(_nothing(plan, given))
    modes = choices.names_of()
    names = tuple(named(plan.structure, modes[k]) for k in kept)
    return AllConfigurations(plan.structure, given, names, choices, kept)


def _nothing(plan: SolvingOrder, given: Inputs) -> Problem:
    """Why there is no configuration: where the nearest one is."""
    found = [
        (gap, name, value) for name in given.drives for gap, value in [_nearest(plan, given, name)] if gap < np.inf
    ]
    if not found:
        return Problem("values", "the mechanism cannot be assembled there, nor at any other value of a single driver")
    _, name, value = min(found)
    is_angle = plan.driven[name].pair.free_is_angle
    shown = f"{degrees(value):.6g} degrees" if is_angle else f"{value:.6g}"
    return Problem("values", "the mechanism cannot be assembled there", f"the nearest value is {name} = {shown}")


def _nearest(plan: SolvingOrder, given: Inputs, name: str) -> tuple[float, float]:
    """The value of a driver nearest to its own with any configuration, and how far it is (of the size, or radians)."""
    first = given.cut(slice(0, 1), slice(0, 1))
    here = float(np.ravel(first.drives[name][0])[0])
    is_angle = plan.driven[name].pair.free_is_angle
    span = TURN / 2.0 if is_angle else 2.0 * reach_of(plan)
    offsets = np.linspace(-span, span, TRIED)
    good = _any(plan, first, name, here + offsets)
    if not good.any():
        return np.inf, here
    order = np.argsort(np.abs(offsets), kind="stable")
    best = order[good[order]][0]
    near, far = offsets[best], offsets[best] - np.sign(offsets[best]) * 2.0 * span / (TRIED - 1)
    near, _ = bisected(lambda off: _any(plan, first, name, np.array([here + off]))[0], near, far, HALVINGS)
    return abs(near) / (1.0 if is_angle else plan.size), here + near


def _any(plan: SolvingOrder, given: Inputs, name: str, values: Number) -> Number:
    rest = {other: tuple(np.ravel(v)[0] for v in vs) for other, vs in given.drives.items()}
    drives = {**rest, name: (values[None],)}
    return AllModes.of(plan, Inputs((len(values),), given.ends, drives)).real.any(axis=(0, 1))
