"""Mobility that depends on dimensions: what really moves, what is held twice, and what no driver moves."""

from __future__ import annotations

from compoundkin.structure.redundancy.mobility_analysis import Gap, MobilityAnalysis, mobility_analysis
from compoundkin.structure.redundancy.passive_freedoms import PassiveFreedom
from compoundkin.structure.redundancy.removal import without_redundancy

__all__ = ["Gap", "MobilityAnalysis", "PassiveFreedom", "mobility_analysis", "without_redundancy"]
