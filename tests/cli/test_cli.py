from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

import compoundkin as ck
from compoundkin.base.errors import Problem
from compoundkin.cli import VERBS, cli, shell
from compoundkin.files import dumps, load, shipped_mechanisms
from compoundkin.files.shipped_mechanisms import path
from tests import catalog
from tests.support import DRIVE, FOUR_BAR

Run = Callable[..., Result]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Run a command in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    return lambda *args: CliRunner().invoke(cli, list(args), catch_exceptions=False)


@pytest.fixture
def broken(tmp_path: Path) -> str:
    (tmp_path / "broken.toml").write_text(FOUR_BAR.replace("[4, 0]", "[6.5, 0]"))
    return "broken.toml"


@pytest.fixture
def undriven(tmp_path: Path) -> str:
    (tmp_path / "undriven.toml").write_text(FOUR_BAR.removesuffix(DRIVE))
    return "undriven.toml"


@pytest.fixture
def wrong(tmp_path: Path) -> str:
    expected = '[[expected]]\nat = { crank = 0 }\nquantity = "rocker.angle"\nvalue = 1\ntolerance = 0.1\n'
    (tmp_path / "wrong.toml").write_text(FOUR_BAR + expected)
    return "wrong.toml"


def rows(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


def numbers(found: list[dict[str, str]], name: str) -> Any:
    return np.array([float(row[name]) for row in found])


# --- help, version, completion --------------------------------------------------------------------------


@pytest.mark.parametrize("args", [("--help",), *((verb, "--help") for verb in VERBS), ("catalog", "copy", "--help")])
def test_help_has_examples_and_fits_80_columns(run: Run, args: tuple[str, ...]) -> None:
    result = run(*args)
    assert result.exit_code == 0
    assert "Usage: compoundkin" in result.stdout or "Usage: cli" in result.stdout
    assert all(len(line) <= 80 for line in result.stdout.splitlines())
    if "copy" not in args:
        assert "Example" in result.stdout


def test_help_lists_every_verb_with_the_first_words_of_its_own_help(run: Run) -> None:
    assert all(f"  {verb} " in run("--help").stdout for verb in VERBS)


def test_version(run: Run) -> None:
    assert run("--version").stdout == f"compoundkin {ck.__version__}\n"


def test_an_unknown_command_is_told_the_nearest(run: Run) -> None:
    result = run("rpeort", "six-bar")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "there is no command 'rpeort'; did you mean 'report'?" in result.stderr


@pytest.mark.parametrize("name", ["bash", "zsh", "fish"])
def test_completion_scripts(run: Run, name: str) -> None:
    result = run("completion", name)
    assert result.exit_code == 0
    assert "_COMPOUNDKIN_COMPLETE" in result.stdout


def test_names_of_the_catalog_are_completed() -> None:
    from compoundkin.cli.file_options import complete_name

    found = complete_name(None, None, "six")  # type: ignore[arg-type]
    assert [item.value for item in found] == ["six-bar"]


def test_the_schema_is_json(run: Run) -> None:
    assert json.loads(run("schema").stdout)["$schema"].startswith("https://json-schema.org")


# --- structure ------------------------------------------------------------------------------------------


def test_structure_of_a_name_and_of_a_file_agree(run: Run) -> None:
    by_name = run("structure", "six-bar")
    run("catalog", "copy", "six-bar", "mine.toml")
    by_file = run("structure", "mine.toml")
    assert by_name.exit_code == by_file.exit_code == 0
    assert by_name.stdout == by_file.stdout
    assert "2  RPR dyad: bar and block" in by_name.stdout


def test_structure_with_faults_is_printed_and_exits_2(run: Run, undriven: str) -> None:
    result = run("structure", undriven)
    assert result.exit_code == 2
    assert "Remedy: add a driver on one of: crank on frame (pin A)" in result.stdout
    assert result.stderr == "The mechanism cannot be solved: 1 fault, explained in the report.\n"


def test_report_of_a_structure_with_faults_is_that_structure(run: Run, undriven: str) -> None:
    assert run("report", undriven).stdout == run("structure", undriven).stdout
    assert run("report", undriven).exit_code == 2


def test_solve_of_a_structure_with_faults_is_an_error(run: Run, undriven: str) -> None:
    result = run("solve", undriven)
    assert (result.exit_code, result.stdout) == (2, "")
    assert "remedy: add a driver" in result.stderr


# --- report ---------------------------------------------------------------------------------------------


def test_report_is_text_without_colour_within_80_columns(run: Run) -> None:
    result = run("report", "six-bar")
    assert (result.exit_code, result.stderr) == (0, "")
    assert "\x1b" not in result.stdout
    assert all(len(line) <= 80 for line in result.stdout.splitlines())
    said = " ".join(result.stdout.split())
    checks = len(ck.verify(ck.solve(ck.load(path("six-bar")))).findings)
    assert f"All 73 poses assembled; all {checks} checks passed; 55 of 55 published numbers reproduced." in said


def test_report_formats_by_option_and_by_suffix(run: Run, tmp_path: Path) -> None:
    for form, suffix in (("markdown", "md"), ("json", "json"), ("text", "txt")):
        printed = run("report", "six-bar", "--format", form)
        result = run("report", "six-bar", "-o", f"out.{suffix}")
        assert (result.exit_code, result.stdout) == (0, "")
        assert result.stderr == f"Wrote out.{suffix}.\n"
        assert (tmp_path / f"out.{suffix}").read_text() == printed.stdout
    run("report", "six-bar", "--format", "json", "-o", "out.txt")
    assert json.loads((tmp_path / "out.txt").read_text())["title"] == "Six-bar of Example 3-4"


def test_report_of_unassembled_poses_exits_3_and_prints(run: Run, broken: str) -> None:
    result = run("report", broken)
    assert result.exit_code == 3
    assert "|BD| = 7.5 > |BC| + |CD| = 3 + 3" in result.stdout
    assert result.stderr == "Warning: 49 of 73 poses cannot be assembled.\n"


def test_report_of_a_wrong_published_number_exits_4(run: Run, wrong: str) -> None:
    result = run("report", wrong)
    assert result.exit_code == 4
    assert "1 of 1 published number NOT reproduced" in result.stdout
    assert "FAILED" in result.stderr


def test_report_over_a_part_of_the_range(run: Run) -> None:
    out = run("report", "six-bar", "--from", "0", "--to", "10", "--format", "json", "--output", "G.speed").stdout
    found = next(b for b in json.loads(out)["sections"]["outputs"]["blocks"] if b["kind"] == "table")
    assert [c["name"] for c in found["columns"]] == ["crank", "G.speed"]
    assert [row[0] for row in found["rows"]] == [0.0, 5.0, 10.0]


def test_report_of_a_design(run: Run, tmp_path: Path) -> None:
    (tmp_path / "sweep.toml").write_text(FOUR_BAR.replace("[4, 0]", "[[[4], [4.5]], 0]"))
    assert "Shown is design 1 of 2" in run("report", "sweep.toml", "--design", "1").stdout
    result = run("report", "sweep.toml", "--design", "2")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "there is no design 2" in result.stderr


# --- solve ----------------------------------------------------------------------------------------------


def test_solve_prints_the_motion_as_csv(run: Run) -> None:
    result = run("solve", "six-bar")
    found = rows(result.stdout)
    motion = catalog.motion("six-bar")
    assert (result.exit_code, result.stderr, len(found)) == (0, "", 73)
    np.testing.assert_allclose(numbers(found, "bar.angle [deg]"), np.rad2deg(motion.links["bar"].angle), rtol=1e-15)
    np.testing.assert_array_equal(numbers(found, "G.velocity.x [mm/s]"), motion.points["G"].velocity.real)
    assert [row["crank.value [deg]"] for row in found] == [str(5.0 * k) for k in range(73)]
    assert {row["assembled"] for row in found} == {"True"}


def test_solve_chosen_outputs_in_order(run: Run) -> None:
    found = rows(run("solve", "six-bar", "--at", "35", "--output", "bar,G.velocity", "--output", "A.speed").stdout)
    motion = ck.solve(load("six-bar"), {"crank": ck.deg(35)})
    assert list(found[0]) == ["crank.value [deg]", "bar [deg]", "G.velocity.x [mm/s]", "G.velocity.y [mm/s]",
                              "A.speed [mm/s]", "assembled"]  # fmt: skip
    assert float(found[0]["A.speed [mm/s]"]) == pytest.approx(float(motion.points["A"].speed), rel=1e-15)


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (("--at", "35"), [35.0]),
        (("--at", "35,40,80"), [35.0, 40.0, 80.0]),
        (("--at", "0:30:15"), [0.0, 15.0, 30.0]),
        (("--drive", "crank=90:0:-45"), [90.0, 45.0, 0.0]),
        (("--drive", "7"), [7.0]),
        (("--from", "350"), [350.0, 355.0, 360.0]),
        (("--to", "10"), [0.0, 5.0, 10.0]),
        (("--step", "120"), [0.0, 120.0, 240.0, 360.0]),
        (("--from", "10", "--to", "0"), [10.0, 5.0, 0.0]),
        (("--from", "0", "--to", "1", "--step", "0.25"), [0.0, 0.25, 0.5, 0.75, 1.0]),
        (("--from", "-5", "--to", "-5"), [-5.0]),
    ],
)
def test_ways_to_give_the_driver_values(run: Run, options: tuple[str, ...], expected: list[float]) -> None:
    found = rows(run("solve", "six-bar", *options, "--output", "G").stdout)
    assert [float(row["crank.value [deg]"]) for row in found] == expected


