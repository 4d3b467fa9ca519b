"""The section on the linkage of pins and slides that stands for higher pairs at one pose."""

from __future__ import annotations

import numpy as np

from compoundkin.analysis.equivalents import replaced
from compoundkin.base.errors import CompoundkinError
from compoundkin.structure import decompose, roman
from compoundkin.view.report.report_data import Cell, Column, Paragraph, Section, TableBlock
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.report.wording import listed


def equivalent_section(sample: Sample) -> Section | None:
    """What stands for each higher pair at the first pose with rates, and the groups that result; None without any."""
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
        f"Its groups: {listed(groups) or 'none'}."
    )
    return Section("equivalent", "Equivalent linkage", (Paragraph(text), TableBlock(columns, rows)))


def _link(length: float | None) -> tuple[Cell, Cell]:
    return ("a block", None) if length is None else ("a bar", length)


def _place(centre: complex | None) -> str:
    return "straight" if centre is None else f"({centre.real:.6g}, {centre.imag:.6g})"
