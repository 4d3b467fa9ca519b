"""What a newcomer types first, and what is said to it: words of other books, programs and countries."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

import compoundkin as ck
from compoundkin.base.errors import OTHER_WORDS, ExplainsAttributes, nearest
from compoundkin.cli import VERBS, cli
from compoundkin.dimensional.task_words import KEYS, read_task
from compoundkin.files import loads

FOUR_BAR = "four-bar:60,20,50,40"
SLIDER_CRANK = "slider-crank:50,200"

Run = Callable[..., Result]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Run a command in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    return lambda *args: CliRunner().invoke(cli, list(args), catch_exceptions=False)


@pytest.mark.parametrize(
    ("said", "meant"),
    [
        *[(word, "animate") for word in ("film", "video", "movie")],
        *[(word, "exercise") for word in ("handout", "worksheet", "exercises")],
        *[("torque", "forces"), ("motor", "size"), ("dynamics", "simulate"), ("list", "catalog"), ("sweep", "study")],
        *[("validate", "check"), ("montecarlo", "tolerance"), ("convert", "import"), ("synthesis", "synthesise")],
    ],
)  # fmt: skip
def test_a_verb_that_others_have_leads_to_ours(run: Run, said: str, meant: str) -> None:
    result = run(said, "six-bar")
    assert result.exit_code == 2
    assert f"'{meant}'" in result.stderr.partition("did you mean")[2]


def test_every_word_of_others_leads_to_a_word_that_there_is() -> None:
    from compoundkin.files.shipped_mechanisms import shipped
    from compoundkin.synthesis.linkages import KINDS

    lost = [other for other, ours in OTHER_WORDS.items() if not ours or other != other.lower()]
    assert not lost
    verbs = {word for ours in OTHER_WORDS.values() for word in ours if word in VERBS}
    assert {"animate", "exercise", "forces", "size", "study", "tolerance"} <= verbs
    named = {*KINDS, *shipped()}
    assert {one for ours in OTHER_WORDS.values() for one in ours if "-" in one} <= named


@pytest.mark.parametrize("verb", ["synthesize", "optimize", "centers"])
def test_verbs_in_american_spelling_are_the_same(run: Run, verb: str) -> None:
    assert run(verb, "--help").exit_code == 0


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (("plot", FOUR_BAR, "transmission angle"), "'coupler.transmission_angle' or 'rocker.transmission_angle'"),
        (("plot", FOUR_BAR, "mu"), "'rocker.transmission_angle'"),
        (("plot", FOUR_BAR, "C.transmission_angle"), "'coupler.transmission_angle' or 'rocker.transmission_angle'"),
        (("plot", FOUR_BAR, "rocker.transmission"), "'rocker.transmission_angle'"),
        (("solve", FOUR_BAR, "--output", "rocker.omega"), "'rocker.angular_velocity'"),
        (("solve", FOUR_BAR, "--output", "rocker.velocity"), "'rocker.angular_velocity'"),
        (("solve", FOUR_BAR, "--output", "C.angular_velocity"), "'coupler.angular_velocity'"),
        (("solve", SLIDER_CRANK, "--output", "slider.position"), "'B.position'"),
        (("solve", SLIDER_CRANK, "--output", "slider.displacement"), "'stroke.displacement'"),
        (("solve", SLIDER_CRANK, "--output", "stroke.velocity"), "'stroke.rate'"),
        (("solve", SLIDER_CRANK, "--output", "velocity"), "'A.velocity' or 'B.velocity'"),
        (("forces", "engine-gas-pressure", "--output", "torque"), "'crank.effort'"),
        (("forces", "engine-gas-pressure", "--output", "crank.torque"), "'crank.effort'"),
        (("plot", "hydraulic-crane", "ram.effort", "--load", "T=0,-9e3"), "'rod.effort'"),
        (("forces", SLIDER_CRANK, "--units", "mm,kg,N", "--load", "slider=-9,0"), "its points are B"),
        (("forces", SLIDER_CRANK, "--force", "B=-9,0"), "Did you mean '--load'?"),
        (("size", SLIDER_CRANK), "give --units mm,kg,N"),
        (("solve", FOUR_BAR, "--rpm", "100"), "Did you mean '--speed'?"),
        (("solve", FOUR_BAR, "--angle", "60"), "Did you mean '--at'?"),
        (("animate", FOUR_BAR, "--trace", "C"), "Did you mean '--path'?"),
        (("solve", FOUR_BAR, "--equations"), "It is an option of report, open, structure."),
        (("animate", FOUR_BAR, "a.gif"), "named by -o a.gif"),
        (("animate", FOUR_BAR, "-o", "a.pptx"), ".mp4 and .gif are what slides"),
        (("report", FOUR_BAR, "-o", "a.pdf"), "printed as PDF by any browser"),
        (("report", "four-bar"), "four-bar:ground=60 crank=20 coupler=50 rocker=40"),
        (("report", "fourbar"), "a linkage takes its lengths"),
        (("report", "hoist"), "hydraulic-crane"),
        (("report", "press"), "geared-press, toggle-press, toggle-press-loaded, wedge-press"),
        (("catalog", "show", "crane"), "in the catalog: hydraulic-crane"),
        (("new", "class-iii-six-bar"), "compoundkin new mine.toml --from class-iii-six-bar"),
        (("new", "triad"), "compoundkin new mine.toml --from class-iii-six-bar"),
        (("synthesise", "six-bar"), "compoundkin new task writes one"),
        (("tolerance", FOUR_BAR, "--tolerance", "AB=0.1"), "did you mean 'crank.B.x'?"),
        (("tolerance", FOUR_BAR, "--tolerance", "rocker=0.1"), "did you mean 'rocker.C.x'?"),
        (("export", "six-bar", "-o", "a.pmks"), "give --to pmks"),
        (("export", "six-bar", "--to", "solidworks"), "did you mean 'dxf'?"),
        (("study", FOUR_BAR), "--free crank.B.x="),
    ],
)
def test_what_is_meant_is_said(run: Run, args: tuple[str, ...], said: str) -> None:
    result = run(*args)
    assert result.exit_code == 2
    assert said in " ".join(result.stderr.split())
    assert "Traceback" not in result.stderr


def test_a_pin_is_no_value_to_set(run: Run) -> None:
    Path("mine.toml").write_text(MINE)
    assert "take A out of crank's points" in run("set", "mine.toml", "A=slide").stderr


def test_a_shipped_mechanism_is_one_to_start_from(run: Run) -> None:
    assert run("new", "mine.toml", "--from", "hydraulic-crane").exit_code == 0
    assert ck.load("mine.toml") == ck.load("hydraulic-crane")
    assert "in the catalog: hydraulic-crane" in run("new", "other.toml", "--from", "crane").stderr
    assert not Path("other.toml").exists()


def test_words_of_the_catalog_are_found(run: Run) -> None:
    assert run("catalog", "list", "crane").stdout.split()[0] == "hydraulic-crane"
    assert run("catalog", "find", "crane").stdout == run("catalog", "crane").stdout
    assert run("catalog", "list", "cylinder").stdout.count("\n") == 3


def test_degrees_may_be_written_and_places_stand_in_the_order_of_a_list(run: Run) -> None:
    plain, worded = (run("solve", FOUR_BAR, "--at", text, "--output", "rocker.angle") for text in ("60", "60deg"))
    assert plain.stdout == worded.stdout
    assert run("structure", "toggle:20,100,60,60,110,55").stdout == run(
        "structure", "toggle:crank=20 rod=100 upper=60 lower=60 pivot=110,55"
    ).stdout  # fmt: skip


def test_percentiles_are_those_asked_for(run: Run) -> None:
    words = ("tolerance", FOUR_BAR, "--tolerance", "crank.B.x=\u00b10.05", "--output", "rocker.angle.stroke")
    result = run(*words, "--percentile", "5,95", "--count", "512")
    rows = [line.split() for line in result.stdout.splitlines() if line.startswith("rocker.angle.stroke  °         - ")]
    low, high = (float(row[4]) for row in rows if row[3] in ("5", "95"))
    deviation = float(rows[0][-1])
    assert high - low == pytest.approx(2 * 1.645 * deviation, rel=0.1)  # of a normal distribution


def test_the_torque_of_a_motor_is_plotted_from_lengths_and_a_load(run: Run, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    picture = tmp_path / "torque.svg"
    load = ("--load", "B=-1000,0", "--units", "mm,kg,N")
    assert run("plot", SLIDER_CRANK, "crank.effort", *load, "--step", "30", "-o", str(picture)).exit_code == 0
    assert "N mm" in run("forces", SLIDER_CRANK, *load, "--output", "crank.effort", "--at", "30").stdout
    assert picture.stat().st_size > 1000


def test_a_report_has_the_equations_in_numbers(run: Run) -> None:
    plain = run("report", FOUR_BAR, "--at", "60").stdout
    worked = run("report", FOUR_BAR, "--at", "60", "--equations").stdout
    own = run("structure", FOUR_BAR, "--equations", "--order", "2", "--at", "60").stdout
    added = [line for line in worked.splitlines() if line not in plain.splitlines()]
    assert len(added) > 20
    assert {*added} <= {*own.splitlines()}


def test_a_study_of_a_linkage_needs_no_file(run: Run) -> None:
    """The stroke of a four-bar whose crank is between two lengths lies between those of the ends."""
    words = ("study", FOUR_BAR, "--free", "crank.B.x=18:22", "--output", "rocker.angle.stroke", "--count", "64")
    result = run(*words, "--format", "json", "--seed", "3")
    assert result.exit_code == 0
    strokes = []
    for crank in (18, 22):
        ends = [np.arccos((40**2 + 60**2 - (50 + side * crank) ** 2) / (2 * 40 * 60)) for side in (1, -1)]
        strokes.append(np.degrees(ends[0] - ends[1]))
    assert "64 designs" in result.stdout
    rows = [line.split() for line in run(*words, "--seed", "3").stdout.splitlines() if line.startswith("rocker.angle")]
    numbers = [float(one) for row in rows for one in row[1:] if one != "°"]
    assert len(numbers) == 7
    assert abs(strokes[0]) - 0.01 <= min(numbers) <= max(numbers) <= abs(strokes[1]) + 0.01


def test_files_of_studies_and_tasks_are_written_to_start_from(run: Run) -> None:
    assert "compute it with: compoundkin study study.toml" in run("new", "study").stderr
    assert run("study", "study.toml").exit_code == 0
    assert run("new", "study").exit_code == 2  # it is there already
    assert "compute it with: compoundkin synthesise mine.toml" in run("new", "task", "-o", "mine.toml").stderr
    task, conditions = read_task(tomllib.loads(Path("mine.toml").read_text()))
    assert task.in_words == "plate through 3 poses"
    assert conditions == {"transmission": pytest.approx(np.deg2rad(10))}


MINE = """\
format = 1
title = "Mine"
[links.frame]
points = { A = [0, 0], D = [60, 0] }
[links.crank]
points = { A = [0, 0], B = [20, 0] }
[[drives]]
link = "crank"
"""


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("points = { A = [0, 0], B = [20, 0] }", "length = 20", "is a bar of length 20"),
        ('title = "Mine"', 'title = "Mine', "begins and ends with a quotation mark in one line"),
        ("[0, 0], B", "[0; 0], B", "a list has commas between its values"),
        ("[20, 0]", "[20,5, 0]", "decimals have a point, no comma"),
        ("[[drives]]", "[[drivers]]", "did you mean 'drives'?"),
        ("[links.crank]", "[links]\ncrank = ['A', 'B']\n[links.other]", "write crank.points = [...]"),
        ("[[drives]]", "[points]\nB = [0, 20]\n[[drives]]", "did you mean 'drawn'?"),
    ],
)
def test_a_wrong_file_is_mended_where_it_is_wrong(old: str, new: str, said: str) -> None:
    assert old in MINE
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        loads(MINE.replace(old, new, 1), where="mine.toml")
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("name", "meant"),
    [("crank", "crank.B.x"), ("crank.length", "crank.B.x"), ("crank.B", "crank.B.x"), ("D", "frame.D.x")],
)
def test_a_length_is_set_by_the_coordinate_that_holds_it(run: Run, tmp_path: Path, name: str, meant: str) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(MINE)
    result = run("set", str(file), f"{name}=22")
    assert result.exit_code == 2
    assert f"did you mean '{meant}'?" in result.stderr
    assert file.read_text() == MINE


def test_files_of_other_kinds_say_which_verb_takes_them(run: Run, tmp_path: Path) -> None:
    task, mine, text = tmp_path / "task.toml", tmp_path / "mine.toml", tmp_path / "mine.txt"
    task.write_text('format = 1\ntask = "swing"\nangle = 40\n')
    mine.write_text(MINE)
    text.write_text("# my crank\n" + MINE)
    assert "compoundkin synthesise" in run("report", str(task)).stderr
    assert "a study file names it" in run("study", str(mine)).stderr
    assert "this is a mechanism file, no task file" in run("synthesise", str(mine)).stderr
    assert "a name that ends in .toml or .json" in run("report", str(text)).stderr


def linkage() -> Any:
    return ck.linkages.four_bar(60, 20, 50, 40)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: ck.four_bar, "did you mean compoundkin.linkages.four_bar?"),
        (lambda: ck.FourBar, "did you mean compoundkin.linkages.four_bar?"),
        (lambda: ck.solve(linkage(), 1.0, omega=10), "did you mean 'speed'?"),
        (lambda: ck.solve(linkage(), 1.0, speed="100 rpm"), "100 * 2 * math.pi / 60"),
        (lambda: ck.solve(linkage()).rocker, "motion.links['rocker']"),
        (lambda: ck.solve(linkage()).transmission_angle, "compoundkin.quantity(motion, 'coupler.transmission_angle'"),
        (lambda: ck.solve(linkage()).links.rocker, "['rocker']"),
        (lambda: ck.solve(linkage()).links["rocker"].omega, "did you mean 'angular_velocity'?"),
        (lambda: ck.solve(linkage()).links["rocker"].transmission_angle, "(motion, 'rocker.transmission_angle')"),
        (lambda: ck.solve(linkage()).to_dataframe, "did you mean 'to_pandas'?"),
        (lambda: ck.solve(linkage()).to_csv, "compoundkin.save(motion"),
        (lambda: ck.characteristics(ck.solve(linkage())).transmission_angle, "did you mean 'groups'?"),
        (lambda: linkage().without("D"), "D is a point of links: frame.D or rocker.D"),
        (
            lambda: linkage().replace("D", ck.slide("rocker", on="frame", through="D")),
            "D is a point of links: frame.D or rocker.D",
        ),
        (lambda: ck.link("crank", "A", "B", length=20), 'write link("crank", A=0, B=20)'),
        (lambda: ck.bar, "compoundkin.link?"),
        (
            lambda: ck.tolerance(linkage(), {"crank.B": 0.1}, "rocker.angle.stroke")["rocker.angle.stroke"].percentile,
            "percentiles=(5, 95)",
        ),
        (lambda: linkage().draw, "compoundkin.draw(mechanism)"),
        (lambda: linkage().solve, "compoundkin.solve(mechanism)"),
        (lambda: ck.load(FOUR_BAR), "compoundkin.linkages.four_bar(60,20,50,40)"),
        (lambda: ck.linkages.four_bar(60, 20, 50), "rocker is missing"),
        (lambda: ck.linkages.four_bar(60, 20, 50, 40, coupler_point=(1, 2)), "did you mean 'point'?"),
        (lambda: ck.link("crank", AB=20), 'write link("crank", A=0, B=20)'),
        (lambda: ck.study(linkage(), {"crank.B.x": (19, 21)}, 1000), "how many there are is count=1000"),  # type: ignore[arg-type]
        (lambda: ck.solve(linkage())["roker"], "did you mean 'rocker'?"),
        (lambda: ck.linkages.four_bar(60, np.linspace(15, 20, 9), 50, 40), "with_dimensions(linkage"),
    ],
)
def test_python_says_what_is_meant(call: Any, said: str) -> None:
    with pytest.raises((AttributeError, TypeError, ck.errors.CompoundkinError)) as caught:
        call()
    assert said in str(caught.value)


def test_the_ways_that_are_named_lead_there() -> None:
    lengths = np.linspace(15, 20, 9)[:, None]
    many = ck.with_dimensions(linkage(), {"crank.B.x": lengths})
    assert ck.solve(many).shape == (9, 73)
    assert nearest("Four bar", ["four-bar", "five-bar"]) == ["four-bar"]


def test_a_property_that_fails_keeps_its_own_error() -> None:
    class Broken(ExplainsAttributes):
        @property
        def value(self) -> int:
            raise AttributeError("inside")

    with pytest.raises(AttributeError, match="inside"):
        Broken().value  # noqa: B018


def test_a_motion_is_asked_by_any_name() -> None:
    motion = ck.solve(linkage())
    np.testing.assert_array_equal(motion["rocker"].angle, motion.links["rocker"].angle)
    np.testing.assert_array_equal(motion["C"].velocity, motion.points["C"].velocity)
    np.testing.assert_array_equal(motion["rocker.angular_velocity"], motion.links["rocker"].angular_velocity)
    with pytest.raises(TypeError, match="not iterable"):
        iter(motion)  # type: ignore[call-overload]


def test_a_new_task_names_all_kinds_and_shows_a_curve(run: Run, tmp_path: Path) -> None:
    assert run("new", "task", "-o", "task.toml").exit_code == 0
    rest = (tmp_path / "task.toml").read_text().splitlines()
    kinds = next(line for line in rest if line.startswith("task = "))
    assert all(word in kinds for word in KEYS)
    begin = next(k for k, line in enumerate(rest) if 'task = "curve"' in line)
    shown = "\n".join(line.removeprefix("#").strip() for line in rest[begin : begin + 4])
    assert read_task(tomllib.loads(f"format = 1\n{shown}"))[0].in_words == "a point along a closed curve of 8 points"


UNREACHED = """format = 1
title = "Zu weit ü"
[links.frame]
points = {{ A = [0, 0], D = [1000, 0] }}
[links."Kurbel ü"]
points = {{ A = [0, 0], B = [{crank}, 0] }}
[links.koppel]
points = {{ B = [0, 0], C = [20, 0] }}
[links.schwinge]
points = {{ C = [0, 0], D = [15, 0] }}
[[drives]]
link = "Kurbel ü"
"""


@pytest.mark.parametrize(
    ("words", "said"),
    [
        # what cannot be drawn says why by the lengths
        (("draw", "far.toml", "-o", "x.svg"), "|BD| = 1010 > |BC| + |CD| = 20 + 15"),
        # the one thing that is wrong, and not what looks equal beside it
        (("report", "huge.toml"), "1 problem\n  - (1e+200+0j) is too far away"),
        (("solve", "four-bar:1e300,20,50,40"), "the others together, 110"),
        (("new", "nowhere/x.toml"), "there is no folder nowhere"),
        (("draw", "six-bar", "-o", "folder.svg"), "this is a folder"),
        (("tolerance", "six-bar"), "--tolerance, --clearance\n  remedy: write NAME=0.05"),
    ],
)
def test_an_impossible_wish_is_refused_by_its_cause(run: Run, words: tuple[str, ...], said: str) -> None:
    Path("folder.svg").mkdir()
    for name, crank in (("far", "10"), ("huge", "1e200")):
        Path(f"{name}.toml").write_text(UNREACHED.format(crank=crank), encoding="utf-8")
    result = run(*words)
    assert result.exit_code in (2, 3)
    assert said in result.stderr
    assert not Path("x.svg").exists()


@pytest.mark.parametrize(
    ("words", "begins"),
    [
        (("task",), "# A task of synthesis."),
        (("study",), "# A study"),
        (("four-bar", "60", "20", "50", "40"), "# Four-bar"),
    ],
)
def test_a_new_file_may_be_named_last(run: Run, words: tuple[str, ...], begins: str) -> None:
    result = run("new", *words, "mine.toml")
    assert (result.exit_code, result.stderr.splitlines()[:-1]) == (0, [])
    assert Path("mine.toml").read_text(encoding="utf-8").startswith(begins)


def test_numbers_that_are_all_whole_do_not_look_like_degrees(run: Run) -> None:
    result = run("solve", FOUR_BAR, "--at", "1e18")
    assert (result.exit_code, result.stderr) == (0, "")
