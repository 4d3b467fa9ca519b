"""What interference comes to: the touches of links, the least clearance of the others, as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from compoundkin.base.display import DisplaysHtml, count_phrase
from compoundkin.kinematics import Motion


@dataclass(frozen=True)
class LinkTouch:
    """A run in which two links touch.

    It is from the place `first` to the place `last` along the motion. Places count poses from 0, and are fractional
    between them. `begin` and `end` are the drivers' values there, found to 1e-6; where the run reaches an end of the
    motion, or poses that cannot be assembled (`open_begin`, `open_end`), they are the values there. `at` is where they
    touch first. Of a closed cycle a run through its first pose is one, and `first` is after `last`. A pin is called
    "pin B".
    """

    one: str
    other: str
    layers: tuple[int, ...]
    design: int
    first: float
    last: float
    begin: Mapping[str, float]
    end: Mapping[str, float]
    open_begin: bool
    open_end: bool
    at: complex
    times: tuple[float, float] | None = None


@dataclass(frozen=True)
class LinkClearance:
    """The least clearance of two links that never touch.

    It is at a place along the motion; `at` is in the middle between them.
    """

    one: str
    other: str
    layers: tuple[int, ...]
    design: int
    clearance: float
    place: float
    drives: Mapping[str, float]
    at: complex
    time: float | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Interference(DisplaysHtml):
    """Which outlines touch along a motion, and how near the others come.

    `clearances` are those of two links each that never touch, the least first, design by design. `neighbours` are
    joined links whose shapes about their common joint are not compared. `poses` were looked at, with all between them;
    `missing` are not assembled.
    """

    motion: Motion
    touches: tuple[LinkTouch, ...]
    clearances: tuple[LinkClearance, ...]
    neighbours: tuple[tuple[str, str], ...]
    poses: int
    missing: int

    @property
    def passed(self) -> bool:
        """Whether nothing touches, and there was something to look at."""
        return self.poses > 0 and not self.touches

    @property
    def least(self) -> LinkClearance | None:
        """The least clearance of all; None where nothing is compared that never touches."""
        return min(self.clearances, key=lambda one: one.clearance, default=None)

    @property
    def touching(self) -> tuple[tuple[str, str], ...]:
        """The links that touch, each two once."""
        return tuple(dict.fromkeys((one.one, one.other) for one in self.touches))

    def at(self, pose: int, design: int = 0) -> tuple[LinkTouch, ...]:
        """Return the runs in which a pose lies, by its index along the motion."""
        return tuple(one for one in self.touches if one.design == design and _within(one, pose))

    @property
    def verdict(self) -> str:
        """What it comes to in words."""
        if not self.poses:
            return "no pose is assembled: nothing could be compared"
        if not self.touches and not self.clearances:
            return "no two links share a layer but neighbours"
        if self.touches:
            return f"{count_phrase(len(self.touching), 'pair')} of links touch"
        least = self.least
        unit = f" {self.motion.mechanism.unit}".rstrip()
        told = "" if least is None else f"; the least clearance is {least.clearance:.6g}{unit}"
        return f"no links touch{told}"

    def __repr__(self) -> str:
        return f"Interference({self.motion.mechanism.title!r} at {count_phrase(self.poses, 'pose')}: {self.verdict})"


def _within(one: LinkTouch, place: float) -> bool:
    if one.first <= one.last:
        return one.first <= place <= one.last
    return place >= one.first or place <= one.last
