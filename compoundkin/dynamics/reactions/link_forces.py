"""Free bodies: all that acts on a link, on the links of a pin, and on the frame (the shaking force)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, overload

from compoundkin.base.arrays import Number, Vectors
from compoundkin.base.errors import Problem, UnknownName, suggestion
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.force_result import ForceResult
from compoundkin.dynamics.loaded_block import loaded_blocks
from compoundkin.dynamics.reactions.driver_efforts import DriverEffort
from compoundkin.dynamics.reactions.link_wrench import (
    DRIVER,
    INERTIA,
    PAIR,
    WEIGHT,
    LinkWrench,
    as_vectors,
    line_of_action,
    moment_about,
    place_in_world,
)
from compoundkin.dynamics.reactions.pair_forces import PairForce
from compoundkin.dynamics.reactions.reverse_pass import JoinedWrenches
from compoundkin.kinematics.motion import described
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads.contract import Load
from compoundkin.model.loads.mass import Mass
from compoundkin.model.pairs import Pair


@dataclass(frozen=True, eq=False, repr=False)
class LinkForces(Sequence[LinkWrench]):
    """All that acts on a link, in order: pairs, efforts, loads, weight, inertia.

    Their sum is zero, except on the frame, where it is the load on the ground.
    """

    forces: ForceResult
    link: str
    entries: tuple[LinkWrench, ...]

    @overload
    def __getitem__(self, which: int | str) -> LinkWrench: ...
    @overload
    def __getitem__(self, which: slice) -> Sequence[LinkWrench]: ...
    def __getitem__(self, which: int | str | slice) -> LinkWrench | Sequence[LinkWrench]:
        """Return a wrench by its index or by its name."""
        if not isinstance(which, str):
            return self.entries[which]
        names = [one.name for one in self.entries]
        if which not in names:
            what = f"nothing of this name acts on {self.link!r}"
            raise UnknownName(Problem(which, what, suggestion(which, names)))
        return self.entries[names.index(which)]

    def __len__(self) -> int:
        return len(self.entries)

    @property
    def sum(self) -> Wrench:
        """The sum of all, about the world's origin, (designs, poses)."""
        whole = Wrench()
        for one in self.entries:
            whole = whole + one.whole
        return whole

    @property
    def force(self) -> Vectors:
        """The sum of all forces."""
        return as_vectors(self.forces.motion, self.sum.force)

    def moment_about(self, point: Any) -> Number:
        """Return the sum of moments about a letter or a place of the world."""
        return moment_about(self.forces.motion, self.sum, point)

    def __repr__(self) -> str:
        shown = ", ".join(f"{one.kind} {one.name}" for one in self.entries[:6])
        more = f", ... {len(self)} in all" if len(self) > 6 else ""
        return f"LinkForces({self.link}: {shown}{more})"


def link_forces(forces: ForceResult, link: str) -> LinkForces:
    """Return all that acts on a link."""
    return LinkForces(forces, link, (*_of_pairs(forces, link), *known_on(forces, link)))


def _of_pairs(forces: ForceResult, link: str) -> Iterator[LinkWrench]:
    """Yield the wrenches of pairs, then the efforts of drivers in them."""
    efforts = {one.pair.name: DriverEffort(forces, one) for one in forces.motion.structure.driven.values()}
    driven = []
    for name in forces.wrenches:
        found = PairForce(forces, forces.solving_order.pairs[name])
        if link not in found.pair.members[:2]:
            continue
        one = found.on(link).acting
        if name not in efforts:
            yield one
            continue
        effort = efforts[name]
        held = effort.wrench if found.on(link).side else -effort.wrench
        yield replace(one, whole=one.whole - held)
        driven.append(replace(one, kind=DRIVER, name=effort.name, whole=held, open=None))
    yield from driven


def known_on(forces: ForceResult, link: str) -> Iterator[LinkWrench]:
    """Yield loads, weight, inertia, then further wrenches such as friction."""
    motion = forces.motion
    mass = motion.mechanism.masses.get(link)
    store: JoinedWrenches[tuple[str, Load | Mass]] = JoinedWrenches(motion.failed.shape)
    for loaded in loaded_blocks(motion):
        for what, on, wrench in loaded.named_loads():
            if on == link:
                kind = WEIGHT if isinstance(what, Mass) else what.title
                store.take((kind, what), wrench, loaded.designs, loaded.poses)
        if mass is not None and forces.inertia:
            store.take((INERTIA, mass), loaded.inertia(mass), loaded.designs, loaded.poses)
    for (kind, what), wrench in store.wrenches().items():
        by, point = ("", what.at) if isinstance(what, Mass) else (_by(what, link), what.attack(link))
        at = point if isinstance(point, str) else ""
        attack = line_of_action(motion, link, wrench) if point is None else place_in_world(motion, link, point)
        yield LinkWrench(motion, kind, what.name, link, by, at, wrench, attack)
    yield from (one for one in forces.more if one.on == link)


