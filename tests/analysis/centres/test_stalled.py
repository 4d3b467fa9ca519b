"""The ways out where crossing stalls that the known chains do not need: several trial values, solved velocities."""

from __future__ import annotations

from collections.abc import Iterator

import networkx as nx
import numpy as np
import pytest

import compoundkin as ck
from compoundkin.analysis.centres import Status, derivation, instant_centres
from compoundkin.analysis.centres.derivation import RateSets, Trial, derive
from compoundkin.analysis.centres.evaluation import Evaluation
from compoundkin.analysis.centres.homogeneous import sine_between
from compoundkin.analysis.centres.known_centres import null_twists
from tests.analysis.centres.chains import DOUBLE_BUTTERFLY, SINGLE_FLIER, diagram, random_mechanism, solved
from tests.support import drawn_values


@pytest.fixture(autouse=True)
def _fresh_derivations() -> Iterator[None]:
    derive.cache_clear()
    yield
    derive.cache_clear()


@pytest.mark.parametrize(("graph6", "values"), [(DOUBLE_BUTTERFLY, 3), (SINGLE_FLIER, 2)])
def test_several_trial_values(graph6: str, values: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Carried link by link only, the motion needs more trial values; the answer is the same."""
    monkeypatch.setattr(RateSets, "_next_bridge", lambda sets: None)
    circle = diagram(nx.from_graph6_bytes(graph6.encode()))
    plan = derive(circle)
    trial = next(rule for rule in plan.rules if isinstance(rule, Trial))
    assert trial.values == len(trial.meetings) == values
    places = np.random.default_rng(9).uniform(-1.0, 1.0, (len(circle.primaries), 2, 300))
    units = [np.stack([x, y, np.ones(300)]) / np.sqrt(x * x + y * y + 1.0) for x, y in places]
    found = Evaluation(plan, units, [np.ones(1)])
    found.run(None)
    twists, gap = null_twists(circle, units, [np.ones(1)])
    for i, j in trial.found:
        firm = (gap > 1e-3) & (found.spread[i, j] < 1e4)
        assert firm.mean() > 0.8
        assert np.max(sine_between(found.points[i, j], twists[j] - twists[i]), where=firm, initial=0.0) < 1e-9


def test_what_nothing_else_gives_comes_from_the_solved_velocities(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(derivation, "trial_position", lambda centres: None)
    flier = random_mechanism(nx.from_graph6_bytes(SINGLE_FLIER.encode()), 0)
    centres = instant_centres(solved(flier))
    by_velocity = [couple for couple in centres if centres[couple].how == "solved velocities"]
    assert len(by_velocity) == 16
    derive.cache_clear()
    monkeypatch.undo()
    proper = instant_centres(solved(flier))
    for couple in by_velocity:
        assert abs(complex(centres[couple].point) - complex(proper[couple].point)) < 1e-9 * (
            1.0 + abs(complex(proper[couple].point))
        )


def test_without_velocities_they_are_undetermined(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(derivation, "trial_position", lambda centres: None)
    flier = random_mechanism(nx.from_graph6_bytes(SINGLE_FLIER.encode()), 0)
    centres = instant_centres(ck.solve(flier, drawn_values(flier), order=0))
    statuses = [int(centres[couple].status) for couple in centres]
    assert statuses.count(Status.UNDETERMINED) == 16
    assert statuses.count(Status.FOUND) == 12
