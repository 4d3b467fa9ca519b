"""Freudenstein's equation: constants as published, and zero at every solved pose."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.analysis.equations.freudenstein import FourBarConstants, SliderCrankConstants
from compoundkin.analysis.equations.reduced_system import pose_values
from compoundkin.files import load
from tests import catalog


def test_constants_of_norton() -> None:
    """R. L. Norton, Design of Machinery, example 4-1: d = 100, a = 40, b = 120, c = 80."""
    (found,) = ck.equations.freudenstein(load("four-bar-norton"))
    assert {name: round(float(value), 4) for name, value in found.constants.items()} == {
        "K1": 2.5, "K2": 1.25, "K3": 0.5625, "K4": 0.8333, "K5": -2.0417,
    }  # fmt: skip
    assert found.text == (
        "K1 cos(rocker) - K2 cos(crank) + K3 = cos(crank - rocker)",
        "K1 cos(coupler) + K4 cos(crank) + K5 = cos(crank - coupler)",
    )
    assert found.latex[0] == (
        r"K_{1}\,\cos \theta_{\text{rocker}} - K_{2}\,\cos \theta_{\text{crank}} + K_{3} = "
        r"\cos(\theta_{\text{crank}} - \theta_{\text{rocker}})"
    )


@catalog.each(sorted({*catalog.CHOSEN, "four-bar-norton", "slider-crank-offset", "watt-ii", "v-engine"}))
def test_every_solved_pose_satisfies_them(name: str) -> None:
    motion = catalog.motion(name)
    values = pose_values(motion)
    for found in ck.equations.freudenstein(motion.structure):
        scale = 1.0 if isinstance(found, FourBarConstants) else motion.size**2
        constants = max(1.0, *(abs(float(v)) / scale for v in found.constants.values()))
        for rest in found.at(values):
            assert np.max(np.abs(np.broadcast_to(rest, motion.shape)[motion.assembled])) < 1e-10 * constants * scale


def test_a_slider_crank_with_an_offset() -> None:
    """R. S. Hartenberg and J. Denavit, Kinematic Synthesis of Linkages, chapter 10: 2a, 2ae, a^2 - b^2 + e^2."""
    for turn in (0.0, 2.0):  # the same, drawn the other way round
        guide = ck.slide("block", on="frame", at="B", through="O", angle=turn, offset=0.5)
        parts = ck.link("frame", O=0), ck.link("crank", O=0, A=2), ck.link("rod", A=0, B=5), ck.link("block", B=0)
        (found,) = ck.equations.freudenstein(ck.Mechanism("m", *parts, guide, ck.drive("crank")))
        assert isinstance(found, SliderCrankConstants)
        assert found.lengths["e"] == pytest.approx(0.5)
        assert [float(v) for v in found.constants.values()] == pytest.approx([4.0, 2.0, 4.0 - 25.0 + 0.25])


def test_loops_without_one_have_none() -> None:
    assert ck.equations.freudenstein(load("oscillating-guide")) == ()
    assert ck.equations.freudenstein(load("planetary-train")) == ()
