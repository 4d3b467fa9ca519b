"""From a drawing to the records of a share string, and what of it they cannot say."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import count
from math import degrees

from compoundkin.base.display import count_phrase
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.drawings.drawn_elements import Drawing
from compoundkin.files.exchange.pmks_plus.share_drivers import ShareDrivers, in_order
from compoundkin.files.exchange.pmks_plus.share_joints import ShareJoints, plain_name
from compoundkin.files.exchange.pmks_plus.share_scale import rounded, share_scale
from compoundkin.files.exchange.pmks_plus.shared_records import SharedJoint, SharedLink, SharedMechanism, SharedSettings
from compoundkin.files.exchange.pmks_plus.told_loads import ToldLoads

_NO = "PMKS+ has pins, slides and slots only"
# Less than this part is no change: what sums of coordinates leave.
_NOTHING = 1e-9


def share_of_drawing(drawing: Drawing, scale: float | None, on_rails: bool) -> SharedMechanism:
    """Return the records of a drawing, with notes. Raises InvalidInput listing all that they cannot say."""
    problems = list(_unsaid(drawing))
    if problems:
        raise InvalidInput(problems, heading=f"{drawing.title!r} cannot be said in PMKS+")
    size = share_scale(drawing, scale)
    table = ShareJoints(drawing, size, on_rails)
    drivers = ShareDrivers(table)
    loads = ToldLoads(drawing, size)
    ids, links = _links(table, drivers, loads)
    joints = tuple(_with_carrier(joint, ids) for joint in table.joints.values())
    settings = SharedSettings(
        drivers.clockwise, loads.has_gravity, size.mark_size, drivers.linear, drivers.rpm, size.length
    )
    notes = (*size.notes(drawing.unit), *_rounding(joints, size.size), *drivers.notes, *loads.notes, *_kept(drawing))
    return SharedMechanism(settings, joints, links, tuple(loads.forces(ids)), notes=notes)


def _unsaid(drawing: Drawing) -> Iterator[Problem]:
    for arc in drawing.arcs:
        yield Problem(f"arcs.{arc.key}", f"{arc.name or arc.key!r} is a curved slot", _NO)
    for gear in drawing.gears:
        word = "belt" if "belt" in gear.kind else "gear pair"
        yield Problem(f"gears.{gear.key}", f"{gear.name or gear.key!r} is a {word}", _NO)
    for rack in drawing.racks:
        yield Problem(f"racks.{rack.key}", f"{rack.name or rack.key!r} is a rack with its pinion", _NO)


def _links(
    table: ShareJoints, drivers: ShareDrivers, loads: ToldLoads
) -> tuple[dict[str, str], tuple[SharedLink, ...]]:
    """Return the ids of the links by their keys, which are those of their joints, and the links."""
    names = {link.key: link.called for link in table.drawing.links}
    blocks = {key or f"block at {slider}": (pin, slider) for key, pin, slider in table.blocks}
    ids: dict[str, str] = {}
    found: list[SharedLink] = []
    for key in in_order([*table.members, *(key for key in blocks if key not in table.members)], drivers.before):
        own = blocks.get(key) or tuple(table.enough(key))
        id_ = "".join(own)
        ids[key] = next(k for n in count(1) if (k := id_ if n == 1 else f"{id_}{n}") not in ids.values())
        link = SharedLink(ids[key], plain_name(names.get(key, "")) or ids[key], own, is_block=key in blocks)
        found.append(loads.weighed(key, link, table))
    return ids, tuple(found)


def _with_carrier(joint: SharedJoint, ids: dict[str, str]) -> SharedJoint:
    """Return a joint whose carrier is named by its id instead of its key."""
    return joint if joint.slot is None else replace(joint, slot=(ids[joint.slot[0]], *joint.slot[1:]))


def _rounding(joints: tuple[SharedJoint, ...], size: float) -> Iterator[str]:
    """Yield what three decimals change: places, and angles of guides."""
    places = [part for joint in joints for part in (joint.at.real, joint.at.imag)]
    most = max((abs(rounded(part) - part) for part in places), default=0.0)
    if most > _NOTHING * size:
        yield f"places are rounded to 3 decimals, by up to {most / size:.1g} of the size"
    for joint in joints:
        off = abs(rounded(joint.angle) - joint.angle)
        if joint.slides and joint.slot is None and off > _NOTHING:
            yield (
                f"the guide of {joint.id} is at {rounded(joint.angle):g} rad, rounded by {degrees(off):.2g} degrees: "
                "on_rails=True keeps it, as a link that the frame holds"
            )


def _kept(drawing: Drawing) -> Iterator[str]:
    """Yield what there is no word for, and names that are written otherwise."""
    names = [*(link.called for link in drawing.links), *(point.called for point in drawing.points)]
    changed = [f"{name!r} is {plain_name(name)!r}" for name in names if plain_name(name) != name]
    if changed:
        yield f"links hold no # and ~ in names: {', '.join(changed[:8])}"
    ranges = sum(one.travel is not None for one in drawing.drivers)
    if ranges:
        yield f"the range of {count_phrase(ranges, 'driver')} is not told: the program drives as far as it goes"
    left = [count_phrase(many, what) for what, many in drawing.dropped if many]
    if left:
        yield f"left out: {', '.join(left)}"
