"""From a drawing to the JSON of pylinkage."""

from __future__ import annotations

import cmath
import json
import math
from collections.abc import Iterator
from typing import Any

from compoundkin.base.display import count_phrase
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.drawings.drawn_elements import Drawing, DrawnDriver
from compoundkin.files.exchange.pylinkage.pylinkage_layout import PylinkageLayout
from compoundkin.files.exchange.pylinkage.pylinkage_records import PLACE, RATE
from compoundkin.files.exchange.pylinkage.step_order import LinkEntry, found_order, link_entries
from compoundkin.model.geometry import FRAME

# A driver that is slower rests, and one so much faster has no speed that means anything.
_SLOWEST = 1e-100


def pylinkage_text(drawing: Drawing, steps: int) -> tuple[str, tuple[str, ...]]:
    """Return the file of a drawing, and what has to be said of it. The fastest crank makes a turn in `steps`."""
    layout = PylinkageLayout(drawing)
    order = found_order(layout)
    entries = link_entries(layout, order)
    fastest = max((abs(driver.speed or 0.0) for driver in drawing.drivers), default=0.0)
    step = math.tau / steps / (fastest if _SLOWEST < fastest < 1.0 / _SLOWEST else 1.0)
    ids = _Ids(drawing)
    data = {
        "name": drawing.title,
        "joints": [_joint(layout, point.key, ids) for point in drawing.points],
        "links": [{"id": ids.ground, "type": "ground", "joints": [k for k in layout.of if layout.on_frame(k)]}]
        + [_link(layout, entry, ids.of(entry), step) for entry in entries],
        "ground": ids.ground,
    }
    return _dumped(data), tuple(_notes(layout, order, entries, step, steps))


def _dumped(data: Any) -> str:
    try:
        return json.dumps(data, indent=2, allow_nan=False) + "\n"
    except ValueError:
        what = "a place or a speed of it is no finite number"
        raise InvalidInput(Problem(str(data["name"]), what, "look at its pose")) from None


class _Ids:
    """The ids of links; each is given once."""

    def __init__(self, drawing: Drawing) -> None:
        self._called = {link.key: link.called for link in drawing.links}
        self._used = {*self._called.values()}
        self._given: set[str] = set()
        self.ground = "ground" if "ground" not in self._used else FRAME

    def of(self, entry: LinkEntry) -> str:
        """Return the id of an entry: the name of its link, a number after it for its further bars."""
        name, k = self._called[entry.body], 2
        if entry.body in self._given:
            while f"{name} {k}" in self._used:
                k += 1
            name = f"{name} {k}"
            self._used.add(name)
        self._given.add(entry.body)
        return name


def _joint(layout: PylinkageLayout, key: str, ids: _Ids) -> dict[str, Any]:
    place = layout.places[key]
    found: dict[str, Any] = {"id": key, "type": "revolute", PLACE: [place.real, place.imag]}
    if layout.on_frame(key):
        return found | {"type": "ground"}
    if key in layout.lines:
        line = layout.lines[key]
        axis, through = cmath.rect(1.0, line.angle), line.through
        way = {"axis": [axis.real, axis.imag], "line_point": [through.real, through.imag], "slide_distance": 0.0}
        return found | {"type": "prismatic", **way}
    if key in layout.trackers:
        first, second = layout.trackers[key]
        gap, base = place - layout.places[first], layout.places[second] - layout.places[first]
        angle = cmath.phase(gap * base.conjugate()) if gap else 0.0
        polar = {"ref_joint1_id": first, "ref_joint2_id": second, "distance": abs(gap), "angle": angle}
        return found | {"type": "tracker", **polar}
    return found


def _link(layout: PylinkageLayout, entry: LinkEntry, name: str, step: float) -> dict[str, Any]:
    found = {"id": name, "type": "link", "joints": list(entry.joints)}
    if not entry.is_crank:
        return found
    driver = next(one for one in layout.drawing.drivers if one.link == entry.body)
    motor, tip = entry.joints
    shown = cmath.phase(layout.places[tip] - layout.places[motor])
    turn = {RATE: _rate(driver, step), "initial_angle": shown, "motor_joint": motor}
    if driver.travel is None or not driver.travel[0] < driver.travel[1]:
        return found | turn | {"type": "driver"}
    low, high = (shown + end for end in driver.travel)
    return found | turn | {"type": "arc_driver", "arc_start": low, "arc_end": high, "initial_angle": shown}


def _rate(driver: DrawnDriver, step: float) -> float:
    """Return how far a driver turns in a step. One that swings goes to the end of its arc first, in pylinkage."""
    speed = driver.speed or 0.0
    return (speed if driver.travel is None else abs(speed)) * step or step


def _notes(
    layout: PylinkageLayout, order: dict[str, int], entries: list[LinkEntry], step: float, steps: int
) -> Iterator[str]:
    drawing = layout.drawing
    if drawing.drivers:
        yield f"a step of pylinkage is {step:.6g} s: {count_phrase(steps, 'step')} are a turn of the fastest crank"
    back = [one.link for one in drawing.drivers if one.travel is not None and (one.speed or 0.0) < 0.0]
    if back:
        yield f"goes to the end of its arc first in pylinkage, and to its beginning here: {', '.join(back)}"
    blocks = [body for body, own in layout.joints.items() if body in layout.sliding and len(own) < 2]
    if blocks:
        yield f"written as pins in slots, for which no link is needed: {', '.join(blocks)}"
    bodies = [entry.body for entry in entries]
    several = [body for body in dict.fromkeys(bodies) if bodies.count(body) > 1]
    if several:
        yield f"written as bars that are one rigid body, so that pylinkage can step it: {', '.join(several)}"
    lost = [key for own in layout.joints.values() for key in own if key not in order]
    if lost:
        names = ", ".join(dict.fromkeys(lost))
        yield f"pylinkage has no way to find {names} one after another (a group of class III), and cannot step it"
    several_of = [("mass", "masses", len(drawing.masses)), ("force", "", len(drawing.forces))]
    left = [count_phrase(many, one, more) for one, more, many in several_of if many]
    left += [count_phrase(many, what) for what, many in drawing.dropped if many]
    left += [f"the unit {drawing.unit}"] if drawing.unit else []
    if left:
        yield f"left out: {', '.join(left)}"
