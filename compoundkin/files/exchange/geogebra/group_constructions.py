"""Groups as constructions: dyads by circles and lines, driven links, gears and trains by angles."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from compoundkin.files.exchange.geogebra.constructed_sides import (
    ConstructedBody,
    InsideBody,
    NamedEnd,
    PairSides,
    PlacedBodies,
    length_of,
    seen_from,
)
from compoundkin.files.exchange.geogebra.dragged_construction import (
    Angle,
    Construction,
    PolarSum,
    along,
    at,
    in_degrees,
    named,
)
from compoundkin.kinematics.groups.contract import GroupSolver
from compoundkin.kinematics.groups.dyad import DyadSolver
from compoundkin.kinematics.groups.pair_sides import Side
from compoundkin.model.pairs import Pair
from compoundkin.structure.mobility_count import Body, DrivenPair

# How far beyond its range rounding takes the cosine of an angle that is flat.
_FLAT = "1E-9"


def rrr(dyad: DyadConstruction) -> None:
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


def rrp(dyad: DyadConstruction) -> None:
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


def rpr(dyad: DyadConstruction) -> None:
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


def prp(dyad: DyadConstruction) -> None:
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


def rpp(dyad: DyadConstruction) -> None:
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


def _line(dyad: DyadConstruction, start: str, angle: Angle, index: str) -> str:
    """Add the line of a guide, or one beside it; return its name."""
    ahead = at(start).plus(along("1", angle)).text
    return dyad.build.shape("line", ("g", f"{dyad.index}{index}"), "guide", "Line", (start, ahead))


class DyadConstruction:
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
CONSTRUCTIONS: Mapping[str, Callable[[DyadConstruction], None]] = {
    one.__name__.upper(): one for one in (rrr, rrp, rpr, prp, rpp)
}


class KnownSide(NamedTuple):
    """The outside of an outer pair: its point, and its direction in the plane."""

    point: str
    angle: Angle


# The angle of a link with full turns counted, as an expression.
Counted = Callable[[str], Angle]


class Mounted(NamedTuple):
    """A body on a lower pair, and the pair that moves it."""

    build: Construction
    placed: PlacedBodies
    sides: PairSides
    mount: Side
    higher: Pair
    counted: Counted

    @property
    def own(self) -> NamedEnd:
        """The body's side of the lower pair, in the axes of its base."""
        end, link = self.sides.of(self.mount.pair, self.mount.own), self.mount.link
        way, angle = self.placed.in_body(link, end.way), self.placed.angle_in_body(link, end.angle)
        return end._replace(way=way, angle=angle)

    @property
    def outside(self) -> NamedEnd:
        """The other side of the lower pair."""
        return self.sides.of(self.mount.pair, 1 - self.mount.own)

    def spot(self) -> str:
        """Return the point of the lower pair's other side."""
        return self.placed.spot(self.mount.other, self.outside, self.mount.pair.name)


def is_constructed(solver: GroupSolver) -> bool:
    """Return whether a group is one body that a pair moves in proportion."""
    pairs = (*solver.group.inner, *solver.group.outer)
    if len(solver.group.bodies) != 1 or len(pairs) != 2 or len(solver.group.links) != 1:
        return False
    lower, higher = sorted(pairs, key=lambda pair: -pair.held)
    return lower.is_simple and (higher.is_geared or _is_rack(lower, higher, solver.group.links[0]))


def _is_rack(lower: Pair, higher: Pair, link: str) -> bool:
    return higher.table == "racks" and lower.free_is_angle == (link == higher.members[1])


def add_mounted(placed: PlacedBodies, sides: PairSides, solver: GroupSolver, counted: Counted) -> None:
    """Add the body of a group of one, and its points."""
    lower, higher = sorted((*solver.group.inner, *solver.group.outer), key=lambda pair: -pair.held)
    own = 0 if lower.members[0] in solver.group.links else 1
    mounted = Mounted(placed.build, placed, sides, Side(lower, own), higher, counted)
    held = _shifted(mounted) if not lower.free_is_angle else _turned(mounted)
    placed.hold(solver.group.bodies[0], held)


def _turned(of: Mounted) -> ConstructedBody:
    """Return a body on a pin: a wheel, a carrier, or the pinion of a rack."""
    text = _pinion(of) if of.higher.table == "racks" else _willis(of)
    angle = named(of.build.helper("θ", of.mount.link, text))
    return ConstructedBody(of.spot(), of.own.way, angle)