def test_driver_values_may_be_lengths_and_several(run: Run) -> None:
    options = ("--drive", "boom-cylinder=2.6:2.7:0.05", "--drive", "stick-cylinder=3", "--drive", "bucket-cylinder=2")
    found = rows(run("solve", "excavator-arm", *options, "--output", "W").stdout)
    assert numbers(found, "boom-cylinder.value [m]").tolist() == pytest.approx([2.6, 2.65, 2.7])
    assert numbers(found, "stick-cylinder.value [m]").tolist() == [3.0, 3.0, 3.0]


@pytest.mark.parametrize(
    ("text", "rate"), [("10", 10.0), ("crank=-2.5", -2.5), ("300rpm", 10 * np.pi), ("crank=90deg", np.pi / 2)]
)
def test_speeds(run: Run, text: str, rate: float) -> None:
    found = rows(run("solve", "six-bar", "--at", "0", "--speed", text, "--output", "crank.angular_velocity").stdout)
    assert float(found[0]["crank.angular_velocity [rad/s]"]) == pytest.approx(rate, rel=1e-14)


def test_accelerations_and_order(run: Run) -> None:
    options = ("--at", "0", "--speed", "3", "--acceleration", "7", "--output", "crank.angular_acceleration,D.jerk")
    found = rows(run("solve", "six-bar", *options).stdout)
    assert float(found[0]["crank.angular_acceleration [rad/s^2]"]) == pytest.approx(7.0)
    # D is at 14 on the x axis: jerk = 14 (-3 w a + i (-w^3))
    assert float(found[0]["D.jerk.x [mm/s^3]"]) == pytest.approx(-14 * 3 * 3 * 7)
    assert float(found[0]["D.jerk.y [mm/s^3]"]) == pytest.approx(-14 * 27)


