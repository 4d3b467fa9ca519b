"""The written terms with the solved positions of every shipped mechanism put in: sums of vectors must be zero."""

from __future__ import annotations

import warnings

import numpy as np

import compoundkin as ck
from compoundkin.analysis.equations.expressions import latex, text
from compoundkin.analysis.equations.loop_equations import LoopEquations, loop_equations
from compoundkin.analysis.equations.vector_loops import pair_terms
from compoundkin.files import load
from compoundkin.model.pairs.loop_terms import Vector
from compoundkin.view.report.structure_sections import equation_count
from tests import catalog

# Residuals of solved positions, of the size of the mechanism or in radians.
ZERO = 1e-9


def solved(name: str) -> ck.results.Motion:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
        return ck.solve(load(name), order=1)


def values_of(motion: ck.results.Motion, equations: LoopEquations) -> dict[str, np.ndarray]:
    """The unknowns as the solved poses show them: lengths and directions by the places of points, not by pairs."""
    values = {name: link.angle for name, link in motion.links.items()}
    geometry = motion.mechanism.geometry
    for pair in equations.structure.pairs:
        how = pair_terms(pair, pair.ends(geometry))
        if not how.unknowns:
            continue
        (unknown,) = how.unknowns
        first, second = (motion.links[name].at(p).position for name, p in zip(pair.members, how.points, strict=False))
        gap = np.asarray(second - first)
        if unknown.kind == "parameter":
            values[unknown.key] = motion.pairs[pair.name].value
            continue
        zero = {**values, unknown.key: 0.0}
        free = next(arm for arm in how.arms if (isinstance(arm, Vector) and not arm.symbol) or len(how.arms) == 1)
        if unknown.kind == "displacement":
            along = free.sign * np.exp(1j * free.angle.at(zero))
            others = sum((arm.at(zero) for arm in how.arms if arm is not free), 0j)
            values[unknown.key] = ((gap - others) * np.conj(along)).real
        else:
            values[unknown.key] = np.unwrap(np.angle(gap * np.exp(-1j * free.angle.at(zero))))
    return values


@catalog.each(catalog.CHOSEN)
def test_solved_positions_satisfy_every_equation(name):
    motion = solved(name)
    equations = loop_equations(motion.structure)
    values, size, good = values_of(motion, equations), motion.mechanism.geometry.size, motion.assembled
    for loop in equations.loops:
        assert np.max(np.abs(np.broadcast_to(loop.at(values), good.shape)[good])) < ZERO * size, str(loop.loop)
    for auxiliary in equations.auxiliary:
        left = np.broadcast_to(auxiliary.at(values), good.shape)[good]
        # a phase that is read off the drawing is taken on by whole turns: it may be another constant
        gap = left - left[0] if auxiliary.counts_turns else left
        assert np.max(np.abs(gap)) < ZERO * size, auxiliary.pair
    for driven in equations.drivers:
        left = driven.at(values, ck.quantity(motion, f"{driven.driver}.value").values)
        assert np.max(np.abs(np.broadcast_to(left, good.shape)[good])) < ZERO * size, driven.driver


@catalog.each(catalog.CHOSEN)
def test_there_are_as_many_equations_as_unknowns_and_every_unknown_is_written(name):
    structure = catalog.structure(name)
    equations, count = loop_equations(structure), equation_count(structure)
    if not structure.faults:  # a driver that closes on others has no place among the equations
        assert (equations.equations, len(equations.unknowns)) == (count.equations, count.unknowns)
        assert equations.is_solvable == (count.equations == count.unknowns)
    written = [text(one) for one in (*equations.loops, *equations.auxiliary, *equations.drivers)]
    for unknown in equations.unknowns:
        assert any(unknown.key in line for line in written), unknown.key
    for one in (*equations.loops, *equations.auxiliary, *equations.drivers):
        formula = latex(one)
        assert formula.count("{") == formula.count("}")
