"""`configurations`: every way in which a mechanism can be assembled at given driver values.

For special dimensions the mechanism still moves while all drivers stand still: a curve of configurations.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import product
from math import prod
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import TURN, Number, degrees, first_entry
from compoundkin.base.bracketing import bisect_brackets
from compoundkin.base.errors import InvalidInput, NotAssembled, Problem
from compoundkin.base.linear import one_thread
from compoundkin.base.poses import Pose
from compoundkin.configurations.driver_range import greatest_reach
from compoundkin.configurations.segment_poses import drawn_angle
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.configuration import Configuration, Configurations, RestingCurve, dimensions_at
from compoundkin.kinematics.driver_values import Inputs, by_name, inputs
from compoundkin.kinematics.groups import GroupSolver, equations_of
from compoundkin.kinematics.groups.general import bodies_at
from compoundkin.kinematics.motion import Named
from compoundkin.kinematics.solution import solving_order_of
from compoundkin.kinematics.solving_order import SolvingOrder, residual, run
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.redundancy.constraint_equations import ConstraintEquations
from compoundkin.structure.redundancy.diagnosis import WIDEST
from compoundkin.structure.redundancy.finite_motion import resting_motion

# A redundant pair counts as closed below this gap, in parts of the size: dimensions have few digits.
CLOSED = 1e-6
# Nobody distinguishes more configurations of one mechanism; no search finds those of groups with more bodies.
MOST, MOST_BODIES = 4096, 24
# Samples of each driver for the nearest value at which the mechanism can be assembled, and halvings that refine it.
TRIED = 721
HALVINGS = 40


@dataclass
class AllModes:
    """The choice of all modes at once: the block has a leading axis for each group with several.

    `modes[k]` are the names of the modes of group k, `possible[k]` their number over the complex numbers (0 unknown).
    """

    solving_order: SolvingOrder
    given: Inputs
    block: Block
    modes: dict[int, tuple[str, ...]] = field(default_factory=dict)
    possible: dict[int, int] = field(default_factory=dict)
    certified: dict[int, Number] = field(default_factory=dict)
    is_lacking: bool = False  # a group has fewer configurations than its count: there may be a curve

    @classmethod
    def of(cls, solving_order: SolvingOrder, given: Inputs) -> AllModes:
        """Assemble all groups in solving order, at all designs and poses of the inputs."""
        found = cls(
            solving_order, given, solving_order.start(given.ends, given.series(0), 0, (given.designs, given.poses))
        )
        run(solving_order, found.block, found)
        return found

    def mode(self, block: Block, solver: GroupSolver) -> Number:
        """Return all modes of a group, along an axis of their own where there are several."""
        if solver.modes == 1:
            return 1.0
        if solver.is_numbered:
            return self._numbered(block, solver)
        signs = np.array([1.0, -1.0]).reshape(2, *[1] * len(block.shape))
        self._branch(solver.index, ("+", "-"), 2)
        return signs

    def angle(self, solver: GroupSolver, link: str) -> Number:
        """Return the drawn angle of a link."""
        return drawn_angle(self.solving_order, link)

    def _numbered(self, block: Block, solver: GroupSolver) -> Number:
        if (bodies := len(solver.group.bodies)) > MOST_BODIES:
            raise InvalidInput(Problem("modes", f"{bodies} bodies in a group are too many", "solve() finds one"))
        found = solver.every(block)
        states = found.states
        batch = (1,) * (len(block.shape) - (states.ndim - 2)) + states.shape[:-2]
        states = np.moveaxis(states.reshape(*batch, *states.shape[-2:]), -2, 0)
        if not len(states):
            states = np.full((1, *states.shape[1:]), np.nan)
        self._branch(solver.index, tuple(str(n + 1) for n in range(len(states))), found.possible)
        self.certified[solver.index] = found.certified
        self.is_lacking |= bool(np.any(found.count < found.possible))
        return equations_of(solver).state(bodies_at(states))

    def _branch(self, k: int, names: tuple[str, ...], possible: int) -> None:
        """Give the block an axis for the modes of a group."""
        self._limited(len(names))
        self.modes[k], self.possible[k] = names, possible
        self.block.shape = (len(names), *self.block.shape)

    def _limited(self, more: int) -> None:
        count = more * prod(len(modes) for modes in self.modes.values())
        if count > MOST:
            what = f"the mechanism has more than {MOST:,} configurations: its groups multiply them"
            raise InvalidInput(Problem("configurations", what, "ask for a part of the mechanism"))

    def full(self, array: Number) -> Number:
        """Return an array of any leading axes as (configurations, designs, poses), the first group varying slowest."""
        axes = [len(modes) for modes in self.modes.values()]
        whole = np.broadcast_to(array, self.block.shape)
        count = len(axes)
        return np.transpose(whole, (*range(count)[::-1], count, count + 1)).reshape(-1, *self.block.shape[-2:])

    @property
    def real(self) -> Number:
        """Where each configuration can be assembled, (configurations, designs, poses)."""
        closed = closed_redundant(self.solving_order, self.block)
        return self.full((np.asarray(self.block.failed) == 0) & closed)

    def configurations(self, real: Number, shape: tuple[int, ...]) -> Configurations:
        """Return the configurations that are `real` at some pose, in the shape of the driver values."""
        which = np.flatnonzero(real.any(axis=(1, 2)))
        every = [dict(zip(self.modes, names, strict=True)) for names in product(*self.modes.values())]

        def last(full: Number) -> Number:
            return np.moveaxis(full[which], 0, -1).reshape(*shape, len(which))

        def shaped(value: Number) -> Number:
            return last(self.full(value))

        def pose(link: str) -> Pose:
            found = self.block.world[link]
            return Pose.of(shaped(found.z.c[0]), shaped(found.u.c[0]))

        real = last(real)
        return Configurations(
            Named("link", tuple(self.block.world), pose),
            real,
            real.sum(axis=-1),
            prod(self.possible.values()),
            all(bool(np.all(found)) for found in self.certified.values()),
            self.solving_order.structure,
            {name: values[0] for name, values in self.given.drives.items()},
            tuple(every[k] for k in which),
            {k: shaped(margin) for k, margin in self.block.margins.items()},
        )


def closed_redundant(solving_order: SolvingOrder, block: Block) -> Number:
    """Return whether the redundant pairs are closed, which not all configurations of the others close."""
    pairs = solving_order.structure.redundant
    return residual(pairs, block, solving_order.size) <= CLOSED**2 if pairs else True


@checked
@one_thread
def configurations(mechanism: Mechanism | Structure, values: Any = None) -> Configurations:
    """Find all configurations of a mechanism at driver values, radians or lengths, those of `solve` by default.

    Groups of pins and slides give all their configurations; others those that a search finds, so that `certified` is
    False. `curve` has the links that move at special dimensions while the drivers stand still. Raises NotDetermined
    where the structure cannot be solved, InvalidInput for values that do not fit, NotAssembled where there is no
    configuration at all, naming the nearest driver value that has any.

    >>> from compoundkin.model.elements import drive, link
    >>> four_bar = Mechanism(
    ...     "Four-bar", link("frame", A=(0, 0), D=(4, 0)), link("crank", A=(0, 0), B=(1, 0)),
    ...     link("coupler", B=(0, 0), C=(3, 0)), link("rocker", D=(0, 0), C=(3, 0)), drive("crank"))
    >>> found = configurations(four_bar, {"crank": 1.0})
    >>> found.names, int(found.real_count), found.possible
    (('RRR(coupler)+', 'RRR(coupler)-'), 2, 2)
    """
    solving_order = solving_order_of(mechanism)
    with np.errstate(all="ignore"):
        given = inputs(solving_order, by_name(solving_order.structure.mechanism, values), None, None, None)
        found = AllModes.of(solving_order, given)
        real = found.real
        curve = resting_curve(solving_order.structure, given) if found.is_lacking else None
        if not real.any() and curve is None:
            raise NotAssembled(_nothing(solving_order, given))
        return replace(found.configurations(real, given.shape), curve=curve)


def _nothing(solving_order: SolvingOrder, given: Inputs) -> Problem:
    """Return the problem of no configuration, with the nearest driver value that has one."""
    nearest = [(*_nearest(solving_order, given, name), name) for name in given.drives]
    found = [one for one in nearest if one[0] < np.inf]
    what = "the mechanism cannot be assembled there"
    if not found:
        return Problem("values", f"{what}, nor at any other value of a single driver")
    _, value, name = min(found)
    is_angle = solving_order.structure.driven_angles[name]
    number = f"{degrees(value):.6g} degrees" if is_angle else f"{value:.6g}"
    return Problem("values", what, f"the nearest value is {name} = {number}")


def _nearest(solving_order: SolvingOrder, given: Inputs, name: str) -> tuple[float, float]:
    """Return the distance (parts of the size, or radians) and value of a driver nearest to its own that has one."""
    first = given.cut(slice(0, 1), slice(0, 1))
    here = float(first_entry(first.drives[name][0]))
    is_angle = solving_order.structure.driven_angles[name]
    span = TURN / 2.0 if is_angle else 2.0 * greatest_reach(solving_order)
    offsets = np.linspace(-span, span, TRIED)
    good = _any(solving_order, first, name, here + offsets)
    if not good.any():
        return np.inf, here
    order = np.argsort(np.abs(offsets), kind="stable")
    best = int(order[good[order]][0])
    far = offsets[[best]] - np.sign(offsets[[best]]) * 2.0 * span / (TRIED - 1)
    near, _ = bisect_brackets(
        lambda offset: _any(solving_order, first, name, here + offset), offsets[[best]], far, HALVINGS
    )
    return abs(near[0]) / (1.0 if is_angle else solving_order.size), here + near[0]


def _any(solving_order: SolvingOrder, given: Inputs, name: str, values: Number) -> Number:
    rest = {other: tuple(first_entry(v) for v in vs) for other, vs in given.drives.items()}
    drives = {**rest, name: (values[None],)}
    return AllModes.of(solving_order, Inputs((len(values),), given.ends, drives)).real.any(axis=(0, 1))


# A link moves if its share of the motion is above this.
MOVES = 1e-6


def resting_curve(structure: Structure, given: Inputs) -> RestingCurve | None:
    """Return a curve of configurations at the first driver values, or None."""
    equations = ConstraintEquations(structure.mechanism)
    if equations.width > WIDEST:
        return None
    values = {name: float(first_entry(numbers[0])) for name, numbers in given.drives.items()}
    found = resting_motion(equations, np.array(list(values.values())), len(structure.passive))
    if found is None:
        return None
    share = np.linalg.norm(found.along, axis=1)
    links = tuple(name for name, k in equations.column.items() if np.max(share[k : k + 3]) > MOVES)
    dimensions = dimensions_at(structure, 0, 0)
    return RestingCurve(links, Configuration(structure, values, equations.poses(found.state), {}, {}, dimensions))
