"""Frames as GIF, by Pillow: one palette for all of them, for ever anew."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.base.suffixes import suffix_for
from compoundkin.view.animation.film_palette import indices, nearest_table, palette

# Browsers show a frame that should be shorter than this, hundredths of a second, for a tenth of a second.
SHORTEST = 2
# So many frames tell which colours there are; one colour is left for what stays as it was.
SAMPLED, MOST_COLOURS = 6, 255


def gif(
    frame: Callable[[int], Number],
    count: int,
    hold: float,
    size: tuple[int, int],
    progress: Callable[[int, int], None],
) -> bytes:
    """Frames, arrays of pixels shown for `hold` seconds each, as the bytes of a GIF.

    Raises InvalidInput where Pillow is not installed, and for more frames a second than a GIF can have.
    """
    image = require_pillow()
    if count > 1 and 100.0 * hold < SHORTEST - 1e-9:
        what = f"a GIF has at most {100 // SHORTEST} frames a second"
        raise InvalidInput(Problem("fps", what, "ask for fewer, for more seconds, or for an .mp4"))
    known = {k: frame(k) for k in sorted({count * n // SAMPLED for n in range(SAMPLED)})}
    colours = palette(np.concatenate(list(known.values())), MOST_COLOURS)
    table = nearest_table(colours)

    def images() -> Iterator[Any]:
        for k in range(count):
            numbers = indices(known.pop(k) if k in known else frame(k), table)
            shown = image.frombytes("P", size, numbers.tobytes())
            shown.putpalette(colours.astype(np.uint8).tobytes())
            yield shown
            progress(k + 1, count)

    first, *others = images()
    written = io.BytesIO()
    first.save(
        written, "GIF", save_all=True, append_images=others, duration=_durations(count, hold), loop=0, optimize=False
    )
    return written.getvalue()


def require_pillow() -> Any:
    """Pillow's images; raises InvalidInput where it is not installed."""
    try:
        from PIL import Image
    except ImportError:
        what = "GIF needs Pillow"
        remedy = "pip install compoundkin[animation], or save an .svg"
        raise InvalidInput(Problem(suffix_for("animation", "gif"), what, remedy)) from None
    return Image


def _durations(count: int, hold: float) -> list[int]:
    """For how long each frame is shown, milliseconds in whole hundredths of a second whose sum is the whole.

    >>> _durations(4, 0.055)
    [60, 50, 60, 50]
    """
    ends = [round(100.0 * hold * k + 1e-9) for k in range(count + 1)]
    return [10 * (b - a) for a, b in pairwise(ends)]
