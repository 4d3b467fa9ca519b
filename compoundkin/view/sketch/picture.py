"""`Picture`: shapes with their size and title, shown and saved."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import Kind
from compoundkin.files.saved_files import Savable
from compoundkin.view.sketch.raster import converted
from compoundkin.view.sketch.shapes import Shape
from compoundkin.view.sketch.svg import NATURAL, inline, svg
from compoundkin.view.sketch.window import Window

# The longer side of a picture has so many pixels, at least and at most.
SMALLEST, LARGEST = 16, 20000

# The longest side of a picture for which no size is asked for.
PAGE = 800.0


@dataclass(frozen=True)
class Picture(Savable):
    """A picture: its shapes in picture units, how large it is in them, and shown (`size`, pixels of its longer side).

    Without a `size` texts are as large as those of a page, and no picture larger than a page. `window` tells where a
    place of the mechanism is on it; None where a picture is not to scale.
    """

    saved_as: ClassVar[Kind] = "picture"

    shapes: tuple[Shape, ...] = field(repr=False)
    width: float
    height: float
    title: str
    description: str = ""
    size: float | None = None
    window: Window | None = field(default=None, repr=False)

    @cached_property
    def svg(self) -> str:
        """Its source as SVG."""
        longer = max(self.width, self.height)
        size = min(NATURAL * longer, PAGE) if self.size is None else self.size
        return svg(self.shapes, self.width, self.height, size, self.title, self.description)

    @property
    def inline(self) -> str:
        """It as part of a page, which must have the style sheet for its shapes."""
        return inline(self.shapes, self.width, self.height, self.title, self.description)

    def content(self, form: str) -> bytes:
        """Return the bytes of a file in the form "svg", "png" or "pdf".

        Raises InvalidInput for PNG and PDF where CairoSVG is not installed.
        """
        return self.svg.encode("utf-8") if form == "svg" else converted(self.svg, form)

    def _repr_svg_(self) -> str:
        return self.svg

    def __repr__(self) -> str:
        return f"Picture({self.title!r}, {self.width:g} x {self.height:g})"


def checked_size(size: Any) -> float | None:
    """A number of pixels, or None; raises InvalidInput for anything else.

    >>> checked_size(640)
    640.0
    """
    if size is None:
        return None
    if isinstance(size, bool) or not isinstance(size, int | float) or not SMALLEST <= size <= LARGEST:
        raise InvalidInput(Problem("size", f"{size!r} is not a number of pixels", f"{SMALLEST} to {LARGEST}"))
    return float(size)
