"""The format of the Linkage program: XML in files with the suffix `.linkage2`.

Written are connectors and links for every pin, guide, actuator and gear of a drawing.
"""

from __future__ import annotations

from cmath import phase, rect
from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import degrees, floor, log10, pi
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.display import count_phrase
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.content import MOST_BYTES, Content, Problems
from compoundkin.files.exchange.contract import Exported, Imported, Readable, Writable
from compoundkin.files.exchange.drawing import (
    Drawing,
    DrawnArc,
    DrawnDriver,
    DrawnGear,
    DrawnGuideway,
    DrawnPoint,
    drawing_of,
)
from compoundkin.files.exchange.drawn_mechanism import AXIS, GUIDE, mechanism_of
from compoundkin.files.exchange.linkage.linkage_reader import CLOCKWISE, SECONDS, drawing_in
from compoundkin.files.exchange.linkage.linkage_records import (
    MM_PER_INCH,
    PER_INCH,
    WrittenConnector,
    WrittenLink,
    WrittenRatio,
    plain,
)
from compoundkin.files.exchange.posed_mechanism import PosedMechanism
from compoundkin.files.read_values import RPM
from compoundkin.model.geometry import FRAME
from compoundkin.model.units import LENGTHS
from compoundkin.structure import Structure, decompose
from compoundkin.structure.assur_groups import roman

# A drawing between these sizes, in millimetres, is at true size; others have a scale of a power of ten.
_SMALLEST, _LARGEST = 20.0, 2000.0


# Tables of pairs that a drawing has and the program has not, with what they are there.
_UNKNOWN = {"racks": "rack"}


def linkage_text(shown: PosedMechanism) -> tuple[str, list[str]]:
    """Return the text and what is told of it. Raises InvalidInput with all that cannot be said."""
    unsaid = list(_unsaid(shown))
    try:
        drawing = drawing_of(shown)
    except InvalidInput as error:
        unsaid += error.problems
    if unsaid:
        raise InvalidInput(unsaid, heading=f"{shown.mechanism.title!r} cannot be said in Linkage")
    problems = Problems(shown.mechanism.title)
    plan = linkage_layout(shown, drawing, problems)
    problems.raise_if_any()
    unit, scale, factor, notes = _scale(drawing, plan.size)
    lines = ["<linkage2>"]
    view = f'zoom="1" xoffset="0" yoffset="0" scalefactor="{plain(factor)}" units="{unit}"'
    lines.append(f"\t<program {view}/>")
    lines += [line for one in plan.connectors for line in one.lines(scale)]
    lines += [line for link in (*plan.links.values(), *plan.extra) for line in link.lines(scale)]
    lines += ["\t<selected>", "\t</selected>"]
    if plan.ratios:
        inside = [f"\t{line}" for ratio in plan.ratios for line in ratio.lines(scale)]
        lines += ["\t<ratios>", *inside, "\t</ratios>"]
    return "\n".join([*lines, "</linkage2>", ""]), [*notes, *plan.notes, *_dropped(drawing)]


def _unsaid(shown: PosedMechanism) -> Iterator[Problem]:
    """Find rings, crossed belts and racks."""
    for where, pair in shown.mechanism.placed_pairs:
        ring = pair.table == "gears" and getattr(pair, "internal", False)
        crossed = pair.table == "belts" and getattr(pair, "crossed", False)
        what = "ring" if ring else "crossed belt" if crossed else _UNKNOWN.get(pair.table)
        if what:
            yield Problem(where, f"{pair.name!r} is a {what}, which Linkage does not have")


def _scale(drawing: Drawing, size: float) -> tuple[str, float, float, list[str]]:
    """Return the unit, how many of the file's lengths are one of the drawing, the scale factor, and what is told."""
    metres = LENGTHS.get(drawing.unit, LENGTHS["mm"])
    inches = drawing.unit in ("in", "ft")
    shown = metres / LENGTHS["in" if inches else "mm"]
    notes = []
    if drawing.unit not in ("mm", "in"):
        there = "in" if inches else "mm"
        said = f"1 {drawing.unit}" if drawing.unit else "lengths have no unit: 1"
        notes.append(f"{said} is {shown:g} {there} there")
    mm = size * shown * (MM_PER_INCH if inches else 1.0)
    factor = 1.0 if _SMALLEST <= mm <= _LARGEST else 10.0 ** floor(log10(mm / 2.0 / _SMALLEST))
    return (
        ("Inches" if inches else "Millimeters"),
        shown * PER_INCH / (1.0 if inches else MM_PER_INCH) / factor,
        factor,
        notes,
    )