def test_the_assembly_mode_changes_the_solution(run: Run) -> None:
    given = [rows(run("solve", "crank-rocker", "--at", "40", "--output", "rocker", *m).stdout)[0]["rocker [deg]"]
             for m in ((), ("--mode", "rocker=+1"), ("--mode", "rocker=-1"))]  # fmt: skip
    assert given[0] in given[1:]
    assert given[1] != given[2]


def test_solve_with_unassembled_poses_prints_them_masked_and_explains(run: Run, broken: str) -> None:
    result = run("solve", broken, "--output", "rocker")
    found = rows(result.stdout)
    assert result.exit_code == 3
    assert len(found) == 73
    assert sum(row["assembled"] == "False" for row in found) == 49
    assert all((row["rocker [deg]"] == "nan") == (row["assembled"] == "False") for row in found)
    assert "Between crank 56.1036448 and 303.896355°, the RRR group of coupler and rocker" in result.stderr


def test_tables_in_every_format_say_the_same(run: Run, tmp_path: Path) -> None:
    import pyarrow.parquet

    for suffix in ("csv", "json", "npz", "parquet"):
        result = run("solve", "six-bar", "--output", "G.velocity,bar", "-o", f"out.{suffix}")
        assert (result.exit_code, result.stdout) == (0, "")
        assert result.stderr == f"Wrote 73 rows of 5 columns to out.{suffix}.\n"
    motion = catalog.motion("six-bar")
    angle = motion.links["bar"].angle
    shown = rows((tmp_path / "out.csv").read_text())
    np.testing.assert_allclose(np.deg2rad(numbers(shown, "bar [deg]")), angle, rtol=1e-15)
    document = {c["name"]: c for c in json.loads((tmp_path / "out.json").read_text())["columns"]}
    np.testing.assert_allclose(np.deg2rad(document["bar"]["values"]), angle, rtol=1e-15)
    assert document["G.velocity.x"]["unit"] == "mm/s"
    with np.load(tmp_path / "out.npz") as archive:
        np.testing.assert_array_equal(archive["bar"], angle)
        np.testing.assert_array_equal(archive["G.velocity.y"], motion.points["G"].velocity.imag)
    stored = pyarrow.parquet.read_table(tmp_path / "out.parquet")
    np.testing.assert_array_equal(stored["bar"].to_numpy(), angle)
    assert stored.schema.field("bar").metadata == {b"unit": b"rad"}


