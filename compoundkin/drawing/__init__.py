"""Pictures: kinematic sketches, vector polygons, structure; shapes as data, and SVG made of them."""

from __future__ import annotations

from compoundkin.drawing.picture import Picture
from compoundkin.drawing.polygons import vector_polygon
from compoundkin.drawing.sketching import draw
from compoundkin.drawing.structures import draw_structure

__all__ = ["Picture", "draw", "draw_structure", "vector_polygon"]
