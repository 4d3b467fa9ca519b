"""Pictures as arrays of pixels, by CairoSVG where it is installed."""

from __future__ import annotations

from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.view.sketch.picture import Picture
from compoundkin.view.sketch.raster import on_light_paper
from compoundkin.view.sketch.sketch_style import PAPER

# Where colours are in the four bytes of a pixel of Cairo's on machines of our days: blue, green, red.
RED_GREEN_BLUE = [2, 1, 0]
DOTS_PER_INCH = 96


def require_cairo(form: str) -> None:
    """Raise InvalidInput where CairoSVG is not installed."""
    try:
        import cairosvg  # noqa: F401
    except (ImportError, OSError) as error:
        what = f"{form.upper()} needs CairoSVG and the library Cairo: {error}"
        raise InvalidInput(Problem(f".{form}", what, "pip install compoundkin[animation], or save an .svg")) from None


def pixel_size(width: float, height: float, size: float) -> tuple[int, int]:
    """Width and height in pixels, even numbers as films need them, the longer one that of `size` or next to it.

    >>> pixel_size(300.0, 199.0, 640.0)
    (640, 424)
    """
    scale = size / max(width, height)
    return max(2, 2 * round(width * scale / 2.0)), max(2, 2 * round(height * scale / 2.0))


def pixels(picture: Picture, width: int, height: int) -> Number:
    """A picture on light paper, bytes of red, green, blue, (height, width, 3)."""
    from cairosvg.parser import Tree
    from cairosvg.surface import PNGSurface

    tree = Tree(bytestring=on_light_paper(picture.svg).encode("utf-8"))
    # drawn, but not packed as PNG and unpacked again, which takes longer than drawing
    surface: Any = PNGSurface(
        tree, None, DOTS_PER_INCH, output_width=width, output_height=height, background_color=PAPER[0]
    ).cairo
    surface.flush()
    rows = np.frombuffer(surface.get_data(), dtype=np.uint8).reshape(height, surface.get_stride())
    return np.ascontiguousarray(rows[:, : 4 * width].reshape(height, width, 4)[:, :, RED_GREEN_BLUE])
