"""The reader of .linkage2 files: sliders as guides, inputs and actuators as drivers, gears, into a drawing."""

from __future__ import annotations

from cmath import phase
from collections.abc import Iterator
from dataclasses import dataclass
from math import radians, sqrt
from typing import NamedTuple

from compoundkin.base.display import abbreviated_list
from compoundkin.base.errors import InvalidInput
from compoundkin.files.exchange.content import Content, Problems, xml_tree
from compoundkin.files.exchange.drawing import Drawing, DrawnArc, DrawnDriver, DrawnGear, DrawnGuideway, DrawnPoint
from compoundkin.files.exchange.drawn_mechanism import AXIS, MOST, SAME, size_around
from compoundkin.files.exchange.linkage.linkage_links import ConnectorPoints, JoinedLinks, hint, rod, unjoined
from compoundkin.files.exchange.linkage.linkage_records import (
    LinkageConnector,
    LinkageLink,
    LinkageRatio,
    linkage_file,
    unknown_attributes,
)
from compoundkin.files.read_values import RPM
from compoundkin.model.geometry import FRAME

# More notes of one kind are counted.
_MOST_NOTES = 8


def drawing_in(content: Content) -> tuple[Drawing, str]:
    """Return the drawing in a file, and a hint.

    The hint names connectors that may be meant to be joined. Raises InvalidInput with all that is wrong.
    """
    problems = Problems(content.where)
    joined = _joined(content, problems)
    file = joined.file
    size = size_around([one.at for one in file.connectors.values()])
    points = ConnectorPoints(joined)
    sliders, gears = sliders_of(joined), tuple(gears_of(points))
    actuators = list(actuators_of(points))
    guides = (*guides_of(sliders, points, size), *(one.guide for one in actuators))
    drivers = (*inputs_of(points), *(one.driver for one in actuators))
    hints = hint(list(unjoined(joined, size)))
    _find_floating(joined, sliders, guides, gears, hints)
    problems.raise_if_any()
    drawing = Drawing(
        content.name or "Linkage",
        tuple(joined.drawn),
        (*points.drawn, *(one.mouth for one in actuators)),
        guides,
        tuple(arcs_of(sliders, points)),
        gears,
        drivers=drivers,
        outputs=points.outputs,
        unit=file.unit,
        source="a file of the Linkage program",
        notes=(*_few(file.notes), *_few(joined.notes), *limit_notes(sliders, file.unit, size)),
        dropped=tuple(file.dropped.items()),
    )
    return drawing, hints


def _joined(content: Content, problems: Problems) -> JoinedLinks:
    """Return the links in a file. Raises InvalidInput where they are more than can be looked at."""
    text, told = _text(content)
    root = xml_tree(text, content.where)
    file = linkage_file(root, problems)
    file.notes += [*told, *unknown_attributes(root)]
    if len(file.connectors) + len(file.links) > MOST:
        problems.add("", f"it has more than {MOST} connectors and links", "look whether it is the right file")
        problems.raise_if_any()
    return JoinedLinks(file, problems)


def _text(content: Content) -> tuple[str, list[str]]:
    """Return the text, of old files by the code page of their time, and what is told of that."""
    try:
        return content.text, []
    except InvalidInput:
        if not content.is_text:
            raise
    return content.raw.decode("cp1252", "replace"), ["it is not UTF-8: its names are read as Windows-1252"]


def _few(notes: list[str]) -> list[str]:
    """Return some notes, and how many more there are."""
    return (
        notes if len(notes) <= _MOST_NOTES else [*notes[:_MOST_NOTES], f"and {len(notes) - _MOST_NOTES} more like this"]
    )


def _find_floating(
    joined: JoinedLinks,
    sliders: list[Slider],
    guides: tuple[DrawnGuideway, ...],
    gears: tuple[DrawnGear, ...],
    hints: str,
) -> None:
    """Note links that nothing joins to the frame, even by others."""
    met = [set(joined.at(id_)) for id_ in joined.file.connectors]
    met += [{*slider.bodies, slider.on} for slider in sliders]
    met += [{guide.link, guide.on} for guide in guides] + [{gear.first, gear.second, gear.carrier} for gear in gears]
    reached = _reached(met)
    if not any(one.anchor for one in joined.file.connectors.values()):
        joined.problems.add("", "no connector is an anchor: nothing is fixed", "make the fixed connectors anchors")
        return
    for link in joined.drawn:
        if link.key not in reached:
            what = f"{link.called} floats: nothing joins it to the anchors"
            joined.problems.add(link.where, what, hints or "pin it to a link")


