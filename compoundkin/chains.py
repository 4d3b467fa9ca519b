"""The atlas of kinematic chains, their names, and mechanisms made of them.

>>> from compoundkin.chains import chains
>>> len(chains(8))
16
"""

from __future__ import annotations

from compoundkin.synthesis.chains import (
    AssurGroup,
    Canonical,
    Chain,
    ChainName,
    Coloured,
    Inversion,
    Joint,
    Joints,
    assur_group,
    assur_groups,
    canonical,
    chain_name,
    chains,
    chains_of,
    group_name,
    group_truss,
    inversions,
    mechanism_from,
    name_of,
    named,
    number_of,
    structure_name,
    symmetric_drivers,
    trusses,
)

__all__ = [
    "AssurGroup", "Canonical", "Chain", "ChainName", "Coloured", "Inversion", "Joint", "Joints",
    "assur_group", "assur_groups", "canonical", "chain_name", "chains", "chains_of", "group_name",
    "group_truss", "inversions", "mechanism_from", "name_of", "named", "number_of", "structure_name",
    "symmetric_drivers", "trusses",
]  # fmt: skip
