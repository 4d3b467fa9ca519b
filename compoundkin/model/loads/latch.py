"""Latches: they hold the coordinate of a pair until something opens them, from the start or from where they catch."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Self

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import Problem, suggestion
from compoundkin.model.fields import value_key
from compoundkin.model.geometry import real
from compoundkin.model.loads.attachments import COORDINATE, PairLoad
from compoundkin.model.loads.contract import NO_RENAMING, Load, LoadedPoses, NamedParts


@dataclass(frozen=True, eq=False, repr=False)
class Latch(PairLoad):
    """A latch that holds the free coordinate of a pair, and the conditions under which it catches and opens.

    It has no force of its own here: simulations hold the coordinate.
    """

    at: Number | None = field(
        default=None,
        kw_only=True,
        metadata=value_key("coordinate", "Where it catches; it holds from the start if left out. Degrees of an angle."),
    )
    teeth: Number | None = field(
        default=None,
        kw_only=True,
        metadata=value_key("coordinate", "The pitch of a ratchet, negative if it goes backward; degrees of an angle."),
    )
    strength: Number | None = field(
        default=None, kw_only=True, metadata=value_key("length", "The force or torque above which it opens.")
    )
    until: Number | None = field(
        default=None, kw_only=True, metadata=value_key("length", "The time at which it opens, seconds.")
    )
    over: str = field(default="", kw_only=True, metadata=value_key("name", "The pair or driver that opens it."))
    value: Number | None = field(
        default=None,
        kw_only=True,
        metadata=value_key("coordinate", "The coordinate of that pair at which it opens; degrees of an angle."),
    )

    title: ClassVar[str] = "latch"
    table: ClassVar[str] = "latches"
    own_variable: ClassVar[str] = COORDINATE
    coordinates_over: ClassVar[Mapping[str, str]] = {"value": "over"}

    is_elastic: ClassVar[bool] = False

    @property
    def opens(self) -> bool:
        """Whether something opens it."""
        return self.strength is not None or self.until is not None or bool(self.over)

    def renamed(self, links: Mapping[str, str], coordinates: Mapping[str, str] = NO_RENAMING) -> Self:
        """Return the latch with other names of links and coordinates."""
        return replace(super().renamed(links, coordinates), over=coordinates.get(self.over, self.over))

    def problems(self, written: NamedParts, where: str) -> Iterator[Problem]:
        """Find unknown pairs, and numbers out of range."""
        yield from super().problems(written, where)
        if self.over and written.coordinate(self.over) is None:
            what = f"there is no pair, pin or driver {self.over!r}"
            yield Problem(f"{where}.over", what, suggestion(self.over, written.pairs))
        if bool(self.over) != (self.value is not None):
            yield Problem(f"{where}.over", "a pair and its coordinate open it together", "give both over and value")
        if self.strength is not None and not np.all(np.asarray(self.strength) > 0.0):
            yield Problem(f"{where}.strength", "a strength is above zero", "leave it out for one that holds anything")
        if self.until is not None and not np.all(np.asarray(self.until) >= 0.0):
            yield Problem(f"{where}.until", "a time is not negative", "give seconds after the start")
        if self.teeth is not None and np.any(np.asarray(self.teeth) == 0.0):
            yield Problem(f"{where}.teeth", "a ratchet has a pitch", "give the coordinate from tooth to tooth")
        if self.teeth is not None and (self.at is not None or self.opens):
            yield Problem(f"{where}.teeth", "a ratchet neither catches nor opens", "leave the other conditions out")

    def effort(self, at: LoadedPoses) -> Number:
        """Return its effort, none: what it holds is known to simulations only."""
        return 0.0 * at.coordinate(self.pair).c[0]

    def energy(self, at: LoadedPoses) -> Number | None:
        """Return its energy, none."""
        return self.effort(at)


def as_latch(load: Load) -> Latch | None:
    """Return a load as a latch, or None."""
    return load if isinstance(load, Latch) else None


@checked
def latch(
    pair: str,
    at: Any = None,
    *,
    teeth: Any = None,
    strength: Any = None,
    until: Any = None,
    over: str = "",
    value: Any = None,
    name: str = "",
) -> Latch:
    """Return a latch that holds the free coordinate of a pair.

    It holds from the start, or catches where the coordinate comes to `at` (radians, with full turns counted, or a
    length). It opens at the time `until` (seconds), where the coordinate of the pair `over` comes to `value`, or where
    its force exceeds `strength`; it holds for ever where none of these is given, and opens once. With `teeth` it is a
    ratchet: the coordinate goes in the sense of that pitch only, and falls back to the last tooth at the most.

    >>> latch("guide", until=0.5).opens, latch("A", 1.2, strength=300).at
    (True, 1.2)
    """
    where = f"latches.{name or pair}"
    given = {"at": at, "teeth": teeth, "strength": strength, "until": until, "value": value}
    numbers: dict[str, Any] = {
        key: None if number is None else real(f"{where}.{key}", number) for key, number in given.items()
    }
    return Latch(pair, **numbers, over=over, name=name)
