"""Bars: bodies of a group that only keep two points of others at a distance, so that they need no unknowns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from compoundkin.model.pairs import Pair


class Sided(Protocol):
    """One side of a pair: the index of its body in the group, or None for a known link."""

    @property
    def body(self) -> int | None:
        """The body's index."""


@dataclass(frozen=True)
class Bar:
    """A body with two pins: `pins` are their indices among the pairs, `own` which side of each is the bar's."""

    body: int
    pins: tuple[int, int]
    own: tuple[int, int]


def bars_of(n: int, pairs: Sequence[Pair], members: Sequence[Sequence[Sided]]) -> tuple[Bar, ...]:
    """As many of `n` bodies with two pins as can be left out together: no two of them on one pin.

    Those with fewest such neighbours first; the others remain bodies like any.
    """
    on: list[list[int]] = [[] for _ in range(n)]
    for k, sides in enumerate(members):
        for side in sides:
            if side.body is not None:
                on[side.body].append(k)
    found = {body: _bar(body, on[body], members) for body in range(n) if _has_two_pins(on[body], pairs)}
    beside = {body: [other for other in _neighbours(bar, members) if other in found] for body, bar in found.items()}
    chosen: dict[int, Bar] = {}
    for body in sorted(found, key=lambda body: (len(beside[body]), body)):
        if not any(other in chosen for other in beside[body]):
            chosen[body] = found[body]
    return tuple(chosen[body] for body in sorted(chosen))


def _has_two_pins(on: Sequence[int], pairs: Sequence[Pair]) -> bool:
    return len(on) == 2 and on[0] != on[1] and all(pairs[k].is_simple and pairs[k].free_is_angle for k in on)


def _bar(body: int, on: Sequence[int], members: Sequence[Sequence[Sided]]) -> Bar:
    one, two = (0 if members[k][0].body == body else 1 for k in on)
    return Bar(body, (on[0], on[1]), (one, two))


def _neighbours(bar: Bar, members: Sequence[Sequence[Sided]]) -> list[int]:
    others = (members[k][1 - own].body for k, own in zip(bar.pins, bar.own, strict=True))
    return [body for body in others if body is not None]
