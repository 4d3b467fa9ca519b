"""An assembled pose: from the drawing as far as it goes, corrected by Gauss's and Newton's least steps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from compoundkin.base.arrays import Number, first_entry, wrapped
from compoundkin.base.newton import StoppingRule, gauss_newton
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import constant
from compoundkin.model.geometry import FRAME, pose_from_points
from compoundkin.model.pairs.contract import as_drivable
from compoundkin.structure.redundancy.constraint_equations import STRICT, Array, ConstraintEquations

# Gauss and Newton's steps: at a pose where the equations are singular each halves the error only.
STEPS = 60
REST = StoppingRule(
    # a residual that is rounding: no step could make it less; where one gains nothing below the second, that is too
    exact=1e-14,
    rounding=1e-11,
    # no step is longer (parts of the size, or radians): from far away it would lead anywhere
    longest=0.3,
    # so many steps must leave less than this part of a residual: else it is a place where none leads on
    patience=10,
    gain=0.9,
)
# Beyond so many columns a step is taken from the normal equations, with this part of the largest singular value squared
# added: well above the rounding of the products.
DENSE_UP_TO = 150
DAMPING = 1e-14
# Directions that exact equations determine less than this are left alone: rounding would lead anywhere.
UNDETERMINED = 1e-12
# The angle of a driver that is given no values: not 0, where links are often in line.
SOMEWHERE = 1.0
# Starts for a mechanism that is not drawn completely, the first one from what is drawn alone; fewer for a large one,
# so that all together have no more than so many columns.
TRIES = 40
COLUMNS = 1000
# The design and pose at which a drawing is read.
FIRST = (0, 0)


@dataclass(frozen=True)
class AssembledPose:
    """The nearest that was found to an assembled pose. It has its state, and the largest residual in parts of the size.

    `is_given` says that it needed no correction.
    """

    state: Array
    residual: float
    is_closed: bool
    is_given: bool = False


def corrected(
    equations: ConstraintEquations, state: Array, goal: Array | None = None, steps: int = STEPS
) -> AssembledPose:
    """Find the nearest assembled pose by least steps. The drivers' coordinates are at `goal` if given."""
    closed, rank = equations.tolerance
    determined = UNDETERMINED if equations.tolerance is STRICT else rank
    found = gauss_newton(partial(_system, equations, goal), partial(_least_step, determined), state, steps, REST)
    is_given = found.steps == 0 and found.residual <= REST.rounding
    return AssembledPose(found.x, found.residual, found.residual <= closed, is_given)


def _least_step(least: float, rows: Array, residual: Array) -> Array:
    """Return the least step that closes what it can; directions determined less than `least` are left alone."""
    if rows.shape[1] <= DENSE_UP_TO:
        return np.asarray(np.linalg.lstsq(rows, residual, rcond=least)[0])
    # far faster than a singular value decomposition; what is nearly undetermined is damped and not cut off
    normal = rows @ rows.T
    normal[np.diag_indices_from(normal)] += max(least**2, DAMPING) * len(rows)
    return np.asarray(rows.T @ np.linalg.solve(normal, residual))


def _system(equations: ConstraintEquations, goal: Array | None, state: Array) -> tuple[Array, Array]:
    """Return by how much the pairs are open, and the drivers off their goal; and the rows of both."""
    rows, lengths = equations.jacobian(state)
    residual = equations.closures(state) / lengths
    if goal is None:
        return residual, rows
    gap = equations.coordinates(state) - goal
    angular = np.array([pair.free_is_angle for pair in equations.driven], dtype=bool)
    gap = np.where(angular, wrapped(gap), gap / equations.size)
    signs = [pair.driven_by(d.link) for pair, d in zip(equations.driven, equations.mechanism.drives, strict=True)]
    return np.concatenate([residual, gap]), np.vstack([rows, equations.driving(state) * np.array(signs)[:, None]])


def assemble(equations: ConstraintEquations) -> AssembledPose:
    """Find an assembled pose near the drawing, the drivers free. Without one, they are at their first values if any."""
    mechanism = equations.mechanism
    if mechanism.sketch:
        return _nearest(equations, None)
    drives = zip(mechanism.drives, equations.driven, strict=True)
    values = [
        (SOMEWHERE if pair.free_is_angle else 0.0) if drive.values is None else float(first_entry(drive.values))
        for drive, pair in drives
    ]
    at_values = _nearest(equations, np.array(values))
    return at_values if at_values.is_closed else _nearest(equations, None)


