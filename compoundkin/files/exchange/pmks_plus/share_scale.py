"""The unit and the scale that a mechanism is written in, so that three decimals are enough."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil, floor, log10

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.drawings.drawn_elements import Drawing
from compoundkin.files.exchange.drawings.drawn_letters import size_of
from compoundkin.files.exchange.pmks_plus.packed_numbers import MOST
from compoundkin.files.exchange.pmks_plus.shared_records import UNITS
from compoundkin.model.units import LENGTHS

# Of a mechanism this large a thousandth is 1e-5; smaller ones lose more.
_LARGE = 100.0
# Numbers this near to three decimals are of three decimals: what sums and quotients leave.
_EXACT = 1e-9
# How many marks fit beside each other, for the sizes that the program draws joints in.
_MARKS = 15.0
# By our unit of length, that of the program, where it is not the centimetre.
_NEAREST = {"in": 0, "ft": 0, "m": 2}


@dataclass(frozen=True)
class ShareScale:
    """What lengths are multiplied by, and the unit that they are then in.

    `enlarged` is by how much more than the change of unit asks for; `size` is that of the drawing as written.
    """

    length: int
    factor: float
    enlarged: float
    size: float

    @property
    def mark_size(self) -> float:
        """How large joints are drawn."""
        return max(round(self.size / _MARKS, 2), 0.01)

    def notes(self, unit: str) -> Iterator[str]:
        """Yield what is to be said of unit and scale."""
        written = UNITS[self.length][0]
        if not unit:
            yield f"the mechanism has no unit: its lengths are written as {written}"
        elif unit != written and self.enlarged == 1.0:
            yield f"lengths are in {written}, not in {unit}"
        if self.enlarged != 1.0:
            yield f"all lengths are {self.enlarged:g} times as large as they are, in {written}: scale=1 leaves them"


def share_scale(drawing: Drawing, asked: float | None) -> ShareScale:
    """Return the scale of a drawing, or the one asked for. Raises InvalidInput where numbers get too large.

    Small mechanisms are written larger where their places are not of three decimals, but for those with loads.
    """
    size = size_of(drawing)
    length = _NEAREST.get(drawing.unit, 1)
    if drawing.unit == "m" and size < _LARGE and not _is_exact(drawing, 1.0):
        length = 1
    convert = LENGTHS[drawing.unit] / LENGTHS[UNITS[length][0]] if drawing.unit in LENGTHS else 1.0
    enlarged = 1.0
    if asked is not None:
        enlarged = asked
    elif size * convert < _LARGE and not (_is_exact(drawing, convert) or drawing.masses or drawing.forces):
        enlarged = 10.0 ** ceil(log10(_LARGE / (size * convert)) - _EXACT)
    written = size * convert * enlarged
    if written * 1000.0 > MOST or max((abs(p.at) for p in drawing.points), default=0.0) * 1000.0 > MOST:
        what = f"it is {written:g} large, more than the program's numbers hold"
        raise InvalidInput(Problem(drawing.title, what, "give a smaller scale"))
    return ShareScale(length, convert * enlarged, enlarged, written)


def rounded(value: float) -> float:
    """Return a number as three decimals of it are read again."""
    return floor(value * 1000.0 + 0.5) / 1000.0


def _is_exact(drawing: Drawing, factor: float) -> bool:
    """Return whether all places are of three decimals."""
    places = [part * factor for point in drawing.points for part in (point.at.real, point.at.imag)]
    return all(abs(rounded(place) - place) <= _EXACT for place in places)
