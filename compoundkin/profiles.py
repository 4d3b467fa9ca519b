"""Profiles of cams and curved slots, in the coordinates of the link that carries them.

>>> from compoundkin.profiles import disc
>>> disc(20).radius
20.0
"""

from __future__ import annotations

from compoundkin.model.profiles import (
    DiscProfile,
    DoubleCam,
    FormulaProfile,
    PointsProfile,
    Profile,
    Synthesised,
    conjugate,
    constant_breadth,
    disc,
    formula,
    profile,
    synthesise,
)

__all__ = [
    "DiscProfile", "DoubleCam", "FormulaProfile", "PointsProfile", "Profile", "Synthesised",
    "conjugate", "constant_breadth", "disc", "formula", "profile", "synthesise",
]  # fmt: skip
