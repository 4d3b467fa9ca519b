"""Profiles of cams in mechanism files: a table with the kind of the profile and what it holds; and their programs."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from compoundkin.files.law_tables import made, of_kind, segments
from compoundkin.model.fields import Key
from compoundkin.model.laws.motion_programs import Program, Segment
from compoundkin.model.profiles import WRITTEN, Disc, Profile

if TYPE_CHECKING:
    from compoundkin.files.recovery import Recovery

# The spans of a cam's program are of its rotation.
SEGMENT = tuple(replace(key, kind="turn") if key.kind == "span" else key for key in Segment.keys)
# It is told what repeats by the cam.
PROGRAM = (
    Key("segments", "turned", "Its dwells, rises and falls over a full turn, one after another.", required=True),
    Key("start", "coordinate", "The lift at its beginning.", default=0.0),
)


# What takes the place of a broken profile: any roller fits into it.
STAND_IN = Disc(1e9)


def profile(log: Recovery, raw: Any, where: str, angle: bool | None) -> Profile:
    """The profile that a table says; a disc where it is broken, which is reported.

    Where the follower turns about a pivot, the rises of its program are angles.
    """
    found: Profile | None = of_kind(log, "profile", WRITTEN, raw, where, isinstance(raw, dict) and "pivot" in raw)
    return STAND_IN if found is None else found


def program(log: Recovery, raw: Any, where: str, angle: bool | None) -> Program | None:
    """A program over a turn of a cam: its segments alone, or a table that also says where it starts."""
    table = raw if isinstance(raw, dict) else {"segments": raw}
    found: Program | None = made(log, Program, table, where, angle, PROGRAM)
    return found


def turned(log: Recovery, raw: Any, where: str, angle: bool | None) -> tuple[Segment, ...]:
    """The segments of a cam's program."""
    return segments(log, raw, where, angle, SEGMENT)
