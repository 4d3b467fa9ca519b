"""Better dimensions beside pylinkage's own example, and the heavy case of the literature.

``python -m tests.benchmarks.optimisation`` (a minute). pylinkage's example (docs/examples/fourbar_linkage.py of its
repository) makes the tip of a four-bar's rocker fill a box of 2 by 2, by particle swarms and by trials over a lattice;
its error is the sum of the squares of what the four sides are off. It is told here as pylinkage finds it, on the poses
of its own steps, and as it is all along the motion.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

import compoundkin as ck
from tests.benchmarks.__main__ import heading
from tests.studies.path_cases import CASES
from tests.studies.test_path_cases import FREE, START, TURN, hold_case

# Least and greatest y and x of the tip, as pylinkage orders them: min y, max x, max y, min x.
BOX = (0.0, 5.0, 2.0, 3.0)
BOUNDS = {"crank.B.x": (0.2, 5.0), "coupler.C.x": (0.6, 15.0), "rocker.C.x": (0.2, 5.0)}
ROUNDS = 3


def four_bar(crank: float = 1.0, coupler: float = 3.0, rocker: float = 1.0) -> ck.Mechanism:
    """The four-bar of the example."""
    return ck.Mechanism(
        "Four-bar of pylinkage",
        ck.link("frame", A=0, D=3),
        ck.link("crank", A=0, B=crank),
        ck.link("coupler", B=0, C=coupler),
        ck.link("rocker", D=0, C=rocker),
        ck.drive("crank"),
        ck.mode(-1, "rocker"),
    )


def ours() -> tuple[float, ck.Mechanism]:
    """The box by `optimise`, with a margin from the limit at which the best of all boxes lies."""
    sides = (("C.y.least", BOX[0]), ("C.x.greatest", BOX[1]), ("C.y.greatest", BOX[2]), ("C.x.least", BOX[3]))
    low, right, top, left = (ck.goals.target(name, value) for name, value in sides)
    goal = low + right + top + left
    turn = np.linspace(0.0, 2.0 * np.pi, 25)
    found = ck.optimise(four_bar(), BOUNDS, goal, ck.goals.assembles(0.02), values=turn, starts=2)
    return found.value, found.mechanism


def by_pylinkage(search: str) -> tuple[float, ck.Mechanism]:
    """The box by pylinkage; raises ImportError where it is missing."""
    import pylinkage as pl
    from pylinkage.actuators import Crank
    from pylinkage.components import Ground
    from pylinkage.dyads import RRRDyad
    from pylinkage.simulation import Linkage

    pivot, other = Ground(0, 0, name="A"), Ground(3, 0, name="D")
    crank = Crank(anchor=pivot, radius=1.0, angular_velocity=0.31, name="B")
    tip = RRRDyad(anchor1=crank.output, anchor2=other, distance1=3.0, distance2=1.0, name="C")
    linkage = Linkage([pivot, other, crank, tip], name="four-bar")

    @pl.kinematic_minimization  # type: ignore[misc]
    def error(loci: Any, **_: Any) -> float:
        box = pl.bounding_box(tuple(one[-1] for one in loci))
        return float(sum((one - wanted) ** 2 for one, wanted in zip(box, BOX, strict=True)))

    more = {"divisions": 25} if search.startswith("trials") else {}
    bounds = pl.generate_bounds(linkage.get_constraints())
    call = getattr(pl, search)
    best = call(eval_func=error, linkage=linkage, bounds=bounds, order_relation=min, verbose=False, **more)[0]
    return float(best.score), four_bar(*best.dimensions)


def told(label: str, search: Callable[[], tuple[float, ck.Mechanism]]) -> None:
    """One row: the error that is told, the shortest time, the error all along and how much of the turn is assembled."""
    seconds, errors = [], []
    for _ in range(ROUNDS):
        began = time.perf_counter()
        error, mechanism = search()
        seconds.append(time.perf_counter() - began)
        errors.append(error)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        turned = ck.solve(mechanism, np.linspace(0.0, 2.0 * np.pi, 3601))
    tip, share = turned.points["C"].position, turned.assembled.mean()
    box = (np.nanmin(tip.imag), np.nanmax(tip.real), np.nanmax(tip.imag), np.nanmin(tip.real))
    along = sum((one - wanted) ** 2 for one, wanted in zip(box, BOX, strict=True))
    print(
        f"  {label:32s} error {max(errors):.5f} at worst of {ROUNDS}, {min(seconds):.1f} s; "
        f"all along {along:.5f}, {100 * share:.2f} % of the turn assembled"
    )


def box() -> None:
    """pylinkage's own example."""
    heading("pylinkage's example: the tip of a rocker in a box")
    told("ck.optimise", ours)
    for search in ("particle_swarm_optimization", "trials_and_errors_optimization"):
        try:
            told(f"pylinkage, {search.split('_optim')[0]}", lambda search=search: by_pylinkage(search))  # type: ignore[misc]
        except ImportError as missing:
            print(f"  left out: {missing}")


def line() -> None:
    """Six points on a line, without timing, by a crank that turns fully."""
    heading("six points on a line, without timing (Cabrera et al. 2002)")
    case, began = CASES["line"], time.perf_counter()
    goal, turns = ck.goals.trace("P", case.target), ck.goals.full_turn()
    found = ck.optimise(START["line"], FREE["line"], goal, turns, values=TURN, starts=4, seed=2)
    hold_case(case, found)
    print(f"  error {found.value:.2g}, published {case.best:.2g}, {time.perf_counter() - began:.1f} s")


if __name__ == "__main__":
    box()
    line()
