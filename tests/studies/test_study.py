"""Studies: every row is what solving its mechanism finds, whoever computed it; what cannot be meant is told first."""

from __future__ import annotations

import pickle
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.studies.study_plan import differences, digest


@cache
def six_bar(count: int = 8192, speed: float = 3.0, more: str = "") -> ck.results.Study:
    """Some of its designs do not assemble everywhere."""
    ranges = {"crank.D.x": (13.0, 14.0), "rocker.A.x": (15.0, 30.0)}
    outputs = ["G.position", "bar.angular_velocity", *more.split()]
    # made without scipy.stats, which takes a worker a second to import
    which: dict[str, Any] = {"sample": "random", "count": count, "seed": 2}
    turn = ck.deg(np.arange(0, 360, 60))
    return ck.study(ck.load("six-bar"), ranges, outputs, **which, values=turn, speed=speed)


@pytest.fixture(scope="module")
def result() -> ck.results.StudyResult:
    return six_bar().run(threads=1)


@pytest.fixture(scope="module")
def figures() -> ck.results.StudyResult:
    return six_bar(256, more="bar.angle.stroke").run(threads=1)


def assert_same(one: ck.results.StudyResult, other: ck.results.StudyResult) -> None:
    """To the last bit."""
    assert one.names == other.names
    for name in one.names:
        a, b = one[name], other[name]
        assert a.dtype == b.dtype, name
        assert (a.tolist() == b.tolist()) if a.dtype == object else (a.tobytes() == b.tobytes()), name


def test_a_row_is_what_solving_its_mechanism_finds(result: ck.results.StudyResult) -> None:
    assert len(result) == len(result["row"]) == 8192
    for row in np.flatnonzero(result.assembled)[[0, 17, 5000]].tolist():
        mechanism, motion = result.mechanism(row), result.motion(row)
        assert mechanism.geometry.points["crank"]["D"].real == result["crank.D.x"][row]
        for name in ("G.position", "bar.angular_velocity"):
            expected = ck.quantity(motion, name).values
            assert np.allclose(result[name][row], expected, rtol=1e-10, atol=0), name
    assert result["G.position"].shape == (8192, 6)


def test_numbers_depend_neither_on_chunks_nor_on_workers(result: ck.results.StudyResult) -> None:
    told: list[tuple[int, int]] = []
    assert_same(result, six_bar().run(chunk=1, threads=3, progress=lambda *at: told.append(at)))
    assert told == [(0, 8192), (4096, 8192), (8192, 8192)]
    with ThreadPoolExecutor(2) as pool:
        assert_same(result, pickle.loads(pickle.dumps(six_bar())).run(on=pool))


def test_the_best_are_rows_that_assemble(figures: ck.results.StudyResult) -> None:
    name = "bar.angle.stroke"
    best = figures.best(name, 3)
    values = np.sort(figures[name][figures.assembled])
    assert [row[name] for row in best] == values[:3].tolist()
    (most,) = figures.best(name, greatest=True)
    assert most[name] == values[-1]
    assert list(most)[:4] == ["row", "crank.D.x", "rocker.A.x", "G.position"]
    again = {key: figures[key][most["row"]] for key in ("crank.D.x", "G.position")}
    assert most["crank.D.x"] == again["crank.D.x"]
    assert (most["G.position"] == again["G.position"]).all()


def test_tables_and_frames_have_the_columns(figures: ck.results.StudyResult) -> None:
    table = figures.table()
    assert len(table) == 256
    assert table.names == tuple(n for n in figures.names if figures[n].ndim == 1)
    assert table.units["bar.angle.stroke"] == "rad"
    frame = figures.to_pandas()
    assert tuple(frame.columns) == figures.names
    assert (frame["G.position.x"][5] == figures["G.position"][5].real).all()
    assert frame.attrs["angles"] == "radians"


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"dimensions": {"crnk.D.x": (1, 2)}}, "dimensions.crnk.D.x: "),
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
        ck.study(ck.load("six-bar"), **given)


def test_a_result_tells_which_columns_it_has(figures: ck.results.StudyResult) -> None:
    assert tuple(figures) == figures.names
    assert "row" in figures
    assert "crank.Z" not in figures


def test_wrong_questions_to_a_result_are_told(figures: ck.results.StudyResult) -> None:
    for call, told in {
        (lambda: figures["bar.angle.strok"]): "did you mean 'bar.angle.stroke'",
        (lambda: figures.best("G.position")): "one number",
        (lambda: figures.best("bar.angle.stroke", 0)): "count",
        (lambda: figures.mechanism(256)): "rows 0 to 255",
        (lambda: figures.table("G.position")): "every pose",
        (lambda: six_bar(4).run(on=3)): "on: 3 computes nothing",
        (lambda: six_bar(4).run(threads=0)): "threads",
    }.items():
        with pytest.raises(ck.errors.CompoundkinError, match=told):
            call()


def test_what_differs_between_two_studies_is_told() -> None:
    one, other = six_bar(4), six_bar(8, 4.0)
    assert sorted(differences(one.data, other.data)) == ["sample.count", "speed.crank"]
    assert (
        digest(one.data) == digest(six_bar(4).data) == pickle.loads(pickle.dumps(one)).fingerprint != other.fingerprint
    )


def test_functions_of_a_pose_are_outputs_in_folders_too(tmp_path: Path) -> None:
    def away(target: complex) -> ck.results.Study:
        outputs = {"error": lambda at: abs(at["C.position"] - at["target"]) ** 2 - target.imag}
        free, turn = {"crank.B.x": (0.9, 1.1)}, ck.deg(np.arange(0, 360, 60))
        given = {"target": target}
        return ck.study(ck.load("crank-rocker"), free, outputs, count=4, values=turn, given=given)

    result = away(5 + 2j).run(tmp_path)
    places = ck.quantity(result.motion(3), "C.position").values
    assert result["error"][3] == pytest.approx(sum(abs(places - 5 - 2j) ** 2 - 2.0))
    # the function is told by what it does and the values that it holds, and so known again
    assert_same(away(5 + 2j).run(tmp_path), result)
    with pytest.raises(ck.errors.InvalidInput, match=r"differs in outputs\.error\.content, given\.target"):
        away(5 + 3j).run(tmp_path)
    with pytest.raises(ck.errors.InvalidInput, match=r"outputs\.error: it is a Python object"):
        ck.results.StudyResult.open(tmp_path)
    with pytest.raises(ck.errors.InvalidInput, match="no output reads it"):
        ck.study(result.study.mechanism, {"crank.B.x": (0.9, 1.1)}, "C", count=4, given={"target": 0})
