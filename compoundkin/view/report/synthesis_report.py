"""The report on an answer of dimensional synthesis: the task, the mechanisms, what is wrong with the others."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.base.arrays import degrees
from compoundkin.dimensional.candidates import Linkage
from compoundkin.dimensional.synthesis import Answer
from compoundkin.dimensional.tasks import Task
from compoundkin.view.report.report_data import NOT_SOLVED, Block, Cell, Column, Outcome, Paragraph, Section, TableBlock
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.wording import counted, sentence

# A reader needs no more rejected candidates than these; the JSON report has all.
MOST_ROWS = 20


def synthesis_report(answer: Answer) -> Report:
    """Return the report on an answer; its page shows the best mechanism."""
    sections = [_task_section(answer), *_solutions(answer), *_rejections(answer)]
    if not len(answer):
        return Report(sentence(answer.task.in_words).rstrip("."), tuple(sections), NOT_SOLVED, None)
    motion = answer[0].motion
    outcome = Outcome(True, motion.failed.size, int((motion.failed == 0).sum()))
    return Report(sentence(answer.task.in_words).rstrip("."), tuple(sections), outcome, motion)


def _task_section(answer: Answer) -> Section:
    texts = [f"Wanted: {answer.task.in_words}. Found: {answer.complete}."]
    texts += [sentence(text) for text in (answer.note, *_conditions(answer.task), answer.nearest) if text]
    return Section("task", "Task", tuple(Paragraph(text) for text in texts))


def _conditions(task: Task) -> Iterator[str]:
    given = task.conditions
    if given.region is not None:
        corners = ", ".join(f"({p.real:.6g}, {p.imag:.6g})" for p in given.region)
        yield f"fixed pivots lie within {corners}"
    if given.lengths is not None:
        yield f"lengths are {given.lengths[0]:.6g} to {given.lengths[1]:.6g}"
    if given.ground:
        yield f"fixed pivots are at {', '.join(f'({p.real:.6g}, {p.imag:.6g})' for p in given.ground)}"
    if given.transmission:
        yield f"the transmission angle is {np.rad2deg(given.transmission):.4g} degrees at least"
    if given.turning:
        yield "the driver turns fully"
    if task.tolerance:
        yield f"it may be missed by {task.tolerance:.6g}"


def _solutions(answer: Answer) -> Iterator[Section]:
    if not len(answer):
        yield Section("mechanisms", "Mechanisms", (Paragraph("No candidate is without a defect."),))
        return
    columns = (Column("no.", style="each"), Column("mechanism"), Column("driver"), Column("turns"),
               Column("least transmission angle", "deg", "fixed"), Column("sum of lengths", "", "each"),
               Column("error", "", "brief"))  # fmt: skip
    rows: tuple[tuple[Cell, ...], ...] = tuple(
        (k, one.candidate.title, one.driver, "fully" if one.turns else "partly",
         None if np.isnan(one.transmission) else float(degrees(one.transmission)), one.size, one.error)
        for k, one in enumerate(answer, start=1)
    )  # fmt: skip
    ranked = f"Ranked by {answer.task.conditions.prefer}; each was solved and verified."
    text = f"{sentence(counted(len(answer), 'mechanism'))} {ranked}"
    yield Section("mechanisms", "Mechanisms", (Paragraph(text), TableBlock(columns, rows, 2)))
    heads = (Column("no.", style="each"), Column("link or pivot"), Column("x", "", "fixed"), Column("y", "", "fixed"),
             Column("length", "", "fixed"))  # fmt: skip
    blocks: list[Block] = [TableBlock(heads, tuple(row for k, one in enumerate(answer, start=1)
                                                   for row in _dimensions(k, one.candidate)), 2)]  # fmt: skip
    yield Section("joints", "Joints and lengths", tuple(blocks))


def _dimensions(number: int, linkage: Linkage) -> Iterator[tuple[Cell, ...]]:
    """Yield the places of the joints at the first position, and the lengths."""
    for letter, place in linkage.places.items():
        yield number, letter, place.real, place.imag, None
    for item in linkage.links:
        points = list(item.points.values())
        if item.name != "frame" and len(points) == 2:
            yield number, item.name, None, None, float(np.abs(np.diff(np.array(points, dtype=complex))[0]))


def _rejections(answer: Answer) -> Iterator[Section]:
    if not answer.rejected:
        return
    counts = ", ".join(f"{count} for {reason}" for reason, count in answer.reasons.items())
    columns = Column("mechanism"), Column("driver"), Column("reason"), Column("what is wrong")
    rows: tuple[tuple[Cell, ...], ...] = tuple(
        (one.candidate.title, one.driver or "-", one.reason, one.text) for one in answer.rejected
    )
    shown = tuple(range(MOST_ROWS)) if len(rows) > MOST_ROWS else None
    text = f"{sentence(counted(len(rows), 'candidate'))} Rejected: {counts}. Positions are counted from 0."
    yield Section("rejected", "Rejected candidates", (Paragraph(text), TableBlock(columns, rows, 0, shown)))
