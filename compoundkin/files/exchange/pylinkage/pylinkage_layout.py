"""A drawing as pylinkage can say it: which points are joints, of which links, and what it cannot say at all."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.drawings.drawn_elements import Drawing, DrawnDriver, DrawnGuideway, DrawnPoint
from compoundkin.model.geometry import FRAME

# Points nearer to each other than this part of the size are at one place, and tell no direction; directions
# nearer than this are one.
_ROUNDING = 1e-9


@dataclass(frozen=True)
class JointLine:
    """The line of the frame that a joint runs on."""

    through: complex
    angle: float


@dataclass
class PylinkageLayout:
    """The joints of links, lines that some run on, tracers, cranks.

    A crank is told by its motor and its tip.
    """

    drawing: Drawing
    sliding: dict[str, float] = field(default_factory=dict)
    lines: dict[str, JointLine] = field(default_factory=dict)
    joints: dict[str, list[str]] = field(default_factory=dict)
    trackers: dict[str, tuple[str, str]] = field(default_factory=dict)
    cranks: dict[str, tuple[str, str]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.places = {point.key: point.at for point in self.drawing.points}
        self.of = {point.key: point.links for point in self.drawing.points}
        centre = sum(self.places.values()) / max(len(self.places), 1)
        self._near = _ROUNDING * max((abs(place - centre) for place in self.places.values()), default=0.0)
        problems = [*self._unsaid(), *self._placed_lines(), *self._made_links()]
        if problems:
            raise InvalidInput(problems, heading=f"{self.drawing.title!r} cannot be said in pylinkage")

    def apart(self, first: str, second: str) -> bool:
        """Return whether two points are at different places."""
        return abs(self.places[first] - self.places[second]) > self._near

    def on_frame(self, point: str) -> bool:
        """Return whether a point is one of the frame."""
        return FRAME in self.of[point]

    def _unsaid(self) -> Iterator[Problem]:
        """Find elements that no link and joint of theirs stands for."""
        drawing = self.drawing
        for word, elements in (("arc", drawing.arcs), ("gear or belt", drawing.gears), ("rack", drawing.racks)):
            for element in elements:
                yield Problem(element.key, f"an {word}" if word == "arc" else f"a {word}", _KNOWN)
        for guide in drawing.guides:
            if FRAME not in (guide.link, guide.on) or (guide.kind == "slot" and guide.on != FRAME):
                yield Problem(guide.key, f"a {guide.kind} of the moving link {guide.on!r}", _KNOWN)
        guides = {guide.key for guide in drawing.guides}
        for driver in drawing.drivers:
            called = f"driver {driver.name or driver.link}"
            if driver.at in guides:
                yield Problem(called, "it drives a length", "pylinkage drives links that turn on the frame")
            elif driver.on != FRAME:
                yield Problem(called, f"it turns on the moving link {driver.on!r}", "it would have to be the frame")

    def _placed_lines(self) -> Iterator[Problem]:
        """Find the lines of points: of slots, and of all points of links that slide."""
        for guide in self.drawing.guides:
            if guide.kind == "slide":
                self.sliding.setdefault(guide.on if guide.link == FRAME else guide.link, guide.angle)
        for point in self.drawing.points:
            wanted = [JointLine(guide.through, guide.angle) for guide in self._guides_at(point)]
            wanted += [JointLine(point.at, self.sliding[link]) for link in point.links if link in self.sliding]
            if wanted:
                self.lines[point.key] = wanted[0]
            if any(abs(math.sin(line.angle - wanted[0].angle)) > _ROUNDING for line in wanted):
                yield Problem(f"point {point.called}", "it runs on two lines", "a joint of pylinkage runs on one")

    def _guides_at(self, point: DrawnPoint) -> Iterator[DrawnGuideway]:
        return (guide for guide in self.drawing.guides if guide.at == point.key and guide.link != FRAME)

    def _made_links(self) -> Iterator[Problem]:
        """Find the joints of links, and a tip for every crank."""
        for link in self.drawing.links:
            if link.key != FRAME:
                own = [point.key for point in self.drawing.points_of(link.key)]
                joints = [key for key in own if len(self.of[key]) > 1 or key in self.lines]
                wanted = (key for key in own if key not in joints)
                while len(joints) < 2 and (more := next(wanted, None)):
                    joints.append(more)
                self.joints[link.key] = joints
                yield from self._tracked(link.key, joints, [key for key in own if key not in joints])
        yield from (problem for driver in self.drawing.drivers for problem in self._crank(driver))

    def _tracked(self, link: str, joints: list[str], tracers: list[str]) -> Iterator[Problem]:
        """Give the tracers of a link two joints to be told by."""
        pair = next(((a, b) for a in joints for b in joints if self.apart(a, b)), None)
        if pair is not None:
            self.trackers |= dict.fromkeys(tracers, pair)
        elif tracers:
            yield Problem(f"link {link}", "its joints are at one place, and tell no direction", "give it another point")

    def _crank(self, driver: DrawnDriver) -> Iterator[Problem]:
        if driver.at not in self.of or driver.on != FRAME:
            return
        tips = [key for key in self.joints[driver.link] if self.apart(key, driver.at)]
        tips.sort(key=lambda key: key in self.lines or self.on_frame(key))
        if tips:
            self.cranks[driver.link] = (driver.at, tips[0])
        else:
            what = f"the link {driver.link!r} has no point beside its pin"
            yield Problem(f"driver {driver.name or driver.link}", what, "give it one")


_KNOWN = "pylinkage knows pins, and pins in slots of the frame"
