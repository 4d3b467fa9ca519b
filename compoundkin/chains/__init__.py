"""The atlas of kinematic chains, and names by it: graphs of links and pairs, no coordinates."""

from __future__ import annotations

from compoundkin.chains.atlas import (
    AssurGroup,
    Inversion,
    assur_groups,
    chains,
    inversions,
    number_of,
    trusses,
)
from compoundkin.chains.canonical import Canonical, Coloured, canonical
from compoundkin.chains.chain import Chain
from compoundkin.chains.chain_names import chain_name
from compoundkin.chains.generation import chains_of
from compoundkin.chains.joints import Joint, Joints
from compoundkin.chains.naming import ChainName, name_of

__all__ = [
    "AssurGroup",
    "Canonical",
    "Chain",
    "ChainName",
    "Coloured",
    "Inversion",
    "Joint",
    "Joints",
    "assur_groups",
    "canonical",
    "chain_name",
    "chains",
    "chains_of",
    "inversions",
    "name_of",
    "number_of",
    "trusses",
]
