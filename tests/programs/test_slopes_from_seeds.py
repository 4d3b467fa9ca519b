"""Groups found from seeds, followers and those without a closed form: they change with dimensions as in `solve`."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from tests.catalog import mechanism

WORDS = ("position", "velocity", "acceleration")


@pytest.mark.parametrize(
    ("name", "point", "free"),
    [
        ("disc-cam-roller-program", "P", ("guide.offset", "follower/cam.radius")),
        ("oscillating-flat-follower", "P", ("frame.H.x",)),
        ("groove-cam-plate", "P", ("guide.angle",)),
        ("geared-coupler", "C", ("coupler.C.x",)),
        ("stephenson-ii", "E", ("frame.F.x",)),
    ],
)
def test_slopes_are_those_of_solve(name: str, point: str, free: tuple[str, ...]) -> None:
    own = mechanism(name)
    values = {drive.name: np.array([0.4, 1.1, 2.3]) for drive in own.drives}
    outputs = [f"{point}.{word}" for word in WORDS]
    path = ck.compile(own, outputs, free=free, values=values)
    found, step = path.derivatives(values, speed=2.0), 1e-4 * own.geometry.size
    for dimension in free:
        # four points about each: the error is of the fourth order of a small step
        places = float(path.programs.stated.own(path.programs.stated.known[dimension])) + step * np.array(
            [[-2.0], [-1.0], [1.0], [2.0]]
        )
        moved = path(values, {dimension: places}, speed=2.0)
        solved = ck.solve(path.mechanism({dimension: places}), values, speed=2.0)
        for output in outputs:
            wanted = ck.quantity(solved, output).values
            assert np.allclose(moved[output], wanted, rtol=0, atol=1e-11 * np.max(np.abs(wanted))), (dimension, output)
            slope = (wanted[0] - wanted[3] + 8.0 * (wanted[2] - wanted[1])) / (12.0 * step)
            size = max(np.max(np.abs(slope)), np.max(np.abs(wanted)) / own.geometry.size)
            assert np.allclose(found[output, dimension], slope, rtol=0, atol=1e-6 * size), (dimension, output)
