"""Coulomb's law in all pairs at once: the sums of presses that bring about just the friction that they allow.

With m the presses' sums, s the senses of motion, the frictions are -s m, and m = h(m) are the sums under them. Where
the mechanism contracts (nearly always) there is one solution, found by Newton's steps, or the image h(m) where that is
better. Elsewhere the directions of all presses are tried; none and several solutions are told.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import TURN, Number
from compoundkin.base.linear import solve
from compoundkin.dynamics.friction.press_influence import PressInfluence

# Steps for all poses; a friction that presses its own pair with 0.9 of itself takes ten.
STEPS = 60
# Sums differ from their image by so many parts of the terms that cancel in them: rounding.
EXACT = 2e-15
# Two solutions are one where they differ by this part.
SAME = 1e-7
# So many presses have all directions tried; of more, so many patterns of them.
ALL_DIRECTIONS, PATTERNS = 6, 96
# So many turns of the forces in pins are tried as well. Of random systems of two or three pins that feed on each other
# strongly one of two solutions is then missed in one to four of a thousand; of one pin, or of contacts, in none.
TURNS = 16

ONE, NONE, SEVERAL, UNKNOWN = range(4)


class Frictions(NamedTuple):
    """The sizes of frictions with their signs, (frictions, poses).

    The state tells how many solutions there are at each pose.
    """

    sizes: Number
    state: Number


def frictions(influence: PressInfluence, signs: Number) -> Frictions:
    """Return the frictions against motion in some senses.

    `signs` (frictions, poses) are -1, 0 or 1.
    """
    finite = np.isfinite(influence.own).all(axis=0) & np.isfinite(influence.by).all(axis=(0, 1))
    state = np.where(finite & np.isfinite(signs).all(axis=0), ONE, UNKNOWN)
    sums = np.full(signs.shape, np.nan)
    known = np.flatnonzero(state == ONE)
    sure = np.zeros(len(state), dtype=bool)
    if len(known):
        part, senses = (influence, signs) if len(known) == len(state) else (influence.of(known), signs[:, known])
        sums[:, known], rested = _iterated(part, senses)
        sure[known] = part.contracts(senses) & rested
    doubtful = np.flatnonzero((state == ONE) & ~sure)
    if len(doubtful):
        sums[:, doubtful], state[doubtful] = _tried(influence.of(doubtful), signs[:, doubtful])
    sums[:, state != ONE] = np.nan
    return Frictions(-signs * sums, state)


def _iterated(influence: PressInfluence, signs: Number) -> tuple[Number, Number]:
    """Return the sums of presses from the frictionless ones, and where they came to rest."""
    sums = influence.sums(np.abs(influence.own))
    going: Number = np.arange(sums.shape[1])
    rested = np.zeros(sums.shape[1], dtype=bool)
    part, senses = influence, signs
    at: Number = np.array(sums)
    for _ in range(STEPS):
        image, newton = _steps(part, senses, at)
        gaps = _gap(part, senses, newton), _gap(part, senses, image)
        # what is not a number is never the better one
        better = gaps[0] <= gaps[1]
        at = np.where(better[None], newton, image)
        sums[:, going] = at
        done: Number = np.where(better, *gaps) <= EXACT * part.rounding(at)
        rested[going] = done
        if done.all():
            break
        if done.any():
            going, part, senses, at = going[~done], part.of(~done), senses[:, ~done], at[:, ~done]
    return sums, rested


def _steps(influence: PressInfluence, signs: Number, sums: Number) -> tuple[Number, Number]:
    """Return the image of some sums, and what Newton makes of them."""
    presses = influence.normal_forces(-signs * sums)
    sizes = np.abs(presses)
    image = influence.sums(sizes)
    matrix = _matrix(influence, signs, _directions(presses, sizes, 0.0))
    return image, sums - solve(matrix, (sums - image).T).T


def _directions(normal_forces: Number, sizes: Number, otherwise: Number) -> Number:
    """Return the directions of presses, something else where there are none."""
    return np.where(sizes > 0.0, normal_forces / np.where(sizes > 0.0, sizes, 1.0), otherwise)


def _matrix(influence: PressInfluence, signs: Number, toward: Number) -> Number:
    """Return the derivatives of sums minus their image, (poses, pairs, frictions). Presses keep their directions."""
    along = influence.sums((np.conjugate(toward) * influence.by).real) * signs[:, None]
    return np.eye(len(signs)) + along.transpose(2, 1, 0)


def _gap(influence: PressInfluence, signs: Number, sums: Number) -> Number:
    """Return how far sums are from their image."""
    found: Number = np.abs(sums - influence.sums(np.abs(influence.normal_forces(-signs * sums)))).max(axis=0)
    return found


def _tried(influence: PressInfluence, signs: Number) -> tuple[Number, Number]:
    """Return the only solution at each pose. The state tells where there is none, or more than one."""
    found = np.full(signs.shape, np.nan)
    count = np.zeros(signs.shape[1], dtype=int)
    for toward in _starts(influence, signs):
        sums, good = _from_directions(influence, signs, toward)
        far = np.abs(sums - found).max(axis=0) > SAME * np.abs(sums).max(axis=0)
        count = np.where(good & ((count == 0) | far), count + 1, count)
        found = np.where(good & (count == 1), sums, found)
    return found, np.select([count == 0, count == 1], [NONE, ONE], SEVERAL)


def _from_directions(influence: PressInfluence, signs: Number, toward: Number) -> tuple[Number, Number]:
    """Return the solution nearest to some directions of presses, and where it is one."""
    for _ in range(STEPS):
        right = influence.sums((np.conjugate(toward) * influence.own).real)
        sums = solve(_matrix(influence, signs, toward), right.T).T
        presses = influence.normal_forces(-signs * sums)
        before, toward = toward, _directions(presses, np.abs(presses), toward)
        if not np.any(np.abs(toward - before) > EXACT):
            break
    closed = _gap(influence, signs, sums) <= 10.0 * EXACT * influence.rounding(sums)
    return sums, closed & np.all(sums >= 0.0, axis=0)


def _starts(influence: PressInfluence, signs: Number) -> Iterator[Number]:
    """Yield directions of presses (presses, poses) to start from.

    They are those without friction and their opposites, in all combinations; and those of frictions alone that feed on
    themselves, which solutions of large forces have. Forces of pins may point anywhere: some are turned at random.
    """
    own = _directions(influence.own, np.abs(influence.own), 1.0)
    alone = influence.normal_forces(-signs * influence.feeding(signs).T) - influence.own
    fed = _directions(alone, np.abs(alone), 1.0)
    yield from (own * pattern[:, None] for pattern in _patterns(len(own)))
    yield from (fed, -fed)
    is_vector = np.any(own.imag != 0.0, axis=1) | np.any(influence.by.imag != 0.0, axis=(0, 2))
    if is_vector.any():
        turns = np.exp(1j * np.random.default_rng(2).uniform(0.0, TURN, (TURNS, len(own))) * is_vector)
        yield from (around * turn[:, None] for turn in turns for around in (own, fed))


def _patterns(normal_forces: int) -> Number:
    """Return patterns of signs, (patterns, presses)."""
    if normal_forces <= ALL_DIRECTIONS:
        return np.array(list(product((1.0, -1.0), repeat=normal_forces)))
    drawn = np.random.default_rng(1).choice([1.0, -1.0], (PATTERNS - 1, normal_forces))
    return np.concatenate([np.ones((1, normal_forces)), drawn])
