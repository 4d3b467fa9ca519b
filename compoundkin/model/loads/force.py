"""Forces and torques on links."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, dot
from compoundkin.base.errors import Problem, suggestion
from compoundkin.base.wrenches import Wrench
from compoundkin.model.attributes import TIME
from compoundkin.model.fields import link_key, spot_key, value_key
from compoundkin.model.geometry import FRAME, vector
from compoundkin.model.loads.amounts import Amount, as_amount, as_planar_amount, needs_rates, planar_value_of, value_of
from compoundkin.model.loads.contract import Load, LoadedPoses, NamedParts


@dataclass(frozen=True, eq=False, repr=False)
class Force(Load):
    """A force on a link at a point, or on a pin itself.

    Its direction is fixed in the frame or in a link. A load on a pin acts on the first of its links, and `on_pin` is
    its letter. With `while_moving` it acts only while its point moves in that direction, given in the same axes.
    """

    link: str = field(metadata=link_key("The link it acts on, or the letter of a point that carries it."))
    force: Any = field(metadata=value_key("planar", "The force, x and y in the frame of `fixed_in`."))
    at: Any = field(
        default="", metadata=spot_key("link", "The point at which it acts, or a place in the link's frame.")
    )
    fixed_in: str = field(default=FRAME, metadata=value_key("name", "The link with which its direction turns."))
    while_moving: Any = field(
        default=None, metadata=value_key("point", "A direction: it acts only while its point moves that way.")
    )
    on_pin: str = field(default="", kw_only=True)

    title: ClassVar[str] = "force"
    table: ClassVar[str] = "forces"
    amounts: ClassVar[tuple[str, ...]] = ("force",)

    @property
    def called(self) -> str:
        """Its name where none is given."""
        return f"force on {self.link}"

    @property
    def needs_rates(self) -> bool:
        """Whether it depends on the direction of motion."""
        return self.while_moving is not None

    @property
    def link_keys(self) -> tuple[str, ...]:
        """The fields that name links, with the one in whose axes it is given."""
        return ("link", "fixed_in")

    def completed(self, written: NamedParts) -> Load:
        """Return the force on a link of the point, where a point is named."""
        own = written.carriers.get(self.link, ())
        if self.link in written.letters or not own or not isinstance(self.at, str) or self.at:
            return super().completed(written)
        return replace(self, link=own[0], at=self.link, on_pin=self.link if len(own) > 1 else "")

    def problems(self, written: NamedParts, where: str) -> Iterator[Problem]:
        """Find unknown links and points, and a direction of zero length."""
        yield from super().problems(written, where)
        if self.fixed_in not in written.letters:
            what = f"there is no link {self.fixed_in!r}"
            yield Problem(f"{where}.fixed_in", what, suggestion(self.fixed_in, list(written.letters)))
        if self.while_moving is not None and np.any(np.asarray(self.while_moving) == 0):
            yield Problem(f"{where}.while_moving", "it has no direction", "write (dx, dy), or leave it out")

    @property
    def pin(self) -> str:
        """The letter of the pin that it acts on."""
        return self.on_pin

    def attack(self, link: str) -> str | Number:
        """Return its point."""
        return self.at

    def speed_at(self, at: LoadedPoses) -> Number | None:
        """Return the speed of its point in the direction in which it acts."""
        if self.while_moving is None:
            return None
        place = at.place(self.link, self.at)
        velocity = place.c[1] if len(place.c) > 1 else 0j
        return dot(at.pose(self.fixed_in).u.c[0] * at.fitted(self.while_moving, self.where), velocity + 0j)

    def wrenches(self, at: LoadedPoses) -> Iterator[tuple[str, Wrench]]:
        """Yield the force."""
        force = planar_value_of(self.where, self.force, at)
        place = at.place(self.link, self.at)
        turned = at.pose(self.fixed_in).u.c[0]
        along = self.speed_at(at)
        if along is not None:
            force = np.where(along > 0.0, force, np.where(np.isnan(along), np.nan, 0.0))
        yield self.link, Wrench.at(place.c[0], force if self.fixed_in == FRAME else turned * force)


@dataclass(frozen=True, eq=False, repr=False)
class Torque(Load):
    """A torque on the link `link`, counterclockwise positive."""

    link: str = field(metadata=link_key("The link it acts on."))
    torque: Amount = field(metadata=value_key("amount", "The torque, counterclockwise positive."))

    title: ClassVar[str] = "torque"
    table: ClassVar[str] = "torques"
    amounts: ClassVar[tuple[str, ...]] = ("torque",)
    has_rate: ClassVar[bool] = True

    @property
    def called(self) -> str:
        """Its name where none is given."""
        return f"torque on {self.link}"

    @property
    def needs_rates(self) -> bool:
        """Whether it depends on the angular velocity of its link."""
        return needs_rates(self.torque)

    def speed_at(self, at: LoadedPoses) -> Number:
        """Return the angular velocity of its link."""
        return at.pose(self.link).u.turning().c[0]

    def variables(self, at: LoadedPoses) -> Mapping[str, Callable[[], Number]]:
        """Return the angular velocity of its link."""
        return {"rate": lambda: self.speed_at(at)}

    def wrenches(self, at: LoadedPoses) -> Iterator[tuple[str, Wrench]]:
        """Yield the torque."""
        yield self.link, Wrench(0j, value_of(self.where, self.torque, at, self.variables(at)))


@checked
def force(
    link: str, force: Any, *, at: Any = "", fixed_in: str = FRAME, while_moving: Any = None, name: str = ""
) -> Force:
    """Return a force on a link at a point, or on a pin itself.

    A pin is named by its letter, in place of the link.

    `force` is ``(fx, fy)`` or complex: numbers, or arrays whose last axis is the motion; a function of time (an array
    of times) that returns such; or two amounts, each a number, an array, a function of time or a table ``{"over":
    "time", a driver or a pair, "at": [...], "values": [...]}``, with ``"period"`` where it repeats and ``"smooth":
    True`` for a spline. It is in the mechanism's unit of force, in the axes of the frame or of the link `fixed_in`,
    with which it then turns. `at` is a letter of the link, or a place in its frame. With ``while_moving=(dx, dy)`` it
    acts only while that point moves so.

    Raises InvalidMechanism for an invalid force.

    >>> force("bar", (-3, -5), at="G").force
    (-3-5j)
    >>> force("ram", (0, lambda t: -100 * t), at=(0, 20)).name
    'force on ram'
    """
    where = f"forces.{name or link}"
    place = at if isinstance(at, str) else vector(f"{where}.at", at)
    moving = None if while_moving is None else vector(f"{where}.while_moving", while_moving)
    return Force(link, as_planar_amount(f"{where}.force", force), place, fixed_in, moving, name=name)


@checked
def torque(link: str, torque: Any, *, name: str = "") -> Torque:
    """Return a torque on a link, counterclockwise positive, in units of force times length.

    It is a number, an array whose last axis is the motion, a function of the time ``t`` and the link's angular velocity
    ``w``, as its arguments name them, or a table as of `force`, which may be over the angular velocity, ``"over":
    "rate"`` in rad/s.

    >>> torque("rocker", 0.02).torque
    0.02
    >>> torque("rocker", lambda w: -0.1 * w).needs_rates
    True
    """
    return Torque(link, as_amount(f"torques.{name or link}.torque", torque, TIME, "rate"), name=name)
