"""Every shipped mechanism over its whole default range: centres, velocities, and what a wrong velocity looks like."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.analysis.centres import Centres, Status, instant_centres
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series
from compoundkin.model.geometry import FRAME
from tests import catalog
from tests.analysis.centres.twists import disagreement, loop_twists, solved_twists

EXACT = 1e-9
# Flat poses of these, where a driver's position has two ways to go on: the loop equations have two solutions.
CHANGE_POINTS = {"parallelogram", "parallelogram-third-crank", "antiparallelogram"}
each = catalog.each(sorted({*catalog.CHOSEN, *CHANGE_POINTS}))


@cache
def centres_of(name: str) -> Centres:
    with warnings.catch_warnings(action="ignore", category=ck.errors.UnassembledPoses):
        return instant_centres(catalog.motion(name))


@each
def test_velocities_and_centres_agree_with_both_other_routes(name: str) -> None:
    centres = centres_of(name)
    check = centres.velocity_check()
    assert check.worst < EXACT
    assembled = float(np.mean(centres.motion.regular))
    assert check.compared > (0.95 if name in CHANGE_POINTS else 0.98) * assembled
    for twists in (solved_twists(centres.motion, centres.scale), loop_twists(centres)[0]):
        worst = {couple: np.fmax.reduce(v, axis=None) for couple, v in disagreement(centres, twists).items()}
        assert max(worst.values()) < EXACT, max(worst, key=lambda couple: worst[couple])
    for triple, volume in centres.collinearity().items():
        assert np.fmax.reduce(volume, axis=None) < EXACT, triple


@each
def test_every_centre_is_found_or_said_why_not(name: str) -> None:
    """One may be missing where the two links do not move relative to each other, such as pistons at dead centre."""
    centres = centres_of(name)
    assembled = centres.motion.assembled
    twists, links = solved_twists(centres.motion, centres.scale), list(centres.motion.mechanism.links)
    fastest = np.abs(twists).max()
    for couple in centres:
        centre = centres[couple]
        assert ((centre.status == Status.NOT_ASSEMBLED) == ~assembled).all()
        assert (np.isfinite(centre.homogeneous).all(axis=-1) == centre.found).all()
        if name not in CHANGE_POINTS:
            one, other = (twists[links.index(link)] for link in couple)
            resting = np.abs(other - one).max(axis=0).reshape(assembled.shape) < EXACT * fastest
            assert (centre.found | ~assembled | resting).all()


@pytest.mark.parametrize("name", sorted(CHANGE_POINTS))
def test_change_points_are_singular_for_geometry_and_loop_equations_alike(name: str) -> None:
    centres = centres_of(name)
    gap = loop_twists(centres)[1]
    singular = centres["frame", "coupler"].status == Status.SINGULAR
    assert singular.sum() == 3
    assert (singular == (gap < EXACT)).all()


def mutated(motion: ck.results.Motion, link: str, change: Callable[[complex], complex]) -> ck.results.Motion:
    pose = motion.poses[link]

    def wrong(series: Series) -> Series:
        return Series((series.c[0], change(series.c[1]), *series.c[2:])) if len(series.c) > 1 else series

    return replace(motion, poses={**motion.poses, link: Pose(wrong(pose.z), wrong(pose.u))})


@each
def test_a_wrong_velocity_of_any_link_is_caught(name: str) -> None:
    """Its sign, or 0.1 per cent of it."""
    centres = centres_of(name)
    for link in centres.motion.mechanism.links:
        for change in (lambda v: -v, lambda v: 1.001 * v) if link != FRAME else ():
            assert centres.velocity_check(mutated(centres.motion, link, change)).worst > 1e3 * EXACT, link
