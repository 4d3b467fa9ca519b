"""The report of a tolerance analysis: errors of the outputs, what contributes to each, bands over the poses."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from compoundkin.base.series import Number
from compoundkin.kinematics.quantities import Quantity
from compoundkin.studies.tolerances.output_tolerance import OutputTolerance
from compoundkin.studies.tolerances.tolerance_analysis import ToleranceAnalysis
from compoundkin.view.report.report_data import Block, Cell, Column, Outcome, Paragraph, Section, Style, TableBlock
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.report.wording import counted, listed, number

# Errors and shares say something with so many digits.
DIGITS = 4


def tolerance_report(found: ToleranceAnalysis, outputs: Sequence[str] = ()) -> Report:
    """Report what tolerances do to outputs: those named, else all of them.

    Raises UnknownName for an output that there is not.
    """
    chosen = [found[name] for name in outputs] or list(found.values())
    motion = found.motion
    courses = [one for one in chosen if one.is_course]
    sections = (
        Section("tolerances", "Tolerances", tuple(_about(found))),
        Section("errors", "Errors of the outputs", tuple(_errors(found, chosen))),
        Section("contributions", "What contributes", tuple(_contributions(found, chosen))),
        *([Section("bands", "Over the motion", tuple(_bands(found, courses)))] if courses else []),
    )
    outcome = Outcome(True, int(motion.failed.size), int(np.count_nonzero(motion.failed == 0)), 0, 0, 0, 0)
    names = tuple(one.name for one in courses)
    return Report(found.mechanism.title, sections, outcome, motion, names, studied=found)


def _about(found: ToleranceAnalysis) -> Iterator[Block]:
    sigmas = number(found.chances.sigmas)
    yield Paragraph(
        f"{counted(len(found.sources), 'source')} of errors: {listed(one.name for one in found.sources)}. "
        f"Limits lie {sigmas} standard deviations from the middle."
    )
    left_out = f", of which {found.unassembled:,} cannot be assembled and are left out" if found.unassembled else ""
    yield Paragraph(
        "Worst cases and standard deviations are to first order, by exact slopes; percentiles are those of "
        f"{counted(found.count, 'random design')}{left_out}, each with its standard error."
    )


def shown(one: OutputTolerance, values: Number | float) -> Quantity:
    """Return values of an output as people read them, angles in degrees."""
    return Quantity(one.name, one.unit, np.asarray(values, dtype=float)).shown


def worst_pose(one: OutputTolerance) -> int | None:
    """Return the pose at which the deviation of a course is greatest."""
    return int(np.argmax(np.where(np.isfinite(one.deviation), one.deviation, -1.0))) if one.is_course else None


def _errors(found: ToleranceAnalysis, chosen: Sequence[OutputTolerance]) -> Iterator[Block]:
    """Yield the errors of each output, of a course where its deviation is greatest."""
    column, places = Sample(found.motion).places
    heads = Column("output"), Column("unit"), Column(column.name, column.unit, "each")
    rows, sampled = list[tuple[Cell, ...]](), list[tuple[Cell, ...]]()
    for one in chosen:
        pose = worst_pose(one)
        head = one.name, shown(one, 0.0).unit, None if pose is None else float(places[pose])
        errors = [_at(one, values, pose) for values in (one.nominal, one.low, one.high, one.deviation)]
        rows.append((*head, *errors[:-1], _rounded(errors[-1])))
        of = zip(found.percentiles, one.sample.percentiles, one.sample.percentile_errors, strict=True)
        sampled += [
            (*head, percent, _at(one, own, pose), _rounded(_at(one, error, pose))) for percent, own, error in of
        ]
    some = ", of courses where that is greatest" if any(one.is_course for one in chosen) else ""
    yield Paragraph(f"Nominal values, worst cases and the standard deviation{some}:")
    words = (Column(word, style="each") for word in ("nominal", "worst low", "worst high", "deviation"))
    yield TableBlock((*heads, *words), tuple(rows), keys=1)
    yield Paragraph("Percentiles of the random designs there:")
    words = (Column(word, unit, "each") for word, unit in (("percentile", "%"), ("value", ""), ("standard error", "")))
    yield TableBlock((*heads, *words), tuple(sampled), keys=1)


def _at(one: OutputTolerance, values: Number, pose: int | None) -> float:
    """Return a value of an output at a pose as it is shown."""
    return float(shown(one, values if pose is None else values[pose]).values)


def _contributions(found: ToleranceAnalysis, chosen: Sequence[OutputTolerance]) -> Iterator[Block]:
    """Yield a table for each output: its sources, the greatest share of the variance first."""
    for one in chosen:
        pose = worst_pose(one)
        column, places = Sample(found.motion).places
        where = "" if pose is None else f" at {column.name} {number(float(places[pose]))} {column.unit}".rstrip()
        yield Paragraph(f"To {one.name}{where}, with the share of each in the variance:")
        source, low, high, unit, worst, deviation, share = found.table(one.name).shown.columns
        rows: list[tuple[Cell, ...]] = []
        for k in np.argsort(-share.values, kind="stable"):
            limits = _rounded(float(low.values[k])), _rounded(float(high.values[k])), str(unit.values[k])
            parts = [_rounded(float(own.values[k])) for own in (share, worst, deviation)]
            rows.append((str(source.values[k]), *limits, round(100.0 * parts[0], 2), *parts[1:]))
        limits_of = Column("lower", style="each"), Column("upper", style="each"), Column("unit")
        parts_of = Column("worst case", worst.unit, "each"), Column("deviation", deviation.unit, "each")
        heads = Column("source"), *limits_of, Column("share", "%", "fixed"), *parts_of
        yield TableBlock(heads, tuple(rows), keys=1)


def _bands(found: ToleranceAnalysis, courses: Sequence[OutputTolerance]) -> Iterator[Block]:
    """Yield the nominal course and its errors, at the poses that tables show."""
    sample = Sample(found.motion)
    column, places = sample.places
    heads, cells = [column], [[float(places[pose]) for pose in sample.rows]]
    for one in courses:
        quantities = {"": one.nominal, " worst": one.worst, " deviation": one.deviation}
        for word, values in quantities.items():
            own = shown(one, values)
            style: Style = "each" if word else "fixed"
            heads.append(Column(f"{one.name}{word}", own.unit, style, follows=bool(word)))
            cells.append([float(own.values[p]) if not word else _rounded(float(own.values[p])) for p in sample.rows])
    yield Paragraph("The worst case and the standard deviation are errors to either side of the middle:")
    yield TableBlock(tuple(heads), tuple(zip(*cells, strict=True)), keys=1)


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")
