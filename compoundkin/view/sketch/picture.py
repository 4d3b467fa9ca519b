"""`Picture`: shapes with their size and title, shown and saved."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.atomic import write_atomically
from compoundkin.view.sketch.raster import converted
from compoundkin.view.sketch.shapes import Shape
from compoundkin.view.sketch.svg import NATURAL, inline, svg
from compoundkin.view.sketch.window import Window

# The longer side of a picture has so many pixels, at least and at most.
SMALLEST, LARGEST = 16, 20000

# The longest side of a picture for which no size is asked for.
PAGE = 800.0

SUFFIXES = (".svg", ".png", ".pdf")


@dataclass(frozen=True)
class Picture:
    """A picture: its shapes in picture units, how large it is in them, and shown (`size`, pixels of its longer side).

    Without a `size` texts are as large as those of a page, and no picture larger than a page. `window` tells where a
    place of the mechanism is on it; None where a picture is not to scale.
    """

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

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it to an .svg, .png or .pdf file, whole or not at all.

        Raises InvalidInput for another suffix, where the file cannot be written, and for PNG and PDF where CairoSVG is
        not installed.
        """
        suffix = Path(path).suffix.lower()
        if suffix not in SUFFIXES:
            what = f"a picture is not saved as {suffix!r}" if suffix else "the file has no suffix"
            raise InvalidInput(Problem(str(path), what, f"one of {', '.join(SUFFIXES)}"))
        made = self.svg.encode("utf-8") if suffix == ".svg" else converted(self.svg, suffix[1:])
        write_atomically(path, lambda file: file.write(made))

    def _repr_svg_(self) -> str:
        return self.svg


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
