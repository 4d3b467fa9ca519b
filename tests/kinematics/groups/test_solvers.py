"""What every way of solving a group answers: the registry is iterated, and a way of our own is put into it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.arrays import Number
from compoundkin.files import load
from compoundkin.kinematics import groups
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.configuration import Configurations
from compoundkin.kinematics.groups import SOLVERS, GroupSolver
from compoundkin.kinematics.groups.general import bodies_at
from compoundkin.kinematics.groups.pair_sides import Reason, alone
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.pairs.contract import Ends
from compoundkin.structure.mobility_count import Group

# Mechanisms in which each way is taken for some group.
SHOWN = {
    "RRR": ("four-bar-norton", "groove-cam-plate"),
    "RRP": ("slider-crank",),
    "RPR": ("whitworth-quick-return", "quick-return-pin-in-slot"),
    "PRP": ("elliptic-trammel",),
    "RPP": ("scotch-yoke", "flat-faced-follower"),
    "GearTrainSolver": ("planetary-train", "rack-and-pinion-steering", "differential"),
    "FollowerSolver": ("disc-cam-roller-program", "oscillating-flat-follower"),
    "GeneralSolver": ("3-rrr", "class-iii-six-bar"),
}
every_way = pytest.mark.parametrize("kind", SOLVERS, ids=[kind.__name__ for kind in SOLVERS])


def solved(kind: type[GroupSolver]) -> list[tuple[GroupSolver, Block, Block]]:
    """Groups that a way solves: its solver, the block before the group is assembled, and after."""
    found = []
    for name in SHOWN[kind.__name__]:
        motion = ck.solve(load(name), order=2)
        for solver in motion.solving_order.solvers:
            if type(solver) is kind:
                places = np.arange(motion.inputs.poses, dtype=float)[None], np.zeros((1, 1), dtype=int)
                before = motion.followed.run(motion.inputs, 2, *places, upto=solver.index)
                after = motion.followed.run(motion.inputs, 2, *places, upto=solver.index + 1)
                found.append((solver, before, after))
    return found


def open_by(solver: GroupSolver, block: Block) -> float:
    """By how much the group's pairs are open at most, in any coefficient."""
    gaps = []
    for pair in (*solver.group.inner, *solver.group.outer):
        closure = pair.closure(block.ends[pair.name], tuple(block.world[name] for name in pair.members))
        gaps += [float(np.nanmax(np.abs(c))) for series in closure for c in series.c]
    return max(gaps)


@every_way
def test_some_mechanism_is_solved_by_it(kind: type[GroupSolver]) -> None:
    assert solved(kind)


@every_way
def test_a_closed_group_satisfies_its_own_pairs(kind: type[GroupSolver]) -> None:
    for solver, _, after in solved(kind):
        assert set(solver.group.links) <= set(after.world)
        assert open_by(solver, after) < 1e-6


@every_way
def test_every_configuration_closes_and_what_was_chosen_is_among_them(kind: type[GroupSolver]) -> None:
    for solver, before, after in solved(kind):
        found = solver.every(before)
        assert found.real.shape[-1] == found.turns.shape[-2]
        size = solver.equations.size if solver.equations else 1.0
        chosen = np.stack(
            [np.broadcast_to(after.world[body.links[0]].u.c[0], before.shape) for body in solver.group.bodies], axis=-1
        )
        gaps = np.abs(np.where(found.real[..., None], found.turns, np.inf) - chosen[..., None, :]).max(axis=-1)
        assert np.nanmax(np.min(gaps, axis=-1)) < 1e-6 * size
        if solver.modes:
            assert np.array_equal(found.real_count, np.full(before.shape, solver.modes))
            assert np.all(found.certified)
        else:
            trial = before.leading()
            solver.close(trial, solver.equations.state(bodies_at(np.moveaxis(found.states, -2, 0))))
            assert open_by(solver, trial) < 1e-6


@every_way
def test_it_tells_why_and_how_far_from_its_limit(kind: type[GroupSolver]) -> None:
    for solver, before, after in solved(kind):
        assert solver.why(after, 0)
        assert (solver.margin(after) is not None) == solver.tells_margin
        assert solver.margin(before) is None


@every_way
def test_it_leaves_other_groups_to_others(kind: type[GroupSolver]) -> None:
    """All but the last, which takes what is left, refuse the groups of the other ways."""
    orders = [SolvingOrder(ck.decompose(load(name))) for names in SHOWN.values() for name in names]
    taken = [
        type(solver) is kind
        for solving_order in orders
        for solver in solving_order.solvers
        if kind.of(solver.index, solver.group, solving_order.size, solving_order.ends) is not None
    ]
    assert taken
    assert all(taken) or kind is SOLVERS[-1]


class Pinned(GroupSolver):
    """A way of our own for two links pinned together: it answers the contract and nothing else."""

    modes: ClassVar[int] = 2
    sign_means: ClassVar[str] = "as the one it hides"
    tells_margin: ClassVar[bool] = True

    def __init__(self, index: int, group: Group, hidden: GroupSolver) -> None:
        super().__init__(index, group)
        self.hidden = hidden

    @classmethod
    def of(cls, index: int, group: Group, size: float, ends: Mapping[str, Ends]) -> GroupSolver | None:
        hidden = SOLVERS[0].of(index, group, size, ends)
        return None if hidden is None else cls(index, group, hidden)

    def close(self, block: Block, mode: Number) -> None:
        self.hidden.close(block, mode)

    def every(self, block: Block) -> Configurations:
        return self.in_modes(block)

    def reasons(self, block: Block) -> tuple[Reason, ...]:
        return alone("for a reason of our own")


def told(name: str) -> list[Any]:
    """What is found of a mechanism: its motion, configurations, circuits and gaps."""
    mechanism = load(name)
    motion = ck.solve(mechanism, order=3)
    circuits = ck.circuits(mechanism)
    ends = [(b.name, b.low, b.high) for b in circuits.branches]
    places = [point.derivative(k).tolist() for point in motion.points.values() for k in range(4)]
    return [places, ck.configurations(mechanism).names, ends, [t.value for t in circuits.toggles]]


@pytest.mark.parametrize("name", ["stephenson-iii", "crank-rocker", "parallelogram"])
def test_one_line_in_the_registry_adds_a_way(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Solving, configurations and circuits ask a group no more than the contract says."""
    expected = told(name)
    monkeypatch.setattr(groups, "SOLVERS", (Pinned, *SOLVERS))
    assert told(name) == expected
    assert any(type(solver) is Pinned for solver in ck.solve(load(name)).followed.solving_order.solvers)
