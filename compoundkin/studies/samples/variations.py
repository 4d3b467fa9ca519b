"""The kinds of variations of a dimension: the first of this registry that fits is taken."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import Any

from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem, suggestion
from compoundkin.programs.dimensions import FreeDimension
from compoundkin.studies.samples.distribution import Distribution
from compoundkin.studies.samples.table_columns import table_columns
from compoundkin.studies.samples.value_ranges import AroundCentre, Levels, ValueRange
from compoundkin.studies.samples.variation import Variation

VARIATIONS: tuple[type[Variation], ...] = (ValueRange, Distribution, AroundCentre, Levels)
_REMEDY = "give a range (40, 60), a distribution scipy.stats.norm(40, 0.1), compoundkin.around(40, 0.1), or a list"


def variations_of(given: Mapping[str, Any] | str | os.PathLike[str]) -> dict[str, Variation]:
    """Return the variations of dimensions.

    Of a file with a table they are its columns. Raises InvalidInput with all that is wrong, each with its place, as
    dimensions.crank.B.
    """
    given = given if isinstance(given, Mapping) else table_columns(given)
    found: dict[str, Variation] = {}
    problems: list[Problem] = []
    for name, one in given.items():
        try:
            found[name] = variation_of(f"dimensions.{name}", one)
        except InvalidInput as error:
            problems += error.problems
    if not given:
        problems.append(Problem("dimensions", "there is none", 'name some: {"crank.B.x": (40, 60)}'))
    if problems:
        raise InvalidInput(problems)
    return found


def variation_of(where: str, given: Any) -> Variation:
    """Return the variation of a dimension. Raises InvalidInput for other objects."""
    if isinstance(given, Variation):
        return given
    for kind in VARIATIONS:
        found = kind.from_argument(where, given)
        if found is not None:
            return found
    raise InvalidInput(Problem(where, f"{short_repr(given)} is nothing that a dimension can be", _REMEDY))


def variation_from(where: str, data: Mapping[str, Any]) -> Variation:
    """Return the variation of plain data in a study file.

    Raises InvalidInput. Angles are in radians here, as in `Variation.data`.
    """
    fitting = [kind for kind in VARIATIONS if kind.keys[0] in data]
    if len(fitting) != 1:
        what = f"{short_repr(dict(data))} is nothing that a dimension can be"
        keys = ", ".join(kind.keys[0] for kind in VARIATIONS)
        raise InvalidInput(Problem(where, what, f"just one of these keys: {keys}"))
    _check_keys(where, fitting[0], data)
    return fitting[0].read(where, data)


def _check_keys(where: str, kind: type[Variation], data: Mapping[str, Any]) -> None:
    known, needed = (*kind.keys, *kind.optional), " and ".join(kind.keys)
    problems = [Problem(where, f"it has no {key!r}", f"say {needed}") for key in kind.keys if key not in data]
    problems += [
        Problem(f"{where}.{key}", "there is no such key", suggestion(key, known)) for key in data if key not in known
    ]
    if problems:
        raise InvalidInput(problems)


def check_kinds(variations: Mapping[str, Variation], dimensions: Iterable[FreeDimension]) -> None:
    """Raise InvalidInput for points instead of numbers, and the reverse."""
    problems = []
    for one in dimensions:
        if one.is_vector and not variations[one.name].is_point:
            remedy = "give points, as in ((x, y), (x, y)), or free one of its coordinates"
            problems.append(Problem(f"dimensions.{one.name}", "it is a point, and numbers are given", remedy))
        if not one.is_vector and variations[one.name].is_point:
            remedy = "give numbers, as in (40, 60)"
            problems.append(Problem(f"dimensions.{one.name}", "it is a number, and points are given", remedy))
    if problems:
        raise InvalidInput(problems)
