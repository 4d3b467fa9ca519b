"""Blocks, barrels and rods of which nothing is left but their pins: sliders and actuators stand for them."""

from __future__ import annotations

from cmath import rect
from dataclasses import dataclass

from compoundkin.files.exchange.drawings.drawn_elements import Drawing, DrawnGuideway, DrawnPoint
from compoundkin.files.exchange.drawings.drawn_pairs import AXIS, GUIDE
from compoundkin.files.exchange.linkage.linkage_plan import LinkagePlan
from compoundkin.model.geometry import FRAME

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
