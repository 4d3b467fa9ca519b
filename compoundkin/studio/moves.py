"""Points that are moved and links that are lengthened, while lengths, directions, places and guides are held.

The moved points go as near to where they are put as what is held allows, the others as little as they can: Newton's
method on the conditions, in each step the least squares of the way that is left under the linearised conditions.

Source: J. Nocedal, S. J. Wright, Numerical Optimization (2nd ed.), 18.1 (sequential quadratic programming).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.model.geometry import FRAME
from compoundkin.studio.edited_document import (
    POINT_KEYS,
    Edit,
    EditedDocument,
    direction_of,
    place_in,
    refused,
    word_in,
)

# How much less a point wants to stay than a moved one wants to go.
STAYING = 1e-3
STEPS, CLOSE = 80, 1e-11


@dataclass(frozen=True)
class HeldLength:
    """Two points keep their distance."""

    first: str
    second: str
    length: float

    @property
    def letters(self) -> tuple[str, ...]:
        """The points that it holds."""
        return self.first, self.second

    def condition(self, at: Mapping[str, complex]) -> tuple[float, dict[str, complex]]:
        """Return how far it is from being held, and its slope at each point."""
        line = at[self.second] - at[self.first]
        along = line / (abs(line) or 1.0)
        return abs(line) - self.length, {self.first: -along, self.second: along}


@dataclass(frozen=True)
class HeldLine:
    """The way from one point to another keeps a direction: a unit vector."""

    first: str
    second: str
    direction: complex

    @property
    def letters(self) -> tuple[str, ...]:
        """The points that it holds."""
        return self.first, self.second

    def condition(self, at: Mapping[str, complex]) -> tuple[float, dict[str, complex]]:
        """Return how far it is from being held, and its slope at each point."""
        across = 1j * self.direction
        away = ((at[self.second] - at[self.first]) * across.conjugate()).real
        return away, {self.first: -across, self.second: across}


@dataclass(frozen=True)
class HeldOnLine:
    """A point keeps its distance from the line through two others."""

    point: str
    first: str
    second: str
    away: float

    @property
    def letters(self) -> tuple[str, ...]:
        """The points that it holds."""
        return self.point, self.first, self.second

    def condition(self, at: Mapping[str, complex]) -> tuple[float, dict[str, complex]]:
        """Return how far it is from being held, and its slope at each point."""
        line, here = at[self.second] - at[self.first], at[self.point] - at[self.first]
        long = abs(line) or 1.0
        along = line / long
        across, part = 1j * along, (here * along.conjugate()).real / long
        away = (here * across.conjugate()).real
        return away - self.away, {self.point: across, self.first: -(1 - part) * across, self.second: -part * across}


Held: TypeAlias = HeldLength | HeldLine | HeldOnLine


def moved_points(
    places: Mapping[str, complex], put: Mapping[str, complex], held: Sequence[Held], fixed: Sequence[str]
) -> dict[str, complex]:
    """Return where all points go when some are put elsewhere. Raises InvalidInput where what is held leaves no place.

    >>> held = [HeldLength("A", "B", 2.0)]
    >>> found = moved_points({"A": 0j, "B": 2 + 0j}, {"B": 3j}, held, ["A"])
    >>> round(abs(found["B"] - 2j), 9)
    0.0
    """
    letters = sorted({*places} - {*fixed})
    index = {letter: 2 * k for k, letter in enumerate(letters)}
    wanted = {**places, **{k: v for k, v in put.items() if k in index}}
    weights = np.repeat([1.0 if k in put else STAYING**2 for k in letters], 2)
    size = max((abs(one - other) for one in places.values() for other in places.values()), default=1.0) or 1.0
    # what is put far away is gone to from where the conditions are known to hold
    at, held = dict(places), [one for one in held if any(k in index for k in one.letters)]
    for _ in range(STEPS):
        left = _pairs(np.array([wanted[k] - at[k] for k in letters]))
        values, slopes = _conditions(at, held, index)
        step = _step(weights, left, values, slopes)
        far = float(np.max(np.abs(step), initial=0.0))
        step *= min(1.0, 0.25 * size / far) if far else 1.0
        at |= {k: at[k] + complex(step[i], step[i + 1]) for k, i in index.items()}
        if far <= CLOSE * size:
            break
    values, _ = _conditions(at, held, index)
    if not np.all(np.abs(values) <= 1e-9 * size):
        raise InvalidInput(Problem("", "what is locked leaves no place there", "unlock a length, an angle or a point"))
    return at


def _step(weights: Number, left: Number, values: Number, slopes: Number) -> Number:
    """Return the step of least weighted squares from what is left, under the linearised conditions."""
    if not len(values):
        return left
    # conditions may say the same twice: the least norm of their multipliers
    inverse = 1.0 / weights
    system = (slopes * inverse) @ slopes.T
    multipliers = np.linalg.lstsq(system, slopes @ left + values, rcond=1e-12)[0]
    return left - inverse * (slopes.T @ multipliers)


def _conditions(at: Mapping[str, complex], held: Sequence[Held], index: Mapping[str, int]) -> tuple[Number, Number]:
    """Return how far each condition is from being held, and its slopes by the coordinates of the free points."""
    values, slopes = np.zeros(len(held)), np.zeros((len(held), 2 * len(index)))
    for row, one in enumerate(held):
        values[row], by_point = one.condition(at)
        for letter, slope in by_point.items():
            if letter in index:
                slopes[row, index[letter] : index[letter] + 2] += slope.real, slope.imag
    return values, slopes


def _pairs(values: Number) -> Number:
    """Return real and imaginary parts in turn."""
    return np.column_stack((values.real, values.imag)).ravel()


# --- the edits -----------------------------------------------------------------------------------------------


def move(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Move points: the coordinates of the links that have some, and the drawing. What is locked is held."""
    several = edit.get("points")
    put = (
        {str(letter): place_in(place) for letter, place in several.items()}
        if isinstance(several, dict) and several
        else {word_in(edit, "point"): place_in(edit.get("to"))}
    )
    for letter in put:
        sheet.carriers(letter)
    held, fixed = _locks(sheet, edit.get("locks"))
    if held or fixed:
        held += _guides(sheet)
        places = moved_points(sheet.drawing.places, put, held, fixed)
    else:
        places = put | _moved_guides(sheet, put)
    return _moved(sheet, places)


