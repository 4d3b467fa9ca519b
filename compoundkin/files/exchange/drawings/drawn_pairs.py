"""The guides, arcs, gears and racks of a drawing as words of a mechanism."""

from __future__ import annotations

from cmath import phase, rect
from collections import Counter
from collections.abc import Iterator
from typing import Any

from compoundkin.files.exchange.drawings.drawn_elements import Drawing, DrawnArc, DrawnGear, DrawnGuideway, DrawnRack
from compoundkin.files.exchange.drawings.drawn_letters import SAME, DrawnLetters
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs import Pair, arc, belt, gear, rack, slide, slot

# How the letters are called that guides and wheels need and the other program has none for.
GUIDE, CENTRE, AXIS = "guide", "centre", "axis"


def pairs_of(drawing: Drawing, letters: DrawnLetters) -> dict[str, Pair]:
    """Return the pairs by their keys, and give the links what letters they need."""
    _direct(drawing, letters)
    found: dict[str, Pair] = {}
    for guide in drawing.guides:
        found[guide.key] = _guide(guide, letters)
    for one in drawing.arcs:
        found[one.key] = _arc(one, letters)
    for wheels in drawing.gears:
        found[wheels.key] = _gear(wheels, letters)
    for line in drawing.racks:
        found[line.key] = _rack(line, letters)
    return _distinguished(found)


def _direct(drawing: Drawing, letters: DrawnLetters) -> None:
    """Give a direction to the links whose own angle counts: carriers, wheels, blocks in two guides."""
    slides = [guide for guide in drawing.guides if guide.kind == "slide"]
    often = Counter(guide.link for guide in slides)
    for guide in drawing.guides:
        along = rect(letters.size, guide.angle)
        if guide.on != FRAME:
            if letters.there(guide.on, guide.through) is None and not guide.ends:
                letters.added(f"{letters.point[guide.at]} {GUIDE}", guide.through, guide.on)
            letters.directed(guide.on, along, AXIS)
        if guide.kind == "slide" and guide.link != FRAME and often[guide.link] > 1:
            letters.directed(guide.link, along, AXIS)
    for one in _wheels(drawing, letters):
        letters.directed(one, complex(letters.size), AXIS)


def _wheels(drawing: Drawing, letters: DrawnLetters) -> Iterator[str]:
    for gear_ in drawing.gears:
        yield from (link for link in (gear_.first, gear_.second, gear_.carrier) if link != FRAME)
    for line in drawing.racks:
        yield from (link for link in (line.rack, line.pinion) if link != FRAME)


def _guide(guide: DrawnGuideway, letters: DrawnLetters) -> Pair:
    at = letters.point[guide.at]
    through, words = _line(guide, letters)
    offset = (rect(1.0, -guide.angle) * (letters.places[at] - letters.places[through])).imag
    if abs(offset) > SAME * letters.size:
        words["offset"] = offset if guide.ends or guide.kind == "slide" else 0.0
    words["on"], words["at"], words["through"] = letters.link[guide.on], at, through
    if guide.reach is not None:
        moved = (rect(1.0, -guide.angle) * (guide.through - letters.places[through])).real
        words["reach"] = (guide.reach[0] + moved, guide.reach[1] + moved)
    word: Any = slide if guide.kind == "slide" else slot
    made: Pair = word(letters.link[guide.link], name=guide.name, **words)
    return made


def _line(guide: DrawnGuideway, letters: DrawnLetters) -> tuple[str, dict[str, Any]]:
    """Return the letter that a guide runs through, and its direction: toward a letter, or by its angle."""
    if guide.ends:
        return letters.point[guide.ends[0]], {"toward": letters.point[guide.ends[1]]}
    name = f"{letters.point[guide.at]} {GUIDE}"
    through = letters.there(guide.on, guide.through) or letters.added(name, guide.through, guide.on)
    return through, {"angle": _own_angle(guide.angle, guide.on, letters)}


def _own_angle(angle: float, link: str, letters: DrawnLetters) -> float:
    """Return an angle in space as one from the x axis of a link, between -pi and pi."""
    if link == FRAME:
        return angle
    return phase(rect(1.0, angle - (letters.axis(link) or 0.0)))


def _arc(one: DrawnArc, letters: DrawnLetters) -> Pair:
    centre = letters.point[one.centre_at] if one.centre_at else letters.there(one.on, one.centre)
    at = letters.point[one.at]
    made: Pair = arc(
        letters.link[one.link],
        on=letters.link[one.on],
        at=at,
        centre_at=centre or letters.added(f"{at} {CENTRE}", one.centre, one.on),
        radius=one.radius,
        name=one.name,
    )
    return made


def _gear(wheels: DrawnGear, letters: DrawnLetters) -> Pair:
    word: Any = belt if "belt" in wheels.kind else gear
    sense = {"ring": {"internal": True}, "crossed belt": {"crossed": True}}.get(wheels.kind, {})
    made: Pair = word(
        letters.link[wheels.first],
        letters.link[wheels.second],
        carrier=letters.link[wheels.carrier],
        first_at=letters.point[wheels.first_at],
        second_at=letters.point[wheels.second_at],
        name=wheels.name,
        **{"teeth" if wheels.in_teeth else "radii": wheels.sizes},
        **sense,
    )
    return made


def _rack(line: DrawnRack, letters: DrawnLetters) -> Pair:
    at = letters.point[line.at]
    through = letters.there(line.rack, line.through) or letters.added(f"{at} {GUIDE}", line.through, line.rack)
    left = (rect(1.0, -line.angle) * (letters.places[at] - line.through)).imag > 0
    made: Pair = rack(
        letters.link[line.rack],
        letters.link[line.pinion],
        through=through,
        at=at,
        angle=_own_angle(line.angle, line.rack, letters),
        radius=line.radius,
        side=1 if left else -1,
        name=line.name,
    )
    return made


def _distinguished(pairs: dict[str, Pair]) -> dict[str, Pair]:
    """Return pairs with names of their own: of several that would be called alike, all but the first are numbered."""
    from dataclasses import replace

    used: set[str] = set()
    found = {}
    for key, pair in pairs.items():
        name = next(
            n for k in range(1, len(pairs) + 2) if (n := pair.name if k == 1 else f"{pair.name} {k}") not in used
        )
        used.add(name)
        found[key] = pair if name == pair.name else replace(pair, name=name)
    return found
