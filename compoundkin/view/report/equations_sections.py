"""Vector-loop equations: in symbols, with the numbers of a pose, their rates, and Newton's iterations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.analysis.equations.expressions import LATEX, TEXT, latex, six_digits, sum_written, text
from compoundkin.analysis.equations.freudenstein import FourBarConstants, constants_of
from compoundkin.analysis.equations.loop_equations import LoopEquations
from compoundkin.analysis.equations.newton_iterations import NewtonIterations
from compoundkin.analysis.equations.rate_equations import RateEquations, RateSolution
from compoundkin.analysis.equations.reduced_system import pose_values, prescribed_values
from compoundkin.base.arrays import degrees, first_entry
from compoundkin.kinematics import Motion
from compoundkin.model.attributes import ACCELERATION, DEGREES, VELOCITY, unit_of, with_unit
from compoundkin.model.pairs.loop_terms import Implicit, Unknown
from compoundkin.view.report.pose_sample import Sample
from compoundkin.view.report.report_data import Alert, Block, Cell, Column, FormulaBlock, Paragraph, Section, TableBlock
from compoundkin.view.report.verification_sections import gap_sentence, gaps_of
from compoundkin.view.report.wording import counted, joined_links, listed, number_text

LOOP_NOTATION = (
    "A vector AB e^(i crank) has the length AB and is turned by the angle of the link crank; "
    "the frame's angle is zero. AB' starts or ends where a guide is, from which its displacement counts."
)
IMPLICIT_FUNCTIONS = "The equations of {pairs} are functions F of the angles and displacements in brackets."
_MEANING = {
    "angle": "angle of the link",
    "displacement": "displacement along the guide",
    "direction": "direction of the line between centres",
    "parameter": "parameter of the profile at the contact",
    "x": "way across the pair in x of its first link",
    "y": "way across the pair in y of its first link",
    "given": "value of the driver",
}
# A matrix in brackets is no wider (characters); a wider one is written entry by entry.
WIDEST = 76
# A matrix of more columns is not typeset: nobody could read it.
MOST_COLUMNS = 24
RATE_NOTATION = (
    "A prime, in formulas a dot, is a derivative by time: crank' is the angular velocity of the link crank, s''(slot) "
    "the second rate of the displacement s(slot)."
)
FUNCTION_RATES = (
    "The derivatives dF/d( ) of a function F are computed by series; F'' is its second rate "
    "while its arguments have constant rates."
)
ONE_MATRIX = "A is the matrix of both velocities and accelerations, its columns those of x = ({})."
_SYMBOLS = {
    True: "With input a, coupler b, output c and frame d",
    False: "With crank a, rod b and offset e of the guide",
}
NEWTON_METHOD = (
    "Each step solves A d = -F for the corrections d, with the matrix A and the residuals F of the loop equations at "
    "the estimates. Near the pose each correction is about the square of the one before."
)
# Poses that differ by less (radians, or parts of the size) are one.
SAME = 1e-6
SAME_POSE = "This is the pose that the groups give one by one."
OTHER_POSE = "This is another configuration than that of the groups: choose estimates nearer to it."
# Numbers of the matrix below this part of its largest are rounding, and shown as 0.
ROUNDING = 1e-12


def equations_section(found: LoopEquations) -> Section:
    """Return the loop equations, the auxiliary ones and those of the drivers, with unknown and known quantities."""
    return Section("equations", "Vector-loop equations", tuple(_equation_blocks(found)))


def _equation_blocks(found: LoopEquations) -> Iterator[Block]:
    yield Paragraph(LOOP_NOTATION)
    for k, loop in enumerate(found.loops, 1):
        yield Paragraph(f"Loop {k}: {loop.loop}")
        yield FormulaBlock(text(loop), latex(loop))
    for title, equations in (("Auxiliary equations:", found.auxiliary), ("Drivers:", found.drivers)):
        if equations:
            yield Paragraph(title)
        for equation in equations:
            yield FormulaBlock(text(equation), latex(equation))
    unwritten = list(dict.fromkeys(one.pair for one in found.auxiliary if isinstance(one, Implicit)))
    if unwritten:
        yield Paragraph(IMPLICIT_FUNCTIONS.format(pairs=joined_links(unwritten)))
    yield Paragraph(_counted_equations(found))
    yield TableBlock((Column("unknown"), Column("what it is")), tuple(_unknown_row(one) for one in found.unknowns))
    known = tuple((symbol, float(first_entry(length))) for symbol, length in found.lengths.items())
    if known:
        yield TableBlock((Column("known"), Column("length", style="each")), known)


def _counted_equations(found: LoopEquations) -> str:
    loops, others = len(found.loops), len(found.auxiliary) + len(found.drivers)
    sides = f"{2 * loops} equations of {counted(loops, 'loop')} in x and y, and {others} more"
    verdict = "as many" if found.is_solvable else "not as many"
    return f"{sides}: {found.equations} for {counted(len(found.unknowns), 'unknown')}, {verdict}."


def _unknown_row(one: Unknown) -> tuple[Cell, ...]:
    return one.key, f"{_MEANING[one.kind]} {one.owner}" if one.kind == "angle" else f"{_MEANING[one.kind]}, {one.owner}"


def constants_section(found: LoopEquations) -> Section | None:
    """Return Freudenstein's equations with their constants; None where no loop has one."""
    blocks: list[Block] = []
    for own in constants_of(found):
        blocks.append(Paragraph(f"Loop {own.loop}:"))
        blocks += [FormulaBlock(*both) for both in zip(own.text, own.latex, strict=True)]
        numbers = {**own.lengths, **own.constants}
        values = ", ".join(f"{name} = {number_text(float(np.ravel(value)[0]))}" for name, value in numbers.items())
        blocks.append(Paragraph(f"{_SYMBOLS[isinstance(own, FourBarConstants)]}: {values}."))
    return Section("constants", "Freudenstein's equation", tuple(blocks)) if blocks else None


