"""Outputs of a mechanism that is driven elsewhere: what only the old driver had is left out, and reports go on."""

from __future__ import annotations

import pytest

import compoundkin as ck
from compoundkin.files import load


@pytest.mark.parametrize(("name", "link"), [("engine-gas-pressure", "piston"), ("jaw-crusher-loaded", "jaw")])
@pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")
def test_report_of_a_loaded_mechanism_driven_elsewhere(name: str, link: str) -> None:
    loaded = load(name)
    (driver,) = loaded.drives
    driven = ck.with_driver(loaded, link)
    assert set(loaded.outputs) - set(driven.outputs) == {f"{driver.name}.effort"}
    # the piston stands at its dead point, where the pose is a single one and singular; the jaw cannot go all around
    assert "Forces" in ck.report(driven).text()
