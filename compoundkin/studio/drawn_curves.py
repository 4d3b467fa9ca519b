"""Replies to the pen: linkages for a curve drawn by hand, the nearest of an atlas at once, then refined ones.

Three questions bring better and better answers, each slower: `near` are designs of the atlas as they are, `fitted` the
best of them refined, `traced` what `synthesise` finds for the task, verified. `atlas` makes the atlas before a curve is
there. Each suggestion is a whole document, with what a thumbnail of it needs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from math import floor, log10
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.arrays import LONGEST, Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.model.geometry import FRAME

if TYPE_CHECKING:
    from compoundkin.dimensional.candidates import Linkage
    from compoundkin.dimensional.coupler_atlas import AtlasMatch, CouplerAtlas
    from compoundkin.dimensional.curve_chains import CurveChain, Laying

Reply: TypeAlias = dict[str, Any]

# Questions whose replies are awaited while the pen rests.
AT_ONCE = ("atlas", "near", "fitted")
# Designs of the atlas that first answers are taken from: made in two seconds, once.
DESIGNS = 30_000
# A curve may have so many points.
MOST_POINTS = 2_000
# So many suggestions are given, of one kind of linkage so many; designs that are looked at for them, and how many of
# four links are refined with the others.
GIVEN, OF_A_KIND, LOOKED_AT, SIMPLE = 8, 2, 32, 8
# Poses of a path, and digits of a linkage's size to which its dimensions are written: a path moves by less than a pen
# is wide.
POSES, EXACT = 96, 7


class PenCurve(NamedTuple):
    """What a question says of a curve: its places, whether it is closed, and the most links."""

    points: Number
    closed: bool
    links: int

    @classmethod
    def of(cls, question: Mapping[str, Any]) -> PenCurve:
        """Return the curve of a question. Raises InvalidInput for what is none."""
        from compoundkin.dimensional import task_words

        points, closed, links = question.get("points"), question.get("closed"), question.get("links", 6)
        if not isinstance(points, list) or len(points) > MOST_POINTS or not all(map(_is_place, points)):
            what = "these are no points of a curve"
            raise InvalidInput(Problem("points", what, f"give [x, y] of each, at most {MOST_POINTS}"))
        if not isinstance(links, int) or not (closed is None or isinstance(closed, bool)):
            what = "it is not said how many links, or whether it is closed"
            raise InvalidInput(Problem("links, closed", what, "give 4, 6 or 8, and true or false"))
        task = task_words.curve(np.array(points, float).reshape(-1, 2), closed=closed, links=links)
        return cls(task.points, task.closed, links)


def _is_place(given: Any) -> bool:
    numbers = given if isinstance(given, list | tuple) and len(given) == 2 else [None]
    return all(isinstance(one, int | float) and not isinstance(one, bool) and abs(one) <= LONGEST for one in numbers)


def atlas(question: Mapping[str, Any]) -> Reply:
    """Reply how many designs the atlas has, which is there from then on."""
    return {"designs": len(_atlas()), "problems": []}


def _atlas() -> CouplerAtlas:
    from compoundkin.dimensional.coupler_atlas import coupler_atlas

    return coupler_atlas(6, DESIGNS)


def _nearest(curve: PenCurve, count: int, links: int) -> list[AtlasMatch]:
    """Return designs of the atlas near a curve, of so many links at most, though it may have none of so many."""
    atlas = _atlas()
    most = max(one for one in atlas.links if one <= links)
    return atlas.near(curve.points, count, closed=curve.closed, links=most)


def near(question: Mapping[str, Any]) -> Reply:
    """Reply the designs of the atlas whose curves are nearest to one, as they lie on it."""
    curve = PenCurve.of(question)
    matches = _nearest(curve, LOOKED_AT, curve.links)
    return _reply(curve, (_laid(curve, one.chain, one.design, one.laying) for one in matches))


def fitted(question: Mapping[str, Any]) -> Reply:
    """Reply the best of those designs refined to the curve, without growth."""
    from compoundkin.dimensional.curve_fitting import fitted as refined

    curve = PenCurve.of(question)
    matches = _nearest(curve, LOOKED_AT, curve.links)
    if curve.links > 4:  # seldom the nearest, and often what one wants
        matches += _nearest(curve, SIMPLE, 4)
    found = refined(matches, curve.points, curve.closed, curve.links, rounds=0)
    return _reply(curve, (_laid(curve, one.chain, one.design, one.laying) for one in found))


def traced(question: Mapping[str, Any]) -> Reply:
    """Reply what `synthesise` finds for the curve: of a larger atlas, grown and refined, each verified."""
    from compoundkin.dimensional import task_words
    from compoundkin.dimensional.candidates import POINT
    from compoundkin.dimensional.synthesis import synthesise

    curve = PenCurve.of(question)
    answer = synthesise(task_words.curve(curve.points, closed=curve.closed, links=curve.links))
    solved = [(one.candidate, np.ravel(one.motion.points[POINT].position), one.error) for one in answer]
    return _reply(curve, (_Suggestion(*one) for one in solved))


class _Suggestion(NamedTuple):
    """A linkage, the path of its point over a turn, and how far that is off the curve, as a mean."""

    linkage: Linkage
    path: Number
    error: float


def _laid(curve: PenCurve, chain: CurveChain, design: Number, laying: Laying) -> _Suggestion:
    """Return a design where it lies on a curve."""
    from compoundkin.dimensional.candidates import POINT
    from compoundkin.dimensional.curve_chains import turn

    linkage = chain.linkage(np.asarray(design, float), laying, turn(POSES))
    link = next(one for one in linkage.links if POINT in one.points)
    path: Number = linkage.z[link.name] + linkage.u[link.name] * link.points[POINT]
    return _Suggestion(linkage, np.append(path, path[0]), _error(path, curve))


def _error(path: Number, curve: PenCurve) -> float:
    """Return the mean distance from a curve to a path, of a closed one also back: the rest of an open one is free."""
    from compoundkin.dimensional.curve_likeness import nearest_distances, resampled

    one, two = resampled(path[None], 4 * POSES)[0], resampled(curve.points[None], 4 * POSES, curve.closed)[0]
    there = float(nearest_distances(two, one, True).mean())
    return (there + float(nearest_distances(one, two, True).mean())) / 2.0 if curve.closed else there


def _reply(curve: PenCurve, found: Iterable[_Suggestion]) -> Reply:
    """Reply the best suggestions, few of a kind, the nearest first, each a document with what its picture needs.

    The best of each number of links is among them.
    """
    ranked = sorted(found, key=lambda one: one.error)
    kinds, kept = dict[str | int, int](), list[_Suggestion]()
    for one in ranked:
        title, links = one.linkage.title, len(one.linkage.links)
        if links not in kinds or (kinds.get(title, 0) < OF_A_KIND and len(kept) < GIVEN):
            kept.append(one)
            kinds |= {title: kinds.get(title, 0) + 1, links: 1}
    return {"closed": curve.closed, "suggestions": list(map(_plain, kept)), "problems": []}


def _plain(one: _Suggestion) -> Reply:
    """Return a suggestion as plain data."""
    from compoundkin.files.mechanism_files import written_text
    from compoundkin.files.writer import document

    linkage = one.linkage
    digits = EXACT - floor(log10(linkage.span))
    driver = next(iter(linkage.drivers))
    text = written_text(_rounded(document(linkage.mechanism(driver)), digits), "toml")
    return {
        "title": linkage.title,
        "links": len(linkage.links),
        "error": float(f"{one.error:.2g}"),
        "text": text,
        "path": [_row(one.path.real, digits), _row(one.path.imag, digits)],
        "points": {letter: [*_row([place.real, place.imag], digits)] for letter, place in linkage.places.items()},
        "bars": [list(item.points) for item in linkage.links if item.name != FRAME],
        "ground": next(list(item.points) for item in linkage.links if item.name == FRAME),
    }


def _row(values: Any, digits: int) -> list[float]:
    return [float(one) + 0.0 for one in np.round(np.asarray(values, float), digits)]


def _rounded(value: Any, digits: int, key: str = "") -> Any:
    """Return a document with its lengths rounded to so many digits, and angles, in degrees, to EXACT."""
    if isinstance(value, dict):
        return {name: _rounded(inner, digits, name) for name, inner in value.items()}
    if isinstance(value, list):
        return [_rounded(inner, digits, key) for inner in value]
    return round(value, EXACT if key == "angle" else digits) + 0.0 if isinstance(value, float) else value


# Questions of the pen, for which no document is needed.
OF_CURVES: Mapping[str, Callable[[Mapping[str, Any]], Reply]] = {
    "atlas": atlas,
    "near": near,
    "fitted": fitted,
    "traced": traced,
}
