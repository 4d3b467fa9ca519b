"""Pairs of shapes whose cores have as many corners, as arrays: the clearances of many bodies in one call."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.analysis.interference.compared_bodies import ComparedBodies
from compoundkin.analysis.interference.outline_places import geometries
from compoundkin.analysis.interference.shapely_library import shapely
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.model.outline_shapes import OutlineShape


@dataclass(frozen=True, eq=False, repr=False)
class ShapePairs(ShortRepr):
    """Pairs of shapes, (pairs,), in order of the bodies that they belong to.

    `cores` and `closed` are of the first and of the second ones, `links` the rows of their links.
    """

    bodies: Number
    links: tuple[Number, Number]
    cores: tuple[Number, Number]
    closed: tuple[bool, bool]
    reach: Number

    def lower(self, found: Number, which: Number, z: Number, u: Number) -> None:
        """Put clearances into what is `found` where they are less, (n,).

        They are of bodies by their indices. `z` and `u` are the origins and orientations of all links, (links, n).
        """
        first, last = np.searchsorted(self.bodies, which, "left"), np.searchsorted(self.bodies, which, "right")
        count = last - first
        at = np.repeat(np.arange(len(which)), count)
        pair = np.arange(len(at)) + np.repeat(first - np.cumsum(count) + count, count)
        if len(at):
            one, other = (
                geometries(z[rows[pair], at][:, None] + u[rows[pair], at][:, None] * core[pair], closed)
                for rows, core, closed in zip(self.links, self.cores, self.closed, strict=True)
            )
            np.minimum.at(found, at, shapely().distance(one, other) - self.reach[pair])


def pairs_alike(compared: Sequence[ComparedBodies], rows: Mapping[str, int]) -> Iterator[ShapePairs]:
    """Yield all pairs of shapes of bodies, those alike together. `rows` are those of links."""
    found: dict[tuple[tuple[int, bool], ...], list[tuple[int, tuple[OutlineShape, OutlineShape]]]] = {}
    for k, bodies in enumerate(compared):
        for two in bodies.shapes:
            found.setdefault(tuple((len(one.core), one.closed) for one in two), []).append((k, two))
    for ((_, closed), (_, other_closed)), of_one in found.items():
        ones, others = zip(*(two for _, two in of_one), strict=True)
        yield ShapePairs(
            np.array([k for k, _ in of_one]),
            (np.array([rows[one.link] for one in ones]), np.array([rows[one.link] for one in others])),
            (np.array([one.core for one in ones]), np.array([one.core for one in others])),
            (closed, other_closed),
            np.array([one.radius + other.radius for one, other in zip(ones, others, strict=True)]),
        )
