"""A report as JSON: the same sections, with every row and every digit."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from functools import singledispatch
from math import isfinite
from typing import Any

from compoundkin.view.report.report_data import (
    Alert,
    Cell,
    FormulaBlock,
    Outcome,
    Paragraph,
    Section,
    StepBlock,
    TableBlock,
)


def json_text(title: str, sections: Sequence[Section], outcome: Outcome) -> str:
    """The report as a JSON text: `title`, `outcome`, and `sections` by their keys in reading order.

    A table has `columns` (name and unit) and `rows`; what is not assembled is null, a vector is [x, y].

    >>> sections = [Section("about", "", (Paragraph("Watch B."),))]
    >>> json.loads(json_text("Crank", sections, Outcome(True, 0, 0, 0, 0, 0, 0)))["sections"]["about"]["blocks"]
    [{'kind': 'paragraph', 'text': 'Watch B.'}]
    """
    parts = {s.key: {"title": s.title, "blocks": [_block(block) for block in s.blocks]} for s in sections}
    comes_to = {**asdict(outcome), "passed": outcome.passed}
    whole = {"format": 1, "title": title, "outcome": comes_to, "sections": parts}
    return json.dumps(whole, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


@singledispatch
def _block(block: object) -> dict[str, Any]:
    raise TypeError(f"{type(block).__name__} is not a part of a report")


@_block.register
def _(block: Paragraph) -> dict[str, Any]:
    return {"kind": "paragraph", "text": block.text}


@_block.register
def _(block: FormulaBlock) -> dict[str, Any]:
    return {"kind": "formula", "text": block.text, **({"latex": block.latex} if block.latex else {})}


@_block.register
def _(block: Alert) -> dict[str, Any]:
    return {"kind": "alert", "text": block.text, "remedy": block.remedy}


@_block.register
def _(block: StepBlock) -> dict[str, Any]:
    return {"kind": "step", "title": block.title, "facts": [list(fact) for fact in block.facts]}


@_block.register
def _(block: TableBlock) -> dict[str, Any]:
    columns = [{"name": column.name, "unit": column.unit} for column in block.columns]
    return {"kind": "table", "columns": columns, "rows": [[_cell(cell) for cell in row] for row in block.rows]}


def _cell(cell: Cell) -> Any:
    if isinstance(cell, tuple):
        return [_cell(value) for value in cell]
    if isinstance(cell, str):
        return cell.replace("\n", " ")
    return None if isinstance(cell, float) and not isfinite(cell) else cell
