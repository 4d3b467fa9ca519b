"""What several tests need: random series, pairs of every kind, random mechanisms whose pose is known, interrupts."""

from __future__ import annotations

import json
import os
import signal
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import MISSING, dataclass, field, fields
from math import factorial
from pathlib import Path
from typing import Any

import numpy as np

import compoundkin as ck
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Series
from compoundkin.model.fields import point_fields
from compoundkin.model.pairs import Pair

EVERYTHING = os.environ.get("COMPOUNDKIN_TESTS") == "all"
REFERENCE = Path(__file__).parent / "reference"

# A mechanism file, its driver last.
DRIVE = '[[drives]]\nlink = "crank"\n'
FOUR_BAR = f"""\
format = 1
title = "Four-bar"
[links.frame]
points = {{ A = [0, 0], D = [4, 0] }}
[links.crank]
points = {{ A = [0, 0], B = [1, 0] }}
[links.coupler]
points = {{ B = [0, 0], C = [3, 0] }}
[links.rocker]
points = {{ D = [0, 0], C = [3, 0] }}
{DRIVE}"""


def examples(count: int) -> int:
    """How many examples of Hypothesis a test takes: all in `.ci/run`, a third in the short suite."""
    return count if EVERYTHING else count // 3


def reference(name: str, subject: str = "kinematics") -> dict[str, Any]:
    """An entry of the published or independently computed numbers."""
    entries = json.loads((REFERENCE / f"{subject}.json").read_text())
    return next(entry for entry in entries if entry["id"] == name)


# --- series ---------------------------------------------------------------------------------------------


def random_real(rng: np.random.Generator, order: int, shape: tuple[int, ...], spread: float = 1.0) -> Series:
    return Series(tuple(rng.standard_normal(shape) * spread / factorial(k) for k in range(order + 1)))


def random_planar(rng: np.random.Generator, order: int, shape: tuple[int, ...], spread: float = 1.0) -> Series:
    x, y = random_real(rng, order, shape, spread), random_real(rng, order, shape, spread)
    return Series(tuple(a + 1j * b for a, b in zip(x.c, y.c, strict=True)))


def random_unit(rng: np.random.Generator, order: int, shape: tuple[int, ...]) -> Series:
    a = random_real(rng, order, shape)
    return Series((rng.uniform(-np.pi, np.pi, shape), *a.c[1:])).turn()


def random_pose(rng: np.random.Generator, order: int, shape: tuple[int, ...]) -> Pose:
    rates = random_real(rng, order, shape)
    theta = Series((rng.uniform(-np.pi, np.pi, shape), *rates.c[1:]))
    return Pose(random_planar(rng, order, shape), theta.turn(), theta)


def largest(values: Iterable[Any]) -> float:
    """The largest absolute value in several arrays, NaN if any is."""
    return max((float(np.max(np.abs(v))) for v in values), default=0.0)


# --- pairs ----------------------------------------------------------------------------------------------


def sample(kind: type[Pair], tag: str = "") -> Pair:
    """A pair of a kind, every name that it needs being that of its field and a tag; profiles an oval."""
    numbers = {"profile": OVAL, "radius": 1.0, "circle": 2.0}
    given = [f.name for f in fields(kind) if f.default is MISSING]
    names = [*given, "name", *(name for name in point_fields(kind) if name != "toward")]
    return kind(**{name: numbers.get(name, name + tag) for name in names})


# Flat enough for its centres of curvature to keep away from the random points of most tests.
OVAL = ck.profiles.formula(lambda s: 0.3 * np.cos(s) + 0.25j * np.sin(s), 0.0, 2 * np.pi)


def ends_at(pair: Pair, rng: np.random.Generator, poses: tuple[Pose, ...]) -> tuple[End, ...]:
    """Sides of a pair in its links' frames that close it at the given poses, for kinds that do not count turns."""
    world = pair.generic(rng)
    return tuple(pose.inverse().carry(end) for pose, end in zip(poses, world, strict=True))


# --- mechanisms whose assembled pose is known --------------------------------------------------------------


@dataclass
class Sketch:
    """A mechanism as drawn: the letters of every link, where they are, its slides and drives."""

    links: dict[str, list[str]]
    places: dict[str, complex]
    slides: list[dict[str, Any]] = field(default_factory=list)
    drives: list[dict[str, Any]] = field(default_factory=list)

    def letter(self, place: complex, *links: str) -> str:
        name = f"P{len(self.places)}"
        self.places[name] = place
        for link in links:
            self.links[link].append(name)
        return name

    def mechanism(self, change: Callable[[complex], complex] = complex, title: str = "random") -> ck.Mechanism:
        """It as a `Mechanism`, its points moved by `change`."""
        points = {k: change(p) for k, p in self.places.items()}
        items = [ck.link(name, *letters) for name, letters in self.links.items()]
        items += [ck.slide(**words) for words in self.slides]
        items += [ck.drive(**words) for words in self.drives]
        return ck.Mechanism(title, *items, ck.drawn(**points))

    def renamed(self, links: Mapping[str, str]) -> Sketch:
        """Other names for the links."""

        def new(words: dict[str, Any]) -> dict[str, Any]:
            return {k: links.get(v, v) if k in ("link", "on") else v for k, v in words.items()}

        return Sketch(
            {links.get(k, k): v for k, v in self.links.items()},
            self.places,
            [new(w) for w in self.slides],
            [new(w) for w in self.drives],
        )