def _dropped(drawing: Drawing) -> Iterator[str]:
    """Yield the note that counts what has no place in the file."""
    many = (*drawing.dropped, ("mass", len(drawing.masses)), ("force", len(drawing.forces)))
    said = [count_phrase(number, what, "masses" if what == "mass" else "") for what, number in many if number]
    if said:
        yield f"left out, for Linkage has no place for it: {', '.join(said)}"


def linkage_layout(shown: PosedMechanism, drawing: Drawing, problems: Problems) -> LinkagePlan:
    """Return a mechanism's elements. What they cannot say is added to the problems."""
    plan = LinkagePlan(shown, drawing, problems)
    rams, blocks = rams_of(plan), blocks_of(plan)
    guides = {guide.key: guide for guide in drawing.guides}
    lengths = {driver.at: driver for driver in drawing.drivers if driver.at in guides}
    turns: dict[str, list[DrawnDriver]] = {}
    for driver in drawing.drivers:
        if driver.at not in lengths:
            turns.setdefault(driver.at, []).append(driver)
    plan.lay_out(turns)
    for key, guide in guides.items():
        if key not in rams:
            _write_guide(plan, guide, blocks.get(key), lengths.get(key))
    for key, ends in rams.items():
        barrel, rod = (plan.of(end, _any_link(plan, end)) for end in ends)
        write_actuator(plan, lengths[key], guides[key].on, (barrel, rod))
    for arc in drawing.arcs:
        write_arc(plan, arc)
    write_gears(plan)
    for key in drawing.outputs:
        plan.of(key, _any_link(plan, key)).draw = True
    _hold_lone_anchors(plan)
    return plan


def _write_guide(plan: LinkagePlan, guide: DrawnGuideway, block: PinSlot | None, driver: DrawnDriver | None) -> None:
    """Write a slide or a slot, and the actuator that drives it."""
    on, sense = (block.on, block.sense) if block else (guide.on, 1.0)
    if block:
        moving = write_slot(plan, guide, block.pin, _any_link(plan, block.pin), on)
    elif guide.kind == "slot":
        moving = write_slot(plan, guide, guide.at, guide.link, on)
    else:
        moving = write_slide(plan, guide)
    if driver:
        write_actuator(plan, driver, f"{driver.link} actuator", actuator_ends(plan, guide, moving, on, driver, sense))


def _any_link(plan: LinkagePlan, point: str) -> str:
    """Return a link that is written and has a point."""
    links = next(one.links for one in plan.drawing.points if one.key == point)
    return next(link for link in links if link not in plan.gone)


def _hold_lone_anchors(plan: LinkagePlan) -> None:
    """Give anchors that are in no link one of their own: every connector there is in a link."""
    held = {id_ for link in (*plan.links.values(), *plan.extra) for id_ in link.connectors}
    for one in plan.connectors:
        if one.id not in held:
            plan.link([one.id])


# An end of a range is the pose written that is nearer to it than this part of the range.
_AT_REST = 1e-9


