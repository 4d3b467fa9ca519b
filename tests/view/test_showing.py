"""What notebooks show of objects: well-formed HTML that says what the objects hold, whatever their state."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from html.parser import HTMLParser
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files import load
from compoundkin.view import notebook
from compoundkin.view.notebook import MOST_LINKS, html_of, unguarded
from compoundkin.view.page.html_blocks import MOST_ROWS

VOID = {"br"}


@dataclass
class Page(HTMLParser):
    """HTML read with a stack of open elements: whatever is not closed in order fails."""

    html: str
    open: list[str] = field(default_factory=list)
    tags: list[str] = field(default_factory=list)
    tables: list[list[list[str]]] = field(default_factory=list)
    headings: list[str] = field(default_factory=list)
    scopes: list[str | None] = field(default_factory=list)
    styles: list[str] = field(default_factory=list)
    texts: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        super().__init__()
        self.feed(self.html)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.styles.append(dict(attributes).get("style") or "")
        if tag == "table":
            self.tables.append([])
        if tag == "tr":
            self.tables[-1].append([])
        if tag in ("td", "th"):
            self.tables[-1][-1].append("")
        if tag == "th":
            self.scopes.append(dict(attributes).get("scope"))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.texts.append(data)
        if {"td", "th"} & set(self.open):
            # as it is read, so that tests take it for a number
            self.tables[-1][-1][-1] += data.replace("−", "-")
        if self.open and self.open[-1] in ("h3", "h4", "h5"):
            self.headings.append(data)

    @property
    def text(self) -> str:
        return "".join(self.texts)


def page_of(what: Any) -> Page:
    """What a notebook gets, read; the guarded way gives the same."""
    html = unguarded(what)
    assert what._repr_html_() == html
    return Page(html)


@pytest.fixture(scope="module")
def motion() -> ck.results.Motion:
    return ck.solve(load("six-bar"), {"crank": ck.deg(range(0, 361, 5))}, speed=10)


def loose() -> ck.Mechanism:
    """No driver, and two freedoms."""
    return ck.Mechanism("Loose", ck.link("frame", A=0), ck.link("rod", A=0, B=1), ck.link("arm", B=0, C=1))


def braced() -> ck.Mechanism:
    """A four-bar with a diagonal, and a driver all the same."""
    bars = (
        ck.link("frame", A=0, D=4),
        ck.link("crank", A=0, B=1),
        ck.link("coupler", B=0, C=3),
        ck.link("rocker", D=0, C=3),
    )
    return ck.Mechanism("Braced", *bars, ck.link("brace", A=0, C=3.3), ck.drive("crank"))


def still() -> ck.Mechanism:
    """A truss without a driver."""
    return ck.Mechanism("Truss", ck.link("frame", A=0, C=3), ck.link("left", A=0, B=2), ck.link("right", C=0, B=2))


def triple_rocker() -> ck.Mechanism:
    return ck.Mechanism(
        "Triple rocker",
        ck.link("frame", A=(0, 0), D=(7, 0)),
        ck.link("crank", A=(0, 0), B=(4, 0)),
        ck.link("coupler", B=(0, 0), C=(5, 0)),
        ck.link("rocker", D=(0, 0), C=(3, 0)),
        ck.drive("crank"),
    )


def inside(picture: ck.results.Picture) -> str:
    """All of a picture but its first tag, which tells its size."""
    head, _, rest = picture.svg.partition("\n")
    assert head.startswith("<svg")
    return rest


def never(*_: Any) -> None:
    raise AssertionError("this is not to be called")


def objects(motion: ck.results.Motion) -> list[Any]:
    """One of each kind that shows itself."""
    mechanism = motion.mechanism
    at = {mechanism.drives[0].name: 0.5}
    return [
        mechanism,
        motion.structure,
        ck.report(motion),
        ck.report(motion.structure),
        ck.verify(motion),
        ck.circuits(mechanism),
        ck.configurations(mechanism, at),
        ck.configurations(mechanism, at).pick(0),
        ck.instant_centres(motion),
        ck.mobility_analysis(mechanism),
    ]


def test_all_pages_are_well_formed_with_tables_that_name_their_rows_and_columns(motion: ck.results.Motion) -> None:
    for what in objects(motion):
        page = page_of(what)
        tables = [[row for row in table if not row[0].startswith("... and")] for table in page.tables]
        assert tables or isinstance(what, ck.Mechanism), what
        # of every table the whole first line, and the first cell of each other line
        assert page.scopes.count("col") == sum(len(table[0]) for table in tables)
        assert page.scopes.count("row") == sum(len(table) - 1 for table in tables)
        assert all(len(row) == len(table[0]) for table in tables for row in table)
        # colours are the page's, light or dark
        assert not any("color" in style or "background" in style for style in page.styles)


def test_short_texts_stand_where_no_page_is_shown(motion: ck.results.Motion) -> None:
    for what in objects(motion):
        if not isinstance(what, ck.results.Check | ck.results.MobilityAnalysis):
            assert len(repr(what)) < 200
    assert repr(motion.structure) == f"Structure({motion.mechanism.title!r}: mobility 1, groups RRR, RPR)"
    assert repr(ck.decompose(loose())).startswith("Structure('Loose': mobility 2, no groups, ")


def test_what_is_made_to_be_seen_says_in_short_what_it_is() -> None:
    mechanism = load("crank-rocker")
    motion = ck.solve(mechanism)
    title = repr(mechanism.title)
    assert repr(ck.draw(motion)).startswith(f"Picture({title}, ")
    assert repr(ck.animate(motion)) == f"Animation({title}, 72 frames, 4.32 s)"
    assert repr(ck.plot(motion, "rocker.angle")) == "Plot('rocker.angle [°]')"
    assert repr(ck.page(motion)).startswith(f"Page({title}, ")
    assert repr(ck.report(motion)).startswith(f"Report({title}: about, links, ")


def test_a_mechanism_shows_its_picture_and_what_it_is(motion: ck.results.Motion) -> None:
    mechanism = motion.mechanism
    page = page_of(mechanism)
    assert page.tags[0] == "figure"
    assert mechanism._repr_svg_() == ck.draw(mechanism).svg
    assert inside(ck.draw(mechanism)) in page.html
    assert page.text.strip().endswith(f"{mechanism.title}: 6 links; pairs 6 R + 1 P; driven: crank; lengths in mm")


def test_a_structure_shows_its_groups_in_solving_order(motion: ck.results.Motion) -> None:
    structure = motion.structure
    page = page_of(structure)
    (table,) = page.tables
    assert table[0] == ["no.", "group", "class", "order", "links", "uses"]
    assert table[1] == ["0", "frame and driver", "-", "-", "frame, crank", "-"]
    expected = [[g.name, "II", "2", ", ".join(g.links), ", ".join(g.uses)] for g in structure.groups]
    assert [row[1:] for row in table[2:]] == expected
    assert len(expected) == 2
    assert structure.mobility.formula in page.text
    assert structure._repr_svg_() == ck.draw(structure, kind="groups").svg
    assert inside(ck.draw(structure, kind="groups")) in page.html


def test_names_are_text_and_never_markup() -> None:
    nasty = ck.Mechanism(
        "<script>alert(1)</script> & co",
        ck.link("frame", A=(0, 0), D=(4, 0)),
        ck.link("<b>", A=(0, 0), B=(1, 0)),
        ck.link('a"x', B=(0, 0), C=(3, 0)),
        ck.link("c&d", D=(0, 0), C=(3, 0)),
        ck.drive("<b>"),
    )
    motion = ck.solve(nasty, {"<b>": [0.5, 1.0]})
    for what in objects(motion):
        page = page_of(what)
        assert not {"b", "script"} & set(page.tags)
        said = [name for name in (*nasty.links, nasty.title) if name in page.text]
        assert said or isinstance(what, ck.results.Check | ck.results.MobilityAnalysis)
    assert "frame, <b>" in page_of(motion.structure).tables[0][1]


def test_a_check_shows_every_finding_and_which_one_fails(motion: ck.results.Motion) -> None:
    check = ck.verify(motion)
    page = page_of(check)
    (table,) = page.tables
    assert [row[0] for row in table[1:]] == [finding.name for finding in check.findings]
    assert {row[-1] for row in table[1:]} == {"pass"}
    assert f"Checks of {check.poses} poses: all {len(check.findings)} checks passed" in page.text

    first, *others = check.findings
    failed = dataclasses.replace(check, findings=(dataclasses.replace(first, value=0.25), *others))
    page = page_of(failed)
    assert page.tables[0][1][0] == first.name
    assert page.tables[0][1][1] == "2.5e-01"
    assert [row[-1] for row in page.tables[0][1:]] == ["FAIL", *["pass"] * len(others)]
    assert f"failed: {first.name}" in page.text


def test_circuits_show_their_branches_and_limits() -> None:
    found = ck.circuits(triple_rocker())
    page = page_of(found)
    assert page.headings[:3] == ["Circuits", "Branches", "Limit positions"]
    limits = [float(row[0]) for row in page.tables[2][1:]]
    # where B is farthest from D: |BD| = 5 + 3
    farthest = np.rad2deg(np.arccos((4**2 + 7**2 - 8**2) / (2 * 4 * 7)))
    assert limits == pytest.approx([farthest, -farthest], abs=1e-3)


def test_configurations_show_the_angles_of_their_links() -> None:
    found = ck.configurations(triple_rocker(), {"crank": 1.0})
    rows = page_of(found).tables[0][1:]
    assert [row[1] for row in rows] == list(found.names)
    for row, one in zip(rows, found, strict=True):
        assert float(row[-1]) == pytest.approx(np.rad2deg(one.angles["rocker"]), abs=1e-3)
        page = page_of(one)
        assert "<svg" in page.html
        assert dict(page.tables[0][1:])["rocker"][:6] == row[-1][:6]
    # the pictures are of the configurations themselves
    first, second = (html_of(one) for one in found)
    assert first != second


def test_centres_show_where_they_are_at_the_first_pose(motion: ck.results.Motion) -> None:
    centres = ck.instant_centres(motion)
    page = page_of(centres)
    rows = [row for table in page.tables for row in table[1:]]
    assert len(rows) == len(centres) == 15
    places = {row[0]: row[1:3] for row in rows}
    for name, letter in {"(plate block)": "C", "(plate rocker)": "A"}.items():
        place = motion.points[letter].position[0]
        assert [float(text) for text in places[name]] == pytest.approx([place.real, place.imag], rel=1e-5)


def test_of_many_centres_the_derivation_alone_is_shown(
    motion: ck.results.Motion, monkeypatch: pytest.MonkeyPatch
) -> None:
    from compoundkin.view.report import centres_section

    monkeypatch.setattr(centres_section, "MOST_CENTRES", 10)
    page = page_of(ck.instant_centres(motion))
    assert page.tables[0][0] == ["step", "centre", "from"]
    assert len(page.tables[0]) == 15 + 1


def test_a_mobility_analysis_shows_count_and_dimensions() -> None:
    found = ck.mobility_analysis(load("parallelogram-third-crank"))
    page = page_of(found)
    numbers = [int(row[1]) for row in page.tables[0][1:]]
    assert numbers == [found.gruebler, found.generic, found.at_pose, found.finite] == [0, 0, 1, 1]
    assert f"O{found.verdict[1:]}." in page.text


def test_a_cam_shows_its_pressure_angle() -> None:
    eccentric = ck.Mechanism(
        "Eccentric",
        ck.link("frame", A=0),
        ck.link("cam", A=0),
        ck.link("follower", P=0),
        ck.slide("follower", on="frame", through="A", angle=ck.deg(90)),
        ck.cam("follower", on="cam", profile=ck.profiles.disc(20, (10, 0)), radius=5),
        ck.drive("cam"),
    )
    found = ck.figures.cam_analysis(ck.solve(eccentric, {"cam": ck.deg(range(0, 361, 5))}), "follower/cam")
    row = page_of(found).tables[0][1]
    assert row[0] == "pressure angle"
    # arcsin of the eccentricity over the sum of the radii
    assert float(row[4]) == pytest.approx(np.rad2deg(np.arcsin(10 / 25)), abs=1e-4)


def test_a_report_shows_all_its_sections(motion: ck.results.Motion) -> None:
    report = ck.report(motion)
    page = page_of(report)
    titles = [section.title for section in report.sections if section.title]
    assert page.headings[0] == report.title
    assert [title for title in titles if title not in page.headings] == []


@pytest.mark.parametrize("broken", [loose, braced, still])
def test_what_cannot_be_solved_shows_why(broken: Any) -> None:
    mechanism = broken()
    assert mechanism.title in page_of(mechanism).text
    structure = ck.decompose(mechanism)
    page = page_of(structure)
    assert "<svg" in page.html
    for fault in structure.faults:
        assert f"{fault.text[1:]}. Remedy: " in page.text
        assert fault.remedy in page.text
    assert structure.mobility.verdict in page.text


def test_no_pose_is_searched_of_what_cannot_be_taken_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(notebook, "draw", never)
    assert page_of(braced()).tags[0] == "p"


def test_a_mechanism_without_a_picture_shows_its_links() -> None:
    page = page_of(loose())
    assert "figure" not in page.tags
    assert [row[0] for row in page.tables[0]] == ["link", "frame", "rod", "arm"]
    assert loose()._repr_svg_() is None


def test_what_is_large_is_shown_in_part_and_is_not_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(notebook, "draw", never)
    large = ck.chains.random_mechanism(groups=300, seed=2)
    assert len(large.links) > MOST_LINKS
    for what, count in ((large, len(large.links)), (ck.decompose(large), 301)):
        page = page_of(what)
        assert what._repr_svg_() is None
        assert len(page.tables[0]) == 1 + MOST_ROWS + 1
        assert page.tables[0][-1] == [f"... and {count - MOST_ROWS} more rows"]
        assert len(page.html) < 40_000
    assert len(repr(ck.decompose(large))) < 200


def test_showing_never_raises(monkeypatch: pytest.MonkeyPatch) -> None:
    assert html_of(object()) is None
    monkeypatch.setattr(notebook, "decompose", never)
    assert triple_rocker()._repr_html_() is None


@pytest.mark.parametrize(
    "name", ["3-rrr", "class-iii-six-bar", "disc-cam-offset-roller", "planetary-train", "scissor-lift", "v8-engine"]
)
def test_mechanisms_of_all_kinds_show_themselves(name: str) -> None:
    mechanism = load(name)
    for what in (mechanism, ck.decompose(mechanism), ck.mobility_analysis(mechanism)):
        page_of(what)
