"""Mobility that depends on dimensions: what really moves, what is held twice, and what no driver moves."""

from __future__ import annotations

from compoundkin.freedom.analysis import Gap, MobilityAnalysis, mobility_analysis
from compoundkin.freedom.passive import PassiveFreedom
from compoundkin.freedom.relaxing import relaxed, solvable

__all__ = ["Gap", "MobilityAnalysis", "PassiveFreedom", "mobility_analysis", "relaxed", "solvable"]
