"""Faults of studies that once were, each shown by what it did to users."""

from __future__ import annotations

import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import InvalidInput, LikelySlip
from compoundkin.studies import load_study

CRANK = {"crank.B.x": (1.8, 2.2)}
PART = "rows-000000000-000004096.parquet"
StudyResult = ck.results.StudyResult
target = 1.0


def rocker(count: int = 4096, dimensions: Any = None, outputs: Any = "rocker.angle", **options: Any) -> Any:
    mechanism = ck.load("crank-rocker")
    options = {"values": [0.0, 0.1], "sample": "random", **options}
    return ck.study(mechanism, dimensions or CRANK, outputs, count=count, **options)


def test_a_part_that_is_damaged_inside_is_told(tmp_path: Path) -> None:
    study = rocker()
    values = study.run(tmp_path)["rocker.angle"]
    content = bytearray((tmp_path / PART).read_bytes())
    place = content.find(values[:4].tobytes())
    content[place if place > 0 else 3000] ^= 1
    (tmp_path / PART).write_bytes(content)
    result = StudyResult.open(tmp_path)
    with pytest.raises(InvalidInput, match="the part is damaged"):
        _ = [result[name] for name in result.names]
    (tmp_path / PART).unlink()
    with pytest.raises(InvalidInput, match="the part is gone"):
        _ = result["rocker.angle"]
    np.testing.assert_array_equal(study.run(tmp_path)["rocker.angle"], values)


def test_a_part_by_the_name_of_another_is_none(tmp_path: Path) -> None:
    study = rocker(2 * 4096)
    rows = study.run(tmp_path, chunk=4096)["crank.B.x"]
    shutil.copy(tmp_path / PART, tmp_path / "rows-000004096-000008192.parquet")
    with pytest.warns(LikelySlip, match="the part is damaged or of another study"):
        np.testing.assert_array_equal(study.run(tmp_path)["crank.B.x"], rows)


def test_heads_that_are_damaged_or_new_are_told(tmp_path: Path) -> None:
    rocker(2).run(tmp_path)
    head = tmp_path / "study.json"
    text = head.read_text("utf-8")
    for old, new, told in (
        ('"format": 1', '"format": 9', "its format 9 is not known; update compoundkin"),
        ('"mechanism":', '"mechanismus":', "its study is damaged"),
    ):
        head.write_text(text.replace(old, new, 1), "utf-8")
        with pytest.raises(InvalidInput, match=told):
            StudyResult.open(tmp_path)
    with pytest.raises(InvalidInput, match="it cannot be a folder of a study: File name too long"):
        rocker(2).run(tmp_path / ("a" * 300))


def test_nothing_is_best_where_nothing_assembles(tmp_path: Path) -> None:
    study = rocker(4, {"crank.B.x": (40, 50)}, "rocker.angle.stroke")
    for result in (study.run(), study.run(tmp_path)):
        assert result.best("rocker.angle.stroke") == ()


def test_functions_are_others_when_what_they_read_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def squared(value: Any) -> Any:
        return value**2

    def again() -> Any:
        return rocker(8, outputs={"error": lambda at: squared(at["C.x"] - target)})

    found = again().run(tmp_path)["error"]
    np.testing.assert_array_equal(again().run(tmp_path)["error"], found)
    monkeypatch.setitem(globals(), "target", 2.0)
    with pytest.raises(InvalidInput, match=r"which differs in outputs\.error"):
        again().run(tmp_path)


@pytest.mark.parametrize(
    "outputs",
    [
        ["C.position", "C.position.x"],
        {"assembled": lambda at: at["C.x"]},
        {"crank.B.x": lambda at: at["C.x"]},
    ],
)
def test_two_columns_of_one_name_are_refused(outputs: Any) -> None:
    with pytest.raises(InvalidInput, match=r"outputs: '.*' would be two columns; name each output once"):
        rocker(8, outputs=outputs)


def test_lists_that_are_no_table_are_told() -> None:
    with pytest.raises(InvalidInput, match=r"dimensions\.crank\.B\.x: .* is not a number or an array of numbers"):
        rocker(None, {"crank.B.x": [[1, 2], 3]}, sample="table")  # type: ignore[arg-type]


