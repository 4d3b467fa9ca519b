"""How a motion transmits forces: transmission angles and indices of groups, pressure angles, velocity ratios.

The mechanical advantage of an output is the inverse of its velocity ratio to the only driver that moves.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from compoundkin.analysis.characteristics.outputs import Output
from compoundkin.analysis.characteristics.placed_figures import PlacedFigure, Range, moving_drivers, scalar_quantity
from compoundkin.base.arrays import Number
from compoundkin.base.extremes import ROUNDING
from compoundkin.kinematics import Motion
from compoundkin.kinematics.quantities import Quantity, owner_of
from compoundkin.model.attributes import (
    ADVANTAGE,
    CORIOLIS,
    GREATEST,
    LEAST,
    LENGTH,
    PRESSURE_ANGLE,
    RADIANS,
    TRANSMISSION_ANGLE,
    TRANSMISSION_INDEX,
    VELOCITY_RATIO,
    coordinate_dimension,
    ratio_unit,
)
from compoundkin.structure import Group, Structure

# Below this transmission angle friction in the pins may lock a linkage. Source: H. Alt, Der Uebertragungswinkel und
# seine Bedeutung fuer das Konstruieren periodischer Getriebe, Werkstattstechnik 26 (1932) 61-64; R. L. Norton, Design
# of Machinery, section 3.3, gives the same 40 degrees.
LEAST_ANGLE = np.deg2rad(40.0)


@dataclass(frozen=True, eq=False)
class GroupFigures:
    """The range of the transmission angle (radians) of a dyad, or of the index (0 to 1) of another group.

    It is `on_the_way` where an output depends on it.
    """

    group: Group
    name: str
    range: Range
    is_angle: bool
    on_the_way: bool

    @property
    def is_poor(self) -> bool:
        """Whether an output depends on it and its angle falls below 40 degrees."""
        return self.on_the_way and self.is_angle and self.range.least.number < LEAST_ANGLE


def index_names(motion: Motion) -> dict[str, Group]:
    """Return the groups by the names of their transmission indices.

    A dyad's index is the sine of its transmission angle, which is smooth at a right angle.
    """
    owners = ((group, owner_of(motion, "links", group.links[0])) for group in motion.structure.groups)
    return {f"{group.links[0]}.{TRANSMISSION_INDEX}": group for group, one in owners if one.has(TRANSMISSION_INDEX)}


def pressure_names(motion: Motion) -> tuple[str, ...]:
    """Return the names of the pressure angles of a motion's cams."""
    return tuple(_names(motion, PRESSURE_ANGLE))


def coriolis_names(motion: Motion) -> tuple[str, ...]:
    """Return the names of the lengths of Coriolis accelerations on moving guides."""
    return tuple(f"{name}.{LENGTH}" for name in _names(motion, CORIOLIS))


def _names(motion: Motion, word: str) -> Iterable[str]:
    return (f"{name}.{word}" for name in motion.pairs if owner_of(motion, "pairs", name).has(word))


def groups_of_outputs(structure: Structure, outputs: Iterable[Output]) -> set[int]:
    """Return the indices of the groups that outputs depend on.

    >>> import compoundkin as ck
    >>> from compoundkin.analysis.characteristics.outputs import outputs_of
    >>> motion = ck.solve(ck.load("watt-ii"))
    >>> groups_of_outputs(motion.structure, outputs_of(motion, ["DCE"]))
    {0}
    """
    of = {link: k for k, group in enumerate(structure.groups) for link in group.links}
    reached: set[int] = set()
    waiting = [of[link] for output in outputs for link in _links(structure, output) if link in of]
    while waiting:
        k = waiting.pop()
        if k not in reached:
            reached.add(k)
            waiting += [of[link] for link in structure.groups[k].uses if link in of]
    return reached


def _links(structure: Structure, output: Output) -> tuple[str, ...]:
    """Return the links that move an output."""
    if output.kind == "links":
        return (output.owner,)
    if output.kind == "points":
        return structure.mechanism.carriers[output.owner][:1]
    pairs = {pair.name: pair.members for pair in structure.pairs}
    return pairs.get(output.owner, ())


def group_figures(
    motion: Motion, names: Mapping[str, Group], ranges: Mapping[str, Range], on_the_way: set[int]
) -> tuple[GroupFigures, ...]:
    """Return the figures of groups in solving order: angles of dyads, indices of others."""
    index = {group.links: k for k, group in enumerate(motion.structure.groups)}
    found = []
    for name, group in names.items():
        if name in ranges:
            link = group.links[0]
            angled = owner_of(motion, "links", link).has(TRANSMISSION_ANGLE)
            range_ = _angles(f"{link}.{TRANSMISSION_ANGLE}", ranges[name]) if angled else ranges[name]
            whose = f"{link}.{TRANSMISSION_ANGLE if angled else TRANSMISSION_INDEX}"
            found.append(GroupFigures(group, whose, range_, angled, index[group.links] in on_the_way))
    return tuple(found)


