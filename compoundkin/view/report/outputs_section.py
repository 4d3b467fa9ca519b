"""What moves: outputs over the cycle, and what stands for higher pairs at one pose."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from compoundkin.analysis.equivalents import replaced
from compoundkin.base.errors import CompoundkinError, InvalidInput
from compoundkin.kinematics.quantities import Quantity
from compoundkin.model.attributes import course_figure
from compoundkin.structure import decompose, roman
from compoundkin.view.report.extremes_blocks import SampleExtremes, cams_sections, extremes_blocks
from compoundkin.view.report.report_data import Block, Cell, Column, Paragraph, Section, TableBlock
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.report.wording import counted, listed, ordinal

_NOTHING = (Paragraph("No outputs are named."),)
# A mechanical advantage at a toggle position.
INFINITE = "inf"


def moving_sections(sample: Sample, outputs: Sequence[str]) -> tuple[Section, ...]:
    """Return the sections of the outputs, with their extremes, and of cams."""
    found = outputs_at_poses(sample, outputs)
    known = SampleExtremes(sample, found)
    figures = figures_blocks(sample, [name for name in outputs if course_figure(name)[1]])
    blocks = (Paragraph(_introduction(sample)), outputs_table(sample, found)) if found else _NOTHING
    moving = Section("outputs", "Outputs over the cycle", (*blocks, *extremes_blocks(known), *figures))
    return moving, *cams_sections(known)


def outputs_at_poses(sample: Sample, outputs: Sequence[str]) -> list[Quantity]:
    """Return the outputs without figures of the whole motion."""
    return [sample.quantity(name) for name in outputs if not course_figure(name)[1]]


def figures_blocks(sample: Sample, names: Sequence[str]) -> Iterator[Block]:
    """Yield the figures of the whole motion, or why one is not told."""
    rows: list[tuple[Cell, ...]] = []
    for name in names:
        try:
            found = sample.quantity(name)
        except InvalidInput as error:
            rows.append((name, "", None, error.problems[0].what))
            continue
        rows.append((name, found.unit, _cell(found.values[0]), ""))
    if rows:
        yield Paragraph("Over the whole motion:")
        yield TableBlock((Column("figure"), Column("unit"), Column("value", style="each"), Column("")), tuple(rows))


def outputs_table(sample: Sample, found: Sequence[Quantity]) -> TableBlock:
    """Return outputs at the poses that a sample shows, one row each."""
    drivers = [(sample.driver_column(driver), driver.values) for driver in sample.varying]
    # several drivers are columns like any other, and the poses are numbered or have their times
    first = drivers if len(drivers) == 1 and sample.times is None else [sample.places, *drivers]
    columns = [*first, *(column for one in found for column in _columns(sample, one))]
    rows = tuple(tuple(_cell(values[pose]) for _, values in columns) for pose in sample.rows)
    return TableBlock(tuple(column for column, _ in columns), rows, keys=1)


def _introduction(sample: Sample) -> str:
    every = "all" if sample.every == 1 else f"every {ordinal(sample.every)} of"
    text = f"{every} {counted(sample.poses, 'pose')}" if sample.poses > 1 else "a single pose"
    constant = [driver for driver in sample.drivers if driver not in sample.varying]
    held = [f"{driver.name} = {driver.values[0]:g} {driver.unit}" for driver in constant]
    missing = " A dash: not assembled." if not sample.assembled.all() else ""
    return f"{text[:1].upper() + text[1:]}{'; ' + listed(held) if held else ''}.{missing}"


def _columns(sample: Sample, found: Quantity) -> Iterator[tuple[Column, Any]]:
    """One column for a number, two for a vector."""
    floor = sample.floor(found)
    for k, part in enumerate(found.components):
        yield Column(part.name, part.unit, "fixed", floor, follows=k > 0), part.values


def _cell(value: Any) -> float | str | None:
    if np.isposinf(value):
        return INFINITE
    return float(value) if np.isfinite(value) else None


def equivalent_section(sample: Sample) -> Section | None:
    """Report what stands for each higher pair at the first pose with rates. None without any."""
    motion = sample.motion
    regular = np.flatnonzero(sample.of(np.broadcast_to(motion.regular, motion.failed.shape).reshape(motion.shape)))
    if not len(regular):
        return None
    at = sample.design * sample.poses + int(regular[0])
    try:
        linkage, found = replaced(motion, at)
    except CompoundkinError:
        return None
    if not found:
        return None
    rows = tuple((one.pair.name, one.pair.title, *_link(one.length), *map(_place, one.centres)) for one in found)
    columns = (
        Column("pair"), Column("kind"), Column("stands for it"), Column("length", style="each"),
        Column("centre on the first"), Column("centre on the second"),
    )  # fmt: skip
    groups = [f"{g.name} ({listed(g.links)}; class {roman(g.class_)})" for g in decompose(linkage).groups]
    text = (
        f"Pins and slides that give the same velocities and accelerations at pose {int(regular[0])}, and there only: a"
        " bar between the centres of curvature, or a block on a straight profile. "
        f"Its groups: {listed(groups) if groups else 'none'}."
    )
    return Section("equivalent", "Equivalent linkage", (Paragraph(text), TableBlock(columns, rows)))


def _link(length: float | None) -> tuple[Cell, Cell]:
    return ("a block", None) if length is None else ("a bar", length)


def _place(centre: complex | None) -> str:
    return "straight" if centre is None else f"({centre.real:.6g}, {centre.imag:.6g})"