@pytest.mark.parametrize("far", [1e6, 1e300])
def test_poses_that_are_far_apart_are_not_looked_between_for_ever(far: float) -> None:
    with pytest.warns(LikelySlip, match="look like degrees"):
        assert rocker(4, values=[0.0, far]).run().assembled.all()


def test_figures_of_a_design_do_not_depend_on_others_near_their_limits() -> None:
    lamp = ck.load("balanced-lamp")
    # a design whose force grows without limit made the search trust coarse polynomials of the other
    designs = {"head.L.x": np.array([0.19, 0.219]), "frame.R.y": np.array([-0.0596, -0.0645])}
    result = ck.study(lamp, designs, "O.force.length.least", sample="table").run()
    for row in np.flatnonzero(result.assembled).tolist():
        fine = ck.solve(result.mechanism(row), np.linspace(-np.pi / 3, np.deg2rad(75), 5001))
        least = np.abs(ck.quantity(fine, "O.force").values).min()
        assert result["O.force.length.least"][row] == pytest.approx(least, rel=1e-7)
    assert result.assembled.tolist() == [True, False]


def test_runs_that_begin_a_folder_at_a_time_share_it(tmp_path: Path) -> None:
    study, begun = rocker(8), Barrier(4)

    def run(_: int) -> Any:
        begun.wait()
        return study.run(tmp_path / "new", threads=1)["rocker.angle"]

    with ThreadPoolExecutor(4) as pool:
        for found in pool.map(run, range(4)):
            np.testing.assert_array_equal(found, study.run()["rocker.angle"])


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"count": 10**30}, "count: .* is too large"),
        ({"sample": {"crank.B.x": 10**12}}, r"sample\.crank\.B\.x: 1000000000000 is no number of levels"),
        ({"sample": {"crank.B.x": "4"}}, r"sample\.crank\.B\.x: '4' is no number of levels"),
        ({"sample": {}}, r"sample\.crank\.B\.x: it is not said how many levels it has"),
    ],
)
def test_numbers_that_are_too_large_are_told_so(options: dict[str, Any], told: str) -> None:
    with pytest.raises(InvalidInput, match=told):
        rocker(**{"count": None, **options})


def test_more_random_designs_than_stay_in_memory_are_refused() -> None:
    mechanism = ck.load("crank-rocker")
    with pytest.raises(InvalidInput, match="count: 100000000 designs of 2 values each do not fit in memory; at most"):
        ck.tolerance(mechanism, {"crank.B.x": 0.01}, "rocker.angle", values=[0.0, 0.1], count=10**8)


def test_errors_given_as_values_are_likely_slips() -> None:
    mechanism = ck.load("crank-rocker")
    options: Any = {"values": [0.0, 0.1], "count": 100, "percentiles": (50,)}
    with pytest.warns(LikelySlip, match=r"tolerances\.crank\.B\.x: the mechanism's own value is not among these"):
        ck.tolerance(mechanism, {"crank.B.x": ck.around(0.0, 0.01)}, "rocker.angle", **options)


def test_a_saved_study_goes_on_with_the_folder_of_the_first(tmp_path: Path) -> None:
    study = rocker(8, values=ck.deg(np.arange(0, 90, 7.3)), speed=5)
    found = study.run(tmp_path / "rows")["rocker.angle"]
    ck.save(study, tmp_path / "study.toml")
    same = load_study(tmp_path / "study.toml")
    assert same.data == study.data
    np.testing.assert_array_equal(same.run(tmp_path / "rows")["rocker.angle"], found)


def test_a_length_that_comes_to_zero_has_no_slope_there() -> None:
    shaper = ck.load("crank-shaper")
    least = "E.velocity.length.least"
    found = ck.tolerance(shaper, {"crank.A.x": 0.05}, least, count=100, percentiles=(50,))[least]
    assert (found.slopes["crank.A.x"], found.worst, found.deviation) == (0.0, 0.0, 0.0)
    assert found.sample.deviation < 1e-6
