"""Gears and chains as ratios between links that are wheels, each fastened to the link that turns with it."""

from __future__ import annotations

from compoundkin.files.exchange.drawings.drawn_elements import DrawnGear
from compoundkin.files.exchange.linkage.linkage_elements import WrittenLink, WrittenRatio
from compoundkin.files.exchange.linkage.linkage_plan import LinkagePlan
from compoundkin.model.geometry import FRAME

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
