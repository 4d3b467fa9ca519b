"""Mechanisms of random geometry for structural tests, and a second way to take them apart."""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from compoundkin.model.elements import drive, link
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.prismatic import slide

REFERENCE = Path(__file__).parents[1] / "reference"


@dataclass
class Plan:
    """Pins (link numbers by letter), slides (guide, block), drivers (on, link); the frame is number 0."""

    links: int
    pins: list[list[int]] = field(default_factory=list)
    sliders: list[tuple[int, int]] = field(default_factory=list)
    drivers: list[tuple[int, int]] = field(default_factory=list)

    def build(self, order: list[int] | None = None, names: Callable[[int], str] = "k{}".format) -> Mechanism:
        def called(k: int) -> str:
            return names(k) if k else "frame"

        r = random.Random(7)
        points: dict[int, dict[str, complex]] = {k: {} for k in (order or range(self.links + 1))}
        items = []
        for i, pin in enumerate(self.pins):
            for k in pin:
                points[k][f"P{i}"] = complex(r.random(), r.random())
        for i, (guide, block) in enumerate(self.sliders):
            points[guide][f"S{i}"] = complex(r.random(), r.random())
            points[block][f"T{i}"] = complex(r.random(), r.random())
            ends = {"at": f"T{i}", "through": f"S{i}"}
            items.append(slide(called(block), on=called(guide), **ends, name=f"slide{i}"))
        driven = [drive(called(b), on=called(a), name=f"d{i}") for i, (a, b) in enumerate(self.drivers)]
        return Mechanism("plan", *(link(called(k), **p) for k, p in points.items()), *items, *driven)

    def groups_by_rank(self) -> set[frozenset[int]]:
        """Peel off, again and again, the smallest sets of links that what is known determines."""
        rng = np.random.default_rng(5)
        at = rng.standard_normal((len(self.pins), 2))
        guides = rng.standard_normal((len(self.sliders), 4))
        known, groups = {0, *(b for _, b in self.drivers)}, set()
        left = [k for k in range(self.links + 1) if k not in known]
        while left:
            found = next(
                set(s)
                for size in range(1, len(left) + 1)
                for s in combinations(left, size)
                if self._rank(known, s, at, guides) == 3 * size
            )
            groups.add(frozenset(found))
            known |= found
            left = [k for k in left if k not in found]
        return groups

    def _rank(self, known: set[int], unknown: tuple[int, ...], at: np.ndarray, guides: np.ndarray) -> int:
        column = {k: 3 * i for i, k in enumerate(unknown)}
        rows = []

        def row(a: int, b: int, coefficients: tuple[float, float, float]) -> None:
            new = np.zeros(3 * len(unknown))
            for k, sign in ((a, -1.0), (b, 1.0)):
                if k in column:
                    new[column[k] : column[k] + 3] += sign * np.array(coefficients)
            rows.append(new)

        for (x, y), pin in zip(at, self.pins, strict=True):
            here = [k for k in pin if k in known or k in column]
            for other in here[1:]:
                row(here[0], other, (1.0, 0.0, -y))
                row(here[0], other, (0.0, 1.0, x))
        for (x, y, nx, ny), (a, b) in zip(guides, self.sliders, strict=True):
            if {a, b} <= known | set(unknown):
                row(a, b, (nx, ny, nx * -y + ny * x))
                row(a, b, (0.0, 0.0, 1.0))
        return int(np.linalg.matrix_rank(np.array(rows))) if rows else 0


def random_plan(r: random.Random, groups: int, multiple: bool = False) -> tuple[Plan, set[frozenset[int]]]:
    """A crank with random dyads and triads on random links, and the groups it was made of."""
    plan, made = Plan(1, pins=[[0, 1]], drivers=[(0, 1)]), set()
    while len(made) < groups:
        size = r.choice((2, 2, 2, 4))
        new = list(range(plan.links + 1, plan.links + size + 1))
        for b in new[:2] if size == 2 else new[:3]:
            _join(plan, r, r.randrange(plan.links + 1), b, multiple)
        if size == 2:
            plan.pins.append(new)
        else:
            plan.pins += [[b, new[3]] for b in new[:3]]
        plan.links += size
        made.add(frozenset(new))
    return plan, made


def _join(plan: Plan, r: random.Random, known: int, b: int, multiple: bool) -> None:
    on_it = [pin for pin in plan.pins if known in pin and not any(k > plan.links for k in pin)]
    if r.random() < 0.2:
        plan.sliders.append((known, b) if r.random() < 0.5 else (b, known))
    elif multiple and on_it and r.random() < 0.5:
        r.choice(on_it).append(b)
    else:
        plan.pins.append([known, b])


@pytest.fixture
def plan() -> type[Plan]:
    return Plan


@pytest.fixture
def random_plans() -> Callable[..., tuple[Plan, set[frozenset[int]]]]:
    return random_plan


@pytest.fixture
def bars() -> Callable[..., list]:
    """Links by their letters, at random places: ``bars(crank="AB", rod="BC")``."""

    def made(**letters: str) -> list:
        r = random.Random(11)
        return [link(n, **{k: complex(r.random(), r.random()) for k in text}) for n, text in letters.items()]

    return made


def plans_of_reference() -> list:
    entries = json.loads((REFERENCE / "decomposition.json").read_text())
    simple = [e for e in entries if not {"gears", "slots"} & set(e["dimensions"])]
    return [pytest.param(e, id=e["id"]) for e in simple]


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "decomposition_case" in metafunc.fixturenames:
        metafunc.parametrize("decomposition_case", plans_of_reference())


@pytest.fixture
def reference_plan(decomposition_case: dict) -> Plan:
    d = decomposition_case["dimensions"]
    return Plan(d["n"], d["pins"], d.get("sliders", []), d["drivers"])


@pytest.fixture(scope="session")
def counts() -> dict:
    return {entry["id"]: entry["expected"] for entry in json.loads((REFERENCE / "counts.json").read_text())}
