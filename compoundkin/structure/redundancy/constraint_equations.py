"""The constraint equations of all pairs in the poses of all moving links, and a pose that satisfies them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number, first_entry, wrapped
from compoundkin.base.newton import StoppingRule, gauss_newton
from compoundkin.base.poses import FIXED, End, Pose
from compoundkin.base.series import constant
from compoundkin.model.definition import Pins, driven_pair
from compoundkin.model.geometry import FRAME, pose_from_points
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Drivable, Ends, as_drivable
from compoundkin.structure.mobility_count import LINK_FREEDOMS
from compoundkin.structure.system import generic_jacobian

Array = np.ndarray[Any, np.dtype[np.float64]]


SEED = 20260101


class Tolerance(NamedTuple):
    """Bounds of closed and dependent: residuals by the size, singular values by the largest."""

    closed: float
    rank: float


# Rounding of exact dimensions.
STRICT = Tolerance(1e-9, 1e-9)


# Dimensions given to some five digits, as in print: pairs that ought to close open by as much, and what ought to be
# dependent is so nearly.
ROUNDED = Tolerance(1e-5, 1e-4)


# No steps lead from the origin to a frame so many sizes away.
FAR_FRAME = 5.0


@dataclass(frozen=True)
class Rows:
    """The rows of a Jacobian that belong to one pair. They tell which pair, and where they begin and end."""

    pair: Pair
    first: int
    last: int


@dataclass(frozen=True)
class ConstraintEquations:
    """The equations of a mechanism: first what its pairs hold, then the drivers' coordinates.

    A state holds x, y (in parts of `size`) and theta (radians) of every moving link, in the order of the mechanism. A
    multiple pin is a star of pairs around the first of its links. Rows are scaled to the length 1.
    """

    mechanism: Mechanism
    tolerance: Tolerance = STRICT

    @cached_property
    def links(self) -> tuple[str, ...]:
        """The moving links."""
        return tuple(name for name in self.mechanism.links if name != FRAME)

    @cached_property
    def pairs(self) -> tuple[Pair, ...]:
        """Every pair, the pins first."""
        return (*self.pins, *self.mechanism.written_pairs)

    @cached_property
    def pins(self) -> tuple[Pair, ...]:
        """The pairs at pins."""
        pins = Pins(self.mechanism)
        named = self.mechanism.pins.items()
        return tuple(pins.pair(letter, names[0], name) for letter, names in named for name in names[1:])

    @cached_property
    def driven(self) -> tuple[Drivable, ...]:
        """The pair of every driver."""
        pins = Pins(self.mechanism)
        return tuple(driven_pair(pins, drive) for drive in self.mechanism.drives)

    @cached_property
    def size(self) -> float:
        """The mechanism's length scale."""
        return self.mechanism.geometry.size

    @cached_property
    def around(self) -> complex:
        """The place around which poses are looked for: the origin, or the middle of a frame that is far from it."""
        places = [complex(_number(place)) for place in self.mechanism.geometry.points[FRAME].values()]
        middle = complex(np.mean(places)) if places else 0j
        return middle if abs(middle) > FAR_FRAME * self.size else 0j

    @cached_property
    def rows(self) -> tuple[Rows, ...]:
        """The rows of each pair."""
        found, first = [], 0
        for pair in self.pairs:
            found.append(Rows(pair, first, first + pair.held))
            first += pair.held
        return tuple(found)

    @property
    def held(self) -> int:
        """How many coordinates the pairs hold."""
        return self.rows[-1].last if self.rows else 0

    @property
    def width(self) -> int:
        """How many numbers a state has."""
        return LINK_FREEDOMS * len(self.links)

    @cached_property
    def column(self) -> dict[str, int]:
        """The first column of every moving link."""
        return {name: LINK_FREEDOMS * k for k, name in enumerate(self.links)}

    @cached_property
    def ends(self) -> dict[str, Ends]:
        """The dimensions of every pair. Of several designs they are those of the first, at the first pose."""
        geometry = self.mechanism.geometry
        return {p.name: tuple(map(_first, p.ends(geometry))) for p in (*self.pairs, *self.driven)}

    def state(self, poses: Mapping[str, Pose]) -> Array:
        """Return the state in which the links have the given poses."""
        placed = (poses[name] for name in self.links)
        parts = [(p.z.c[0].real / self.size, p.z.c[0].imag / self.size, p.angle.c[0]) for p in placed]
        return np.array(parts, dtype=float).ravel()

    def poses(self, state: Array, of: Iterable[Pair] | None = None) -> dict[str, Pose]:
        """Return the poses of all links in a state, or of those that some pairs join."""
        found = {FRAME: FIXED}
        wanted = self.column if of is None else {name for pair in of for name in pair.members if name != FRAME}
        for name in wanted:
            k = self.column[name]
            angle = constant(float(state[k + 2]))
            found[name] = Pose(constant(complex(state[k], state[k + 1]) * self.size), angle.turn(), angle)
        return found

    def place(self, poses: dict[str, Pose], link: str, letter: str) -> complex:
        """Return where a point of a link is."""
        return complex(poses[link].at(_number(self.mechanism.geometry.points[link][letter])).c[0])

    def closures(self, state: Array) -> Array:
        """Return by how much every held coordinate is open, lengths in the user's unit."""
        links, _ = self._sides
        origins = np.append(state.reshape(-1, LINK_FREEDOMS)[:, :2] * self.size, [[0.0, 0.0]], axis=0)
        places = origins.T[:, links] + self._arms(state)
        others = self.mechanism.written_pairs
        poses = self.poses(state, others)
        rest = [float(np.real(c.c[0])) for p in others for c in p.closure(self.ends[p.name], _of(p, poses))]
        return np.append((places[:, 1] - places[:, 0]).T, rest)

    def coordinates(self, state: Array) -> Array:
        """Return the drivers' coordinates, as the drivers count them."""
        poses = self.poses(state, self.driven)
        found = []
        for drive, pair in zip(self.mechanism.drives, self.driven, strict=True):
            value = pair.coordinate(self.ends[pair.name], _of(pair, poses)).c[0]
            found.append(float(np.real(value)) * pair.driven_by(drive.link))
        return np.array(found)

    def is_properly_assembled(self, state: Array) -> bool:
        """Tell whether every closed pair is in the way that is meant."""
        poses = self.poses(state)
        return all(
            bool(np.all(pair.is_properly_assembled(self.ends[pair.name], _of(pair, poses)))) for pair in self.pairs
        )

    def jacobian(self, state: Array) -> tuple[Array, Array]:
        """Return the rows of all pairs by the state, each of the length 1. Return also by what each was divided."""
        others = self.mechanism.written_pairs
        poses = self.poses(state, others)
        tables = ((pair, pair.jacobian(self.ends[pair.name], _of(pair, poses))) for pair in others)
        rest = self._filled((pair, table[..., : pair.held, :]) for pair, table in tables)
        return self._scaled(np.concatenate([self._pin_rows(state), rest]), self.size)

    def driving(self, state: Array) -> Array:
        """Return the rows of the drivers' coordinates, each of the length 1. They are by the state."""
        poses = self.poses(state, self.driven)
        tables = ((pair, pair.jacobian(self.ends[pair.name], _of(pair, poses))) for pair in self.driven)
        coordinate = ((pair, table[..., pair.held : pair.held + 1, :]) for pair, table in tables)
        return self._scaled(self._filled(coordinate), self.size)[0]

    @cached_property
    def generic(self) -> Array:
        """The rows of all pairs at random geometry. They are the same kinds of pairs between the same links."""
        rng = np.random.default_rng(SEED)
        places: dict[str, Ends] = {}
        tables = []
        for number, pair in enumerate(self.pairs):
            # all links on a pin share its one place
            at = f"pin {pair.letters[0]}" if number < len(self.pins) else f"pair {pair.name}"
            ends = places.setdefault(at, pair.generic(rng))
            tables.append((pair, generic_jacobian(pair, ends)[..., : pair.held, :]))
        return self._scaled(self._filled(tables), 1.0)[0]

    @cached_property
    def _sides(self) -> tuple[Number, Number]:
        """The two links of every pin (2, pins), the frame after the moving ones, and its place on each of them."""
        number = {name: k for k, name in enumerate((*self.links, FRAME))}
        links = [[number[name] for name in pin.members] for pin in self.pins]
        points = [[end.point for end in self.ends[pin.name]] for pin in self.pins]
        return np.array(links, dtype=int).reshape(-1, 2).T, np.array(points, dtype=complex).reshape(-1, 2).T

    def _arms(self, state: Array) -> Array:
        """Return from the origins of its two links to every pin, in the world: x and y (2, 2, pins).

        All pins are computed at once, in real numbers: they are rounded as those of a single pair.
        """
        links, points = self._sides
        angles = np.append(state[2::LINK_FREEDOMS], 0.0)[links]
        cos, sin, x, y = np.cos(angles), np.sin(angles), points.real, points.imag
        return np.stack([cos * x - sin * y, cos * y + sin * x])

    def _pin_rows(self, state: Array) -> Array:
        """Return the rows of all pins, the gaps in x and in y of each."""
        links, _ = self._sides
        x, y = self._arms(state)
        rows = np.zeros((len(self.pins), 2, len(self.links) + 1, LINK_FREEDOMS))
        k = np.arange(len(self.pins))
        for side, sign in enumerate((-1.0, 1.0)):
            on = links[side]
            rows[k, 0, on, 0] = rows[k, 1, on, 1] = sign
            rows[k, 0, on, 2], rows[k, 1, on, 2] = -sign * y[side], sign * x[side]
        return rows.reshape(2 * len(k), self.width + LINK_FREEDOMS)[:, : self.width]

    def _filled(self, tables: Iterable[tuple[Pair, Any]]) -> Array:
        blocks = [(pair, np.asarray(one, float).reshape(-1, LINK_FREEDOMS * len(pair.members))) for pair, one in tables]
        filled, first = np.zeros((sum(len(block) for _, block in blocks), self.width)), 0
        for pair, block in blocks:
            rows = filled[first : first + len(block)]
            first += len(block)
            for side, name in enumerate(pair.members):
                if name in self.column:
                    part = block[:, LINK_FREEDOMS * side : LINK_FREEDOMS * (side + 1)]
                    rows[:, self.column[name] : self.column[name] + LINK_FREEDOMS] += part
        return filled

    def _scaled(self, matrix: Array, size: float) -> tuple[Array, Array]:
        matrix = matrix * np.tile([size, size, 1.0], len(self.links))
        lengths = np.linalg.norm(matrix, axis=1)
        lengths = np.where(lengths > 0.0, lengths, 1.0)
        return matrix / lengths[:, None], lengths


