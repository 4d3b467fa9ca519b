"""Dyads as constructions of circles and lines."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

from compoundkin.files.exchange.geogebra.dragged_construction import Angle, Construction, PolarSum, along, at, named
from compoundkin.files.exchange.geogebra.pair_sides import (
    ConstructedBody,
    NamedEnd,
    PairSides,
    PlacedBodies,
    length_of,
    seen_from,
)
from compoundkin.kinematics.groups.dyad import DyadSolver
from compoundkin.kinematics.groups.pair_sides import Side

# How far beyond its range rounding takes the cosine of an angle that is flat.
_FLAT = "1E-9"


def rrr(dyad: DyadParts) -> None:
    """Add a dyad of three pins.

    The inner pin is found by the law of cosines, on a side of the way from one outer pin to the other.
    """
    build, k = dyad.build, dyad.index
    one, two = dyad.known(0).point, dyad.known(1).point
    a, turned = length_of(build, dyad.inner[0].way.minus(dyad.outer[0].way), k)
    b, other = length_of(build, dyad.inner[1].way.minus(dyad.outer[1].way), k)
    d = build.measured("d", k, "Distance", (one, two))
    cosine = build.helper("q", k, f"({a}^2 + {d}^2 - {b}^2) / (2 * {a} * {d})")
    opened = build.helper("γ", k, f"acos({rounded(cosine)}) / °")
    line = seen_from(one, two)
    # to the right of the way from outer pin to outer pin the three run counterclockwise
    first = dyad.angle(0, f"{line} - {dyad.mode} * {opened}" + _less(turned))
    pin = dyad.pin(at(one).plus(along(a, first.plus(turned))).text)
    dyad.hold(0, one, dyad.outer[0].way, first)
    if dyad.is_real(1):
        dyad.hold(1, two, dyad.outer[1].way, dyad.angle(1, seen_from(two, pin) + _less(other)))


def rrp(dyad: DyadParts) -> None:
    """Add a dyad of a rod and a block.

    From the foot of the outer pin on the line of the inner one it is half a chord, forward or backward along the guide.
    """
    build, k = dyad.build, dyad.index
    outer, guide = dyad.known(0).point, dyad.known(1)
    a, turned = length_of(build, dyad.inner[0].way.minus(dyad.outer[0].way), k)
    block = guide.angle.minus(dyad.outer[1].angle)
    start = dyad.beside(guide.point, dyad.inner[1].way.minus(dyad.outer[1].way), block, "S")
    line = _line(dyad, start, guide.angle, "")
    foot = build.shape("point", ("F", k), "helper", "ClosestPoint", (line, outer))
    square = build.helper("q", k, f"{a}^2 - Distance({outer}, {foot})^2")
    chord = build.helper("h", k, f"sqrt({positive(square, a)})")
    pin = dyad.pin(at(foot).plus(along(f"{dyad.mode} * {chord}", guide.angle)).text)
    if dyad.is_real(0):
        dyad.hold(0, outer, dyad.outer[0].way, dyad.angle(0, seen_from(outer, pin) + _less(turned)))
    if dyad.is_real(1):
        dyad.hold(1, pin, dyad.inner[1].way, block)


def rpr(dyad: DyadParts) -> None:
    """Add a guide and a block, turned until both pins fit."""
    build, k = dyad.build, dyad.index
    one, two = dyad.known(0).point, dyad.known(1).point
    here = dyad.outer[0].way.minus(dyad.inner[0].way).turned(Angle().minus(dyad.inner[0].angle))
    there = dyad.outer[1].way.minus(dyad.inner[1].way).turned(Angle().minus(dyad.inner[1].angle))
    across = there.minus(here).rectangular("y")
    line = seen_from(one, two)
    if across == "0":
        text = f"{line} + 90 * (1 - {dyad.mode})"
    else:
        e = build.helper("e", k, across)
        square = build.helper("q", k, f"Distance({one}, {two})^2 - {e}^2")
        text = f"{line} - atan2({e}, {dyad.mode} * sqrt({positive(square, e)})) / °"
    guide = named(build.helper("ψ", k, text))
    for j, point in enumerate((one, two)):
        if dyad.is_real(j):
            dyad.hold(j, point, dyad.outer[j].way, guide.minus(dyad.inner[j].angle))


def prp(dyad: DyadParts) -> None:
    """Add two blocks pinned to each other, where their two lines meet."""
    guides = [dyad.known(j) for j in (0, 1)]
    blocks = [guide.angle.minus(end.angle) for guide, end in zip(guides, dyad.outer, strict=True)]
    lines = []
    for j, (guide, block) in enumerate(zip(guides, blocks, strict=True)):
        way = dyad.inner[j].way.minus(dyad.outer[j].way)
        start = dyad.beside(guide.point, way, block, "ST"[j])
        lines.append(_line(dyad, start, guide.angle, "ab"[j]))
    pin = dyad.pin_met((lines[0], lines[1]))
    for j, block in enumerate(blocks):
        if dyad.is_real(j):
            dyad.hold(j, pin, dyad.inner[j].way, block)


def rpp(dyad: DyadParts) -> None:
    """Add a link on a slide that slides, where two lines meet."""
    outer, guide = dyad.known(0).point, dyad.known(1)
    block = guide.angle.minus(dyad.outer[1].angle)
    held = block.plus(dyad.inner[1].angle)
    first = held.minus(dyad.inner[0].angle)
    through = dyad.beside(outer, dyad.inner[0].way.minus(dyad.outer[0].way), first, "S")
    start = dyad.beside(guide.point, dyad.inner[1].way.minus(dyad.outer[1].way), block, "T")
    lines = _line(dyad, through, held, "a"), _line(dyad, start, guide.angle, "b")
    met = dyad.runner_met(lines)
    if dyad.is_real(0):
        dyad.hold(0, outer, dyad.outer[0].way, first)
    if dyad.is_real(1):
        dyad.hold(1, met, dyad.inner[1].way, block)


def rounded(cosine: str) -> str:
    """Return a cosine without what rounding adds to that of a flat angle."""
    return f"If(1 < abs({cosine}) ∧ abs({cosine}) < 1 + {_FLAT}, sgn({cosine}), {cosine})"


def positive(square: str, length: str) -> str:
    """Return a square without what rounding takes from zero."""
    return f"If({square} < 0 ∧ -{square} < {_FLAT} * {length}^2, 0, {square})"


def _less(angle: Angle) -> str:
    """Return what takes an angle off, as the end of a sum."""
    return "" if angle.is_zero else f" - ({angle.text})"


def _line(dyad: DyadParts, start: str, angle: Angle, index: str) -> str:
    """Add the line of a guide, or one beside it; return its name."""
    ahead = at(start).plus(along("1", angle)).text
    return dyad.build.shape("line", ("g", f"{dyad.index}{index}"), "guide", "Line", (start, ahead))


class DyadParts:
    """A dyad to be constructed. `index` is that of its helpers, `mode` the number that says which of two ways."""

    def __init__(self, placed: PlacedBodies, sides: PairSides, solver: DyadSolver, index: str, mode: str) -> None:
        self.build: Construction = placed.build
        self.placed, self.solver, self.index, self.mode = placed, solver, index, mode
        self._sides = sides
        self.outer = tuple(self._own(side) for side in solver.outer)
        self.inner = tuple(self._own(side) for side in solver.inner)

    def _own(self, side: Side) -> NamedEnd:
        """Return a side in the axes of its body."""
        end = self._sides.of(side.pair, side.own)
        way, angle = self.placed.in_body(side.link, end.way), self.placed.angle_in_body(side.link, end.angle)
        return end._replace(way=way, angle=angle)

    def known(self, k: int) -> KnownSide:
        """Return the outside of an outer pair."""
        side = self.solver.outer[k]
        end = self._sides.of(side.pair, 1 - side.own)
        spot = self.placed.spot(side.other, end, side.pair.name)
        return KnownSide(spot, self.placed.angle(side.other).plus(end.angle))

    def pin(self, expression: str) -> str:
        """Add the inner pin by an expression; return its name."""
        if not self.letter:
            return self.build.helping_point("Q", self.index, expression)
        return self._noted(self.letter, self.build.point(self.letter, expression))

    def pin_met(self, lines: tuple[str, str]) -> str:
        """Add the inner pin where two lines meet; return its name."""
        return self._met(self.letter, lines)

    def runner_met(self, lines: tuple[str, str]) -> str:
        """Add the second body's point where two lines meet; return its name."""
        return self._met(self.inner[1].letter, lines)

    def _met(self, letter: str, lines: tuple[str, str]) -> str:
        if not letter or letter in self.placed.points:
            return self.build.shape("point", ("Q", self.index), "helper", "Intersect", lines)
        return self._noted(letter, self.build.met(letter, "Intersect", lines))

    def _noted(self, letter: str, name: str) -> str:
        self.placed.points[letter] = name
        return name

    @property
    def letter(self) -> str:
        """The letter of the inner pin."""
        return self.inner[0].letter or self.inner[1].letter

    def angle(self, k: int, text: str) -> Angle:
        """Add the angle of a body; return it. Nothing is added for a body that only stands for a pair."""
        return named(self.build.helper("θ", self.solver.bodies[k].links[0], text))

    def hold(self, k: int, point: str, own: PolarSum, angle: Angle) -> None:
        """Note where a body is, and add its points."""
        self.placed.hold(self.solver.bodies[k], ConstructedBody(point, own, angle))

    def is_real(self, k: int) -> bool:
        """Return whether a body is one of the mechanism, not for a pair."""
        return self.solver.bodies[k] in self.solver.group.bodies

    def beside(self, point: str, way: PolarSum, angle: Angle, stem: str) -> str:
        """Return the point a way off another one, that itself where there is none."""
        if not way.terms:
            return point
        return self.build.helping_point(stem, self.index, at(point).plus(way.turned(angle)).text)


# By the dyads' names.
CONSTRUCTIONS: Mapping[str, Callable[[DyadParts], None]] = {
    one.__name__.upper(): one for one in (rrr, rrp, rpr, prp, rpp)
}


class KnownSide(NamedTuple):
    """The outside of an outer pair: its point, and its direction in the plane."""

    point: str
    angle: Angle