def test_a_table_of_designs_has_their_index(run: Run, tmp_path: Path) -> None:
    (tmp_path / "sweep.toml").write_text(FOUR_BAR.replace("[4, 0]", "[[[4], [4.5]], 0]"))
    for outputs in ((), ("--output", "rocker")):
        found = rows(run("solve", "sweep.toml", "--at", "0,90", *outputs).stdout)
        assert [row["design"] for row in found] == ["0", "0", "1", "1"]


def test_json_tables_have_null_where_nothing_is_assembled(run: Run, broken: str, tmp_path: Path) -> None:
    run("solve", broken, "--output", "rocker", "--at", "0,180", "-o", "out.json")
    document = {c["name"]: c["values"] for c in json.loads((tmp_path / "out.json").read_text())["columns"]}
    assert document["rocker"][1] is None
    assert document["assembled"] == [True, False]


# --- catalog and new ------------------------------------------------------------------------------------


def test_the_catalog_lists_every_name_and_title(run: Run) -> None:
    lines = run("catalog").stdout.splitlines()
    assert [line.split()[0] for line in lines] == list(shipped_mechanisms.shipped())
    assert any(line.endswith("Six-bar of Example 3-4") for line in lines)
    assert run("catalog", "list").stdout.splitlines() == lines


def test_the_catalog_shows_a_file_as_it_is(run: Run) -> None:
    assert run("catalog", "show", "six-bar").stdout == shipped_mechanisms.path("six-bar").read_text()


