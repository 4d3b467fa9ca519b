"""The goals of compiled programs, as ratios of shortest times in one run; all that is compared agrees."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

import compoundkin as ck
from tests.benchmarks import programs, six_bar, six_bar_in_c
from tests.benchmarks.measure import Times

# Goals are for a quiet machine; this much is left to noise.
NOISE = 1.25
LLVM, TAPE, C = "llvm", "numpy", "C, vectors"


def shortest(times: Times, one: str, other: str) -> float:
    return min(times[one]) / min(times[other])


@pytest.fixture(scope="module")
def installed() -> list[str]:
    pytest.importorskip("llvmlite")
    return programs.back_ends()


def test_all_agree(installed: list[str]) -> None:
    crank = np.linspace(0.0, 2 * np.pi, 1001)
    expected = six_bar.by_hand(crank)["G"]
    found = {kind: six_bar_in_c.asked(kind, crank) for kind in six_bar_in_c.TEXTS}
    for name in installed:
        values = ck.compile(six_bar.mechanism(), programs.POINT, backend=name)({"crank": crank}, speed=six_bar.SPEED)
        found[name] = [values[output] for output in programs.POINT]
    for name, ours in found.items():
        for one, other in zip(ours, expected, strict=True):
            assert np.max(np.abs(one - other)) < 1e-12 * np.max(np.abs(other)), name


def test_all_outputs_agree(installed: list[str]) -> None:
    crank = np.linspace(0.0, 4 * np.pi, 1003)
    values = ck.compile(six_bar.mechanism(), six_bar_in_c.OUTPUTS)(crank, speed=six_bar.SPEED)
    for name, one in zip(six_bar_in_c.OUTPUTS, six_bar_in_c.everything(crank), strict=True):
        # angles begin in the turn of the drawing
        turns = 2 * np.pi * np.round((values[name][0] - one[0]) / (2 * np.pi)) if name.endswith(".angle") else 0.0
        assert np.max(np.abs(one + turns - values[name])) < 1e-11 * max(1.0, np.max(np.abs(one))), name


def test_one_point(installed: list[str]) -> None:
    times = programs.one_point()
    assert shortest(times, LLVM, C) < 1.0 * NOISE
    assert shortest(times, TAPE, C) < 10.0 * NOISE
    assert shortest(times, LLVM, "by hand") < 0.25


def test_all_outputs(installed: list[str]) -> None:
    times = programs.all_outputs()
    assert shortest(times, LLVM, C) < 2.0 * NOISE
    assert shortest(times, TAPE, "by hand") < 2.0


def test_small_calls(installed: list[str]) -> None:
    times = programs.small()
    assert min(times[LLVM]) < 15e-6 * NOISE
    assert min(times[TAPE]) < 90e-6 * NOISE


def test_every_form_of_a_call_is_quick(installed: list[str]) -> None:
    times = programs.forms()
    for name in times:
        if name not in ("array", *programs.in_c(np.zeros(8))):
            assert shortest(times, name, "array") < 1.6 * NOISE, name


def test_results_into_arrays(installed: list[str]) -> None:
    assert shortest(programs.into_arrays(), LLVM, C) < 1.1 * NOISE


def test_designs(installed: list[str]) -> None:
    times: Mapping[str, list[float]] = programs.designs()
    assert min(times[f"{LLVM}, order 2"]) < 1.1 * NOISE * min(times["C, vectors, order 2"])
    assert min(times[f"{LLVM}, gradient"]) < 2.2 * NOISE * min(times[f"{LLVM}, objective"])


def test_two_threads(installed: list[str]) -> None:
    times = programs.threads()
    assert shortest(times, f"{LLVM}, 1", f"{LLVM}, 2") > 1.7 / NOISE
