"""Responses of many designs: what a study finds equals what `solve` finds of each design."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.studies.responses import studied_path
from compoundkin.studies.samples import sample_of
from compoundkin.studies.variations import variation_of

RANGES = {"crank.D.x": variation_of("crank.D.x", (13.0, 14.0)), "plate.C.x": variation_of("plate.C.x", (12.0, 12.5))}


@pytest.mark.parametrize("name", ["G.position", "bar.angle", "G.velocity.length"])
def test_courses_are_those_of_solve(name: str) -> None:
    path, (response,) = studied_path(ck.catalog.load_named("six-bar"), list(RANGES), [name], speed=3.0)
    designs = path.designs(sample_of("sobol", 16, 1).designs(RANGES, range(4, 12)))
    expected = ck.quantity(designs.motion, name).values
    assert np.abs(response.values(designs) - expected).max() < 1e-11 * np.abs(expected).max()
