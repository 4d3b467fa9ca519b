"""The equilibrium of any group: forces in its pairs from the loads on its bodies, by the transposed Jacobian.

The unknowns are how much of each pair's unit wrenches acts; the equations are force and moment on every body. For
pairs whose unit wrenches are the rows of their Jacobians, the matrix is the transpose of that of the velocities.

Source: the principle of virtual work with multipliers, e.g. P. E. Nikravesh, Computer-Aided Analysis of Mechanical
Systems, section 11.2.
"""

from __future__ import annotations

from collections.abc import Mapping

from compoundkin.base.linear import Inverse, Row
from compoundkin.base.series import Number
from compoundkin.base.wrenches import Wrench
from compoundkin.kinematics.block import Block
from compoundkin.model.pairs import Pair
from compoundkin.structure.parts import LINK_FREEDOMS, Body, Group


def reactions_of(group: Group, block: Block, loads: Mapping[str, Wrench]) -> dict[str, Wrench]:
    """Return the wrench on the second member of each pair of a group.

    It is that from the first member, by the pairs' names.

    `loads` are all other wrenches on the group's links, about the world's origin.
    """
    units: list[tuple[Pair, Wrench]] = []
    for pair in (*group.inner, *group.outer):
        poses = tuple(block.world[name] for name in pair.members)
        units += [(pair, unit) for unit in pair.wrenches(block.ends[pair.name], poses)[: pair.held]]
    rows: list[Row] = []
    right: list[Number] = []
    for body in group.bodies:
        middle, given = block.world[body.links[0]].z.c[0], load_on(body, loads)
        columns = [(k, _components(unit, middle), sign) for k, (pair, unit) in enumerate(units)
                   if (sign := _sign(pair, body))]  # fmt: skip
        rows += [{k: parts[j] * sign for k, parts, sign in columns} for j in range(LINK_FREEDOMS)]
        right += [0.0 - part for part in _components(given, middle)]
    found: dict[str, Wrench] = {}
    for (pair, unit), amount in zip(units, Inverse(rows, len(right)).times(right), strict=True):
        found[pair.name] = found.get(pair.name, Wrench()) + unit.times(amount)
    return found


def load_on(body: Body, loads: Mapping[str, Wrench]) -> Wrench:
    """Return the sum of what acts on the links of a body."""
    total = Wrench()
    for link in body.links:
        total = total + loads.get(link, Wrench())
    return total


def _components(wrench: Wrench, middle: Number) -> tuple[Number, Number, Number]:
    return wrench.force.real, wrench.force.imag, wrench.about(middle)


def _sign(pair: Pair, body: Body) -> float:
    """Return how a pair's unit wrench acts on a body: as it is on the second member, the opposite on the first."""
    return float(pair.members[1] in body.links) - float(pair.members[0] in body.links)
