"""Profiles of cams and curved slots as they are written.

Coordinates are those of the link that carries the profile. What they have in common is their `curve`.
"""

from compoundkin.model.profiles.double_cams import DoubleCam, conjugate, constant_breadth
from compoundkin.model.profiles.profile import (
    DiscProfile,
    FormulaProfile,
    PointsProfile,
    Profile,
    disc,
    formula,
    profile,
)
from compoundkin.model.profiles.synthesised import Synthesised, synthesise

KINDS: tuple[type[Profile], ...] = (DiscProfile, PointsProfile, FormulaProfile, Synthesised)
# Those that a mechanism file can hold, by their name there.
WRITTEN: dict[str, type[Profile]] = {kind.kind: kind for kind in KINDS if kind.keys}
__all__ = [
    "KINDS", "WRITTEN", "DiscProfile", "DoubleCam", "FormulaProfile", "PointsProfile", "Profile", "Synthesised",
    "conjugate", "constant_breadth", "disc", "formula", "profile", "synthesise",
]  # fmt: skip
