"""Independently computed forces, mechanism by mechanism: `tests/reference/forces.json`."""

from __future__ import annotations

import pytest

from tests.dynamics.cases import CASES, misfits


@pytest.mark.parametrize("name", CASES)
def test_driver_pairs_and_frame(name: str) -> None:
    """Driver effort, force and moment of every pair, force and moment on the frame, to 1e-9."""
    assert misfits(CASES[name]()) == []
