"""Where a group is attached: the midst of these places, their reach, and the point by which a body's place is told."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.series import as_series
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups.group_equations import GroupEquations
from compoundkin.model.pairs.contract import Ends
from compoundkin.structure.parts import Body, Group


def surroundings(equations: GroupEquations, block: Block) -> tuple[Number, Number]:
    """Return the midst of the places where a group is attached, and its reach.

    The reach is how far these places are from it, or the longest distance of two pairs on a link. It does not depend
    on where the frame has its origin or other links have their points.
    """
    attached: list[Number] = []
    on: dict[str, list[Number]] = {}
    for pair, members in zip(equations.pairs, equations.members, strict=True):
        for end, member in zip(block.ends[pair.name], members, strict=True):
            if member.body is None:
                attached.append(block.world[member.link].at(end.point).c[0])
            else:
                on.setdefault(member.link, []).append(as_series(end.point).c[0])
    centre = sum(attached) / max(len(attached), 1)
    spans = [np.abs(one - other) for own in on.values() for one, other in combinations(own, 2)]
    reach = 0.0
    for span in (*spans, *(np.abs(place - centre) for place in attached)):
        reach = np.maximum(reach, span)
    return centre, np.where(reach > 0.0, reach, equations.size)


def middle_of(body: Body, group: Group, ends: Mapping[str, Ends]) -> complex:
    """Return the point of a body by which its state tells where it is.

    In its base's frame it is the origin, unless that lies outside the pairs on the base: then it is the midst of
    these. Points that are no numbers, but stand for some, tell of no place.
    """
    pairs = (*group.inner, *group.outer)
    sides = [(pair, side) for pair in pairs for side, name in enumerate(pair.members) if name == body.links[0]]
    points = (as_series(ends[pair.name][side].point).c[0] for pair, side in sides)
    own = [np.mean(point) for point in points if isinstance(point, (complex, float, int, np.ndarray, np.number))]
    middle = complex(np.mean(own)) if own else 0j
    # about the origin poses take fewer products, which is what most of the time goes into
    return 0j if abs(middle) <= max((abs(place - middle) for place in own), default=0.0) else middle