def _reached(met: list[set[str]]) -> set[str]:
    """Return the bodies that hang together with the frame."""
    meets: dict[str, list[int]] = {}
    for k, bodies in enumerate(met):
        for body in bodies:
            meets.setdefault(body, []).append(k)
    reached, waiting = {FRAME}, [FRAME]
    while waiting:
        for k in meets.pop(waiting.pop(), ()):
            waiting += met[k] - reached
            reached |= met[k]
    return reached


# Lines are one, and pins are on them, that differ by less than this part of the size: the program keeps six decimals
# of 1/96 inch, and what is moved by hand snaps.
ONE_LINE = 1e-5


# Two pins hold a direction that are not one above the other, seen along their line.
_ALONG = 0.05


@dataclass(frozen=True)
class Slider:
    """A connector that runs between two others, on a body that they share."""

    connector: LinkageConnector
    bodies: tuple[str, ...]
    on: str
    limits: tuple[LinkageConnector, LinkageConnector]

    @property
    def along(self) -> complex:
        """The way from limit to limit."""
        return self.limits[1].at - self.limits[0].at

    @property
    def direction(self) -> complex:
        """The direction of the line."""
        return self.along / abs(self.along)

    def off(self, at: complex) -> float:
        """Return how far a place is from the line."""
        return abs(((at - self.limits[0].at) / self.direction).imag)

    @property
    def centre(self) -> complex:
        """The centre of a circular slot. It is left of the way between the limits, if its radius is positive."""
        half = abs(self.along) / 2.0
        height = sqrt(max(self.radius**2 - half**2, 0.0))
        side = 1.0 if self.connector.radius > 0 else -1.0
        return self.limits[0].at + self.along / 2.0 + side * 1j * self.direction * height

    @property
    def radius(self) -> float:
        """The radius of a circular slot, at least half the way between the limits."""
        return max(abs(self.connector.radius), abs(self.along) / 2.0)


def sliders_of(joined: JoinedLinks) -> list[Slider]:
    """Return the sliders that hold something. What is wrong with them is noted."""
    found = (_slider(one, joined) for one in joined.file.connectors.values() if one.slider)
    return [slider for slider in found if slider is not None]


def _slider(one: LinkageConnector, joined: JoinedLinks) -> Slider | None:
    problems, known = joined.problems, joined.file.connectors
    for id_ in one.limits:
        if id_ not in known and id_ is not None:
            problems.add(one.where, f"slidelimit {id_} is not there", "name two connectors of one link")
    if len(one.limits) != 2:
        what = f"it is a slider with {len(one.limits)} slide limits"
        problems.add(one.where, what, "name the two connectors that it slides between")
    limits = [known[id_] for id_ in one.limits if id_ in known]
    if len(limits) != 2 or len(one.limits) != 2:
        return None
    if limits[0].at == limits[1].at or one.id in (limits[0].id, limits[1].id):
        problems.add(one.where, "its slide limits are no two places beside it", "name two other connectors")
        return None
    bodies = joined.at(one.id)
    shared = [body for body in joined.at(limits[0].id) if body in joined.at(limits[1].id)]
    carriers = [body for body in shared if body not in bodies]
    if FRAME in bodies and FRAME in shared:
        joined.file.drop("slider of a fixed pin")
    elif bodies and not carriers:
        said = f"{limits[0].id} and {limits[1].id}"
        what = f"it is of the link that holds its slide limits {said}" if shared else f"no link holds both {said}"
        problems.add(one.where, f"it is a slider, but {what}", "let it slide on one other link")
    usable = bodies and carriers and not (FRAME in bodies and FRAME in shared)
    return Slider(one, bodies, carriers[0], (limits[0], limits[1])) if usable else None


def guides_of(sliders: list[Slider], points: ConnectorPoints, size: float) -> Iterator[DrawnGuideway]:
    """Yield slots and slides. Two sliders of one link in one line of another are a slide."""
    straight = [slider for slider in sliders if not slider.connector.radius]
    sliding: list[Slider] = []
    held: set[int] = set()
    for one in straight:
        if one.connector.id in held or any(_is_slide(other, one, size) for other in sliding):
            continue
        second = next((two for two in straight if two is not one and _is_slide(one, two, size)), None)
        if second is None:
            yield _guide(one, one.bodies[0], "slot", points, size)
            continue
        sliding.append(one)
        held.add(second.connector.id)
        yield _guide(one, _common(one, second)[0], "slide", points, size)


def arcs_of(sliders: list[Slider], points: ConnectorPoints) -> Iterator[DrawnArc]:
    """Yield circular slots."""
    for one in sliders:
        if one.connector.radius:
            key, at = f"slider {one.connector.id}", points.key(one.connector.id)
            yield DrawnArc(key, one.bodies[0], one.on, at, one.centre, one.radius, where=one.connector.where)


