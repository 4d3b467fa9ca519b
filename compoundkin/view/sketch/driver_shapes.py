"""The arrows of drivers: around a driven pin, beside a driven slide, beside a point that is led."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.model.attributes import ANGLE
from compoundkin.model.elements import Lead
from compoundkin.model.pairs.symbols import Sliding, Track
from compoundkin.structure import DrivenPair
from compoundkin.view.sketch.cylinder_shapes import beside
from compoundkin.view.sketch.noted_numbers import as_place
from compoundkin.view.sketch.scene import Seen
from compoundkin.view.sketch.shapes import (
    HEAD,
    ArcShape,
    Shape,
    arrow,
    arrow_head,
    direction,
)
from compoundkin.view.sketch.sketch_style import BLOCK
from compoundkin.view.sketch.slide_shapes import Laid, Layer, Painter

# The arrow around a driven pin: its radius and how far it goes, radians.
TURN_RADIUS, TURN = 25.0, 1.9
# The arrow beside a driven slide.
PUSH = 34.0


def drives(painter: Painter) -> Iterator[Laid]:
    """Draw an arrow at every driven pair, in the sense of its speed."""
    scene = painter.scene
    for step in scene.driven:
        if not painter.shows(step.link) or step.link in scene.mechanism.led_links:
            continue
        speed = painter.scene.driver_value(step.drive.name, 1) or 1.0
        marks = [s for s in painter.scene.seen if s.pair.name == step.pair.name]
        straight = next((s for s in marks if isinstance(s.mark, Sliding | Track)), None)
        letter = step.pair.letters[0]
        at = painter.pin(step.link, letter)
        if straight is None or step.pair.free_is_angle:
            shapes = turning(painter, step, at, float(np.sign(speed)))
        else:
            e = _way(painter, straight, step.link) * float(np.sign(speed))
            shapes = pushing(painter, at, e, beside(painter, straight))
        # the arrow beside a wheel that is pushed along its track does not turn with it
        rolls = straight is not None and isinstance(straight.mark, Track) and letter in painter.scene.points[step.link]
        yield from (Laid(Layer.PIN, shape, step.link, letter if rolls else "") for shape in shapes)
    for lead in scene.mechanism.leads.values() if painter.only is None else ():
        yield from led(painter, lead)


def _way(painter: Painter, seen: Seen, link: str) -> complex:
    """The direction of a slide or track, as the link with the arrow carries it."""
    mark, guide = seen.mark, seen.members[0]
    if isinstance(mark, Sliding) and link != guide:
        return painter.along(link, mark.turn)
    assert isinstance(mark, Sliding | Track)
    return painter.along(guide, mark.along) if link == guide else complex(painter.along(guide, mark.along))


def led(painter: Painter, lead: Lead) -> Iterator[Laid]:
    """Draw an arrow beside a led point, or around a turned link's."""
    scene = painter.scene
    speeds = {word: scene.driver_value(name, 1) for word, name in lead.drivers.items()}
    link, letter = lead.link, lead.point
    if link:
        letter = next(iter(scene.points[link]))
        step = next(s for s in scene.driven if s.drive.name == lead.drivers[ANGLE])
        at = complex(painter.window.at(scene.letters[letter]))
        shapes = turning(painter, step, at, float(np.sign(speeds[ANGLE] or 1.0)), link)
    else:
        way = speeds.get("x", 0.0) + 1j * speeds.get("y", 0.0) or complex("x" in speeds, "x" not in speeds)
        at = complex(painter.window.at(scene.letters[letter]))
        shapes = pushing(painter, at, direction(painter.along(lead.on, way)))
    # of what is only thought: it turns with nothing, and is left out where the sketch moves by itself
    yield from (Laid(Layer.PIN, shape, lead.links[-1]) for shape in shapes)


def turning(painter: Painter, step: DrivenPair, at: complex, sense: float, link: str = "") -> tuple[Shape, ...]:
    """Draw a curved arrow around a pin, behind the driven link or another."""
    link, letter = link or step.drive.link, step.pair.letters[0]
    others = [painter.place(link, p) for k, p in painter.scene.points[link].items() if k != letter]
    toward = direction(max((p - at for p in others), key=abs, default=1 + 0j))
    # counterclockwise is clockwise in coordinates whose y points downward
    way = -sense
    start = toward * np.exp(1j * way * 0.45)
    stop = start * np.exp(1j * way * TURN)
    tip = at + stop * TURN_RADIUS
    back = HEAD / TURN_RADIUS
    end = at + stop * np.exp(-1j * way * back * 0.8) * TURN_RADIUS
    heading = 1j * way * stop * np.exp(-1j * way * back / 2.0)
    arc = ArcShape(at + start * TURN_RADIUS, as_place(end), TURN_RADIUS, way > 0, "drive")
    return arc, arrow_head(as_place(tip), as_place(heading), "drive-head")


def pushing(painter: Painter, at: complex, e: complex, room: float = BLOCK[1] / 2.0) -> tuple[Shape, ...]:
    """Draw a straight arrow beside a block. It needs so much room on its sides."""
    across = 1j * e
    side = -1.0 if (np.conjugate(across) * (painter.middle - at)).real > 0 else 1.0
    if abs(across.imag) > 0.5:
        side = -1.0 if across.imag > 0 else 1.0
    middle = at + across * side * (room + 9.0)
    return arrow(middle - e * PUSH / 2.0, middle + e * PUSH / 2.0, "drive")