def gear_numbers(build: Construction, sides: PairSides, gear: Pair) -> tuple[list[str], str]:
    """Add the sizes and the phase of a gear pair; return their names."""
    ends = [sides.of(gear, k) for k in range(3)]
    sizes = [build.dimension("z", name, abs(end.measure)) for name, end in zip(gear.members[:2], ends[:2], strict=True)]
    build.sizes[gear.name] = tuple(sizes)
    phase = build.dimension("φ", gear.name, in_degrees(ends[2].measure), "where the first is at zero, degrees")
    return sizes, phase


def _willis(of: Mounted) -> str:
    """Return the angle of a wheel or a carrier, by Willis's equation."""
    sizes, phase = gear_numbers(of.build, of.sides, of.higher)
    ends = [of.sides.of(of.higher, k) for k in range(2)]
    alike = ends[0].measure * ends[1].measure < 0
    sign, opposite = ("-", "+") if alike else ("+", "-")
    ratio = f"{sizes[0]} / {sizes[1]}"
    first, second, carrier = of.higher.members
    if of.mount.link == second:
        one, arm = of.counted(first), of.counted(carrier)
        return f"{arm.text} + {phase} {opposite} {ratio} * ({one.minus(arm).text})"
    if of.mount.link == first:
        two, arm = of.counted(second), of.counted(carrier)
        return f"{arm.text} {sign} ({Angle(((1, phase),)).minus(two.minus(arm)).text}) * {sizes[1]} / {sizes[0]}"
    one, two = of.counted(first), of.counted(second)
    return f"({two.text} {sign} {ratio} * ({one.text}) - {phase}) / (1 {sign} {ratio})"


def _pinion(of: Mounted) -> str:
    """Return the angle of a pinion on a rack that is known."""
    line, wheel = of.sides.of(of.higher, 0), of.sides.of(of.higher, 1)
    rack = of.higher.members[0]
    radius, phase = _rack_numbers(of, line, wheel)
    start = of.placed.spot(rack, line, of.higher.name)
    turned = of.placed.angle(rack).plus(line.angle)
    away = of.build.vector(of.higher.name, at(of.spot()).minus(at(start)).text)
    gone = _component(away, turned)
    return f"{of.counted(rack).text} + ({phase} - ({gone})) / {radius} / °"


def _shifted(of: Mounted) -> ConstructedBody:
    """Return a rack on a slide, moved by its pinion."""
    line, wheel = of.sides.of(of.higher, 0), of.sides.of(of.higher, 1)
    pinion = of.higher.members[1]
    way = of.placed.angle(of.mount.other).plus(of.outside.angle)
    angle = way.minus(of.own.angle)
    radius, phase = _rack_numbers(of, line, wheel)
    axis, start = of.placed.spot(pinion, wheel, of.higher.name), of.spot()
    # with the slide at zero: how far the axis is along the pitch line, and how far it ought to be
    gap = at(axis).minus(at(start)).minus(line.way.minus(of.own.way).turned(angle))
    pitch = angle.plus(line.angle)
    gone = _component(of.build.vector(of.higher.name, gap.text), pitch)
    ought = f"{phase} - {radius} * ({of.counted(pinion).minus(angle).text}) * °"
    slope = "" if way == pitch else f" / cos({way.minus(pitch).in_degrees})"
    step = of.build.helper("s", of.mount.pair.name, f"({gone} - ({ought})){slope}")
    place = at(start).plus(along(step, way)).text
    if not of.own.letter:
        moved = of.build.helping_point("Q", of.mount.link, place)
    else:
        moved = of.placed.points[of.own.letter] = of.build.point(of.own.letter, place)
    return ConstructedBody(moved, of.own.way, angle)


def _component(vector: str, angle: Angle) -> str:
    """Return how far a vector goes in a direction, as an expression."""
    if angle.is_zero:
        return f"x({vector})"
    return f"x({vector}) * cos({angle.in_degrees}) + y({vector}) * sin({angle.in_degrees})"


def _rack_numbers(of: Mounted, line: NamedEnd, wheel: NamedEnd) -> tuple[str, str]:
    radius = of.build.dimension("r", of.higher.name, wheel.measure, "pitch radius, negative to the right of the rack")
    of.build.sizes[of.higher.name] = (radius,)
    return radius, of.build.dimension("p", of.higher.name, line.measure, "displacement where the pinion is at zero")


