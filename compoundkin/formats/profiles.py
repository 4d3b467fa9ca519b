"""Profiles of cams in mechanism files: a table with the kind of the profile and what it holds; and their programs."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from compoundkin.formats.laws import made, of_kind, tables
from compoundkin.profiles import WRITTEN, Profile
from compoundkin.programs import Program, Segment

if TYPE_CHECKING:
    from compoundkin.formats.recovery import Recovery

# The spans of a cam's program are of its rotation.
SEGMENT = tuple(replace(key, kind="turn") if key.kind == "span" else key for key in Segment.keys)


def profile(log: Recovery, raw: Any, where: str, angle: bool | None) -> Profile | None:
    """The profile that a table says; None where it is broken, which is reported.

    Where the follower turns about a pivot, the rises of its program are angles.
    """
    return of_kind(log, "profile", WRITTEN, raw, where, isinstance(raw, dict) and "pivot" in raw)


def program(log: Recovery, raw: Any, where: str, angle: bool | None) -> Program | None:
    """A program over the rotation of a cam: its segments alone, or a table that also says where it starts."""
    if isinstance(raw, dict):
        keys = tuple(replace(key, kind="turns") if key.kind == "segments" else key for key in Program.keys)
        found = made(log, Program, raw, where, angle, keys)
    else:
        found = segments(log, raw, where, angle)
    return found