def _moved(sheet: EditedDocument, places: Mapping[str, complex]) -> dict[str, Any]:
    """Write where points have gone."""
    least = 1e-12 * sheet.drawing.size
    gone = {k: p for k, p in places.items() if abs(p - sheet.drawing.places.get(k, p + 1)) > least}
    sheet.put_all(gone)
    return {"places": {k: [p.real, p.imag] for k, p in gone.items()}}


def _locks(sheet: EditedDocument, locks: Any) -> tuple[list[Held], list[str]]:
    """Return what is locked: lengths and directions between two points, and points. Of what is no more, nothing."""
    held, fixed, known = list[Held](), list[str](), sheet.drawing.places
    for lock in locks if isinstance(locks, list) else ():
        letters = [k for k in lock.get("points", ()) if k in known] if isinstance(lock, dict) else []
        if isinstance(lock, dict) and lock.get("what") == "point":
            fixed += letters
        elif len(letters) == 2 and known[letters[0]] != known[letters[1]]:
            line = known[letters[1]] - known[letters[0]]
            is_length = lock.get("what") == "length"
            first, second = letters
            held.append(
                HeldLength(first, second, abs(line)) if is_length else HeldLine(first, second, line / abs(line))
            )
    return held, fixed


def _guides(sheet: EditedDocument) -> list[Held]:
    """Return what slides and slots hold: their points on their lines, as far from them as they are drawn."""
    held, known = list[Held](), sheet.drawing.places
    for name, _, table in sheet.tables():
        at, through, toward = (table.get(key) for key in ("at", "through", "toward"))
        if name not in ("slides", "slots") or not isinstance(through, str):
            continue
        letters = list(sheet.points(table["link"])) if table.get("link") in sheet.links else []
        at = at if isinstance(at, str) else letters[0] if letters else ""
        if at not in known or through not in known or at == through:
            continue
        on = table.get("on", FRAME)
        if isinstance(toward, str) and toward in known:
            line = known[toward] - known[through]
            away = ((known[at] - known[through]) * line.conjugate()).imag / (abs(line) or 1.0)
            held.append(HeldOnLine(at, through, toward, away))
        elif on == FRAME:
            held.append(HeldLine(through, at, direction_of(sheet, table)))
    return held


