"""What lies between the poses of a motion: places solved again, extremes, zeros, dead points."""

from __future__ import annotations

from compoundkin.kinematics.extremes.dead_points import DeadPoints, dead_points, driver_dead_points
from compoundkin.kinematics.extremes.extremes_of_motion import AssembledPieces, Extreme, Extremes, extremes, pieces
from compoundkin.kinematics.extremes.measures import Measure, driver_pace
from compoundkin.kinematics.extremes.motion_between import MotionBetween, between, given_over
from compoundkin.kinematics.extremes.places import Places, closed_cycles, places_of_jumps
from compoundkin.kinematics.extremes.zeros_of_motion import Zeros, zeros

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
    "extremes",
    "given_over",
    "pieces",
    "places_of_jumps",
    "zeros",
]
