"""Goals and constraints: values, slopes against differences, and invalid arguments."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.arrays import Number
from compoundkin.base.errors import suppress_pose_warnings
from compoundkin.kinematics.motion import Motion
from compoundkin.studies.goals.clearance_constraint import clearance
from compoundkin.studies.goals.constraints import assembles, at_least, at_most, box, distance, full_turn, transmits
from compoundkin.studies.goals.design_trial import DesignTrial, real_parts
from compoundkin.studies.goals.driver_schedule import DriverSchedule
from compoundkin.studies.goals.goal import DesignConstraint, Goal
from compoundkin.studies.goals.path_goals import function, path, poses, trace
from compoundkin.studies.goals.range_goals import dwell, even, straight_line
from compoundkin.studies.goals.value_goals import greatest, least, target
from compoundkin.studies.responses import studied_path

TURN = np.linspace(0, 2 * np.pi, 13)[:-1]
FREE = {"crank.D.x": 13.5, "plate.C": 12.3 + 8.6j}


def trial_of(asked: Goal | DesignConstraint, dimensions: Mapping[str, Number], unknowns: Number) -> DesignTrial:
    """Some designs of the six-bar, as a goal sees them."""
    mechanism = ck.load("six-bar")
    names = asked.outputs(ck.solve(mechanism, TURN))
    studied, responses = studied_path(mechanism, list(dimensions), names, TURN)
    return DesignTrial(studied.designs(dimensions), {one.name: one for one in responses}, unknowns)


def numbers(asked: Goal | DesignConstraint, trial: DesignTrial) -> Number:
    return asked.residuals(trial) if isinstance(asked, Goal) else asked.margins(trial)


def hold_slopes(asked: Goal | DesignConstraint, unknowns: Number | None = None) -> None:
    """Its slopes are the differences of its numbers, by all coordinates and unknowns."""
    own = np.empty(0) if unknowns is None else np.asarray(unknowns, dtype=float)
    start = np.array([13.5, 12.3, 8.6, *own])
    step, width = 1e-5, len(start)

    def at(rows: Number) -> DesignTrial:
        return trial_of(asked, {"crank.D.x": rows[:, 0], "plate.C": rows[:, 1] + 1j * rows[:, 2]}, rows[:, 3:])

    ahead, behind = (numbers(asked, at(start + way * step * np.eye(width))) for way in (1, -1))
    found = asked.slopes(at(start[None, :]))[0]
    expected = (ahead - behind).T / (2 * step)
    assert found.shape == expected.shape
    assert np.abs(found - expected).max() < 1e-6 * max(1.0, np.abs(expected).max())


class AtOwnValues(Goal):
    """A point near two places, wherever the driver is then."""

    description, has_own_poses = "two places", True
    places = np.array([20 + 5j, 22 + 3j])

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        return ("G.position",)

    def residuals(self, trial: DesignTrial) -> Number:
        return real_parts(trial.at("crank", trial.unknowns).values("G.position") - self.places)

    def slopes(self, trial: DesignTrial) -> Number:
        there = trial.at("crank", trial.unknowns)
        own = there.driver_slopes("G.position", "crank")[:, :, None] * np.eye(2)
        return real_parts(np.concatenate([there.slopes("G.position"), own], axis=-1))


@pytest.mark.parametrize("goal", [path("G", TURN), least("bar.angle.greatest"), greatest("G.x.stroke")])
def test_slopes_along_the_motion(goal: Goal) -> None:
    hold_slopes(goal)


def test_slopes_at_driver_values_of_its_own() -> None:
    hold_slopes(AtOwnValues(), np.array([0.4, 1.9]))


def test_what_does_not_fit_is_told_at_once() -> None:
    motion = ck.solve(ck.load("six-bar"), TURN)
    with pytest.raises(ck.errors.InvalidInput, match="3 points, and 12 poses"):
        path("G", [1, 2, 3]).outputs(motion)
    with pytest.raises(ck.errors.InvalidInput, match=r'take a figure of it: "G.x.greatest"'):
        least("G.x").outputs(motion)
    for wrong in ("abc", [], [np.nan], [[1, 2, 3]], 5):
        with pytest.raises(ck.errors.InvalidInput, match="these are not points"):
            path("G", wrong)
    with pytest.raises(ck.errors.InvalidInput, match="not a positive number"):
        -1.0 * path("G", [1])


def test_sums_keep_their_weights() -> None:
    one, other = path("G", TURN), least("G.x.stroke")
    assert (one + 2 * other).parts == ((1.0, one), (2.0, other))
    assert (3 * (one + 2 * other) + one).parts == ((3.0, one), (6.0, other), (1.0, one))


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


STROKE, ANGLE = "rocker.angle.stroke", "rocker.angle"
goals = ck.goals
MISTAKES: dict[str, tuple[Callable[[], object], str]] = {
    "number added": (lambda: goals.least(STROKE) + 1, "objective: 1 is not a goal and cannot be added"),
    "text added": (lambda: STROKE + goals.least(STROKE), "objective: 'rocker.angle.stroke' is not a goal"),
    "less a goal": (lambda: goals.least(STROKE) - goals.least(STROKE), r"weight: -1 is .* goals.greatest\(...\)"),
    "negative": (lambda: -goals.least(STROKE), "weight: -1 is not a positive number"),
    "flag": (lambda: True * goals.least(STROKE), "weight: True is not a positive number"),
    "array": (lambda: np.arange(2) * goals.least(STROKE), r"weight: .* is not a positive number"),
    "vector": (lambda: goals.least("C.position"), "C.position.length.greatest"),
    "course": (lambda: goals.least(ANGLE), '"rocker.angle.greatest"'),
    "one point": (lambda: goals.path("C", (1, 2)), r"path.C: \(1, 2\) is one point"),
    "function of nothing": (lambda: goals.function(ANGLE, lambda at: 1 / 0 * at), "function.rocker.angle: .* zero"),
    "function of a figure": (lambda: goals.function(STROKE, np.sin), "it is a figure, not a course"),
    "one pair of changes": (lambda: goals.function(ANGLE, [(0, 1)], free_zero=True), "one pair has no changes"),
    "complex figure": (lambda: goals.target(STROKE, 1 + 2j), "rocker.angle.stroke is not a vector"),
    "complex number": (lambda: goals.target(ANGLE, 1 + 2j), r"rocker.angle is not a vector, and cannot be \(1\+2j\)"),
    "degrees": (lambda: goals.transmits("rocker", 40), "transmits.rocker: 40 is not between .* compoundkin.deg"),
    "itself": (lambda: goals.distance("A", "A", at_least=1), "a point has no distance from itself"),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_told(name: str) -> None:
    made, told = MISTAKES[name]
    mechanism = ck.load("crank-rocker")
    with pytest.raises(ck.errors.CompoundkinError, match=told):
        ck.optimise(mechanism, {"crank.B.x": (1, 2)}, made(), starts=1)  # type: ignore[arg-type]


def test_goals_are_summed_as_numbers_are() -> None:
    both = sum([goals.least(STROKE), np.float32(2) * goals.path("C", [(1, 2)])])
    assert [weight for weight, _ in both.parts] == [1.0, 2.0]  # type: ignore[union-attr]
    assert [goal.description.split(" ")[0] for _, goal in both.parts] == [STROKE, "C"]  # type: ignore[union-attr]


def test_a_point_that_rests_goes_along_any_line() -> None:
    mechanism = ck.load("crank-rocker")
    found = ck.optimise(mechanism, {"crank.B.x": (1.5, 2)}, goals.straight_line("A"), starts=1)
    assert found.value == 0.0
    assert [one.matters for one in found.changes] == [False]


def test_numbers_beyond_all_bounds_are_no_fault_of_assembly(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("compoundkin.studies.optimisation.design_search.MOST_SAMPLED", 1 << 10)
    mechanism = ck.load("crank-rocker")
    with pytest.raises(ck.errors.NotAssembled, match="with finite goals and constraints"):
        ck.optimise(mechanism, {"crank.B.x": (1.5, 2)}, goals.target(STROKE, 1e300), values=np.linspace(0, 6, 5))


def test_the_margin_of_a_box_is_that_of_its_nearest_side() -> None:
    mechanism = ck.load("crank-rocker")
    found = ck.optimise(mechanism, {"crank.B.x": (1.5, 2)}, STROKE, goals.box("C", x=(-90, 12)), starts=2)
    sides = (ck.quantity(found.motion, f"C.x.{end}").values.ravel()[0] for end in ("least", "greatest"))
    low, high = sides
    assert found.constraints[0].margin == pytest.approx(min(low + 90, 12 - high), rel=1e-9)


BARE = ck.Mechanism(
    "Crank-rocker",
    ck.link("frame", A=(0, 0), D=(60, 0)),
    ck.link("crank", A=(0, 0), B=(25, 0)),
    ck.link("coupler", B=(0, 0), C=(55, 0), E=(30, 22)),
    ck.link("rocker", D=(0, 0), C=(45, 0)),
    ck.drive("crank"),
)
FULL = BARE.replace(
    ck.outline("crank", 6),
    ck.outline("rocker", 8),
    ck.outline("coupler", 6, layer=1),
    ck.outline("coupler", polygon=["E", (40, 30), (20, 30)], layer=1),
    ck.outline("frame", at=(30, 95), radius=4, layer=1),
    ck.outline("frame", polygon=["A", (-20, -40), (80, -40)], layer=0),
)
COARSE_TURN = ck.deg(range(0, 360, 10))
FREE_OF_OUTLINES: dict[str, complex] = {
    "crank.B.x": 25.0,
    "coupler.B": 0.3 + 0.2j,
    "frame.D.x": 60.0,
    "coupler.E": 30 + 22j,
}


def trial(asked: DesignConstraint, dimensions: Mapping[str, Number]) -> DesignTrial:
    names = asked.outputs(ck.solve(FULL, COARSE_TURN))
    studied, responses = studied_path(FULL, list(dimensions), names, COARSE_TURN)
    return DesignTrial(studied.designs(dimensions), {one.name: one for one in responses}, np.empty((1, 0)))


def test_slopes_of_clearances_are_those_of_differences() -> None:
    asked, step = clearance(2.0), 1e-5
    names = [
        one for name in FREE_OF_OUTLINES for one in ((name,) if name.endswith(".x") else (f"{name}.x", f"{name}.y"))
    ]
    # the mechanism as it stands, then each coordinate ahead and behind
    steps = step * np.concatenate([np.zeros((1, len(names))), np.eye(len(names)), -np.eye(len(names))])
    columns = dict(zip(names, steps.T, strict=True))
    dimensions = {name: value + columns.get(name, columns.get(f"{name}.x", 0.0) + 1j * columns.get(f"{name}.y", 0.0))
                  for name, value in FREE_OF_OUTLINES.items()}  # fmt: skip
    every = trial(asked, dimensions)
    assert list(every.coordinates) == names
    margins = asked.margins(every)
    differences = (margins[1 : 1 + len(names)] - margins[1 + len(names) :]) / (2.0 * step)
    assert np.abs(asked.slopes(every)[0] - differences.T).max() < 1e-6


def test_margins_are_those_of_interference() -> None:
    asked = clearance(1.5)
    own = {name: np.array([value]) for name, value in {**FREE_OF_OUTLINES, "coupler.B": 0j}.items()}
    margins = asked.margins(trial(asked, own))[0]
    told = {(one.one, one.other): one.clearance for one in ck.interference(ck.solve(FULL, COARSE_TURN)).clearances}
    # between the poses it is less by what ten degrees may hide
    assert sorted(margins) == pytest.approx(sorted(value - 1.5 for value in told.values()), abs=0.3)
    assert (np.sort(margins) >= np.sort([value - 1.5 for value in told.values()]) - 1e-9).all()


def test_a_crank_is_made_as_long_as_a_stop_lets_it_be() -> None:
    """The longest crank that keeps 1 clear of a disc in its way: distance less radius, half width and the gap."""
    crank = ck.Mechanism("Crank", ck.link("frame", A=0), ck.link("crank", A=0, B=5), ck.drive("crank"))
    stopped = crank.replace(ck.outline("crank", 2), ck.outline("frame", at=(0, 12), radius=1))
    found = ck.optimise(
        stopped, {"crank.B.x": (3.0, 20.0)}, ck.goals.greatest("B.x.greatest"),
        ck.goals.clearance(1.0, "crank"), values=ck.deg(range(0, 361, 30)), starts=1,
    )  # fmt: skip
    assert complex(found.mechanism.links["crank"].points["B"]).real == pytest.approx(12.0 - 1.0 - 1.0 - 1.0, abs=1e-6)
    assert found.mechanism.outlines["crank"].width == 2.0
    least = ck.interference(ck.solve(found.mechanism)).least
    assert least is not None
    assert least.clearance == pytest.approx(1.0, abs=1e-6)


def test_what_cannot_be_asked_is_told() -> None:
    motion = ck.solve(FULL, COARSE_TURN)
    with pytest.raises(ck.errors.InvalidInput, match="is no clearance"):
        clearance(-1.0)
    with pytest.raises(ck.errors.UnknownName, match="no outline of it is compared"):
        clearance(1.0, "crnk").outputs(motion)
    with pytest.raises(ck.errors.InvalidInput, match="no two links with outlines share a layer"):
        clearance(1.0).outputs(ck.solve(BARE, COARSE_TURN))
