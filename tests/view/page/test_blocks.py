"""Pages as text: well formed, complete, the same every time, with nothing taken for markup."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Callable
from dataclasses import replace
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

import compoundkin as ck
from compoundkin.cli import cli
from compoundkin.files import load
from compoundkin.model.attributes import typeset_unit
from compoundkin.view.page.html_document import ASSETS, asset
from compoundkin.view.page.html_tables import names_of
from compoundkin.view.page.report_page import Page
from compoundkin.view.report import Report, page, report
from compoundkin.view.report.atlas_sections import atlas_report
from compoundkin.view.report.report_data import Column, Outcome, Section, TableBlock
from compoundkin.view.report.wording import column_texts, typeset
from tests import catalog

from .conftest import HOSTILE

# Elements that have no end. Source: HTML Living Standard, 13.1.2.
VOID = {"meta", "link", "br", "wbr", "input", "img", "hr"}


def test_tables_and_the_sketch_are_read_out_in_words() -> None:
    html = page(catalog.motion("six-bar")).html
    assert 'aria-label="Table: Links"' in html
    assert "Moving kinematic sketch of" in html
    assert "TableBlock" not in html
    assert "MotionData" not in html


class Reader(HTMLParser):
    """Reads a page, and holds it to be well formed: every element is ended in its turn."""

    def __init__(self, html: str) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[str] = []
        self.ids: list[str] = []
        self.headings: list[int] = []
        self.scripts = 0
        self.tables: dict[str, list[list[str]]] = {}
        self._table = ""
        self._text: list[str] = []
        self.words: list[str] = []
        self.labels: list[str] = []
        self.feed(html)
        self.close()
        assert not self.open, f"not ended: {self.open}"

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        told = dict(attrs)
        assert len(told) == len(attrs), f"an attribute of {tag} is given twice"
        if tag not in VOID:
            self.open.append(tag)
        if told.get("id"):
            self.ids.append(str(told["id"]))
        self.labels += [str(told[name]) for name in ("aria-labelledby", "aria-controls") if name in told]
        self.scripts += tag == "script"
        if re.fullmatch("h[1-6]", tag):
            self.headings.append(int(tag[1]))
        if tag == "table" and "sortable" in str(told.get("class")):
            self._table = str(told["id"])
            self.tables[self._table] = []
        elif tag == "tr" and self._table:
            self.tables[self._table].append([])
        elif tag in ("td", "th") and self._table:
            self._text = []

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """SVG has elements that end at once."""
        assert len(dict(attrs)) == len(attrs)

    def handle_endtag(self, tag: str) -> None:
        assert self.open
        assert self.open.pop() == tag
        if tag in ("td", "th") and self._table:
            self.tables[self._table][-1].append(" ".join("".join(self._text).split()))
        elif tag == "table":
            self._table = ""

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] not in ("script", "style"):
            self.words.append(data)
        self._text.append(data)

    @property
    def text(self) -> str:
        """All words of the page, between single spaces."""
        return " ".join("".join(self.words).split())


@pytest.fixture(scope="module")
def six_bar() -> tuple[Report, str]:
    motion = catalog.motion("six-bar")
    return report(motion), page(motion).html


def random_structure() -> ck.results.Structure:
    return ck.decompose(ck.chains.random_mechanism(groups=19, seed=7))


def made_of(name: str) -> tuple[Report, str]:
    if name == "random":
        structure = random_structure()
        return report(structure), page(structure).html
    motion = catalog.motion(name)
    return report(motion), page(motion).html


@pytest.mark.parametrize("name", ["six-bar", "jansen-leg", "stephenson-iii", "planetary-train", "random"])
def test_it_is_well_formed_and_holds_every_word_and_number_of_the_report(name: str) -> None:
    made, html = made_of(name)
    reader = Reader(html)
    assert len(set(reader.ids)) == len(reader.ids)
    assert set(reader.labels) <= set(reader.ids)
    assert reader.headings[0] == 1
    assert reader.headings.count(1) == 1
    assert all(after - before <= 1 for before, after in pairwise(reader.headings))
    for section in made.sections:
        assert section.title in reader.text
        tables = [block for block in section.blocks if isinstance(block, TableBlock)]
        for k, table in enumerate(tables, 1):
            rows = reader.tables[f"{section.key}-table-{k}"][1:]
            whole = section.key == "outputs" and k == 1
            _holds(table, rows, whole)


def _holds(table: TableBlock, rows: list[list[str]], whole: bool) -> None:
    """The rows are those of the table; with poses between them where it has only every third or so."""
    assert len(rows) >= len(table.rows) if whole else len(rows) == len(table.rows)
    for k, column in enumerate(table.columns):
        wanted = column_texts(column, [row[k] for row in table.rows], "\n")
        shown = [row[k].removeprefix("✓ ").removeprefix("✗ ") for row in rows]
        if whole:
            # more rows may have more digits: the numbers are the same
            assert {_number(text) for text in wanted} <= {_number(text) for text in shown}
        else:
            # the page raises the powers of units, and has the signs of degrees and minus
            signed = ["°" if text == "deg" else typeset_unit(typeset(text)) for text in wanted]
            assert shown == [" ".join(text.replace("\n", "").split()) for text in signed]


def _number(text: str) -> float | str:
    try:
        return float(f"{float(text.replace('−', '-')):.3g}")
    except ValueError:
        return text


def test_all_paragraphs_steps_and_formulas_are_there(six_bar: tuple[Report, str]) -> None:
    made, html = six_bar
    text = Reader(html).text
    for section in made.sections:
        for block in section.blocks:
            # what badges say is not said again
            told = [getattr(block, "text", "").removesuffix(getattr(block, "badged", "")), getattr(block, "title", "")]
            told += [part for fact in getattr(block, "facts", ()) for part in fact]
            assert all(" ".join(typeset(part).split()) in text for part in told)


def test_the_same_motion_gives_the_same_page(six_bar: tuple[Report, str]) -> None:
    again = page(ck.solve(load("six-bar"))).html
    assert again == six_bar[1]
    assert len(again.encode()) < 1_000_000


def test_a_full_turn_in_degrees_is_below_a_megabyte_and_more_poses_are_not_all_written() -> None:
    six_bar = load("six-bar")
    whole = page(ck.solve(six_bar, {"crank": ck.deg(range(361))}, speed=10.0)).html
    assert len(whole.encode()) < 1_000_000
    assert "Show all 361 rows" in whole
    many = page(ck.solve(six_bar, {"crank": ck.deg([k / 5.0 for k in range(1801)])}, speed=10.0)).html
    assert len(many.encode()) < 2_000_000
    assert not re.search("Show all 1,?801 rows", many)
    poses = re.findall(r'data-pose="(\d+)"', many)
    # 24 steps of 75 poses each
    assert poses[:2] == ["0", "75"]
    assert poses[-1] == "1800"


def test_it_asks_for_nothing_from_anywhere(six_bar: tuple[Report, str]) -> None:
    html = six_bar[1]
    assert "default-src 'none'" in html
    addresses = re.findall(r"""(?:src|href|url|action|data)\s*[=(]\s*["']?(?!#|data:)([^"'\s>)]+)""", _markup(html))
    assert not addresses
    assert "@import" not in html


def _markup(html: str) -> str:
    return re.sub(r"<(script|style)[^>]*>.*?</\1>", "", html, flags=re.DOTALL)


def test_all_poses_of_the_outputs_are_there_and_those_of_the_report_shown(six_bar: tuple[Report, str]) -> None:
    made, html = six_bar
    section = made.section("outputs")
    assert section is not None
    table = next(block for block in section.blocks if isinstance(block, TableBlock))
    body = html[html.index('id="outputs-table-1"') :]
    body = body[: body.index("</table>")]
    rows = re.findall(r'<tr( class="more")? data-pose="(\d+)" data-n=', body)
    assert [int(pose) for _, pose in rows] == list(range(73))
    assert sum(not folded for folded, _ in rows) == len(table.rows) == 25
    assert "Show all 73 rows" in html


def test_numbers_are_sorted_and_copied_with_every_digit() -> None:
    value = 1.0 / 3.0
    columns = Column("name"), Column("x", "mm", "each"), Column("v", style="each"), Column("", style="passed")
    rows = ("a", value, (1.25, -2.0 / 3.0), True), ("b", None, (float("nan"),), False), ("c", 1e-20, (0.5,), None)
    section = Section("s", "S", (TableBlock(columns, rows),))
    html = Report("R", (section,), Outcome(True)).html()
    assert f'data-sort="{value!r}">0.333333<' in html
    assert f'data-copy="1.25, {-2.0 / 3.0!r}">1.25<br>−0.666667<' in html
    assert '<td class="number" data-sort="">-</td>' in html
    assert "✓</span> pass" in html
    assert "✗</span> FAIL" in html


def test_rounding_below_the_floor_of_a_column_is_zero_in_copies_too() -> None:
    table = TableBlock((Column("x", style="fixed", floor=1e-9),), ((1e-12,), (2.5,)))
    html = Report("R", (Section("s", "S", (table,)),), Outcome(True)).html()
    assert "1e-12" not in html
    assert re.search(r'<td class="number" data-sort="0">0\.0</td>', html)


def test_names_tell_the_links_they_are_about() -> None:
    names = names_of(catalog.structure("six-bar"))
    assert names.about("bar") == ("bar",)
    assert names.about("slot") == names.about("slot.value") == ("block", "bar") or names.about("slot") == (
        "bar",
        "block",
    )
    assert names.about("G.velocity.x") == names.about("|G.velocity|") == ("bar",)
    assert set(names.about("E")) == {"frame", "crank"}
    assert names.about("(crank bar)") == ("crank", "bar")
    assert names.about("frame -E- crank -D- plate -A- rocker -B- frame") == ("frame", "crank", "plate", "rocker")
    assert names.about("closure") == ()
    assert names.members == (("frame", "crank"), ("plate", "rocker"), ("bar", "block"))


def test_nothing_a_user_writes_is_taken_for_markup(hostile: ck.Mechanism) -> None:
    html = page(ck.solve(hostile)).html
    reader, plain = Reader(html), Reader(page(catalog.motion("crank-rocker")).html)
    assert reader.scripts == plain.scripts
    assert "<script>hacked" not in html
    assert "<img" not in html
    for word in ("Title", "Description", "Source", "crank"):
        assert f"{word} {HOSTILE}" in reader.text


@pytest.mark.parametrize("kind", ["faults", "bare", "atlas"])
def test_reports_without_a_motion_make_pages_too(kind: str) -> None:
    parts = ck.link("frame", A=0, D=4), ck.link("a", A=0, B=1), ck.link("b", B=0, C=3), ck.link("c", D=0, C=3)
    structure = ck.decompose(ck.Mechanism("Undriven", *parts))
    bare = replace(report(structure), subject=None)
    made = {"faults": report(structure), "bare": bare, "atlas": atlas_report(6)}[kind]
    html = made.html()
    reader = Reader(html)
    assert made.title in reader.text
    if kind == "faults":
        assert "cannot be solved" in reader.text
        assert "Remedy:" in reader.text
        assert "<svg" in html


def test_it_is_saved_whole_and_opened_from_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    monkeypatch.setattr("webbrowser.open", lambda address: bool(asked.append(address)) or True)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    one = Page("<!DOCTYPE html>\n<title>é</title>\n")
    one.save(tmp_path / "a.html")
    assert (tmp_path / "a.html").read_text(encoding="utf-8") == one.html
    path = one.open()
    assert path.read_text(encoding="utf-8") == one.html
    assert asked == [path.as_uri()]


def test_libraries_are_as_they_were_released() -> None:
    listed = re.findall(r"^\| `([^`]+)` .*\| `([0-9a-f]{64})` \|$", asset("vendor/VERSIONS.md"), re.MULTILINE)
    vendor = ASSETS / "vendor"
    assert {name for name, _ in listed} == {path.name for path in vendor.iterdir()} - {"VERSIONS.md"}
    for name, digest in listed:
        assert hashlib.sha256((vendor / name).read_bytes()).hexdigest() == digest, name


def test_no_script_or_style_can_end_its_element() -> None:
    for path in ASSETS.rglob("*.*s"):
        text = path.read_text(encoding="utf-8").lower()
        assert "</script" not in text
        assert "</style" not in text
        assert "<!--" not in text


Verb = Callable[..., Any]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Verb:
    from click.testing import CliRunner

    from compoundkin.cli import cli

    monkeypatch.chdir(tmp_path)
    return lambda *arguments: CliRunner().invoke(cli, list(arguments), catch_exceptions=False)


@pytest.mark.parametrize(
    ("verb", "title"),
    [
        (("report", "six-bar"), "Checks"),
        (("structure", "six-bar", "--equations"), "Vector-loop equations"),
        (("check", "crank-rocker"), "Checks"),
        (("centres", "crank-rocker", "--derivation"), "Derivation of the centres"),
        (("circuits", "triple-rocker"), "Circuits"),
        (("configurations", "crank-rocker"), "Configurations"),
        (("atlas", "--links", "6"), "Atlas"),
    ],
    ids=lambda value: value[0] if isinstance(value, tuple) else None,
)
def test_every_verb_writes_a_page(run: Verb, tmp_path: Path, verb: tuple[str, ...], title: str) -> None:
    assert run(*verb, "-o", "page.htm").exit_code == 0
    html = (tmp_path / "page.htm").read_text(encoding="utf-8")
    assert title in Reader(html).text
    assert run(*verb, "--format", "html").stdout == html


def test_a_report_is_a_page_of_its_own(six_bar: tuple[Report, str]) -> None:
    assert six_bar[0].html() == six_bar[1]
    assert six_bar[0].page().title == six_bar[0].title


def test_open_shows_a_page_or_says_where_it_is(run: Verb, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    monkeypatch.setattr("webbrowser.open", lambda address: bool(asked.append(address)) or True)
    there = run("open", "crank-rocker", "-o", "page.html")
    assert there.exit_code == 0
    assert "Opened page.html" in there.stderr
    assert asked == [(tmp_path / "page.html").resolve().as_uri()]
    monkeypatch.setattr("webbrowser.open", lambda address: False)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    none = run("open", "crank-rocker")
    assert none.exit_code == 0
    (made,) = tmp_path.glob("compoundkin-*.html")
    assert f"No browser can be opened here; the page is in {made}." in none.stderr
    assert made.read_text(encoding="utf-8") == (tmp_path / "page.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("verb", ["centres", "configurations"])
def test_pages_of_one_pose_show_that_pose(verb: str, tmp_path: Path) -> None:
    """The numbers were those of 35 degrees, the sketch that of the drawing."""
    path = tmp_path / "pose.html"
    assert CliRunner().invoke(cli, [verb, "six-bar", "--at", "35", "-o", str(path)]).exit_code == 0
    html = path.read_text(encoding="utf-8")
    data = json.loads(re.findall(r'id="ck-motion">(.*?)</script>', html)[0])
    assert data["poses"] == 1
    assert data["drivers"][0]["parts"][""] == pytest.approx(35)
