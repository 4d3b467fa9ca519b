"""The atlas of kinematic chains, and names by it. Graphs of links and pairs, no coordinates."""

from __future__ import annotations

from compoundkin.synthesis.chains.chain import Chain
from compoundkin.synthesis.chains.chain_atlas import (
    AssurGroup,
    Inversion,
    assur_group,
    assur_groups,
    chains,
    group_name,
    inversions,
    number_of,
    trusses,
)
from compoundkin.synthesis.chains.chain_names import chain_name
from compoundkin.synthesis.chains.coloured_graphs import Canonical, Coloured, canonical
from compoundkin.synthesis.chains.generation import chains_of
from compoundkin.synthesis.chains.joints import Joint, Joints
from compoundkin.synthesis.chains.mechanism_names import ChainName, group_truss, name_of, named, structure_name
from compoundkin.synthesis.chains.skeletons import mechanism_from, symmetric_drivers

__all__ = [
    "AssurGroup",
    "Canonical",
    "Chain",
    "ChainName",
    "Coloured",
    "Inversion",
    "Joint",
    "Joints",
    "assur_group",
    "assur_groups",
    "canonical",
    "chain_name",
    "chains",
    "chains_of",
    "group_name",
    "group_truss",
    "inversions",
    "mechanism_from",
    "name_of",
    "named",
    "number_of",
    "structure_name",
    "symmetric_drivers",
    "trusses",
]
