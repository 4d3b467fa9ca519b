"""`Painter`: a scene on its window, and what all shapes of a sketch ask of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from compoundkin.model.elements import FRAME
from compoundkin.view.sketch.scene import Scene, Seen
from compoundkin.view.sketch.shapes import Polygon, Polyline, Shape
from compoundkin.view.sketch.sketch_style import BLOCK, PIN, style_of
from compoundkin.view.sketch.strokes import box, direction
from compoundkin.view.sketch.window import Window


class Layer(IntEnum):
    """What is drawn first is behind."""

    BACK = 0
    FRAME = 1
    WHEEL = 2
    PLATE = 3
    BAR = 4
    GROOVE = 5
    BLOCK = 6
    PIN = 7


class Laid(NamedTuple):
    """A shape with its layer and the link with which it moves; at a point with a `letter` it does not turn with it."""

    layer: Layer
    shape: Shape
    link: str
    letter: str = ""


@dataclass(frozen=True)
class Painter:
    """A scene on its window; of all its links, or of `only` some that are drawn apart."""

    scene: Scene
    window: Window
    only: frozenset[str] | None = None
    outer: frozenset[str] = frozenset()  # the letters of the pairs by which those are attached

    def shows(self, link: str) -> bool:
        """Whether a link is drawn."""
        return self.only is None or link in self.only

    def place(self, link: str, p: Any) -> complex:
        """Where a point of a link is on the picture."""
        return complex(self.window.at(self.scene.at(link, p)))

    def line(self, link: str, points: Any) -> tuple[complex, ...]:
        """A line of a link on the picture."""
        return self.window.line(self.scene.here[link].at(points).c[0])

    def along(self, link: str, e: Any) -> complex:
        """A direction of a link on the picture."""
        return direction(np.conjugate(self.scene.turned(link, e)))

    def style(self, kind: str, link: str) -> str:
        """The style of a shape that belongs to a link; the frame has its own."""
        if link != FRAME:
            return style_of(kind, self.scene.groups[link])
        return {"plate": "frame-face frame", "track": "frame-track"}.get(kind, "frame")

    @cached_property
    def middle(self) -> complex:
        """The middle of all points on the picture."""
        return complex(np.mean([self.window.at(p) for p in self.scene.letters.values()] or [0j]))

    @cached_property
    def driven(self) -> frozenset[str]:
        """The names of the driven pairs."""
        return frozenset(step.pair.name for step in self.scene.driven)

    def is_cylinder(self, seen: Seen) -> bool:
        """Whether a slide is drawn as a cylinder: where it is driven between two moving links."""
        return FRAME not in seen.members and seen.pair.name in self.driven

    def is_rod(self, seen: Seen) -> bool:
        """Whether a slide is drawn as a rod through a block: where the link with the guide has but one point."""
        guide, block = (len(self.scene.points[name]) for name in seen.members)
        return seen.members[0] != FRAME and guide == 1 and block > 1

    def block_at(self, link: str, middle: complex, along: complex) -> Laid:
        """A block."""
        style = "pin frame" if link == FRAME else f"pin {style_of('ring', self.scene.groups[link])}"
        return Laid(Layer.BLOCK, Polygon(box(middle, along, *BLOCK), style), link)

    def stub(self, link: str, foot: complex) -> Iterator[Laid]:
        """A bar from a place to the nearest point of its link, where it is none of them."""
        own = [self.place(link, p) for p in self.scene.points[link].values()]
        nearest = min(own, key=lambda p: abs(p - foot), default=foot)
        if link != FRAME and abs(nearest - foot) > PIN:
            yield Laid(Layer.BAR, Polyline((nearest, foot), self.style("bar", link)), link)
