"""Geometry of relative motion: pole, centrodes, inflection circle, curvature of paths.

>>> import compoundkin as ck
>>> motion = ck.solve(ck.catalog.load_named("crank-rocker"), {"crank": [1.0]}, speed=1)
>>> ck.coupler.inflection_circle(motion, "coupler").diameter.round(3)
array([63.425])
"""

from __future__ import annotations

from compoundkin.analysis.coupler import (
    BresseCircle,
    CanonicalFrame,
    Centrodes,
    Displacement,
    LinkPosition,
    PathCurvature,
    Pole,
    PoleTriangle,
    StationaryCurvature,
    acceleration_pole,
    canonical_frame,
    centrode_curvature,
    centrodes,
    curvature_rate,
    displacement,
    euler_savary,
    inflection_circle,
    link_position,
    path_curvature,
    pole,
    pole_triangle,
    pole_velocity,
    relative_link,
    relative_point,
    stationary_curvature,
    tangential_circle,
)

__all__ = [
    "BresseCircle", "CanonicalFrame", "Centrodes", "Displacement", "LinkPosition", "PathCurvature", "Pole",
    "PoleTriangle", "StationaryCurvature", "acceleration_pole", "canonical_frame", "centrode_curvature",
    "centrodes", "curvature_rate", "displacement", "euler_savary", "inflection_circle", "link_position",
    "path_curvature", "pole", "pole_triangle", "pole_velocity", "relative_link", "relative_point",
    "stationary_curvature", "tangential_circle",
]  # fmt: skip
