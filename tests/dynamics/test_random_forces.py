"""Random mechanisms of the stress suite with random masses and loads: their forces balance."""

from __future__ import annotations

import pytest

from tests.dynamics.random_loads import SEED, check_of, loaded_motion
from tests.stress.trial import drawn_case

# `python -m tests.dynamics.random_loads 1000 small` tries many more.
COUNT, PARTS = 24, 2


@pytest.mark.parametrize("part", range(PARTS))
def test_forces_of_random_mechanisms_balance(part: int) -> None:
    """By every finding of `verify`; a case is left out where no pose is assembled or a rack does not fit."""
    checks = {number: check_of(drawn_case(SEED, number, small=True)) for number in range(part, COUNT, PARTS)}
    there = {number: check for number, check in checks.items() if check is not None and check.poses}
    assert {number: check.failed for number, check in there.items() if check.failed} == {}
    assert len(there) > COUNT / PARTS / 2


@pytest.mark.filterwarnings("ignore")
def test_home_a_hair_beyond_the_last_sample() -> None:
    """The way from the drawn pose to the first one ended 4e-15 beyond its samples: an IndexError."""
    case = drawn_case(SEED, 762, small=True)
    assert loaded_motion(case).shape == (case.way.poses,)
