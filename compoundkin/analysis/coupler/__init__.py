"""Relative motion of any two links as geometry. Pole, centrodes, inflection circle, curvature of paths."""

from compoundkin.analysis.coupler.centrodes import Centrodes, Pole, centrode_curvature, centrodes, pole, pole_velocity
from compoundkin.analysis.coupler.displacement import (
    Displacement,
    LinkPosition,
    PoleTriangle,
    displacement,
    link_position,
    pole_triangle,
)
from compoundkin.analysis.coupler.path_curvature import (
    BresseCircle,
    CanonicalFrame,
    PathCurvature,
    StationaryCurvature,
    acceleration_pole,
    canonical_frame,
    curvature_rate,
    euler_savary,
    inflection_circle,
    path_curvature,
    stationary_curvature,
    tangential_circle,
)
from compoundkin.analysis.coupler.relative_motion import relative_link, relative_point

__all__ = [
    "BresseCircle",
    "CanonicalFrame",
    "Centrodes",
    "Displacement",
    "LinkPosition",
    "PathCurvature",
    "Pole",
    "PoleTriangle",
    "StationaryCurvature",
    "acceleration_pole",
    "canonical_frame",
    "centrode_curvature",
    "centrodes",
    "curvature_rate",
    "displacement",
    "euler_savary",
    "inflection_circle",
    "link_position",
    "path_curvature",
    "pole",
    "pole_triangle",
    "pole_velocity",
    "relative_link",
    "relative_point",
    "stationary_curvature",
    "tangential_circle",
]
