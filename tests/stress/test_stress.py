"""The stress suite in the test command: random mechanisms, mutated files and wrong calls come out right."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
import pytest

from tests.stress.continuation import Branch
from tests.stress.equations import Equations
from tests.stress.known import KNOWN, SEED, SLOW
from tests.stress.misuse import misused
from tests.stress.mutated_files import mutated
from tests.stress.outcome import Outcome
from tests.stress.sketch import Placed
from tests.stress.trial import KINDS, drawn_case, tried

pytestmark = pytest.mark.full

COUNT, PARTS = 40, 4
small = partial(tried, small=True)


@pytest.mark.parametrize("part", range(PARTS))
def test_random_mechanisms_are_right(part: int) -> None:
    numbers = [number for number in range(part, COUNT, PARTS) if number not in {*KNOWN, *SLOW}]
    assert faults(small, numbers) == []


@pytest.mark.parametrize("number", KNOWN)
def test_what_is_known_to_be_faulty_still_is(number: int) -> None:
    assert small(SEED, number).faults, f"case {number} is right now: take it off the list"


@pytest.mark.parametrize("number", range(6))
def test_the_suites_own_jacobian_and_rates_are_those_of_differences(number: int) -> None:
    case = drawn_case(SEED, number, small=True)
    equations = Equations(Placed(case.sketch))
    x, step = equations.drawn, 1e-6
    for k in range(x.size):
        ahead, behind = (equations.residual(x + h * np.eye(x.size)[k]) for h in (step, -step))
        assert np.max(np.abs((ahead - behind) / (2 * step) - equations.jacobian(x)[:, k])) < 1e-7
    branch = Branch(equations, case.way.rates)
    way = 1e-5 / np.max(np.abs(branch.start.rate))
    there, back = (branch.follow(branch.start, [s]).places.get(s) for s in (way, -way))
    if there and back:
        rate = (there.x - back.x) / (2 * way)
        assert np.max(np.abs(rate - branch.start.rate)) < 1e-4 * np.max(np.abs(rate))


# What cases of other seeds found, by seed, number, whether they are small, and kind; said is what was wrong.
FOUND = {
    "drawn at the last pose of a full turn of three drivers, the first one was taken": (7, 17, True, "even"),
    "drawn at the last pose of a full turn, with a rack that counts turns": (13, 57, False, "even"),
    "drawn between a pose and a limit, the pose was lost": (13, 83, False, "even"),
    "a later group's change points were found before an earlier group had its own": (5, 89, False, "stacked"),
    "stages many times as fast as the driver fell down at their common change point": (5, 132, False, "stacked"),
    "a rack driven beyond half a turn on a coupler was a turn of its pinion away": (3000000, 1348, False, "even"),
    "a stated phase turned a wheel past half a turn, where a second pair has its phase of the drawing": (
        *(3000000, 1635, False),
        "even",
    ),
    "a change point of a stage five times as fast as the driver lay between two samples": (9, 1555, False, "stacked"),
    "a short drive of long tongs had no samples on its way": (9, 723, False, "stacked"),
    "drawn near the limit of a face, the contact leapt at once, and later groups were lost": (
        *(7200000, 1206, False),
        "cams",
    ),
    "a face on a pin changed its mode next to a limit position": (5000000, 235, False, "even"),
    "a face on a pin changed its mode, drawn next to a limit": (7000000, 2818, False, "even"),
    "wheels with stated phases on an arm that slides on another link, beyond half a turn": (
        3000000,
        4186,
        False,
        "even",
    ),
    "tongs folded down where the motion ended just beyond their closed pose": (5, 144, False, "stacked"),
}


@pytest.mark.parametrize("said", FOUND)
def test_what_other_seeds_found_is_right(said: str) -> None:
    seed, number, few, kind = FOUND[said]
    assert tried(seed, number, small=few, kind=kind).faults == []


@pytest.mark.parametrize(("seed", "number"), [(910, 55), (911, 7)])
def test_motions_that_once_could_not_be_differentiated_are_verified(seed: int, number: int) -> None:
    """Beyond the end of a motion that came back through a whole turn, and where steps danced in rounding."""
    assert tried(seed, number, small=True, verified=True).faults == []


@pytest.mark.parametrize("kind", KINDS[1:])
def test_random_mechanisms_of_other_kinds_are_right(kind: str) -> None:
    assert faults(partial(small, kind=kind), range(6)) == []


def test_mutated_files_answer_or_say_what_is_wrong() -> None:
    assert faults(mutated, range(100)) == []


def test_wrong_calls_say_what_is_wrong() -> None:
    assert faults(misused, range(80)) == []


def faults(trial: Callable[..., Outcome], numbers: list[int] | range) -> list[str]:
    outcomes = (trial(SEED, number) for number in numbers)
    return [f"case {outcome.number}: {fault}" for outcome in outcomes for fault in outcome.faults]
