"""Transmission angles over all circuits, and advantages that pass through infinity, in plots and reports."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.view.plot.circuit_plot import segment_positions, segment_quantity
from compoundkin.view.report import report
from tests import catalog


def test_transmission_angles_over_circuits_end_at_zero() -> None:
    """Both branches of a triple rocker, from limit to limit of its driver; a ratio of rates is not shown so."""
    found = ck.circuits(catalog.mechanism("triple-rocker"))
    positions = segment_positions(found)
    (angle,) = segment_quantity(positions, "rocker.transmission_angle")
    assert angle.unit == "deg"
    assert np.abs(angle.values[:, [0, -1]]).max() < 1e-4
    assert np.nanmax(angle.values) == pytest.approx(90.0, abs=0.5)
    with pytest.raises(ck.errors.InvalidInput, match="circuits show positions, not rates"):
        segment_quantity(positions, "rocker.advantage")


def test_an_advantage_is_not_drawn_through_its_poles() -> None:
    """A crank-rocker has two toggle positions, and a double crank none: its extremes are marked."""
    rocker, crank = (ck.plot(catalog.motion(name), f"{link}.advantage").figure.axes[0]
                     for name, link in (("crank-rocker", "rocker"), ("double-crank", "follower")))  # fmt: skip
    cuts = np.isnan(rocker.lines[0].get_ydata()).sum()
    assert cuts == 2
    assert not any("−" in text.get_text() for text in rocker.texts if "cut off" not in text.get_text())
    assert not np.isnan(crank.lines[0].get_ydata()).any()


def test_poles_are_gaps_in_polar_plots_and_along_the_axis_too() -> None:
    motion = catalog.motion("crank-rocker")
    polar = ck.plots.polar(motion, "rocker.advantage").figure.axes[0]
    assert np.isnan(polar.lines[0].get_ydata()).sum() == 2
    assert polar.get_xlabel() == "rocker.advantage over crank [deg]"
    across = ck.plot(motion, "rocker.transmission_angle", against="rocker.advantage").figure.axes[0]
    assert np.isnan(across.lines[0].get_xdata()).sum() == 2


def test_a_published_advantage_of_a_driver_at_rest_says_which_it_is() -> None:
    crank_rocker = catalog.mechanism("crank-rocker")
    published = ck.expect("rocker.advantage", 1.0, 1.0, **{"crank.speed": 0.0})
    rests = ck.Mechanism("Rests", *crank_rocker.items, published)
    where = rf"expected\[{len(rests.expectations) - 1}\].quantity: no driver moves"
    with pytest.raises(ck.errors.InvalidInput, match=where):
        report(ck.solve(rests))


def test_a_report_says_infinite_where_it_is() -> None:
    """At both dead points of a slider-crank, in the table and among the extremes; not a dash, as of no pose."""
    text = report(catalog.motion("slider-crank"), ["stroke.advantage"]).text()
    assert text.count(" inf") >= 3
    assert "always" not in text.split("Extremes")[1].split("Checks")[0]
