"""Outlines at many places of a motion as arrays of planar geometries, and what lies between two of them."""

from __future__ import annotations

from typing import Any

import numpy as np

from compoundkin.analysis.interference.shapely_library import shapely
from compoundkin.base.arrays import Number
from compoundkin.model.outline_shapes import OutlineShape


def core_at(shape: OutlineShape, z: Number = 0j, u: Number = 1 + 0j) -> Any:
    """Return the cores of a shape as geometries, (n,).

    Its link has origins `z` and orientations `u` there; of numbers it is one.
    """
    return geometries(np.asarray(z)[..., None] + np.asarray(u)[..., None] * np.array(shape.core), shape.closed)


def geometries(vertices: Number, closed: bool) -> Any:
    """Return points, lines or polygons of these vertices, (n, vertices)."""
    library = shapely()
    placed = np.stack([vertices.real, vertices.imag], axis=-1)
    if placed.shape[-2] == 1:
        return library.points(placed[..., 0, :])
    return library.polygons(library.linearrings(placed)) if closed else library.linestrings(placed)


def clearance(one: OutlineShape, other: OutlineShape, cores: tuple[Any, Any]) -> Number:
    """Return how far apart two shapes are, (n,), from the cores of both.

    It is negative where their edges overlap, and not less than both radii where their cores cross.
    """
    return np.asarray(shapely().distance(*cores)) - (one.radius + other.radius)


def nearest_places(cores: tuple[Any, Any]) -> Number:
    """Return the nearest places of two cores, complex (n, 2)."""
    library = shapely()
    lines = np.atleast_1d(library.shortest_line(*cores))
    ends = library.get_coordinates(lines).reshape(len(lines), 2, 2)
    return np.asarray(ends[..., 0] + 1j * ends[..., 1])


def between_outlines(one: OutlineShape, other: OutlineShape, cores: tuple[Any, Any]) -> Number:
    """Return the places in the middle between the edges of two shapes, complex (n,)."""
    ends = nearest_places(cores)
    distance = np.abs(ends[:, 1] - ends[:, 0])
    with np.errstate(invalid="ignore", divide="ignore"):
        part = np.where(distance > 0.0, 0.5 * (1.0 + (one.radius - other.radius) / distance), 0.0)
    return np.asarray(ends[:, 0] + part * (ends[:, 1] - ends[:, 0]))
