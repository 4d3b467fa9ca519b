"""Better dimensions: searches end at designs that are known, or that a fine grid of designs confirms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.arrays import Number
from compoundkin.studies.goals.constraints import at_least
from compoundkin.studies.goals.path_goals import trace
from compoundkin.studies.optimisation.design_optimisation import stated_problem

NAMES = ["crank.B.x", "coupler.C.x", "rocker.C.x", "coupler.P.x", "coupler.P.y", "frame.D.x", "frame.D.y"]
OWN = np.array([2.0, 5.0, 4.0, 2.5, 1.5, 5.0, 0.0])
WANTED = np.array([2.2, 5.4, 4.3, 2.2, 1.9, 5.2, 0.1])
WITHIN = 0.3 * np.abs(OWN) + 0.2
FREE = {name: (low, high) for name, low, high in zip(NAMES, OWN - WITHIN, OWN + WITHIN, strict=True)}
TURN = ck.deg(np.arange(0, 360, 15))
LINKAGE = ck.Mechanism(
    "Crank-rocker",
    ck.link("frame", A=(0, 0), D=(5, 0)),
    ck.link("crank", A=(0, 0), B=(2, 0)),
    ck.link("coupler", B=(0, 0), C=(5, 0), P=(2.5, 1.5)),
    ck.link("rocker", D=(0, 0), C=(4, 0)),
    ck.drive("crank"),
)
TRANSMISSION = "coupler.transmission_angle.least"


def wanted_path(values: Number = TURN, modes: str | None = None) -> Number:
    """The path of a linkage that is known."""
    path = ck.compile(LINKAGE, "P.position", free=NAMES, modes=modes)
    return np.asarray(path(values, dict(zip(NAMES, WANTED, strict=True)))["P.position"])


def two_free(grid: int) -> tuple[dict[str, tuple[float, float]], Number, Number, Number]:
    """Two free dimensions, and a fine grid of them with what is asked there."""
    free = {"rocker.C.x": (3.0, 4.5), "coupler.C.x": (4.0, 6.0)}
    sizes = [np.linspace(*ends, grid) for ends in free.values()]
    rocker, coupler = (one.ravel()[:, None] for one in np.meshgrid(*sizes))
    path = ck.compile(LINKAGE, ["rocker.angle", "coupler.transmission_angle"], free=list(free))
    # extremes between the poses count too
    found = path(ck.deg(range(346)), {"rocker.C.x": rocker, "coupler.C.x": coupler})
    return free, rocker, np.ptp(found["rocker.angle"], axis=-1), found["coupler.transmission_angle"].min(axis=-1)


def test_a_path_that_a_linkage_has_is_found_from_every_start() -> None:
    found = ck.optimise(LINKAGE, FREE, ck.goals.path("P", wanted_path()), values=TURN, starts=32)
    assert found.value < 1e-20 < found.value_before
    assert found.agreed == found.starts == 32
    sizes = np.array([found.dimensions[name] for name in NAMES])
    assert np.abs(sizes - WANTED).max() < 1e-9
    assert found.check.passed
    assert [one.name for one in found.changes] == NAMES
    assert np.allclose([one.before for one in found.changes], OWN)
    assert found.binding == ()
    assert np.abs(ck.solve(found.mechanism, TURN).points["P"].position - wanted_path()).max() < 1e-9


def test_the_answer_is_the_same_for_a_seed_and_its_mechanism_keeps_the_mode() -> None:
    own, other = ck.compile(LINKAGE, "P").modes, "RRR(coupler)+"
    told: list[tuple[int, int]] = []
    goal = ck.goals.path("P", wanted_path(modes=other))
    first, again = (
        ck.optimise(
            LINKAGE, FREE, goal, values=TURN, modes=other, starts=4, seed=5, progress=lambda *done: told.append(done)
        )
        for _ in range(2)
    )
    assert first.value == again.value
    assert first.dimensions == again.dimensions
    assert told[0] == (0, 100)
    assert told[-1] == (100, 100)
    assert told == told[: len(told) // 2] * 2
    assert first.minima[0].modes == other != own
    assert (
        np.abs(ck.solve(first.mechanism, TURN).points["P"].position - first.motion.points["P"].position).max() < 1e-12
    )


def test_values_and_slopes_of_a_problem_are_those_of_differences() -> None:
    goals = 2.0 * ck.goals.path("P", wanted_path()) + ck.goals.least("rocker.angle.stroke")
    problem = stated_problem(LINKAGE, FREE, goals, (at_least(TRANSMISSION, 0.5),), values=TURN, modes=None)
    start, step = np.full(len(NAMES), 0.45), 1e-6
    rows = start + step * np.concatenate([np.eye(len(NAMES)), -np.eye(len(NAMES))])
    beside, there = problem.at(rows), problem.at(start)
    for numbers, slopes in ((beside.values[:, None], there.value_slopes), (beside.margins, there.margin_slopes[0])):
        expected = (numbers[: len(NAMES)] - numbers[len(NAMES) :]).T / (2 * step)
        assert np.abs(slopes - expected).max() < 1e-6 * np.abs(expected).max()
    assert not problem.is_squares


@pytest.mark.parametrize("method", [None, "differential_evolution", "trust-constr"])
def test_a_figure_with_a_constraint_is_that_of_a_fine_grid(method: str | None) -> None:
    free, _, strokes, angles = two_free(81)
    best = strokes[angles >= 0.6].max()
    found = ck.optimise(
        LINKAGE, free, ck.goals.greatest("rocker.angle.stroke"), [at_least(TRANSMISSION, 0.6)], values=TURN,
        starts=3 if method == "differential_evolution" else 1, method=method,
    )  # fmt: skip
    assert best - 1e-3 < -found.value < best * 1.01
    assert found.is_held
    assert found.constraints[0].binds
    assert TRANSMISSION in found.binding[-1]


def test_squares_with_a_constraint_are_those_of_a_fine_grid() -> None:
    free, *_ = two_free(2)
    size = np.linspace(0, 1, 201)
    rocker, coupler = (one.ravel()[:, None] for one in np.meshgrid(3 + 1.5 * size, 4 + 2 * size))
    path = ck.compile(LINKAGE, ["P.position", "coupler.transmission_angle"], free=list(free))
    grid = path(TURN, {"rocker.C.x": rocker, "coupler.C.x": coupler})
    errors = (np.abs(grid["P.position"] - wanted_path()) ** 2).sum(axis=-1)
    best = errors[grid["coupler.transmission_angle"].min(axis=-1) >= 0.75].min()
    goal, constraint = ck.goals.path("P", wanted_path()), at_least(TRANSMISSION, 0.75)
    found = ck.optimise(LINKAGE, free, goal, constraint, values=TURN, starts=8)
    assert best * 0.98 < found.value < best * (1 + 1e-9)
    assert found.constraints[0].binds
    assert found.constraints[0].is_held


def test_what_changes_nothing_is_kept_and_bounds_that_bind_are_told() -> None:
    free = {"rocker.C.x": (3.5, 4.5), "coupler.P": ((1, 1), (3, 3))}
    found = ck.optimise(LINKAGE, free, "rocker.angle.stroke", values=TURN, starts=4)
    assert found.dimensions["coupler.P"] == 2.5 + 1.5j
    assert [one.matters for one in found.changes] == [True, False, False]
    assert found.binding == ("rocker.C.x at its high bound",)
    assert found.method == "SLSQP"


def test_a_path_without_timing_is_found() -> None:
    uneven = np.cumsum(np.linspace(0.2, 0.7, 10))
    goal = trace("P", wanted_path(uneven))
    free = {name: FREE[name] for name in NAMES[:5]}
    at = dict(zip(NAMES[5:], WANTED[5:], strict=True))
    linkage = LINKAGE.replace(ck.link("frame", A=(0, 0), D=(at["frame.D.x"], at["frame.D.y"])))
    found = ck.optimise(linkage, free, goal, starts=16, modes="RRR(coupler)-")
    assert found.value < 1e-18
    assert np.abs(np.array([found.dimensions[name] for name in free]) - WANTED[:5]).max() < 1e-6


def test_constraints_that_hold_nowhere_are_told() -> None:
    free, *_ = two_free(2)
    with pytest.warns(ck.errors.UnmetConstraints, match=r"not coupler.transmission_angle.least"):
        found = ck.optimise(LINKAGE, free, "rocker.angle.stroke", at_least(TRANSMISSION, 1.5), values=TURN, starts=1)
    assert not found.is_held


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"free": {}}, "no dimension is free"),
    ({"free": {"crank.X": (1, 2)}}, "crank.X: it has no such dimension"),
    ({"free": {"crank.B.x": (2, 1)}}, "free.crank.B.x"),
    ({"free": {"crank.B.x": (2, 2)}}, "free.crank.B.x"),
    ({"free": {"crank.B.x": [1, 2, 3]}}, "single values"),
    ({"free": {"crank.B": (1, 3)}}, "it is a point"),
    ({"objective": 3}, "objective"),
    ({"objective": "P.position"}, "not a single one to minimise"),
    ({"objective": "X.position.length.least"}, "X"),
    ({"objective": ck.goals.path("P", [1, 2])}, "2 points, and 24 poses"),
    ({"subject_to": "crank"}, "subject_to"),
    ({"subject_to": [3]}, "subject_to"),
    ({"starts": 0}, "no number of starts"),
    ({"seed": -1}, "no seed"),
    ({"method": "newton"}, "there is no method 'newton'"),
    ({"method": "least_squares", "objective": "rocker.angle.stroke"}, "sums of squares"),
]


@pytest.mark.parametrize(("changed", "told"), WRONG, ids=lambda one: "")
def test_what_does_not_fit_is_told_before_anything_is_searched(changed: dict[str, Any], told: str) -> None:
    given = {"free": FREE, "objective": ck.goals.path("P", wanted_path()), "values": TURN, **changed}
    with pytest.raises(ck.errors.CompoundkinError, match=told):
        ck.optimise(LINKAGE, **given)


def test_no_design_that_is_assembled_is_told_with_the_group_that_fails() -> None:
    with pytest.raises(ck.errors.NotAssembled, match=r"none of 65537 designs .* fails at RRR\(coupler\) in 65537"):
        ck.optimise(LINKAGE, {"coupler.C.x": (0.1, 0.2)}, "rocker.angle.stroke", values=TURN[:3])


def test_wheels_that_do_not_fit_are_told_by_name() -> None:
    train = ck.load("planetary-train")
    with pytest.raises(ck.errors.NotAssembled, match=r"none of 65537 designs .* fails at planet in annulus in 65537"):
        ck.optimise(train, {"arm.P.x": (50.0, 51.0)}, ck.goals.least("sun.angle.stroke"), values=[0.0, 1.0])


def test_guides_whose_ends_are_too_near_are_told_by_name() -> None:
    """The piston goes from 2 to 4, and the guide from 2.4 to 3 at most."""
    press = ck.Mechanism(
        "Press", ck.link("frame", O=0), ck.link("crank", O=0, A=1), ck.link("rod", A=0, B=3), ck.link("piston", B=0),
        ck.slide("piston", on="frame", at="B", through="O", angle=0, name="guide", reach=(2.4, 3.0)), ck.drive("crank"),
    )  # fmt: skip
    with pytest.raises(ck.errors.NotAssembled, match=r"none of 65537 designs .* fails at guide in 65537"):
        ck.optimise(press, {"crank.A.x": (0.9, 1.1)}, "B.x.stroke", values=[0.0, np.pi])
