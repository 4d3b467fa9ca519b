"""The equilibrium of any group: forces in its pairs from the loads on its bodies, by the transposed Jacobian.

The unknowns are how much of each pair's unit wrenches acts; the equations are force and moment on every body. For
pairs whose unit wrenches are the rows of their Jacobians, the matrix is the transpose of that of the velocities. A bar,
with two pins and nothing else, tells the forces across it by its moments alone: it is left out but for one unknown, the
force along it, as it needs no unknowns for its motion.

Source: the principle of virtual work with multipliers, e.g. P. E. Nikravesh, Computer-Aided Analysis of Mechanical
Systems, section 11.2.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.linear import Inverse, Row
from compoundkin.base.wrenches import Wrench
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups.bars import Bar, BarPin, Member, bars_of
from compoundkin.model.pairs import Pair
from compoundkin.structure.parts import LINK_FREEDOMS, Body, Group

# What a unit of an unknown does to each body, by its index.
Column: TypeAlias = dict[int | None, Wrench]


def reactions_of(group: Group, block: Block, loads: Mapping[str, Wrench], bars: bool = True) -> dict[str, Wrench]:
    """Return the wrench on the second member of each pair of a group.

    It is that from the first member, by the pairs' names.

    `loads` are all other wrenches on the group's links, about the world's origin. Without `bars` no body is left out.
    """
    pairs = (*group.inner, *group.outer)
    own = {link: k for k, body in enumerate(group.bodies) for link in body.links}
    sides = [[Member(name, own.get(name)) for name in pair.members[:2]] for pair in pairs]
    given = {k: load_on(body, loads) for k, body in enumerate(group.bodies)}
    found = bars_of(len(group.bodies), pairs, sides) if bars else ()
    struts = [_strut(bar, block, given.pop(bar.body)) for bar in found]
    for strut in struts:
        given.update({k: given[k] + wrench for k, wrench in strut.passed.items() if k is not None})
    hung = {pin.pair.name for bar in found for pin in bar.pins}
    units = [(pair.name, unit, side) for pair, side in zip(pairs, sides, strict=True) if pair.name not in hung
             for unit in _units(pair, block)]  # fmt: skip
    columns: list[Column] = [{first.body: -unit, second.body: unit} for _, unit, (first, second) in units]
    middles = {k: block.world[group.bodies[k].links[0]].z.c[0] for k in given}
    amounts = _amounts([*columns, *(strut.column for strut in struts)], given, middles)
    wrenches: dict[str, Wrench] = {}
    for (name, unit, _), amount in zip(units, amounts, strict=False):
        wrenches[name] = wrenches.get(name, Wrench()) + unit.times(amount)
    for strut, amount in zip(struts, amounts[len(units) :], strict=True):
        wrenches.update(strut.wrenches(amount))
    return wrenches


def _units(pair: Pair, block: Block) -> tuple[Wrench, ...]:
    poses = tuple(block.world[name] for name in pair.members)
    return pair.wrenches(block.ends[pair.name], poses)[: pair.held]


def _amounts(columns: Sequence[Column], given: Mapping[int, Wrench], middles: Mapping[int, Number]) -> list[Number]:
    """Return how much of each unknown balances what is given on the bodies."""
    rows: list[Row] = []
    right: list[Number] = []
    for body, middle in middles.items():
        parts = {k: _components(column[body], middle) for k, column in enumerate(columns) if body in column}
        rows += [{k: part[j] for k, part in parts.items()} for j in range(LINK_FREEDOMS)]
        right += [0.0 - part for part in _components(given[body], middle)]
    return Inverse(rows, len(right)).times(right)


class Strut(NamedTuple):
    """A bar that is left out. What its pins do to it without a force along it, and of a unit of that force.

    `passed` is what the bar does to its neighbours without it, `column` what it does with a unit of it.
    """

    pins: tuple[BarPin, BarPin]
    known: tuple[Wrench, Wrench]
    units: tuple[Wrench, Wrench]

    @property
    def passed(self) -> Column:
        """What it does to the bodies beside it, without a force along it."""
        return _opposite(self.pins, self.known)

    @property
    def column(self) -> Column:
        """What a unit of the force along it does to the bodies beside it."""
        return _opposite(self.pins, self.units)

    def wrenches(self, amount: Number) -> dict[str, Wrench]:
        """Return the wrenches on second members of its pins. A force is along it."""
        parts = zip(self.pins, self.known, self.units, strict=True)
        on_bar = [(pin, known + unit.times(amount)) for pin, known, unit in parts]
        return {pin.pair.name: wrench if pin.own else -wrench for pin, wrench in on_bar}


def _opposite(pins: tuple[BarPin, BarPin], on_bar: tuple[Wrench, Wrench]) -> Column:
    """Return what acts on the bodies at the pins' other sides; on one that has both pins it is the sum."""
    found: Column = {}
    for pin, wrench in zip(pins, on_bar, strict=True):
        body = pin.members[1 - pin.own].body
        found[body] = found.get(body, Wrench()) - wrench
    return found


def _strut(bar: Bar, block: Block, load: Wrench) -> Strut:
    """Return a bar by its load: moments about each pin tell the forces across it."""
    one, two = (_place(pin, block) for pin in bar.pins)
    line = one - two
    inverse = 1.0 / np.abs(line)
    along = line * inverse
    across = 1j * along * (load.about(two) * inverse)
    known = Wrench.at(one, 0.0 - across), Wrench.at(two, across - load.force)
    return Strut(bar.pins, known, (Wrench.at(one, along), Wrench.at(two, 0.0 - along)))


def _place(pin: BarPin, block: Block) -> Number:
    end = block.ends[pin.pair.name][pin.own]
    return block.world[pin.members[pin.own].link].at(end.point).c[0]


def load_on(body: Body, loads: Mapping[str, Wrench]) -> Wrench:
    """Return the sum of what acts on the links of a body."""
    total = Wrench()
    for link in body.links:
        total = total + loads.get(link, Wrench())
    return total


def _components(wrench: Wrench, middle: Number) -> tuple[Number, Number, Number]:
    return wrench.force.real, wrench.force.imag, wrench.about(middle)
