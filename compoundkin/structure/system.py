"""The constraint system of a mechanism: what is unknown, and what each pair holds.

A moving body has three freedoms. A pin that joins three moving bodies or more is an unknown of its own with
two freedoms, and each body on it holds two with it: written as pairs in a star around one of its links it
would wrongly merge groups. A pin on the ground is simply fixed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import FIXED
from compoundkin.model.definition import pin_at
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends
from compoundkin.model.pairs.profile_contact import as_profile_contact
from compoundkin.structure.composites import GROUND, Composites
from compoundkin.structure.mobility_count import LINK_FREEDOMS, Dropped

POINT_FREEDOMS = 2


@dataclass(frozen=True)
class Constraint:
    """What one pair holds between the unknowns (or GROUND) of its members, its `sides`.

    `letter` is that of a pin, "" for a written pair; `unknowns` are the sides but GROUND, once each.
    """

    pair: Pair
    sides: tuple[int, ...]
    letter: str
    unknowns: tuple[int, ...]


@dataclass(frozen=True)
class System:
    """The unknowns, moving bodies and then pins, and the constraints between them."""

    mechanism: Mechanism
    bodies: Composites
    vertices: tuple[str, ...]
    constraints: tuple[Constraint, ...]
    dropped: tuple[Dropped, ...] = ()

    @cached_property
    def freedoms(self) -> list[int]:
        """The freedoms of each unknown."""
        return [LINK_FREEDOMS] * len(self.bodies.moving) + [POINT_FREEDOMS] * len(self.vertices)

    @cached_property
    def rows(self) -> list[tuple[int, ...]]:
        """One row a held coordinate: the unknowns it is between."""
        return [c.unknowns for c in self.constraints for _ in range(c.pair.held)]

    @cached_property
    def constraint_of(self) -> list[int]:
        """The constraint of each row."""
        return [k for k, c in enumerate(self.constraints) for _ in range(c.pair.held)]

    @cached_property
    def place_of(self) -> dict[str, int]:
        """The place of each link in the order of input."""
        return {name: place for place, name in enumerate(self.mechanism.links)}

    def is_body(self, unknown: int) -> bool:
        """Return whether an unknown is a moving body (else a pin)."""
        return unknown < len(self.bodies.moving)

    def is_thought(self, constraint: Constraint) -> bool:
        """Return whether a constraint is only thought, to lead a point."""
        links = self.mechanism.carriers[constraint.letter] if constraint.letter else constraint.pair.members
        return len([name for name in links if name not in self.mechanism.auxiliary_links]) < 2

    def neighbour(self, letter: str, body: int) -> int:
        """Return the first other body that carries a letter."""
        on_pin = (self.bodies.body_of[name] for name in self.mechanism.pins[letter])
        return next(other for other in on_pin if other != body)

    def carrier(self, letter: str, body: int) -> str:
        """Return the link of a body that carries a letter nearest to its base."""
        links = self.bodies.body(body).links
        return links[0] if len(links) == 1 else self._carriers[letter, body]

    @cached_property
    def _carriers(self) -> dict[tuple[str, int], str]:
        """The carriers of all letters of composites of several links."""
        found: dict[tuple[str, int], str] = {}
        for index in range(GROUND, len(self.bodies.moving)):
            links = self.bodies.body(index).links
            for name in links if len(links) > 1 else ():
                for letter in self.mechanism.links[name].points:
                    found.setdefault((letter, index), name)
        return found


def system_of(mechanism: Mechanism, bodies: Composites, dropped: Sequence[Dropped] = ()) -> System:
    """Return the constraint system of composite links, without what is dropped."""
    count = len(bodies.moving)
    vertices: list[str] = []
    constraints: list[Constraint] = []
    off = {(part.name, link) for part in dropped for link in part.off}
    for letter, names in mechanism.pins.items():
        on_pin = tuple(dict.fromkeys([bodies.body_of[name] for name in names if (letter, name) not in off]))
        if len(on_pin) > 2 and GROUND not in on_pin:
            vertices.append(letter)
        sides = _pin_sides(on_pin, count + len(vertices) - 1)
        constraints += [_constraint(pin_at(letter), pair, letter) for pair in sides]
    for pair in constraining_pairs(mechanism, dropped):
        members = tuple(bodies.body_of[name] for name in pair.members)
        if len(set(members)) > 1:
            constraints.append(_constraint(pair, members, ""))
    return System(mechanism, bodies, tuple(vertices), tuple(constraints), tuple(dropped))


def constraining_pairs(mechanism: Mechanism, dropped: Sequence[Dropped]) -> tuple[Pair, ...]:
    """Return the written pairs, those partly dropped replaced by what is kept."""
    left_out = {part.name for part in dropped if not part.off}
    kept = (part.kept for part in dropped if part.kept is not None)
    return (*(pair for pair in mechanism.written_pairs if pair.name not in left_out), *kept)


def _pin_sides(on_pin: tuple[int, ...], vertex: int) -> Iterator[tuple[int, int]]:
    if GROUND in on_pin:
        yield from ((GROUND, body) for body in on_pin if body != GROUND)
    elif len(on_pin) == 2:
        yield on_pin[0], on_pin[1]
    elif len(on_pin) > 2:
        yield from ((vertex, body) for body in on_pin)


def _constraint(pair: Pair, sides: tuple[int, ...], letter: str) -> Constraint:
    return Constraint(pair, sides, letter, tuple(dict.fromkeys([s for s in sides if s != GROUND])))


def generic_jacobian(pair: Pair, ends: Ends) -> Number:
    """Return a pair's rows at random ends, its profile of the size 1.

    So is all else there; otherwise the rank of a mechanism would depend on the unit of its lengths.
    """
    rows = np.array(pair.jacobian(ends, (FIXED,) * len(ends)), dtype=float)
    profiled = as_profile_contact(pair)
    if profiled:
        rows[..., 2::3] /= profiled.curve.size
        rows[..., pair.held :, :] *= profiled.curve.size / profiled.coordinate_scale
    return rows
