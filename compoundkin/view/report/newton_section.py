"""Newton's iterations of a pose, as a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from compoundkin.analysis.equations import Unknown
from compoundkin.analysis.equations.newton_iterations import NewtonIterations
from compoundkin.base.arrays import degrees
from compoundkin.view.report.pose_numbers_section import coordinate_unit
from compoundkin.view.report.report_data import Alert, Block, Cell, Column, Paragraph, Section, TableBlock
from compoundkin.view.report.wording import counted, number

START = (
    "Each step solves A d = -F for the corrections d, with the matrix A and the residuals F of the loop equations at "
    "the estimates. Near the pose each correction is about the square of the one before."
)
# Poses that differ by less (radians, or parts of the size) are one.
SAME = 1e-6
SAME_POSE = "This is the pose that the groups give one by one."
OTHER_POSE = "This is another configuration than that of the groups: choose estimates nearer to it."


def newton_section(found: NewtonIterations, unit: str, size: float, solved: Mapping[str, float] | None) -> Section:
    """Return Newton's iterations as a table. `solved` has the unknowns of the pose that the groups gave, if any."""
    blocks: list[Block] = [Paragraph(START), _steps_table(found, unit)]
    if found.failure:
        last = ", ".join(f"{own.key} = {_shown(own, found.values[own.key])}" for own in found.unknowns)
        remedy = "choose a pose within reach" if solved is None else "start elsewhere"
        blocks.append(Alert(f"No pose was found: {found.failure}; the last estimate is {last}.", remedy))
    else:
        told = f"It converges in {counted(len(found.corrections), 'step')}."
        compared = "" if solved is None else f" {SAME_POSE if _is_same(found, size, solved) else OTHER_POSE}"
        blocks.append(Paragraph(told + compared))
    return Section("newton", "Newton's iterations", tuple(blocks))


def _is_same(found: NewtonIterations, size: float, solved: Mapping[str, float]) -> bool:
    for own, value in zip(found.unknowns, found.estimates[-1], strict=True):
        other = solved[own.key]
        gap = np.exp(1j * value) - np.exp(1j * other) if own.is_angle else (value - other) / size
        if abs(gap) > SAME:
            return False
    return True


def _shown(own: Unknown, value: float) -> str:
    return f"{number(float(degrees(value)))} deg" if own.is_angle else number(value)


def _steps_table(found: NewtonIterations, unit: str) -> TableBlock:
    turn = [float(degrees(1.0)) if own.is_angle else 1.0 for own in found.unknowns]
    units = [coordinate_unit(own, unit, 0) for own in found.unknowns]
    columns = [Column("step")]
    columns += [Column(own.key, name, "each") for own, name in zip(found.unknowns, units, strict=True)]
    columns += [Column(f"residual {name}", style="brief") for name in found.names]
    columns += [Column(f"correction {own.key}", name, "brief") for own, name in zip(found.unknowns, units, strict=True)]
    rows = []
    for k, (estimate, residual) in enumerate(zip(found.estimates, found.residuals, strict=True)):
        moves: Sequence[Cell] = [None] * len(turn)
        if k < len(found.corrections):
            moves = [float(v * t) for v, t in zip(found.corrections[k], turn, strict=True)]
        rows.append(
            (str(k), *(float(v * t) for v, t in zip(estimate, turn, strict=True)), *map(float, residual), *moves)
        )
    return TableBlock(tuple(columns), tuple(rows), keys=1)
