"""Mobility that depends on dimensions: what really moves, what is held twice, and what no driver moves."""

from __future__ import annotations

from compoundkin.structure.redundancy.finite_motion import PassiveFreedom
from compoundkin.structure.redundancy.mobility_analysis import MobilityAnalysis, MobilityGap, mobility_analysis

__all__ = ["MobilityAnalysis", "MobilityGap", "PassiveFreedom", "mobility_analysis"]
