"""Goals and constraints: their slopes are those of differences, and what does not fit is told."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.arrays import Number
from compoundkin.kinematics.motion import Motion
from compoundkin.studies.goals.design_trial import DesignTrial, real_parts
from compoundkin.studies.goals.goal import DesignConstraint, Goal
from compoundkin.studies.goals.path_goals import path
from compoundkin.studies.goals.value_goals import greatest, least
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
