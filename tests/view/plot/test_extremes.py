"""Highest and lowest values against calculus, numpy on fine motions, and what must not be taken for one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import compoundkin as ck
from compoundkin.files.shipped_mechanisms import load_named
from compoundkin.view.plot.marked_places import extremes

PHASES = st.floats(0.0, 2 * np.pi)


@given(PHASES, st.floats(0.1, 50.0), st.floats(-20.0, 20.0))
def test_of_a_wave_known_by_calculus(phase: float, height: float, middle: float) -> None:
    x = np.deg2rad(np.arange(0.0, 361.0, 5.0))
    highest, lowest = extremes(x, middle + height * np.cos(x - phase))
    assert highest.y == pytest.approx(middle + height, abs=1e-6 * height)
    assert lowest.y == pytest.approx(middle - height, abs=1e-6 * height)
    assert abs(np.exp(1j * highest.x) - np.exp(1j * phase)) < 1e-4
    assert abs(np.exp(1j * lowest.x) + np.exp(1j * phase)) < 1e-4


@given(PHASES, st.floats(0.3, 3.0))
def test_a_length_that_passes_zero_is_zero_there(place: float, speed: float) -> None:
    x = np.linspace(0.0, 7.0, 60)
    vector = (x - place) * speed * np.exp(0.1j * x)
    lowest = extremes(x, np.abs(vector), vector=vector)[-1]
    assert lowest.y < 1e-6
    assert lowest.x == pytest.approx(place, abs=1e-6)


@pytest.mark.parametrize("name", ["plate.angular_velocity", "bar.angle", "G.speed", "rocker.angular_acceleration"])
def test_against_numpy_on_a_fine_motion(name: str) -> None:
    six_bar = load_named("six-bar")
    coarse, fine = (ck.solve(six_bar, np.deg2rad(np.linspace(0, 360, n))) for n in (73, 36001))
    dense = ck.quantity(fine, name).values
    crank = fine.drives["crank"].value
    vector = np.asarray(coarse.points["G"].velocity) if name == "G.speed" else None
    found = extremes(coarse.drives["crank"].value, ck.quantity(coarse, name).values, vector=vector)
    span = np.ptp(dense)
    for one, k in zip(found, (np.argmax(dense), np.argmin(dense)), strict=True):
        assert one.y == pytest.approx(dense[k], abs=2e-4 * span)
        # its place, or another one of the same value
        assert np.interp(one.x, crank, dense) == pytest.approx(dense[k], abs=2e-4 * span)


def test_where_the_curve_comes_back_the_poses_are_the_parameter() -> None:
    s = np.linspace(0.0, 2 * np.pi, 73)
    highest, _ = extremes(np.cos(s), np.sin(s - 1.0))
    assert highest.x == pytest.approx(np.cos(1.0 + np.pi / 2), abs=1e-5)
    assert highest.y == pytest.approx(1.0, abs=1e-5)


def test_constants_and_rounding_have_none() -> None:
    x = np.arange(9.0)
    noise = 1e-14 * np.array([0, 1, -1, 2, 0, -2, 1, 0, 1])
    assert extremes(x, np.full(9, 3.0)) == ()
    assert extremes(x, 3.0 + noise) == ()
    assert extremes(x, noise, scale=1.0) == ()
    assert extremes(x, np.full(9, np.nan)) == ()


def test_a_rate_that_grows_towards_a_gap_has_no_highest_value() -> None:
    x = np.linspace(0.0, 0.99, 34)
    y = np.where(x > 0.9, np.nan, (x - 0.4) ** 2 / (0.95 - x))
    kinds = [one.is_highest for one in extremes(x, y, grows=True)]
    assert kinds == [False]
    assert [one.is_highest for one in extremes(x, y)] == [True, False]


def test_a_kink_of_the_data_adds_nothing_beyond_its_neighbours_slopes() -> None:
    x = np.arange(11.0)
    y = -np.abs(x - 5.0)
    highest = extremes(x, y)[0]
    assert (highest.x, highest.y) == (pytest.approx(5.0), pytest.approx(0.0, abs=0.3))
    plateau = np.clip(np.minimum(x, 10 - x), 0, 3)
    assert extremes(x, plateau)[0].y < 3.3
