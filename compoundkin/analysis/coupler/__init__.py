"""Relative motion of any two links as geometry. Pole, centrodes, inflection circle, curvature of paths."""

from compoundkin.analysis.coupler.bresse_circles import (
    BresseCircle,
    CanonicalFrame,
    acceleration_pole,
    canonical_frame,
    inflection_circle,
    tangential_circle,
)
from compoundkin.analysis.coupler.centrodes import Centrodes, Pole, centrode_curvature, centrodes, pole, pole_velocity
from compoundkin.analysis.coupler.path_curvature import (
    PathCurvature,
    StationaryCurvature,
    curvature_rate,
    euler_savary,
    path_curvature,
    stationary_curvature,
)
from compoundkin.analysis.coupler.relative_motion import relative_link, relative_point

__all__ = [
    "BresseCircle",
    "CanonicalFrame",
    "Centrodes",
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
