"""From components of unknowns to groups of bodies: which links each pair is written between."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from compoundkin.model.pairs import Pair
from compoundkin.structure.composites import GROUND, find
from compoundkin.structure.group_names import named_group
from compoundkin.structure.parts import Group
from compoundkin.structure.system import Constraint, System


@dataclass
class Binder:
    """Binds components in solving order; `holder[k]` is the body through which the k-th pin is located."""

    system: System
    holder: dict[int, int] = field(default_factory=dict)

    def locate(self, component: Sequence[int], constraints: Sequence[Constraint]) -> None:
        """Note where the pins of a component are found: on a body that is then solved."""
        own = frozenset(component)
        for constraint in constraints:
            vertex, body = constraint.sides[0], constraint.sides[-1]
            if vertex != GROUND and not self.system.is_body(vertex) and vertex in own:
                self.holder.setdefault(vertex, body)

    def group(self, component: Sequence[int], constraints: Sequence[Constraint]) -> Group:
        """The group of a component that holds a body."""
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
    """Every pair: the pins letter by letter, as drivers and groups use them, then those written out.

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
    """The pairs of one pin, with those that no driver and no group uses."""
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
