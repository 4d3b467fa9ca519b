"""`compoundkin set` and `changed_text`: one value changes, comments and layout stay, mistakes change nothing."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from click.testing import CliRunner

import compoundkin as ck
from compoundkin.cli import cli
from compoundkin.cli.new import starting_file
from compoundkin.files.mechanism_files import changed_text, loads
from compoundkin.files.shipped_mechanisms import resolve, shipped


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "mine.toml"
    path.write_text(starting_file(path))
    return path


def run(*args: object) -> tuple[int, str]:
    result = CliRunner().invoke(cli, [str(one) for one in args])
    return result.exit_code, result.output


def test_one_line_changes_and_all_comments_stay(file: Path) -> None:
    before = file.read_text().splitlines()
    assert run("set", file, "crank.B.x=22.5")[0] == 0
    after = file.read_text().splitlines()
    changed = [(one, other) for one, other in zip(before, after, strict=True) if one != other]
    assert changed == [("points = { A = [0, 0], B = [25, 0] }", "points = { A = [0, 0], B = [22.5, 0] }")]
    assert ck.load(file).links["crank"].points["B"] == 22.5


def test_equal_numbers_are_told_apart(file: Path) -> None:
    """B of the crank and B of the drawing have one value; so have many zeros."""
    run("set", file, "rocker.D.y=0.5", "drawn.B.x=24")
    made = ck.load(file)
    assert made.links["rocker"].points["D"] == 0.5j
    assert made.links["crank"].points["B"] == 25
    assert made.sketch["B"] == 24


def test_numbers_stand_as_they_are_given(file: Path) -> None:
    """In a text from Windows too, without an end of its last line."""
    before = file.read_text().rstrip().replace("\n", "\r\n")
    file.write_bytes(before.encode())
    assert run("set", file, "crank.B.x=22.50", "drawn.B.x=2.4e1", "drawn.B.y=1")[0] == 0
    after = file.read_bytes().decode()
    assert after == before.replace(", B = [25, 0]", ", B = [22.50, 0]").replace("\nB = [25, 0]", "\nB = [2.4e1, 1]")


def test_text_driver_and_polar_point(file: Path) -> None:
    file.write_text(file.read_text().replace("P = [35, 30]", "P = { polar = [46, 40] }"))
    assert run("set", file, 'title=Of "mine"', "crank.speed=10", "coupler.P.angle=41")[0] == 0
    made = ck.load(file)
    assert made.title == 'Of "mine"'
    assert made.drives[0].speed == 10
    assert made.links["coupler"].points["P"] == pytest.approx(46 * (0.754709580222772 + 0.6560590289905073j))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("crank.C.x=3", "did you mean 'crank.B.x'"),
        ("crank.B.x=long", "is not a number"),
        ("crank.B.x=nan", "is not a number"),
        ("crank.B.x", "this is no change"),
        ("crank.link=rot", "rot"),
        ("format=9", "format"),
    ],
)
def test_mistakes_leave_the_file_as_it_was(file: Path, change: str, said: str) -> None:
    before = file.read_bytes()
    code, output = run("set", file, "frame.D.x=81", change)
    assert code != 0
    assert said in output
    assert file.read_bytes() == before
    assert list(file.parent.iterdir()) == [file]


@pytest.mark.parametrize("name", ["six-bar", "hydraulic-crane", "planetary-train", "toggle-press-loaded"])
def test_shipped_files_keep_everything_else(name: str) -> None:
    assert name in shipped()
    text = Path(resolve(name)).read_text(encoding="utf-8")
    new = changed_text(text, {"title": "Another"})
    assert new.count("\n") == text.count("\n")
    assert loads(new) == ck.load(name).replace(title="Another")


def test_without_takes_what_hangs_on_a_link() -> None:
    bar = ck.linkages.four_bar(60, 20, 50, 40)
    arm = ck.link("arm", C=0, E=15), ck.drive("arm", on="rocker"), ck.outline("arm", 2.0)
    assert bar.replace(*arm).without("arm") == bar
    with pytest.raises(ck.errors.UnknownName, match="rocker"):
        bar.without("roker")
    with pytest.raises(ck.errors.InvalidMechanism):
        bar.without("frame")


def test_a_pin_is_swapped_for_a_slide_in_one_call() -> None:
    bar = ck.linkages.four_bar(60, 20, 50, 40)
    guided = bar.replace(ck.slide("rocker", on="frame", through="D", angle=0.1), without="rocker.D")
    assert sorted(guided.pins) == ["A", "B", "C"]
    assert not ck.decompose(guided).faults


def test_dimensions_by_name() -> None:
    bar = ck.linkages.four_bar(60, 20, 50, 40)
    same = ck.linkages.four_bar(60, 22, 50, 45)
    made = ck.with_dimensions(bar, {"crank.B.x": 22, "rocker.C.x": 45})
    by_name = ck.solve(made, {"crank": 1.0}).links["rocker"].angle
    assert by_name == pytest.approx(ck.solve(same, {"crank": 1.0}).links["rocker"].angle)
    with pytest.raises(ck.errors.UnknownName, match=r"crank\.B"):
        ck.with_dimensions(bar, {"crank.X": 22})
    published = ck.load("crank-rocker")
    assert not ck.with_dimensions(published, {"crank.B.x": 2.1}).expectations


def test_problems_of_a_file_have_line_column_and_nearest_word(file: Path) -> None:
    text = file.read_text().replace('link = "crank"', 'link = "crnk"')
    file.write_text(text.replace("B = [25, 0] }", 'B = [25, "a"] }'))
    with pytest.raises(ck.errors.InvalidMechanism) as told:
        ck.load(file)
    lines = file.read_text().splitlines()
    for problem in told.value.problems:
        name, line, column = re.fullmatch(r"(\S+) \(line (\d+), column (\d+)\)", problem.where).groups()  # type: ignore[union-attr]
        assert lines[int(line) - 1][int(column) - 1 :].startswith(re.sub(r"\W", "", name.rpartition(".")[2]))
    assert any(one.remedy == "did you mean 'crank'?" for one in told.value.problems)
    assert run("report", file)[0] != 0


def test_one_line_tells_of_the_schema(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file.write_text(file.read_text().replace("values =", "valeus ="))
    with pytest.raises(SystemExit):
        cli.main(["report", str(file)], standalone_mode=True)
    told = capsys.readouterr().err
    assert told.count("#:schema") == 1
    assert "drives[0].valeus (line 28, column 1)" in told
