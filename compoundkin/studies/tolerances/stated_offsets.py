"""Offsets of guides that go through a point: they are none, and stated so that they can have errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import pairs_among
from compoundkin.programs.dimensions import StatedDimensions

# The number of slots and guides that their clearance changes.
OFFSET = "offset"


def guides_of(mechanism: Mechanism) -> dict[str, Any]:
    """Return the straight guides and slots that are written out, by name."""
    found = {pair.name: pair for pair in pairs_among(mechanism.items)}
    return {name: pair for name, pair in found.items() if any(key.name == OFFSET for key in pair.keys)}


def with_offsets(mechanism: Mechanism, names: Sequence[str]) -> Mechanism:
    """Return the mechanism with the offsets stated that are among some names of dimensions.

    One that is neither written nor read off the drawing is 0.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.pairs import slide
    >>> way = slide("block", on="frame", through="O", at="B", name="way")
    >>> press = Mechanism("m", link("frame", O=0), link("block", B=0), way, drive("block"))
    >>> with_offsets(press, ["way.offset"]).written_pairs[0].offset
    0.0
    """
    asked = {name: pair for name, pair in guides_of(mechanism).items() if f"{name}.{OFFSET}" in names}
    if not asked:
        return mechanism
    ends = {pair.name: pair.ends(mechanism.geometry) for pair in mechanism.written_pairs}
    known = StatedDimensions(mechanism, ends).known
    lacking = [pair for name, pair in asked.items() if f"{name}.{OFFSET}" not in known]
    return mechanism.replace(*(replace(pair, offset=0.0) for pair in lacking))
