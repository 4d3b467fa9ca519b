"""Default modes: what a group takes where neither a drawing nor a sign chooses, whatever order links are written in."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.series import Series, as_series
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.group_paths import Followed
from compoundkin.kinematics.groups import GroupSolver, equations_of
from compoundkin.kinematics.inputs import Inputs, fit
from compoundkin.structure.four_bars import FourBarLoops, Place

# Twice a triangle's area below this part of the product of two sides is none: both modes close polygons of one area.
TIE = 1e-12
# Where the modes tie they are told apart by the first derivative of the area that is not zero, up to this one.
HIGHEST = 3
# The modes of a dyad meet where its margin is below this: a change point, but for rounding.
FLAT = 1e-12
# Configurations whose determinants differ by less than this part are mirror images but for rounding.
EVEN = 1e-9
# Stands for the largest of no heights at all.
TINY = 1e-300


class AtFirstPose(Followed, Protocol):
    """What chooses the modes: the motion, its approach path, signs so far."""

    signs: dict[int, Number]


def default_sign(tracker: AtFirstPose, k: int, block: Block) -> Number:
    """Return the sign that a dyad has where nothing chooses. All before it is assembled in a block."""
    loops = tracker.solving_order.four_bars.get(k)
    return 1 if loops is None else _open_sign(tracker, k, loops, block)


def _open_sign(tracker: AtFirstPose, k: int, loops: FourBarLoops, block: Block) -> Number:
    """Return the sign with which a dyad's four-bar loop has the larger area.

    The polygon of a loop A, B, C, D has the area of half the vector product of its diagonals, so that its two modes, C
    on one or on the other side of BD, differ in how A lies beside BD: C lies opposite. Where A is on BD, it is where A
    will be that counts.
    """
    sides = _sides(tracker, loops, block)[0]
    # higher derivatives change nothing of the first, which most often tells
    for order in (1, HIGHEST):
        if np.any(sides == 0.0):
            for rate in _sides(tracker, loops, _ahead(tracker, k, order))[1:]:
                sides = np.where(sides == 0.0, rate, sides)
    if np.any(sides == 0.0):
        first, second = (_at(tracker, place, block).c[0] for place in (loops.first, loops.second))
        sides = np.where(sides == 0.0, _upward(second - first), sides)
    signs = np.where(sides < 0.0, -1.0, 1.0)
    alike = signs.size == 1 or np.all(signs == signs[0, 0])
    return float(signs.flat[0]) if alike else signs


def _ahead(tracker: AtFirstPose, k: int, order: int) -> Block:
    """Return what is solved before a group, with derivatives by increasing drivers. It is at the drawn pose.

    At a change point of the group a mode is that of the side to which the motion goes: its drivers may decrease.
    """
    first = tracker.approach_path.cut(slice(None), slice(0, 1))
    place = np.zeros((1, 1)), np.arange(tracker.given.designs)[:, None]
    single = tracker.approach_path.poses == 1
    sense = _senses(tracker.given, int(tracker.at)) if single else _senses(tracker.approach_path, 0)
    if any(np.any(one < 0.0) for one in sense.values()):
        tracker.signs[k] = 1
        margin = tracker.run(first, 0, *place, upto=k + 1, on_approach=True).margins[k]
        sense = {name: np.where(margin < FLAT, one, 1.0) for name, one in sense.items()}
    rates = {name: tracker.solving_order.unit(name) * sense[name] for name in first.drives}
    part = first.driven({name: (v[0], rates[name]) for name, v in first.drives.items()})
    return tracker.run(part, order, *place, upto=k, on_approach=True)


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


def _senses(way: Inputs, start: int) -> dict[str, Number]:
    """Return in which sense each driver goes on from a pose of a way, +1 or -1. It is +1 for one that rests."""
    found: dict[str, Number] = {}
    for name, (value, *_) in way.drives.items():
        steps = value[:, start + 1 :] - value[:, start : start + 1] if np.ndim(value) else np.zeros((1, 0))
        first = np.argmax(steps != 0.0, axis=1) if steps.shape[1] else 0
        falls = steps[np.arange(len(steps)), first] < 0.0 if steps.shape[1] else np.zeros(len(steps), dtype=bool)
        found[name] = np.where(falls, -1.0, 1.0)[:, None]
    return found


def _sides(tracker: AtFirstPose, loops: FourBarLoops, block: Block) -> list[Number]:
    """Return on which side of the line through the outer pins the opposite pin lies, with derivatives; 0 for none.

    Of several opposite pins it is the one that makes the largest area.
    """
    first, second = _at(tracker, loops.first, block), _at(tracker, loops.second, block)
    line = second - first
    found: list[Number] = [0.0] * (block.order + 1)
    most: Number = 0.0
    for place in loops.opposite:
        arm = _at(tracker, place, block) - first
        area = line.cross(arm)
        scale = TIE * np.abs(line.c[0]) * np.abs(arm.c[0])
        values = [np.where(np.abs(c) > scale, c, 0.0) for c in (*area.c, *[0.0] * (block.order - area.order))]
        if len(loops.opposite) == 1:
            return values
        largest = np.abs(area.c[0]) > most
        found = [np.where(largest, value, kept) for value, kept in zip(values, found, strict=True)]
        most = np.fmax(most, np.abs(area.c[0]))
    return found


def _at(tracker: AtFirstPose, place: Place, block: Block) -> Series:
    """Return where a point is, its place on its link being that of the motion's pose nearest to the drawn one."""
    mechanism = tracker.solving_order.structure.mechanism
    point = fit(tracker.given.shape)(mechanism.geometry.points[place.link][place.letter])
    varies = np.ndim(point) > 0 and point.shape[1] > 1
    return as_series(block.world[place.link].at(point[:, [int(tracker.at)]] if varies else point))


def _upward(line: Number) -> Number:
    """Return the sign with which the inner pin is the higher of the two, or else the one farther right."""
    return np.where(line.real != 0.0, -line.real, line.imag)
