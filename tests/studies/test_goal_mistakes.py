"""Mistakes in what a search is asked: each is told in the field's words, before any search begins."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import compoundkin as ck

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
