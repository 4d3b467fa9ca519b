"""Pictures: kinematic sketches, vector polygons, structure; shapes as data, and SVG made of them."""

from __future__ import annotations

from compoundkin.view.sketch.picture import Picture
from compoundkin.view.sketch.picture_kinds import draw

__all__ = ["Picture", "draw"]
