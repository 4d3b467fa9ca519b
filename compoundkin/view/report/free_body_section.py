"""The section of a free body: all that acts on one link, as a table at every pose told."""

from __future__ import annotations

from collections.abc import Iterator

from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.named_forces.link_forces import LinkForces
from compoundkin.model.elements import FRAME
from compoundkin.view.report.force_assumptions import assumptions
from compoundkin.view.report.force_measures import ROUNDING, largest_of
from compoundkin.view.report.report_data import Block, Cell, Column, Paragraph, Section, TableBlock
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.report.wording import number

# A free body is told at all of so many poses; of more at the first one.
SHOWN = 8


def free_body_section(forces: Forces, link: str, design: int = 0) -> Section:
    """Return all that acts on a link. Raises UnknownName for a link that there is not."""
    own = forces.on(link)
    return Section("free-body", f"Forces on {link}", tuple(_blocks(Sample(forces.motion, design), forces, own)))


def _blocks(sample: Sample, forces: Forces, own: LinkForces) -> Iterator[Block]:
    yield Paragraph(f"Assumed: {'; '.join(assumptions(sample, forces))}.")
    what = "what the ground must hold" if own.link == FRAME else "which is zero in equilibrium"
    yield Paragraph(
        f"Each force at its point of attack, in the axes of the frame, its moment about that point; the sum, {what}."
    )
    column, values = sample.places
    shown = range(sample.poses) if sample.poses <= SHOWN else range(1)
    for pose in shown:
        unit = f" {column.unit}" if column.unit else ""
        more = "" if len(shown) == sample.poses else f", the first of {sample.poses} poses"
        yield Paragraph(f"At {column.name} {number(float(values[pose]))}{unit}{more}:")
        if not sample.assembled[pose]:
            yield Paragraph("It cannot be assembled there.")
            continue
        yield _table(sample, forces, own, pose)


def _table(sample: Sample, forces: Forces, own: LinkForces, pose: int) -> TableBlock:
    """What acts at a pose, a row each, and their sum."""
    units, floor = forces.units, ROUNDING * largest_of(forces)
    rows: list[tuple[Cell, ...]] = []
    for one in own:
        place, force = complex(sample.of(one.place)[pose]), complex(sample.of(one.force)[pose])
        named = one.at or f"({number(place.real)}, {number(place.imag)})"
        moment = float(sample.of(one.moment)[pose])
        rows.append((one.kind, one.name, one.by, named, (force.real, force.imag), abs(force), moment))
    whole, about = complex(sample.of(own.force)[pose]), float(sample.of(own.moment_about(0j))[pose])
    rows.append(("sum", "", "", "the origin", (whole.real, whole.imag), abs(whole), about))
    words = Column("kind"), Column("name"), Column("by"), Column("at")
    numbers = (Column("force", units.force, "each", floor), Column("size", units.force, "each", floor),
               Column("moment", units.moment, "each", floor * forces.motion.size))  # fmt: skip
    return TableBlock((*words, *numbers), tuple(rows), keys=2)