def rates_section(found: LoopEquations) -> Section:
    """Return the equations of velocities, and of accelerations if requested, in symbols."""
    title = "Velocity and acceleration equations" if len(found.rates) > 1 else "Velocity equations"
    return Section("rates", title, tuple(_rate_blocks(found)))


def _rate_blocks(found: LoopEquations) -> Iterator[Block]:
    first, system = found.velocity, found.system
    has_function = any(row.function is not None for row in system.rows)
    yield Paragraph(f"{RATE_NOTATION} {FUNCTION_RATES}" if has_function else RATE_NOTATION)
    given = [own.key for own in system.given]
    tied = [f"{own.key} = {sum_written(value, TEXT, _constant_writer(own))}" for own, value in system.tied]
    if given:
        put = f", and put in: {listed(tied)}" if tied else ""
        yield Paragraph(f"Given by drivers: {listed(given)}{put}.")
    if not system.unknowns:
        yield Paragraph("Nothing is left unknown.")
        return
    yield Paragraph(ONE_MATRIX.format(", ".join(own.key for own in first.unknowns)))
    is_set = len(first.unknowns) <= MOST_COLUMNS
    yield FormulaBlock(_matrix_text(first), f"A = {first.matrix.latex}" if is_set else "")
    for title, rates in zip(("Velocities, A x' = b:", "Accelerations, A x'' = c:"), found.rates, strict=False):
        yield Paragraph(title)
        yield FormulaBlock("\n".join(rates.rows), _system_latex(rates) if is_set else "")


def _constant_writer(own: Unknown) -> Any:
    return six_digits if own.is_length else TEXT.angle


def _matrix_text(rates: RateEquations) -> str:
    whole = rates.matrix.text
    if max(map(len, whole.split("\n"))) <= WIDEST:
        return whole
    return "\n".join(f"{name}: {row}" for name, row in zip(rates.names, rates.matrix.rows, strict=True))


def _system_latex(rates: RateEquations) -> str:
    unknown = r" \\ ".join(LATEX.unknown(own, rates.order) for own in rates.unknowns)
    return rf"A \begin{{bmatrix}} {unknown} \end{{bmatrix}} = {rates.right_side.latex}"


@dataclass(frozen=True, eq=False)
class PoseNumbers:
    """The equations in numbers, at the first pose of a design of a motion."""

    found: LoopEquations
    motion: Motion
    design: int = 0

    @cached_property
    def sample(self) -> Sample:
        """The design."""
        return Sample(self.motion, self.design)

    @cached_property
    def solutions(self) -> tuple[RateSolution, ...]:
        """The solutions of velocities, and of accelerations if requested."""
        return tuple(rates.at(self.motion) for rates in self.found.rates)

    def at(self, values: Any, axes: int = 0) -> Any:
        """Return what an array holds at the pose. It may have some axes more than the motion."""
        array = np.asarray(values)
        more = array.shape[array.ndim - axes :]
        return np.broadcast_to(array, (*self.motion.shape, *more)).reshape(-1, self.sample.poses, *more)[self.design, 0]


def pose_section(found: LoopEquations, motion: Motion, design: int = 0) -> Section:
    """Return matrix, right-hand sides and solution at the first pose of a design."""
    pose = PoseNumbers(found, motion, design)
    drivers = [f"{one.name} = {with_unit(number_text(float(one.values[0])), one.unit)}" for one in pose.sample.drivers]
    return Section("pose", f"Numbers at {listed(drivers)}" if drivers else "Numbers", tuple(_pose_blocks(pose)))


