"""Groups of the reference cases, and groups with slides, as assemblies."""

from __future__ import annotations

from typing import Any

import networkx as nx
import numpy as np

from compoundkin.kinematics.assembly import Connection, GroupGeometry
from tests.kinematics.assembly.trusses import random_truss, truss_assembly


def as_drawn(dimensions: dict[str, Any]) -> GroupGeometry:
    """A truss of the reference file: joint positions in one configuration."""
    joints = {tuple(map(int, key.split("-"))): complex(*at) for key, at in dimensions["joint_xy"].items()}
    return truss_assembly(joints, dimensions["ground"])


def three_legs(dimensions: dict[str, Any]) -> GroupGeometry:
    """A platform (body 3) on three legs, its first point the origin and its second on its x axis."""
    first, second, third = dimensions["B1B2"], dimensions["B2B3"], dimensions["B1B3"]
    x = (first**2 + third**2 - second**2) / (2 * first)
    corners = (0j, complex(first), complex(x, np.sqrt(third**2 - x**2)))
    connections = []
    for k, (at, leg, corner) in enumerate(zip(dimensions["A"], dimensions["legs"], corners, strict=True)):
        connections += [Connection((None, k), (complex(*at), 0j)), Connection((k, 3), (leg, corner))]
    return GroupGeometry(4, tuple(connections), 20.0)


def seven_bar(d: dict[str, Any]) -> GroupGeometry:
    """The chain of the loops in the reference file; body k has the angle t_(k + 1)."""
    a0, b0, c0, b2, b5 = (complex(*d[name]) for name in ("a0", "b0", "c0", "b2", "b5"))
    ground = (0j, a0, a0 + b0, a0 + b0 + c0)
    connections = (
        Connection((None, 0), (ground[0], 0j)),
        Connection((0, 1), (d["a1"], 0j)),
        Connection((None, 2), (ground[1], 0j)),
        Connection((2, 1), (d["a3"], d["a2"])),
        Connection((None, 3), (ground[2], 0j)),
        Connection((1, 4), (d["a2"] + b2, 0j)),
        Connection((3, 4), (d["a4"], d["a5"])),
        Connection((None, 5), (ground[3], 0j)),
        Connection((5, 4), (d["a6"], d["a5"] + b5)),
    )
    return GroupGeometry(6, connections)


def joined(a: int | None, b: int | None, kind: str, rng: np.random.Generator) -> Connection:
    """A pin or a slide of random dimensions, drawn where both bodies have the pose of the world."""
    at, along = complex(*rng.uniform(-4, 4, 2)), np.exp(1j * rng.uniform(-np.pi, np.pi))
    if kind == "R":
        return Connection((a, b), (at, at))
    return Connection((a, b), (at - along * rng.uniform(1, 3), at), (along, along))


def dyad(word: str, rng: np.random.Generator) -> GroupGeometry:
    """A dyad of the named pairs."""
    bodies = ((None, 0), (0, 1), (None, 1))
    return GroupGeometry(2, tuple(joined(*pair, kind, rng) for pair, kind in zip(bodies, word, strict=True)), 4.0)


def triad(word: str, rng: np.random.Generator) -> GroupGeometry:
    """Body 3 on three legs, each named by its pair with the world and its pair with body 3."""
    connections = []
    for k, leg in enumerate(word.split(",")):
        connections += [joined(None, k, leg[0], rng), joined(k, 3, leg[1], rng)]
    return GroupGeometry(4, tuple(connections), 4.0)


def with_slides(graph: nx.Graph, number: int, rng: np.random.Generator) -> GroupGeometry:
    """A truss in which so many pins are slides."""
    pinned = random_truss(graph, rng)
    slides = set(rng.choice(len(pinned.connections), number, replace=False))
    connections = tuple(joined(*c.bodies, "P", rng) if k in slides else c for k, c in enumerate(pinned.connections))
    return GroupGeometry(pinned.n, connections, 4.0)
