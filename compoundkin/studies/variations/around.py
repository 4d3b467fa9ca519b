"""A value and what it may be off by: evenly within it, or normally distributed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from compoundkin.base.arguments import checked, is_finite_real
from compoundkin.base.arrays import Number
from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.studies.variations.contract import Variation
from compoundkin.studies.variations.given_values import number_or_point, planar, written
from compoundkin.studies.variations.normal_quantiles import normal_quantiles


@dataclass(frozen=True)
class AroundCentre(Variation):
    """Values around a centre, of points in each coordinate: see `around`."""

    keys: ClassVar[tuple[str, ...]] = ("centre", "within")
    optional: ClassVar[tuple[str, ...]] = ("sigmas",)
    centre: float | complex
    within: float
    sigmas: float | None = None

    @property
    def is_point(self) -> bool:
        """Whether its centre is a point."""
        return isinstance(self.centre, complex)

    @property
    def deviation(self) -> float:
        """The standard deviation of each coordinate."""
        return self.within / (self.sigmas or np.sqrt(3.0))

    @property
    def ends(self) -> tuple[float | complex, float | complex]:
        """The least and the greatest value, infinite where it is normally distributed."""
        one = complex(1.0, 1.0) if self.is_point else 1.0
        if self.sigmas is not None:
            return (complex(-np.inf, -np.inf), complex(np.inf, np.inf)) if self.is_point else (-np.inf, np.inf)
        return self.centre - self.within * one, self.centre + self.within * one

    def values(self, units: Number) -> Number:
        """Return the values at numbers between 0 and 1."""
        if self.sigmas is None:
            return self.centre + self.within * planar(2.0 * units - 1.0)
        return self.centre + self.deviation * planar(normal_quantiles(units))

    def grid_steps(self, count: int) -> Number:
        """Return equal steps with both ends, or parts that are as likely."""
        if self.sigmas is not None or count == 1:
            return super().grid_steps(count)
        return np.linspace(0.0, 1.0, count)

    @property
    def data(self) -> Mapping[str, Any]:
        """Its centre and bound, and the number of standard deviations where there is one."""
        found: dict[str, Any] = {"centre": written(self.centre), "within": self.within}
        return found if self.sigmas is None else {**found, "sigmas": self.sigmas}

    @classmethod
    def read(cls, where: str, data: Mapping[str, Any]) -> Self:
        """Return what is `within` of a `centre`."""
        return cls.of(where, data["centre"], data["within"], data.get("sigmas"))

    @classmethod
    def of(cls, where: str, centre: Any, within: Any, sigmas: Any = None) -> Self:
        """Return it of what is given; raises InvalidInput."""
        middle = number_or_point(_place(where, "centre"), centre)
        if not is_finite_real(within) or within <= 0:
            what = f"{short_repr(within)} is no distance above 0"
            raise InvalidInput(Problem(_place(where, "within"), what, "say how far from the centre values may be"))
        if sigmas is not None and (not is_finite_real(sigmas) or sigmas <= 0):
            what = f"{short_repr(sigmas)} is no number above 0"
            remedy = "sigmas=3: `within` is three standard deviations"
            raise InvalidInput(Problem(_place(where, "sigmas"), what, remedy))
        return cls(middle, float(within), None if sigmas is None else float(sigmas))


def _place(where: str, word: str) -> str:
    return f"{where}.{word}" if where else word


@checked
def around(centre: Number, within: float, *, sigmas: float | None = None) -> AroundCentre:
    """Return what a dimension may be around a value, for studies and tolerances.

    `centre` is a number, or a point, complex or (x, y), of which each coordinate is around its own. All values within
    `within` of it are as likely; with `sigmas` they are normally distributed, and `within` is so many standard
    deviations. Both are in the mechanism's unit, or in radians. Raises InvalidInput.

    >>> around((12.3, 8.6), 0.05, sigmas=3)
    AroundCentre(centre=(12.3+8.6j), within=0.05, sigmas=3.0)
    """
    return AroundCentre.of("", centre, within, sigmas)
