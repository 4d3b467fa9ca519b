"""Curves of the pen: suggestions are documents whose point goes along the curve, better at each question."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.dimensional import curve_fitting
from compoundkin.dimensional.coupler_atlas import coupler_atlas
from compoundkin.files.mechanism_files import loads
from compoundkin.studio import answer, drawn_curves

ANGLES = np.linspace(0, 2 * np.pi, 90, endpoint=False)
EGG = 30 * np.exp(1j * ANGLES) + 9 * np.exp(-1j * ANGLES) + 4 * np.exp(2j * ANGLES) + 12 - 5j


@pytest.fixture(autouse=True)
def _small_atlas(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drawn_curves, "DESIGNS", 4_000)
    monkeypatch.setattr(curve_fitting, "DESIGNS", 4_000)
    monkeypatch.setattr(curve_fitting, "STARTED", 12)
    monkeypatch.setattr(curve_fitting, "GIVEN", 1)
    monkeypatch.setattr(curve_fitting, "ROUNDS", 0)


def asked(ask: str, curve: np.ndarray, **more: Any) -> dict[str, Any]:
    points = [[float(z.real), float(z.imag)] for z in curve]
    return answer("", {"ask": ask, "points": points, **more})


def even(line: np.ndarray, count: int) -> np.ndarray:
    along = np.append(0, np.cumsum(np.abs(np.diff(line))))
    return np.interp(np.linspace(0, along[-1], count), along, line)


def off(text: str, curve: np.ndarray, closed: bool) -> float:
    """The mean distance of a curve from the path of P over a turn, of a closed one also back, by every pair."""
    mechanism = loads(text)
    motion = ck.solve(mechanism, {mechanism.drives[0].name: np.linspace(0, 2 * np.pi, 1000)}, order=0)
    assert motion.assembled.all()
    path = np.ravel(motion.points["P"].position)
    apart = np.abs(even(np.append(curve, curve[:1]) if closed else curve, 2500)[:, None] - even(path, 2500))
    there, back = apart.min(axis=1).mean(), apart.min(axis=0).mean()
    return float((there + back) / 2 if closed else there)


@pytest.mark.parametrize("closed", [True, pytest.param(False, marks=pytest.mark.full)])
def test_suggestions_go_along_the_curve_each_step_nearer(closed: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drawn_curves, "_atlas", lambda: coupler_atlas(4, 4_000))
    curve = EGG if closed else EGG[:50]
    assert answer("", {"ask": "atlas"})["designs"] == 4_000
    best = []
    for ask in ("near", "fitted", "traced") if closed else ("near", "fitted"):
        reply = asked(ask, curve, closed=closed, links=4)
        assert reply["problems"] == []
        found = reply["suggestions"]
        assert [one["error"] for one in found] == sorted(one["error"] for one in found)
        for one in found[:2]:
            mechanism = loads(one["text"])
            assert one["links"] == 4 == len(mechanism.links)
            assert off(one["text"], curve, closed) == pytest.approx(one["error"], rel=0.1, abs=0.03)
            # what a thumbnail draws is the document's own drawing
            drawn = {letter: complex(*place) for letter, place in one["points"].items()}
            assert drawn == pytest.approx(dict(mechanism.geometry.sketch))
            assert answer(one["text"], {"ask": "motion"})["poses"] == 361
        best.append(found[0]["error"])
    assert best[1] < best[0]
    assert len(best) == 2 or best[2] <= best[1] * 1.2


def test_of_more_links_than_the_atlas_has_all_of_it_is_near() -> None:
    one, two = (asked("near", EGG, links=links) for links in (6, 8))
    assert one == two
    assert one["suggestions"]


def test_the_best_of_each_number_of_links_is_among_them() -> None:
    found = asked("near", EGG)["suggestions"]
    assert {4, 6} <= {one["links"] for one in found}
    titles = [one["title"] for one in found]
    assert len(found) <= drawn_curves.GIVEN + 2
    assert max(titles.count(one) for one in titles) <= drawn_curves.OF_A_KIND
    assert "-0.0" not in found[0]["text"]


@pytest.mark.parametrize(
    ("question", "words"),
    [
        ({}, "no points of a curve"),
        ({"points": [[0, 0]] * 3000}, "at most 2000"),
        ({"points": [[0, float("inf")]] * 9}, "no points of a curve"),
        ({"points": [[0, 1], [True, 2]]}, "no points of a curve"),
        ({"points": [[10**400, 1]] * 9}, "no points of a curve"),
        ({"points": [[1e300 * k, k * k] for k in range(9)]}, "no points of a curve"),
        ({"points": [[0, 1]] * 20}, "too few for a curve"),
        ({"points": [[k, k * k] for k in range(20)], "links": 5}, "not in the atlas"),
        ({"points": [[k, k * k] for k in range(20)], "closed": "yes"}, "true or false"),
    ],
)
def test_what_is_no_curve_is_said(question: dict[str, Any], words: str) -> None:
    (problem,) = answer("", {"ask": "near", **question})["problems"]
    assert words in problem["what"] + problem["remedy"]
