"""The goals of rows of studies, as ratios of shortest times in one run; the memory of a process of its own."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from tests.benchmarks import studies
from tests.benchmarks.test_program_ratios import NOISE

pytest.importorskip("llvmlite")


def test_sums_agree_with_those_by_hand() -> None:
    found = studies.program(studies.ERROR, studies.FEW).rows(range(studies.FEW))["error"]
    expected = studies.by_hand()
    assert np.abs(found - expected).max() < 1e-10 * expected.max()


def test_sums() -> None:
    times = studies.sums()
    assert min(times["rows"]) < 2.0 * NOISE
    assert min(times["gradients"]) < 2.2 * NOISE * min(times["sums"])
    # by hand a million variants took 49 s
    assert min(times["rows"]) / studies.MANY < 0.1 * min(times["hand"]) / studies.FEW


def test_figures() -> None:
    assert min(studies.figures()["figures"]) / studies.SOME * 1e6 < 6.0 * NOISE


def test_memory() -> None:
    code = [sys.executable, "-m", "tests.benchmarks.studies", "memory"]
    found = subprocess.run(code, check=True, capture_output=True, text=True).stdout
    assert float(found.split()[0]) < 300.0
