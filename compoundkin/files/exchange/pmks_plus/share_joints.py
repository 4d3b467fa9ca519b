"""The joints and blocks that a drawing is written with: pins, and for each guide a block with a sliding joint."""

from __future__ import annotations

from cmath import rect
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import product
from math import pi
from string import ascii_letters

from compoundkin.files.exchange.drawings.drawn_elements import Drawing, DrawnGuideway
from compoundkin.files.exchange.pmks_plus.share_scale import ShareScale, rounded
from compoundkin.files.exchange.pmks_plus.shared_records import SharedJoint
from compoundkin.model.geometry import FRAME

# Joints whose line is this near to a guide's direction (radians) are on it: what sums of coordinates leave.
_PARALLEL = 1e-9
# Joints of a carrier are far enough apart to tell its direction beyond this part of the size.
_LONG = 0.1
# How far a joint that is added for a guide is from the next one, as a part of the size.
_APART = 0.5
_BESIDE = 0.1
_FORBIDDEN = str.maketrans("#,.~", "----")


@dataclass
class ShareJoints:
    """The joints by their ids, those of each link, and the blocks.

    Of a block it has the key of its link, where that is no more, its pin and its sliding joint.
    `of_point` and `of_guide` have the joint of each point and guide of the drawing by its key.
    """

    drawing: Drawing
    scale: ShareScale
    on_rails: bool = False
    joints: dict[str, SharedJoint] = field(default_factory=dict)
    members: dict[str, list[str]] = field(default_factory=dict)
    blocks: list[tuple[str, str, str]] = field(default_factory=list)
    of_point: dict[str, str] = field(default_factory=dict)
    of_guide: dict[str, str] = field(default_factory=dict)
    turned: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        self._names = {point.called for point in self.drawing.points if len(point.called) == 1}
        self._free = (id_ for id_ in _ids() if id_ not in self._names)
        self.members = {link.key: [] for link in self.drawing.links if link.key != FRAME}
        guides = self.drawing.guides
        self._slotted = {guide.at for guide in guides if guide.kind == "slot"}
        self._uses = Counter([*(g.link for g in guides if g.kind == "slide"), *(g.on for g in guides)])
        for point in self.drawing.points:
            if set(point.links) != {FRAME} or point.key in self._slotted:
                name = plain_name(point.called)
                id_ = self.add(point.at * self.scale.factor, point.links, name, point.key in self.drawing.outputs)
                self.of_point[point.key] = id_
        for guide in guides:
            self._guide(guide)

    def add(self, at: complex, links: tuple[str, ...], name: str = "", has_curve: bool = False) -> str:
        """Add a pin of links and return its id. That is its name where this is a free letter."""
        is_letter = len(name) == 1 and name in ascii_letters and name not in self.joints
        id_ = name if is_letter else next(self._free)
        grounded = FRAME in links
        self.joints[id_] = SharedJoint(id_, name or id_, at, is_grounded=grounded, has_curve=has_curve)
        for link in links:
            if link != FRAME:
                self.members[link].append(id_)
        return id_

    def change(self, id_: str, **changes: object) -> None:
        """Change what is said of a joint."""
        self.joints[id_] = replace(self.joints[id_], **changes)  # type: ignore[arg-type]

    def enough(self, link: str) -> list[str]:
        """Return the joints of a link, two at least. What is missing is added beside."""
        own = self.members[link]
        while len(own) < 2:
            self.add((self.joints[own[0]].at if own else 0j) + _BESIDE * self.scale.size, (link,))
        return own

    def _guide(self, guide: DrawnGuideway) -> None:
        """Add the block of a guide. A slide of the frame on a link is one of the link on the frame."""
        body, on, angle = guide.link, guide.on, guide.angle
        if guide.kind == "slide" and body == FRAME:
            body, on = on, body
            self.turned.add(guide.key)
        pin = self._in_slot(guide) if guide.kind == "slot" else self._welded(guide, body)
        slider = self._slider(guide, pin, on, angle)
        self.of_guide[guide.key] = slider
        is_link = guide.kind == "slide" and not self.joints[pin].is_welded
        self.blocks.append((body if is_link else "", pin, slider))

    def _welded(self, guide: DrawnGuideway, body: str) -> str:
        """Return the pin of a slide's block: the only point of a link that is no more, else one welded to the link."""
        own = self.members[body]
        loaded = body in {force.link for force in self.drawing.forces}
        at = self.of_point.get(guide.at)
        plain = self._uses[body] == 1 and guide.at not in self._slotted and not loaded
        if own == [at] and plain and not (self.joints[own[0]].is_grounded or self._has_block(own[0])):
            return own[0]
        taken = {id_ for link, ids in self.members.items() if link != body for id_ in ids}
        taken |= {self.of_point[key] for key in self._slotted}
        free = [k for k in own if k not in taken and not (self.joints[k].is_grounded or self.joints[k].is_welded)]
        pin = at if at in free else next(iter(free), None) or self.add(self._beside(guide), (body,))
        self.change(pin, is_welded=True)
        return pin

    def _in_slot(self, guide: DrawnGuideway) -> str:
        """Return the pin of a slot's block. A pin has one block: for a second, its link is given a pin there."""
        pin = self.of_point[guide.at]
        return self.add(self.joints[pin].at, (guide.link,)) if self._has_block(pin) else pin

    def _has_block(self, pin: str) -> bool:
        return any(pin == other for _, other, _ in self.blocks)

    def _beside(self, guide: DrawnGuideway) -> complex:
        at = self.joints[self.of_point[guide.at]].at if guide.at in self.of_point else guide.through * self.scale.factor
        return at + rect(_APART * self.scale.size, guide.angle)

    def _slider(self, guide: DrawnGuideway, pin: str, on: str, angle: float) -> str:
        """Add the sliding joint of a block at its pin: grounded at an angle, or on a link through two joints of it."""
        id_ = self.add(self.joints[pin].at, ())
        if on == FRAME and not self.on_rails:
            driven = guide.key in {one.at for one in self.drawing.drivers}
            self.change(id_, slides=True, is_grounded=True, angle=_best_angle(angle, is_driven=driven))
            return id_
        carrier = on if on != FRAME else self._rail(guide, pin, angle)
        ends = self._ends(guide, carrier, angle)
        self.change(id_, slides=True, slot=(carrier, *ends))
        return id_

    def _rail(self, guide: DrawnGuideway, pin: str, angle: float) -> str:
        """Add a link that the frame holds at two pins, in the direction of a guide on the frame."""
        key = f"rail {guide.key}"
        self.members[key] = []
        for side in (-1.0, 1.0):
            self.add(self.joints[pin].at + rect(side * _APART * self.scale.size, angle), (FRAME, key))
        return key

    def _ends(self, guide: DrawnGuideway, on: str, angle: float) -> tuple[str, str]:
        """Return two joints of a carrier in the direction of a guide, far apart; added where there are none."""
        if not self.members[on]:
            self.add(guide.through * self.scale.factor, (on,))
        own = self.members[on]
        told = tuple(self.of_point[key] for key in guide.ends or () if key in self.of_point)
        if len(told) == 2 and set(told) <= set(own) and self._is_told_well(*told):
            return told
        one, other = max(product(own, own), key=lambda ends: self._along(ends[0], ends[1], angle))
        if self._along(one, other, angle) > _LONG * self.scale.size:
            return one, other
        return own[0], self.add(self.joints[own[0]].at + rect(_APART * self.scale.size, angle), (on,))

    def _is_told_well(self, one: str, other: str) -> bool:
        """Return whether the line through two joints keeps its direction when they are rounded."""
        ends = (self.joints[one].at, self.joints[other].at)
        is_exact = all(rounded(part) == part for end in ends for part in (end.real, end.imag))
        return is_exact or abs(ends[1] - ends[0]) > _LONG * self.scale.size

    def _along(self, one: str, other: str, angle: float) -> float:
        """Return how far a joint is from another in a direction, 0 where it is not in that."""
        gap: complex = (self.joints[other].at - self.joints[one].at) * rect(1.0, -angle)
        return gap.real if abs(gap.imag) <= _PARALLEL * abs(gap) else 0.0


def plain_name(name: str) -> str:
    """Return a name without what ends fields, records and links."""
    return name.translate(_FORBIDDEN)


def _best_angle(angle: float, *, is_driven: bool) -> float:
    """Return an angle, a turn more or less, that rounding changes least; lines that nothing drives have two."""
    turns = (0, -2, 2) if is_driven else (0, -2, 2, 1, -1)
    same = [angle + k * pi for k in turns]
    return min(same, key=lambda one: (round(abs(rounded(one) - one), 9), abs(one)))


def _ids() -> Iterator[str]:
    """Yield A, B ... Z, a ... z, and then two letters each."""
    letters = ascii_letters[26:] + ascii_letters[:26]
    yield from letters
    yield from ("".join(pair) for pair in product(letters, letters))