def limit_notes(sliders: list[Slider], unit: str, size: float) -> Iterator[str]:
    """Yield what is told of limits and of connectors beside their lines."""
    said = [f"{one.connector.id} runs {abs(one.along):.6g} {unit} from {one.limits[0].id}" for one in sliders]
    if said:
        yield f"slide limits are not kept, the guides are open: {abbreviated_list(said)}"
    for one in sliders:
        round_ = one.connector.radius and abs(abs(one.connector.at - one.centre) - one.radius)
        off = round_ if one.connector.radius else one.off(one.connector.at)
        if off > ONE_LINE * size:
            yield f"{one.connector.called} is drawn {off:.4g} {unit} beside its slot"


def _guide(one: Slider, link: str, kind: str, points: ConnectorPoints, size: float) -> DrawnGuideway:
    """Return a guide. A pin that rounding has put beside the line is on it, so that line has an angle and no ends."""
    first, second = one.limits
    exact = kind == "slide" or one.off(one.connector.at) <= SAME * size
    return DrawnGuideway(
        f"slider {one.connector.id}",
        "slide" if kind == "slide" else "slot",
        link,
        one.on,
        points.key(one.connector.id),
        first.at,
        phase(one.direction),
        (points.key(first.id), points.key(second.id)) if exact else None,
        where=one.connector.where,
    )


def _common(one: Slider, two: Slider) -> list[str]:
    return [body for body in one.bodies if body in two.bodies]


def _is_slide(one: Slider, two: Slider, size: float) -> bool:
    """Return whether two sliders of one link are in one line of another."""
    apart = (two.connector.at - one.connector.at) / one.direction
    return (
        one.on == two.on
        and bool(_common(one, two))
        and all(one.off(limit.at) <= ONE_LINE * size for limit in two.limits)
        and abs(apart.real) > _ALONG * abs(apart)
        and abs(apart) > ONE_LINE * size
    )


# Turns a minute are clockwise there.
CLOCKWISE = -1.0


SECONDS = 60.0


# How far the barrel of an actuator is drawn along it, which moves nothing.
_BARREL = 0.8


def inputs_of(points: ConnectorPoints) -> Iterator[DrawnDriver]:
    """Yield the drivers at connectors. At anchors against the frame, else against the link listed first."""
    joined = points.joined
    for one in joined.file.connectors.values():
        if not one.input:
            continue
        bodies = joined.at(one.id)
        if len(bodies) == 2:
            joined.notes += _described(one)
            on, link = bodies
            sense = -CLOCKWISE if link == FRAME else CLOCKWISE  # it is the other link that turns against the frame
            yield _input(one, points.key(one.id), (link, on) if link != FRAME else (on, link), sense)
        else:
            joined.problems.add(
                one.where, f"it is an input, but {_why(one, bodies)}", "turn a link at it, or clear its input"
            )


def _input(one: LinkageConnector, at: str, links: tuple[str, str], sense: float) -> DrawnDriver:
    """Return the driver of the first link against the second, whose speed has a sign."""
    speed = None if one.manual or not one.rpm else sense * one.rpm * RPM
    ahead = sense if one.rpm >= 0 else -sense
    travel = (0.0, ahead * radians(abs(one.range))) if one.range else None
    return DrawnDriver(*links, at, speed, travel, where=one.where)


def _described(one: LinkageConnector) -> Iterator[str]:
    """Yield what of an input is taken in another way."""
    if one.manual or not one.rpm:
        yield f"{one.called} has no speed of its own there: it turns at 1 rad/s here"
    if one.range:
        yield f"{one.called} oscillates over {abs(one.range):g} degrees: that is its range here, at constant speed"


def _why(one: LinkageConnector, bodies: tuple[str, ...]) -> str:
    if not one.anchor:
        return "joins no two links that turn against each other"
    return "no link turns at it: two anchors hold a link fast" if bodies == (FRAME,) else "holds several links"


class DrawnActuator(NamedTuple):
    """An actuator in a drawing. `mouth` is a point that tells the direction of its barrel."""

    guide: DrawnGuideway
    driver: DrawnDriver
    mouth: DrawnPoint