class LinkagePlan:
    """Elements as far as they are laid out. `links` are in the order of the file, by their keys.

    `gone` are links that others stand for: blocks, barrels and rods.
    """

    def __init__(self, shown: PosedMechanism, drawing: Drawing, problems: Problems) -> None:
        self.shown, self.drawing, self.problems = shown, drawing, problems
        self.size = shown.mechanism.geometry.size
        self.connectors: list[WrittenConnector] = []
        self.links: dict[str, WrittenLink] = {}
        self.extra: list[WrittenLink] = []
        self.ratios: list[WrittenRatio] = []
        self.notes: list[str] = []
        self.gone: set[str] = set()
        self._held: dict[tuple[str, str], WrittenConnector] = {}
        self._frame_links: dict[tuple[int, ...], WrittenLink] = {}

    def lay_out(self, drivers: dict[str, list[DrawnDriver]]) -> None:
        """Make the links, and a connector for each point. Links that are driven have their own."""
        for key in _in_order(self.drawing):
            if key not in self.gone and key != FRAME:
                self.links[key] = WrittenLink(len(self.links), name=self.drawing_name(key))
        for point in self.drawing.points:
            links = [link for link in point.links if link not in self.gone]
            for driver in drivers.get(point.key, ()):
                self._drive(point, driver, links)
            if links:
                self._hold(point.key, self.connector(point.at, links, point.called), links)

    def connector(self, at: complex, links: list[str], name: str = "") -> WrittenConnector:
        """Make a connector of some links; one of the frame is an anchor."""
        made = WrittenConnector(len(self.connectors), at, name, FRAME in links)
        self.connectors.append(made)
        for link in self.links:
            if link in links:
                self.links[link].connectors.append(made.id)
        return made

    def link(self, connectors: list[int], name: str = "") -> WrittenLink:
        """Make a link that the mechanism does not have."""
        made = WrittenLink(len(self.links) + len(self.extra), connectors, name)
        self.extra.append(made)
        return made

    def of(self, point: str, link: str) -> WrittenConnector:
        """Return the connector that stands for a point of a link."""
        return self._held[point, link]

    def frame_link(self, *connectors: int) -> WrittenLink:
        """Return a link of anchors. Limits and wheels that are fixed need one there."""
        found = self._frame_links.get(connectors)
        if found is None:
            found = self._frame_links[connectors] = self.link([*connectors])
        return found

    def drawing_name(self, key: str) -> str:
        """Return what a link is called."""
        return next(link.called for link in self.drawing.links if link.key == key)

    def places(self, link: str, on: str, at: complex) -> np.ndarray:
        """Return where a place of one link goes on another over the motion."""
        motion, poses = self.shown.motion, self.shown.poses
        if motion is None:
            return np.array([at])
        here = (at - poses[link].z.c[0]) / poses[link].u.c[0]
        with np.errstate(invalid="ignore"):  # poses that cannot be assembled are NaN
            way = np.ravel(motion.poses[link].at(complex(here)).c[0])
            place = (way - np.ravel(motion.poses[on].z.c[0])) / np.ravel(motion.poses[on].u.c[0])
            found = np.ravel(poses[on].at(place).c[0])
        found = found[np.isfinite(found)]
        return found if found.size else np.array([at])

    def _hold(self, point: str, made: WrittenConnector, links: list[str]) -> None:
        for link in links:
            self._held.setdefault((point, link), made)

    def _drive(self, point: DrawnPoint, driver: DrawnDriver, links: list[str]) -> None:
        """Make a connector for two links at a pin that is driven; those beside them do not turn with them."""
        turned = driver if driver.link != FRAME else _reversed(driver)
        made = self.connector(point.at, [turned.on, turned.link], point.called)
        made.rpm = CLOCKWISE * (turned.speed or 0.0) / RPM
        self._hold(point.key, made, [turned.link])
        links.remove(turned.link)
        if links == [turned.on]:
            self._hold(point.key, made, [turned.on])
            links.clear()
        if turned.travel is not None:
            low, high = turned.travel
            start, end = (low, high) if (turned.speed or 0.0) > 0 else (high, low)
            if abs(start) <= _AT_REST * abs(end):
                made.range = degrees(abs(end))
            else:
                self.notes.append(f"{driver.link} makes full turns there: its range does not begin at the pose written")


def _reversed(driver: DrawnDriver) -> DrawnDriver:
    """Return a driver that turns the frame as one that turns the link against it."""
    travel = None if driver.travel is None else (-driver.travel[1], -driver.travel[0])
    return replace(driver, link=driver.on, on=FRAME, speed=-(driver.speed or 0.0), travel=travel)


def _in_order(drawing: Drawing) -> list[str]:
    """Return the keys of the links, those before others that are driven against them."""
    keys = [link.key for link in drawing.links]
    for _ in drawing.drivers:
        for driver in drawing.drivers:
            one, two = keys.index(driver.on), keys.index(driver.link)
            if one > two:
                keys.insert(two, keys.pop(one))
    return keys


# A place is on a line, an end at a pose, that is nearer to it than this part of the size.
CLOSE = 1e-9


