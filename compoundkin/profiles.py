"""Profiles of cams and curved slots, and mechanisms of a synthesised cam.

>>> from compoundkin.profiles import disc
>>> disc(20).radius
20.0
"""

from __future__ import annotations

from compoundkin.analysis.cam_analysis import cam_pairs
from compoundkin.model.cam_mechanism import cam_mechanism
from compoundkin.model.profiles import Profile
from compoundkin.model.profiles.double_cams import conjugate, constant_breadth
from compoundkin.model.profiles.profile import disc, formula, profile
from compoundkin.model.profiles.synthesised import synthesise

__all__ = [
    "Profile",
    "cam_mechanism",
    "cam_pairs",
    "conjugate",
    "constant_breadth",
    "disc",
    "formula",
    "profile",
    "synthesise",
]