def test_copies_go_here_to_a_folder_or_to_a_name(run: Run, tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    content = shipped_mechanisms.path("six-bar").read_bytes()
    for args, target in (((), "six-bar.toml"), (("folder",), "folder/six-bar.toml"), (("a.toml",), "a.toml")):
        assert run("catalog", "copy", "six-bar", *args).exit_code == 0
        assert (tmp_path / target).read_bytes() == content


def test_a_copy_is_written_in_the_form_that_its_suffix_tells(run: Run, tmp_path: Path) -> None:
    assert run("catalog", "copy", "six-bar", "a.json").exit_code == 0
    assert json.loads((tmp_path / "a.json").read_text())["format"] == 1
    assert dumps(load(tmp_path / "a.json")) == dumps(load(shipped_mechanisms.path("six-bar")))


@pytest.mark.parametrize(
    ("name", "told"),
    [("a.md", "a mechanism is not saved as '.md', a report is"), ("a", "the file has no suffix")],
)
def test_a_copy_with_another_suffix_is_refused(run: Run, tmp_path: Path, name: str, told: str) -> None:
    result = run("catalog", "copy", "six-bar", name)
    assert result.exit_code == 2
    assert told in result.stderr
    assert "mechanism files end in .toml, .json" in result.stderr
    assert not (tmp_path / name).exists()


@pytest.mark.parametrize(
    ("make", "name"), [(("catalog", "copy", "six-bar"), "six-bar.toml"), (("new",), "mechanism.toml")]
)
def test_nothing_is_overwritten_unless_forced(run: Run, tmp_path: Path, make: tuple[str, ...], name: str) -> None:
    (tmp_path / name).write_text("mine")
    result = run(*make)
    assert result.exit_code == 2
    assert "--force" in result.stderr
    assert (tmp_path / name).read_text() == "mine"
    assert run(*make, "--force").exit_code == 0
    assert (tmp_path / name).read_text() != "mine"


def test_a_new_file_is_a_mechanism_with_a_good_report(run: Run, tmp_path: Path) -> None:
    assert run("new", "my-linkage.toml").exit_code == 0
    assert load(tmp_path / "my-linkage.toml").title == "My linkage"
    assert run("report", "my-linkage.toml").exit_code == 0


def test_the_comments_of_a_new_file_are_right(run: Run, tmp_path: Path) -> None:
    run("new", "m.toml")
    text = (tmp_path / "m.toml").read_text()
    lines = text.split("# A block that slides")[1].splitlines()
    hinted = [line.removeprefix("#   ") for line in lines if line.startswith("#   ")]
    expected = hinted[hinted.index("[[expected]]") :]
    (tmp_path / "m.toml").write_text(text + "\n" + "\n".join(expected) + "\n")
    found = load(tmp_path / "m.toml")
    assert len(found.expectations) == 1
    assert run("report", "m.toml").exit_code in (0, 4)
    slide = hinted[: hinted.index("[[expected]]")]
    (tmp_path / "m.toml").write_text(text + "\n" + "\n".join(slide) + "\n")
    assert load(tmp_path / "m.toml").written_pairs[0].name == "block/rocker"


def test_new_writes_toml_only(run: Run) -> None:
    assert "ends in .toml" in run("new", "m.json").stderr


# --- mistakes -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("args", "told"),
    [
        (("report", "no.toml"), "there is no such file"),
        (("report", "six-bra"), "did you mean 'six-bar'?"),
        (("report", "."), "this is a folder"),
        (("report", "binary.toml"), "it is not UTF-8 text"),
        (("report", "empty.toml"), "links"),
        (("report",), "Missing argument 'FILE'"),
        (("report", "six-bar", "-o", "no/such/folder.md"), "it cannot be written"),
        (("report", "six-bar", "--format", "pdf"), "'pdf' is not one of"),
        (("report", "six-bar", "--output", "G.velocty"), "did you mean 'G.velocity'?"),
        (("solve", "six-bar", "--output", "nothing"), "there is no point, link, pair or driver 'nothing'"),
        (("solve", "six-bar", "--order", "4"), "4 is not in the range"),
        (("solve", "six-bar", "--order", "1", "--output", "G.jerk"), "give --order 3"),
        (("solve", "six-bar", "--at", "x"), "'x' is not a number"),
        (("solve", "six-bar", "--at", ""), "'' is not a number"),
        (("solve", "six-bar", "--at", "nan"), "'nan' is not finite"),
        (("solve", "six-bar", "--at", "1:2"), "'1:2' is not a range"),
        (("solve", "six-bar", "--at", "0:10:0"), "steps of 0 do not lead from 0 to 10"),
        (("solve", "six-bar", "--at", "0:10:-1"), "steps of -1 do not lead from 0 to 10"),
        (("solve", "six-bar", "--step", "1e-9"), "more than 1,000,000 values"),
        (("solve", "six-bar", "--step", "inf"), "steps of inf"),
        (("solve", "six-bar", "--at", "1", "--from", "2"), "it does not go with --from"),
        (("draw", "six-bar", "--configurations", "--ghosts", "3"), "it does not go with --configurations"),
        (("draw", "six-bar", "--circuits", "--dimensions"), "it does not go with --circuits"),
        (("solve", "six-bar", "--at", "1", "--drive", "crank=2"), "given twice"),
        (("solve", "six-bar", "--drive", "crnk=2"), "did you mean 'crank'?"),
        (("solve", "six-bar", "--speed", "crnk=2"), "did you mean 'crank'?"),
        (("solve", "six-bar", "--speed", "fast"), "'fast' is not a number"),
        (("solve", "six-bar", "--speed", "xrpm"), "write 10 (rad/s), 300rpm or 90deg (a second)"),
        (("solve", "six-bar", "--acceleration", "x"), "write 7 (rad/s^2)"),
        (("solve", "hydraulic-crane", "--speed", "fast"), "write 0.5 (lengths a second)"),
        (("solve", "six-bar", "--mode", "bra=1"), "did you mean 'bar'?"),
        (("solve", "six-bar", "--mode", "bar=2"), "'2' is not an assembly mode"),
        (("solve", "six-bar", "--mode", "bar"), "write bar=+1 or bar=-1"),
        (("solve", "six-bar", "-o", "out.xls"), ".csv, .json, .npz, .parquet"),
        (("solve", "excavator-arm", "--at", "2"), "there are 3 drivers"),
        (("solve", "excavator-arm", "--speed", "2"), "there are 3 drivers"),
        (("solve", "excavator-arm", "--drive", "boom-cylinder=2.6:2.7:0.05"), "boom-cylinder has 3, stick"),
        (("solve", "hydraulic-crane", "--speed", "5rpm"), "is not a valid speed"),
        (("catalog", "show", "nothing-like-it"), "the catalog has no such mechanism"),
        (("catalog", "nothing-like-it"), "no mechanism of the catalog has this word"),
        (("completion", "tcsh"), "'tcsh' is not one of"),
    ],
)  # fmt: skip
def test_mistakes_are_explained(run: Run, tmp_path: Path, args: tuple[str, ...], told: str) -> None:
    (tmp_path / "binary.toml").write_bytes(bytes(range(256)))
    (tmp_path / "empty.toml").write_text("")
    result = run(*args)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert told in result.stderr
    assert "Traceback" not in result.stderr


