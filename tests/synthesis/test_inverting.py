"""Inversions keep all relative motions; other drivers pass through the same poses."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import InvalidInput, UnknownName
from compoundkin.files import load
from compoundkin.synthesis.inversion import with_driver, with_frame

# As drawn and dimensioned; modes by sign, by drawing; slides, gears, racks, cams; larger groups.
CASES = ["six-bar", "four-bar-norton", "jaw-crusher", "parallelogram", "stephenson-ii", "geared-five-bar",
         "rack-driven-double-slider", "disc-cam-roller-program", "elliptic-trammel", "hydraulic-crane"]  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_points_seen_from_the_new_frame_move_as_before(name):
    mechanism = load(name)
    motion = ck.solve(mechanism, order=0)
    spun = {spin.link for spin in ck.decompose(mechanism).passive}
    for link in [link for link in mechanism.links if link != "frame" and link not in spun]:
        inverted = ck.solve(with_frame(mechanism, link), order=0)
        assert "old frame" in inverted.links
        origin, back = motion.links[link].origin.position, np.exp(-1j * motion.links[link].angle)
        for letter in mechanism.carriers:
            expected = np.asarray(motion.points[letter].position - origin) * back
            gap = np.max(np.abs(np.asarray(inverted.points[letter].position) - expected))
            assert gap < 1e-6 * mechanism.geometry.size, (link, letter)


def test_inverting_back_is_the_same_motion():
    mechanism = load("four-bar-norton")
    twice = with_frame(
        with_frame(mechanism, "coupler" if "coupler" in mechanism.links else [*mechanism.links][2]), "old frame"
    )
    first, second = ck.solve(mechanism, order=0), ck.solve(twice, order=0)
    for letter in mechanism.carriers:
        assert np.allclose(first.points[letter].position, second.points[letter].position, atol=1e-8)


def test_driving_elsewhere_reaches_the_same_poses():
    mechanism = load("four-bar-norton")
    crank = mechanism.drives[0].link
    rocker = next(
        link for link in mechanism.pins[[*mechanism.links["frame"].points][1]] if link not in ("frame", crank)
    )
    motion = ck.solve(mechanism, order=0)
    k = int(0.382 * motion.assembled.size)
    around = slice(k - 2, k + 3)
    driven = with_driver(mechanism, rocker, values=motion.links[rocker].angle[around])
    found = ck.solve(driven, order=0)
    for letter in mechanism.carriers:
        expected = np.broadcast_to(motion.points[letter].position, motion.assembled.shape)[around]
        assert np.allclose(found.points[letter].position, expected, atol=1e-7)


def test_a_driven_slide_without_values_stays_where_it_is():
    driven = with_driver(load("slider-crank"), "piston")
    assert ck.solve(driven).assembled.all()
    assert np.size(driven.drives[0].values) == 1


def test_what_cannot_be_meant():
    with pytest.raises(UnknownName):
        with_frame(load("six-bar"), "crnk")
    with pytest.raises(InvalidInput, match="several drivers"):
        with_driver(load("five-bar"), [*load("five-bar").links][2])
    with pytest.raises(UnknownName, match="no such driver"):
        with_driver(load("six-bar"), "rocker", instead="piston")
    with pytest.raises(ck.errors.InvalidMechanism, match="no pair"):
        with_driver(load("six-bar"), "plate")
