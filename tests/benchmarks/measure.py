"""Times taken side by side: machines are noisy, ratios measured in one run much less so."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from statistics import median
from typing import Any

Times = dict[str, list[float]]


def interleaved(
    subjects: Mapping[str, Callable[[], Any]],
    rounds: int,
    clock: Callable[[], float] = time.perf_counter,
    is_warm: bool = False,
) -> Times:
    """The seconds of each subject, one call of each in every round, after one round that is not counted.

    Where it is to be warm, a call that is not counted goes before each: what ran before it left it cold caches.
    """
    times: Times = {name: [] for name in subjects}
    for run in range(rounds + 1):
        for name, call in subjects.items():
            if is_warm:
                call()
            start = clock()
            result = call()
            seconds = clock() - start
            del result
            if run:
                times[name].append(seconds)
    return times


def ratio(times: Times, one: str, other: str) -> float:
    """How many times as long `one` takes as `other`: the median over the rounds."""
    return median(a / b for a, b in zip(times[one], times[other], strict=True))


def commands(codes: Mapping[str, list[str]], rounds: int, bytecode: Path) -> Times:
    """The seconds of processor time of Python with these arguments, started anew, interleaved.

    Their bytecode is kept in a folder: by the round that is not counted.
    """
    kept = {"PYTHONPYCACHEPREFIX": str(bytecode), "PYTHONDONTWRITEBYTECODE": "", "OPENBLAS_NUM_THREADS": "1"}
    silent: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}

    def start(arguments: list[str]) -> Callable[[], Any]:
        return lambda: subprocess.run([sys.executable, *arguments], check=True, env={**os.environ, **kept}, **silent)

    return interleaved({name: start(arguments) for name, arguments in codes.items()}, rounds, _of_children)


def least_ratio(times: Times, one: str, other: str) -> float:
    """How many times as long `one` takes as `other`, at their best."""
    return min(times[one]) / min(times[other])


def _of_children() -> float:
    """The processor time of all processes that were started and have ended."""
    found = os.times()
    return found.children_user + found.children_system