def _nearest(equations: ConstraintEquations, goal: Array | None) -> AssembledPose:
    best: AssembledPose | None = None
    for start, is_complete in _starts(equations):
        found = corrected(equations, start, goal)
        good = found.is_closed and equations.is_properly_assembled(found.state)
        if best is None or found.residual < best.residual:
            best = found
        if good or is_complete:
            return found
    assert best is not None
    return best


def _starts(equations: ConstraintEquations) -> Iterator[tuple[Array, bool]]:
    """List states to start from; the only one where a drawing shows every link."""
    shown = _shown(equations)
    missing = [name for name in equations.links if name not in shown]
    places, guided = _places(equations, shown), _guided(equations, shown)
    still = {name: _placed(equations, name, places, guided.get(name, 0.0)) for name in missing}
    yield equations.state({**shown, **still}), not missing
    rng = np.random.default_rng(len(missing))
    for _ in range(min(TRIES, COLUMNS // equations.width) if missing else 0):
        around = complex(*rng.standard_normal(2)) * equations.size / 2.0
        angles = {name: float(rng.uniform(-np.pi, np.pi)) for name in missing} | guided
        turned = {name: _placed(equations, name, places, angles[name], around) for name in missing}
        yield equations.state({**shown, **turned}), False


def _shown(equations: ConstraintEquations) -> dict[str, Pose]:
    """Return the poses of the links that the drawing fixes, or points of links that it fixes."""
    geometry = equations.mechanism.geometry
    shown = {name: pose.entry(FIRST) for name, pose in geometry.drawn.items()}
    seen = {letter: _number(p) for letter, p in geometry.sketch.items()}
    points = {name: {k: _number(p) for k, p in geometry.points[name].items()} for name in equations.mechanism.links}
    while True:
        for name, pose in shown.items():
            seen.update({k: complex(pose.at(p).c[0]) for k, p in points[name].items() if k not in seen})
        fitted = {name: pose_from_points(points[name], seen) for name in equations.links if name not in shown}
        found = {name: pose for name, pose in fitted.items() if pose is not None}
        if not found:
            return shown
        shown.update(found)


def _guided(equations: ConstraintEquations, shown: Mapping[str, Pose]) -> dict[str, float]:
    """Return the angles of links that are not shown, where slides keep them from turning on links that are."""
    known = {**shown, FRAME: FIXED}
    simple = (as_drivable(pair) for pair in equations.pairs if pair.is_simple and not pair.free_is_angle)
    slides = [pair for pair in simple if pair]
    found: dict[str, float] = {}
    while True:
        open_to = [pair for pair in slides if sum(name in known for name in pair.members) == 1]
        if not open_to:
            return found
        pair = open_to[0]
        relative = pair.placed(equations.ends[pair.name], constant(0.0))
        one, other = pair.members
        base, name = (one, other) if one in known else (other, one)
        known[name] = known[base].compose(relative if base == one else relative.inverse())
        found[name] = float(np.angle(known[name].u.c[0]))


def _places(equations: ConstraintEquations, shown: Mapping[str, Pose]) -> dict[str, complex]:
    """Return where the points of what is shown are."""
    geometry = equations.mechanism.geometry
    places = {letter: _number(p) for letter, p in geometry.sketch.items()}
    for name, pose in {**shown, FRAME: FIXED}.items():
        places.update({k: complex(pose.at(_number(p)).c[0]) for k, p in geometry.points[name].items()})
    return places


def _placed(
    equations: ConstraintEquations, name: str, places: Mapping[str, complex], angle: float, around: complex = 0j
) -> Pose:
    """Place a link that is not shown, at an angle; at the place of one of its points that is shown, else anywhere."""
    points = equations.mechanism.geometry.points[name]
    turned = complex(np.exp(1j * angle))
    at = next((places[k] - turned * _number(p) for k, p in points.items() if k in places), around)
    return Pose.of(complex(at), turned)


def _number(value: Number) -> complex:
    return complex(first_entry(value))
