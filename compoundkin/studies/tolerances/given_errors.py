"""Tolerances as they are given: which dimension each changes, and what source of errors it is."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.arguments import real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.model.attributes import AXES
from compoundkin.studies.responses import StudiedPath
from compoundkin.studies.tolerances.contract import ErrorSource
from compoundkin.studies.tolerances.dimension_tolerance import DimensionTolerance
from compoundkin.studies.tolerances.varied_dimension import VariedDimension
from compoundkin.studies.variations import variation_of
from compoundkin.studies.variations.contract import Variation

# A source of errors of the numbers of these names, of the unit and the value of their dimension.
MakeSource: TypeAlias = Callable[[tuple[str, ...], str, Number], ErrorSource]


class GivenError(NamedTuple):
    """What is given for a dimension.

    It is a source of errors once the numbers of the dimension are known.
    """

    dimension: str
    source: MakeSource


def given_tolerances(tolerances: Mapping[str, Any], sigmas: float) -> list[GivenError]:
    """Return what tolerances are.

    They are 0.05 to either side, two deviations (-0.02, 0.05), or variations of the whole dimension. Raises
    InvalidInput for what is none.
    """
    for name in tolerances:
        point = _point(name)
        if point in tolerances:
            what = f"{point!r} has a tolerance, which is that of both coordinates"
            raise InvalidInput(Problem(f"tolerances.{name}", what, f"give {point}.x and {point}.y, or {point} alone"))
    return [GivenError(name, _tolerance(name, given, sigmas)) for name, given in tolerances.items()]


def _tolerance(name: str, given: Any, sigmas: float) -> MakeSource:
    where = f"tolerances.{name}"
    if isinstance(given, Variation) or type(given).__module__.startswith("scipy."):
        variation = variation_of(where, given)
        return lambda numbers, unit, own: VariedDimension.of(name, numbers, unit, variation, own, sigmas)
    low, high = _limits(where, given)
    return lambda numbers, unit, own: DimensionTolerance(name, numbers, unit, low, high, sigmas)


def _limits(where: str, given: Any) -> tuple[float, float]:
    found = real_numbers(where, given)
    if found.shape not in ((), (2,)) or not np.isfinite(found).all():
        raise InvalidInput(
            Problem(where, f"{short_repr(given)} is no tolerance", "give 0.05, or deviations (-0.02, 0.05)")
        )
    low, high = (-found, found) if found.ndim == 0 else found
    if low > high:
        remedy = f"give {-float(found)}" if found.ndim == 0 else f"give ({high}, {low})"
        raise InvalidInput(Problem(where, f"the tolerance {short_repr(given)} is less than nothing", remedy))
    return float(low), float(high)


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


def _hold_one_motion(path: StudiedPath) -> None:
    if len(path.reference.shape) > 1:
        what = f"they are of several motions, {path.reference.shape}, and tolerances are of one"
        raise InvalidInput(Problem("values", what, "give one value for each pose"))


def error_sources(path: StudiedPath, given: Sequence[GivenError]) -> tuple[ErrorSource, ...]:
    """Return the sources of errors of a path.

    Raises InvalidInput where a dimension has several values, or the drivers have.
    """
    _hold_one_motion(path)
    stated, sources = path.compiled.programs.stated, []
    for one in given:
        dimension = stated.known[one.dimension]
        own = stated.own(dimension)
        if np.size(own) != 1:
            what = f"it has {np.size(own)} values, and tolerances are of one design"
            raise InvalidInput(Problem(f"tolerances.{one.dimension}", what, "give the mechanism one value"))
        sources.append(one.source(dimension.coordinates, stated.unit(dimension), np.reshape(own, ())))
    return tuple(sources)
