"""Motions prescribed the other way round: points led along paths, links whose angles are told."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.display import short
from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.base.given_numbers import planar_numbers, real_numbers
from compoundkin.model.laws import Law, as_law, constant_speed
from compoundkin.model.leads.contract import Path
from compoundkin.model.leads.lead import Lead
from compoundkin.model.leads.paths import CurvePath, FunctionPath, LinePath, TimedPlaces
from compoundkin.model.profiles import PointsProfile, Profile

__all__ = [
    "KINDS", "WRITTEN", "CurvePath", "FunctionPath", "Lead", "LinePath", "Path", "TimedPlaces",
    "as_path", "as_prescribed", "place_table",
]  # fmt: skip

KINDS: tuple[type[Path], ...] = (TimedPlaces, LinePath, CurvePath, FunctionPath)

# Those that a mechanism file can hold, by their name there.
WRITTEN: dict[str, type[Path]] = {kind.kind: kind for kind in KINDS if kind.keys}

WHEN = "say when it is where: time=, or law= for the length of way in time"


@checked
def place_table(times: Any, places: Any, *, degree: int = 5, repeat: bool = False) -> TimedPlaces:
    """Return the path through places at times (seconds). A spline through them, complex or (n, 2).

    >>> place_table([0, 1, 2], [(0, 0), (1, 0), (2, 2)]).span
    (0.0, 2.0)
    """
    return TimedPlaces(times, _places("along.places", places), degree, repeat)


def as_path(where: str, along: Any, time: Any, law: Law | None) -> Path:
    """Return what a point is led along as a path. Raises InvalidMechanism naming `where` for anything else.

    >>> as_path("drives.G.along", lambda t: 1j * t, None, None).kind
    'function'
    """
    try:
        return _path(where, along, time, law)
    except InvalidMechanism as error:
        placed = (replace(p, where=where + p.where.removeprefix("along")) if p.where.startswith("along") else p
                  for p in error.problems)  # fmt: skip
        raise InvalidMechanism(placed) from None


def _path(where: str, along: Any, time: Any, law: Law | None) -> Path:
    if isinstance(along, Path) or callable(along):
        if time is not None or law is not None:
            raise InvalidMechanism(Problem(where, "it says itself when it is where", "leave time and law out"))
        return along if isinstance(along, Path) else FunctionPath(along)
    if time is not None and law is not None:
        raise InvalidMechanism(Problem(where, "times and a law both say when it is where", "leave one of them out"))
    if isinstance(along, Profile) and law is None:
        raise InvalidMechanism(Problem(where, "a curve is no motion", "give law=, the length of way in time"))
    if isinstance(along, Profile) and law is not None:
        return CurvePath(along, law)
    places = _places(where, along)
    if time is not None:
        return TimedPlaces(real_numbers(f"{where}.time", time, InvalidMechanism), places)
    if law is None:
        raise InvalidMechanism(Problem(where, "places are no motion", WHEN))
    if len(places) < 4:
        return LinePath(places, law)
    return CurvePath(PointsProfile(places, closed=places[0] == places[-1]), law)


def as_prescribed(where: str, law: Any) -> Law | None:
    """Return as a law what is prescribed.

    It is a law, a Python function of time, or a number that stays.
    """
    if law is None or callable(law) or isinstance(law, Law):
        return as_law(where, law)
    held = real_numbers(where, law, InvalidMechanism)
    if held.ndim:
        how = "write laws.time_table(times, values)"
        raise InvalidMechanism(Problem(where, "several values are no motion without times", how))
    if not np.isfinite(held):
        raise InvalidMechanism(Problem(where, f"{held} is no value to hold", "write a finite number"))
    return constant_speed(0.0, float(held))


def _places(where: str, places: Any) -> tuple[complex, ...]:
    """Return places given as complex numbers, as (x, y), or as an array (n, 2)."""
    found = planar_numbers(where, places, InvalidMechanism)
    if found.ndim == 2 and found.shape[1] == 2 and not np.any(found.imag):
        found = found[:, 0].real + 1j * found[:, 1].real
    if found.ndim != 1 or len(found) < 2 or not np.isfinite(found).all():
        what = f"{short(places)} are not two places or more"
        raise InvalidMechanism(Problem(where, what, "write [(x, y), (x, y), ...], complex numbers, or an array (n, 2)"))
    return tuple(complex(place) for place in found)
