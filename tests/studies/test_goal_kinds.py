"""Each kind of goal and constraint: its slopes are those of differences, its numbers those of `solve`."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.arrays import Number
from compoundkin.base.errors import suppress_pose_warnings
from compoundkin.studies.goals.constraints import assembles, at_least, at_most, box, distance, full_turn, transmits
from compoundkin.studies.goals.design_trial import DesignTrial
from compoundkin.studies.goals.driver_schedule import DriverSchedule
from compoundkin.studies.goals.function_goal import function
from compoundkin.studies.goals.goal import DesignConstraint, Goal
from compoundkin.studies.goals.path_goals import poses, trace
from compoundkin.studies.goals.range_goals import dwell, even, straight_line
from compoundkin.studies.goals.value_goals import target
from compoundkin.studies.responses import studied_path
from tests.studies.test_goals import FREE, TURN, hold_slopes, numbers, trial_of

SIX_BAR = ck.compile(ck.load("six-bar"), "G.position", free=list(FREE)).mechanism(FREE)
MOTION = ck.solve(SIX_BAR, TURN)
G = np.asarray(MOTION.points["G"].position)
PLATE = np.stack([G.real, G.imag, MOTION.links["plate"].angle + 0.1], axis=1)
PLACES = np.array([20 + 5j, 22 + 3j, 21 + 1j])
OWN = np.array([0.4, 1.9, -0.3])

ASKED: dict[str, tuple[Goal | DesignConstraint, Number | None]] = {
    "trace": (trace("G", PLACES), OWN),
    "trace, any order": (trace("G", PLACES, in_order=False), OWN),
    "poses": (poses("plate", "G", PLATE), None),
    "poses without timing": (poses("plate", "G", PLATE[[1, 4, 8]], arm=3.0, timed=False), OWN),
    "function": (function("bar.angle", lambda crank: 0.3 * np.sin(crank)), None),
    "function at pairs": (function("bar.angle", [(0.3, 0.2), (0.9, 0.1), (1.5, 0.4)], free_zero=True), None),
    "dwell": (dwell("bar.angle", (0.4, 1.1)), None),
    "dwell of a point": (dwell("G", (0.4, 1.1)), None),
    "even": (even("G.x"), None),
    "straight line": (straight_line("G", (0.4, 1.1)), None),
    "straight line with an angle": (straight_line("G", angle=0.5), None),
    "target of a figure": (target("G.x.stroke", 12.0), None),
    "target of a course": (target("G.position", PLACES[0]), None),
    "at least": (at_least("bar.angle", -1.0), None),
    "at most": (at_most("G.y.stroke", 9.0), None),
    "transmission angle": (transmits("bar", 0.5), None),
    "box": (box("G", x=(10, 30), y=(-20.0, 20.0)), None),
    "distance": (distance("C", "G", at_least=1.0, at_most=50.0), None),
    "length": (distance("A", "C", at_most=50.0), None),
    "assembles": (assembles(), None),
    "full turn": (full_turn(), None),
}


@pytest.mark.parametrize("name", ASKED)
def test_slopes_are_those_of_differences(name: str) -> None:
    hold_slopes(*ASKED[name])


def of_one(asked: Goal | DesignConstraint, unknowns: Number = OWN[:0]) -> Number:
    """The numbers of the six-bar as it stands."""
    dimensions = {name: np.array([value]) for name, value in FREE.items()}
    found = numbers(asked, trial_of(asked, dimensions, np.reshape(unknowns, (1, -1))))
    assert found.shape[0] == 1
    return np.asarray(found[0])


def test_numbers_are_those_of_solve() -> None:
    turns = ck.solve(SIX_BAR, np.linspace(0.4, 1.1, 25))
    angles, places = turns.links["bar"].angle, turns.points["G"].position
    assert of_one(dwell("bar.angle", (0.4, 1.1))) == pytest.approx(angles - angles.mean(), abs=1e-12)
    assert of_one(even("G.x")) == pytest.approx(G.real - G.real.mean(), abs=1e-10)
    # the line that fits best, by the singular values of the places
    about = places - places.mean()
    least = np.linalg.svd(np.stack([about.real, about.imag]), compute_uv=False)[1]
    assert np.linalg.norm(of_one(straight_line("G", (0.4, 1.1)))) == pytest.approx(least, rel=1e-8)
    across = (about * np.exp(-0.5j)).imag
    assert of_one(straight_line("G", (0.4, 1.1), angle=0.5)) == pytest.approx(across, abs=1e-10)
    pairs = [(0.3, 0.2), (0.9, 0.1)]
    expected = ck.solve(SIX_BAR, [0.3, 0.9]).links["bar"].angle - [0.2, 0.1]
    assert of_one(function("bar.angle", pairs)) == pytest.approx(expected, abs=1e-12)
    assert of_one(function("bar.angle", pairs, free_zero=True)) == pytest.approx(expected - expected.mean(), abs=1e-12)
    shifted = [(one, value + 2 * np.pi) for one, value in pairs]
    assert of_one(function("bar.angle", shifted)) == pytest.approx(expected, abs=1e-12)
    off = of_one(poses("plate", "G", PLATE, arm=3.0))
    assert off == pytest.approx(np.repeat([0.0, 0.0, -0.3], len(TURN)), abs=1e-10)
    assert of_one(target("G.x.stroke", 12.0)) == pytest.approx(
        float(ck.quantity(MOTION, "G.x.stroke").values[0]) - 12.0, rel=0.01
    )


def test_margins_are_those_of_solve() -> None:
    angle = ck.quantity(MOTION, "bar.transmission_angle").values
    assert of_one(transmits("bar", 0.2)) == pytest.approx([angle.min() - 0.2], abs=0.01)
    assert of_one(box("G", x=(0, 30))) == pytest.approx([G.real.min(), 30 - G.real.max()], abs=0.1)
    between = np.asarray(abs(G - MOTION.points["B"].position))
    margins = of_one(distance("B", "G", at_least=1.0, at_most=50.0))
    assert margins == pytest.approx([between.min() - 1.0, 50.0 - between.max()], abs=1e-9)
    indices = [ck.quantity(MOTION, f"{link}.transmission_index").values.min() for link in ("plate", "bar")]
    assert np.sort(of_one(assembles(0.0))) == pytest.approx(np.sort(indices), abs=0.01)


def test_a_full_turn_of_four_bars_is_grashofs_condition() -> None:
    lengths = np.random.default_rng(5).uniform(1.0, 10.0, (400, 4))
    frame, crank, coupler, rocker = lengths.T
    plan = ck.Mechanism(
        "Four-bar",
        ck.link("frame", A=0, D=6),
        ck.link("crank", A=0, B=2),
        ck.link("coupler", B=0, C=5),
        ck.link("rocker", D=0, C=5),
        ck.drive("crank"),
    )
    asked = full_turn(margin=0.0)
    names = ["frame.D.x", "crank.B.x", "coupler.C.x", "rocker.C.x"]
    studied, responses = studied_path(plan, names, asked.outputs(ck.solve(plan, TURN)), TURN)
    trial = DesignTrial(
        studied.designs(dict(zip(names, (frame, crank, coupler, rocker), strict=True))),
        {one.name: one for one in responses},
        np.empty((400, 0)),
    )
    ordered = np.sort(lengths)
    is_grashof = ordered[:, 0] + ordered[:, 3] <= ordered[:, 1] + ordered[:, 2]
    turns = is_grashof & ((crank == ordered[:, 0]) | (frame == ordered[:, 0]))
    assert 20 < turns.sum() < 380
    with suppress_pose_warnings():
        margins = asked.margins(trial)
    assert (np.isfinite(margins).all(axis=1) == turns).all()


@pytest.mark.parametrize("turns", [True, False])
@pytest.mark.parametrize("way", [1, -1])
def test_places_keep_their_order(turns: bool, way: int) -> None:
    timing = DriverSchedule("crank", 5, 0.0, 2 * np.pi if turns else 3.0, turns, True)
    values = np.sort(np.random.default_rng(1).uniform(0.1, 2.9, (6, 5)), axis=1)[:, ::way]
    found = timing.values(timing.nearest((values[:, :, None] - timing.sampled_values) ** 2))
    step = timing.sampled_values[1] - timing.sampled_values[0]
    moved = found - 2 * np.pi * turns * np.round((found - values)[:, :1] / (2 * np.pi))
    assert abs(moved - values).max() < 2.0 * step  # each is near, or next to another that is
    assert (way * np.diff(found) > 0).all()
    anywhere = timing.values(np.random.default_rng(2).normal(0, 3, (100, 5)))
    steps = np.diff(anywhere)
    assert ((steps > 0).all(axis=1) | (steps < 0).all(axis=1)).all()


def test_what_is_no_goal_is_told() -> None:
    wrong: list[tuple[Any, str]] = [
        (lambda: function("bar.angle", [1, 2, 3]), "neither pairs nor a function"),
        (lambda: function("bar.angle", lambda crank: "x").outputs(MOTION), "not return a number for each value"),
        (lambda: function("bar.angle", lambda crank: np.log(-1.0 - crank**2)).outputs(MOTION), "not finite"),
        (lambda: function("G", [(0, 1)]).outputs(MOTION), "it is a vector"),
        (lambda: dwell("bar.angle", None), "not two different values"),
        (lambda: dwell("bar.angle", (1.0, 1.0)), "not two different values"),
        (lambda: even("bar.angle.stroke").outputs(MOTION), "always even"),
        (lambda: target("G.x", [1.0, 2.0]).outputs(MOTION), "2 values, and 12 poses"),
        (lambda: target("G.x.stroke", "far"), "is not a value"),
        (lambda: trace("G", [1, 2], driver="rank").outputs(MOTION), "no driver 'rank'"),
        (lambda: trace("G", [1, 2]).outputs(ck.solve(SIX_BAR, 0.5)), "stands still"),
        (lambda: poses("plate", "G", [(1, 2)]), "these are not poses"),
        (lambda: poses("plate", "G", [(1, 2, 3)], arm=0.0), "the arm above 0"),
        (lambda: poses("plate", "G", [(1, 2, 3)]).outputs(MOTION), "1 places, and 12 poses"),
        (lambda: straight_line("G", angle=np.nan), "not finite"),
        (lambda: at_least("G.x", np.inf), "is not a valid bound"),
        (lambda: at_least("G.velocity", 1.0).outputs(MOTION), "a vector has no least value"),
        (lambda: box("G", x=(2, 1)), "ends of the box"),
        (lambda: box("G"), "ends of the box"),
        (lambda: distance("A", "B"), "leave no distance"),
        (lambda: distance("A", "B", at_least=3, at_most=2), "leave no distance"),
        (lambda: assembles(1.5), "not a transmission index"),
        (lambda: full_turn().outputs(ck.solve(ck.catalog.load_named("slider-crank"))), ""),
    ]
    for call, said in wrong[:-1]:
        with np.errstate(all="ignore"), pytest.raises(ck.errors.CompoundkinError, match=said):
            call()
