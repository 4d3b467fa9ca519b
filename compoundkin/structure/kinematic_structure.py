"""A mechanism taken apart: what `decompose` finds."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from compoundkin.base.display import DisplaysPicture
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.structure.graph import Loop, independent_loops, kinematic_graph
from compoundkin.structure.mobility_count import Body, DrivenPair, Fault, Group, Mobility, Passive, Relaxation

if TYPE_CHECKING:
    import networkx as nx

# So many groups are named where a structure is printed.
SHOWN_GROUPS = 12


@dataclass(frozen=True)
class Structure(DisplaysPicture):
    """A mechanism taken apart. The frame with its driven links, then the Assur groups in solving order.

    `pairs` lists every pair, a multiple pin of k links as k - 1 of them. Where `faults` is not empty the
    mechanism cannot be solved, and `groups` holds what could be decomposed. Where there is a `relaxation`, part of
    some pairs is left out in the groups.
    """

    mechanism: Mechanism
    pairs: tuple[Pair, ...]
    ground: Body
    groups: tuple[Group, ...]
    mobility: Mobility
    faults: tuple[Fault, ...]
    passive: tuple[Passive, ...] = ()
    relaxation: Relaxation | None = None

    @cached_property
    def bodies(self) -> tuple[Body, ...]:
        """The frame with its driven links, then the bodies of all groups."""
        return (self.ground, *(body for group in self.groups for body in group.bodies))

    @cached_property
    def driven(self) -> dict[str, DrivenPair]:
        """The driven pairs by the names of their drivers."""
        return {step.drive.name: step for body in self.bodies for step in body.driven if not step.is_passive}

    @cached_property
    def driven_angles(self) -> dict[str, bool]:
        """Which drivers drive an angle; the others drive a length."""
        return {name: step.pair.free_is_angle for name, step in self.driven.items()}

    @cached_property
    def translating_links(self) -> dict[str, str]:
        """The links that cannot turn, only slides joining them to the frame. Each with its slide, the frame without.

        >>> from compoundkin.files import load
        >>> from compoundkin.structure import decompose
        >>> decompose(load("slider-crank")).translating_links
        {'frame': '', 'piston': 'stroke'}
        """
        found = {FRAME: ""}
        slides = [pair for pair in self.pairs if pair.is_simple and not pair.free_is_angle]
        while reached := [pair for pair in slides if len(found.keys() & set(pair.members)) == 1]:
            for pair in reached:
                found.update({name: pair.name for name in pair.members if name not in found})
        return found

    @cached_property
    def redundant(self) -> tuple[Pair, ...]:
        """The pairs that no driver and no group uses as they are. The others hold what they hold."""
        if self.relaxation is None:
            return ()
        used = {step.pair.name for body in self.bodies for step in body.driven}
        used.update(pair.name for group in self.groups for pair in (*group.inner, *group.outer))
        return tuple(pair for pair in self.pairs if pair.name not in used)

    @cached_property
    def graph(self) -> nx.MultiGraph:
        """The kinematic graph: links are nodes, pairs are edges keyed by their names."""
        return kinematic_graph(self)

    @cached_property
    def loops(self) -> tuple[Loop, ...]:
        """A short basis of independent loops."""
        return independent_loops(self)

    def __repr__(self) -> str:
        groups = ", ".join(group.name for group in self.groups[:SHOWN_GROUPS])
        more = f" and {len(self.groups) - SHOWN_GROUPS} more" if len(self.groups) > SHOWN_GROUPS else ""
        faults = f", {len(self.faults)} faults" if self.faults else ""
        found = f"groups {groups}{more}" if groups else "no groups"
        return f"Structure({self.mechanism.title!r}: mobility {self.mobility.freedoms}, {found}{faults})"
