"""How a vector loop crosses a pair: from a point of one link to a point of the other, by what is free or known."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from compoundkin.analysis.equations.terms import Curved, Sum, Term, Unknown, Values, Vector
from compoundkin.base.poses import End
from compoundkin.base.series import Number, Series
from compoundkin.model.elements import FRAME
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends
from compoundkin.model.pairs.geared import ratio
from compoundkin.model.pairs.pitch_line import OnLine
from compoundkin.model.pairs.profiled import Profiled


@dataclass(frozen=True, eq=False)
class Auxiliary:
    """An equation of angles and displacements that a pair adds: ``sum = 0``.

    With a `path` it is the part of a vector sum along a direction that is added: a rack is held to its pinion. Angles
    count whole turns only where the pair does (`counts_turns`).
    """

    pair: str
    sum: Sum
    path: tuple[Term, ...] = ()
    along: Sum = field(default_factory=Sum)
    counts_turns: bool = False

    def at(self, values: Values) -> Number:
        """What is to be zero."""
        total = self.sum.at(values)
        if self.path:
            vector = sum((term.at(values) for term in self.path), 0j)
            total = total + (vector * np.exp(-1j * self.along.at(values))).real
        return total if self.counts_turns else np.angle(np.exp(1j * total))


@dataclass(frozen=True, eq=False)
class PairTerms:
    """The points of a pair on its first two members, the vectors from one to the other, and what it adds.

    `unknown` is what the pair leaves free, None for a pin. A `label` names each point.
    """

    points: tuple[Number, Number]
    labels: tuple[str, str]
    arms: tuple[Term, ...] = ()
    unknown: Unknown | None = None
    auxiliary: Auxiliary | None = None


def _turn(end: End) -> Number:
    """The angle of a guide, a block or a face on its link."""
    return np.angle(end.along.c[0])


def _point(end: End) -> Number:
    return end.point.c[0] if isinstance(end.point, Series) else end.point


def angle_of(link: str) -> Sum:
    """The angle of a link; that of the frame is zero.

    >>> angle_of("frame").parts
    ()
    """
    return Sum() if link == FRAME else Sum(0.0, ((1.0, Unknown("angle", link)),))


def difference(first: Sum, second: Sum) -> Sum:
    """The second sum less the first.

    >>> difference(angle_of("a"), angle_of("b")).at({"a": 1.0, "b": 3.0})
    2.0
    """
    taken = tuple((-factor, unknown) for factor, unknown in first.parts)
    return Sum(second.constant - first.constant, (*second.parts, *taken))


def crossing(pair: Pair, ends: Ends) -> PairTerms | None:
    """How a loop crosses a pair; None for gears, belts and racks, which close no loop of vectors of their own."""
    if pair.is_simple:
        return _simple(pair, ends)
    if pair.held == 1 and pair.counts_turns:
        return None
    found = pair.equivalent(ends)
    if found is not None:
        return _by_lower_pairs(pair, found.pairs, [found.ends[lower.name] for lower in found.pairs])
    if isinstance(pair, Profiled):
        return _profiled(pair, ends)
    return _rolling_on_line(pair, ends) if isinstance(pair, OnLine) else _rolling_on_circle(pair, ends)


def relation(pair: Pair, ends: Ends) -> Auxiliary | None:
    """The angles that a gear pair or a belt ties; None for other pairs."""
    if not pair.adds_angles:
        return None
    first, second, carrier = (angle_of(name) for name in pair.members)
    one, two = difference(carrier, first), difference(carrier, second)
    k = ratio(ends)
    parts = (*two.parts, *((k * factor, unknown) for factor, unknown in one.parts))
    return Auxiliary(pair.name, Sum(-ends[2].measure, _collected(parts)), counts_turns=True)


def _collected(parts: tuple[tuple[Number, Unknown], ...]) -> tuple[tuple[Number, Unknown], ...]:
    total: dict[Unknown, Number] = {}
    for factor, unknown in parts:
        total[unknown] = total.get(unknown, 0.0) + factor
    return tuple((factor, unknown) for unknown, factor in total.items())


def _simple(pair: Pair, ends: Ends) -> PairTerms:
    """A pin, or a slide along the guide of the first member."""
    points = ends[0].point, ends[1].point
    if pair.free_is_angle:
        return PairTerms(points, (pair.letters[0], pair.letters[0]))
    free = Unknown("displacement", pair.name)
    guide = angle_of(pair.members[0]).plus(_turn(ends[0]))
    block = angle_of(pair.members[1]).plus(_turn(ends[1]))
    arm = Vector("", Sum(0.0, ((1.0, free),)), guide)
    return PairTerms(
        points, (_guide(pair), pair.letters[0]), (arm,), free, Auxiliary(pair.name, difference(guide, block))
    )


def _guide(pair: Pair) -> str:
    """The point of the guide from which the displacement counts."""
    return f"{pair.letters[1]}'"


def _by_lower_pairs(pair: Pair, lower: tuple[Pair, Pair], ends: list[Ends]) -> PairTerms:
    """A pin in a slot, a disc: the block that slides there has its guide's angle, the bar one of its own."""
    outside = [next(k for k, name in enumerate(p.members) if name in pair.members) for p in lower]
    points = _point(ends[0][outside[0]]), _point(ends[1][outside[1]])
    inner = _point(ends[1][1 - outside[1]]) - _point(ends[0][1 - outside[0]])
    labels = lower[0].letters[0], lower[1].letters[0]
    slides = [k for k, p in enumerate(lower) if not p.free_is_angle]
    if not slides:
        free = Unknown("direction", pair.name)
        bar = Vector(f"r({pair.name})", Sum(np.abs(inner)), Sum(np.angle(inner), ((1.0, free),)))
        return PairTerms(points, labels, (bar,), free)
    k = slides[0]
    free = Unknown("displacement", pair.name)
    guide = angle_of(lower[k].members[0]).plus(_turn(ends[k][0]))
    # toward the block where the guide is on the first member, from it where it is on the second
    arm = Vector("", Sum(0.0, ((1.0, free),)), guide, 1 if k == 0 else -1)
    sides = (_guide(lower[0]), labels[1]) if k == 0 else (labels[0], _guide(lower[1]))
    return PairTerms(points, sides, (arm,), free)


