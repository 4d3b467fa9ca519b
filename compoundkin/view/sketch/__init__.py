"""Pictures: kinematic sketches, vector polygons, structure; shapes as data, and SVG and TikZ made of them.

A pair gives its marks in its members' own frames: a pin, a guide with the part that the motion uses, a groove, a disc,
a track, a profile. Painters know marks, not kinds of pairs. The scale leaves room for the lengths of links; marks have
fixed sizes in picture units, and a mechanism of many links makes a picture of more units, with finer lines. Every
picture is drawn twice: to measure its shapes, then in a window that just holds them. Labels are placed one after
another where they cover least, and again when all others are known; nothing depends on fonts.

Painters also run on traced numbers, whose arithmetic is recorded while every branch goes by the values; `complex()` and
`float()` would lose the trace, `as_place` and `as_length` keep it.
"""

from __future__ import annotations

from compoundkin.view.sketch.picture import Picture
from compoundkin.view.sketch.picture_kinds import draw

__all__ = ["Picture", "draw"]