def test_all_problems_of_a_file_are_listed(run: Run, tmp_path: Path) -> None:
    (tmp_path / "bad.toml").write_text(
        FOUR_BAR.replace("[4, 0]", '["x", 0]').replace('link = "crank"', 'link = "crnk"')
    )
    error = run("report", "bad.toml").stderr
    assert error.startswith("Error: bad.toml")
    assert "links.frame.points.D" in error
    assert "remedy: did you mean 'crank'?" in error


def test_a_driver_without_a_range_asks_for_one(run: Run, tmp_path: Path) -> None:
    slide = '[links.block]\npoints = { Q = [0, 0] }\n[[slides]]\nlink = "block"\non = "frame"\nthrough = "A"\n'
    head = 'format = 1\ntitle = "Slide"\n[links.frame]\npoints = { A = [0, 0] }\n'
    (tmp_path / "slide.toml").write_text(head + slide + '[[drives]]\nlink = "block"\n')
    assert "has no values" in run("solve", "slide.toml").stderr
    assert "give all three" in run("solve", "slide.toml", "--to", "2").stderr
    found = rows(run("solve", "slide.toml", "--from", "0", "--to", "2", "--step", "1", "--output", "Q.x").stdout)
    assert numbers(found, "Q.x [length]").tolist() == [0.0, 1.0, 2.0]


def test_options_that_drive_need_a_driver(run: Run, tmp_path: Path) -> None:
    (tmp_path / "still.toml").write_text('format = 1\ntitle = "Still"\n[links.frame]\npoints = { A = [0, 0] }\n')
    assert "the mechanism has no driver" in run("solve", "still.toml", "--at", "2").stderr
    assert run("report", "still.toml").exit_code == 0


# --- the shell ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("error", "code", "told"),
    [
        (KeyboardInterrupt(), 130, "Interrupted.\n"),
        (MemoryError(), 2, "not enough memory"),
        (ck.errors.NotAssembled(Problem("here", "no pose", "draw it")), 3,
         "Error: no pose\n  where:  here\n  remedy: draw it\n"),
        (ck.errors.InvalidInput([Problem("a", "x"), Problem("b", "y")], "bad"), 2,
         "Error: bad\n  - x\n    where:  a\n  - y\n    where:  b\n"),
        (ck.errors.InvalidInput([Problem("a", "x"), Problem("b", "y")]), 2, "Error: 2 problems\n"),
    ],
)  # fmt: skip
def test_whatever_goes_wrong_has_a_message_and_a_code(
    error: BaseException, code: int, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail() -> None:
        raise error

    with pytest.raises(SystemExit) as end:
        shell.guarded(fail)
    assert end.value.code == code
    assert told in capsys.readouterr().err


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_colour_is_for_terminals_that_want_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm")
    assert shell.has_colour(Terminal())
    assert not shell.has_colour(io.StringIO())
    monkeypatch.setenv("NO_COLOR", "1")
    assert not shell.has_colour(Terminal())
    monkeypatch.delenv("NO_COLOR")
    monkeypatch.setenv("TERM", "dumb")
    assert not shell.has_colour(Terminal())


def test_what_is_no_text_does_not_go_to_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdout", Terminal())
    with pytest.raises(shell.NotWritten, match="write to a file with -o"):
        shell.put(b"PK\x03\x04\x00")


def test_long_work_is_told_on_a_terminal_and_wiped_away(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys
    import time

    from compoundkin.cli.shell import working

    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    with working("solving"):
        pass
    assert terminal.getvalue() == ""
    with working("solving", patience=0.0):
        time.sleep(0.05)
    assert terminal.getvalue().startswith("\rsolving ... 0 s")
    assert terminal.getvalue().endswith("\r")