@dataclass(frozen=True)
class PinSlot:
    """A pin that stands for a block. `sense` is -1 where it runs against the guide's direction."""

    pin: str
    on: str
    sense: float


def blocks_of(plan: LinkagePlan) -> dict[str, PinSlot]:
    """Return the guides whose block only holds a pin. These links are gone."""
    found: dict[str, PinSlot] = {}
    taken: set[str] = set()
    for guide in plan.drawing.guides:
        for block, other, sense in ((guide.link, guide.on, 1.0), (guide.on, guide.link, -1.0)):
            pin = _only_pin(plan, guide, block)
            if guide.kind == "slide" and pin is not None and other not in pin.links and pin.key not in taken:
                found[guide.key] = PinSlot(pin.key, other, sense)
                taken.add(pin.key)
                plan.gone.add(block)
                break
    return found


def _only_pin(plan: LinkagePlan, guide: DrawnGuideway, link: str) -> DrawnPoint | None:
    """Return the one pin of a link that is nothing but a block. Points that reading adds to a block do not count."""
    wanted = any(name.partition(".")[0] == link for name in plan.shown.mechanism.outputs)
    if link == FRAME or link in plan.gone or wanted or _roles(plan.drawing, link, guide.key) != 1:
        return None
    own = list(plan.drawing.points_of(link))
    pins = [point for point in own if len(set(point.links) - plan.gone) > 1]
    further = [point for point in own if point not in pins and not _is_added(point.key)]
    return pins[0] if len(pins) == 1 and not further else None


def _is_added(letter: str) -> bool:
    """Return whether a letter is one that reading gives to a link for its direction."""
    return letter.endswith((f" {AXIS}", f" {GUIDE}"))


def _roles(drawing: Drawing, link: str, guide: str) -> int:
    """Count the pairs and drivers that need a link; the driver of its own guide does not."""
    guided = sum(link in (one.link, one.on) for one in drawing.guides)
    guided += sum(link in (one.link, one.on) for one in drawing.arcs)
    geared = sum(link in (one.first, one.second, one.carrier) for one in drawing.gears)
    return guided + geared + sum(link in (one.link, one.on) and one.at != guide for one in drawing.drivers)


def rams_of(plan: LinkagePlan) -> dict[str, tuple[str, str]]:
    """Return the driven slides between two pins, with these. Barrel and rod are gone."""
    found = {}
    for driver in plan.drawing.drivers:
        guide = next((one for one in plan.drawing.guides if one.key == driver.at), None)
        if guide is None or {guide.link, guide.on} & plan.gone:
            continue
        ends = [_only_pin(plan, guide, link) for link in (guide.on, guide.link)]
        if ends[0] is None or ends[1] is None or abs(ends[1].at - ends[0].at) <= CLOSE * plan.size:
            continue
        across = (rect(1.0, -guide.angle) * (ends[1].at - ends[0].at)).imag
        if abs(across) <= CLOSE * plan.size:
            found[guide.key] = (ends[0].key, ends[1].key)
            plan.gone |= {guide.link, guide.on}
    return found


# How far limits are beyond what the motion needs, and sliders of one link from each other, as parts of the size.
BEYOND, APART = 0.05, 0.2


# A circular slot of more than half a turn is a bar: that of the program is the smaller arc between its limits.
_MOST_OF_TURN = 0.45 * pi


def write_slot(plan: LinkagePlan, guide: DrawnGuideway, pin: str, link: str, on: str) -> WrittenConnector:
    """Write a pin of a link that runs on another, along the guide."""
    made = plan.of(pin, link)
    if made.limits:  # one connector is in one slot; a second one at its place is in the other
        made = plan.connector(made.at, [link])
    _run(plan, guide, [made], link, on)
    return made


def write_slide(plan: LinkagePlan, guide: DrawnGuideway) -> WrittenConnector:
    """Write a link that slides on another. Two of its connectors run in one line."""
    first = plan.of(guide.at, guide.link)
    if first.limits:
        first = plan.connector(first.at, [guide.link])
    second = plan.connector(first.at + rect(APART * plan.size, guide.angle), [guide.link])
    _run(plan, guide, [first, second], guide.link, guide.on)
    return first


