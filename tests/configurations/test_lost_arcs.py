"""Configurations whose arcs are lost, as of wheels that roll through many turns."""

from __future__ import annotations

import numpy as np

from compoundkin.configurations.general_segments import _add


def test_a_configuration_whose_arcs_are_both_lost_is_no_segment() -> None:
    """It stopped `circuits` with an error about the shapes of arrays."""
    pieces: list = []
    _add(pieces, 0, np.array([[0.0, 0.0, 1.0, 0.5]]), [], False)
    assert pieces == []
    _add(pieces, 0, np.array([[0.0, 0.0, 1.0, 0.5], [0.0, 0.0, 1.1, 0.6]]), [], False)
    assert len(pieces) == 1
