"""Coulomb's law in all pairs at once: the sums of presses that bring about just the friction that they allow.

With m the presses' sums, s the senses of motion, the frictions are -s m, and m = h(m) are the sums under them. Where
the mechanism contracts (nearly always) there is one solution, found by Newton's steps, or the image h(m) where that is
better. Elsewhere the directions of all presses are tried; none and several solutions are told.
"""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
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
        # what is not a number is never the better one
        better = _off(part, senses, newton) <= _off(part, senses, image)
        at = np.where(better[None], newton, image)
        sums[:, going] = at
        done: Number = _off(part, senses, at) <= EXACT
        rested[going] = done
        if done.all():
            break
        if done.any():
            going, part, senses, at = going[~done], part.of(~done), senses[:, ~done], at[:, ~done]
    return sums, rested


def _steps(influence: PressInfluence, signs: Number, sums: Number) -> tuple[Number, Number]:
    """Return the image of some sums, and what Newton makes of them."""
    presses = influence.presses(-signs * sums)
    sizes = np.abs(presses)
    image = influence.sums(sizes)
    matrix = _matrix(influence, signs, _directions(presses, sizes, 0.0))
    return image, sums - solve(matrix, (sums - image).T).T


def _directions(presses: Number, sizes: Number, otherwise: Number) -> Number:
    """Return the directions of presses, something else where there are none."""
    return np.where(sizes > 0.0, presses / np.where(sizes > 0.0, sizes, 1.0), otherwise)


def _matrix(influence: PressInfluence, signs: Number, toward: Number) -> Number:
    """Return the derivatives of sums minus their image, (poses, pairs, frictions). Presses keep their directions."""
    along = influence.sums((np.conjugate(toward) * influence.by).real) * signs[:, None]
    return np.eye(len(signs)) + along.transpose(2, 1, 0)


def _off(influence: PressInfluence, signs: Number, sums: Number) -> Number:
    """Return how far sums are from their image, by the terms that cancel there."""
    image = influence.sums(np.abs(influence.presses(-signs * sums)))
    scale = influence.rounding(sums)
    return np.abs(sums - image).max(axis=0) / np.where(scale > 0.0, scale, 1.0)


def _tried(influence: PressInfluence, signs: Number) -> tuple[Number, Number]:
    """Return the only solution at each pose. The state tells where there is none, or more than one."""
    found = np.full(signs.shape, np.nan)
    count = np.zeros(signs.shape[1], dtype=int)
    for pattern in _patterns(len(influence.own)):
        sums, good = _from_directions(influence, signs, pattern[:, None])
        far = np.abs(sums - found).max(axis=0) > SAME * np.abs(sums).max(axis=0)
        count = np.where(good & ((count == 0) | far), count + 1, count)
        found = np.where(good & (count == 1), sums, found)
    return found, np.select([count == 0, count == 1], [NONE, ONE], SEVERAL)


def _from_directions(influence: PressInfluence, signs: Number, pattern: Number) -> tuple[Number, Number]:
    """Return the solution nearest to some directions of presses, and where it is one."""
    toward = _directions(influence.own, np.abs(influence.own), 1.0) * pattern
    for _ in range(STEPS):
        right = influence.sums((np.conjugate(toward) * influence.own).real)
        sums = solve(_matrix(influence, signs, toward), right.T).T
        presses = influence.presses(-signs * sums)
        before, toward = toward, _directions(presses, np.abs(presses), toward)
        if not np.any(np.abs(toward - before) > EXACT):
            break
    return sums, (_off(influence, signs, sums) <= 10.0 * EXACT) & np.all(sums >= 0.0, axis=0)


def _patterns(presses: int) -> Number:
    """Return patterns of directions, (patterns, presses): factors of those without friction."""
    if presses <= ALL_DIRECTIONS:
        return np.array(list(product((1.0, -1.0), repeat=presses)))
    drawn = np.random.default_rng(1).choice([1.0, -1.0], (PATTERNS - 1, presses))
    return np.concatenate([np.ones((1, presses)), drawn])
