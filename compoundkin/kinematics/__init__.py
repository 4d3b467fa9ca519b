"""Solving: from a mechanism and driver values to a motion with every derivative asked for."""

from __future__ import annotations

from compoundkin.base import display
from compoundkin.base.arrays import Vectors
from compoundkin.kinematics.motion import LinkMotion, Motion, PairMotion, PointMotion
from compoundkin.kinematics.solution import solve

__all__ = ["LinkMotion", "Motion", "PairMotion", "PointMotion", "Vectors", "solve"]

display.register(course="compoundkin.kinematics.extremes.dead_points:course_quantity")
