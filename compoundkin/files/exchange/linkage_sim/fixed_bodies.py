"""Bodies that fixed joints make one link: where each lies in the axes of the first."""

from __future__ import annotations

import cmath
from collections.abc import Mapping
from dataclasses import dataclass

from compoundkin.files.exchange.linkage_sim.sim_records import GROUND, SimBody, SimFile, SimJoint
from compoundkin.files.exchange.problems import Problems

# Places nearer than this part of the size are one, angles nearer than this are the same.
ROUNDING = 1e-9


@dataclass(frozen=True)
class Placed:
    """Where a body lies in a link, told by its first body.

    `turn` and `place` are those of the body's axes.
    """

    host: str
    turn: float = 0.0
    place: complex = 0j

    def at(self, point: complex) -> complex:
        """Return a place of the body in the axes of the link."""
        return self.place + cmath.rect(1.0, self.turn) * point


def fixed_bodies(file: SimFile, problems: Problems) -> dict[str, Placed]:
    """Return where all bodies lie in their links.

    Fixed joints that contradict each other are noted.
    """
    fixed = [joint for joint in file.joints if joint.kind == "fixed"]
    near = ROUNDING * size_of(file)
    found: dict[str, Placed] = {}
    for first in sorted(file.bodies, key=lambda key: key != GROUND):
        if first in found:
            continue
        found[first], waiting = Placed(first), [first]
        while waiting:
            body = waiting.pop()
            for joint in (joint for joint in fixed if body in joint.bodies):
                other, placed = _beside(body, joint, found[body], file.bodies)
                if other not in found:
                    found[other] = placed
                    waiting.append(other)
                elif not _same(found[other], placed, near):
                    problems.add(joint.where, f"it fixes {other!r} where another fixed joint does not")
    return found


def size_of(file: SimFile) -> float:
    """Return the size of the largest body, 1 where all are points."""
    spans = []
    for body in file.bodies.values():
        places = [*body.points.values()] or [0j]
        across, upward = [place.real for place in places], [place.imag for place in places]
        spans += [max(across) - min(across), max(upward) - min(upward)]
    return max(spans, default=0.0) or 1.0


def _beside(body: str, joint: SimJoint, placed: Placed, bodies: Mapping[str, SimBody]) -> tuple[str, Placed]:
    """Return the other body of a fixed joint, and where it lies by it."""
    own = joint.bodies.index(body)
    other = joint.bodies[1 - own]
    here, there = (bodies[joint.bodies[k]].points[joint.points[k]] for k in (own, 1 - own))
    turn = placed.turn + (joint.turn if own == 0 else -joint.turn)
    return other, Placed(placed.host, turn, placed.at(here) - cmath.rect(1.0, turn) * there)


def _same(one: Placed, other: Placed, near: float) -> bool:
    turned = abs(cmath.exp(1j * (one.turn - other.turn)) - 1.0)
    return abs(one.place - other.place) <= near and turned <= ROUNDING
