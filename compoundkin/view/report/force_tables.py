"""Tables of forces: reactions, drivers, what the frame is shaken by."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from compoundkin.base.series import Number
from compoundkin.dynamics.forces import Forces
from compoundkin.kinematics.extremes import Extremes
from compoundkin.model.elements import FRAME
from compoundkin.view.report.extremes_blocks import extremes_columns, extremes_row
from compoundkin.view.report.force_measures import (
    ROUNDING,
    ForceFigure,
    force_extremes,
    largest_of,
    mean,
)
from compoundkin.view.report.report_data import Block, Cell, Column, Paragraph, TableBlock
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.report.wording import listed

# What is below this part of the largest moment, by forces and the size of the mechanism, is rounding.
NOTHING = 1e-9


def reaction_figures(forces: Forces) -> tuple[ForceFigure, ...]:
    """Return what is listed of pairs. The force, and its moment where there is one."""
    units = forces.units
    efforts = {driven.pair.name for driven in forces.motion.structure.driven.values()}
    found = []
    for name, own in forces.pairs.items():
        title = f"{name}, on {own.pair.members[1]}"
        found.append(ForceFigure(f"{title}|force", units.force, partial(_force, name), True))
        turns = own.pair.free_is_angle if name in efforts else False
        if not turns and not _is_nothing(forces, own.moment):
            found.append(ForceFigure(f"{title}|moment", units.moment, partial(_moment, name)))
    return tuple(found)


def _force(name: str, forces: Forces) -> Number:
    return np.abs(forces.pairs[name].force)


def _moment(name: str, forces: Forces) -> Number:
    found: Number = forces.pairs[name].moment
    return found


def _is_nothing(forces: Forces, moment: Number) -> bool:
    """Whether a moment is rounding at every pose."""
    values = np.abs(np.asarray(moment))
    largest = float(np.max(values, initial=0.0, where=np.isfinite(values)))
    return largest <= NOTHING * max(largest_of(forces) * forces.motion.size, 1e-300)


def reactions_blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    """Yield the extremes of the forces in all pairs."""
    figures = reaction_figures(forces)
    if not figures:
        return
    if sample.poses == 1:
        yield Paragraph("Reactions, the force on the second link of each pair, its size, and its moment there:")
        yield _at_one_pose(sample, forces)
        return
    told = "Reactions, the force on the second link of each pair, between the poses too"
    yield Paragraph(f"{told}. Least and greatest:")
    rows = []
    for figure, row in zip(figures, extremes_rows(sample, forces, figures), strict=True):
        (pair, _, on), _, what = figure.name.partition("|")[0].partition(", on "), "", figure.name.partition("|")[2]
        rows.append((pair, on, what, figure.unit, *row))
    columns = Column("pair"), Column("on"), Column("quantity"), Column("unit"), *extremes_columns(sample)
    yield TableBlock(columns, tuple(rows), keys=1)


def _at_one_pose(sample: Sample, forces: Forces) -> TableBlock:
    """The forces themselves."""
    rows: list[tuple[Cell, ...]] = []
    for name, one in forces.pairs.items():
        force, moment = complex(sample.of(one.force)[0]), float(sample.of(one.moment)[0])
        rows.append((name, one.pair.members[1], (force.real, force.imag), abs(force), moment))
    floor = ROUNDING * largest_of(forces)
    units = forces.units
    numbers = (Column("force", units.force, "each", floor), Column("size", units.force, "each", floor),
               Column("moment", units.moment, "each", floor * forces.motion.size))  # fmt: skip
    return TableBlock((Column("pair"), Column("on"), *numbers), tuple(rows), keys=1)


def extremes_rows(sample: Sample, forces: Forces, figures: Sequence[ForceFigure]) -> list[tuple[Cell, ...]]:
    """Return the extremes of figures with their places; at a single pose its value."""
    floor = ROUNDING * largest_of(forces)
    if sample.poses > 1:
        found: tuple[Extremes, ...] = force_extremes(forces, tuple(figures))
        return [extremes_row(sample, one, sample.design, floor) for one in found]
    return [_at_poses(sample, np.asarray(sample.of(figure.of(forces)))) for figure in figures]


def _at_poses(sample: Sample, values: Number) -> tuple[Cell, ...]:
    if not np.isfinite(values).any():
        return (None,) * 4
    places = sample.places[1]
    low, high = int(np.nanargmin(values)), int(np.nanargmax(values))
    return float(values[low]), float(places[low]), float(values[high]), float(places[high])


def drives_blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    """Yield what each driver does: its effort with mean and extremes, its power."""
    figures = tuple(figure for name in forces.drives for figure in _drive_figures(forces, name))
    if not figures:
        return
    yield Paragraph("Drivers, the torque or thrust along the driver's own coordinate, positive where it drives it up:")
    rows = []
    for figure, row in zip(figures, extremes_rows(sample, forces, figures), strict=True):
        values = np.asarray(figure.of(forces))
        root = float(np.sqrt(mean(forces, values**2, sample.design)))
        average = mean(forces, values, sample.design)
        average = 0.0 if abs(average) <= NOTHING * root else average
        rows.append((*figure.name.split("|"), figure.unit, average, root, *row))
    first = Column("driver"), Column("quantity"), Column("unit")
    columns = (*first, Column("mean", style="each"), Column("rms", style="each"), *extremes_columns(sample))
    yield TableBlock(columns, tuple(rows), keys=1)


def _drive_figures(forces: Forces, name: str) -> Iterator[ForceFigure]:
    units, is_angle = forces.units, forces.motion.drives[name].is_angle
    what, unit = ("torque", units.moment) if is_angle else ("thrust", units.force)
    yield ForceFigure(f"{name}|{what}", unit, partial(_effort, name))
    if forces.motion.order:
        yield ForceFigure(f"{name}|power", units.power, partial(_power, name))


def _effort(name: str, forces: Forces) -> Number:
    found: Number = forces.drives[name].effort
    return found


def _power(name: str, forces: Forces) -> Number:
    found: Number = forces.drives[name].power
    return found


def shaking_blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    """Yield the shaking force, and its moment about a point of the frame."""
    letter = frame_point(forces)
    units = forces.units
    about = letter or "the origin"
    figures = (ForceFigure("force", units.force, _shaking, True),
               ForceFigure(f"moment about {about}", units.moment, partial(_shaking_moment, letter)))  # fmt: skip
    yield Paragraph("The mechanism on its frame (shaking force), reactions of the drivers included:")
    rows = [(figure.name, figure.unit, *row)
            for figure, row in zip(figures, extremes_rows(sample, forces, figures), strict=True)]  # fmt: skip
    yield TableBlock((Column("on the frame"), Column("unit"), *extremes_columns(sample)), tuple(rows), keys=1)


def frame_point(forces: Forces) -> str:
    """Return the point of the frame about which moments are told.

    It is that of the first driver, else the first one; nothing for a frame without points.
    """
    points = forces.mechanism.geometry.points[FRAME]
    letters = [driven.pair.letters[0] for driven in forces.motion.structure.driven.values()]
    return next((one for one in (*letters, *points) if one in points), "")


def _shaking(forces: Forces) -> Number:
    return np.abs(forces.shaking.force)


def _shaking_moment(letter: str, forces: Forces) -> Number:
    return forces.shaking.moment_about(letter or 0j)


def undetermined(names: Sequence[str]) -> str:
    """Return what equilibrium does not determine, in a sentence."""
    return f"Equilibrium does not determine {listed(names)}: the mechanism is held by more than it needs."
