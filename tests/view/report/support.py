"""A mechanism that several tests of reports change, and what holds for every report."""

from __future__ import annotations

import json
import re
from typing import Any

import compoundkin as ck
from compoundkin.view.report import Report
from compoundkin.view.report.report_data import TableBlock


def four_bar(frame: Any = 4.0, *more: Any, **words: Any) -> ck.Mechanism:
    return ck.Mechanism(
        "Four-bar",
        ck.link("frame", A=(0, 0), D=(frame, 0)),
        ck.link("crank", A=(0, 0), B=(1, 0)),
        ck.link("coupler", B=(0, 0), C=(3, 0), P=(1, 1)),
        ck.link("rocker", D=(0, 0), C=(3, 0)),
        *more,
        **words,
    )


def assert_fits(made: Report) -> None:
    """Its text is 80 columns wide, nothing is cut off, and no line ends in blanks."""
    whole = made.text()
    lines = whole.splitlines()
    assert max(map(len, lines)) <= 80
    assert "…" not in whole
    assert all(line == line.rstrip() for line in lines)
    # every name of a link stands somewhere whole
    links = next(block for block in made.section("links").blocks if isinstance(block, TableBlock))  # type: ignore[union-attr]
    assert all(str(row[0]) in whole for row in links.rows)


def assert_well_formed(made: Report) -> None:
    """Each table of its Markdown has a head, a rule, and as many cells in every line."""
    for block in made.markdown().split("\n\n"):
        lines = block.splitlines()
        if lines[0].startswith("|"):
            assert len(lines) >= 2
            assert set(lines[1]) <= set("|-: ")
            assert len({len(re.findall(r"(?<!\\)\|", line)) for line in lines}) == 1, block


def parsed(made: Report) -> Any:
    """Its JSON, read by a strict reader."""

    def refuse(name: str) -> Any:
        raise AssertionError(f"{name} is not JSON")

    return json.loads(made.json(), parse_constant=refuse)
