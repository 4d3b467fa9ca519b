"""Driven links: each from its parent by the value of a slider."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from compoundkin.files.exchange.geogebra.dragged_construction import Construction
from compoundkin.files.exchange.geogebra.pair_sides import NamedEnd, PairSides
from compoundkin.files.exchange.geogebra.placed_bodies import InsideBody
from compoundkin.files.exchange.geogebra.polar_sums import Angle, Way, along, in_degrees, named
from compoundkin.structure.mobility_count import Body, DrivenPair

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


def is_constructed(driven: DrivenPair) -> bool:
    """Return whether a driven pair can be constructed."""
    if driven.pair.table in ("rollings", "circular_rollings"):
        return driven.link == driven.pair.members[1] and driven.pair.driven_by(driven.drive.link) > 0
    return driven.pair.table in STEPS and len(driven.pair.members) == 2


def inside_body(
    build: Construction, body: Body, sides: PairSides, sliders: Mapping[str, str]
) -> Mapping[str, InsideBody]:
    """Return the links of a body in the axes of its base."""
    found = {body.links[0]: InsideBody(Way(), Angle())}
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
