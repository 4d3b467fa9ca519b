"""The stress suite in the test command: random mechanisms are right, all but those whose faults are known."""

from __future__ import annotations

import numpy as np
import pytest

from tests.stress.continuation import Branch
from tests.stress.equations import Equations
from tests.stress.known import KNOWN, SEED
from tests.stress.sketch import Placed
from tests.stress.trial import drawn_case, tried

COUNT, PARTS = 300, 6


@pytest.mark.parametrize("part", range(PARTS))
def test_random_mechanisms_are_right(part: int) -> None:
    outcomes = [tried(SEED, number) for number in range(part, COUNT, PARTS) if number not in KNOWN]
    assert [f"case {outcome.number}: {fault}" for outcome in outcomes for fault in outcome.faults] == []


@pytest.mark.parametrize("number", KNOWN)
def test_what_is_known_to_be_faulty_still_is(number: int) -> None:
    assert tried(SEED, number).faults, f"case {number} is right now: take it off the list"


@pytest.mark.parametrize("number", range(12))
def test_the_suites_own_jacobian_and_rates_are_those_of_differences(number: int) -> None:
    case = drawn_case(SEED, number)
    equations = Equations(Placed(case.sketch))
    x = equations.drawn
    step = 1e-6
    for k in range(x.size):
        ahead, behind = (equations.residual(x + h * np.eye(x.size)[k]) for h in (step, -step))
        assert np.max(np.abs((ahead - behind) / (2 * step) - equations.jacobian(x)[:, k])) < 1e-7
    branch = Branch(equations, case.way.rate)
    way = 1e-3 / np.max(np.abs(branch.start.rate))
    ahead, behind = (branch.follow(branch.start, [s]).places.get(s) for s in (way, -way))
    if ahead and behind:
        rate = (ahead.x - behind.x) / (2 * way)
        assert np.max(np.abs(rate - branch.start.rate)) < 1e-4 * np.max(np.abs(rate))
