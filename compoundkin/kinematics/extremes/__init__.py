"""What lies between the poses of a motion: places solved again, extremes, zeros, dead points."""

from __future__ import annotations

from compoundkin.kinematics.extremes.extremes_of_motion import Extreme, Extremes, extremes
from compoundkin.kinematics.extremes.measures import Measure
from compoundkin.kinematics.extremes.motion_between import MotionBetween, between
from compoundkin.kinematics.extremes.places import Places, closed_cycles
from compoundkin.kinematics.extremes.zeros_of_motion import Zeros, zeros

__all__ = [
    "Extreme",
    "Extremes",
    "Measure",
    "MotionBetween",
    "Places",
    "Zeros",
    "between",
    "closed_cycles",
    "extremes",
    "zeros",
]
