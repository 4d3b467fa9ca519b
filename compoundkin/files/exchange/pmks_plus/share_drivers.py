"""The inputs that drivers are written as: joints between two links, with speeds of their own where they differ."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.drawings.drawn_elements import DrawnDriver, DrawnPoint
from compoundkin.files.exchange.pmks_plus.share_joints import ShareJoints
from compoundkin.files.exchange.pmks_plus.share_scale import rounded
from compoundkin.files.written_quantities import RPM
from compoundkin.model.geometry import FRAME

# What the program turns at where we have no speed.
_RPM = 10.0
# A speed within this part is the same: what the change of units leaves.
_SAME = 1e-9


@dataclass
class ShareDrivers:
    """Inputs, and the speeds of the document.

    `before` is which link comes before which, which says what is driven.
    """

    table: ShareJoints
    clockwise: bool = False
    rpm: float = _RPM
    linear: float = 0.0
    before: list[tuple[str, str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        found = [(self._input(one), one) for one in self.table.drawing.drivers]
        speeds = [(id_, speed) for id_, one in found if (speed := self._speed(id_, one)) is not None]
        turning = [speed for id_, speed in speeds if not self.table.joints[id_].slides]
        sliding = [speed for id_, speed in speeds if self.table.joints[id_].slides]
        self.clockwise = next(iter([*turning, *sliding]), 1.0) < 0.0
        self.rpm = float(max(round(abs(turning[0])), 1)) if turning else _RPM
        self.linear = rounded(abs(sliding[0])) if sliding else 0.0
        sense = -1.0 if self.clockwise else 1.0
        for id_, speed in speeds:
            whole = sense * (self.linear if self.table.joints[id_].slides else self.rpm)
            if abs(speed - whole) > _SAME * abs(whole):
                self._own(id_, speed)

    def _own(self, id_: str, speed: float) -> None:
        """Give an input a speed of its own, which is not told where it is rounded to nothing."""
        told = rounded(speed)
        if told != speed and abs(told - speed) > _SAME * abs(speed):
            unit = "units of length a second" if self.table.joints[id_].slides else "rpm"
            self.notes.append(f"the speed of the driver at {id_} is {told:g} {unit}, rounded from {speed:.9g}")
        self.table.change(id_, speed=told)

    def _speed(self, id_: str, one: DrawnDriver) -> float | None:
        """Return a driver's speed as it is written: in rpm, or in lengths a second; signed as the joint has it."""
        if one.speed is None:
            return None
        if not self.table.joints[id_].slides:
            return one.speed / RPM * (-1.0 if one.link == FRAME else 1.0)
        guide = next(guide for guide in self.table.drawing.guides if guide.key == one.at)
        turned = (one.link == guide.on) != (one.at in self.table.turned)
        return one.speed * self.table.scale.factor * (-1.0 if turned else 1.0)

    def _input(self, one: DrawnDriver) -> str:
        """Make the joint of a driver an input, and return its id."""
        if one.at in self.table.of_guide:
            id_ = self.table.of_guide[one.at]
        else:
            point = next(point for point in self.table.drawing.points if point.key == one.at)
            id_ = self._between_two(point, one)
            if FRAME not in (one.link, one.on):
                self.before.append((one.on, one.link))
        self.table.change(id_, is_input=True)
        return id_

    def _between_two(self, point: DrawnPoint, one: DrawnDriver) -> str:
        """Return the joint of a driven pin. Of several links there, the driven one is pinned by a joint of its own."""
        id_ = self.table.of_point[point.key]
        links = tuple(dict.fromkeys((one.on, one.link)))
        if set(point.links) == set(links):
            return id_
        driven = one.link if one.link != FRAME else one.on
        self.table.members[driven].remove(id_)
        return self.table.add(self.table.joints[id_].at, links)


def in_order(links: list[str], before: list[tuple[str, str]]) -> Iterator[str]:
    """Yield links in their order, but for those that come after others."""
    left = list(links)
    while left:
        first = next((k for k in left if not any(b == k and a in left for a, b in before)), None)
        if first is None:
            what = f"drivers between {' and '.join(left)} drive each other in a ring"
            raise InvalidInput(Problem("drives", what, "drive one of them against another link"))
        left.remove(first)
        yield first
