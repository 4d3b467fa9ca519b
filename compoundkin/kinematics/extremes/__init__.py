"""What lies between the poses of a motion: places solved again, extremes, zeros, dead points."""

from __future__ import annotations

from compoundkin.kinematics.extremes.dead_points import DeadPoints, dead_points, driver_dead_points
from compoundkin.kinematics.extremes.extremes import AssembledPieces, Extreme, Extremes, extremes, pieces
from compoundkin.kinematics.extremes.motion_between import MotionBetween, between, extended_to
from compoundkin.kinematics.extremes.stretches import Measure, Places, closed_cycles, driver_pace, places_of_jumps
from compoundkin.kinematics.extremes.zeros import Zeros, zeros

__all__ = [
    "AssembledPieces",
    "DeadPoints",
    "Extreme",
    "Extremes",
    "Measure",
    "MotionBetween",
    "Places",
    "Zeros",
    "between",
    "closed_cycles",
    "dead_points",
    "driver_dead_points",
    "driver_pace",
    "extended_to",
    "extremes",
    "pieces",
    "places_of_jumps",
    "zeros",
]
