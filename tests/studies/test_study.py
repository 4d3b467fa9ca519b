"""Studies: every row is what solving its mechanism finds, whoever computed it; what cannot be meant is told first."""

from __future__ import annotations

import pickle
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.studies.study_data import differences, digest


@cache
def six_bar(count: int = 8192, speed: float = 3.0) -> ck.results.Study:
    ranges = {"crank.D.x": (13.0, 14.0), "rocker.A.x": (15.0, 30.0)}
    outputs = ["G.position", "bar.angle.stroke", "bar.angular_velocity"]
    turn = ck.deg(np.arange(0, 360, 30))
    return ck.study(ck.catalog.load_named("six-bar"), ranges, outputs, count=count, seed=2, values=turn, speed=speed)


@pytest.fixture(scope="module")
def result() -> ck.results.StudyResult:
    return six_bar().run(threads=1)


def assert_same(one: ck.results.StudyResult, other: ck.results.StudyResult) -> None:
    """To the last bit."""
    assert one.names == other.names
    for name in one.names:
        a, b = one[name], other[name]
        assert a.dtype == b.dtype, name
        assert (a.tolist() == b.tolist()) if a.dtype == object else (a.tobytes() == b.tobytes()), name


def test_a_row_is_what_solving_its_mechanism_finds(result: ck.results.StudyResult) -> None:
    assert len(result) == len(result["row"]) == 8192
    for row in (0, 17, 5000):
        mechanism, motion = result.mechanism(row), result.motion(row)
        assert mechanism.geometry.points["crank"]["D"].real == result["crank.D.x"][row]
        for name in ("G.position", "bar.angular_velocity"):
            expected = ck.quantity(motion, name).values
            assert np.allclose(result[name][row], expected, rtol=1e-10, atol=0), name
    assert result["G.position"].shape == (8192, 12)


def test_numbers_depend_neither_on_chunks_nor_on_workers(result: ck.results.StudyResult) -> None:
    told: list[tuple[int, int]] = []
    assert_same(result, six_bar().run(chunk=1, threads=3, progress=lambda *at: told.append(at)))
    assert told == [(0, 8192), (4096, 8192), (8192, 8192)]
    with ThreadPoolExecutor(2) as pool:
        assert_same(result, pickle.loads(pickle.dumps(six_bar())).run(on=pool))


def test_the_best_are_rows_that_assemble(result: ck.results.StudyResult) -> None:
    name = "bar.angle.stroke"
    best = result.best(name, 3)
    values = np.sort(result[name][result.assembled])
    assert [row[name] for row in best] == values[:3].tolist()
    (most,) = result.best(name, greatest=True)
    assert most[name] == values[-1]
    again = {key: result[key][most["row"]] for key in ("crank.D.x", "G.position")}
    assert most["crank.D.x"] == again["crank.D.x"]
    assert (most["G.position"] == again["G.position"]).all()


def test_tables_and_frames_have_the_columns(result: ck.results.StudyResult) -> None:
    table = result.table()
    assert len(table) == 8192
    assert table.names == tuple(n for n in result.names if result[n].ndim == 1)
    assert table.units["bar.angle.stroke"] == "rad"
    frame = result.to_pandas()
    assert tuple(frame.columns) == result.names
    assert (frame["G.position.x"][5] == result["G.position"][5].real).all()
    assert frame.attrs["angles"] == "radians"


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"dimensions": {"crnk.D.x": (1, 2)}}, "crnk"),
        ({"dimensions": {}}, "dimensions: there is none"),
        ({"outputs": []}, "outputs: there is none"),
        ({"outputs": ["bar.angel"]}, "bar.angle"),
        ({"sample": "sobel"}, "sobol"),
        ({"count": None}, "count"),
        ({"seed": -1}, "seed"),
        ({"values": np.zeros((2, 3))}, "values"),
    ],
)
def test_what_cannot_be_meant_is_told_before_anything_runs(options: dict[str, Any], told: str) -> None:
    given = {"dimensions": {"crank.D.x": (13, 14)}, "outputs": ["G.position"], "count": 4, **options}
    with pytest.raises(ck.errors.CompoundkinError, match=told):
        ck.study(ck.catalog.load_named("six-bar"), **given)


def test_wrong_questions_to_a_result_are_told(result: ck.results.StudyResult) -> None:
    for call, told in {
        (lambda: result["bar.angle.strok"]): "did you mean 'bar.angle.stroke'",
        (lambda: result.best("G.position")): "one number",
        (lambda: result.best("bar.angle.stroke", 0)): "count",
        (lambda: result.mechanism(8192)): "rows 0 to 8191",
        (lambda: result.table("G.position")): "every pose",
        (lambda: six_bar(4).run(on=3)): "on: 3 computes nothing",
        (lambda: six_bar(4).run(threads=0)): "threads",
    }.items():
        with pytest.raises(ck.errors.CompoundkinError, match=told):
            call()


def test_what_differs_between_two_studies_is_told() -> None:
    one, other = six_bar(4), six_bar(8, 4.0)
    assert sorted(differences(one.data, other.data)) == ["sample.count", "speed"]
    assert (
        digest(one.data) == digest(six_bar(4).data) == pickle.loads(pickle.dumps(one)).fingerprint != other.fingerprint
    )