@dataclass(frozen=True)
class Factor:
    """A number as it is written, and its value, to choose divisors by."""

    text: str
    value: float


@dataclass(frozen=True)
class WheelEquation:
    """A sum of angles with factors, and of what is known; it is zero."""

    factors: Mapping[str, Factor]
    known: str


def is_train(solver: GroupSolver) -> bool:
    """Return whether a group is wheels and carriers on as many pins and gears."""
    pins, gears = _pins_and_gears(solver)
    count = len(solver.group.bodies)
    simple = all(pin.is_simple and pin.free_is_angle for pin in pins) and all(gear.is_geared for gear in gears)
    return simple and len(pins) == len(gears) == len(solver.group.links) == count


def add_train(placed: PlacedBodies, sides: PairSides, solver: GroupSolver, counted: Counted) -> None:
    """Add the bodies of a train, one pin after another."""
    pins, gears = _pins_and_gears(solver)
    links = solver.group.links
    equations = [_equation(placed.build, sides, gear, links, counted) for gear in gears]
    angles = _solved(placed.build, equations, links)
    bodies, waiting = {body.links[0]: body for body in solver.group.bodies}, list(links)
    while waiting:
        link, pin, own = next(found for name in waiting for found in _hung(name, pins, waiting))
        other = pin.members[1 - own]
        spot = placed.spot(other, sides.of(pin, 1 - own), pin.name)
        placed.hold(bodies[link], ConstructedBody(spot, sides.of(pin, own).way, named(angles[link])))
        waiting.remove(link)


def _pins_and_gears(solver: GroupSolver) -> tuple[list[Pair], list[Pair]]:
    pairs = (*solver.group.inner, *solver.group.outer)
    return [pair for pair in pairs if pair.held == 2], [pair for pair in pairs if pair.held != 2]


def _hung(link: str, pins: Sequence[Pair], waiting: Sequence[str]) -> list[tuple[str, Pair, int]]:
    """Return the pin by which a link hangs on one that is there, and its side of it."""
    found = [(pin, pin.members.index(link)) for pin in pins if link in pin.members]
    return [(link, pin, own) for pin, own in found if pin.members[1 - own] not in waiting][:1]


def _equation(
    build: Construction, sides: PairSides, gear: Pair, links: Sequence[str], counted: Counted
) -> WheelEquation:
    """Return Willis's equation of a gear pair: second - carrier + ratio (first - carrier) - phase."""
    sizes, phase = gear_numbers(build, sides, gear)
    ends = [sides.of(gear, k).measure for k in range(2)]
    sign, value = ("-" if ends[0] * ends[1] < 0 else ""), ends[0] / ends[1]
    ratio = build.helper("i", gear.name, f"{sign}{sizes[0]} / {sizes[1]}")
    first, second, carrier = gear.members
    all_of = {first: Factor(ratio, value), second: Factor("1", 1.0), carrier: Factor(f"(-1 - {ratio})", -1.0 - value)}
    known = "".join(f" + {f.text} * ({counted(name).text})" for name, f in all_of.items() if name not in links)
    return WheelEquation({name: f for name, f in all_of.items() if name in links}, f"-{phase}{known}")


def _solved(build: Construction, equations: Sequence[WheelEquation], links: Sequence[str]) -> dict[str, str]:
    """Return the angles by their names: each in turn is taken out of the equations that are left."""
    left, taken = list(equations), list[tuple[str, WheelEquation]]()
    for link in links:
        best = max(left, key=lambda equation: abs(equation.factors[link].value) if link in equation.factors else 0.0)
        left = [_without(build, one, best, link) for one in left if one is not best]
        taken.append((link, best))
    angles: dict[str, str] = {}
    for link, equation in reversed(taken):
        others = "".join(f" + {f.text} * {angles[name]}" for name, f in equation.factors.items() if name != link)
        angles[link] = build.helper("θ", link, f"-({equation.known}{others}) / {equation.factors[link].text}")
    return angles


def _without(build: Construction, one: WheelEquation, best: WheelEquation, link: str) -> WheelEquation:
    """Return an equation without one of its angles, by means of another."""
    if link not in one.factors:
        return one
    by, own = best.factors[link], one.factors[link]
    times = Factor(build.helper("k", link, f"{own.text} / {by.text}"), own.value / by.value)
    zero = Factor("0", 0.0)
    factors = {}
    for name in dict.fromkeys([*one.factors, *best.factors]):
        here, there = one.factors.get(name, zero), best.factors.get(name, zero)
        if name != link:
            text = build.helper("k", name, f"{here.text} - {times.text} * {there.text}")
            factors[name] = Factor(text, here.value - times.value * there.value)
    return WheelEquation(factors, build.helper("k", "", f"{one.known} - {times.text} * ({best.known})"))


