"""Prescribed paths of a point: places at times, a line or curve traversed by a law, a Python function."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arguments import checked, planar_numbers, real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.copies import CopiesFields, CopiesFunction
from compoundkin.base.curves import Analytic, Curve
from compoundkin.base.curves.curve import ArcLength
from compoundkin.base.display import ShortRepr, short_repr
from compoundkin.base.errors import InvalidInput, InvalidMechanism, Problem
from compoundkin.base.series import Series, planar_series
from compoundkin.model.fields import Key
from compoundkin.model.laws import FunctionLaw, Law, TimeTable, as_law, constant_speed
from compoundkin.model.laws.constant_laws import ComparedByValue
from compoundkin.model.profiles import Profile
from compoundkin.model.profiles.profile import PointsProfile


class Path(CopiesFields, ComparedByValue, ABC):
    """Places in time. Kinds are frozen dataclasses with the keys that a file holds for them."""

    kind: ClassVar[str]  # what it is called in a file
    keys: ClassVar[tuple[Key, ...]]  # none: it cannot be written to a file

    @property
    @abstractmethod
    def span(self) -> tuple[float, float] | None:
        """Its first and last time, or None."""

    @abstractmethod
    def place(self, t: Number, order: int) -> Series:
        """Return place and derivatives at times t (seconds), complex. Raises InvalidInput where there is none."""

    @property
    def laws(self) -> tuple[Any, ...]:
        """Its laws in time."""
        return ()

    def problems(self, where: str) -> Iterator[Problem]:
        """Find the problems of the path."""
        return iter(())


# A law may run beyond the ends of a path by rounding: this part of its length.
SLACK = 1e-9


@dataclass(frozen=True, eq=False, repr=False)
class TimedPlaces(ShortRepr, Path):
    """A spline through places at times: quintic, or cubic (`degree` 3). With `repeat` it goes round again.

    >>> TimedPlaces([0.0, 1.0], (0j, 2 + 4j)).place(0.5, order=1).c
    ((1+2j), (2+4j))
    """

    times: Number
    places: tuple[complex, ...]
    degree: int = 5
    repeat: bool = False

    kind: ClassVar[str] = "time-table"
    keys: ClassVar[tuple[Key, ...]] = (
        Key("times", "times", "Times in seconds, increasing.", required=True),
        Key("places", "route", "Where the point is at each time.", required=True),
        Key("degree", "whole", "Of the spline: 3 or 5.", default=5),
        Key("repeat", "flag", "Whether the path is run again and again.", default=False),
    )

    def __post_init__(self) -> None:
        object.__setattr__(self, "places", tuple(complex(place) for place in self.places))
        object.__setattr__(self, "times", self.laws[0].times)

    @cached_property
    def laws(self) -> tuple[TimeTable, TimeTable]:
        """The tables of both coordinates."""
        try:
            places = np.array(self.places, dtype=complex)
            first = TimeTable(self.times, places.real, self.degree, self.repeat)
            return first, TimeTable(self.times, places.imag, self.degree, self.repeat)
        except InvalidMechanism as error:
            raise InvalidMechanism([_path_problem(problem) for problem in error.problems]) from None

    @property
    def span(self) -> tuple[float, float]:
        """The first and the last time."""
        return self.laws[0].span

    def place(self, t: Number, order: int) -> Series:
        """Return place and derivatives at times t (seconds)."""
        x, y = (table.coordinate(t, order) for table in self.laws)
        return planar_series(x, y)


def _path_problem(problem: Problem) -> Problem:
    """Return a problem of one coordinate as a problem of the places."""
    where = problem.where.replace("law.values", "along.places").replace("law", "along")
    return replace(problem, where=where, what=problem.what.replace("values", "places"))


class TraversedCurve(Path):
    """A curve and a law of the length of arc from its beginning."""

    law: Law

    @property
    def span(self) -> tuple[float, float] | None:
        """The first and the last time of the law."""
        return self.law.span

    @property
    def laws(self) -> tuple[Law]:
        """The law of the length of arc."""
        return (self.law,)

    @property
    def curve(self) -> Curve:
        """The curve that is traversed."""
        raise NotImplementedError

    @cached_property
    def _arc(self) -> ArcLength:
        return ArcLength(self.curve)

    @property
    def length(self) -> float:
        """The length of the whole curve."""
        return self._arc.whole

    def place(self, t: Number, order: int) -> Series:
        """Return place and derivatives at times t (seconds). Raises InvalidInput beyond the ends of an open curve."""
        arc = self.law.coordinate(t, order)
        length, whole = np.asarray(arc.c[0]), self._arc.whole
        slack = SLACK * whole
        if not self.curve.closed and np.any(beyond := (length < -slack) | (length > whole + slack)):
            k = np.flatnonzero(np.ravel(beyond))[0]
            when, where = np.broadcast_to(t, length.shape).flat[k], length.flat[k]
            what = f"at {when:g} s the law is at the length {where:.6g} of a path that is {whole:.6g} long"
            raise InvalidInput(Problem("along.law", what, "let it go from 0 to that length, or give fewer times"))
        shape = np.shape(t)
        return self._arc.place(Series(tuple(np.broadcast_to(c, shape) for c in arc.c)))


@dataclass(frozen=True, eq=False, repr=False)
class LinePath(ShortRepr, TraversedCurve):
    """The straight line from one place to another, traversed by a law of the distance from the first.

    >>> from compoundkin.model.laws import constant_speed
    >>> LinePath((0j, 3 + 4j), constant_speed(5.0)).place(np.array([0.5]), order=1).c[1].tolist()
    [(3+4j)]
    """

    places: tuple[complex, ...]
    law: Law

    kind: ClassVar[str] = "line"
    keys: ClassVar[tuple[Key, ...]] = (
        Key("places", "route", "Where the line begins and where it ends.", required=True),
        Key("law", "law", "The distance from its beginning in time.", required=True),
    )

    def __post_init__(self) -> None:
        object.__setattr__(self, "places", tuple(complex(place) for place in self.places))
        if len(self.places) != 2 or not np.isfinite(self.places).all() or self.places[0] == self.places[1]:
            how = "give two places, or four and more for a curve"
            raise InvalidMechanism(Problem("along.places", "a line goes from one place to another", how))

    @cached_property
    def curve(self) -> Curve:
        """The line, by the distance from its beginning."""
        start, end = self.places
        along = (end - start) / abs(end - start)
        return Analytic(lambda s: s * along + start, 0.0, abs(end - start), closed=False)


@dataclass(frozen=True, eq=False, repr=False)
class CurvePath(ShortRepr, TraversedCurve):
    """A curve run along by a law of the length of arc.

    It is given as a profile; a closed one is run round and round."""

    profile: Profile
    law: Law

    kind: ClassVar[str] = "curve"
    keys: ClassVar[tuple[Key, ...]] = (
        Key("profile", "profile", "The curve, as the profile of a cam is written.", required=True),
        Key("law", "law", "The length of arc from its beginning in time.", required=True),
    )

    @property
    def curve(self) -> Curve:
        """The curve."""
        return self.profile.curve

    def problems(self, where: str) -> Iterator[Problem]:
        """Find the problems of the curve; it may cross itself."""
        try:
            self.profile.curve  # noqa: B018 - an invalid curve raises when it is built
        except InvalidMechanism as error:
            yield from (replace(problem, where=f"{where}.profile.{problem.where}") for problem in error.problems)


@dataclass(frozen=True)
class FunctionComponent:
    """One coordinate of a function of time that returns complex places."""

    function: Callable[[Any], Any]
    part: str

    def __call__(self, t: Any) -> Any:
        """Return the coordinate at times."""
        places = self.function(t)
        if isinstance(places, tuple | list):
            raise TypeError("it returns several arrays, not complex places; return x + 1j * y")
        return getattr(places, self.part, places)


@dataclass(frozen=True, eq=False)
class FunctionPath(CopiesFunction, Path):
    """A Python function of an array of times that returns complex places."""

    function: Callable[[Any], Any]

    function_field: ClassVar[str] = "function"
    kind: ClassVar[str] = "function"
    keys: ClassVar[tuple[Key, ...]] = ()
    span: ClassVar[None] = None

    def __eq__(self, other: object) -> bool:
        return isinstance(other, FunctionPath) and self.function is other.function

    def __hash__(self) -> int:
        return hash(self.function)

    def place(self, t: Number, order: int) -> Series:
        """Return place and derivatives at times t (seconds). Raises InvalidInput where the function fails."""
        x, y = (FunctionLaw(FunctionComponent(self.function, part)).coordinate(t, order) for part in ("real", "imag"))
        return planar_series(x, y)


KINDS: tuple[type[Path], ...] = (TimedPlaces, LinePath, CurvePath, FunctionPath)
# Those that a mechanism file can hold, by their name there.
WRITTEN: dict[str, type[Path]] = {kind.kind: kind for kind in KINDS if kind.keys}
TIME_NEEDED = "give its times with time=, or the length of arc in time with law="


@checked
def place_table(times: Any, places: Any, *, degree: int = 5, repeat: bool = False) -> TimedPlaces:
    """Return the path through places at times (seconds). A spline through them, complex or (n, 2).

    >>> place_table([0, 1, 2], [(0, 0), (1, 0), (2, 2)]).span
    (0.0, 2.0)
    """
    return TimedPlaces(times, _places("along.places", places), degree, repeat)


def as_path(where: str, along: Any, time: Any, law: Law | None) -> Path:
    """Return the path of a point. Raises InvalidMechanism naming `where` for anything that is not one.

    >>> as_path("drives.G.along", lambda t: 1j * t, None, None).kind
    'function'
    """
    try:
        return _path_from(where, along, time, law)
    except InvalidMechanism as error:
        placed = (replace(p, where=where + p.where.removeprefix("along")) if p.where.startswith("along") else p
                  for p in error.problems)  # fmt: skip
        raise InvalidMechanism(placed) from None


def _path_from(where: str, along: Any, time: Any, law: Law | None) -> Path:
    if isinstance(along, Path) or callable(along):
        if time is not None or law is not None:
            raise InvalidMechanism(Problem(where, "it is a function of time already", "leave time and law out"))
        return along if isinstance(along, Path) else FunctionPath(along)
    if time is not None and law is not None:
        raise InvalidMechanism(
            Problem(where, "times and a law both prescribe the motion along it", "leave one of them out")
        )
    if isinstance(along, Profile) and law is None:
        raise InvalidMechanism(Problem(where, "a curve is not a motion", "give law=, the length of arc in time"))
    if isinstance(along, Profile) and law is not None:
        return CurvePath(along, law)
    places = _places(where, along)
    if time is not None:
        return TimedPlaces(real_numbers(f"{where}.time", time, InvalidMechanism), places)
    if law is None:
        raise InvalidMechanism(Problem(where, "places are not a motion", TIME_NEEDED))
    if len(places) < 4:
        return LinePath(places, law)
    return CurvePath(PointsProfile(places, closed=places[0] == places[-1]), law)


def as_prescribed(where: str, law: Any) -> Law | None:
    """Return the law of a prescribed coordinate: a law, a Python function of time, or a constant number."""
    if law is None or callable(law) or isinstance(law, Law):
        return as_law(where, law)
    number = real_numbers(where, law, InvalidMechanism)
    if number.ndim:
        how = "write laws.time_table(times, values)"
        raise InvalidMechanism(Problem(where, "several values are not a motion without times", how))
    if not np.isfinite(number):
        raise InvalidMechanism(Problem(where, f"{number} is not a finite number", "write a finite number"))
    return constant_speed(0.0, float(number))


def _places(where: str, places: Any) -> tuple[complex, ...]:
    """Return places given as complex numbers, as (x, y), or as an array (n, 2)."""
    found = planar_numbers(where, places, InvalidMechanism)
    if found.ndim == 2 and found.shape[1] == 2 and not np.any(found.imag):
        found = found[:, 0].real + 1j * found[:, 1].real
    if found.ndim != 1 or len(found) < 2 or not np.isfinite(found).all():
        what = f"{short_repr(places)} are not two places or more"
        raise InvalidMechanism(Problem(where, what, "write [(x, y), (x, y), ...], complex numbers, or an array (n, 2)"))
    return tuple(complex(place) for place in found)
