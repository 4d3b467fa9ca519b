"""Stages on stages whose change points coincide, with motions in closed form.

At a change point every stage goes on in the direction in which it came; the suite's own continuation, which ends where
its Jacobian is singular, cannot tell that.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import compoundkin as ck
from tests.stress.outcome import Outcome, shown
from tests.stress.ways import SPACINGS

# Places agree to this part of the size.
SAME = 1e-7
# Nearer to a change point (radians, sizes) two branches are one to this digit, or there is no pose.
BESIDE = 1e-5
# A stage is drawn no nearer to a change point.
REGULAR = 0.1


@dataclass
class Stack:
    """What is drawn, its driver with the range of its values, and where its points are then."""

    items: list[Any]
    drawn: dict[str, complex]
    drive: Any
    home: float
    low: float
    high: float
    places: Callable[[np.ndarray], dict[str, np.ndarray]]
    beside: Callable[[np.ndarray], np.ndarray]


def stacked(seed: int, number: int) -> Outcome:
    """The outcome of a case of stacked stages."""
    rng, out = np.random.default_rng((seed, number, 3)), Outcome(number)
    name = str(rng.choice(list(STACKS)))
    stack = STACKS[name](rng)
    scale, turn = 10.0 ** float(rng.integers(-4, 5)), complex(np.exp(1j * rng.uniform(-np.pi, np.pi)))
    values = _values(rng, stack)
    mechanism = _placed(stack, scale, turn, f"stress {number}")
    began = time.process_time()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            # an angle is measured on the frame, which is not turned
            motion = ck.solve(mechanism, values + np.angle(turn) if name == "train" else values * scale)
    except Exception as error:
        out.faults.append(f"stacked {name}: {type(error).__name__}: {' '.join(str(error).split())[:300]}")
        return out
    out.seconds = time.process_time() - began
    out.counts.update({"kind stacked": 1, f"stack {name}": 1, "poses": values.size})
    out.counts["poses assembled"] += int(np.sum(motion.assembled))
    far = stack.beside(values) > BESIDE
    lost = np.flatnonzero(far & ~motion.assembled)
    if lost.size:
        out.faults.append(f"stacked {name}: not assembled at {shown(list(lost))} of {values.size}")
    off = np.zeros(values.size)
    for letter, place in stack.places(values).items():
        found = motion.points[letter].position / (scale * turn)
        off = np.fmax(off, np.where(far & motion.assembled, np.abs(found - place), 0.0))
    bad = np.flatnonzero(off > SAME)
    if bad.size:
        out.faults.append(
            f"stacked {name}: another pose at {shown(list(bad))} of {values.size}, off by {off.max():.2g}"
        )
    return out


def _values(rng: np.random.Generator, stack: Stack) -> np.ndarray:
    first, last = rng.uniform(stack.low, stack.high, 2)
    if rng.random() < 0.5:
        first, last = (stack.low, stack.high) if rng.random() < 0.5 else (stack.home, -stack.home)
    values = np.linspace(first, last, int(rng.integers(3, 120)))
    return SPACINGS[str(rng.choice(list(SPACINGS)))](rng, values) if rng.random() < 0.4 else values


def _placed(stack: Stack, scale: float, turn: complex, title: str) -> ck.Mechanism:
    """The stack in another size and turned, on a link that is fixed to the frame's letters."""
    drawn = {k: complex(z * scale * turn) for k, z in stack.drawn.items()}
    items = [item(drawn, float(np.angle(turn))) for item in stack.items]
    return ck.Mechanism(title, *items, stack.drive, ck.drawn(**drawn))


def _link(name: str, *letters: str) -> Callable[[dict[str, complex], float], Any]:
    """A link with these letters where they are drawn, in a frame of its own along the first two."""

    def item(drawn: dict[str, complex], _: float) -> Any:
        if name == "frame":
            return ck.link(name, **{k: drawn[k] for k in letters})
        start = drawn[letters[0]]
        along = drawn[letters[1]] - start if len(letters) > 1 else 1.0
        along /= abs(along)
        return ck.link(name, **{k: (drawn[k] - start) / along for k in letters})

    return item


def _guide(name: str, link: str, at: str, through: str) -> Callable[[dict[str, complex], float], Any]:
    return lambda _, angle: ck.slide(link, on="frame", at=at, through=through, angle=angle, name=name)


