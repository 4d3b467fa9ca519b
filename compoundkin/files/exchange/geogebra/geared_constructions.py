"""One wheel, carrier or rack that a gear pair, a belt or a rack moves in proportion."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from compoundkin.files.exchange.geogebra.dragged_construction import Construction
from compoundkin.files.exchange.geogebra.pair_sides import NamedEnd, PairSides
from compoundkin.files.exchange.geogebra.placed_bodies import Held, PlacedBodies
from compoundkin.files.exchange.geogebra.polar_sums import Angle, along, at, in_degrees, named
from compoundkin.kinematics.groups.contract import GroupSolver
from compoundkin.kinematics.groups.pair_sides import Side
from compoundkin.model.pairs import Pair

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
    return lower.is_simple and (higher.table in ("gears", "belts") or _is_rack(lower, higher, solver.group.links[0]))


def _is_rack(lower: Pair, higher: Pair, link: str) -> bool:
    return higher.table == "racks" and lower.free_is_angle == (link == higher.members[1])


def add_mounted(placed: PlacedBodies, sides: PairSides, solver: GroupSolver, counted: Counted) -> None:
    """Add the body of a group of one, and its points."""
    lower, higher = sorted((*solver.group.inner, *solver.group.outer), key=lambda pair: -pair.held)
    own = 0 if lower.members[0] in solver.group.links else 1
    mounted = Mounted(placed.build, placed, sides, Side(lower, own), higher, counted)
    held = _shifted(mounted) if not lower.free_is_angle else _turned(mounted)
    placed.hold(solver.group.bodies[0], held)


def _turned(of: Mounted) -> Held:
    """Return a body on a pin: a wheel, a carrier, or the pinion of a rack."""
    text = _pinion(of) if of.higher.table == "racks" else _willis(of)
    angle = named(of.build.helper("θ", of.mount.link, text))
    return Held(of.spot(), of.own.way, angle)


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


def _shifted(of: Mounted) -> Held:
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
    return Held(moved, of.own.way, angle)


def _component(vector: str, angle: Angle) -> str:
    """Return how far a vector goes in a direction, as an expression."""
    if angle.is_zero:
        return f"x({vector})"
    return f"x({vector}) * cos({angle.in_degrees}) + y({vector}) * sin({angle.in_degrees})"


def _rack_numbers(of: Mounted, line: NamedEnd, wheel: NamedEnd) -> tuple[str, str]:
    radius = of.build.dimension("r", of.higher.name, wheel.measure, "pitch radius, negative to the right of the rack")
    of.build.sizes[of.higher.name] = (radius,)
    return radius, of.build.dimension("p", of.higher.name, line.measure, "displacement where the pinion is at zero")