def _angles(name: str, sines: Range) -> Range:
    """Return the range of an angle from that of its sine."""
    ends = [
        replace(end, value=scalar_quantity(f"{name}.{word}", float(np.arcsin(np.clip(end.number, 0.0, 1.0))), RADIANS))
        for word, end in ((LEAST, sines.least), (GREATEST, sines.greatest))
    ]
    return Range(ends[0], ends[1], sines.is_constant)


# Links that turn by less (radians) stay parallel but for rounding, and have no torque.
TURNS = 1e-9


@dataclass(frozen=True, eq=False)
class AdvantageFigures:
    """The velocity ratio of an output to the only driver that moves, and its mechanical advantage.

    The advantage is the reciprocal of the ratio, least where the ratio is farthest from zero. It grows without limit at
    `toggles`, the dead points of the output, where the ratio passes zero.
    """

    owner: str
    ratio: Range

    @property
    def least(self) -> PlacedFigure:
        """The mechanical advantage of least absolute value."""
        return self._inverse(self.ratio.absolute, LEAST)

    @property
    def greatest(self) -> PlacedFigure | None:
        """The mechanical advantage of greatest absolute value; None where it grows without limit."""
        if self.toggles:
            return None
        return self._inverse(min(self.ratio.least, self.ratio.greatest, key=lambda end: abs(end.number)), GREATEST)

    def _inverse(self, end: PlacedFigure, word: str) -> PlacedFigure:
        unit = end.value.unit
        inverse = unit.removeprefix("1/") if unit.startswith("1/") else f"1/{unit}" if unit else ""
        value: Quantity = scalar_quantity(f"{self.owner}.{ADVANTAGE}.{word}", 1.0 / end.number, inverse)
        return PlacedFigure(value, end.at, end.place)

    @property
    def toggles(self) -> bool:
        """Whether the advantage grows without limit at some place."""
        most = abs(self.ratio.absolute.number)
        slack = ROUNDING * most if np.isfinite(most) else 0.0
        return self.ratio.least.number <= slack and self.ratio.greatest.number >= -slack


def ratio_names(motion: Motion, outputs: Iterable[Output]) -> dict[str, str]:
    """Return the names of the velocity ratios by their owners.

    It is empty for a driver of constant speed: ratios then follow from rates.
    """
    if len(moving_drivers(motion, 0)) > 1 or steady_speed(motion) is not None:
        return {}
    if not any(np.any(rates[1] != 0) for rates in motion.inputs.drives.values()):
        return {}
    return {one.owner: f"{one.owner}.{VELOCITY_RATIO}" for one in _turning(motion, outputs)}


def _turning(motion: Motion, outputs: Iterable[Output]) -> Iterator[Output]:
    """Yield the outputs with a velocity ratio: turning links, and pairs, without drivers."""
    driven = {drive.link for drive in motion.mechanism.drives} | set(motion.drives)
    for one in (one for one in outputs if one.kind in ("links", "pairs") and one.owner not in driven and one.rate):
        turns = one.kind == "pairs" or _turned(motion.links[one.owner].angle) > TURNS
        if turns and owner_of(motion, one.kind, one.owner).has(VELOCITY_RATIO):
            yield one


def _turned(angle: Number) -> float:
    """Return the greatest change of an angle along a motion, 0 if nothing is assembled."""
    shape = np.shape(angle)
    known = np.reshape(angle, (-1, shape[-1] if shape else 1))
    rows = [row[np.isfinite(row)] for row in known]
    return max((float(np.ptp(row)) for row in rows if len(row)), default=0.0)


def steady_speed(motion: Motion) -> float | None:
    """Return the constant speed of the only driver that moves, else None."""
    moving = moving_drivers(motion, 0)
    if len(moving) != 1:
        return None
    rates = np.ravel(motion.inputs.drives[moving[0]][1])
    return float(rates[0]) if rates[0] and np.all(rates == rates[0]) else None


def advantages(
    motion: Motion, outputs: Iterable[Output], names: Mapping[str, str], ranges: Mapping[str, Range]
) -> tuple[AdvantageFigures, ...]:
    """Return the advantages of all outputs that move."""
    speed = steady_speed(motion)
    found = {owner: ranges[name] for owner, name in names.items() if name in ranges}
    if speed is not None:
        known = [one for one in _turning(motion, outputs) if one.rate in ranges]
        found = {one.owner: _by_speed(motion, one, ranges[one.rate], speed) for one in known}
    return tuple(AdvantageFigures(owner, ratio) for owner, ratio in found.items() if ratio.absolute.number)


def _by_speed(motion: Motion, output: Output, rate: Range, speed: float) -> Range:
    """Return the range of a velocity ratio from that of a rate, at a constant speed of the driver."""
    driver = motion.drives[moving_drivers(motion, 0)[0]]
    own = output.kind == "links" or motion.pairs[output.owner].is_angle
    unit = ratio_unit(motion.mechanism.unit, coordinate_dimension(own), coordinate_dimension(driver.is_angle))
    ends = sorted((rate.least, rate.greatest), key=lambda end: end.number / speed)
    least, greatest = (
        replace(end, value=scalar_quantity(f"{output.owner}.{VELOCITY_RATIO}.{word}", end.number / speed, unit))
        for word, end in zip((LEAST, GREATEST), ends, strict=True)
    )
    return Range(least, greatest, rate.is_constant)
