"""Reports of studies, tolerance analyses, optimisations and comparisons of two mechanisms."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from compoundkin.analysis.common_pose import scale_of_units
from compoundkin.analysis.comparison import ROUNDING, MechanismComparison
from compoundkin.base.arrays import Number, degrees
from compoundkin.kinematics.quantities import ASSEMBLED, Quantity
from compoundkin.model.attributes import DEGREES, GREATEST, LEAST, PARTS, RADIANS, with_unit
from compoundkin.model.geometry import FRAME
from compoundkin.studies.optimisation.optimum import LocalMinimum, Optimum
from compoundkin.studies.study_program import CIRCUIT, ORDER_DEFECT, REASON, ROW, StudyColumn
from compoundkin.studies.study_result import StudyResult
from compoundkin.studies.tolerances.output_tolerance import OutputTolerance
from compoundkin.studies.tolerances.tolerance_analysis import ToleranceAnalysis
from compoundkin.view.report.pose_sample import Sample
from compoundkin.view.report.report_data import (
    Alert,
    Block,
    Cell,
    Column,
    Outcome,
    Paragraph,
    Section,
    Style,
    TableBlock,
)
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.verification_sections import checks_table, outcome_of
from compoundkin.view.report.wording import brief, counted, listed, number_text, objective_quantity, objective_text

PERCENTILES = (5.0, 25.0, 50.0, 75.0, 95.0)
# At most so many reasons and circuits are listed, the most frequent first.
MOST_STATES = 12
# Before where in the motion it is that a design does not assemble.
_PLACE = re.compile(" (at|between) ")
# Significant digits of errors and shares.
DIGITS = 4
# At most so many designs at which searches ended are listed, the best first.
MOST_MINIMA = 8
# Speeds that differ by no more than this part are the same: some programs have rpm of three decimals.
_SAME_SPEED = 1e-3
# So many rows with the least values of a figure are listed, and as many with the greatest.
BEST = 3


def whole_study_report(
    what: StudyResult | ToleranceAnalysis | Optimum | MechanismComparison, outputs: Sequence[str]
) -> Report:
    """Report a study, a tolerance analysis, an optimisation or a comparison as a whole."""
    if isinstance(what, ToleranceAnalysis):
        return tolerance_report(what, outputs)
    if isinstance(what, Optimum):
        return optimum_report(what, outputs)
    if isinstance(what, MechanismComparison):
        return comparison_report(what)
    return study_report(what, outputs, outputs, BEST)


def study_report(found: StudyResult, least: Sequence[str] = (), greatest: Sequence[str] = (), best: int = 1) -> Report:
    """Report a study, with the `best` designs of least and of greatest values of figures.

    Raises UnknownName and InvalidInput for names that are no figures of the study.
    """
    closed = found.counts(ASSEMBLED)[True]
    figures = [*((name, False) for name in least), *((name, True) for name in greatest)]
    tables = [block for name, is_greatest in figures for block in _best_designs(found, name, best, is_greatest)]
    sections = [
        Section("study", "Study", tuple(_study_about(found, closed))),
        Section("figures", "Figures", (_figures_table(found),)) if closed else None,
        Section("states", "States", tuple(_state_blocks(found))),
        Section("best", "Best designs", tuple(tables)) if tables else None,
    ]
    reference = found.reference
    courses = tuple(one.name for one in found.columns if one.width)
    shown = tuple(one for one in sections if one and one.blocks)
    return Report(found.study.mechanism.title, shown, outcome_of(reference), reference, courses, studied=found)


def _study_about(found: StudyResult, closed: int) -> Iterator[Block]:
    study, rows = found.study, len(found)
    share = f"; {number_text(100.0 * closed / rows)} % of them assemble over the whole range" if rows else ""
    sample = study.sample.data["sample"]
    kind = sample if isinstance(sample, str) else "grid"
    yield Paragraph(f"{counted(rows, 'design')} by {listed(study.dimensions)} ({kind}){share}.")
    if not found.is_complete:
        yield Paragraph(f"The study has {counted(len(study), 'row')}; run it again to go on.")
    courses = [column.name for column in found.columns if column.width]
    if courses:
        yield Paragraph(f"Courses, a value at every pose: {listed(courses)}.")


def _figures_table(found: StudyResult) -> TableBlock:
    """Return how dimensions and figures are distributed over the designs that assemble."""
    rows: list[tuple[Cell, ...]] = []
    for column in _figure_columns(found):
        factor, unit = _display_unit(column)
        known = found.percentiles(column.name, (0.0, *PERCENTILES, 100.0), factor=factor)
        if known:
            rows.append((column.name, unit, *known))
    named = (LEAST, *(f"{share:g} %" for share in PERCENTILES), GREATEST)
    heads = (Column(name, style="each") for name in named)
    return TableBlock((Column("of"), Column("unit"), *heads), tuple(rows), keys=1)


def _state_blocks(found: StudyResult) -> Iterator[Block]:
    """Yield why designs do not assemble, and on how many circuits the others are."""
    reasons = found.counts(REASON)
    del reasons[None]
    if reasons:
        yield Paragraph("What does not assemble:")
        yield _reasons_table(reasons)
    circuits = found.counts(CIRCUIT, assembled=True)
    if len(circuits) > 1:
        yield Paragraph("The others are on these circuits:")
        rows = tuple((count, text) for text, count in circuits.most_common(MOST_STATES))
        yield TableBlock((Column("designs", style="each"), Column("on")), rows)
    wrong = found.counts(ORDER_DEFECT)[True]
    if wrong:
        yield Paragraph(f"{counted(wrong, 'design')} with the poses not in one sense.")


def _reasons_table(reasons: Counter[str]) -> TableBlock:
    """Return how many designs fail by what, wherever in the motion, and where most of these do."""
    counts: Counter[str] = Counter()
    most: dict[str, str] = {}
    for text, count in reasons.most_common():
        what, *place = _PLACE.split(text, maxsplit=1)
        counts[what] += count
        most.setdefault(what, " ".join(place))
    rows = tuple((count, what, most[what]) for what, count in counts.most_common(MOST_STATES))
    return TableBlock((Column("designs", style="each"), Column("why"), Column("most often")), rows)


def _best_designs(found: StudyResult, name: str, count: int, is_greatest: bool) -> Iterator[Block]:
    """Yield the designs with the least or the greatest values of a figure."""
    yield Paragraph(f"The {GREATEST if is_greatest else LEAST} {name}:")
    rows = found.best(name, count, greatest=is_greatest)
    columns = sorted(_figure_columns(found), key=lambda column: column.name != name)
    heads = (Column(one.name, _display_unit(one)[1], "each") for one in columns)
    cells = tuple((int(row[ROW]), *(_figure_cell(row, one) for one in columns)) for row in rows)
    yield TableBlock((Column(ROW, style="each"), *heads), cells, keys=1)


def _figure_cell(row: dict[str, Any], column: StudyColumn) -> Cell:
    """Return the number of a row in a column; vectors have their parts there."""
    vector, _, part = column.name.rpartition(".")
    value = row[column.name] if column.name in row else PARTS[part](row[vector])
    return float(value * _display_unit(column)[0])


def _figure_columns(found: StudyResult) -> list[StudyColumn]:
    """Return the dimensions and the figures: one number for each design."""
    return [one for one in found.columns if one.is_figure]


def _display_unit(column: StudyColumn) -> tuple[float, str]:
    """Return the factor to the display unit, and that unit."""
    return (float(degrees(1.0)), DEGREES) if column.unit == RADIANS else (1.0, column.unit)


def tolerance_report(found: ToleranceAnalysis, outputs: Sequence[str] = ()) -> Report:
    """Report what tolerances do to outputs: those named, else all of them.

    Raises UnknownName for an output that there is not.
    """
    chosen = [found[name] for name in outputs] or list(found.values())
    motion = found.motion
    courses = [one for one in chosen if one.is_course]
    sections = (
        Section("tolerances", "Tolerances", tuple(_tolerance_about(found))),
        Section("errors", "Errors of the outputs", tuple(_error_blocks(found, chosen))),
        Section("contributions", "What contributes", tuple(_contribution_blocks(found, chosen))),
        *([Section("bands", "Over the motion", tuple(_band_blocks(found, courses)))] if courses else []),
    )
    names = tuple(one.name for one in courses)
    return Report(found.mechanism.title, sections, outcome_of(motion), motion, names, studied=found)


def _tolerance_about(found: ToleranceAnalysis) -> Iterator[Block]:
    sigmas = number_text(found.chances.sigmas)
    yield Paragraph(
        f"{counted(len(found.sources), 'source')} of errors: {listed(one.name for one in found.sources)}. "
        f"Limits lie {sigmas} standard deviations from the middle."
    )
    left_out = f", of which {found.unassembled:,} cannot be assembled and are left out" if found.unassembled else ""
    yield Paragraph(
        "Worst cases and standard deviations are to first order, by exact slopes; percentiles are those of "
        f"{counted(found.count, 'random design')}{left_out}, each with its standard error."
    )


def output_quantity(one: OutputTolerance, values: Number | float) -> Quantity:
    """Return values of an output as people read them, angles in degrees."""
    return Quantity(one.name, one.unit, np.asarray(values, dtype=float)).shown


def worst_pose(one: OutputTolerance) -> int | None:
    """Return the pose at which the deviation of a course is greatest."""
    return int(np.argmax(np.where(np.isfinite(one.deviation), one.deviation, -1.0))) if one.is_course else None


def _error_blocks(found: ToleranceAnalysis, chosen: Sequence[OutputTolerance]) -> Iterator[Block]:
    """Yield the errors of each output, of a course where its deviation is greatest."""
    column, places = Sample(found.motion).places
    heads = Column("output"), Column("unit"), Column(column.name, column.unit, "each")
    rows, sampled = list[tuple[Cell, ...]](), list[tuple[Cell, ...]]()
    for one in chosen:
        pose = worst_pose(one)
        head = one.name, output_quantity(one, 0.0).unit, None if pose is None else float(places[pose])
        errors = [_value_at(one, values, pose) for values in (one.nominal, one.low, one.high, one.deviation)]
        rows.append((*head, *errors[:-1], _rounded(errors[-1])))
        of = zip(found.percentiles, one.sample.percentiles, one.sample.percentile_errors, strict=True)
        sampled += [
            (*head, percent, _value_at(one, own, pose), _rounded(_value_at(one, error, pose)))
            for percent, own, error in of
        ]
    some = ", of courses where that is greatest" if any(one.is_course for one in chosen) else ""
    yield Paragraph(f"Nominal values, worst cases and the standard deviation{some}:")
    words = (Column(word, style="each") for word in ("nominal", "worst low", "worst high", "deviation"))
    yield TableBlock((*heads, *words), tuple(rows), keys=1)
    yield Paragraph("Percentiles of the random designs there:")
    words = (Column(word, unit, "each") for word, unit in (("percentile", "%"), ("value", ""), ("standard error", "")))
    yield TableBlock((*heads, *words), tuple(sampled), keys=1)


def _value_at(one: OutputTolerance, values: Number, pose: int | None) -> float:
    """Return a value of an output at a pose in its display unit."""
    return float(output_quantity(one, values if pose is None else values[pose]).values)


def _contribution_blocks(found: ToleranceAnalysis, chosen: Sequence[OutputTolerance]) -> Iterator[Block]:
    """Yield a table for each output: its sources, the greatest share of the variance first."""
    for one in chosen:
        pose = worst_pose(one)
        column, places = Sample(found.motion).places
        where = "" if pose is None else f" at {column.name} {with_unit(number_text(float(places[pose])), column.unit)}"
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


def _band_blocks(found: ToleranceAnalysis, courses: Sequence[OutputTolerance]) -> Iterator[Block]:
    """Yield the nominal course and its errors, at the poses that tables show."""
    sample = Sample(found.motion)
    column, places = sample.places
    heads, cells = [column], [[float(places[pose]) for pose in sample.rows]]
    for one in courses:
        quantities = {"": one.nominal, " worst": one.worst, " deviation": one.deviation}
        for word, values in quantities.items():
            own = output_quantity(one, values)
            style: Style = "each" if word else "fixed"
            heads.append(Column(f"{one.name}{word}", own.unit, style, follows=bool(word)))
            cells.append([float(own.values[p]) if not word else _rounded(float(own.values[p])) for p in sample.rows])
    yield Paragraph("The worst case and the standard deviation are errors to either side of the middle:")
    yield TableBlock(tuple(heads), tuple(zip(*cells, strict=True)), keys=1)


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def optimum_report(found: Optimum, outputs: Sequence[str] = ()) -> Report:
    """Report a search of better dimensions; its page plots `outputs`."""
    check, motion = found.check, found.motion
    sections = (
        Section("optimum", "Better dimensions", tuple(_optimum_about(found))),
        Section("changes", "What changed", (_changes_table(found),)),
        *([Section("constraints", "Constraints", (_constraints_table(found),))] if found.constraints else []),
        *([Section("unknowns", "Found beside", (_unknowns_table(found),))] if found.unknowns else []),
        Section("minima", "How sure", tuple(_minima_blocks(found))),
        Section("checks", "Checks of the answer", (checks_table(motion, check),)),
    )
    return Report(found.mechanism.title, sections, outcome_of(motion, check), motion, outputs, studied=found)


def _optimum_about(found: Optimum) -> Iterator[Block]:
    yield Paragraph(f"What shall be least: {listed(one.description for one in found.goals)}.")
    squares = "sum of squares" if all(one.is_squares for one in found.goals) else "objective"
    before = f"from {objective_text(found, found.value_before)} " if np.isfinite(found.value_before) else ""
    yield Paragraph(f"The {squares} came {before}to {objective_text(found, found.value)}.")
    if not np.isfinite(found.value_before):
        yield Paragraph("The mechanism as it stood has no objective: it cannot be assembled over the whole motion.")
    if not found.is_held:
        broken = listed(one.description for one in found.constraints if not one.is_held)
        yield Alert(f"Not all constraints hold: {broken}", "widen the ranges of dimensions, or ask for less")
    if not found.is_whole:
        what = "It cannot be assembled all along the motion, between its poses too"
        yield Alert(what, "subject_to=compoundkin.goals.assembles() leads to one that can")
    yield Paragraph(f"What keeps it from being better: {listed(found.binding)}." if found.binding
                    else "Nothing binds: no dimension is at a bound, no constraint at its limit.")  # fmt: skip


def _changes_table(found: Optimum) -> TableBlock:
    """Return all free numbers before and after, with their bounds."""
    rows: list[tuple[Cell, ...]] = []
    for one in found.changes:
        factor, unit = (degrees(1.0), DEGREES) if one.unit == RADIANS else (1.0, one.unit)
        values = (float(factor * value) for value in (one.before, one.after, one.after - one.before, one.low, one.high))
        note = f"{one.binds} bound" if one.binds else "" if one.matters else "affects no goal"
        rows.append((one.name, unit, *values, note))
    words = (Column(word, style="each") for word in ("before", "after", "change", "low", "high"))
    return TableBlock((Column("dimension"), Column("unit"), *words, Column("at")), tuple(rows), keys=1)


def _constraints_table(found: Optimum) -> TableBlock:
    rows: list[tuple[Cell, ...]] = []
    for one in found.constraints:
        margin = Quantity(one.description, one.unit, np.array([one.margin])).shown
        rows.append((one.description, float(margin.values[0]), margin.unit, one.is_held, "binds" if one.binds else ""))
    heads = Column("constraint"), Column("least margin", style="each"), Column("unit"), Column("", style="passed")
    return TableBlock((*heads, Column("")), tuple(rows), keys=1)


def _unknowns_table(found: Optimum) -> TableBlock:
    """Return the numbers that goals determined beside the dimensions."""
    return TableBlock((Column("number"), Column("value", style="each")), tuple(found.unknowns.items()), keys=1)


def _minima_blocks(found: Optimum) -> Iterator[Block]:
    """Yield how many searches ended where, and the designs there."""
    searches = "1 search" if found.starts == 1 else f"{found.starts:,} searches"
    yield Paragraph(
        f"{found.assembled:,} of {counted(found.screened, 'design')} looked at first are assembled. {searches} began "
        f"at the best of them; {found.agreed:,} ended at an objective as good as the best."
    )
    yield Paragraph(
        f"In all {counted(found.evaluations, 'design')} were looked at in {number_text(round(found.seconds, 2))} s; "
        f"the best ends were refined by {found.method} of SciPy."
    )
    several = found.minima[:MOST_MINIMA]
    some = f" {len(several)} of {len(found.minima)}" if len(several) < len(found.minima) else ""
    yield Paragraph(f"Designs at which searches ended, the best{some}:")
    yield _minima_table(found, several)


def _minima_table(found: Optimum, several: tuple[LocalMinimum, ...]) -> TableBlock:
    """Return designs with their objectives, how many searches ended there, and all free numbers."""
    free = [one.name for one in found.changes]
    units = [DEGREES if one.unit == RADIANS else one.unit for one in found.changes]
    heads = (
        Column("place", style="each"),
        Column("objective", objective_quantity(found, 0.0).unit, "each"),
        Column("searches", style="each"),
        *([Column("holds", style="passed")] if found.constraints else []),
        *(Column(name, unit, "each") for name, unit in zip(free, units, strict=True)),
    )
    rows: list[tuple[Cell, ...]] = []
    for k, one in enumerate(several, 1):
        numbers = [part for value in one.dimensions.values() for part in _real_parts(value)]
        shown = [float(degrees(v)) if unit == DEGREES else v for v, unit in zip(numbers, units, strict=True)]
        objective = float(objective_quantity(found, one.value).values)
        held = [one.is_held] if found.constraints else []
        rows.append((k, objective, len(one.searches), *held, *shown))
    return TableBlock(heads, tuple(rows), keys=1)


def _real_parts(value: complex) -> tuple[float, ...]:
    """Return the real numbers of a dimension."""
    return (value.real, value.imag) if isinstance(value, complex) else (float(value),)


def comparison_report(found: MechanismComparison) -> Report:
    """Report two mechanisms side by side."""
    one, other = (structure.mechanism for structure in found.structures)
    sections = (
        Section("about", "", tuple(_comparison_about(found))),
        Section("structure", "Structure", (_structure_table(found),)),
        *([Section("points", "Motion", tuple(_distance_blocks(found)))] if found.places else []),
        *([Section("drivers", "Drivers", tuple(_driver_blocks(found)))] if found.drivers else []),
        *([Section("dimensions", "Dimensions", tuple(_dimension_blocks(found)))] if found.lengths else []),
    )
    outcome = Outcome(not any(s.faults for s in found.structures), found.poses + found.apart, found.poses)
    # of the structure a page has the sketch alone, not the dimensions to be changed, which belong to the first only
    return Report(f"{one.title} / {other.title}", sections, outcome, found.structures[0], studied=found)


def _comparison_about(found: MechanismComparison) -> Iterator[Block]:
    """Yield what is compared, how the two fit onto each other, and what it comes to."""
    one, other = (structure.mechanism for structure in found.structures)
    yield Paragraph(f"First: {one.title}, {one.in_numbers}. Second: {other.title}, {other.in_numbers}.")
    if found.matched_by:
        how = "places at a pose that both have" if found.matched_by == "place" else "names"
        scaled = "" if found.scale == 1.0 else f" Lengths of the second count {number_text(found.scale)} times."
        yield Paragraph(f"Points stand for each other by their {how}.{scaled}")
        units = scale_of_units(one, other)
        if units is not None and abs(found.scale / units - 1.0) > ROUNDING:
            yield Paragraph(
                f"By their units the second is {number_text(units / found.scale)} times as large as the first."
            )
    alone = (("the first", found.only_one), ("the second", found.only_other))
    for which, letters in alone if found.points else ():
        if letters:
            yield Paragraph(f"Only {which} has {counted(len(letters), 'point')}: {listed(letters)}.")
    yield Paragraph(f"In short: {_comparison_verdict(found)}.")


def _comparison_verdict(found: MechanismComparison) -> str:
    """Return what it comes to, with where that is."""
    largest = found.largest
    if largest is None or largest.distance <= ROUNDING * found.size:
        return found.verdict
    angles = found.structures[0].driven_angles
    values = (
        f"{k} {with_unit(number_text(float(degrees(v))), DEGREES)}" if angles[k] else f"{k} {number_text(v)}"
        for k, v in largest.drives.items()
    )
    return f"{found.verdict} with {listed(values)}, {brief(largest.distance / found.size)} of the size"


def _structure_table(found: MechanismComparison) -> Block:
    rows = tuple((fact.what, fact.one, fact.other, "differs" if fact.differs else "") for fact in found.facts)
    return TableBlock((Column(""), Column("first"), Column("second"), Column("")), rows)


def _distance_blocks(found: MechanismComparison) -> Iterator[Block]:
    """Yield how far apart points and links come, and where."""
    unit, floor = found.structures[0].mechanism.unit, ROUNDING * found.size
    yield Paragraph(
        f"Driven alike from the common pose, {counted(found.poses, 'pose')} of both; the greatest distance of each "
        "point, and the first's drivers there:"
    )
    where = _driver_columns(found)
    points = Column("point"), Column("second's"), Column("distance", unit, "each", floor)
    rows = tuple((one.point, one.other, one.distance, *_driver_cells(found, one.drives)) for one in found.places)
    yield TableBlock((*points, *where), rows, keys=1)
    if found.turns:
        yield Paragraph("Links without two points that tell how they turn, counted from the first pose:")
        links = Column("link"), Column("second's"), Column("angle", "deg", "each", float(degrees(ROUNDING)))
        turned = tuple(
            (one.link, one.other, float(degrees(one.angle)), *_driver_cells(found, one.drives)) for one in found.turns
        )
        yield TableBlock((*links, *where), turned, keys=1)


def _driver_columns(found: MechanismComparison) -> tuple[Column, ...]:
    unit, angles = found.structures[0].mechanism.unit, found.structures[0].driven_angles
    return tuple(Column(f"at {one.name}", "deg" if angles[one.name] else unit, "fixed") for one in found.drivers)


def _driver_cells(found: MechanismComparison, drives: Mapping[str, float]) -> Iterator[Cell]:
    for one in found.drivers:
        yield float(degrees(drives[one.name])) if one.is_angle else drives[one.name]


def _driver_blocks(found: MechanismComparison) -> Iterator[Block]:
    """Yield the drivers, their values at the common pose, and the range of displacements from there."""
    differing = [one for one in found.drivers if abs(one.speed - one.other_speed) > _SAME_SPEED * abs(one.speed)]
    if differing:
        unit = found.structures[0].mechanism.unit or "1"
        speeds = (
            f"{one.name} has {number_text(one.speed)}, in the second {number_text(one.other_speed)} "
            f"{'rad' if one.is_angle else unit}/s"
            for one in differing
        )
        yield Paragraph(f"Speeds differ, and are not compared: {listed(speeds)}.")
    rows: list[tuple[Cell, ...]] = []
    for one in found.drivers:
        unit = "deg" if one.is_angle else found.structures[0].mechanism.unit
        values = one.start, one.other_start, *one.reach
        shown = [float(degrees(value)) if one.is_angle else value for value in values]
        way = "the same" if one.sign > 0 else "the other"
        rows.append((one.name, one.other, way, *shown, unit))
    words = ("first at the common pose", "second there", "moved from", "to")
    numbers = (Column(word, style="each", floor=ROUNDING * max(found.size, 360.0)) for word in words)
    yield TableBlock((Column("driver"), Column("second's"), Column("way"), *numbers, Column("unit")), tuple(rows))


def _dimension_blocks(found: MechanismComparison) -> Iterator[Block]:
    """Yield the distances of points on links, and by how much they differ."""
    unit, floor = found.structures[0].mechanism.unit, ROUNDING * found.size
    rows = tuple(
        (one.link, "-".join(one.points), one.other_link, "-".join(one.other_points), one.one, one.other, one.difference)
        for one in found.lengths
    )
    alone = [name for name in found.structures[0].mechanism.links if name not in found.links and name != FRAME]
    if alone:
        yield Paragraph(f"No link of the second stands for {listed(alone)}.")
    yield Paragraph("Distances of points on the links:")
    heads = Column("link"), Column("points"), Column("second's"), Column("its points")
    numbers = Column("first", unit, "each"), Column("second", unit, "each"), Column("difference", unit, "each", floor)
    yield TableBlock((*heads, *numbers), rows)
