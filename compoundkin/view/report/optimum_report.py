"""The report of a search of better dimensions: what changed, what binds, how sure one can be, the next best."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from compoundkin.base.arrays import degrees
from compoundkin.kinematics.quantities import Quantity
from compoundkin.model.attributes import DEGREES, RADIANS
from compoundkin.studies.optimisation.optimum import LocalMinimum, Optimum
from compoundkin.view.report.findings_table import findings_table
from compoundkin.view.report.objective_words import objective_words, shown_objective
from compoundkin.view.report.report_data import Alert, Block, Cell, Column, Outcome, Paragraph, Section, TableBlock
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.report.wording import counted, listed, number

# So many designs at which searches ended are listed, the best first.
MOST_MINIMA = 8


def optimum_report(found: Optimum, outputs: Sequence[str] = ()) -> Report:
    """Report a search of better dimensions; its page plots `outputs`."""
    check, motion = found.check, found.motion
    sections = (
        Section("optimum", "Better dimensions", tuple(_about(found))),
        Section("changes", "What changed", (_changes(found),)),
        *([Section("constraints", "Constraints", (_constraints(found),))] if found.constraints else []),
        *([Section("unknowns", "Found beside", (_unknowns(found),))] if found.unknowns else []),
        Section("minima", "How sure", tuple(_minima(found))),
        Section("checks", "Checks of the answer", (findings_table(Sample(motion), check),)),
    )
    passed = len(check.findings) - len(check.failed)
    poses = int(motion.failed.size), int(np.count_nonzero(motion.failed == 0))
    outcome = Outcome(True, *poses, len(check.findings), passed, 0, 0, check.passed, check.verdict)
    return Report(found.mechanism.title, sections, outcome, motion, outputs, studied=found)


def _about(found: Optimum) -> Iterator[Block]:
    yield Paragraph(f"What shall be least: {listed(one.told for one in found.goals)}.")
    squares = "sum of squares" if all(one.is_squares for one in found.goals) else "objective"
    before = f"from {objective_words(found, found.value_before)} " if np.isfinite(found.value_before) else ""
    yield Paragraph(f"The {squares} came {before}to {objective_words(found, found.value)}.")
    if not np.isfinite(found.value_before):
        yield Paragraph("The mechanism as it stood has no objective: it cannot be assembled over the whole motion.")
    if not found.is_held:
        broken = listed(one.told for one in found.constraints if not one.is_held)
        yield Alert(f"Not all constraints hold: {broken}", "widen the ranges of dimensions, or ask for less")
    if not found.is_whole:
        what = "It cannot be assembled all along the motion, between its poses too"
        yield Alert(what, "subject_to=compoundkin.goals.assembles() leads to one that can")
    yield Paragraph(f"What keeps it from being better: {listed(found.binding)}." if found.binding
                    else "Nothing binds: no dimension is at a bound, no constraint at its limit.")  # fmt: skip


def _changes(found: Optimum) -> TableBlock:
    """Return all free numbers before and after, with their bounds."""
    rows: list[tuple[Cell, ...]] = []
    for one in found.changes:
        factor, unit = (degrees(1.0), DEGREES) if one.unit == RADIANS else (1.0, one.unit)
        values = (float(factor * value) for value in (one.before, one.after, one.after - one.before, one.low, one.high))
        said = f"{one.binds} bound" if one.binds else "" if one.matters else "changes nothing asked"
        rows.append((one.name, unit, *values, said))
    words = (Column(word, style="each") for word in ("before", "after", "change", "low", "high"))
    return TableBlock((Column("dimension"), Column("unit"), *words, Column("at")), tuple(rows), keys=1)


def _constraints(found: Optimum) -> TableBlock:
    rows: list[tuple[Cell, ...]] = []
    for one in found.constraints:
        margin = Quantity(one.told, one.unit, np.array([one.margin])).shown
        rows.append((one.told, float(margin.values[0]), margin.unit, one.is_held, "binds" if one.binds else ""))
    heads = Column("constraint"), Column("least margin", style="each"), Column("unit"), Column("", style="passed")
    return TableBlock((*heads, Column("")), tuple(rows), keys=1)


def _unknowns(found: Optimum) -> TableBlock:
    """Return what goals found beside the dimensions, as they have it."""
    return TableBlock((Column("number"), Column("value", style="each")), tuple(found.unknowns.items()), keys=1)


def _minima(found: Optimum) -> Iterator[Block]:
    """Yield how many searches ended where, and the designs there."""
    searches = "1 search" if found.starts == 1 else f"{found.starts:,} searches"
    yield Paragraph(
        f"{found.assembled:,} of {counted(found.screened, 'design')} looked at first are assembled. {searches} began "
        f"at the best of them; {found.agreed:,} ended at an objective as good as the best."
    )
    yield Paragraph(
        f"In all {counted(found.evaluations, 'design')} were looked at in {number(round(found.seconds, 2))} s; "
        f"the best ends were refined by {found.method} of SciPy."
    )
    several = found.minima[:MOST_MINIMA]
    some = f" {len(several)} of {len(found.minima)}" if len(several) < len(found.minima) else ""
    yield Paragraph(f"Designs at which searches ended, the best{some}:")
    yield _designs(found, several)


def _designs(found: Optimum, several: tuple[LocalMinimum, ...]) -> TableBlock:
    """Return designs with their objectives, how many searches ended there, and all free numbers."""
    free = [one.name for one in found.changes]
    units = [DEGREES if one.unit == RADIANS else one.unit for one in found.changes]
    heads = (
        Column("place", style="each"),
        Column("objective", shown_objective(found, 0.0).unit, "each"),
        Column("searches", style="each"),
        *([Column("holds", style="passed")] if found.constraints else []),
        *(Column(name, unit, "each") for name, unit in zip(free, units, strict=True)),
    )
    rows: list[tuple[Cell, ...]] = []
    for k, one in enumerate(several, 1):
        numbers = [part for value in one.dimensions.values() for part in _real(value)]
        shown = [float(degrees(v)) if unit == DEGREES else v for v, unit in zip(numbers, units, strict=True)]
        objective = float(shown_objective(found, one.value).values)
        held = [one.is_held] if found.constraints else []
        rows.append((k, objective, len(one.searches), *held, *shown))
    return TableBlock(heads, tuple(rows), keys=1)


def _real(value: complex) -> tuple[float, ...]:
    """Return the real numbers of a dimension."""
    return (value.real, value.imag) if isinstance(value, complex) else (float(value),)
