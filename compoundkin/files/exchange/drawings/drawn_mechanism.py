"""From a drawing to a mechanism: links by letters, a table of where they are drawn, pairs, drivers."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import Any

from compoundkin.base.display import abbreviated_list, count_phrase
from compoundkin.base.errors import InvalidInput, InvalidMechanism, LikelySlip, Problem
from compoundkin.files.exchange.drawings.drawn_drivers import drivers_of
from compoundkin.files.exchange.drawings.drawn_elements import Drawing
from compoundkin.files.exchange.drawings.drawn_letters import SAME, DrawnLetters, check
from compoundkin.files.exchange.drawings.drawn_loads import loads_of
from compoundkin.files.exchange.drawings.drawn_pairs import pairs_of
from compoundkin.files.exchange.exchanged import Imported
from compoundkin.files.exchange.problems import Problems
from compoundkin.model.attributes import OF_POINTS
from compoundkin.model.elements import Item, drawn, link
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair

# A mechanism of more elements than this takes longer to look at than anybody waits; the largest known have hundreds.
MOST = 2000


def mechanism_of(drawing: Drawing, form: str, where: str = "") -> Imported:
    """Return the mechanism that a drawing shows. Its assembly mode is the one drawn.

    `form` is the word of the format it was read from, `where` the file. Raises InvalidInput where the drawing is of
    more elements than can be looked at, or names what is not there; InvalidMechanism for what cannot be a mechanism.
    """
    problems = Problems(where)
    many = len(drawing.points) + len(drawing.links) + len(drawing.guides)
    if many > MOST:
        problems.add("", f"it has {many} links, points and guides", f"at most {MOST} are read")
        problems.raise_if_any()
    check(drawing, problems)
    problems.raise_if_any()
    letters = DrawnLetters(drawing)
    try:
        pairs = pairs_of(drawing, letters)
        mechanism, notes = _built(drawing, letters, pairs)
    except InvalidMechanism as error:
        told = [_translated(problem, drawing, letters) for problem in error.problems]
        raise InvalidInput(told, heading=f"{where or drawing.title or form}: it cannot be a mechanism") from None
    return Imported(mechanism, form, (*drawing.notes, *_renamed(letters), *notes, *_left_out(drawing)))


def _built(drawing: Drawing, letters: DrawnLetters, pairs: dict[str, Pair]) -> tuple[Mechanism, list[str]]:
    items: list[Item] = [*_links(letters), *pairs.values(), drawn(**letters.places)]
    notes: list[str] = []
    drivers = drivers_of(drawing, letters, pairs, notes)
    about: dict[str, Any] = {"unit": drawing.unit, "source": drawing.source}
    about["outputs"] = tuple(f"{letters.point[key]}.{OF_POINTS[0]}" for key in drawing.outputs)
    mechanism = Mechanism(drawing.title or "Mechanism", *items, *drivers, **about)
    if not (drawing.masses or drawing.forces or drawing.gravity):
        return mechanism, notes
    loads = loads_of(drawing, letters, mechanism, notes)
    if drawing.units is not None:
        about["unit"], about["units"] = "", dict(zip(("length", "mass", "force"), drawing.units, strict=True))
    with warnings.catch_warnings(record=True) as said:
        # what is odd in another program's file is told with what else is told of it
        warnings.simplefilter("always", LikelySlip)
        whole = Mechanism(mechanism.title, *items, *drivers, *loads, **about)
    return whole, [*notes, *(str(one.message) for one in said)]


def _links(letters: DrawnLetters) -> Iterator[Item]:
    """Yield the links by their letters; one whose points are all at one place by these, for nothing is read off."""
    for key, name in letters.link.items():
        own = letters.ordered(key)
        if key != FRAME and len(own) > 1 and letters.axis(key) is None:
            yield link(name, **dict.fromkeys(own, 0j))
        else:
            yield link(name, *own)


def _translated(problem: Problem, drawing: Drawing, letters: DrawnLetters) -> Problem:
    """Return a problem of the mechanism in the words of its file, with points that may be meant to be joined."""
    found = next((one for one in drawing.links if problem.where == f"links.{letters.link[one.key]}"), None)
    if found is None:
        return problem
    hint = next((text for point in drawing.points_of(found.key) for text in _coinciding(point.key, drawing)), "")
    place = found.where or f"link {found.called}"
    return Problem(place, f"link {found.called!r}: {problem.what}", hint or problem.remedy)


def _coinciding(key: str, drawing: Drawing) -> Iterator[str]:
    point = next(one for one in drawing.points if one.key == key)
    for other in drawing.points:
        if other.key != key and abs(other.at - point.at) <= SAME * (abs(point.at) + 1.0):
            yield f"did you mean to join {point.called} and {other.called}, which are at one place?"


def _renamed(letters: DrawnLetters) -> Iterator[str]:
    changed = [f"{old!r} is {new!r}" for old, new in letters.names.changed]
    if changed:
        yield f"names are unique here, without dots and commas: {abbreviated_list(changed)}"


def _left_out(drawing: Drawing) -> Iterator[str]:
    """Yield the one note that counts what is not kinematic."""
    said = [count_phrase(many, what) for what, many in drawing.dropped if many]
    if said:
        yield f"left out, for it does not move anything: {', '.join(said)}"
