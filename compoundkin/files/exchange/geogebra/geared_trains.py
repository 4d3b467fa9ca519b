"""Several wheels and carriers whose angles only all their gear pairs together give: linear equations in the angles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from compoundkin.files.exchange.geogebra.dragged_construction import Construction
from compoundkin.files.exchange.geogebra.geared_constructions import Counted, gear_numbers
from compoundkin.files.exchange.geogebra.pair_sides import PairSides
from compoundkin.files.exchange.geogebra.placed_bodies import Held, PlacedBodies
from compoundkin.files.exchange.geogebra.polar_sums import named
from compoundkin.kinematics.groups.contract import GroupSolver
from compoundkin.model.pairs import Pair


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
    simple = all(pin.is_simple and pin.free_is_angle for pin in pins) and all(g.table in _GEARED for g in gears)
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
        placed.hold(bodies[link], Held(spot, sides.of(pin, own).way, named(angles[link])))
        waiting.remove(link)


_GEARED = ("gears", "belts")


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
