"""The report of a study: how many designs assemble, how figures are distributed, which designs are best."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from compoundkin.base.arrays import degrees
from compoundkin.model.attributes import DEGREES, GREATEST, LEAST, PARTS, RADIANS
from compoundkin.studies.runs.design_states import CIRCUIT, ORDER_DEFECT, REASON
from compoundkin.studies.runs.study_program import ROW, StudyColumn
from compoundkin.studies.runs.study_result import StudyResult
from compoundkin.view.report.report_data import Block, Cell, Column, Outcome, Paragraph, Section, TableBlock
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.wording import counted, listed, number

PERCENTILES = (5.0, 25.0, 50.0, 75.0, 95.0)
# Of more reasons and circuits only so many are told, the most frequent ones.
MOST_STATES = 12
# Before where in the motion it is that a design does not assemble.
_PLACE = re.compile(" (at|between) ")


def study_report(found: StudyResult, least: Sequence[str] = (), greatest: Sequence[str] = (), best: int = 1) -> Report:
    """Report what a study found.

    The designs with the least and the greatest values of some figures are listed, so many of each.
    Raises UnknownName and InvalidInput for what are no figures of it.
    """
    closed = int(np.count_nonzero(found.assembled))
    asked = [*((name, False) for name in least), *((name, True) for name in greatest)]
    tables = [block for name, is_greatest in asked for block in _best(found, name, best, is_greatest)]
    sections = [
        Section("study", "Study", tuple(_about(found, closed))),
        Section("figures", "Figures", (_figures(found),)) if closed else None,
        Section("states", "States", tuple(_states(found))),
        Section("best", "Best designs", tuple(tables)) if tables else None,
    ]
    reference = found.reference
    poses, courses = int(reference.failed.size), tuple(one.name for one in found.columns if one.width)
    outcome = Outcome(True, poses, int(np.count_nonzero(reference.failed == 0)), 0, 0, 0, 0)
    shown = tuple(one for one in sections if one and one.blocks)
    return Report(found.study.mechanism.title, shown, outcome, reference, courses, studied=found)


def _about(found: StudyResult, closed: int) -> Iterator[Block]:
    study, rows = found.study, len(found)
    share = f"; {number(100.0 * closed / rows)} % of them assemble over the whole range" if rows else ""
    said = study.sample.data["sample"]
    kind = said if isinstance(said, str) else "grid"
    yield Paragraph(f"{counted(rows, 'design')} by {listed(study.dimensions)} ({kind}){share}.")
    if not found.is_complete:
        yield Paragraph(f"The study has {counted(len(study), 'row')}; run it again to go on.")
    courses = [column.name for column in found.columns if column.width]
    if courses:
        yield Paragraph(f"Courses, a value at every pose: {listed(courses)}.")


def _figures(found: StudyResult) -> TableBlock:
    """Return how dimensions and figures are distributed over the designs that assemble."""
    rows: list[tuple[Cell, ...]] = []
    for column in _single(found):
        factor, unit = _shown(column)
        values = found[column.name][found.assembled] * factor
        known = values[np.isfinite(values)]
        if known.size:
            rows.append((column.name, unit, *np.percentile(known, (0.0, *PERCENTILES, 100.0)).tolist()))
    named = (LEAST, *(f"{share:g} %" for share in PERCENTILES), GREATEST)
    heads = (Column(name, style="each") for name in named)
    return TableBlock((Column("of"), Column("unit"), *heads), tuple(rows), keys=1)


def _states(found: StudyResult) -> Iterator[Block]:
    """Yield why designs do not assemble, and on how many circuits the others are."""
    reasons = Counter(one for one in found[REASON] if one)
    if reasons:
        yield Paragraph("What does not assemble:")
        yield _whys(reasons)
    circuits = Counter(found[CIRCUIT][found.assembled])
    if len(circuits) > 1:
        yield Paragraph("The others are on these circuits:")
        rows = tuple((count, text) for text, count in circuits.most_common(MOST_STATES))
        yield TableBlock((Column("designs", style="each"), Column("on")), rows)
    wrong = int(np.count_nonzero(found[ORDER_DEFECT]))
    if wrong:
        yield Paragraph(f"{counted(wrong, 'design')} with the poses not in one sense.")


def _whys(reasons: Counter[str]) -> TableBlock:
    """Return how many designs fail by what, wherever in the motion, and where most of these do."""
    counts: Counter[str] = Counter()
    most: dict[str, str] = {}
    for text, count in reasons.most_common():
        what, *place = _PLACE.split(text, maxsplit=1)
        counts[what] += count
        most.setdefault(what, " ".join(place))
    rows = tuple((count, what, most[what]) for what, count in counts.most_common(MOST_STATES))
    return TableBlock((Column("designs", style="each"), Column("why"), Column("most often")), rows)


def _best(found: StudyResult, name: str, count: int, is_greatest: bool) -> Iterator[Block]:
    """Yield the designs with the least or the greatest values of a figure."""
    yield Paragraph(f"The {GREATEST if is_greatest else LEAST} {name}:")
    rows = found.best(name, count, greatest=is_greatest)
    columns = sorted(_single(found), key=lambda column: column.name != name)
    heads = (Column(one.name, _shown(one)[1], "each") for one in columns)
    cells = tuple((int(row[ROW]), *(_cell(row, one) for one in columns)) for row in rows)
    yield TableBlock((Column(ROW, style="each"), *heads), cells, keys=1)


def _cell(row: dict[str, Any], column: StudyColumn) -> Cell:
    """Return the number of a row in a column; vectors have their parts there."""
    vector, _, part = column.name.rpartition(".")
    value = row[column.name] if column.name in row else PARTS[part](row[vector])
    return float(value * _shown(column)[0])


def _single(found: StudyResult) -> list[StudyColumn]:
    """Return the dimensions and the figures: one number for each design."""
    return [one for one in found.columns if one.is_figure]


def _shown(column: StudyColumn) -> tuple[float, str]:
    """Return the factor to the unit that people are shown, and that unit."""
    return (float(degrees(1.0)), DEGREES) if column.unit == RADIANS else (1.0, column.unit)
