"""A variation by a distribution of scipy.stats, given by its name and numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any, ClassVar, Self

import numpy as np

from compoundkin.base.arguments import real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.copies import CopiesFields
from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem, suggestion
from compoundkin.studies.samples.variation import Variation

_REMEDY = "write scipy.stats.norm(40, 0.1) or another distribution of scipy.stats with its numbers"


@dataclass(frozen=True)
class Distribution(CopiesFields, Variation):
    """A distribution of scipy.stats by its name.

    Values are `loc` and `scale` times those of its standard form.

    Discrete ones, which scipy knows without a scale, have one too: that is how they are told in other units.
    """

    keys: ClassVar[tuple[str, ...]] = ("distribution",)
    optional: ClassVar[tuple[str, ...]] = ("shape", "loc", "scale")
    name: str
    shape: tuple[float, ...] = ()
    loc: float = 0.0
    scale: float = 1.0

    @cached_property
    def standard(self) -> Any:
        """The distribution in scipy.stats, with `loc` 0 and `scale` 1."""
        from scipy import stats

        return getattr(stats, self.name)(*self.shape)

    @property
    def ends(self) -> tuple[float | complex, float | complex]:
        """The ends of its support, perhaps infinite."""
        low, high = self.standard.support()
        return float(self.loc + self.scale * low), float(self.loc + self.scale * high)

    def values(self, units: Number) -> Number:
        """Return its quantiles at numbers between 0 and 1."""
        return self.loc + self.scale * np.asarray(self.standard.ppf(inner_units(units[:, 0])))

    @property
    def data(self) -> Mapping[str, Any]:
        """Its name, shape, place and scale."""
        shape = {"shape": list(self.shape)} if self.shape else {}
        return {"distribution": self.name, **shape, "loc": self.loc, "scale": self.scale}

    @classmethod
    def read(cls, where: str, data: Mapping[str, Any]) -> Self:
        """Return the `distribution` of a name with its `shape`, `loc` and `scale`."""
        family = _family(where, data["distribution"])
        shape = real_numbers(f"{where}.shape", data.get("shape", ()))
        if shape.shape != (family.numargs,):
            names = family.shapes or "none"
            what = f"the distribution {family.name} has {family.numargs} numbers of its shape, not {shape.size}"
            raise InvalidInput(Problem(f"{where}.shape", what, f"they are: {names}"))
        return cls._held(where, family.name, tuple(shape.tolist()), data.get("loc", 0.0), data.get("scale", 1.0))

    @classmethod
    def from_argument(cls, where: str, given: Any) -> Self | None:
        """Return a frozen distribution of scipy.stats; families without numbers are refused."""
        if type(given).__module__.partition(".")[0] != "scipy":
            return None
        family = getattr(given, "dist", None)
        if family is None or not hasattr(given, "kwds"):
            raise InvalidInput(Problem(where, f"{short_repr(given)} is no distribution with its numbers", _REMEDY))
        if family.name not in _families() or type(_families()[family.name]) is not type(family):
            raise InvalidInput(Problem(where, "it is no distribution that scipy.stats has by a name", _REMEDY))
        shapes = family.shapes.split(", ") if family.shapes else []
        numbers = {**dict(zip([*shapes, "loc", "scale"], given.args, strict=False)), **given.kwds}
        shape = tuple(float(cls._one(where, numbers[word])) for word in shapes)
        return cls._held(where, family.name, shape, numbers.get("loc", 0.0), numbers.get("scale", 1.0))

    @classmethod
    def _held(cls, where: str, name: str, shape: tuple[float, ...], loc: Any, scale: Any) -> Self:
        """Return it; raises InvalidInput where its numbers make no distribution."""
        found = cls(name, shape, cls._one(where, loc), cls._one(where, scale))
        with np.errstate(all="ignore"):
            middle = found.values(np.array([[0.5]]))
        if not np.isfinite(middle).all() or found.scale <= 0:
            what = f"these numbers do not make a distribution {name}"
            raise InvalidInput(Problem(where, what, f"the scale is above 0; see the conditions of scipy.stats.{name}"))
        return found

    @staticmethod
    def _one(where: str, given: Any) -> float:
        found = real_numbers(where, given)
        if found.ndim:
            raise InvalidInput(
                Problem(where, f"{short_repr(given)} is not one number", "a dimension has one distribution")
            )
        return float(found)


def _family(where: str, name: object) -> Any:
    """Return the distributions of a name in scipy.stats; raises InvalidInput."""
    known = _families()
    if not isinstance(name, str) or name not in known:
        what = f"scipy.stats has no distribution {short_repr(name)}"
        raise InvalidInput(Problem(where, what, suggestion(name, ["norm", "uniform", "triang", *known])))
    return known[name]


@cache
def _families() -> Mapping[str, Any]:
    """All distributions of scipy.stats by their names."""
    from scipy import stats

    kinds = stats.rv_continuous | stats.rv_discrete
    return {name: one for name, one in sorted(vars(stats).items()) if isinstance(one, kinds)}


# Sobol's numbers are multiples of 2^-30; 0 stands for all below the first of them, the half of which is taken.
LEAST_UNIT = 2.0**-31


def inner_units(units: Number) -> Number:
    """Return the numbers, which are moved off 0 and 1."""
    return np.clip(units, LEAST_UNIT, 1.0 - LEAST_UNIT)


def normal_quantiles(units: Number) -> Number:
    """Return the quantiles of the standard normal distribution."""
    from scipy.special import ndtri

    return np.asarray(ndtri(inner_units(units)))
