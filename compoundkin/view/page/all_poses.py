"""The outputs at all poses, where the report has every third or tenth of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from compoundkin.kinematics import Motion
from compoundkin.view.report.outputs_section import chosen_outputs, outputs_section
from compoundkin.view.report.report_data import Section, TableBlock
from compoundkin.view.report.shown_poses import Sample

OUTPUTS = "outputs"
# More cells than these make a page slow and large: the table then has the poses of the report.
MOST_CELLS = 12_000


@dataclass(frozen=True, eq=False)
class Whole(Sample):
    """A sample that shows every pose."""

    @property
    def rows(self) -> tuple[int, ...]:
        """All poses."""
        return tuple(range(self.poses))


def all_poses(
    sections: Sequence[Section], motion: Motion, outputs: Sequence[str], design: int
) -> tuple[Sequence[Section], tuple[int, ...]]:
    """The sections with the outputs at every pose, those of the report shown first; and the poses of the table's rows.

    `outputs` are those that the report was made with.
    """
    section = next((one for one in sections if one.key == OUTPUTS), None)
    table = _table(section)
    if section is None or table is None:
        return sections, ()
    sample = Sample(motion, design)
    if len(sample.rows) == sample.poses or sample.poses * len(table.columns) > MOST_CELLS:
        return sections, sample.rows
    whole = _table(outputs_section(Whole(motion, design), chosen_outputs(motion, outputs)))
    if whole is None or [c.name for c in whole.columns] != [c.name for c in table.columns]:
        # the report is about other outputs
        return sections, sample.rows
    full = replace(whole, shown=sample.rows)
    changed = replace(section, blocks=tuple(full if block is table else block for block in section.blocks))
    return tuple(changed if one is section else one for one in sections), tuple(range(sample.poses))


def _table(section: Section | None) -> TableBlock | None:
    """The first table of a section."""
    blocks = section.blocks if section else ()
    return next((block for block in blocks if isinstance(block, TableBlock)), None)
