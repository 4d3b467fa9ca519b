"""An assembled pose: from the drawing as far as it goes, corrected by Gauss and Newton."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Number, constant
from compoundkin.model.elements import FRAME
from compoundkin.model.geometry import fitted_pose
from compoundkin.structure.redundancy.constraint_equations import STRICT, Array, Equations

# Gauss and Newton's steps: at a pose where the equations are singular each halves the error only.
STEPS = 60
# So many steps must leave less than this part of a residual: else it is a place where none leads on.
PATIENCE, GAIN = 10, 0.9
# No step is longer than this (parts of the size, or radians): from far away it would lead anywhere.
LONGEST = 0.3
# A residual that is rounding: no step could make it less.
EXACT = 1e-14
# Where a step gains nothing below this, what is left is rounding too.
ROUNDING = 1e-11
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
COLUMNS = 4000


@dataclass(frozen=True)
class Assembly:
    """The nearest that was found to an assembled pose: its state, and the largest residual in parts of the size.

    `is_given` says that it needed no correction.
    """

    state: Array
    residual: float
    is_closed: bool
    is_given: bool = False


def corrected(equations: Equations, state: Array, goal: Array | None = None, steps: int = STEPS) -> Assembly:
    """The nearest assembled pose, by so many least steps at most; with the drivers' coordinates at `goal` if given."""
    closed, rank = equations.tolerance
    least = UNDETERMINED if equations.tolerance is STRICT else rank
    best, before = Assembly(state, np.inf, False), list[float]()
    for _ in range(steps):
        residual, rows = _system(equations, state, goal)
        worst = float(np.max(np.abs(residual), initial=0.0))
        before.append(worst)
        if not np.isfinite(worst) or (len(before) > PATIENCE and worst > GAIN * before[-1 - PATIENCE]):
            return best
        stalls = worst > best.residual / 2.0
        if worst < best.residual:
            best = Assembly(state, worst, worst <= closed, best.residual == np.inf and worst <= ROUNDING)
        if worst <= EXACT or (stalls and worst <= ROUNDING) or best.is_given:
            break
        step = _least_step(rows, -residual, least)
        longest = float(np.max(np.abs(step), initial=0.0))
        if longest <= EXACT:
            break
        state = state + step * min(1.0, LONGEST / longest)
    return best


def _least_step(rows: Array, residual: Array, least: float) -> Array:
    """The least step that closes what can be closed, directions that are determined less than `least` left alone."""
    if rows.shape[1] <= DENSE_UP_TO:
        return np.asarray(np.linalg.lstsq(rows, residual, rcond=least)[0])
    # far faster than a singular value decomposition; what is nearly undetermined is damped and not cut off
    normal = rows @ rows.T
    normal[np.diag_indices_from(normal)] += max(least**2, DAMPING) * len(rows)
    return np.asarray(rows.T @ np.linalg.solve(normal, residual))


def _system(equations: Equations, state: Array, goal: Array | None) -> tuple[Array, Array]:
    rows, lengths = equations.jacobian(state)
    residual = equations.closures(state) / lengths
    if goal is None:
        return residual, rows
    gap = equations.coordinates(state) - goal
    angular = np.array([pair.free_is_angle for pair in equations.driven], dtype=bool)
    gap = np.where(angular, np.angle(np.exp(1j * gap)), gap / equations.size)
    signs = [pair.driven_by(d.link) for pair, d in zip(equations.driven, equations.mechanism.drives, strict=True)]
    return np.concatenate([residual, gap]), np.vstack([rows, equations.driving(state) * np.array(signs)[:, None]])


def assembled(equations: Equations) -> Assembly:
    """An assembled pose near the drawing, the drivers free; without a drawing, at the drivers' first values if any."""
    mechanism = equations.mechanism
    if mechanism.sketch:
        return _nearest(equations, None)
    drives = zip(mechanism.drives, equations.driven, strict=True)
    values = [_first(drive.values, SOMEWHERE if pair.free_is_angle else 0.0) for drive, pair in drives]
    at_values = _nearest(equations, np.array(values))
    return at_values if at_values.is_closed else _nearest(equations, None)


