"""Words for the paths along which points are led."""

from __future__ import annotations

from dataclasses import dataclass
from functools import singledispatchmethod

from compoundkin.model.leads import CurvePath, FunctionPath, LinePath, Path, TimedPlaces
from compoundkin.view.report.law_words import Wording
from compoundkin.view.report.wording import number


@dataclass(frozen=True)
class PathWording:
    """The words for a path, lengths in a unit.

    >>> PathWording("mm").path(TimedPlaces([0.0, 2.0], (0j, 1j)))
    'through 2 places from 0 to 2 s, by a spline of degree 5'
    """

    unit: str

    @singledispatchmethod
    def path(self, path: Path) -> str:
        """Tell where a path goes, after "it is led"."""
        raise NotImplementedError

    @path.register
    def _(self, path: TimedPlaces) -> str:
        first, last = path.span
        again = ", again and again" if path.repeat else ""
        places = f"through {len(path.places)} places from {number(first)} to {number(last)} s"
        return f"{places}, by a spline of degree {path.degree}{again}"

    @path.register
    def _(self, path: LinePath) -> str:
        start, end = (f"({number(p.real)}, {number(p.imag)})" for p in path.places)
        return f"along the line from {start} to {end}; its way goes {self._law(path)}"

    @path.register
    def _(self, path: CurvePath) -> str:
        round_ = "closed " if path.curve.closed else ""
        return f"along a {round_}curve of {number(path.length)} {self.unit}; its way goes {self._law(path)}"

    @path.register
    def _(self, path: FunctionPath) -> str:
        return "by a Python function of time"

    def _law(self, path: LinePath | CurvePath) -> str:
        return Wording(False, self.unit).law(path.law)
