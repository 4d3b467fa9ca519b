"""Dampers between points of two links, and along the coordinate of a pair."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import Problem
from compoundkin.model.fields import NameWording, value_key
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads.amounts import Amount, as_amount, plain_amount, value_of
from compoundkin.model.loads.attachments import (
    EndSeparation,
    PairLoad,
    PlainEffort,
    PointToPointLoad,
    attachment_point,
    check_ends,
)
from compoundkin.model.loads.contract import COORDINATE, Load, LoadedPoses, NamedParts
from compoundkin.model.loads.spring import is_force_law

_RATE = "Force or torque for a unit of speed, or the force itself as a table over that."


class Damping(Load):
    """What both kinds of damper share: a rate, and a force or torque that depends on velocities."""

    rate: Amount

    title: ClassVar[str] = "damper"
    table: ClassVar[str] = "dampers"
    amounts: ClassVar[tuple[str, ...]] = ("rate",)
    own_variable: ClassVar[str] = "rate"

    @property
    def needs_rates(self) -> bool:
        """Whether it depends on velocities."""
        return True

    def problems(self, written: NamedParts, where: str) -> Iterator[Problem]:
        """Find unknown ends or an unknown pair, and a negative rate, with which a damper would drive."""
        yield from super().problems(written, where)
        if not is_force_law(self.rate) and np.any(np.asarray(self.rate) < 0.0):
            yield Problem(f"{where}.{self.amounts[0]}", "a damper of negative rate drives", "give a rate above zero")


@dataclass(frozen=True, eq=False, repr=False)
class Damper(Damping, PointToPointLoad):
    """A damper between points of two links, which pulls with its rate times its speed of extension.

    >>> damper("arm", "A", at="S", rate=40).name
    'damper on arm'
    """

    rate: Amount = field(kw_only=True, metadata=value_key("amount", _RATE))

    wording: ClassVar[NameWording] = NameWording(verb="pull", two_links="a damper has its ends on two links")

    def variables(self, at: LoadedPoses) -> Mapping[str, Callable[[], Number]]:
        """Return the speed of extension and the length."""
        gap = self.gap(at)
        return {"rate": lambda: gap.rate, "length": lambda: gap.length}

    def pull(self, gap: EndSeparation, at: LoadedPoses) -> Number:
        """Return its force; where its ends coincide, along their relative velocity."""
        amount = value_of(self.where, self.rate, at, self.variables(at))
        # ends that coincide move along the line on which they are before and after
        line = np.where(np.equal(gap.length, 0.0), gap.velocity, gap.vector)
        pull = amount if is_force_law(self.rate) else amount * gap.rate
        return EndSeparation(line, np.abs(line), gap.velocity).along(pull, self.where)


@dataclass(frozen=True, eq=False, repr=False)
class PairDamper(Damping, PairLoad):
    """A damper along the free coordinate of a pair, against its rate."""

    rate: Amount = field(kw_only=True, metadata=value_key("amount", _RATE))

    def variables(self, at: LoadedPoses) -> Mapping[str, Callable[[], Number]]:
        """Return the rate of the coordinate, and the coordinate."""
        own = super().variables(at)
        return {"rate": own["rate"], COORDINATE: own[COORDINATE]}

    def effort(self, at: LoadedPoses) -> Number:
        """Return its effort, against the rate of the coordinate."""
        own = self.variables(at)
        amount = value_of(self.where, self.rate, at, own)
        return 0.0 - (amount if is_force_law(self.rate) else amount * own["rate"]())

    def plain_effort(self) -> PlainEffort | None:
        """Return the effort as a function of plain numbers."""
        amount = plain_amount(self.where, self.rate, ("rate", "coordinate", "time"))
        if amount is None:
            return None
        if is_force_law(self.rate):
            return lambda q, w, t: -amount(w, q, t)
        rate = amount(0.0, 0.0, 0.0)
        return lambda q, w, t: -rate * w


@checked
def damper(
    link: str = "", point: Any = "", *, to: str = FRAME, at: Any = "", pair: str = "", rate: Any, name: str = ""
) -> Damper | PairDamper:
    """Return a damper between points of two links, or along a pair.

    It is written as a `spring`, and pulls with `rate` times its speed of extension. A `rate` that is a function of
    speed ``w``, length or coordinate ``q``, time ``t``, as its arguments name them, or a table over the speed, is the
    force itself. Raises InvalidMechanism for ends of both sorts.

    >>> damper("arm", "A", to="frame", at="S", rate=40).rate
    40.0
    >>> damper(pair="C", rate=lambda w: 2 * w * abs(w)).name
    'damper along C'
    """
    where = f"dampers.{name or pair or link}"
    amount = as_amount(f"{where}.{Damper.amounts[0]}", rate, "rate", "length" if link else "coordinate", "time")
    check_ends(where, pair, link, {"link": link, "point": point, "at": at} if pair else {})
    if pair:
        return PairDamper(pair, rate=amount, name=name)
    one, other = (attachment_point(f"{where}.{key}", spot) for key, spot in (("point", point), ("at", at)))
    return Damper(link, one, to=to, at=other, rate=amount, name=name)
