"""Figures that engineers compute of a motion and its forces.

Mechanical advantage, poles and curvature of relative motion, features of paths, types of linkages, cams, workspaces,
equivalent linkages; equivalent inertia, balancing by masses and by springs, flywheels, noncircular gears, efforts over
a cycle, equilibrium positions, forces along the bars of links.

>>> import compoundkin as ck
>>> motion = ck.solve(ck.load("crank-rocker"), {"crank": [1.0]}, speed=1)
>>> ck.figures.mechanical_advantage(motion, "rocker", "crank").advantage.round(3)
array([3.573])
>>> ck.figures.inflection_circle(motion, "coupler").diameter.round(3)
array([63.425])
>>> ck.figures.linkage_types(ck.load("double-crank"))[0].name
'double-crank (drag link)'
"""

from __future__ import annotations

from compoundkin.analysis.cam_analysis import cam_analysis
from compoundkin.analysis.characteristics.linkage_types import four_bar_code, linkage_types
from compoundkin.analysis.characteristics.path_features import path_features, straightness
from compoundkin.analysis.coupler import (
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
from compoundkin.analysis.coupler.displacement import LinkPosition
from compoundkin.analysis.equivalents import equivalent_linkage
from compoundkin.analysis.mechanical_advantage import ForcePort, TorquePort, mechanical_advantage
from compoundkin.configurations.workspace import workspace
from compoundkin.dynamics.counterweights import counterweights
from compoundkin.dynamics.driver_course import drive_figures, force_ratio
from compoundkin.dynamics.equilibria import equilibria
from compoundkin.dynamics.flywheel import flywheel
from compoundkin.dynamics.harmonics import harmonics
from compoundkin.dynamics.intermittent_motion import intermittent_motion
from compoundkin.dynamics.mass_motion import equivalent_inertia
from compoundkin.dynamics.motor_sizing import sizing
from compoundkin.dynamics.noncircular_drive import noncircular_drive
from compoundkin.dynamics.spring_balance import balancing_springs
from compoundkin.dynamics.strength import strength

__all__ = [
    "ForcePort",
    "LinkPosition",
    "TorquePort",
    "acceleration_pole",
    "balancing_springs",
    "cam_analysis",
    "canonical_frame",
    "centrode_curvature",
    "centrodes",
    "counterweights",
    "curvature_rate",
    "displacement",
    "drive_figures",
    "equilibria",
    "equivalent_inertia",
    "equivalent_linkage",
    "euler_savary",
    "flywheel",
    "force_ratio",
    "four_bar_code",
    "harmonics",
    "inflection_circle",
    "intermittent_motion",
    "link_position",
    "linkage_types",
    "mechanical_advantage",
    "noncircular_drive",
    "path_curvature",
    "path_features",
    "pole",
    "pole_triangle",
    "pole_velocity",
    "relative_link",
    "relative_point",
    "sizing",
    "stationary_curvature",
    "straightness",
    "strength",
    "tangential_circle",
    "workspace",
]
