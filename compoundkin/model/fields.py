"""The keys a mechanism file may hold, declared beside what they describe; readers, writers and the schema follow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

# What a value is: how a file writes it and how Python holds it.
#   name     text                                         str
#   text     text                                         str
#   names    list of texts                                tuple of str
#   length   number or nested list of numbers             float or array
#   angle    the same in degrees, or {rad = ...}          float or array, radians
#   point    [x, y], {polar = [radius, degrees]}          complex or array
#   sign     1 or -1                                      int
#   flag     true or false                                bool
#   two      list of two numbers or lists of numbers      tuple of two floats or arrays
#   points   table of points by letter, or list of letters   mapping of letter to complex, array or None
#   drawing  table of points by letter                    mapping of letter to complex or array
#   whole    whole number                                 int
#   span     positive number; degrees where it is of a rotation   float
#   times    list of seconds or {from, to, step}          array
#   segments list of tables, as ProgramSegment has keys          tuple of ProgramSegment
#   law      table with a kind, and the keys of that law  law
#   number   a single number                              float
#   turn     a single angle in degrees, or {rad = ...}    float, radians
#   place    [x, y], {polar = [radius, degrees]}, single  complex
#   places   list of such points                          tuple of complex
#   turned   list of segments over degrees                tuple of ProgramSegment over radians
#   program  such a list, or a table of it and a start    Program over radians
#   profile  table with a kind, and the keys of that profile   Profile
# Of a driven coordinate, an angle (degrees in files) or a length, as its pair has it:
#   values   number or nested list, {from, to, step}, {rad = ...}   float or array
#   coordinate  number or nested list, {rad = ...}        float or array
#   rate     number or nested list, {rpm = ...}, {deg = ...}        float or array
#   at       table of such numbers by driver, rates by "driver.speed"   tuple of (key, float)
# Of a published quantity, an angle (degrees in files) or anything else, as its name says:
#   published  number or [x, y]                           complex
#   margin   number                                       float
Kind = Literal[
    "name", "text", "names", "length", "angle", "point", "sign", "flag", "two", "points", "drawing",
    "values", "rate", "at", "published", "margin",
    "whole", "span", "times", "coordinate", "segments", "law",
    "number", "turn", "place", "places", "turned", "program", "profile",
]  # fmt: skip


@dataclass(frozen=True)
class Key:
    """One key of a table in a mechanism file: its name, what it holds, its default, and a sentence on it."""

    name: str
    kind: Kind
    doc: str
    required: bool = False
    default: Any = None
