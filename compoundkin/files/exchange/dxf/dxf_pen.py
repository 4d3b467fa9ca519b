"""A pen on a DXF layout: edges, circles, splines, lines and texts of complex places."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.files.exchange.dxf.legal_names import literal
from compoundkin.files.exchange.dxf.outline_contours import Contour
from compoundkin.files.exchange.dxf.profile_splines import ProfileSpline

# Entities on this layer of a block take that of the block.
OF_BLOCK = "0"


@dataclass(frozen=True)
class DxfPen:
    """What draws on one layer of a layout, a block or the model.

    All is moved `by` a distance.
    """

    layout: Any
    layer: str = OF_BLOCK
    by: complex = 0j

    def contour(self, edges: Contour) -> None:
        """Draw a closed contour, with arcs as bulges; a whole circle as one."""
        centre = edges[0].centre
        if centre is not None and all(edge.centre == centre for edge in edges):
            self.circle(centre, edges[0].radius)
            return
        corners = [(*self._pair(edge.start), edge.bulge) for edge in edges]
        self.layout.add_lwpolyline(corners, format="xyb", close=True, dxfattribs=self._own)

    def line(self, places: Sequence[complex] | Number, closed: bool = False) -> None:
        """Draw a line through places; a straight one as such."""
        ends = [self._pair(place) for place in places]
        if len(ends) == 2:
            self.layout.add_line(*ends, dxfattribs=self._own)
        else:
            self.layout.add_lwpolyline(ends, close=closed, dxfattribs=self._own)

    def circle(self, centre: complex, radius: float) -> None:
        """Draw a circle."""
        self.layout.add_circle(self._pair(centre), radius, dxfattribs=self._own)

    def arc(self, centre: complex, radius: float, start: float, stop: float) -> None:
        """Draw an arc counterclockwise between angles in radians."""
        angles = [float(np.rad2deg(angle)) for angle in (start, stop)]
        self.layout.add_arc(self._pair(centre), radius, *angles, dxfattribs=self._own)

    def spline(self, spline: ProfileSpline) -> None:
        """Draw a cubic spline."""
        own = self.layout.add_spline(degree=3, dxfattribs=self._own)
        own.control_points = [(*self._pair(place), 0.0) for place in spline.control_points]
        own.knots = spline.knots.tolist()

    def point(self, place: complex) -> None:
        """Mark a place."""
        self.layout.add_point(self._pair(place), dxfattribs=self._own)

    def text(self, text: str, place: complex, height: float) -> None:
        """Write a text that begins at a place."""
        self.layout.add_text(literal(text), height=height, dxfattribs={**self._own, "insert": self._pair(place)})

    @property
    def _own(self) -> dict[str, str]:
        return {"layer": self.layer}

    def _pair(self, place: complex) -> tuple[float, float]:
        moved = complex(place) + self.by
        return moved.real, moved.imag
