"""The order in which a drawing is laid out: links and connectors, then guides, actuators, arcs and wheels."""

from __future__ import annotations

from compoundkin.files.exchange.drawings.drawn_elements import Drawing, DrawnDriver, DrawnGuideway
from compoundkin.files.exchange.linkage.linkage_plan import LinkagePlan
from compoundkin.files.exchange.linkage.standing_pins import PinSlot, blocks_of, rams_of
from compoundkin.files.exchange.linkage.written_actuators import actuator_ends, write_actuator
from compoundkin.files.exchange.linkage.written_gears import write_gears
from compoundkin.files.exchange.linkage.written_guides import write_arc, write_slide, write_slot
from compoundkin.files.exchange.problems import Problems
from compoundkin.files.exchange.shown_mechanism import ShownMechanism


def linkage_layout(shown: ShownMechanism, drawing: Drawing, problems: Problems) -> LinkagePlan:
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
