"""Geneva wheels as shapes: a wheel with all its slots and locking arcs, and the locking disc of its crank.

The dimensions tell such a wheel: at the mouth of its slot the crank stands at right angles to it, and the angle between
them at the wheel's axis is that between two slots. How deep its locking arcs are is chosen for the picture.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from compoundkin.base.series import Number
from compoundkin.model.elements import FRAME
from compoundkin.model.pairs.symbols import Groove, Stud, arc_line
from compoundkin.view.sketch.scene import Scene, Seen
from compoundkin.view.sketch.shapes import CircleShape, Polygon
from compoundkin.view.sketch.slide_shapes import Laid, Layer, Painter

# Numbers that differ by less than this are one, in parts of the distance of the axes or as numbers of slots.
SAME = 1e-3
FEWEST = 3
# Half the width of a slot, and the wall between slot and locking arc at its thinnest, in picture units.
HALF, WALL = 5.5, 6.0
# Neither is more than this part of the crank's length, where the wheel is small or has many slots.
PART = 0.2
HUB = 9.0
# The locking disc in parts of the crank's length, where there is room for it.
LOCKING = 0.7


class Geneva(NamedTuple):
    """A wheel with so many `slots`.

    It turns about `axis` in its own frame; `slot` is the way from there to the mouth of one slot.
    The crank turns about `pivot` in its own frame; `arm` is the way to its pin. The slots begin `bottom` from the axis,
    and `apart` is the distance of both axes.
    """

    wheel: str
    axis: complex
    slot: complex
    bottom: float
    slots: int
    crank: str
    pivot: complex
    arm: complex
    apart: float


def geneva(scene: Scene, seen: Seen) -> Geneva | None:
    """Return the Geneva wheel whose slot a groove is. None where its dimensions are not those of one."""
    if not isinstance(seen.mark, Groove) or len(seen.mark.line) != 2 or FRAME in seen.members[:2]:
        return None
    stud = next((s for s in scene.seen if s.pair is seen.pair and isinstance(s.mark, Stud)), None)
    if stud is None:
        return None
    wheel, crank = seen.members[seen.mark.member], stud.members[stud.mark.member]  # type: ignore[union-attr]
    axes = [_pivot(scene, link) for link in (wheel, crank)]
    if None in axes:
        return None
    (axis, centre), (pivot, other) = axes  # type: ignore[misc]
    mouth, foot = sorted((complex(p) - axis for p in seen.mark.line), key=abs, reverse=True)
    arm, apart = complex(stud.mark.at) - pivot, abs(centre - other)  # type: ignore[union-attr]
    is_radial = abs((np.conjugate(mouth) * foot).imag) < SAME * abs(mouth) ** 2
    if not is_radial or not 0 < abs(arm) < apart or abs(np.hypot(abs(mouth), abs(arm)) - apart) > SAME * apart:
        return None
    slots = np.pi / np.arcsin(abs(arm) / apart)
    if round(slots) < FEWEST or abs(slots - round(slots)) > SAME:
        return None
    return Geneva(wheel, axis, mouth, abs(foot), round(slots), crank, pivot, arm, apart)


def genevas(scene: Scene) -> list[Geneva]:
    """Return all Geneva wheels."""
    return [found for seen in scene.seen if (found := geneva(scene, seen)) is not None]


def around_genevas(scene: Scene) -> Iterator[Number]:
    """Return places around Geneva wheels and locking discs at the pose shown."""
    for found in genevas(scene):
        around = np.array([1, 1j, -1, -1j])
        yield scene.at(found.wheel, found.axis) + abs(found.slot) * around
        yield scene.at(found.crank, found.pivot) + LOCKING * abs(found.arm) * around


def _pivot(scene: Scene, link: str) -> tuple[complex, complex] | None:
    """Where a link is pinned to the frame: in its own frame, and on the frame."""
    for letter, p in scene.points[link].items():
        if letter in scene.points[FRAME]:
            return complex(p), complex(scene.points[FRAME][letter])
    return None


def geneva_wheel(painter: Painter, found: Geneva) -> Iterator[Laid]:
    """Draw the wheel with its slots and locking arcs. The disc of its crank locks it."""
    for link, line, hub in (
        (found.wheel, wheel_line(found, float(painter.window.scale)), found.axis),
        (found.crank, disc_line(found, float(painter.window.scale)), found.pivot),
    ):
        yield Laid(Layer.WHEEL, Polygon(painter.line(link, line), painter.style("plate", link)), link)
        yield Laid(Layer.WHEEL, CircleShape(painter.place(link, hub), HUB, painter.style("line", link)), link)


def wheel_line(found: Geneva, scale: float) -> Number:
    """Return the outline of the wheel in its own frame. It is that for a picture of a scale."""
    half, radius = _width(found, HALF, scale), abs(found.slot)
    locking = _locking(found, scale)
    pitch = 2.0 * np.pi / found.slots
    # one slot along the x axis from its bottom, and half a pitch on the locking arc
    bottom = arc_line(found.bottom, half, 1.5 * np.pi, 0.5 * np.pi)
    corner = complex(np.sqrt(radius**2 - half**2), half)
    middle = found.apart * np.exp(0.5j * pitch)
    inner = np.arccos((found.apart**2 + locking**2 - radius**2) / (2.0 * found.apart * locking))
    toward = float(np.angle(-middle))
    arc = arc_line(middle, locking, toward + inner, toward - inner)
    tooth = np.concatenate([[np.conjugate(corner)], bottom, [corner], arc])
    turns = np.exp(1j * pitch * np.arange(found.slots)) * found.slot / radius
    return found.axis + (turns[:, None] * tooth[None]).ravel()


def disc_line(found: Geneva, scale: float) -> Number:
    """Return the outline of the crank's locking disc in its own frame. It is cut out where the wheel turns by."""
    locking, radius = _locking(found, scale), abs(found.slot) + _width(found, HALF, scale)
    half = float(np.arccos((found.apart**2 + locking**2 - radius**2) / (2.0 * found.apart * locking)))
    wide = float(np.arccos((found.apart**2 + radius**2 - locking**2) / (2.0 * found.apart * radius)))
    rim = arc_line(0j, locking, half, 2.0 * np.pi - half)
    cut = arc_line(found.apart, radius, np.pi + wide, np.pi - wide)
    return found.pivot + np.concatenate([rim, cut]) * found.arm / abs(found.arm)


def _locking(found: Geneva, scale: float) -> float:
    """The radius of the locking arcs. Beside the slots a wall is left, and the arcs reach into the wheel."""
    walls = _width(found, HALF, scale) + _width(found, WALL, scale)
    most, least = abs(found.arm) - walls, 1.05 * (found.apart - abs(found.slot))
    return max(min(LOCKING * abs(found.arm), most), least)


def _width(found: Geneva, width: float, scale: float) -> float:
    return min(width / scale, PART * abs(found.arm))
