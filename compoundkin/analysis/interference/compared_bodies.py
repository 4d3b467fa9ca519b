"""Which outlines may touch: those on one layer of links that are not joined, and what of joined links lies apart."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import combinations
from typing import Any

from compoundkin.analysis.interference.outline_places import core_at
from compoundkin.analysis.interference.shapely_library import shapely
from compoundkin.base.display import ShortRepr
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.outline_shapes import OutlineShape, Points

# A point that is farther outside of a shape than this part of the size is not within it.
WITHIN = 1e-9


@dataclass(frozen=True, eq=False, repr=False)
class ComparedBodies(ShortRepr):
    """Two bodies, links or pins, and shapes that share a layer."""

    one: str
    other: str
    shapes: list[tuple[OutlineShape, OutlineShape]] = field(default_factory=list)

    @property
    def layers(self) -> tuple[int, ...]:
        """The layers that they share."""
        return tuple(sorted({layer for a, b in self.shapes for layer in set(a.layers) & set(b.layers)}))


@dataclass(frozen=True, eq=False, repr=False)
class OutlineComparison(ShortRepr):
    """All that is compared of one design.

    `neighbours` are not: shapes about their common joints.
    """

    compared: tuple[ComparedBodies, ...]
    neighbours: tuple[tuple[str, str], ...]


def comparison_of(mechanism: Mechanism, shapes: tuple[OutlineShape, ...], points: Points) -> OutlineComparison:
    """Return which shapes of a mechanism are held against each other.

    Shapes of one link move together. Of two links that a pin or a slide joins, those that both reach its points
    overlap by nature, and all of links that another pair joins: wheels touch where they mesh.
    """
    joints = _joints(mechanism)
    reached = [_reached(shape, points, WITHIN * mechanism.geometry.size) for shape in shapes]
    found: dict[tuple[str, str], ComparedBodies] = {}
    left: dict[tuple[str, str], None] = {}
    for i, j in combinations(range(len(shapes)), 2):
        one, other = shapes[i], shapes[j]
        if not set(one.layers) & set(other.layers) or set(one.links) & set(other.links):
            continue
        key = one.body, other.body
        if (other.body, one.body) in found:
            key, one, other = (other.body, one.body), other, one
        letters = joints.get(frozenset((one.link, other.link)), ()) if not (one.is_pin or other.is_pin) else ()
        if any(_overlap(letter, reached[i], reached[j]) for letter in letters):
            left[key] = None
        else:
            found.setdefault(key, ComparedBodies(*key)).shapes.append((one, other))
    return OutlineComparison(tuple(found.values()), tuple(left))


def _joints(mechanism: Mechanism) -> Mapping[frozenset[str], list[tuple[str, ...]]]:
    """Return the points of all joints of two links; none of a joint about which all is by nature in contact."""
    found: dict[frozenset[str], list[tuple[str, ...]]] = {}
    for letter, links in mechanism.real_pins.items():
        for two in combinations(links, 2):
            found.setdefault(frozenset(two), []).append((letter,))
    for pair in mechanism.real_pairs:
        letters = pair.letters if pair.is_simple else ()
        found.setdefault(frozenset(pair.members[:2]), []).append(letters)
    return found


def _overlap(letters: tuple[str, ...], one: frozenset[str], other: frozenset[str]) -> bool:
    """Tell whether two shapes both reach a joint."""
    return not letters or bool(one.intersection(letters) and other.intersection(letters))


def _reached(shape: OutlineShape, points: Points, slack: float) -> frozenset[str]:
    """Return the points of its link that a shape reaches."""
    own: Any = points[shape.link]
    core, library = core_at(shape), shapely()
    apart = ((letter, library.distance(core, library.Point(p.real, p.imag))) for letter, p in own.items())
    return frozenset(letter for letter, distance in apart if distance <= shape.radius + slack)
