"""Structure without coordinates: mobility, loops, composite links, Assur groups in solving order, faults."""

from __future__ import annotations

from compoundkin.structure.assur_groups import roman
from compoundkin.structure.decomposition import decompose, without_leads
from compoundkin.structure.graph import (
    Loop,
    independent_loops,
    kinematic_graph,
    links_by_pairs,
    loop_count,
    loops_through,
    pair_counts,
    simple_loops,
)
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.mobility_count import Body, DrivenPair, Fault, Group, Mobility, PairCount, Passive

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
    "without_leads",
]
