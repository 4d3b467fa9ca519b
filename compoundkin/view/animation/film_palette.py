"""One palette for all frames: the colours that occur most often, and the nearest of them for any other."""

from __future__ import annotations

import numpy as np

from compoundkin.base.series import Number

# Two colours of a palette differ by more than this, red, green and blue together: no eye misses what is between.
APART = 40
# Of each of red, green and blue so many bits tell which colour of the palette is the nearest.
BITS = 5
LEVELS = 1 << BITS


def palette(pixels: Number, most: int) -> Number:
    """At most so many colours of some pixels, (..., 3), the most frequent first, (colours, 3).

    What is drawn in one colour keeps it exactly; edges, whose colours lie between two, go to one nearby.

    >>> palette(np.array([[255, 255, 255], [0, 0, 0], [255, 255, 255], [250, 250, 250]]), 4).tolist()
    [[255, 255, 255], [0, 0, 0]]
    """
    flat = np.reshape(pixels, (-1, 3)).astype(np.int64) @ np.array([1 << 16, 1 << 8, 1])
    colours, counts = np.unique(flat, return_counts=True)
    ordered = colours[np.argsort(-counts, kind="stable")]
    left = np.stack([ordered >> 16, (ordered >> 8) & 255, ordered & 255], axis=-1)
    found: list[Number] = []
    while len(left) and len(found) < most:
        found.append(left[0])
        left = left[np.abs(left - left[0]).sum(axis=1) > APART]
    return np.array(found)


def nearest_table(colours: Number) -> Number:
    """Which colour of a palette is the nearest to any other: a table for `indices`."""
    levels = np.arange(LEVELS) * (256 // LEVELS) + 128 // LEVELS
    any_colour = np.stack(np.meshgrid(levels, levels, levels, indexing="ij"), axis=-1).reshape(-1, 1, 3)
    parts = np.array_split(any_colour, LEVELS)
    nearest = [np.argmin(((part - colours) ** 2).sum(axis=-1), axis=1) for part in parts]
    return np.concatenate(nearest).astype(np.uint8)


def indices(pixels: Number, table: Number) -> Number:
    """The colours of a palette, by their numbers, that are nearest to those of pixels, (..., 3)."""
    red, green, blue = np.moveaxis(pixels >> (8 - BITS), -1, 0).astype(np.intp)
    return np.asarray(table[(red * LEVELS + green) * LEVELS + blue])