def actuators_of(points: ConnectorPoints) -> Iterator[DrawnActuator]:
    """Yield the actuators of a file."""
    joined = points.joined
    for link in joined.links:
        if not link.actuator or len(link.connectors) != 2:
            continue
        if not link.throw > 0:
            joined.problems.add(link.where, "throw must be positive", "give the way that it moves by")
        first, second = (joined.file.connectors[id_] for id_ in link.connectors)
        held = set(joined.at(first.id)) & set(joined.at(second.id))
        if first.at == second.at or held:
            what = "one link holds both its ends" if held else "both its ends are at one place"
            joined.problems.add(link.where, f"{what}: it cannot change its length", "pin it to two links")
        else:
            if not link.cpm:
                joined.notes.append(f"{link.called} has no speed there: it moves by 1 {joined.file.unit}/s here")
            yield _actuator(link, first, second, points)


def _actuator(
    link: LinkageLink, first: LinkageConnector, second: LinkageConnector, points: ConnectorPoints
) -> DrawnActuator:
    """Return a slide along the line between two pins, driven from the length drawn to that and the throw."""
    barrel, moving = points.joined.body(link.key), points.joined.body(rod(link))
    angle = phase(second.at - first.at)
    guide = DrawnGuideway(link.key, "slide", moving, barrel, points.key(second.id), first.at, angle, where=link.where)
    sense = -1.0 if link.cpm < 0 else 1.0
    speed = sense * 2.0 * link.throw * abs(link.cpm) / SECONDS if link.cpm else None
    travel = (0.0, sense * link.throw)
    driver = DrawnDriver(moving, barrel, link.key, speed, travel, name=link.name, where=link.where)
    mouth = first.at + _BARREL * (second.at - first.at)
    return DrawnActuator(guide, driver, DrawnPoint(f"{link.key} {AXIS}", mouth, (barrel,), f"{link.called} {AXIS}"))


_KINDS = ("gears", "chain")


def gears_of(points: ConnectorPoints) -> Iterator[DrawnGear]:
    """Yield the pairs of wheels. What is wrong with them is noted."""
    joined = points.joined
    for k, ratio in enumerate(joined.file.ratios):
        wheels = _wheels(ratio, joined)
        if wheels is None:
            continue
        first, second = (joined.body(link.key) for link in wheels)
        axes = [link.connectors[0] for link in wheels]
        both = [body for body in joined.at(axes[0]) if body in joined.at(axes[1])]
        carriers = sorted((body for body in both if body not in (first, second)), key=lambda body: body != FRAME)
        if first == second:
            joined.problems.add(ratio.where, "both its wheels are one link", "name two links that turn")
        elif not carriers:
            what = f"links {wheels[0].id} and {wheels[1].id} have no common carrier of their axes"
            joined.problems.add(ratio.where, what, "hold both axes by one link, or anchor both")
        else:
            yield _gear(f"ratio {k}", ratio, (first, second), carriers[0], axes, points)


def _wheels(ratio: LinkageRatio, joined: JoinedLinks) -> list[LinkageLink] | None:
    """Return the two links of a ratio, or nothing where they are not that."""
    problems = joined.problems
    if ratio.kind not in _KINDS:
        problems.add(ratio.where, f"there is no ratio of type {ratio.kind[:40]!r}", "gears or chain")
    if len(ratio.wheels) != 2 or not all(size > 0 for _, size in ratio.wheels):
        problems.add(ratio.where, "it is not of two links with positive sizes", "name two links, each with a size")
        return None
    found = []
    for id_, _ in ratio.wheels:
        links = [link for link in joined.links if link.id == id_]
        gears = [link for link in links if link.gear] or links
        if len(gears) == 1 and not gears[0].actuator:
            found += gears
        else:
            said = f"{len(gears)} links have the id {id_}" if gears else f"link {id_} is not there"
            problems.add(ratio.where, said, "name two gears, each by an id of its own")
    return found if len(found) == 2 and ratio.kind in _KINDS else None


def _gear(
    key: str, ratio: LinkageRatio, wheels: tuple[str, str], carrier: str, axes: list[int], points: ConnectorPoints
) -> DrawnGear:
    """Return the pair. Gears by teeth or shares of the distance; a chain may be of radii as large as its sizes."""
    one, two = (size for _, size in ratio.wheels)
    is_chain = ratio.kind == "chain"
    in_teeth = one == round(one) and two == round(two) and not (is_chain and ratio.by_size)
    if is_chain and ratio.by_size:
        one, two = one * points.joined.file.scale, two * points.joined.file.scale
    elif not in_teeth:
        places = [points.joined.file.connectors[axis].at for axis in axes]
        share = abs(places[1] - places[0]) / (one + two)
        one, two = one * share, two * share
    kind = "belt" if is_chain else "gears"
    return DrawnGear(
        key,
        "belt" if kind == "belt" else "gears",
        *wheels,
        carrier,
        points.key(axes[0]),
        points.key(axes[1]),
        (one, two),
        in_teeth,
        where=ratio.where,
    )
