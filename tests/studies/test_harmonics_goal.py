"""The goal of harmonics: against `ck.figures.harmonics`, and counterweights of a four-bar by Berkof and Lowen."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.errors import InvalidInput

TURN = {"crank": np.linspace(0.0, 2 * np.pi, 73)}
FREE = {"crank.at.x": (-120.0, 60.0), "rocker.at.x": (-120.0, 60.0)}


def four_bar(**at: float) -> ck.Mechanism:
    return ck.Mechanism(
        "Four-bar",
        ck.link("frame", O=(0, 0), C=(140, 0)),
        ck.link("crank", O=(0, 0), A=(50, 0)),
        ck.link("coupler", A=(0, 0), B=(150, 0)),
        ck.link("rocker", C=(0, 0), B=(120, 0)),
        ck.drive("crank"),
        ck.mass("crank", 1.0, at=(at.get("crank", 20.0), 0), inertia=2000),
        ck.mass("coupler", 0.4, at=(69, 0), inertia=1000),
        ck.mass("rocker", 1.5, at=(at.get("rocker", 50.0), 0), inertia=4000),
        units={"length": "mm", "mass": "kg", "force": "N"},
    )


def test_without_all_harmonics_of_the_shaking_force_it_is_balanced() -> None:
    """Of a coupler in line m r of the crank is -m2 a (1 - r2 / b), of the rocker -m2 c r2 / b."""
    goal = ck.goals.without_harmonics("frame.shaking_force", [1, 2, 3])
    found = ck.optimise(four_bar(), FREE, goal, values=TURN, speed=100.0, starts=2).dimensions
    assert found["crank.at.x"] == pytest.approx(-0.4 * 50.0 * (1.0 - 69.0 / 150.0), abs=1e-4)
    assert found["rocker.at.x"] == pytest.approx(-0.4 * 120.0 * 69.0 / 150.0 / 1.5, abs=1e-4)


def test_the_shaking_moment_has_least_of_its_first_two_harmonics() -> None:
    goal = ck.goals.without_harmonics("frame.shaking_moment", [1, 2])
    found = ck.optimise(four_bar(), FREE, goal, values=TURN, speed=100.0, starts=2).dimensions

    def amplitudes(crank: float, rocker: float) -> float:
        motion = ck.solve(four_bar(crank=crank, rocker=rocker), TURN, speed=100.0)
        of = ck.figures.harmonics(ck.force_analysis(motion), "frame.shaking_moment", orders=2)
        return float(np.sum(of.amplitude[0][1:] ** 2))

    best = found["crank.at.x"], found["rocker.at.x"]
    least = amplitudes(*best)
    assert least < 0.9 * amplitudes(20.0, 50.0)
    for change in ((0.5, 0.0), (-0.5, 0.0), (0.0, 0.5), (0.0, -0.5)):
        moved = [min(60.0, max(-120.0, one + by)) for one, by in zip(best, change, strict=True)]
        assert amplitudes(*moved) >= least * (1.0 - 1e-9)


@pytest.mark.parametrize(
    ("output", "orders", "values", "message"),
    [
        ("crank.effort", [0], TURN, "no orders"),
        ("crank.effort", [], TURN, "no orders"),
        ("crank.effort", [40], TURN, "order 40"),
        ("crank.effort.greatest", [1], TURN, "figure"),
        ("crank.effort", [1], {"crank": [0.0, 1.0, 2.0, 3.0]}, "closed cycle"),
        ("crank.effort", [1], {"crank": [0.0, 1.0, 2.0, 3.0, 2 * np.pi]}, "equally spaced"),
    ],
)
def test_bad_input_is_named(output: str, orders: list[int], values: Any, message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        ck.optimise(four_bar(), FREE, ck.goals.without_harmonics(output, orders), values=values, speed=1.0, starts=1)
