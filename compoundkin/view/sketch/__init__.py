"""Pictures: kinematic sketches, vector polygons, structure; shapes as data, and SVG made of them."""

from __future__ import annotations

from compoundkin.view.sketch.picture import Picture
from compoundkin.view.sketch.sketches import draw
from compoundkin.view.sketch.structure_pictures import draw_structure
from compoundkin.view.sketch.vector_polygons import vector_polygon

__all__ = ["Picture", "draw", "draw_structure", "vector_polygon"]
