"""Random mechanisms with motors, stops and friction, simulated: none ends without a true reason.

`python -m tests.dynamics.random_machines --count 200` tries so many and tells the slow and the wrong ones.
"""

from __future__ import annotations

import signal
import time
import warnings
from collections import Counter
from collections.abc import Iterator
from typing import Any, NamedTuple

import click
import numpy as np

import compoundkin as ck
from compoundkin.chains import random_mechanism
from tests.dynamics.cases import SI
from tests.stress.sketch import Placed
from tests.stress.trial import drawn_case
from tests.support import drawn_values

# What a simulation may take, seconds of processor time, and what its energies may be off.
SLOW, ENERGY = 5.0, 1e-6


def loads(rng: np.random.Generator, mechanism: ck.Mechanism) -> Iterator[Any]:
    """Yield masses, gravity, a motor at the driver, stops and friction."""
    size, (driver,) = mechanism.geometry.size, mechanism.drives
    pairs = ck.decompose(mechanism).pairs
    for link in mechanism.links:
        if link != "frame":
            yield ck.mass(link, float(rng.uniform(0.5, 2.0)), inertia=float(rng.uniform(0.1, 0.5)) * size**2)
    if rng.random() < 0.7:
        yield ck.gravity(*(float(x) for x in rng.uniform(-10.0, 10.0, 2)))
    speed = float(rng.uniform(3.0, 15.0))
    moved = next(own.pair for own in ck.decompose(mechanism).driven.values())
    unit = 1.0 if moved.free_is_angle else size
    push = 20.0 * size**2 / unit
    if moved.free_is_angle:
        yield ck.motor(driver.name, stall=push, no_load=speed, inertia=0.01 * size**2)
    else:
        yield ck.effort(driver.name, lambda w: push * (1.0 - w / (speed * size)))
    if rng.random() < 0.7:
        pair = pairs[int(rng.integers(len(pairs)))]
        if pair.is_simple:
            yield from stop(rng, mechanism, pair, size)
    for pair in pairs:
        if pair.is_simple and rng.random() < 0.7:
            if pair.free_is_angle:
                yield ck.friction(pair.name, float(rng.uniform(0.02, 0.2)), radius=0.05 * size)
            else:
                long = {"length": 0.5 * size} if rng.random() < 0.5 else {}
                yield ck.friction(pair.name, float(rng.uniform(0.02, 0.2)), **long)


def stop(rng: np.random.Generator, mechanism: ck.Mechanism, pair: Any, size: float) -> Iterator[Any]:
    """Yield a stop on both sides of where a pair is drawn, rigid or elastic."""
    try:
        motion = ck.solve(mechanism, {name: [value] for name, value in drawn_values(mechanism).items()})
    except ValueError:  # a sketch with arcs has no drawn values there
        return
    here, unit = float(np.ravel(motion.pairs[pair.name].value)[0]), 1.0 if pair.free_is_angle else size
    low, high = here - unit * float(rng.uniform(0.2, 2.0)), here + unit * float(rng.uniform(0.2, 2.0))
    if rng.random() < 0.5:
        yield ck.stop(pair.name, low, high, restitution=float(rng.choice([0.0, 0.3, 0.7])), name="ends")
    else:
        yield ck.stop(
            pair.name, low, high, stiffness=5e3 * size**2 / unit**2, damping=20.0 * size**2 / unit**2, name="ends"
        )


def machine(seed: int, number: int) -> ck.Mechanism | None:
    """Return a random machine, None where a drawing does not fit."""
    rng = np.random.default_rng((seed, number))
    sort = number % 4
    if sort < 3:
        kinds = ["RRR", "RRP", "RPR", "PRP", "RPP"]
        plain = random_mechanism(1 + int(rng.integers(3)), seed=int(rng.integers(10**6)), kinds=kinds)
    else:
        case = drawn_case(seed, number, small=True)
        plain = Placed(case.sketch).mechanism(f"random {number}")
        if len(plain.drives) != 1:
            return None
    return plain.replace(*loads(rng, plain), units=SI)


class Ended(NamedTuple):
    """How a simulation ended."""

    seconds: float
    how: str
    detail: str


class _Alarm(Exception):
    """Too long."""


def _ring(*_: Any) -> None:
    raise _Alarm


def tried(seed: int, number: int, longest: float, until: float = 2.0) -> Ended | None:
    """Simulate a machine for so long at most."""
    begun = time.process_time()
    signal.signal(signal.SIGVTALRM, _ring)
    try:
        made = machine(seed, number)
        if made is None:
            return None
        begun = time.process_time()
        signal.setitimer(signal.ITIMER_VIRTUAL, longest)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = ck.simulate(made, until=until)
    except _Alarm:
        return Ended(longest, "endless", "")
    except ck.errors.CompoundkinError as error:
        return Ended(time.process_time() - begun, "refused", " ".join(str(error).split())[:150])
    except Exception as error:
        return Ended(time.process_time() - begun, "ERROR", repr(error)[:200])
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
    seconds, last = time.process_time() - begun, found.events[-1] if found.events else None
    names = Counter(event.name for event in found.events)
    kinds = type(found.course.steps[-1].chart).__name__
    how = "done" if found.times[-1] >= until * (1 - 1e-12) else f"ends: {last.name if last else '?'}"
    wrong = f" ENERGY {found.energy.worst:.1g}" if found.energy.worst > ENERGY else ""
    return Ended(
        seconds, how + wrong, f"{kinds} {found.steps} steps {dict(names)} {str(last)[:90] if how != 'done' else ''}"
    )


@click.command()
@click.option("--count", default=60)
@click.option("--seed", default=5)
@click.option("--first", default=0)
@click.option("--longest", default=25.0)
def main(count: int, seed: int, first: int, longest: float) -> None:
    """Simulate random machines."""
    tally: Counter[str] = Counter()
    for number in range(first, first + count):
        found = tried(seed, number, longest)
        if found is None:
            continue
        tally[found.how] += 1
        tally["slow"] += found.seconds > SLOW
        print(f"{number:4d} {found.seconds:6.2f} {found.how:20s} {found.detail}", flush=True)
    print(tally)


if __name__ == "__main__":
    main()
