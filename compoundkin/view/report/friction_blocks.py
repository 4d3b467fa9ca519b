"""Friction in a report: what is written of it, its sizes and losses, efficiency, self-locking, wedging."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from compoundkin.base.series import Number
from compoundkin.dynamics.forces import Forces
from compoundkin.view.report.extremes_blocks import extremes_columns
from compoundkin.view.report.force_measures import ForceFigure, mean
from compoundkin.view.report.force_tables import extremes_rows
from compoundkin.view.report.load_tables import first_number
from compoundkin.view.report.report_data import Alert, Block, Cell, Column, Paragraph, TableBlock
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.report.wording import counted, listed, number

# So many stretches of poses are told one by one.
MOST = 6


def friction_words(forces: Forces) -> str:
    """Return the friction that is assumed, in words."""
    frictions = forces.mechanism.frictions.values()
    if not frictions:
        return "no friction"
    told = []
    for one in frictions:
        sizes = [f"{word} {number(first_number(value))}" for word, value in
                 (("radius", one.radius), ("length", one.length)) if value is not None]  # fmt: skip
        told.append(f"{one.pair} {number(first_number(one.coefficient))}{f' ({listed(sizes)})' if sizes else ''}")
    return f"Coulomb friction against the motion, coupled to the reactions: {listed(told)}; none elsewhere"


def friction_blocks(sample: Sample, forces: Forces) -> Iterator[Block]:
    """Yield sizes and losses of frictions, efficiency, and where it locks or wedges."""
    if not forces.friction.pairs:
        return
    yield Paragraph("Friction, on the second link of each pair, and the power that it takes:")
    figures = tuple(figure for name in forces.friction.pairs for figure in _figures(forces, name))
    rows: list[tuple[Cell, ...]] = []
    for figure, row in zip(figures, extremes_rows(sample, forces, figures), strict=True):
        average = mean(forces, figure.of(forces), sample.design)
        rows.append((*figure.name.split("|"), figure.unit, average, *row))
    first = Column("pair"), Column("quantity"), Column("unit"), Column("mean", style="each")
    yield TableBlock((*first, *extremes_columns(sample)), tuple(rows), keys=1)
    yield from _efficiency(sample, forces)
    yield from _stuck(sample, forces)


def _figures(forces: Forces, name: str) -> Iterator[ForceFigure]:
    units, is_moment = forces.units, forces.friction.pairs[name].is_moment
    what, unit = ("moment", units.moment) if is_moment else ("force", units.force)
    yield ForceFigure(f"{name}|{what}", unit, partial(_friction, name))
    yield ForceFigure(f"{name}|power", units.power, partial(_power, name))


def _friction(name: str, forces: Forces) -> Number:
    return forces.friction.pairs[name].friction


def _power(name: str, forces: Forces) -> Number:
    return forces.friction.pairs[name].power


def _efficiency(sample: Sample, forces: Forces) -> Iterator[Block]:
    """How much comes out over the whole motion, and the least at a pose."""
    whole = float(np.ravel(forces.efficiency.over_motion)[sample.design])
    at_poses = np.asarray(sample.of(forces.efficiency.at_poses))
    if not np.isfinite(whole):
        return
    worst = f"; at poses from {number(float(np.nanmin(at_poses)))} on" if np.isfinite(at_poses).any() else ""
    yield Paragraph(f"Efficiency over the motion, work out over work in: {number(whole)}{worst}.")


def _stuck(sample: Sample, forces: Forces) -> Iterator[Block]:
    """Where loads cannot move it, and where no forces or several satisfy Coulomb's law."""
    locked = [str(one) for one in forces.efficiency.self_locking_stretches if one.design == sample.design]
    if locked:
        yield Paragraph(f"Self-locking, loads cannot move it: {_some(locked)}.")
    for one in forces.friction.wedged[:MOST]:
        yield Alert(f"It is {one}.")


def _some(told: list[str]) -> str:
    more = [f"and {counted(len(told) - MOST, 'stretch')} more"] if len(told) > MOST else []
    return "; ".join([*told[:MOST], *more])
