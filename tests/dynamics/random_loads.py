"""Random mechanisms of the stress suite with random masses and loads, and whether their forces balance.

`python -m tests.dynamics.random_loads 1000` tries so many and tells the worst of each finding.
"""

from __future__ import annotations

import sys
import warnings
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np

import compoundkin as ck
from compoundkin.model.pairs.contract import as_turn_counting
from compoundkin.results import Check, Motion
from tests.dynamics.cases import SI
from tests.stress.sketch import Placed
from tests.stress.trial import Case, drawn_case

SEED = 15
# Masses, loads: about the weight of a unit of mass at a mechanism of the size 1.
PULL = 10.0
# Racks are held to this part of the size, which is more than rounding leaves.
FITTING = 1e-9


def loads(rng: np.random.Generator, mechanism: ck.Mechanism) -> Iterator[Any]:
    """Yield random masses and gravity; forces, a torque, a spring and a damper on random links."""
    size, links = mechanism.geometry.size, [link for link in mechanism.links if link != "frame"]

    def place() -> tuple[float, float]:
        x, y = rng.uniform(-0.5, 0.5, 2) * size
        return float(x), float(y)

    for link in links:
        if rng.random() < 0.8:
            mass = float(rng.uniform(0.1, 2.0))
            yield ck.mass(link, mass, at=place(), inertia=float(rng.uniform(0.0, 0.3)) * mass * size**2)
    yield ck.gravity(*rng.uniform(-PULL, PULL, 2))
    for k in range(3):
        link = links[int(rng.integers(len(links)))]
        fixed = "frame" if rng.random() < 0.5 else link
        force = rng.uniform(-PULL, PULL, 2) * np.array([1.0, 1.0])
        yield ck.force(link, tuple(force), at=mechanism.links[link].letters[0], fixed_in=fixed, name=f"force {k}")
    yield ck.torque(links[-1], float(rng.uniform(-PULL, PULL)) * size)
    ends = [(link, letter) for link in links for letter in mechanism.links[link].letters]
    (one, first), (two, second) = (ends[int(k)] for k in rng.choice(len(ends), 2))
    if first != second and one != two:
        between = {"to": two, "at": second}
        yield ck.spring(one, first, **between, stiffness=PULL / size, free_length=0.3 * size)
        yield ck.damper(one, first, **between, rate=PULL / size)


def loaded_motion(case: Case) -> Motion:
    """Return the motion of a case of the stress suite with loads."""
    rng = np.random.default_rng((SEED, case.number))
    plain = Placed(case.sketch).mechanism(f"random {case.number}")
    mechanism = plain.replace(*loads(rng, plain), unit="", units=SI)
    rates = {
        name: dict(zip(case.names, found.tolist(), strict=True))
        for name, found in (("speed", case.speed), ("acceleration", case.acceleration))
    }
    return ck.solve(mechanism, case.values(Placed(case.sketch).values()), **rates)


def fits(motion: Motion) -> bool:
    """Tell whether all racks and wheels stay in touch; others do work that no force on a link does."""
    for name, pair in motion.solving_order.pairs.items():
        counting, poses = as_turn_counting(pair), tuple(motion.poses[member] for member in pair.members)
        error = counting.distance_error(motion.inputs.ends[name], poses) if counting else None
        for k in range(2 if error is not None else 0):
            if np.any(np.abs(np.where(motion.regular, error.derivative(k), 0.0)) > FITTING * motion.size):
                return False
    return True


def check_of(case: Case) -> Check | None:
    """Return the findings about the forces of a case, None of one whose racks do not fit."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        motion = loaded_motion(case)
        return ck.verify(ck.force_analysis(motion)) if fits(motion) else None


def main(count: int, small: bool) -> None:
    """Try so many cases."""
    worst: Counter[str] = Counter()
    told: Counter[str] = Counter()
    for number in range(count):
        try:
            check = check_of(drawn_case(SEED, number, small))
            if check is None:
                told["racks that do not fit"] += 1
                continue
        except ck.errors.CompoundkinError as error:
            told[type(error).__name__] += 1
            print(number, "refused:", " ".join(str(error).split())[:200])
            continue
        told[check.verdict if not check.failed else "failed"] += 1
        told["poses"] += check.poses
        for finding in check.findings:
            worst[finding.name] = (
                max(worst[finding.name], finding.value) if np.isfinite(finding.value) else worst[finding.name]
            )
            if not finding.passed:
                print(number, finding)
    print(told, {name: f"{value:.1e}" for name, value in worst.items()})


if __name__ == "__main__":
    main(int(sys.argv[1]), small="small" in sys.argv)
