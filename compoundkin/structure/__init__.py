"""Structure without coordinates: mobility, loops, composite links, Assur groups in solving order, faults."""

from __future__ import annotations

from compoundkin.structure.decomposition import decompose
from compoundkin.structure.graph import kinematic_graph, links_by_pairs, pair_counts
from compoundkin.structure.group_names import roman
from compoundkin.structure.loops import Loop, independent_loops, loop_count, loops_through, simple_loops
from compoundkin.structure.mobility import Mobility, PairCount
from compoundkin.structure.parts import Body, DrivenPair, Fault, Group, Passive, Structure

__all__ = [
    "Body",
    "DrivenPair",
    "Fault",
    "Group",
    "Loop",
    "Mobility",
    "PairCount",
    "Passive",
    "Structure",
    "decompose",
    "independent_loops",
    "kinematic_graph",
    "links_by_pairs",
    "loop_count",
    "loops_through",
    "pair_counts",
    "roman",
    "simple_loops",
]
