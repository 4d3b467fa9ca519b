"""Polar diagrams of bearing loads against closed forms, and the mean line of an effort."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.errors import InvalidInput, UnknownName
from tests.view.loaded import MASS, REACH, SPEED, crank_forces

WEIGHT, PULL = MASS * 9.81, MASS * SPEED**2 * REACH / 1000.0


def test_the_pin_of_a_crank_is_loaded_on_one_side_of_the_crank() -> None:
    # in the frame a circle about the weight with the centrifugal force as radius, in the crank one about that force
    frame, own = ck.plots.bearing_loads(crank_forces(), "A").figure.axes
    assert own.get_title() == "in the axes of crank"
    for axes, middle, radius in ((frame, 1j * WEIGHT, PULL), (own, -PULL, WEIGHT)):
        x, y = axes.get_lines()[0].get_data()
        assert np.allclose(np.abs(np.asarray(x) + 1j * np.asarray(y) - middle), radius)


def test_several_pairs_are_in_one_panel_and_wrong_names_are_said() -> None:
    with pytest.raises(InvalidInput, match="no pair is named"):
        ck.plots.bearing_loads(crank_forces())
    with pytest.raises(UnknownName, match="known"):
        ck.plots.bearing_loads(crank_forces().motion, "Z")


def test_efforts_have_their_mean() -> None:
    (axes,) = ck.plot(crank_forces(), "crank.effort").figure.axes
    dashed = [line for line in axes.get_lines() if str(line.get_label()).startswith("mean")]
    assert [line.get_label() for line in dashed] == ["mean 0"]
