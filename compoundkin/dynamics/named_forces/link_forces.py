"""All that acts on one link: its free body."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, overload

from compoundkin.base.arrays import Number, Vectors
from compoundkin.base.errors import Problem, UnknownName, suggestion
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.found_forces import FoundForces
from compoundkin.dynamics.loaded_block import loaded_blocks
from compoundkin.dynamics.named_forces.driver_efforts import DriverEffort
from compoundkin.dynamics.named_forces.link_wrench import (
    DRIVER,
    INERTIA,
    WEIGHT,
    LinkWrench,
    as_vectors,
    line_of_action,
    moment_about,
    place_in_world,
)
from compoundkin.dynamics.named_forces.pair_forces import PairForce
from compoundkin.dynamics.reactions.joined_wrenches import JoinedWrenches
from compoundkin.model.loads.contract import Load
from compoundkin.model.loads.mass import Mass


@dataclass(frozen=True, eq=False, repr=False)
class LinkForces(Sequence[LinkWrench]):
    """All that acts on a link, in order: pairs, efforts, loads, weight, inertia.

    Their sum is zero, but for the frame, where it is what the ground must hold.
    """

    forces: FoundForces
    link: str
    entries: tuple[LinkWrench, ...]

    @overload
    def __getitem__(self, which: int | str) -> LinkWrench: ...
    @overload
    def __getitem__(self, which: slice) -> Sequence[LinkWrench]: ...
    def __getitem__(self, which: int | str | slice) -> LinkWrench | Sequence[LinkWrench]:
        """Return what acts by its place in the order or by its name."""
        if not isinstance(which, str):
            return self.entries[which]
        names = [one.name for one in self.entries]
        if which not in names:
            what = f"nothing of this name acts on {self.link!r}"
            raise UnknownName(Problem(which, what, suggestion(which, names)))
        return self.entries[names.index(which)]

    def __len__(self) -> int:
        return len(self.entries)

    def of_kind(self, *kinds: str) -> tuple[LinkWrench, ...]:
        """Return what acts of some kinds, such as "pair" or "weight"."""
        return tuple(one for one in self.entries if one.kind in kinds)

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


def link_forces(forces: FoundForces, link: str) -> LinkForces:
    """Return all that acts on a link."""
    return LinkForces(forces, link, (*_of_pairs(forces, link), *known_on(forces, link)))


def _of_pairs(forces: FoundForces, link: str) -> Iterator[LinkWrench]:
    """Yield what pairs do, then the efforts that drivers add there."""
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


def known_on(forces: FoundForces, link: str) -> Iterator[LinkWrench]:
    """Yield loads, weight, inertia, then what else was found to act."""
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
