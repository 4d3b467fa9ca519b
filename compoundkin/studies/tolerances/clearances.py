"""Clearances of pins, slots and guides as sources of errors.

A pin's clearance moves one link's copy of the point on a circle at an unknown angle; a slot or a guide has an offset to
either flank, which is stated as zero so that it can have errors.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from compoundkin.base.arguments import real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.display import count_phrase, short_repr
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import pairs_among
from compoundkin.programs.dimensions import StatedDimensions
from compoundkin.studies.tolerances.error_sources import ErrorSource, ErrorSpec


def clearance_specs(mechanism: Mechanism, clearances: Mapping[str, Any]) -> list[ErrorSpec]:
    """Return the error sources of clearances of pins, slots and guides.

    Pins are named "C", or "plate.C" where the plate has clearance; slots and guides by their names. Raises UnknownName
    for unknown names, InvalidInput for an ambiguous link and an invalid clearance.
    """
    return [_clearance(mechanism, name, given) for name, given in clearances.items()]


def _clearance(mechanism: Mechanism, name: str, given: Any) -> ErrorSpec:
    half = _half(name, given)
    if name in straight_guides(mechanism):
        return ErrorSpec(
            f"{name}.{OFFSET}", lambda numbers, unit, own: FlankClearance(f"clearance {name}", numbers, unit, half)
        )
    point = clearance_point(mechanism, name)
    return ErrorSpec(point, lambda numbers, unit, own: PinClearance(f"clearance {name}", numbers, unit, half))


def _half(name: str, given: Any) -> float:
    where = f"clearance.{name}"
    found = real_numbers(where, given)
    if found.shape != () or not np.isfinite(found) or found < 0:
        raise InvalidInput(Problem(where, f"{short_repr(given)} is not a clearance", "give half the play, 0.02"))
    return float(found)


def clearance_point(mechanism: Mechanism, name: str) -> str:
    """Return the name of the point that the clearance of a pin moves, on a link where no other pair uses it."""
    where, pins = f"clearance.{name}", mechanism.real_pins
    link, _, letter = name.rpartition(".")
    if letter not in pins or (link and link not in pins[letter]):
        known = [*pins, *straight_guides(mechanism), *(f"{one}.{pin}" for pin, links in pins.items() for one in links)]
        raise UnknownName(Problem(where, "there is no such pin, slot or guide", suggestion(name, known)))
    able = [one for one in reversed(pins[letter]) if _is_alone(mechanism, one, letter)]
    if link and link not in able:
        what = f"another pair is at {letter} on {link}, and would be moved too"
        raise InvalidInput(Problem(where, what, _others(able, letter)))
    if not link and len(pins[letter]) > 2:
        what = f"{count_phrase(len(pins[letter]), 'link')} meet there, and it is ambiguous which has clearance"
        raise InvalidInput(Problem(where, what, _others(able, letter)))
    if not able:
        raise InvalidInput(Problem(where, "other pairs are at this point on each of its links", _others(able, letter)))
    return f"{link or able[0]}.{letter}"


def _is_alone(mechanism: Mechanism, link: str, letter: str) -> bool:
    """Return whether a pin is the only pair at a point of a rigid link."""
    pairs = mechanism.written_pairs
    return link in mechanism.rigid_links and not any(link in one.members and letter in one.letters for one in pairs)


def _others(able: list[str], letter: str) -> str:
    if not able:
        return "leave it out, and give tolerances of dimensions there instead"
    return f"name them, as {f'{able[0]}.{letter}'!r}; there may be {', '.join(f'{one}.{letter}' for one in able)}"


@dataclass(frozen=True)
class PinClearance(ErrorSource):
    """One link's copy of a pinned point, displaced by the radial clearance in any direction.

    The pin touches the hole, so each coordinate has the variance of a cosine, half the square of the clearance. Source:
    S. J. Lee, B. J. Gilmore, Trans. ASME J. Mech. Des. 113 (1991) 84-90, the effective length of loose links.
    """

    radius: float

    @property
    def limits(self) -> tuple[float, float]:
        """The clearance to either side."""
        return -self.radius, self.radius

    @property
    def columns(self) -> int:
        """One: the angle of contact."""
        return 1

    def errors(self, units: Number) -> Number:
        """Return places on the circle, uniformly distributed."""
        angle = 2.0 * np.pi * units[:, 0]
        return self.radius * np.array([np.cos(angle), np.sin(angle)])

    def worst(self, slopes: Sequence[Number]) -> Number:
        """Return the clearance times the steepest slope of all directions."""
        return np.hypot(*slopes) * self.radius

    def variance(self, slopes: Sequence[Number]) -> Number:
        """Return half the square of the clearance times that of the steepest slope."""
        return np.sum(np.square(slopes), axis=0) * self.radius**2 / 2


@dataclass(frozen=True)
class FlankClearance(ErrorSource):
    """The offset of a slot or guide, displaced by half the play to either side with equal probability.

    A block does not tilt by it: its angle has a tolerance of its own.
    """

    half: float

    @property
    def limits(self) -> tuple[float, float]:
        """Half the play to either side."""
        return -self.half, self.half

    def errors(self, units: Number) -> Number:
        """Return one of the two for each design."""
        return self.half * np.where(units < 0.5, -1.0, 1.0).T

    def worst(self, slopes: Sequence[Number]) -> Number:
        """Return the slope times half the play."""
        return np.abs(slopes[0]) * self.half

    def variance(self, slopes: Sequence[Number]) -> Number:
        """Return the square of slope times half the play."""
        return (slopes[0] * self.half) ** 2


# The dimension of slots and guides that their clearance changes.
OFFSET = "offset"


def straight_guides(mechanism: Mechanism) -> dict[str, Any]:
    """Return the straight guides and slots that are written out, by name."""
    found = {pair.name: pair for pair in pairs_among(mechanism.items)}
    return {name: pair for name, pair in found.items() if any(key.name == OFFSET for key in pair.keys)}


def with_stated_offsets(mechanism: Mechanism, names: Sequence[str]) -> Mechanism:
    """Return the mechanism with the named offsets stated; one neither written nor read off the drawing is 0.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.pairs import slide
    >>> way = slide("block", on="frame", through="O", at="B", name="way")
    >>> press = Mechanism("m", link("frame", O=0), link("block", B=0), way, drive("block"))
    >>> with_stated_offsets(press, ["way.offset"]).written_pairs[0].offset
    0.0
    """
    asked = {name: pair for name, pair in straight_guides(mechanism).items() if f"{name}.{OFFSET}" in names}
    if not asked:
        return mechanism
    ends = {pair.name: pair.ends(mechanism.geometry) for pair in mechanism.written_pairs}
    known = StatedDimensions(mechanism, ends).known
    lacking = [pair for name, pair in asked.items() if f"{name}.{OFFSET}" not in known]
    return mechanism.replace(*(replace(pair, offset=0.0) for pair in lacking))
