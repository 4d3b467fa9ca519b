"""Profiles of cams and curved slots as they are written.

Coordinates are those of the link that carries the profile. What they have in common is their `curve`. They are imported
from their files.
"""

from __future__ import annotations

from compoundkin.model.fields import LateKinds
from compoundkin.model.profiles.profile import Profile

# Those that a mechanism file can hold, by their name there.
WRITTEN = LateKinds[type[Profile]](
    __name__,
    {"disc": "profile.DiscProfile", "points": "profile.PointsProfile", "made": "synthesised.Synthesised"},
)
__all__ = ["WRITTEN", "Profile"]
