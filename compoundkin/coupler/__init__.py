"""Relative motion of any two links as geometry: pole, centrodes, inflection circle, curvature of paths."""

from compoundkin.coupler.centrodes import Centrodes, Pole, centrode_curvature, centrodes, pole, pole_velocity
from compoundkin.coupler.circles import (
    CanonicalFrame,
    Circle,
    acceleration_pole,
    canonical_frame,
    inflection_circle,
    tangential_circle,
)
from compoundkin.coupler.curvature import PathCurvature, curvature_rate, euler_savary, path_curvature
from compoundkin.coupler.relative import relative_link, relative_point
from compoundkin.coupler.stationary import StationaryCurvature, stationary_curvature

__all__ = [
    "CanonicalFrame",
    "Centrodes",
    "Circle",
    "PathCurvature",
    "Pole",
    "StationaryCurvature",
    "acceleration_pole",
    "canonical_frame",
    "centrode_curvature",
    "centrodes",
    "curvature_rate",
    "euler_savary",
    "inflection_circle",
    "path_curvature",
    "pole",
    "pole_velocity",
    "relative_link",
    "relative_point",
    "stationary_curvature",
    "tangential_circle",
]
