"""Guides and arcs as sliders: a pin in a slot is one, a slide is two of them in one line."""

from __future__ import annotations

from cmath import phase, rect
from math import pi

import numpy as np

from compoundkin.files.exchange.drawings.drawn_elements import DrawnArc, DrawnGuideway
from compoundkin.files.exchange.linkage.linkage_elements import WrittenConnector
from compoundkin.files.exchange.linkage.linkage_plan import LinkagePlan
from compoundkin.files.exchange.linkage.standing_pins import CLOSE
from compoundkin.model.geometry import FRAME

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
