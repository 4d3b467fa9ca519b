"""Work on long chains of groups grows with their number: groups are counted as they are assembled, not timed."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.poses import Pose
from compoundkin.kinematics.groups.dyad import DyadSolver
from tests.benchmarks.growth import chain


def assembled(monkeypatch: pytest.MonkeyPatch, dyads: int) -> int:
    """How often a group is assembled while a chain is solved at 37 poses."""
    count, close = [0], DyadSolver.close

    def counted(self: DyadSolver, *given: object) -> None:
        count[0] += 1
        close(self, *given)  # type: ignore[arg-type]

    with monkeypatch.context() as patched:
        patched.setattr(DyadSolver, "close", counted)
        motion = ck.solve(chain(dyads), {"crank": np.linspace(0.0, 2 * np.pi, 37)})
    assert motion.assembled.all()
    return count[0]


def test_groups_are_assembled_a_few_times_each(monkeypatch: pytest.MonkeyPatch) -> None:
    """Some come near a limit; each of these was looked at by a run of all groups before it: as the square of them."""
    few, many = assembled(monkeypatch, 32), assembled(monkeypatch, 128)
    assert many <= 4.2 * few


def cut(monkeypatch: pytest.MonkeyPatch, dyads: int) -> int:
    """How often a pose is cut to an order while the motion of a chain is verified."""
    motion = ck.solve(chain(dyads), {"crank": np.linspace(0.0, 0.3, 3)})
    count, trimmed = [0], Pose.trimmed

    def counted(self: Pose, order: int) -> Pose:
        count[0] += 1
        return trimmed(self, order)

    with monkeypatch.context() as patched:
        patched.setattr(Pose, "trimmed", counted)
        assert ck.verify(motion).passed
    return count[0]


def test_groups_see_their_own_links_when_a_motion_is_verified(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each group took all links before it to its order, which grew as the square of them."""
    few, many = cut(monkeypatch, 16), cut(monkeypatch, 64)
    assert many <= 4.2 * few


def test_a_long_chain_is_what_its_beginning_is_alone() -> None:
    """A part of a chain does not see what follows it."""
    turn = {"crank": np.linspace(0.0, 2 * np.pi, 37)}
    short, long = ck.solve(chain(5), turn), ck.solve(chain(40), turn)
    for name in short.points:
        assert np.array_equal(short.points[name].position, long.points[name].position)