def _of(pair: Pair, poses: dict[str, Pose]) -> tuple[Pose, ...]:
    return tuple(poses[name] for name in pair.members)


def _first(end: End) -> End:
    return End(*(None if value is None else _number(value) for value in end))


def _number(value: Any) -> Any:
    return np.asarray(first_entry(value)).item()


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


def assemble(equations: ConstraintEquations, everywhere: bool = True) -> AssembledPose:
    """Find an assembled pose near the drawing, the drivers free. Without one, they are at their first values if any.

    What the drawing does not show is looked for from random starts too, `everywhere` or not at all.
    """
    mechanism = equations.mechanism
    if mechanism.sketch:
        return _nearest(equations, None, everywhere)
    drives = zip(mechanism.drives, equations.driven, strict=True)
    values = [
        (SOMEWHERE if pair.free_is_angle else 0.0) if drive.values is None else float(first_entry(drive.values))
        for drive, pair in drives
    ]
    at_values = _nearest(equations, np.array(values), everywhere)
    return at_values if at_values.is_closed else _nearest(equations, None, everywhere)


def _nearest(equations: ConstraintEquations, goal: Array | None, everywhere: bool) -> AssembledPose:
    best: AssembledPose | None = None
    for start, is_complete in _starts(equations):
        found = corrected(equations, start, goal)
        good = found.is_closed and equations.is_properly_assembled(found.state)
        if best is None or found.residual < best.residual:
            best = found
        if good or is_complete or not everywhere:
            return found
    assert best is not None
    return best


