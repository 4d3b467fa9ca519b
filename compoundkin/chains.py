"""Kinematic chains: their atlas and names, mechanisms made of them, built group by group, or at random.

>>> from compoundkin.chains import chains, random_mechanism
>>> len(chains(8))
16
>>> random_mechanism(groups=3, seed=1)
Mechanism('3 random groups, seed 1': 8 links, 1 driver)
"""

from __future__ import annotations

from compoundkin.synthesis.chains import (
    Chain,
    Coloured,
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
from compoundkin.synthesis.chains.joints import Joint, Joints
from compoundkin.synthesis.composer import Composer, random_mechanism

__all__ = [
    "Chain",
    "Coloured",
    "Composer",
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
    "random_mechanism",
    "structure_name",
    "symmetric_drivers",
    "trusses",
]