def _run(plan: LinkagePlan, guide: DrawnGuideway, made: list[WrittenConnector], link: str, on: str) -> None:
    """Let connectors of one link run between limits that another has, as far as the motion needs."""
    along = rect(1.0, guide.angle)
    ways = [((plan.places(link, on, one.at) - made[0].at) / along).real for one in made]
    low, high = (float(end) for end in (np.min(np.concatenate(ways)), np.max(np.concatenate(ways))))
    limits = _own_ends(plan, guide, made, on, (low, high)) if guide.ends else ()
    if not limits:
        beyond = BEYOND * plan.size
        ends = (made[0].at + (low - beyond) * along, made[0].at + (high + beyond) * along)
        limits = tuple(plan.connector(end, [on]).id for end in ends)
        if on == FRAME:
            plan.frame_link(*limits)
    for one in made:
        one.limits = limits


def _own_ends(
    plan: LinkagePlan, guide: DrawnGuideway, made: list[WrittenConnector], on: str, way: tuple[float, float]
) -> tuple[int, ...]:
    """Return the two points by which the guide is given, where the motion stays between them."""
    assert guide.ends is not None
    if on != guide.on:
        return ()
    found = [plan.of(end, on) for end in guide.ends]
    along = rect(1.0, guide.angle)
    one, two = ((end.at - made[0].at) / along for end in found)
    near = CLOSE * plan.size
    if (
        abs(one.imag) > near
        or abs(two.imag) > near
        or min(one.real, two.real) > way[0]
        or max(one.real, two.real) < way[1]
    ):
        return ()
    if on == FRAME:
        plan.frame_link(*(end.id for end in found))
    return tuple(end.id for end in found)


def write_arc(plan: LinkagePlan, arc: DrawnArc) -> None:
    """Write a circular slot. One of more than half a turn becomes a bar."""
    made = plan.of(arc.at, arc.link)
    places = plan.places(arc.link, arc.on, made.at) - arc.centre
    middle = phase(np.mean(places) or 1.0)
    reach = float(np.max(np.abs(np.angle(places * rect(1.0, -middle))))) + BEYOND * pi
    if reach > _MOST_OF_TURN:
        centre = plan.connector(arc.centre, [arc.on])
        plan.link([centre.id, made.id], f"{arc.key} bar")
        plan.notes.append(f"{arc.key} is written as a bar to its centre: it is run through for more than half a turn")
        return
    if made.limits:
        made = plan.connector(made.at, [arc.link])
    ends = [arc.centre + rect(arc.radius, middle + side * reach) for side in (-1.0, 1.0)]
    made.limits, made.radius = tuple(plan.connector(end, [arc.on]).id for end in ends), arc.radius
    if arc.on == FRAME:
        plan.frame_link(*made.limits)


def write_actuator(
    plan: LinkagePlan, driver: DrawnDriver, name: str, ends: tuple[WrittenConnector, WrittenConnector]
) -> None:
    """Write a link between two connectors that becomes longer or shorter."""
    low, high = driver.travel or (0.0, BEYOND * plan.size)
    if driver.travel is None:
        plan.notes.append(f"{driver.link} has no range to be driven over: it goes {high:.4g} there")
    near = CLOSE * plan.size
    ahead = high >= -low if min(high, -low) <= near else (driver.speed or 0.0) >= 0
    made = plan.link([one.id for one in ends], driver.name or name)
    made.throw = high if ahead else -low
    if min(high, -low) > near:
        kept, lost = ("longest", "shortest") if ahead else ("shortest", "longest")
        plan.notes.append(f"{driver.link} goes from the pose written to its {kept} there, not to its {lost}")
    made.cpm = (1.0 if ahead else -1.0) * abs(driver.speed or 0.0) * SECONDS / (2.0 * made.throw)


def actuator_ends(
    plan: LinkagePlan, guide: DrawnGuideway, moving: WrittenConnector, on: str, driver: DrawnDriver, sense: float
) -> tuple[WrittenConnector, WrittenConnector]:
    """Return a connector behind a slide, and the slide's own. The length between them stays positive."""
    low = min(driver.travel[0] if driver.travel else 0.0, 0.0)
    behind = moving.at + sense * rect(low - APART * plan.size, guide.angle)
    return plan.connector(behind, [on]), moving


_KINDS = {"gears": "gears", "belt": "chain"}


