"""The page on the kinds of pair is true: its examples run, its table is that of the registry."""

from __future__ import annotations

import re
from pathlib import Path

from compoundkin.model.pairs import KINDS

PAGE = (Path(__file__).parents[1] / "docs" / "pairs.md").read_text("utf-8")


def test_the_examples_run() -> None:
    names: dict[str, object] = {}
    for code in re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL):
        exec(code, names)


def test_the_table_is_that_of_the_registry() -> None:
    lines = (line for line in PAGE.splitlines() if re.match(r"\| [A-Z] \|", line))
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines]
    assert sorted(row[0] for row in rows) == sorted(kind.code for kind in KINDS.values())
    for kind in KINDS.values():
        (row,) = (row for row in rows if row[0] == kind.code)
        assert row[3].strip("`") == kind.table
        assert int(row[4]) == kind.held
        assert (row[6] == "yes") == (kind.held == 2)
