"""Newton's iterations of a pose on the loop equations, as a textbook does them: estimates, residuals, corrections.

Sources: R. L. Norton, Design of Machinery, section 4.14; E. Soylemez, Mechanisms, section 3.9.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.analysis.equations.loop_equations import LoopEquations, loop_equations
from compoundkin.analysis.equations.rate_equations import condition_number, least_squares, rate_equations
from compoundkin.analysis.equations.reduced_system import pose_values, unknown_values
from compoundkin.base.arguments import checked, real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem, UnassembledPoses, UnknownName, suggestion
from compoundkin.base.poses import FIXED, Pose
from compoundkin.kinematics import solve
from compoundkin.kinematics.driver_values import FULL_TURN
from compoundkin.kinematics.solution import solving_order_of
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.loop_terms import Unknown
from compoundkin.structure import Structure

# Iterations stop when no correction is larger (radians, or parts of the size): the next one would be its square.
CONVERGED = 1e-9
# Residuals below this (parts of the size, or radians) are rounding.
ROUNDING = 1e-15
# Digits double at each step: so many steps suffice from any estimate that converges.
STEPS = 20
# A matrix of pure numbers with a greater condition number gives no useful step.
SINGULAR = 1e12


@dataclass(frozen=True, eq=False, repr=False)
class NewtonIterations(ShortRepr):
    """The iterations of one pose, by steps: radians and lengths.

    `estimates` (steps + 1, unknowns) begin with the start, `residuals` (steps + 1, rows) are those of the rows at them,
    `corrections` (steps, unknowns) lead from each to the next. `values` are the last estimates by their keys;
    `failure` says why the iterations did not converge, "" where they did.
    """

    unknowns: tuple[Unknown, ...]
    names: tuple[str, ...]
    estimates: Number
    residuals: Number
    corrections: Number
    failure: str = ""

    @property
    def values(self) -> Mapping[str, float]:
        """The last estimates, by the keys of the unknowns."""
        return {own.key: float(self.estimates[-1, k]) for k, own in enumerate(self.unknowns)}


@checked
def newton_iterations(
    mechanism: Mechanism | Structure, values: Mapping[str, float], start: Mapping[str, float] | None = None
) -> NewtonIterations:
    """Return Newton's iterations of a pose, at one value of every driver.

    Values are radians and lengths, by drivers; `start` has estimates by the keys of unknowns (`loop_equations`). The
    others come from the drawing, or where it does not place all links, from the first assembled pose.

    Raises InvalidInput for values that are missing and for mechanisms of several designs, UnknownName for other names,
    NotDetermined for a structure that cannot be solved.

    >>> from compoundkin.files import load
    >>> found = newton_iterations(load("four-bar-norton"), {"crank": np.deg2rad(40)})
    >>> found.failure, {name: round(float(np.degrees(v)), 3) for name, v in found.values.items()}
    ('', {'coupler': 20.298, 'rocker': 57.325})
    """
    equations = loop_equations(mechanism)
    structure, system = equations.structure, equations.system
    solving_order_of(structure)  # raises NotDetermined
    if any(np.size(v) > 1 for own in structure.mechanism.geometry.points.values() for v in own.values()):
        raise InvalidInput(Problem("dimensions", "they are arrays of several designs", "iterate one of them"))
    values = _numbers("values", values, list(structure.driven))
    estimates = _numbers("start", start or {}, [own.key for own in system.unknowns])
    missing = [own.driver for own in equations.drivers if own.driver not in values]
    if missing:
        raise InvalidInput(Problem("values", f"the driver {missing[0]!r} has no value", "give one for every driver"))
    given = {own.key: system.prescribed_value(own, values[by.driver]) for own, by in system.given.items()}
    known = all(own.key in estimates for own in system.unknowns)
    first = estimates if known else {**_drawn(equations), **estimates}
    x = np.array([float(np.ravel(first[own.key])[0]) for own in system.unknowns])
    return _iterated(equations, x, given)


def _numbers(where: str, given: Mapping[str, Any], known: Sequence[str]) -> dict[str, float]:
    """Return one finite number for each name."""
    found = {}
    for name, value in given.items():
        if name not in known:
            raise UnknownName(Problem(f"{where} {name}", f"there is no {name!r}", suggestion(str(name), known)))
        number = real_numbers(f"{where} {name}", value)
        if number.size != 1 or not np.isfinite(number).all():
            raise InvalidInput(Problem(f"{where} {name}", "this is not one finite number", "give one for a pose"))
        found[name] = float(number.ravel()[0])
    return found


def _iterated(equations: LoopEquations, x: Number, given: Mapping[str, Number]) -> NewtonIterations:
    system = equations.system
    matrix = rate_equations(equations.structure, system, 1).matrix
    scale = system.scales(equations.structure.mechanism.geometry.size)
    estimates, residuals, corrections, failure = [x], list[Number](), list[Number](), ""
    while True:
        here = {**given, **{own.key: value for own, value in zip(system.unknowns, estimates[-1], strict=True)}}
        here.update({own.key: value.at(here) for own, value in system.tied})
        residuals.append(np.array([float(np.ravel(row.at(here))[0]) for row in system.rows]))
        rest = residuals[-1] / scale.rows
        last = corrections[-1] / scale.columns if corrections else np.array([np.inf])
        if np.max(np.abs(last), initial=0.0) <= CONVERGED or np.max(np.abs(rest), initial=0.0) <= ROUNDING:
            break
        pure = np.atleast_2d(matrix.at(here)) * scale.columns / scale.rows[:, None]
        failure = _failure(len(corrections), pure)
        if failure:
            break
        corrections.append(-scale.columns * least_squares(pure, rest))
        estimates.append(estimates[-1] + corrections[-1])
    names = tuple(row.name for row in system.rows)
    moves = np.array(corrections).reshape(len(corrections), len(x))
    return NewtonIterations(system.unknowns, names, np.array(estimates), np.array(residuals), moves, failure)


def _failure(steps: int, pure: Number) -> str:
    """Return why there is no further step, or an empty text."""
    if not np.isfinite(pure).all():
        return f"after {steps} steps the estimates are no numbers"
    if condition_number(pure) > SINGULAR:
        return f"after {steps} steps the matrix is singular"
    return f"it has not converged in {steps} steps" if steps >= STEPS else ""


def _drawn(equations: LoopEquations) -> Mapping[str, Number]:
    """Return the drawn unknowns, else those of the first assembled pose."""
    structure = equations.structure
    mechanism = structure.mechanism
    poses: dict[str, Pose] = {FRAME: FIXED, **mechanism.drawn_poses}
    if not all(name in poses for name in mechanism.links):
        return _first_assembled(structure)

    def coordinate(pair: Pair) -> Number:
        members = tuple(poses[name] for name in pair.members)
        return pair.coordinate(pair.ends(mechanism.geometry), members).c[0]

    angles = {name: pose.angle.c[0] for name, pose in poses.items()}
    return unknown_values(structure, angles, lambda link, p: poses[link].at(p).c[0], coordinate)


def _first_assembled(structure: Structure) -> Mapping[str, Number]:
    """Return the unknowns at the first assembled pose of the drivers' own ranges."""
    ranges = {drive.name: FULL_TURN for drive in structure.mechanism.drives if drive.values is None and not drive.law}
    turning = {name: values for name, values in ranges.items() if structure.driven_angles[name]}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnassembledPoses)
        motion = solve(structure, turning, order=0)
    first = np.flatnonzero(motion.failed == 0)
    if not first.size:
        what = "nothing is drawn, and no pose of the drivers' ranges is assembled"
        raise InvalidInput(Problem("start", what, "give an estimate of every unknown"))
    return {name: np.ravel(np.broadcast_to(v, motion.shape))[first[0]] for name, v in pose_values(motion).items()}