def _pose_blocks(pose: PoseNumbers) -> Iterator[Block]:
    if not pose.sample.assembled[0]:
        reasons = [gap_sentence(pose.sample, gap) for gap in gaps_of(pose.sample)]
        yield Alert(" ".join(reasons) or "The pose cannot be assembled.", "choose a pose within reach")
        return
    if pose.solutions and pose.found.system.unknowns:
        yield _matrix_table(pose)
        yield from _verdict(pose.solutions[0], pose)
    yield _values_table(pose)


def _matrix_table(pose: PoseNumbers) -> TableBlock:
    sides = [pose.at(own.right_side, 1) for own in pose.solutions]
    matrix = pose.at(pose.solutions[0].matrix, 2)
    floor = ROUNDING * float(np.max(np.abs(matrix), initial=0.0))
    columns = [Column(own.key, style="each", floor=floor) for own in pose.found.system.unknowns]
    right = [Column(name, style="each", follows=True) for name, _ in zip("bc", sides, strict=False)]
    rows: list[tuple[Cell, ...]] = []
    for k, row in enumerate(pose.found.system.rows):
        rows.append((row.name, *(float(v) for v in (*matrix[k], *(side[k] for side in sides)))))
    return TableBlock((Column("row of A"), *columns, *right), tuple(rows), keys=1)


def _verdict(first: RateSolution, pose: PoseNumbers) -> Iterator[Block]:
    rows, columns = np.shape(first.matrix)[-2:]
    condition = f"condition {number_text(float(pose.at(first.condition)))}, lengths in parts of the mechanism's size"
    if rows == columns:
        yield Paragraph(f"Determinant {number_text(float(pose.at(first.determinant)))}, {condition}.")
    else:
        more = "more rows than unknowns: where they agree, each follows from the others"
        yield Paragraph(f"{rows} rows for {columns} unknowns, {condition}; {more}.")
    if pose.at(first.singular):
        yield Alert("The matrix is singular: a limit position or change point, where rates are not determined.")


def _values_table(pose: PoseNumbers) -> TableBlock:
    """Return all unknowns and drivers with their values and rates."""
    system, unit = pose.found.system, pose.found.structure.mechanism.unit
    values = pose_values(pose.motion)
    for order in range(len(pose.solutions) + 1):
        values.update(prescribed_values(pose.motion, system, order))
    rows = []
    for own in (*system.unknowns, *system.given):
        shown = float(pose.at(values[own.key]))
        cells: list[Cell] = [own.key, float(degrees(shown)) if own.is_angle else shown, coordinate_unit(own, unit, 0)]
        for order, solution in enumerate(pose.solutions, 1):
            key = own.rate_key(order)
            rate = values[key] if key in values else solution.rate(own.key)
            cells += [float(pose.at(rate)), coordinate_unit(own, unit, order)]
        rows.append((*cells, "given" if own in system.given else ""))
    columns = [Column("coordinate"), Column("value", style="each"), Column("unit", follows=True)]
    for name in (VELOCITY, ACCELERATION)[: len(pose.solutions)]:
        columns += [Column(name, style="each"), Column("unit", follows=True)]
    return TableBlock((*columns, Column("")), tuple(rows), keys=1)


def coordinate_unit(own: Unknown, unit: str, order: int) -> str:
    """Return the display unit of a coordinate or of its rate."""
    if own.kind == "parameter":
        return ""
    if own.is_length:
        return unit_of(unit, "length", order)
    return unit_of("", "angle", order) if order else DEGREES


def newton_section(found: NewtonIterations, unit: str, size: float, solved: Mapping[str, float] | None) -> Section:
    """Return Newton's iterations as a table; `solved` has the unknowns of the pose that the groups gave, if any."""
    blocks: list[Block] = [Paragraph(NEWTON_METHOD), _steps_table(found, unit)]
    if found.failure:
        last = ", ".join(f"{own.key} = {_value_text(own, found.values[own.key])}" for own in found.unknowns)
        remedy = "choose a pose within reach" if solved is None else "start elsewhere"
        blocks.append(Alert(f"No pose was found: {found.failure}; the last estimate is {last}.", remedy))
    else:
        text = f"It converges in {counted(len(found.corrections), 'step')}."
        compared = "" if solved is None else f" {SAME_POSE if _is_same(found, size, solved) else OTHER_POSE}"
        blocks.append(Paragraph(text + compared))
    return Section("newton", "Newton's iterations", tuple(blocks))


def _is_same(found: NewtonIterations, size: float, solved: Mapping[str, float]) -> bool:
    for own, value in zip(found.unknowns, found.estimates[-1], strict=True):
        other = solved[own.key]
        gap = np.exp(1j * value) - np.exp(1j * other) if own.is_angle else (value - other) / size
        if abs(gap) > SAME:
            return False
    return True


def _value_text(own: Unknown, value: float) -> str:
    return with_unit(number_text(float(degrees(value))), DEGREES) if own.is_angle else number_text(value)


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
