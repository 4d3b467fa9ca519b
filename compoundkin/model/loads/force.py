"""Forces and torques on links."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, ClassVar

from compoundkin.base.arguments import checked
from compoundkin.base.series import Number
from compoundkin.base.wrenches import Wrench
from compoundkin.model.fields import link_key, value_key
from compoundkin.model.geometry import FRAME, real, vector
from compoundkin.model.loads.contract import Load, LoadedPoses


@dataclass(frozen=True, eq=False)
class Force(Load):
    """A force on a link at a point. Its direction is fixed in the frame or in a link."""

    link: str = field(metadata=link_key("The link it acts on."))
    force: Any = field(metadata=value_key("point", "The force, x and y in the frame of `fixed_in`."))
    at: str = field(metadata=value_key("name", "The point of the link at which it acts."))
    fixed_in: str = field(default=FRAME, metadata=value_key("name", "The link with which its direction turns."))

    title: ClassVar[str] = "force"
    table: ClassVar[str] = "forces"

    @property
    def links(self) -> tuple[str, ...]:
        """The link it acts on."""
        return (self.link,)

    def attack(self, link: str) -> str:
        """Return its point."""
        return self.at

    def wrenches(self, at: LoadedPoses) -> Iterator[tuple[str, Wrench]]:
        """Yield the force."""
        turned = at.fitted(self.force)
        if self.fixed_in != FRAME:
            turned = at.pose(self.fixed_in).u.c[0] * turned
        yield self.link, Wrench.at(at.place(self.link, self.at).c[0], turned)


@dataclass(frozen=True, eq=False)
class Torque(Load):
    """A torque on the link `link`, counterclockwise positive."""

    link: str = field(metadata=link_key("The link it acts on."))
    torque: Any = field(metadata=value_key("length", "The torque, counterclockwise positive."))

    title: ClassVar[str] = "torque"
    table: ClassVar[str] = "torques"

    @property
    def links(self) -> tuple[str, ...]:
        """The link it acts on."""
        return (self.link,)

    def wrenches(self, at: LoadedPoses) -> Iterator[tuple[str, Wrench]]:
        """Yield the torque."""
        yield self.link, Wrench(0j, at.fitted(self.torque))


@checked
def force(link: str, force: Any, *, at: str, fixed_in: str = FRAME, name: str = "") -> Force:
    """Return a force on a link.

    >>> force("bar", (-3, -5), at="G").force
    (-3-5j)
    """
    return Force(link, vector(f"forces.{name or link}.force", force), at, fixed_in, name=name)


@checked
def torque(link: str, torque: Number, *, name: str = "") -> Torque:
    """Return a torque on a link.

    >>> torque("rocker", 0.02).torque
    0.02
    """
    return Torque(link, real(f"torques.{name or link}.torque", torque), name=name)