def _profiled(pair: Profiled, ends: Ends) -> PairTerms:
    """From the origin of the profile's link to the contact, and on to the roller's middle or the face's point."""
    first, second = (angle_of(name) for name in pair.members)
    labels = f"origin of {pair.members[0]}", pair.letters[0]
    curve, points = pair.curve, (ends[0].point, ends[1].point)
    if not pair.is_flat:
        free = Unknown("parameter", pair.name)
        away = ends[1].measure * pair.outward
        contact = Curved(f"profile({free.key})", lambda values: curve.at(values[free.key]).c[0], first)
        normal = Curved(f"normal({free.key})", lambda values: away * curve.normal(values[free.key]).c[0], first)
        return PairTerms(points, labels, (contact, normal) if np.any(away != 0.0) else (contact,), free)
    free = Unknown("displacement", pair.name)
    face = second.plus(_turn(ends[1]))
    toward = difference(first, face)
    flat: Any = pair
    side = -1j * flat.side

    def touched(values: Values) -> Number:
        return curve.at(curve.support(np.exp(1j * toward.at(values)) * side).c[0]).c[0]

    arms = Curved(f"contact({pair.name})", touched, first), Vector("", Sum(0.0, ((1.0, free),)), face, -1)
    return PairTerms(points, labels, arms, free)


def _rolling_on_line(pair: Pair, ends: Ends) -> PairTerms:
    """Along the line and out to the wheel's middle."""
    free = Unknown("displacement", pair.name)
    on, wheel = (angle_of(name) for name in pair.members)
    along, radius = on.plus(_turn(ends[0])), ends[1].measure
    out = Vector(f"r({pair.name})", Sum(np.abs(radius)), along.plus(np.pi / 2.0), int(np.sign(np.ravel(radius)[0])))
    turned = tuple((radius * factor, unknown) for factor, unknown in difference(on, wheel).parts)
    rolled = Auxiliary(pair.name, Sum(-ends[0].measure, ((1.0, free), *turned)), counts_turns=True)
    arms = Vector("", Sum(0.0, ((1.0, free),)), along), out
    return PairTerms((ends[0].point, ends[1].point), (_guide(pair), pair.letters[0]), arms, free, rolled)


def _rolling_on_circle(pair: Pair, ends: Ends) -> PairTerms:
    """From the middle of the circle to that of the wheel."""
    free = Unknown("direction", pair.name)
    on, wheel = (angle_of(name) for name in pair.members)
    line = Sum(_turn(ends[0]), (*on.parts, (1.0, free)))
    turned = difference(on, wheel)
    rolled = Sum(-ends[0].measure, (*turned.parts, (-ends[1].measure, free)))
    arm = Vector(f"r({pair.name})", Sum(np.abs(ends[0].along.c[0])), line)
    points, labels = (ends[0].point, ends[1].point), (pair.letters[1], pair.letters[0])
    return PairTerms(points, labels, (arm,), free, Auxiliary(pair.name, rolled, counts_turns=True))
