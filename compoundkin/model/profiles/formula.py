"""The profile by a Python function."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

from compoundkin.base.curves import Curve, Function
from compoundkin.model.fields import Key
from compoundkin.model.profiles.contract import Profile, number_of


@dataclass(frozen=True)
class Formula(Profile):
    """A curve by a Python function of a parameter from `low` to `high`: complex points for an array of parameters."""

    function: Callable[[Any], Any]
    low: float
    high: float
    closed: bool = True

    kind: ClassVar[str] = "formula"
    keys: ClassVar[tuple[Key, ...]] = ()

    def _made(self) -> Curve:
        return Function(self.function, self.low, self.high, self.closed)


def formula(function: Callable[[Any], Any], low: float, high: float, *, closed: bool = True) -> Formula:
    """The profile that a Python function traces: complex points for an array of parameters.

    >>> import numpy as np
    >>> formula(lambda s: 2 * np.cos(s) + 1j * np.sin(s), 0, 2 * np.pi).curve.closed
    True
    """
    return Formula(function, number_of(low, "profile.low"), number_of(high, "profile.high"), closed)
