"""Pairs whose links rub: where friction acts in them, and by which forces they are pressed together.

Pins, slides, pins in slots and cams rub. Wheels that roll, gears and belts do not: what they pass on they hold.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar

from compoundkin.base.arrays import dot
from compoundkin.base.series import Number
from compoundkin.base.wrenches import Wrench
from compoundkin.model.pairs.contact import Contact
from compoundkin.model.pairs.contract import Ends, Pair, Poses


class Rubbing(Pair):
    """A pair whose links rub on each other as it moves."""

    needs_radius: ClassVar[bool] = False  # whether friction takes a radius, as that of a pin

    @abstractmethod
    def rubbed(self, ends: Ends, poses: Poses, radius: Number) -> Wrench:
        """Return the wrench on the second member of friction by a press of one. It is along the pair's free motion.

        Where friction acts on a pin it is a couple, the `radius`.
        """

    @abstractmethod
    def presses(self, ends: Ends, poses: Poses, wrench: Wrench, length: Number | None) -> tuple[Number, ...]:
        """Return the forces that press the links together.

        They are linear in the wrench, that on the second member. Each is a number with a sign or a vector; friction
        goes by the sum of their sizes.
        """


def as_rubbing(pair: Pair) -> Rubbing | None:
    """Return a pair as one whose links rub, or None."""
    return pair if isinstance(pair, Rubbing) else None


class RubbingPin(Rubbing):
    """A pin. The friction moment is coefficient times radius times force."""

    needs_radius = True

    def rubbed(self, ends: Ends, poses: Poses, radius: Number) -> Wrench:
        """Return a couple."""
        return Wrench(0j, radius)

    def presses(self, ends: Ends, poses: Poses, wrench: Wrench, length: Number | None) -> tuple[Number, ...]:
        """Return the force in the pin."""
        return (wrench.force,)


class RubbingGuide(Rubbing):
    """A block in a guide. With a length it touches at the two ends of that, else at its point."""

    takes: ClassVar[tuple[str, ...]] = ("effort", "friction")

    def rubbed(self, ends: Ends, poses: Poses, radius: Number) -> Wrench:
        """Return a force of one along the guide, through the block's point."""
        return Wrench.at(poses[1].at(ends[1].point).c[0], poses[0].carry(ends[0]).along.c[0])

    def presses(self, ends: Ends, poses: Poses, wrench: Wrench, length: Number | None) -> tuple[Number, ...]:
        """Return the normal force, or those at both ends of a long guide.

        These carry the moment as well.
        """
        normal = dot(1j * poses[0].carry(ends[0]).along.c[0], wrench.force)
        if length is None:
            return (normal,)
        couple = wrench.about(poses[1].at(ends[1].point).c[0]) / length
        return 0.5 * normal + couple, 0.5 * normal - couple


class RubbingContact(Contact, Rubbing):
    """Two links that touch at a place and slide there."""

    def rubbed(self, ends: Ends, poses: Poses, radius: Number) -> Wrench:
        """Return a force of one across the common normal, where they touch."""
        touch = self.touch(ends, poses)
        return Wrench.at(touch.place.c[0], -1j * touch.normal.c[0])

    def presses(self, ends: Ends, poses: Poses, wrench: Wrench, length: Number | None) -> tuple[Number, ...]:
        """Return the force along the common normal."""
        return (dot(self.touch(ends, poses).normal.c[0], wrench.force),)
