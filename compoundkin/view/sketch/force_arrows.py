"""Forces as arrows and moments as arcs, with their names beside them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.view.sketch.acting_forces import ShownForce
from compoundkin.view.sketch.label_places import Label, around, text_half
from compoundkin.view.sketch.shapes import HEAD, ArcShape, Shape, ShapeGroup, Text, arrow, arrow_head, direction
from compoundkin.view.sketch.sketch_style import REACTION, SMALL
from compoundkin.view.sketch.vectors import VectorScale, round_below

# The arc of a moment: its radius, what it goes through (radians), and how much farther the next one is.
ROUND, SWEEP, NEXT = 19.0, 2.7, 7.0
# Arrows begin and end so far from the point at which they act, so that the pin stays to be seen.
CLEAR = 6.0
# Around a driven pin it is outside of the arrow of the driver.
AROUND_DRIVER = 34.0
# A shorter arrow is not drawn, and told below the picture.
SHORTEST = 5.0
# Digits of the values beside arrows.
DIGITS = 4
# Values of so many digits before the point are written without an exponent.
PLAIN = 8


def force_scale(forces: Sequence[ShownForce], length: float, unit: str) -> VectorScale | None:
    """Return the scale at which the longest force is so long. None where there are none."""
    longest = max((abs(one.force) for one in forces), default=0.0)
    if longest <= 0:
        return None
    amount = round_below(longest)
    return VectorScale(REACTION, length / longest, amount, f"{amount:g} {unit}")


@dataclass(frozen=True)
class DrawnForce:
    """A force on a picture. `start` and `stop` are the ends of its arrow, `tip` where its name belongs."""

    force: ShownForce
    start: complex
    stop: complex
    away: complex

    @property
    def is_seen(self) -> bool:
        """Whether its arrow is long enough to be seen."""
        return abs(self.stop - self.start) >= SHORTEST

    @property
    def shapes(self) -> tuple[Shape, ...]:
        """The arrow."""
        title = f"{self.force.told}: {written(abs(self.force.force))}"
        made = arrow(self.start, self.stop, self.force.kind)
        return (ShapeGroup(made, title=title, links=(self.force.link,)),) if self.is_seen else ()

    def label(self, text: str, key: str) -> Label:
        """Return the label at the free end of the arrow."""
        at = self.stop if self.away == direction(self.stop - self.start) else self.start
        return around(key, at, text_half(text, SMALL), 3.0, self.away)


def drawn(one: ShownForce, at: complex, scale: VectorScale, middle: complex | None = None) -> DrawnForce:
    """Return the arrow of a force at a place of the picture.

    It leads away from the place; into the place where it presses on a body whose middle is given.
    """
    way = complex(np.conjugate(one.force)) * scale.per_unit
    e = direction(way)
    inward = middle is not None and abs(middle - at) > CLEAR and (np.conjugate(e) * direction(middle - at)).real > 0.2
    if inward:
        return DrawnForce(one, at - e * CLEAR - way, at - e * CLEAR, -e)
    return DrawnForce(one, at + e * CLEAR, at + e * CLEAR + way, e)


def moment_arc(one: ShownForce, at: complex, radius: float, toward: complex) -> tuple[Shape, ...]:
    """Draw a moment as an arc with a head beside its place.

    It is not to scale.
    """
    # counterclockwise is clockwise in coordinates whose y points downward
    way = -float(np.sign(one.moment))
    start = direction(toward) * np.exp(-0.5j * way * SWEEP)
    stop, back = start * np.exp(1j * way * SWEEP), HEAD / radius
    end = at + stop * np.exp(-1j * way * back * 0.8) * radius
    heading = 1j * way * stop * np.exp(-1j * way * back / 2.0)
    arc = ArcShape(complex(at + start * radius), complex(end), radius, way > 0, one.kind)
    tip = arrow_head(complex(at + stop * radius), complex(heading), f"{one.kind}-head")
    return (ShapeGroup((arc, tip), title=f"moment, {one.told}: {written(abs(one.moment))}", links=(one.link,)),)


def moments(
    forces: Sequence[ShownForce], place: Callable[[complex], complex], toward: complex, first: float = ROUND
) -> Iterator[tuple[ShownForce, tuple[Shape, ...], Label]]:
    """Yield the arcs of all moments with labels. Several at one place are one around another."""
    taken: list[complex] = []
    for k, one in enumerate(one for one in forces if one.moment):
        at = place(one.at)
        radius = first if one.is_driver else ROUND
        radius += NEXT * sum(abs(other - at) < 1.0 for other in taken)
        taken.append(at)
        way = toward - at if abs(toward - at) > CLEAR else -1j
        outward = -direction(complex(way))
        shapes = moment_arc(one, at, radius, outward)
        half = text_half(one.turning, SMALL)
        yield one, shapes, around(f"moment {k} {one.turning}", at + outward * radius, half, 5.0, outward)


def named(key: str, text: str, at: complex, kind: str) -> tuple[Shape, ...]:
    """Return the name of a force, readable on lines."""
    return Text(at, text, f"halo {kind}-name"), Text(at, text, f"{kind}-name")


def written(value: float) -> str:
    """Return a value as it stands beside an arrow.

    >>> written(12754.9), written(0.5)
    ('12750', '0.5')
    """
    return f"{float(f'{value + 0.0:.{DIGITS}g}'):.{PLAIN}g}"
