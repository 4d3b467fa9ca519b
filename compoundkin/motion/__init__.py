"""Solving: from a mechanism and driver values to a motion with every derivative asked for."""

from __future__ import annotations

from compoundkin.motion.model import LinkMotion, Motion, PairMotion, PointMotion, Vectors
from compoundkin.motion.solving import solve

__all__ = ["LinkMotion", "Motion", "PairMotion", "PointMotion", "Vectors", "solve"]
