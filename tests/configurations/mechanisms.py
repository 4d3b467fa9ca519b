"""Mechanisms that the tests of circuits share."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

import compoundkin as ck
from tests.support import Sketch, random_sketch


def four_bar(a: float, b: float, c: float, d: float, driver: str = "crank") -> ck.Mechanism:
    """Crank a, coupler b, rocker c, frame d."""
    return ck.Mechanism(
        "Four-bar",
        ck.link("frame", A=(0, 0), D=(d, 0)),
        ck.link("crank", A=(0, 0), B=(a, 0)),
        ck.link("coupler", B=(0, 0), C=(b, 0)),
        ck.link("rocker", D=(0, 0), C=(c, 0)),
        ck.drive(driver),
    )


def slider_crank(r: float, rod: float, offset: float, driver: str = "crank") -> ck.Mechanism:
    return ck.Mechanism(
        "Slider-crank",
        ck.link("frame", A=(0, 0), F=(0, offset)),
        ck.link("crank", A=(0, 0), B=(r, 0)),
        ck.link("rod", B=(0, 0), C=(rod, 0)),
        ck.link("piston", C=(0, 0)),
        ck.slide("piston", on="frame", at="C", through="F", angle=0.0),
        ck.drive(driver),
    )


def random_place(rng: np.random.Generator) -> complex:
    return complex(*rng.uniform(-3.0, 3.0, 2))


def random_triad(
    rng: np.random.Generator, legs: Iterable[str] = ("RR", "RR", "RR"), more: Iterable[str] = ()
) -> Sketch:
    """A crank, dyads of the kinds `more` after it, and a plate on three legs: each leg's outer and inner pair."""
    sketch = random_sketch(rng, more, multiple=0.0)
    known = list(sketch.links)
    sketch.links["plate"] = []
    for i, (outer, inner) in enumerate(legs):
        leg, base = f"leg{i}", known[i % 2] if i < 2 else known[int(rng.integers(len(known)))]
        sketch.links[leg] = []
        for kind, one, other in ((outer, base, leg), (inner, leg, "plate")):
            if kind == "R":
                sketch.letter(random_place(rng), one, other)
            else:
                slide(sketch, rng, one, other)
    for name in ("plate", *(f"leg{i}" for i in range(3))):
        while len(sketch.links[name]) < 2:
            sketch.letter(random_place(rng), name)
    return sketch


def slide(sketch: Sketch, rng: np.random.Generator, guide: str, block: str) -> None:
    through = sketch.letter(random_place(rng), guide)
    toward = sketch.letter(sketch.places[through] + np.exp(1j * rng.uniform(0, 6.28)), guide)
    at = sketch.letter(random_place(rng), block)
    sketch.slides.append({"link": block, "on": guide, "at": at, "through": through, "toward": toward})


def random_six_bodies(rng: np.random.Generator) -> Sketch:
    """A crank and one group of six links: two plates pinned to each other, each on two legs."""
    sketch = random_sketch(rng, (), multiple=0.0)
    sketch.links.update({"p": [], "q": []})
    sketch.letter(random_place(rng), "p", "q")
    for leg, base, plate in (("a", "frame", "p"), ("b", "link0", "p"), ("c", "frame", "q"), ("d", "frame", "q")):
        sketch.links[leg] = []
        sketch.letter(random_place(rng), base, leg)
        sketch.letter(random_place(rng), leg, plate)
    return sketch
