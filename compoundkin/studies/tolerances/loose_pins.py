"""Which dimension a clearance changes: of a pin one link's own copy of the point, of a slot its offset."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from compoundkin.base.arguments import real_numbers
from compoundkin.base.display import count_phrase, short_repr
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.model.mechanism import Mechanism
from compoundkin.studies.tolerances.flank_clearance import FlankClearance
from compoundkin.studies.tolerances.given_errors import GivenError
from compoundkin.studies.tolerances.pin_clearance import PinClearance
from compoundkin.studies.tolerances.stated_offsets import OFFSET, guides_of


def given_clearances(mechanism: Mechanism, clearances: Mapping[str, Any]) -> list[GivenError]:
    """Return what clearances of pins, slots and guides are.

    Pins are named "C", or "plate.C" where the plate is loose on it; slots and guides by their names. Raises UnknownName
    for what there is not, InvalidInput where it is open which link is loose, and for no clearance.
    """
    return [_clearance(mechanism, name, given) for name, given in clearances.items()]


def _clearance(mechanism: Mechanism, name: str, given: Any) -> GivenError:
    half = _half(name, given)
    if name in guides_of(mechanism):
        return GivenError(
            f"{name}.{OFFSET}", lambda numbers, unit, own: FlankClearance(f"clearance {name}", numbers, unit, half)
        )
    point = loose_point(mechanism, name)
    return GivenError(point, lambda numbers, unit, own: PinClearance(f"clearance {name}", numbers, unit, half))


def _half(name: str, given: Any) -> float:
    where = f"clearance.{name}"
    found = real_numbers(where, given)
    if found.shape != () or not np.isfinite(found) or found < 0:
        raise InvalidInput(Problem(where, f"{short_repr(given)} is no clearance", "give half the play, 0.02"))
    return float(found)


def loose_point(mechanism: Mechanism, name: str) -> str:
    """Return the name of the point that a loose pin moves.

    Of a pin of two links it is that of one which no other pair uses: the pin alone is then off.
    """
    where, pins = f"clearance.{name}", mechanism.real_pins
    link, _, letter = name.rpartition(".")
    if letter not in pins or (link and link not in pins[letter]):
        known = [*pins, *guides_of(mechanism), *(f"{one}.{pin}" for pin, links in pins.items() for one in links)]
        raise UnknownName(Problem(where, "there is no such pin, slot or guide", suggestion(name, known)))
    able = [one for one in reversed(pins[letter]) if _is_alone(mechanism, one, letter)]
    if link and link not in able:
        what = f"another pair is at {letter} on {link}, and would be moved too"
        raise InvalidInput(Problem(where, what, _others(able, letter)))
    if not link and len(pins[letter]) > 2:
        what = f"{count_phrase(len(pins[letter]), 'link')} meet there, and it is open which are loose on the pin"
        raise InvalidInput(Problem(where, what, _others(able, letter)))
    if not able:
        raise InvalidInput(Problem(where, "other pairs are at this point on each of its links", _others(able, letter)))
    return f"{link or able[0]}.{letter}"


def _is_alone(mechanism: Mechanism, link: str, letter: str) -> bool:
    """Whether a pin is all that is at a point of a link, whose place is written out."""
    pairs = mechanism.written_pairs
    return link in mechanism.rigid_links and not any(link in one.members and letter in one.letters for one in pairs)


def _others(able: list[str], letter: str) -> str:
    if not able:
        return "leave it out, and give tolerances of dimensions there instead"
    return f"name them, as {f'{able[0]}.{letter}'!r}; there may be {', '.join(f'{one}.{letter}' for one in able)}"
