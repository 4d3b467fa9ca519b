"""What drives: inputs of connectors, and actuators, which are a barrel and a rod with a driven slide."""

from __future__ import annotations

from cmath import phase
from collections.abc import Iterator
from math import radians
from typing import NamedTuple

from compoundkin.files.exchange.drawings.drawn_elements import DrawnDriver, DrawnGuideway, DrawnPoint
from compoundkin.files.exchange.drawings.drawn_pairs import AXIS
from compoundkin.files.exchange.linkage.connector_points import ConnectorPoints
from compoundkin.files.exchange.linkage.joined_links import rod
from compoundkin.files.exchange.linkage.linkage_records import LinkageConnector, LinkageLink
from compoundkin.files.written_quantities import RPM
from compoundkin.model.geometry import FRAME

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
            joined.notes += _told(one)
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


def _told(one: LinkageConnector) -> Iterator[str]:
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
