"""Cylinders as shapes: hydraulic ones with barrel and rod, and pistons in a bore of the frame."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from compoundkin.model.elements import FRAME
from compoundkin.model.pairs.symbols import Sliding
from compoundkin.view.sketch.scene import Seen
from compoundkin.view.sketch.shapes import HATCH, Polygon, Polyline, Strokes, box, hatching
from compoundkin.view.sketch.sketch_style import BLOCK, style_of
from compoundkin.view.sketch.slide_shapes import Laid, Layer, Painter

CYLINDER = 17.0
# A cylinder ends at this part of the shortest length, and its piston keeps this distance from both ends.
BARREL = 0.92
PISTON = 7.0
# What its user calls by one of these words is drawn as a piston.
PISTONS = frozenset({"piston", "pistons", "plunger", "plungers"})
# A piston is so wide, in parts of its stroke and within bounds, and so long, in parts of its width.
WIDTH, NARROWEST, WIDEST, LENGTH = 0.25, 24.0, 44.0, 0.9
# What is between it and its bore.
PLAY = 2.0
# How much of it, in parts of its length, is out of its bore at its nearest place.
SKIRT = 0.4
# The head of a bore is so far beyond the piston's crown at its last place.
HEAD = 6.0
# Two rings are so far below the crown.
RINGS = 4.0, 7.5
# Bores that differ by less than this, in picture units, are one.
ONE = 1.0
# A rod that stands more across the bore than this, in parts of its length, is pinned to a stem outside.
ACROSS = 0.5


def cylinder(painter: Painter, seen: Seen, mark: Sliding) -> Iterator[Laid]:
    """Draw a cylinder from its foot, and the rod with its piston."""
    barrel, rod = seen.members
    foot, eye, e = painter.place(barrel, mark.at), painter.place(rod, mark.block), painter.along(barrel, mark.along)
    scale = painter.window.scale
    shortest, longest = sorted((abs(mark.low) * scale, abs(mark.high) * scale))
    sense = 1.0 if (np.conjugate(e) * (eye - foot)).real >= 0 else -1.0
    out, inward = e * sense, painter.along(rod, mark.turn) * -sense
    here = float((np.conjugate(out) * (eye - foot)).real)
    length = BARREL * shortest if shortest > 2.0 * BLOCK[0] else max(0.6 * longest, BLOCK[0])
    rim = box(foot + out * length / 2.0, out, length, CYLINDER)
    yield Laid(Layer.BAR, Polygon(rim, painter.style("plate", barrel)), barrel)
    style = painter.style("bar", rod)
    # at the shortest length the piston is near the bottom, and at this one it is not out of the barrel
    piston = eye + inward * np.maximum(np.minimum(shortest, here) - PISTON, PISTON + (here - length))
    yield Laid(Layer.BAR, Polyline((piston, eye), style), rod)
    across = 1j * inward * (CYLINDER / 2.0 - 1.5)
    yield Laid(Layer.BAR, Polyline((piston + across, piston - across), style), rod)


def is_piston(seen: Seen) -> bool:
    """Tell whether a slide on the frame is that of a piston. Its name or that of its link says so.

    A slide that has stops is drawn with them.
    """
    if not isinstance(seen.mark, Sliding) or seen.members[0] != FRAME or any(seen.mark.stops):
        return False
    words = re.split("[^a-z]+", f"{seen.members[1]} {seen.pair.name}".lower())
    return not PISTONS.isdisjoint(words)


def piston(painter: Painter, seen: Seen, mark: Sliding) -> Iterator[Laid]:
    """Draw a piston in a bore of the frame, closed by its head. Pistons side by side share one."""
    block, stroke = seen.members[1], (mark.high - mark.low) * painter.window.scale
    wide = _width(painter, mark)
    long = wide * LENGTH
    sense, is_stem = _head(painter, seen, mark)
    eye, up = painter.place(block, mark.block), painter.along(block, mark.turn) * sense
    e = painter.along(FRAME, mark.along) * sense
    off = stroke + long if is_stem else 0.0 * stroke
    ends = (mark.low, mark.high) if sense > 0 else (mark.high, mark.low)
    near, far = (painter.place(FRAME, mark.at + mark.along * s) for s in ends)
    mouth, head = near + e * (off - long * (0.5 - SKIRT)), far + e * (off + (long / 2.0 + HEAD))
    across = e * (wide / 2.0 + PLAY) * 1j
    corners = mouth + across, head + across, head - across, mouth - across
    if _has_bore(painter, seen, mark):
        yield Laid(Layer.FRAME, Polyline(corners, "frame"), FRAME)
        yield from (Laid(Layer.BACK, hatching(*wall, 1.0), FRAME) for wall in pairwise(corners))
    middle = eye + up * off
    if is_stem:
        yield Laid(Layer.BAR, Polyline((eye, middle), painter.style("bar", block)), block)
    ring = style_of("ring", painter.scene.groups[block])
    yield Laid(Layer.BLOCK, Polygon(box(middle, up, long, wide), f"pin {ring}"), block)
    half = up * (wide / 2.0) * 1j
    grooves = [middle + up * (long / 2.0 - below) for below in RINGS]
    lines = tuple((at - half, at + half) for at in grooves)
    yield Laid(Layer.BLOCK, Strokes(lines, painter.style("thin", block)), block)


def _has_bore(painter: Painter, seen: Seen, mark: Sliding) -> bool:
    """Tell whether a piston is the first one in its bore. Those of a bank of cylinders are behind each other."""
    seen_before = painter.scene.seen[: painter.scene.seen.index(seen)]
    others = [_ends(painter, one.mark) for one in seen_before if isinstance(one.mark, Sliding) and is_piston(one)]
    own = _ends(painter, mark)
    return not any(abs(own[0] - low) < ONE and abs(own[1] - high) < ONE for low, high in others)


def _ends(painter: Painter, mark: Sliding) -> list[complex]:
    return [complex(painter.place(FRAME, mark.at + mark.along * s)) for s in (mark.low, mark.high)]


def beside(painter: Painter, seen: Seen) -> float:
    """Return how much room a slide needs on its sides, from its middle."""
    if isinstance(seen.mark, Sliding) and is_piston(seen):
        return _width(painter, seen.mark) / 2.0 + PLAY + HATCH
    return BLOCK[1] / 2.0


def _width(painter: Painter, mark: Sliding) -> float:
    """The width of a piston."""
    stroke = float(mark.high - mark.low) * float(painter.window.scale)
    return float(np.clip(WIDTH * stroke, NARROWEST, WIDEST))


def _head(painter: Painter, seen: Seen, mark: Sliding) -> tuple[float, bool]:
    """On which side along the guide the head of a bore is, away from the rods; and whether these stand across it."""
    scene, letter = painter.scene, seen.pair.letters[0]
    eye, e = painter.place(seen.members[1], mark.block), painter.along(FRAME, mark.along)
    rods = [link for link in scene.mechanism.carriers[letter] if link not in (FRAME, seen.members[1])]
    ways = [painter.place(link, p) - eye for link in rods for p in scene.points[link].values()]
    length = sum(map(abs, ways))
    toward = sum((np.conjugate(e) * way).real for way in ways)
    if length == 0 or abs(toward) > ACROSS * length:
        return (-1.0 if toward > 0 else 1.0), False
    # where neither side is that of the rods, a bore stands below
    return (1.0 if e.imag > 0 else -1.0), True
