"""Lengths of an absurd size are refused with a word, and take no time."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin import laws, profiles
from compoundkin.model.profiles import synthesised
from tests import catalog
from tests.scaled import scaled

QUARTER = np.pi / 2.0
LIFT = laws.program(
    laws.dwell(QUARTER),
    laws.rise(10, over=QUARTER, law="cycloidal"),
    laws.dwell(QUARTER),
    laws.fall(10, over=QUARTER, law="cycloidal"),
)


@pytest.mark.parametrize("factor", [1e-320, 1e-200, 1e-60, 1e60, 1e160, 1e200])
@pytest.mark.parametrize("name", ["six-bar", "crank-shaper", "slider-crank", "class-iii-six-bar", "planetary-train"])
def test_lengths_that_cannot_be_computed_with_are_refused(name: str, factor: float) -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match="choose another unit"):
        scaled(catalog.mechanism(name), factor)


@pytest.mark.parametrize("base", [1e60, 1e200])
def test_profiles_that_cannot_be_computed_with_are_refused(base: float) -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match="choose another unit"):
        profiles.synthesise(LIFT, base=base, follower="roller", roller=8)
    with pytest.raises(ck.errors.InvalidMechanism, match="beyond 1e50"):
        _ = profiles.disc(base).curve


@pytest.mark.parametrize("follower", ["roller", "flat"])
@pytest.mark.parametrize("base", [1e-300, 1e-9, 1e-3, 1.0])
def test_a_base_circle_that_will_do_is_found_from_an_absurd_one_in_few_trials(
    base: float, follower: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    trials = []
    asked = synthesised._is_sufficient
    monkeypatch.setattr(synthesised, "_is_sufficient", lambda made: trials.append(made.base) or asked(made))
    roller = 12.0 if follower == "roller" else 0.0
    with pytest.raises(ck.errors.InvalidMechanism, match="take a base circle of") as told:
        _ = profiles.synthesise(LIFT, base=base, follower=follower, roller=roller).curve
    # 1.1 ** 73 is a thousand; halving takes some 24 more
    assert len(trials) < 250
    least = float(str(told.value).split("take a base circle of ")[1].split()[0])
    assert profiles.synthesise(LIFT, base=least * 1.001, follower=follower, roller=roller).curve.closed
    with pytest.raises(ck.errors.InvalidMechanism):
        _ = profiles.synthesise(LIFT, base=least * 0.99, follower=follower, roller=roller).curve