def write_gears(plan: LinkagePlan) -> None:
    """Write the wheels and their ratios. A carrier must turn freely at both axes."""
    wheels: dict[tuple[str, str], WrittenLink] = {}
    for gear in plan.drawing.gears:
        sides = ((gear.first, gear.first_at), (gear.second, gear.second_at))
        if not all(_is_carried(plan, gear, link, at) for link, at in sides):
            continue
        ids = []
        for side in sides:
            if side not in wheels:
                wheels[side] = _wheel(plan, *side)
            ids.append(wheels[side].id)
        by_size = gear.kind == "belt" and not gear.in_teeth
        plan.ratios.append(WrittenRatio(_KINDS[gear.kind], (ids[0], ids[1]), gear.sizes, by_size))


def _is_carried(plan: LinkagePlan, gear: DrawnGear, link: str, at: str) -> bool:
    """Return whether a wheel has its axis in common with the carrier: not where it or the carrier is driven there."""
    made = plan.of(at, link)
    shared = made.anchor if gear.carrier == FRAME else made.id in plan.links[gear.carrier].connectors
    if not shared:
        what = f"{link!r} turns at {at!r} beside its carrier {gear.carrier!r}, of which one is driven there"
        plan.problems.add(f"gears.{gear.key}", what, "Linkage turns all links at an input together")
    return shared


def _wheel(plan: LinkagePlan, link: str, at: str) -> WrittenLink:
    """Return a wheel about an axis: the link itself where it is nothing else, or one fastened to it."""
    axis = plan.of(at, link).id
    if link != FRAME and plan.links[link].connectors == [axis] and not plan.links[link].gear:
        plan.links[link].gear = True
        return plan.links[link]
    made = plan.link([axis])
    made.gear = True
    made.fastened = _fixed(plan, axis) if link == FRAME else plan.links[link].id
    return made


def _fixed(plan: LinkagePlan, axis: int) -> int:
    """Return a link of two anchors, one of them an axis."""
    place = plan.connectors[axis].at
    other = next((one for one in plan.connectors if one.anchor and abs(one.at - place) > 1e-6 * plan.size), None)
    if other is None:
        other = plan.connector(place + plan.size, [FRAME])
    return plan.frame_link(axis, other.id).id


# The highest class of group that the program's own solver knows.
DYADS = 2


class LinkageFormat(Readable, Writable):
    """Files of the Linkage program, which solves dyads only."""

    # they may have a picture in the background
    most: ClassVar[int] = MOST_BYTES

    name: ClassVar[str] = "linkage"
    program: ClassVar[str] = "Linkage"
    title: ClassVar[str] = "Linkage file (.linkage2)"
    suffix: ClassVar[str] = ".linkage2"

    def recognises(self, content: Content) -> bool:
        """Return whether it begins as XML with an element `linkage2`, or nearly."""
        return content.head.startswith("<") and "<linkage" in content.head

    def read(self, content: Content) -> Imported:
        """Return the mechanism, and what the program could not make of it."""
        drawing, hints = drawing_in(content)
        found = mechanism_of(drawing, self.name, content.where)
        return replace(found, notes=(*found.notes, *_of_structure(found, hints)))

    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
        """Return the file. Raises InvalidInput listing all that it cannot say."""
        text, notes = linkage_text(shown)
        return Exported(text.encode(), self.name, (*notes, *_beyond_dyads(shown.structure)))


def _of_structure(found: Imported, hints: str) -> Iterator[str]:
    """Yield what is told of the structure: groups that the program cannot simulate, freedoms that nothing drives."""
    structure = decompose(found.mechanism)
    yield from _beyond_dyads(structure)
    if not found.mechanism.drives:
        yield "nothing drives it: no connector is an input, no link an actuator"
    if hints and structure.faults:
        yield hints


def _beyond_dyads(structure: Structure) -> Iterator[str]:
    """Yield which groups the program's own solver does not know."""
    for group in structure.groups:
        if group.class_ > DYADS:
            links = ", ".join(group.links)
            yield (
                f"Linkage cannot simulate it: {links} are an Assur group of class {roman(group.class_)}"
                f" ({group.name}), and its solver knows dyads only; here all its configurations are found"
            )


FORMAT = LinkageFormat()
