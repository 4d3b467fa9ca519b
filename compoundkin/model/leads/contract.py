"""What every path of a led point answers."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Any, ClassVar

from compoundkin.base.copies import CopiesFields
from compoundkin.base.errors import Problem
from compoundkin.base.series import Number, Series
from compoundkin.model.fields import Key
from compoundkin.model.laws.constant_laws import Compared


class Path(CopiesFields, Compared, ABC):
    """Places in time. Kinds are frozen dataclasses with the keys that a file holds for them."""

    kind: ClassVar[str]  # what it is called in a file
    keys: ClassVar[tuple[Key, ...]]  # none: it cannot be written to a file

    @property
    @abstractmethod
    def span(self) -> tuple[float, float] | None:
        """The first and the last time of it; None where it has none."""

    @abstractmethod
    def place(self, t: Number, order: int) -> Series:
        """Return place and derivatives at times t (seconds), complex. Raises InvalidInput where there is none."""

    @property
    def laws(self) -> tuple[Any, ...]:
        """The laws in time that it is made of."""
        return ()

    def problems(self, where: str) -> Iterator[Problem]:
        """Find what makes it no path."""
        return iter(())
