"""How groups pass on forces over a motion: transmission angles and indices, pressure angles, Coriolis accelerations."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from compoundkin.analysis.characteristics.figure import Range, scalar
from compoundkin.analysis.characteristics.outputs_of_motion import Output
from compoundkin.kinematics import Motion
from compoundkin.kinematics.quantity_owners import owner_of
from compoundkin.model.attributes import (
    CORIOLIS,
    GREATEST,
    LEAST,
    LENGTH,
    PRESSURE_ANGLE,
    RADIANS,
    TRANSMISSION_ANGLE,
    TRANSMISSION_INDEX,
)
from compoundkin.structure import Group, Structure

# Below this transmission angle friction in the pins may lock a linkage. Source: H. Alt, Der Uebertragungswinkel und
# seine Bedeutung fuer das Konstruieren periodischer Getriebe, Werkstattstechnik 26 (1932) 61-64; R. L. Norton, Design
# of Machinery, section 3.3, gives the same 40 degrees.
LEAST_ANGLE = np.deg2rad(40.0)


@dataclass(frozen=True, eq=False)
class GroupFigures:
    """How the group of some links passes on forces.

    The range is that of the transmission angle (radians) or index. A dyad has an angle, other groups an index from 0 to
    1. It is on the way where an output that was named depends on it.
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
    """Return the transmission indices of a motion's groups, by the names of their quantities.

    Of a dyad it is the sine of the transmission angle, and smooth where that is a right one.
    """
    owners = ((group, owner_of(motion, "links", group.links[0])) for group in motion.structure.groups)
    return {f"{group.links[0]}.{TRANSMISSION_INDEX}": group for group, one in owners if one.has(TRANSMISSION_INDEX)}


def pressure_names(motion: Motion) -> tuple[str, ...]:
    """Return the pressure angles of a motion's cams, by the names of their quantities."""
    return tuple(_names(motion, PRESSURE_ANGLE))


def coriolis_names(motion: Motion) -> tuple[str, ...]:
    """Return the names of the lengths of Coriolis accelerations on moving guides."""
    return tuple(f"{name}.{LENGTH}" for name in _names(motion, CORIOLIS))


def _names(motion: Motion, word: str) -> Iterable[str]:
    return (f"{name}.{word}" for name in motion.pairs if owner_of(motion, "pairs", name).has(word))


def groups_on_the_way(structure: Structure, outputs: Iterable[Output]) -> set[int]:
    """Return the groups, by their indices, that outputs depend on.

    They are those that solve them, and all before those.

    >>> import compoundkin as ck
    >>> from compoundkin.analysis.characteristics.outputs_of_motion import outputs_of
    >>> motion = ck.solve(ck.catalog.load_named("watt-ii"))
    >>> groups_on_the_way(motion.structure, outputs_of(motion, ["DCE"]))
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
    """Return the links whose motion an output is that of."""
    if output.kind == "links":
        return (output.owner,)
    if output.kind == "points":
        return structure.mechanism.carriers[output.owner][:1]
    pairs = {pair.name: pair.members for pair in structure.pairs}
    return pairs.get(output.owner, ())


def group_figures(
    motion: Motion, names: Mapping[str, Group], ranges: Mapping[str, Range], on_the_way: set[int]
) -> tuple[GroupFigures, ...]:
    """Return the figures of groups, in solving order: of dyads angles, of others indices."""
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
        replace(end, value=scalar(f"{name}.{word}", float(np.arcsin(np.clip(end.number, 0.0, 1.0))), RADIANS))
        for word, end in ((LEAST, sines.least), (GREATEST, sines.greatest))
    ]
    return Range(ends[0], ends[1], sines.is_constant)