# From one side of a pair to the other by a value: offset and angle of the second link in the axes of the first.
Step = Callable[[Construction, NamedEnd, NamedEnd, str, int, str], InsideBody]


def turned(build: Construction, own: NamedEnd, other: NamedEnd, value: str, sign: int, pair: str) -> InsideBody:
    """Return a link turned about a pin."""
    angle = Angle(((sign, value),)) if value else Angle()
    return InsideBody(own.way.minus(other.way.turned(angle)), angle)


def shifted(build: Construction, own: NamedEnd, other: NamedEnd, value: str, sign: int, pair: str) -> InsideBody:
    """Return a block moved along its guide, or a guide along its block."""
    angle = own.angle.minus(other.angle)
    step = along(value, own.angle)
    moved = own.way.plus(step, sign)
    return InsideBody(moved.minus(other.way.turned(angle)), angle)


def rolled(build: Construction, own: NamedEnd, other: NamedEnd, value: str, sign: int, pair: str) -> InsideBody:
    """Return a wheel rolled along a line."""
    radius = build.dimension("r", pair, other.measure, "radius of the wheel, negative to the right of its line")
    build.sizes[pair] = (radius,)
    phase = f" - {build.dimension('p', pair, own.measure, 'where the angle is zero')}" if own.measure else ""
    angle = named(build.helper("θ", pair, f"-({value}{phase}) / {radius} / °"))
    middle = own.way.plus(along(value, own.angle)).plus(along(radius, own.angle.plus(Angle(rest=90.0))))
    return InsideBody(middle.minus(other.way.turned(angle)), angle)


def rolled_around(build: Construction, own: NamedEnd, other: NamedEnd, value: str, sign: int, pair: str) -> InsideBody:
    """Return a wheel rolled around a circle, by the direction between their middles."""
    slow, inside = other.measure, other.measure < 0
    radius = build.dimension("r", pair, abs(own.reach / slow), "radius of the wheel")
    circle = build.dimension("R", pair, own.reach + (-1 if not inside else 1) * abs(own.reach / slow), "of the circle")
    phase = build.dimension("p", pair, in_degrees(own.measure), "angle of the wheel at direction zero, degrees")
    sign_of = "-" if inside else "+"
    distance = build.helper("d", pair, f"{circle} {sign_of} {radius}")
    angle = named(build.helper("θ", pair, f"(1 {sign_of} {circle} / {radius}) * {value} + {phase}"))
    build.sizes[pair] = (radius,)
    middle = own.way.plus(along(distance, named(value)))
    return InsideBody(middle.minus(other.way.turned(angle)), angle)


# By the kind's table in a mechanism file; pins are in none.
STEPS: Mapping[str, Step] = {"": turned, "slides": shifted, "rollings": rolled, "circular_rollings": rolled_around}


def is_driven_constructed(driven: DrivenPair) -> bool:
    """Return whether a driven pair can be constructed."""
    if driven.pair.table in ("rollings", "circular_rollings"):
        return driven.link == driven.pair.members[1] and driven.pair.driven_by(driven.drive.link) > 0
    return driven.pair.table in STEPS and len(driven.pair.members) == 2


def inside_body(
    build: Construction, body: Body, sides: PairSides, sliders: Mapping[str, str]
) -> Mapping[str, InsideBody]:
    """Return the links of a body in the axes of its base."""
    found = {body.links[0]: InsideBody(PolarSum(), Angle())}
    for driven in body.driven:
        pair, second = driven.pair, int(driven.link == driven.pair.members[1])
        value = "" if driven.is_passive else sliders[driven.drive.name]
        sign = pair.driven_by(driven.drive.link) * (1 if second else -1)
        own, other = sides.of(pair, 1 - second), sides.of(pair, second)
        step = STEPS[pair.table](build, own, other, value, sign, pair.name)
        parent = found[driven.parent]
        offset = parent.offset.plus(step.offset.turned(parent.angle))
        found[driven.link] = InsideBody(offset, parent.angle.plus(step.angle))
    return found