def _nearest(equations: Equations, goal: Array | None) -> Assembly:
    best: Assembly | None = None
    for start, is_complete in _starts(equations):
        found = corrected(equations, start, goal)
        good = found.is_closed and equations.is_properly_assembled(found.state)
        if best is None or found.residual < best.residual:
            best = found
        if good or is_complete:
            return found
    assert best is not None
    return best


def _first(values: Number, otherwise: float) -> float:
    return otherwise if values is None else float(np.ravel(values)[0])


def _starts(equations: Equations) -> Iterator[tuple[Array, bool]]:
    """States to start from; the only one where a drawing shows every link."""
    shown = _shown(equations)
    missing = [name for name in equations.links if name not in shown]
    places, guided = _places(equations, shown), _guided(equations, shown)
    still = {name: _upright(equations, name, places, guided.get(name, 0.0)) for name in missing}
    yield equations.state({**shown, **still}), not missing
    rng = np.random.default_rng(len(missing))
    for _ in range(min(TRIES, COLUMNS // equations.width) if missing else 0):
        around = complex(*rng.standard_normal(2)) * equations.size / 2.0
        angles = {name: float(rng.uniform(-np.pi, np.pi)) for name in missing} | guided
        turned = {name: _upright(equations, name, places, angles[name], around) for name in missing}
        yield equations.state({**shown, **turned}), False


def _shown(equations: Equations) -> dict[str, Pose]:
    """The poses of the links that the drawing fixes, or points of links that it fixes."""
    geometry = equations.mechanism.geometry
    shown = {name: _at_first(pose) for name, pose in geometry.drawn.items()}
    seen = {letter: _number(p) for letter, p in geometry.sketch.items()}
    points = {name: {k: _number(p) for k, p in geometry.points[name].items()} for name in equations.mechanism.links}
    while True:
        for name, pose in shown.items():
            seen.update({k: complex(pose.at(p).c[0]) for k, p in points[name].items() if k not in seen})
        fitted = {name: fitted_pose(points[name], seen) for name in equations.links if name not in shown}
        found = {name: pose for name, pose in fitted.items() if pose is not None}
        if not found:
            return shown
        shown.update(found)


def _guided(equations: Equations, shown: Mapping[str, Pose]) -> dict[str, float]:
    """The angles of links that are not shown, where slides keep them from turning on links that are."""
    known = {**shown, FRAME: FIXED}
    slides = [pair for pair in equations.pairs if pair.is_simple and not pair.free_is_angle]
    found: dict[str, float] = {}
    while True:
        open_to = [pair for pair in slides if sum(name in known for name in pair.members) == 1]
        if not open_to:
            return found
        pair = open_to[0]
        relative = pair.placed(equations.ends[pair.name], constant(0.0))
        first, second = pair.members
        base, name = (first, second) if first in known else (second, first)
        known[name] = known[base].compose(relative if base == first else relative.inverse())
        found[name] = float(np.angle(known[name].u.c[0]))


def _places(equations: Equations, shown: Mapping[str, Pose]) -> dict[str, complex]:
    """Where the points of what is shown are."""
    geometry = equations.mechanism.geometry
    places = {letter: _number(p) for letter, p in geometry.sketch.items()}
    for name, pose in {**shown, FRAME: FIXED}.items():
        places.update({k: complex(pose.at(_number(p)).c[0]) for k, p in geometry.points[name].items()})
    return places


def _upright(
    equations: Equations, name: str, places: Mapping[str, complex], angle: float, around: complex = 0j
) -> Pose:
    """A link that is not shown, at an angle; at the place of one of its points that is shown, else anywhere."""
    points = equations.mechanism.geometry.points[name]
    turned = complex(np.exp(1j * angle))
    at = next((places[k] - turned * _number(p) for k, p in points.items() if k in places), around)
    return Pose.of(complex(at), turned)


def _at_first(pose: Pose) -> Pose:
    return Pose.of(_number(pose.z.c[0]), _number(pose.u.c[0]))


def _number(value: Number) -> complex:
    return complex(np.ravel(value)[0])
