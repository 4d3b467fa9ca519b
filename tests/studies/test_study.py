"""Studies: rows, results, programs, and regressions."""

from __future__ import annotations

import pickle
import shutil
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from functools import cache
from pathlib import Path
from threading import Barrier, Event
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import InvalidInput, LikelySlip
from compoundkin.programs.backends import runner
from compoundkin.programs.backends.runner import ThreadTurns
from compoundkin.studies import load_study
from compoundkin.studies.responses import studied_path
from compoundkin.studies.samples import sample_of
from compoundkin.studies.samples.variations import variation_of
from compoundkin.studies.study_plan import differences, digest
from compoundkin.studies.study_program import StudyProgram


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


def test_threads_take_turns_and_wait_for_nobody_forever(monkeypatch: pytest.MonkeyPatch) -> None:
    turns, reached = ThreadTurns(), Event()

    def other() -> None:
        with turns.taken():
            reached.set()

    monkeypatch.setattr(runner, "LONGEST_WAIT", 60.0)
    with ThreadPoolExecutor(1) as threads, turns.taken(), turns.taken():
        waiting = threads.submit(other)
        assert not reached.wait(0.05)
        with turns.left():
            waiting.result(timeout=10.0)
        # another that gets no turn goes on without
        monkeypatch.setattr(runner, "LONGEST_WAIT", 0.05)
        threads.submit(other).result(timeout=10.0)


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


RANGES = {"crank.D.x": variation_of("crank.D.x", (13.0, 14.0)), "plate.C.x": variation_of("plate.C.x", (12.0, 12.5))}
TURN = ck.deg(np.arange(0.0, 360.0, 10.0))


@pytest.fixture(scope="module")
def program() -> StudyProgram:
    names = ["G.position", "bar.angle.stroke", "plate.transmission_angle.least"]
    path, responses = studied_path(ck.load("six-bar"), list(RANGES), names, TURN, speed=3.0)
    return StudyProgram(RANGES, sample_of("sobol", 8192, 1), path, responses)


def test_rows_are_the_same_in_any_chunk(program: StudyProgram) -> None:
    whole = program.rows(range(4000, 4300))
    parts = [program.rows(range(start, start + 100)) for start in range(4000, 4300, 100)]
    assert list(whole) == ["row", *(column.name for column in program.columns)]
    for name, values in whole.items():
        assert np.array_equal(values, np.concatenate([part[name] for part in parts]))
    assert whole["row"].tolist() == list(range(4000, 4300))
    assert not len(program.rows(range(0))["row"])


def test_columns_tell_units_kinds_and_widths(program: StudyProgram) -> None:
    found = {column.name: column for column in program.columns}
    assert found["crank.D.x"].kind == "dimension"
    assert found["G.position.y"].width == len(TURN)
    assert found["bar.angle.stroke"].unit == "rad"
    assert found["reason"].kind == "state"
    assert [found[name].width for name in ("assembled", "bar.angle.stroke")] == [None, None]
    rows = program.rows(range(5))
    assert rows["G.position.x"].shape == (5, len(TURN))


def test_designs_are_lost_between_the_poses_as_grashof_tells() -> None:
    """A crank that turns fully has the longest distance to cover at 184 degrees, between two poses."""
    turned = np.deg2rad(4.0)
    four_bar = ck.Mechanism(
        "Four-bar", ck.link("frame", A=0, D=5.0 * np.exp(1j * turned)), ck.link("crank", A=0, B=2),
        ck.link("coupler", B=0, C=5), ck.link("rocker", D=0, C=4), ck.drive("crank"), ck.mode(-1, "rocker"),
    )  # fmt: skip
    ranges = {"crank.B.x": (1.5, 4.5), "coupler.C.x": (3.0, 6.0), "rocker.C.x": (2.5, 5.0)}
    variations = {name: variation_of(name, given) for name, given in ranges.items()}
    path, responses = studied_path(four_bar, list(ranges), ["C.position"], TURN)
    rows = StudyProgram(variations, sample_of("sobol", 2**13, 1), path, responses).rows(range(2**13))
    crank, coupler, rocker = (rows[name] for name in ranges)
    longest, shortest = crank + 5.0 <= coupler + rocker, abs(5.0 - crank) >= abs(coupler - rocker)
    assert np.array_equal(rows["assembled"], longest & shortest)
    told = rows["reason"][~rows["assembled"]]
    assert all(text.startswith("RRR(coupler) cannot be assembled ") for text in told)
    assert "RRR(coupler) cannot be assembled between crank 180 and 190°" in told
    assert "RRR(coupler) cannot be assembled at crank 180 to 190°" in told
    assert set(rows["circuit"][~rows["assembled"]]) == {"RRR(coupler)+-"}
    assert set(rows["circuit"][rows["assembled"]]) == set(rows["branch"]) == {"RRR(coupler)-"}
    assert not rows["order_defect"].any()
    assert all(text is None for text in rows["reason"][rows["assembled"]])


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
    with pytest.raises(InvalidInput, match="it cannot be made: File name too long"):
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
    # where every floating number is whole, that says nothing of degrees
    warned = pytest.warns(LikelySlip, match="look like degrees") if far < 2.0**52 else nullcontext()
    with warned:
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


def test_rows_whose_wheels_do_not_fit_are_not_assembled() -> None:
    """The axes of the planetary train are 52 mm apart, to 1e-5 of it."""
    dimensions = {"arm.P.x": (51.9992, 52.0008)}
    studied = ck.study(ck.load("planetary-train"), dimensions, "Q.x", sample="grid", count=9, values=[0.0, 1.0])
    found = studied.run(threads=1)
    fits = np.abs(found["arm.P.x"] - 52.0) <= 1e-5 * found["arm.P.x"]
    assert fits.sum() == 5
    assert (found["assembled"] == fits).all()
    assert np.isnan(found["Q.x"][~fits]).all()
    assert [one is None for one in found["reason"]] == fits.tolist()
    assert set(found["reason"][~fits]) == {"planet in annulus does not fit"}
    with pytest.raises(ck.errors.InvalidMechanism, match=r"require a distance of 52, but P and O on 'arm' are"):
        found.mechanism(0)


@pytest.mark.parametrize(
    ("name", "shares", "words"),
    [
        ("rocker.angle.stroke", [-1.0], "shares: -1 is no percentile"),
        ("rocker.angle.stroke", [50.0, 101.0], "shares: 101 is no percentile"),
        ("rocker.angle.stroke", [float("nan")], "shares: nan is no percentile"),
        ("assembled", [50.0], "assembled: it is not one number"),
        ("rocker.angle.stork", [50.0], "no such column; .*stroke"),
    ],
)
def test_wrong_percentiles_say_what_would_do(name: str, shares: list[float], words: str) -> None:
    free = {"crank.B.x": (1.8, 2.2)}
    result = ck.study(ck.load("crank-rocker"), free, "rocker.angle.stroke", count=16).run()
    with pytest.raises(ck.errors.CompoundkinError, match=words):
        result.percentiles(name, shares)
