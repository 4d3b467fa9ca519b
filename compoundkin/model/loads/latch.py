"""What opens in a simulation: latches, which hold the coordinate of a pair, and pairs that come apart."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Self

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import Problem, suggestion
from compoundkin.base.wrenches import Wrench
from compoundkin.model.fields import value_key
from compoundkin.model.geometry import real
from compoundkin.model.loads.attachments import PairLoad
from compoundkin.model.loads.contract import COORDINATE, NO_RENAMING, Load, LoadedPoses, NamedParts
from compoundkin.model.pairs.profile_contact import as_profile_contact


@dataclass(frozen=True, eq=False, repr=False)
class OpeningLoad(PairLoad):
    """What holds two links together until it opens: at a time, at a coordinate of a pair, or by too great a force.

    It has no force of its own here: simulations know what it holds with.
    """

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

    own_variable: ClassVar[str] = COORDINATE
    coordinates_over: ClassVar[Mapping[str, str]] = {"value": "over"}
    is_elastic: ClassVar[bool] = False

    @property
    def opens(self) -> bool:
        """Whether something opens it."""
        return self.strength is not None or self.until is not None or bool(self.over)

    def renamed(self, links: Mapping[str, str], coordinates: Mapping[str, str] = NO_RENAMING) -> Self:
        """Return it with other names of links and coordinates."""
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

    def effort(self, at: LoadedPoses) -> Number:
        """Return its effort, none: what it holds is known to simulations only."""
        return 0.0 * at.coordinate(self.pair).c[0]

    def wrenches(self, at: LoadedPoses) -> Iterator[tuple[str, Wrench]]:
        """Yield nothing."""
        yield from ()

    def energy(self, at: LoadedPoses) -> Number | None:
        """Return its energy, none."""
        return 0.0 * at.pose(self.members[0]).u.c[0].real


@dataclass(frozen=True, eq=False, repr=False)
class Latch(OpeningLoad):
    """A latch that holds the free coordinate of a pair, from the start or from where it catches."""

    at: Number | None = field(
        default=None,
        kw_only=True,
        metadata=value_key("coordinate", "Where it catches; it holds from the start if left out. Degrees of an angle."),
    )
    since: Number | None = field(
        default=None,
        kw_only=True,
        metadata=value_key("length", "The time at which it catches wherever it is, seconds."),
    )
    teeth: Number | None = field(
        default=None,
        kw_only=True,
        metadata=value_key("coordinate", "The pitch of a ratchet, negative if it goes backward; degrees of an angle."),
    )

    title: ClassVar[str] = "latch"
    table: ClassVar[str] = "latches"

    def problems(self, written: NamedParts, where: str) -> Iterator[Problem]:
        """Find unknown pairs, numbers out of range, and a ratchet with what only other latches have."""
        yield from super().problems(written, where)
        if self.teeth is not None and np.any(np.asarray(self.teeth) == 0.0):
            yield Problem(f"{where}.teeth", "a ratchet has a pitch", "give the coordinate from tooth to tooth")
        if self.since is not None and not np.all(np.asarray(self.since) >= 0.0):
            yield Problem(f"{where}.since", "a time is not negative", "give seconds after the start")
        if self.since is not None and self.at is not None:
            yield Problem(f"{where}.since", "it catches at a time or at a coordinate", "leave one of both out")
        if self.since is not None and self.until is not None and not np.all(np.asarray(self.since) < self.until):
            yield Problem(f"{where}.until", "it opens before it catches", "give a later time")
        if self.teeth is not None and (self.at is not None or self.since is not None or self.opens):
            yield Problem(f"{where}.teeth", "a ratchet neither catches nor opens", "leave the other conditions out")


@dataclass(frozen=True, eq=False, repr=False)
class Release(OpeningLoad):
    """A pair that comes apart: from there on its two links are joined by it no more.

    A contact lands again, with the part `restitution` of the speed.
    """

    restitution: Number | None = field(
        default=None,
        kw_only=True,
        metadata=value_key("length", "The part of the speed with which a contact rebounds where it lands, 0 to 1."),
    )

    title: ClassVar[str] = "release"
    table: ClassVar[str] = "releases"

    def problems(self, written: NamedParts, where: str) -> Iterator[Problem]:
        """Find unknown pairs, numbers out of range, and a pair that nothing opens; a contact needs nothing to open."""
        pair, e = written.pair(self.pair), self.restitution
        if e is not None and not np.all((np.asarray(e) >= 0.0) & (np.asarray(e) <= 1.0)):
            yield Problem(f"{where}.restitution", f"{e:.6g} is no coefficient of restitution", "0 to 1")
        if pair is not None and as_profile_contact(pair) is not None:
            if self.opens:
                what = f"{self.pair!r} is a {pair.title}, which lets go where its force falls to zero"
                yield Problem(where, what, "leave the conditions out")
            return
        yield from super().problems(written, where)
        if e is not None:
            yield Problem(f"{where}.restitution", f"{self.pair!r} is no contact that lands again", "leave it out")
        if not self.opens:
            yield Problem(where, "nothing opens it", "give until, over and value, or strength")

    @property
    def restitution_of_landing(self) -> float:
        """The part of the speed with which its contact rebounds."""
        return 0.0 if self.restitution is None else float(np.ravel(self.restitution)[0])


def as_release(load: Load) -> Release | None:
    """Return a load as a release, or None."""
    return load if isinstance(load, Release) else None


def as_latch(load: Load) -> Latch | None:
    """Return a load as a latch, or None."""
    return load if isinstance(load, Latch) else None


@checked
def latch(
    pair: str,
    at: Any = None,
    *,
    since: Any = None,
    teeth: Any = None,
    strength: Any = None,
    until: Any = None,
    over: str = "",
    value: Any = None,
    name: str = "",
) -> Latch:
    """Return a latch that holds the free coordinate of a pair.

    It holds from the start, or catches where the coordinate comes to `at` (radians, with full turns counted, or a
    length), or at the time `since` (seconds) wherever it is, as a clutch. It opens at the time `until`, where the
    coordinate of the pair `over` comes to `value`, or where its force exceeds `strength`; it holds for ever where none
    of these is given, and opens once. With `teeth` it is a ratchet: the coordinate goes in the sense of that pitch
    only, and falls back to the last tooth at the most.

    >>> latch("guide", until=0.5).opens, latch("A", 1.2, strength=300).at
    (True, 1.2)
    """
    where = f"latches.{name or pair}"
    given = {"at": at, "since": since, "teeth": teeth, "strength": strength, "until": until, "value": value}
    numbers: dict[str, Any] = {
        key: None if number is None else real(f"{where}.{key}", number) for key, number in given.items()
    }
    return Latch(pair, **numbers, over=over, name=name)


@checked
def release(
    pair: str,
    *,
    strength: Any = None,
    until: Any = None,
    over: str = "",
    value: Any = None,
    restitution: Any = None,
    name: str = "",
) -> Release:
    """Return a pair that comes apart in a simulation, which goes on without it.

    It opens as a `latch` does: at the time `until` (seconds), where the coordinate of the pair `over` comes to `value`
    (radians, with full turns counted, or a length), or where the force in it exceeds `strength`. At a pin it is the
    second of its links that leaves it. The contact of a cam or a flat face is released where its force falls to zero,
    without any condition, and closes again where both meet, after rebounds with the part `restitution` of the speed at
    which they do, none if it is left out. Loads along a pair that opens end there.

    >>> release("S", over="sling", value=2.4).name
    'release along S'
    """
    where = f"releases.{name or pair}"
    given = {"strength": strength, "until": until, "value": value, "restitution": restitution}
    numbers: dict[str, Any] = {
        key: None if number is None else real(f"{where}.{key}", number) for key, number in given.items()
    }
    return Release(pair, **numbers, over=over, name=name)
