from __future__ import annotations

import re
import warnings
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files import load
from compoundkin.view.report import Report, report
from compoundkin.view.report.report_data import Column, Outcome, Paragraph, Section, TableBlock
from compoundkin.view.report.wording import column_texts
from tests.view.report.support import assert_fits, assert_well_formed, four_bar, parsed

ESCAPE = "\x1b"
# The forms without pictures; those with them have tests of their own.
FORMS = (Report.text, Report.markdown, Report.json)


def made_of(*blocks: Any) -> Report:
    return Report("Title", (Section("key", "Section", blocks),), Outcome(True))


# --- text -----------------------------------------------------------------------------------------------


def test_lines_fit_and_nothing_is_cut_off_or_blank_at_the_end(
    broken: ck.results.Motion, sweep: ck.results.Motion
) -> None:
    for made in (report(ck.decompose(four_bar())), report(broken), report(sweep, design=1)):
        assert_fits(made)


def test_text_is_plain_unless_colour_is_asked_for(six_bar: ck.results.Motion) -> None:
    made = report(six_bar)
    assert ESCAPE not in made.text()
    coloured = made.text(colour=True)
    assert ESCAPE in coloured
    assert re.sub(r"\x1b\[[0-9;]*m", "", coloured).split() == made.text().split()


def test_text_is_ascii_but_for_degrees_where_the_mechanism_is(six_bar: ck.results.Motion) -> None:
    assert report(six_bar).text().replace("°", "").isascii()


def test_the_same_report_is_the_same_text(six_bar: ck.results.Motion) -> None:
    again = report(ck.solve(load("six-bar")))
    for written_as in FORMS:
        assert written_as(report(six_bar)) == written_as(again)


def test_a_wide_table_is_split_with_its_keys_repeated_and_vectors_together() -> None:
    numbers = [Column(f"quantity-{k}.{part}", "mm", "fixed", follows=part == "y") for k in range(6) for part in "xy"]
    found = TableBlock((Column("crank", "deg", "fixed"), *numbers), ((5.0, *map(float, range(12))),), keys=1)
    lines = made_of(found).text().splitlines()
    heads = [line.split() for line in lines if line.startswith("crank")]
    assert len(heads) > 1
    assert all(head[1:] == ["x", "y"] * ((len(head) - 1) // 2) for head in heads)
    assert [line.split()[1:] for line in lines if re.match(r" +5 ", line)] == [
        [str(k) for k in part] for part in np.split(np.arange(12), np.cumsum([len(h) - 1 for h in heads])[:-1])
    ]


def test_names_that_look_like_markup_stay_as_they_are() -> None:
    made = made_of(Paragraph("[bold]x[/bold] :smile: *a*"), TableBlock((Column("[red]h"),), (("[b]",),)))
    for part in ("[bold]x[/bold] :smile: *a*", "[red]h", "[b]"):
        assert part in made.text()


# --- numbers --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("cells", "expected"),
    [
        ([0.0, 5.0, 360.0], ["0", "5", "360"]),
        ([0.0, 2.5, 360.0], ["0.0", "2.5", "360.0"]),
        ([-1276.8949837, 61.06], ["-1276.89", "61.06"]),
        ([1e-7, 2e-8], ["1.00000e-07", "2.00000e-08"]),
        ([1.5e9, 0.0], ["1.50000e+09", "0"]),
        ([float("nan"), 1.0], ["-", "1"]),
        ([None, -1e-20], ["-", "0"]),
        ([-0.00001, 300.0], ["0", "300"]),
        ([], []),
    ],
)
def test_a_column_has_as_many_decimals_as_say_something(cells: list[Any], expected: list[str]) -> None:
    assert column_texts(Column("x", style="fixed", floor=1e-15), cells) == expected


# --- Markdown -------------------------------------------------------------------------------------------


def test_markdown_tables_are_well_formed(broken: ck.results.Motion) -> None:
    for made in (report(ck.decompose(four_bar())), report(broken)):
        assert_well_formed(made)


def test_formulas_and_units_are_set_alike_but_for_plain_text(six_bar: ck.results.Motion) -> None:
    made = report(six_bar)
    for form in (made.markdown(), re.sub(r"(?s)<script.*?</script>", "", made.html())):
        assert "3 (6 − 1) − 2·7 = 1" in form
        assert "mm/s²" in form
        assert not re.search(r"/s\^[23]|\d \* \d", form)
    assert "2 * 7" in made.text()
    assert "mm/s^2" in made.json()


def test_markdown_escapes_what_is_markup() -> None:
    mechanism = ck.Mechanism("a | b *c* <d> `e`", ck.link("frame", A=0), ck.link("x|y", A=0, B=1), ck.drive("x|y"))
    found = report(ck.solve(mechanism)).markdown()
    assert found.startswith(r"# a \| b \*c\* \<d\> \`e\`")
    assert r"x\|y" in found


# --- JSON -----------------------------------------------------------------------------------------------


def test_json_holds_the_numbers_of_the_motion(six_bar: ck.results.Motion) -> None:
    document = parsed(report(six_bar, ["bar.angle", "G.acceleration"]))
    found = next(b for b in document["sections"]["outputs"]["blocks"] if b["kind"] == "table")
    assert [c["unit"] for c in found["columns"]] == ["deg", "deg", "mm/s^2", "mm/s^2"]
    rows = np.array(found["rows"])
    np.testing.assert_allclose(np.deg2rad(rows[:, 1]), six_bar.links["bar"].angle[::3], rtol=1e-15)
    np.testing.assert_array_equal(rows[:, 2] + 1j * rows[:, 3], six_bar.points["G"].acceleration[::3])
    assert document["outcome"]["passed"] is True


def test_json_has_every_published_number(six_bar: ck.results.Motion) -> None:
    document = parsed(report(six_bar))
    found = next(b for b in document["sections"]["published"]["blocks"] if b["kind"] == "table")
    assert len(found["rows"]) == 55
    assert found["rows"][0][2] == pytest.approx([37.27745008226299, 6.4399766983660784], abs=1e-12)


def test_json_says_null_where_nothing_is_assembled(broken: ck.results.Motion) -> None:
    with warnings.catch_warnings(action="ignore"):
        document = parsed(report(broken))
    rows = next(b for b in document["sections"]["outputs"]["blocks"] if b["kind"] == "table")["rows"]
    assert [row[-1] is None for row in rows] == [not ok for ok in broken.assembled[::3].tolist()]


def test_only_parts_of_a_report_are_rendered() -> None:
    for written_as in FORMS:
        with pytest.raises(TypeError, match="not a part of a report"):
            written_as(made_of("text"))
