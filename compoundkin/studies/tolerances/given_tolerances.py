"""Tolerances and clearances as they are given: which dimension each changes, and within which limits."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.display import short
from compoundkin.base.errors import CompoundkinError, InvalidInput, Problem
from compoundkin.base.given_numbers import real_numbers
from compoundkin.programs.dimensions.free_dimension import AXES, FreeDimension
from compoundkin.studies.tolerances.contract import ErrorSource
from compoundkin.studies.tolerances.dimension_tolerance import DimensionTolerance


class Limits(NamedTuple):
    """The least and the greatest error of a dimension."""

    low: float
    high: float


def given_limits(tolerances: Mapping[str, Any]) -> dict[str, Limits]:
    """Return the limits of each tolerance.

    It is given as 0.05 to either side, or as two deviations (-0.02, 0.05). Raises InvalidInput for what is none.
    """
    return {name: _limits(f"tolerances.{name}", given) for name, given in tolerances.items()}


def _limits(where: str, given: Any) -> Limits:
    found = real_numbers(where, given)
    if found.shape not in ((), (2,)) or not np.isfinite(found).all():
        raise InvalidInput(Problem(where, f"{short(given)} is no tolerance", "give 0.05, or deviations (-0.02, 0.05)"))
    low, high = (-found, found) if found.ndim == 0 else found
    if low > high:
        remedy = f"give {-float(found)}" if found.ndim == 0 else f"give ({high}, {low})"
        raise InvalidInput(Problem(where, f"the tolerance {short(given)} is less than nothing", remedy))
    return Limits(float(low), float(high))


def freed(names: Sequence[str]) -> tuple[str, ...]:
    """Return the dimensions that must be free for some names.

    A point that is among them has both coordinates.

    >>> freed(["plate.C.x", "plate.C", "crank.B.x"])
    ('plate.C', 'crank.B.x')
    """
    once = dict.fromkeys(names)
    return tuple(name for name in once if _point(name) not in once)


def _point(name: str) -> str:
    point, _, axis = name.rpartition(".")
    return point if axis in AXES else ""


def hold_once(names: Sequence[str]) -> None:
    """Raise InvalidInput where a point has a tolerance and one of its coordinates another."""
    twice = [name for name in names if _point(name) in names]
    if twice:
        point = _point(twice[0])
        what = f"{point!r} has a tolerance, which is that of both coordinates"
        raise InvalidInput(Problem(f"tolerances.{twice[0]}", what, f"give {point}.x and {point}.y, or {point} alone"))


@contextmanager
def told_of(argument: str) -> Iterator[None]:
    """Tell what is wrong with dimensions by the argument that has them."""
    try:
        yield
    except CompoundkinError as error:
        told = (replace(one, where=one.where.replace("free.", f"{argument}.", 1)) for one in error.problems)
        raise type(error)(told, error.heading) from None


def coordinates_of(one: FreeDimension) -> tuple[str, ...]:
    """Return the names of its numbers, as slopes have them."""
    return tuple(f"{one.name}.{axis}" for axis in AXES) if one.is_vector else (one.name,)


def tolerance_sources(
    known: Mapping[str, FreeDimension], limits: Mapping[str, Limits], sigmas: float
) -> tuple[ErrorSource, ...]:
    """Return the sources of errors that tolerances are."""
    return tuple(
        DimensionTolerance(name, coordinates_of(known[name]), low, high, sigmas) for name, (low, high) in limits.items()
    )