KINDS_OF_DYAD = ("RRR", "RRP", "RPR", "PRP", "RPP")


def random_sketch(rng: np.random.Generator, kinds: Iterable[str], driver: str = "R", multiple: float = 0.3) -> Sketch:
    """A crank or driven slide on the frame and dyads of the given kinds, each on random links before it.

    Every link's first two letters are well apart, so that its own axes are well defined; some pins are multiple.
    """
    sketch = Sketch({"frame": [], "link0": []}, {})
    known = ["frame", "link0"]
    if driver == "R":
        sketch.letter(_place(rng), "frame", "link0")
        sketch.letter(_place(rng), "link0")
        sketch.drives.append({"link": "link0", "speed": 1.0})
    else:
        _slide(sketch, rng, "frame", "link0", name="drive")
        sketch.drives.append({"link": "link0", "on": "frame", "speed": 1.0})
    sketch.letter(_place(rng), "frame")
    for index, kind in enumerate(kinds):
        bodies = [f"a{index}", f"b{index}"]
        sketch.links.update({b: [] for b in bodies})
        around = [known[i] for i in rng.choice(len(known), 2, replace=False)]
        for code, body, outside in zip(kind[::2], bodies, around, strict=True):
            _join(sketch, rng, code, outside, body, multiple, taken={k for b in bodies for k in sketch.links[b]})
        _join(sketch, rng, kind[1], bodies[0], bodies[1], 0.0)
        for body in bodies:
            while len(sketch.links[body]) < 2:
                sketch.letter(_place(rng), body)
        known += bodies
    return sketch


def _place(rng: np.random.Generator) -> complex:
    return complex(*rng.uniform(-3.0, 3.0, 2))


def _join(
    sketch: Sketch,
    rng: np.random.Generator,
    code: str,
    one: str,
    other: str,
    multiple: float,
    taken: Iterable[str] = (),
) -> None:
    if code == "R":
        pinned = [k for k in sketch.links[one] if sum(k in letters for letters in sketch.links.values()) > 1]
        free = [k for k in pinned if k not in taken]
        if free and rng.random() < multiple:
            sketch.links[other].append(free[-1])
        else:
            sketch.letter(_place(rng), one, other)
    else:
        guide, block = (one, other) if rng.random() < 0.5 else (other, one)
        _slide(sketch, rng, guide, block)


def _slide(sketch: Sketch, rng: np.random.Generator, guide: str, block: str, name: str = "") -> None:
    through = sketch.letter(_place(rng), guide)
    toward = sketch.letter(sketch.places[through] + np.exp(1j * rng.uniform(0, 6.28)), guide)
    at = sketch.letter(_place(rng), block)
    words = {"link": block, "on": guide, "at": at, "through": through, "toward": toward}
    sketch.slides.append({**words, **({"name": name} if name else {})})


def drawn_values(mechanism: ck.Mechanism) -> dict[str, float]:
    """The drivers' values in the drawn pose, read off the drawing by plain geometry (not by the package)."""
    sketch, values = mechanism.sketch, {}
    letters = {name: link.letters for name, link in mechanism.links.items()}

    def angle(link: str) -> float:
        if link == "frame":
            return 0.0
        first, second = letters[link][:2]
        return float(np.angle(sketch[second] - sketch[first]))

    for drive in mechanism.drives:
        slide = next((p for p in mechanism.written_pairs if {drive.link, drive.on} == set(p.members)), None)
        if slide is None:
            values[drive.name] = angle(drive.link) - angle(drive.on)
        else:
            at, through, toward = (sketch[k] for k in slide.letters)
            line = (toward - through) / abs(toward - through)
            values[drive.name] = float((np.conj(line) * (at - through)).real)
    return values


def well_conditioned(mechanism: ck.Mechanism, limit: float, reach: float) -> bool:
    """Whether no link is much faster than the driver within some reach of the drawn pose: no limit position is near."""
    values = {name: value + reach * np.linspace(-1.0, 1.0, 9) for name, value in drawn_values(mechanism).items()}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
        motion = ck.solve(mechanism, values, order=2)
    if not np.all(motion.assembled):
        return False
    fast = [np.max(np.abs(point.derivative(k))) ** (1 / k) for point in motion.points.values() for k in (1, 2)]
    return float(np.max(fast)) < limit


def differences(values: Any, step: float) -> list[Any]:
    """Derivatives 1, 2, 3 at the middle of nine equally spaced samples (last axis), by central differences.

    Exact for polynomials of degree 8; the weights are those that differentiate the interpolating polynomial.
    """
    offsets = np.arange(-4, 5)
    powers = np.vander(offsets.astype(float), increasing=True)
    weights = np.linalg.inv(powers)  # row k gives the k-th coefficient
    return [np.asarray(values) @ weights[k] * factorial(k) / step**k for k in (1, 2, 3)]


@contextmanager
def interrupts_heard() -> Iterator[None]:
    """Processes started now hear Ctrl-C, also where the tests run in the background of a shell that ignores it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