def _moved_guides(sheet: EditedDocument, put: Mapping[str, complex]) -> dict[str, complex]:
    """Return where the guides on the frame go that only the slides of moved points have: beside them, not along."""
    found = dict[str, complex]()
    tables = list(sheet.tables())
    for name, _, table in tables:
        through = table.get("through")
        if name != "slides" or table.get("on", FRAME) != FRAME or "toward" in table or not isinstance(through, str):
            continue
        own = list(sheet.points(table["link"])) if table.get("link") in sheet.links else []
        at = table.get("at", own[0] if own else None)
        users = [other for _, _, other in tables if through in map(other.get, POINT_KEYS)]
        is_its_own = (
            len(users) == 1 and sheet.carriers(through) == [FRAME] if through in sheet.drawing.places else False
        )
        if at in put and through not in put and is_its_own and at in sheet.drawing.places:
            along, by = direction_of(sheet, table), put[at] - sheet.place(at)
            found[through] = sheet.place(through) + 1j * along * (by * along.conjugate()).imag
    return found


def lengthen(sheet: EditedDocument, edit: Edit) -> dict[str, Any]:
    """Give one link another length, and hold all other links, the frame and the direction of this one."""
    link, letter = word_in(edit, "link"), word_in(edit, "point")
    own = [k for k in sheet.points(link) if k in sheet.drawing.places]
    if letter not in own or len(own) < 2:
        raise refused(f"{link} has no length to {letter}", "choose an end of a bar")
    first = edit.get("from", next(k for k in sorted(own, key=lambda k: not sheet.is_fixed(k)) if k != letter))
    if first not in own or first == letter:
        raise refused(f"{link} has no point {first!r} to measure from", "choose another point of it")
    start, known = sheet.place(first), sheet.drawing.places
    line = sheet.place(letter) - start
    along = line / (abs(line) or 1.0)
    length = edit.get("length")
    if length is None:
        length = ((place_in(edit.get("to")) - start) * along.conjugate()).real
    if isinstance(length, bool) or not isinstance(length, int | float) or not isfinite(length) or length <= 0:
        raise refused(f"{length!r} is no length", "give a positive number")
    if FRAME in sheet.carriers(letter) and FRAME not in sheet.carriers(first):
        raise refused(f"{letter} is fixed", f"lengthen {link} at {first}, or move {letter}")
    held: list[Held] = [HeldLine(first, letter, along), HeldLength(first, letter, float(length)), *_guides(sheet)]
    for other in sheet.links:
        letters = [k for k in sheet.points(other) if k in known]
        pairs = [(a, b) for i, a in enumerate(letters) for b in letters[:i]]
        if other != FRAME:
            pairs = [(a, b) for a, b in pairs if other != link or letter not in (a, b)]
            held += [HeldLength(a, b, abs(known[a] - known[b])) for a, b in pairs if known[a] != known[b]]
    fixed = [k for k in known if k in sheet.links.get(FRAME, {}).get("points", ()) or k == first]
    more, others = _locks(sheet, edit.get("locks"))
    try:
        places = moved_points(known, {letter: start + along * length}, held + more, [*fixed, *others])
    except InvalidInput:
        what = f"the other links do not reach with {link} {sheet.number(length)} long"
        raise refused(what, "take a length nearer to what it was, or move the point with Shift") from None
    return _moved(sheet, places)