def _by(load: Load, link: str) -> str:
    """Return the link from which a load comes. It is empty where it comes from outside."""
    return next((name for name in load.links if name != link), "")


@dataclass(frozen=True, eq=False, repr=False)
class PinForces:
    """The forces of a pin on its links.

    That on each link is unique, while the force between two of more links depends on how their pairs are counted.
    """

    forces: ForceResult
    letter: str

    @property
    def links(self) -> tuple[str, ...]:
        """The links that it joins."""
        return self.forces.mechanism.real_pins[self.letter]

    @property
    def all_links(self) -> tuple[str, ...]:
        """The links that it joins, with a prescribed motion."""
        return self.forces.mechanism.pins[self.letter]

    @property
    def pairs(self) -> tuple[Pair, ...]:
        """The pairs that stand for it, one less than its links."""
        written = {pair.name for pair in self.forces.mechanism.written_pairs}
        found = (self.forces.solving_order.pairs[name] for name in self.forces.wrenches if name not in written)
        return tuple(pair for pair in found if pair.letters[0] == self.letter)

    def on(self, link: str) -> LinkWrench:
        """Return the force of the pin on a link.

        Raises UnknownName for a link that is not at it. It has `force`, `moment` about the pin, which is that of
        drivers, and `wrench`. A load on the pin itself is passed on by the pin to the link that carries it. What leads
        the pin is one of `all_links`.
        """
        if link not in self.all_links:
            what = f"the pin {self.letter} does not join it"
            raise UnknownName(Problem(str(link), what, f"known: {', '.join(self.links)}"))
        whole, parts = Wrench(), list[tuple[str, float]]()
        for pair in self.pairs:
            if link in pair.members[:2]:
                whole = whole + PairForce(self.forces, pair).on(link).acting.whole
                parts.append((pair.name, 1.0 if link == pair.members[1] else -1.0))
        loads = self.forces.mechanism.loads
        for one in known_on(self.forces, link):
            if one.name in loads and loads[one.name].pin == self.letter:
                whole = whole + one.whole
        place = place_in_world(self.forces.motion, self.links[0], self.letter)
        left = self.forces.left_open(parts, place)
        return LinkWrench(self.forces.motion, PAIR, self.letter, link, self.letter, self.letter, whole, place, left)

    def __repr__(self) -> str:
        return described(self, self.forces.grid, f"{self.letter} on {', '.join(self.links)}")


@dataclass(frozen=True, eq=False, repr=False)
class ShakingForce:
    """The force of a mechanism on its frame.

    It is that of pairs, of drivers' reactions, of springs and dampers fixed to the frame. External loads on the frame
    are none of the mechanism's: they are in `external` alone. Without those it is the sum of loads and weights less
    that of masses times accelerations.
    """

    forces: ForceResult

    @cached_property
    def parts(self) -> tuple[LinkWrench, ...]:
        """All that acts on the frame, by name and kind."""
        return tuple(link_forces(self.forces, FRAME))

    @property
    def pairs(self) -> tuple[LinkWrench, ...]:
        """The forces of pairs on the frame, without drivers' reactions."""
        return self._of(PAIR)

    @property
    def reactions(self) -> tuple[LinkWrench, ...]:
        """The drivers' reactions."""
        return self._of(DRIVER)

    @property
    def external(self) -> tuple[LinkWrench, ...]:
        """The loads on the frame that do not come from a link."""
        return tuple(one for one in self.parts if not one.by)

    @property
    def whole(self) -> Wrench:
        """All that the mechanism does to the frame, about the world's origin, (designs, poses)."""
        if self.forces.singular:
            # where single forces have no limit their sum may have one
            return self.forces.on_frame - _sum(self.external)
        return _sum(one for one in self.parts if one.by)

    @property
    def force(self) -> Vectors:
        """The shaking force, complex; `.xy` gives (..., 2)."""
        return as_vectors(self.forces.motion, self.whole.force)

    def moment_about(self, point: Any) -> Number:
        """Return the shaking moment about a letter or a place of the world. It depends on the point."""
        return moment_about(self.forces.motion, self.whole, point)

    def _of(self, kind: str) -> tuple[LinkWrench, ...]:
        return tuple(one for one in self.parts if one.kind == kind)

    def __repr__(self) -> str:
        return described(self, self.forces.grid, ", ".join(one.name for one in self.parts[:6]))


def _sum(acting: Iterable[LinkWrench]) -> Wrench:
    whole = Wrench()
    for one in acting:
        whole = whole + one.whole
    return whole
