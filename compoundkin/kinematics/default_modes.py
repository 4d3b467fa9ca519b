"""Default modes: what a group takes where neither a drawing nor a sign chooses, whatever order links are written in."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from compoundkin.base.series import Number, Series, as_series
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups import GroupSolver, equations_of
from compoundkin.structure.four_bars import FourBarLoops, Place

# Twice a triangle's area below this part of the product of two sides is none: both modes close polygons of one area.
TIE = 1e-12
# Where the modes tie they are told apart by the first derivative of the area that is not zero, up to this one.
HIGHEST = 3
# Configurations whose determinants differ by less than this part are mirror images but for rounding.
EVEN = 1e-9
# Stands for the largest of no heights at all.
TINY = 1e-300


def open_sign(
    loops: FourBarLoops, point: Callable[[str, str], Number], block: Block, ahead: Callable[[int], Block]
) -> Number:
    """Return the sign with which a dyad's four-bar loop has the larger area.

    The polygon of a loop A, B, C, D has the area of half the vector product of its diagonals, so that its two modes, C
    on one or on the other side of BD, differ in how A lies beside BD: C lies opposite. Where A is on BD, it is where A
    will be that counts. `point(link, letter)` is a point on its link, `block` the first pose, `ahead(order)` the same
    with derivatives as the drivers go on.
    """
    sides = _sides(loops, point, block)[0]
    if np.any(sides == 0.0):
        for rate in _sides(loops, point, ahead(HIGHEST))[1:]:
            sides = np.where(sides == 0.0, rate, sides)
        first, second = (_at(place, point, block).c[0] for place in (loops.first, loops.second))
        sides = np.where(sides == 0.0, _upward(second - first), sides)
    signs = np.broadcast_to(np.where(sides < 0.0, -1.0, 1.0), (block.shape[0], 1))
    return float(signs[0, 0]) if np.all(signs == signs[0, 0]) else signs


def regularity(solver: GroupSolver, state: Number, block: Block) -> Number:
    """Return how far configurations of a group are from being singular.

    They are closed in `block`, and compared with each other only. It is the determinant of the group's equations, of
    which another choice of unknowns changes a factor that all configurations share. Of two that are mirror images it is
    a little larger for the one that stands higher.
    """
    determinant = np.abs(np.linalg.det(equations_of(solver).matrix(state, block)))
    places = [block.world[link].z.c[0] for link in solver.group.links]
    middle = sum(places[1:], places[0]) / len(places)
    heights = middle.imag + EVEN * middle.real
    return determinant * (1.0 + EVEN * heights / np.nanmax(np.abs(heights), initial=TINY))


def _sides(loops: FourBarLoops, point: Callable[[str, str], Number], block: Block) -> list[Number]:
    """Return on which side of the line through the outer pins the opposite pin lies, with derivatives; 0 for none.

    Of several opposite pins it is the one that makes the largest area.
    """
    first, second = (_at(place, point, block) for place in (loops.first, loops.second))
    line = second - first
    found: list[Number] = [0.0] * (block.order + 1)
    most: Number = 0.0
    for place in loops.opposite:
        arm = _at(place, point, block) - first
        area = line.cross(arm)
        scale = TIE * np.abs(line.c[0]) * np.abs(arm.c[0])
        values = [np.where(np.abs(c) > scale, c, 0.0) for c in (*area.c, *[0.0] * (block.order - area.order))]
        largest = np.abs(area.c[0]) > most if len(loops.opposite) > 1 else True
        found = [np.where(largest, value, kept) for value, kept in zip(values, found, strict=True)]
        most = np.fmax(most, np.abs(area.c[0]))
    return found


def _at(place: Place, point: Callable[[str, str], Number], block: Block) -> Series:
    return as_series(block.world[place.link].at(point(place.link, place.letter)))


def _upward(line: Number) -> Number:
    """Return the sign with which the inner pin is the higher of the two, or else the one farther right."""
    return np.where(line.real != 0.0, -line.real, line.imag)