def _starts(equations: ConstraintEquations) -> Iterator[tuple[Array, bool]]:
    """List states to start from; the only one where a drawing shows every link."""
    shown = _drawn(equations)
    missing = [name for name in equations.links if name not in shown]
    places, guided = _places(equations, shown), _guided(equations, shown)
    middle = equations.around
    still = {name: _placed(equations, name, places, guided.get(name, 0.0), middle) for name in missing}
    yield equations.state({**shown, **still}), not missing
    rng = np.random.default_rng(len(missing))
    for _ in range(min(TRIES, COLUMNS // equations.width) if missing else 0):
        around = middle + complex(*rng.standard_normal(2)) * equations.size / 2.0
        angles = {name: float(rng.uniform(-np.pi, np.pi)) for name in missing} | guided
        turned = {name: _placed(equations, name, places, angles[name], around) for name in missing}
        yield equations.state({**shown, **turned}), False


def _drawn(equations: ConstraintEquations) -> dict[str, Pose]:
    """Return the poses of the links that the drawing fixes, or points of links that it fixes."""
    geometry = equations.mechanism.geometry
    shown = {name: pose.entry(FIRST) for name, pose in geometry.drawn.items()}
    seen = {letter: _number_of_start(p) for letter, p in geometry.sketch.items()}
    points = {
        name: {k: _number_of_start(p) for k, p in geometry.points[name].items()} for name in equations.mechanism.links
    }
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
    places = {letter: _number_of_start(p) for letter, p in geometry.sketch.items()}
    for name, pose in {**shown, FRAME: FIXED}.items():
        places.update({k: complex(pose.at(_number_of_start(p)).c[0]) for k, p in geometry.points[name].items()})
    return places


def _placed(
    equations: ConstraintEquations, name: str, places: Mapping[str, complex], angle: float, around: complex
) -> Pose:
    """Place a link that is not shown, at an angle; at the place of one of its points that is shown, else anywhere."""
    points = equations.mechanism.geometry.points[name]
    turned = complex(np.exp(1j * angle))
    at = next((places[k] - turned * _number_of_start(p) for k, p in points.items() if k in places), around)
    return Pose.of(complex(at), turned)


def _number_of_start(value: Number) -> complex:
    return complex(first_entry(value))
