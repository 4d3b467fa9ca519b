"""Assur groups from components of unknowns. Their bodies, their pairs and what each group is called.

A dyad is named by its pairs along the chain, outer-inner-outer, from the end that makes the name first in
the order of `pairs.KINDS`: RRP, not PRR. A larger group is named by the letters of its outer pairs, a dash,
and those of its inner pairs, both sorted: the class III triad of revolute pairs is RRR-RRR.

The order is the number of outer pairs, those by which the group is attached. The class is II for a dyad.
For a larger group it is that of its highest contour: a link with k pairs is a rigid contour of class k; a
closed loop of k links inside the group, in a shortest basis of its loops, is a changeable contour of class k
where k is four or more.
Source: I. I. Artobolevskii, Theory of Mechanisms and Machines, Nauka 1975, on the structure of planar
mechanisms.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from compoundkin.model.pairs import KINDS, Pair
from compoundkin.structure.composites import GROUND
from compoundkin.structure.cycles import cycle_basis, find
from compoundkin.structure.mobility_count import Body, Group
from compoundkin.structure.system import Constraint, System

_RANK = {code: rank for rank, code in enumerate(KINDS)}
# The least number of links in a loop that counts as a changeable contour: a loop of three is rigid.
_CHANGEABLE = 4
_LEAST_CLASS = 2
_NUMERALS = ((10, "X"), (9, "IX"), (5, "V"), (4, "IV"), (1, "I"))


def roman(number: int) -> str:
    """Return a class as it is printed.

    >>> roman(2), roman(4), roman(13)
    ('II', 'IV', 'XIII')
    """
    text = ""
    for value, numeral in _NUMERALS:
        while number >= value:
            text += numeral
            number -= value
    return text


def named_group(bodies: Sequence[Body], inner: Sequence[Pair], outer: Sequence[Pair]) -> Group:
    """Return the group of some bodies, with its name, class and order."""
    if len(bodies) == 2 and len(inner) == 1 and len(outer) == 2:
        return _dyad(bodies, inner[0], outer)
    name = "-".join(letters for letters in (_letters(outer), _letters(inner)) if letters)
    class_ = group_class(bodies, inner, outer)
    return Group(tuple(bodies), tuple(inner), tuple(outer), name, class_, len(outer))


def _dyad(bodies: Sequence[Body], inner: Pair, outer: Sequence[Pair]) -> Group:
    first, second = bodies
    carried = outer if _on(first, outer[0]) else outer[::-1]
    if rank(carried[1]) < rank(carried[0]):
        (first, second), carried = (second, first), carried[::-1]
    name = f"{carried[0].code}{inner.code}{carried[1].code}"
    return Group((first, second), (inner,), tuple(carried), name, _LEAST_CLASS, len(outer))


def group_class(bodies: Sequence[Body], inner: Sequence[Pair], outer: Sequence[Pair]) -> int:
    """Return a group's class by Artobolevskii, from its graph."""
    index = {link: k for k, body in enumerate(bodies) for link in body.links}
    joined = [tuple(dict.fromkeys(index[m] for m in pair.members if m in index)) for pair in (*inner, *outer)]
    pairs_on = [0] * len(bodies)
    for members in joined:
        for k in members:
            pairs_on[k] += 1
    loops = cycle_basis(len(bodies), [(members[0], members[1]) for members in joined if len(members) > 1])
    changeable = (len(loop) for loop in loops if len(loop) >= _CHANGEABLE)
    return max(_LEAST_CLASS, *pairs_on, *changeable)


def rank(pair: Pair) -> int:
    """Return the place of a pair's letter in a group's name."""
    return _RANK[pair.code]


def _letters(pairs: Iterable[Pair]) -> str:
    return "".join(pair.code for pair in sorted(pairs, key=rank))


def _on(body: Body, pair: Pair) -> bool:
    return any(member in body.links for member in pair.members)


@dataclass
class Binder:
    """Binds components in solving order. `holder[k]` is the body through which the k-th pin is located."""

    system: System
    holder: dict[int, int] = field(default_factory=dict)

    def locate(self, component: Sequence[int], constraints: Sequence[Constraint]) -> None:
        """Note where the pins of a component are found. On a body that is then solved."""
        own = frozenset(component)
        for constraint in constraints:
            vertex, body = constraint.sides[0], constraint.sides[-1]
            if vertex != GROUND and not self.system.is_body(vertex) and vertex in own:
                self.holder.setdefault(vertex, body)

    def group(self, component: Sequence[int], constraints: Sequence[Constraint]) -> Group:
        """Return the group of a component that holds a body."""
        own = set(component)
        inner: list[Pair] = []
        outer: list[Pair] = []
        for constraint in constraints:
            members = [side for side in constraint.sides if side in own]
            if not constraint.letter:
                (inner if len(set(members)) > 1 else outer).append(constraint.pair)
            elif len(members) == 2:
                inner += self._inner_pin(constraint)
            else:
                outer.append(self._outer_pin(constraint, members[0]))
        bodies = [self.system.bodies.moving[k] for k in component if self.system.is_body(k)]
        return named_group(bodies, inner, outer)

    def _inner_pin(self, constraint: Constraint) -> list[Pair]:
        first, second = constraint.sides
        if self.system.is_body(first):
            return [self._pin(constraint.letter, first, second)]
        hub = self.holder[first]
        return [] if second == hub else [self._pin(constraint.letter, hub, second)]

    def _outer_pin(self, constraint: Constraint, body: int) -> Pair:
        known = constraint.sides[0] if constraint.sides[1] == body else constraint.sides[1]
        if known != GROUND and not self.system.is_body(known):
            known = self.holder[known]
        return self._pin(constraint.letter, known, body)

    def _pin(self, letter: str, first: int, second: int) -> Pair:
        links = [self.system.carrier(letter, body) for body in (first, second)]
        return self.system.bodies.pins.pair(letter, *links)


def all_pairs(system: System, groups: Sequence[Group], kept: Sequence[Pair] = ()) -> tuple[Pair, ...]:
    """Return every pair, the pins letter by letter and then those written out.

    `kept` are what groups use in the place of pairs of which something is dropped: those themselves are listed.
    """
    mechanism = system.mechanism
    used: dict[str, list[Pair]] = {letter: [] for letter in mechanism.pins}
    written = {pair.name for pair in (*mechanism.written_pairs, *kept)}
    bodies = (system.bodies.ground, *system.bodies.moving)
    driven = [step.pair for body in bodies for step in body.driven]
    for pair in (*driven, *(pair for group in groups for pair in (*group.inner, *group.outer))):
        if pair.name not in written:
            used[pair.letters[0]].append(pair)
    pins = [pair for letter, pairs in used.items() for pair in _completed(system, letter, pairs)]
    return (*pins, *mechanism.written_pairs)


def _completed(system: System, letter: str, pairs: list[Pair]) -> list[Pair]:
    """Return the pairs of one pin, unused ones included."""
    links = system.mechanism.pins[letter]
    if len(pairs) == len(links) - 1:
        return pairs
    leader = {name: name for name in links}
    for pair in pairs:
        first, second = pair.members
        leader[find(leader, second)] = find(leader, first)
    rest = []
    for name in links[1:]:
        if find(leader, name) != find(leader, links[0]):
            leader[find(leader, name)] = find(leader, links[0])
            rest.append(system.bodies.pins.pair(letter, links[0], name))
    return [*pairs, *rest]
