"""Solving: from a mechanism and driver values to a motion with every derivative asked for."""

from __future__ import annotations

from compoundkin.motion.model import Motion
from compoundkin.motion.solving import solve
from compoundkin.motion.views import LinkMotion, PairMotion, PointMotion, Vectors

__all__ = ["LinkMotion", "Motion", "PairMotion", "PointMotion", "Vectors", "solve"]
