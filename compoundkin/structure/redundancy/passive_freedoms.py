"""Freedoms that move one link alone: what no driver can determine and no other link feels."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import degrees

import numpy as np

from compoundkin.structure.redundancy.constraint_equations import Array, Equations
from compoundkin.structure.redundancy.finite_motion import null_space

# A motion that turns less than this (radians, while it shifts by the size) is a translation; and the point about which
# a link turns is one of its own if it is not farther away than this part of the size.
STRAIGHT = 1e-6


@dataclass(frozen=True)
class PassiveFreedom:
    """A freedom of one link alone, in words: `motion` is "turn about C" or "slide along a line at 30 degrees"."""

    link: str
    motion: str

    def __str__(self) -> str:
        return f"{self.link} may {self.motion} without moving anything else"


def passive_motions(equations: Equations, state: Array) -> Iterator[PassiveFreedom]:
    """The freedoms of single links while the drivers stand still, of links on two pairs or more.

    A link on one pair only is no passive part: it is left free.
    """
    rows = np.vstack([equations.jacobian(state)[0], equations.driving(state)])
    counts = dict.fromkeys(equations.mechanism.links, 0)
    for pair in equations.pairs:
        for name in pair.members:
            counts[name] += 1
    for name, first in equations.column.items():
        if counts[name] > 1:
            for motion in null_space(rows[:, first : first + 3], equations.tolerance.rank).T:
                yield PassiveFreedom(name, _said(equations, state, name, motion))


def _said(equations: Equations, state: Array, name: str, motion: Array) -> str:
    x, y, turn = motion
    if abs(turn) < STRAIGHT:
        return f"slide along a line at {degrees(np.arctan2(y, x)) % 180.0:.4g} degrees"
    poses = equations.poses(state)
    pivot = complex(poses[name].z.c[0]) + 1j * complex(x, y) / turn * equations.size
    letters = equations.mechanism.links[name].points
    near = (k for k in letters if abs(equations.place(poses, name, k) - pivot) < STRAIGHT * equations.size)
    at = next(near, f"({pivot.real:.6g}, {pivot.imag:.6g})")
    return f"turn about {at}"