def tongs(rng: np.random.Generator) -> Stack:
    """Lazy tongs of crossed arms of length 2 on a roller: flat and folded at once at 0."""
    stages, home = int(rng.integers(1, 13)), float(rng.uniform(0.3, 1.8))
    names = [f"{a}{k}" for k in range(stages + 1) for a in "PQ"]

    def places(x: np.ndarray) -> dict[str, np.ndarray]:
        high = 1j * np.sqrt(4.0 - x**2)
        found = {name: (x if name[0] == "Q" else 0.0) + high * int(name[1:]) for name in names}
        return found | {f"M{k}": x / 2.0 + high * (k + 0.5) for k in range(stages)}

    items = [_link("frame", "P0"), _link("roller", "Q0"), _guide("guide", "roller", "Q0", "P0")]
    for k in range(stages):
        items += [_link(f"a{k}", f"P{k}", f"M{k}", f"Q{k + 1}"), _link(f"b{k}", f"Q{k}", f"M{k}", f"P{k + 1}")]
    drawn = {k: complex(z) for k, z in places(np.array(home)).items()}
    drive = ck.drive("roller", on="frame", pair="guide")
    return Stack(items, drawn, drive, home, -1.9, 1.9, places, np.abs)


def umbrella(rng: np.random.Generator) -> Stack:
    """Ribs on a pole's top with struts as long to a runner: all change at once where it is at the top."""
    ribs = int(rng.integers(1, 9))
    arms = rng.uniform(1.0, 3.0, ribs)
    sides = rng.choice([-1.0, 1.0], ribs)
    home = float(rng.uniform(0.3, 1.8))

    def places(x: np.ndarray) -> dict[str, np.ndarray]:
        found = {"R": x + 0j, "T": 0.0 * x + 0j}
        for k in range(ribs):
            found[f"S{k}"] = x / 2.0 + 1j * sides[k] * np.sqrt(arms[k] ** 2 - x**2 / 4.0)
        return found

    items = [_link("frame", "T"), _link("runner", "R"), _guide("pole", "runner", "R", "T")]
    for k in range(ribs):
        items += [_link(f"rib{k}", "T", f"S{k}"), _link(f"strut{k}", "R", f"S{k}")]
    drawn = {k: complex(z) for k, z in places(np.array(home)).items()}
    return Stack(items, drawn, ck.drive("runner", on="frame", pair="pole"), home, -1.9, 1.9, places, np.abs)


def train(rng: np.random.Generator) -> Stack:
    """Parallelograms and antiparallelograms, each driven by the crank of the one before.

    The pin of an antiparallelogram is that of the parallelogram, mirrored in the diagonal.
    """
    stages, aligned = int(rng.integers(1, 7)), rng.random() < 0.6
    kinds = rng.random(stages) < 0.3
    kinds[np.cumsum(kinds) > 2] = False
    radius, base = float(rng.uniform(0.3, 0.6)), rng.uniform(1.0, 2.0, stages)
    direction = np.where(aligned, 1.0, np.exp(1j * rng.uniform(-np.pi, np.pi, stages)))
    pivots = np.concatenate(([0.0], np.cumsum(base * direction)))

    def turned(theta: np.ndarray) -> list[np.ndarray]:
        """Directions of all cranks."""
        found = [np.exp(1j * theta)]
        for k in range(stages):
            pin, pivot = pivots[k] + radius * found[-1], pivots[k + 1]
            other = pivot + radius * found[-1]
            if kinds[k]:
                diagonal = (pivot - pin) / np.abs(pivot - pin)
                other = pin + diagonal**2 * np.conj(other - pin)
            found.append((other - pivot) / radius)
        return found

    def places(theta: np.ndarray) -> dict[str, np.ndarray]:
        found = {f"B{k}": pivots[k] + radius * u for k, u in enumerate(turned(theta))}
        return found | {f"A{k}": pivots[k] + 0.0 * theta for k in range(stages + 1)}

    def beside(theta: np.ndarray) -> np.ndarray:
        away = [np.abs((u * np.conj(d)).imag) for u, d in zip(turned(theta), direction, strict=False)]
        return np.min(away, axis=0)

    home = float(rng.uniform(-np.pi, np.pi))
    while beside(np.array(home)) < REGULAR:
        home = float(rng.uniform(-np.pi, np.pi))
    items = [_link("frame", *(f"A{k}" for k in range(stages + 1)))]
    items += [_link(f"crank{k}", f"A{k}", f"B{k}") for k in range(stages + 1)]
    items += [_link(f"rod{k}", f"B{k}", f"B{k + 1}") for k in range(stages)]
    drawn = {k: complex(z) for k, z in places(np.array(home)).items()}
    return Stack(items, drawn, ck.drive("crank0", on="frame", pair="A0"), home, home - 7.0, home + 7.0, places, beside)


STACKS: dict[str, Callable[[np.random.Generator], Stack]] = {"tongs": tongs, "umbrella": umbrella, "train": train}
