"""Rows of studies beside the same by hand with `solve`: ``python -m tests.benchmarks.studies`` (half a minute).

A crank-rocker with five free dimensions at 36 poses: the squares of distances to a path, summed over the poses of each
design, and its figures (a stroke, a time ratio, a least transmission angle). Rows are those of a study, with its sample
and states, by two threads. By hand are the same sums of `solve`, of fewer designs.
"""

from __future__ import annotations

import resource
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

import numpy as np

import compoundkin as ck
from compoundkin.base.errors import suppress_pose_warnings
from compoundkin.studies.responses import studied_path
from compoundkin.studies.samples import sample_of
from compoundkin.studies.samples.variations import variations_of
from compoundkin.studies.study_program import StudyProgram
from tests.benchmarks.__main__ import heading, row
from tests.benchmarks.measure import Times, interleaved

MANY, SOME, FEW, CHUNK, THREADS = 2**20, 2**18, 2**12, 2**16, 2
TURN = ck.deg(np.arange(0, 360, 10.0))
CYCLE = ck.deg(np.arange(0, 361, 10.0))
OWN = {"crank.B.x": 2.0, "coupler.C.x": 5.0, "rocker.C.x": 4.0, "coupler.P.x": 2.5, "coupler.P.y": 1.5}
FIGURES = ("rocker.angle.stroke", "rocker.angle.time_ratio", "coupler.transmission_angle.least")
ERROR = {"error": lambda at: abs(at["P.position"] - at["target"]) ** 2}


def mechanism() -> ck.Mechanism:
    """The crank-rocker of the page on compiled programs."""
    return ck.Mechanism(
        "Crank-rocker", ck.link("frame", A=0, D=5), ck.link("crank", A=0, B=2),
        ck.link("coupler", B=0, C=5, P=2.5 + 1.5j), ck.link("rocker", D=0, C=4), ck.drive("crank"),
        ck.mode(-1, "rocker"),
    )  # fmt: skip


def program(outputs: Any, count: int, values: Any = TURN) -> StudyProgram:
    """A study of designs within three per cent."""
    ranges = variations_of({name: (0.97 * own, 1.03 * own) for name, own in OWN.items()})
    given = {"target": target()} if outputs is ERROR else None
    path, responses = studied_path(mechanism(), list(OWN), outputs, values, given=given)
    return StudyProgram(ranges, sample_of("sobol", count, 1, ranges), path, responses)


def target() -> Any:
    """The path of the mechanism itself."""
    return ck.quantity(ck.solve(mechanism(), TURN), "P.position").values


def rows(study: StudyProgram) -> None:
    """All rows, chunk by chunk."""
    each(study, lambda chunk: study.rows(chunk))


def asked(study: StudyProgram, is_sloped: bool) -> None:
    """All sums without states, or their slopes."""
    (response,) = study.responses

    def block(part: range) -> None:
        designs = study.path.designs(study.sample.designs(study.variations, part))
        _ = response.slopes(designs) if is_sloped else response.values(designs)

    with suppress_pose_warnings():
        each(study, lambda chunk: [block(chunk[k : k + study.block]) for k in range(0, len(chunk), study.block)])


def each(study: StudyProgram, do: Callable[[range], Any]) -> None:
    """Do something with each chunk, by two threads."""
    chunks = [range(k, min(k + CHUNK, study.count)) for k in range(0, study.count, CHUNK)]
    with ThreadPoolExecutor(THREADS) as threads:
        list(threads.map(lambda chunk: do(chunk) and None, chunks))


def by_hand() -> Any:
    """The sums of some designs by `solve`."""
    study = program(ERROR, FEW)
    designs = study.path.designs(study.sample.designs(study.variations, range(FEW)))
    places = ck.quantity(designs.motion, "P.position").values
    return (abs(places - target()) ** 2).sum(axis=-1)


def sums(rounds: int = 5) -> Times:
    """Rows of one summed objective; with its gradient; by hand."""
    study = program(ERROR, MANY)
    heading(f"{MANY:,} designs at {len(TURN)} poses, one sum, {THREADS} threads")
    alone = {"sums": partial(asked, study, False), "gradients": partial(asked, study, True)}
    times = interleaved({"rows": partial(rows, study), **alone, "hand": by_hand}, rounds)
    scaled = {"rows": MANY, "sums": MANY, "gradients": MANY, "hand": FEW}
    for name, count in scaled.items():
        row(name, min(times[name]) / count, f"{min(times[name]) / count * MANY:.2f} s for all")
    return times


def figures(rounds: int = 3) -> Times:
    """Rows of three figures, found between the poses."""
    study = program(FIGURES, SOME, CYCLE)
    heading(f"{SOME:,} designs at {len(CYCLE)} poses: {', '.join(FIGURES)}")
    times = interleaved({"figures": partial(rows, study)}, rounds)
    row("figures", min(times["figures"]) / SOME, f"{min(times['figures']) / SOME * 1e6:.1f} s for a million")
    return times


def memory() -> float:
    """The most memory of this process after a study, in MB."""
    rows(program(ERROR, MANY))
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


if __name__ == "__main__":
    if "memory" in sys.argv:
        print(f"{memory():.0f} MB")
    else:
        sums()
        figures()
