"""The workspace of a point of a mechanism with two or three drivers: the region it reaches, and its boundary.

`Reach` is how far places are inside the reach of a point: the greatest least margin, in the modes that count.

Where the point is prescribed the rates of the drivers are the inverse of the Jacobian; where its determinant is zero
the mechanism moves though its drivers rest.

Sources: J. J. Craig, Introduction to Robotics, section 4.2 (reachable workspace); J.-P. Merlet, Parallel Robots,
chapter 7; C. Gosselin and J. Angeles (1990), the second kind, for its singular curves.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import TURN, Number, first_entry, wrapped
from compoundkin.base.bracketing import bisect_brackets, false_position
from compoundkin.base.copies import CopiesFields
from compoundkin.base.display import display_function
from compoundkin.base.errors import InvalidInput, NotAssembled, Problem, UnassembledPoses, UnknownName, suggestion
from compoundkin.base.linear import one_thread
from compoundkin.configurations.driver_range import starting_values
from compoundkin.configurations.enumeration import AllModes, closed_redundant
from compoundkin.configurations.prescribed_point import ACROSS, ALONG, TURN_OF, ModeSigns, PrescribedPoint
from compoundkin.configurations.region_boundary import Depths, Lattice, boundaries, lattice_of, signed_area
from compoundkin.kinematics import Motion, solve
from compoundkin.kinematics.block import BLOCK, EDGE, Block
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.solution import solving_order_of
from compoundkin.kinematics.solving_order import run
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.travel_limits import as_travel_limited
from compoundkin.structure.kinematic_structure import Structure

# Configurations assembled at once: their arrays stay in the caches.
AT_ONCE = 65536
# Samples of the link's angle over a turn; then a step to both sides of the best few, or BETWEEN around those at two
# neighbours, in so many parts at once, each time finer.
ANGLES, PEAKS, PARTS, FINE = 60, 3, 12, 1e-9
STEP, BETWEEN = TURN / ANGLES, TURN / 24.0
# Margin and number of trials of a place of the boundary; coarser where the angle is searched too.
FLAT, TRIALS = 1e-12, 60
FLAT_BY_ANGLES, TRIALS_BY_ANGLES = 1e-10, 16
# Groups without margins only close or not, and take long: bisection to a millionth of a step.
HALVINGS = 20


@dataclass(frozen=True)
class Reach:
    """The margins by which places are inside the reach of a point, over the configurations of its inverse mechanism.

    `ranges` are those of the drivers, `modes` the modes of the driven mechanism's groups that count. `live` has the
    signs of the configurations that occur, by groups of the inverse mechanism; without any all count. `angle` is that
    of the point's link where it is fixed.
    """

    prescribed: PrescribedPoint
    ranges: Mapping[str, tuple[float, float]]
    modes: GroupModes
    live: Mapping[int, Number] | None = None
    angle: float | None = None

    @property
    def seeks_angle(self) -> bool:
        """Whether the point's link may have any angle."""
        return self.prescribed.turns and self.angle is None

    def margins(self, z: Number, angle: Number, own: bool = True) -> Number:
        """Return the margins (configurations, n) of places and angles, with `own` only in the modes that count."""
        parts = [self._margins(z[k], angle[k], own) for k in self._parts(len(z))]
        return np.concatenate(parts, axis=1)

    def at(self, z: Number) -> Depths:
        """Return the depths of places (n,) in the best configuration and at the best angle."""
        fixed = np.full(len(z), 0.0 if self.angle is None else self.angle)
        if not self.seeks_angle:
            return self._best(z, fixed)
        turns = TURN * np.arange(ANGLES) / ANGLES
        every = self._of_angles(z, np.broadcast_to(turns[:, None], (ANGLES, len(z))))
        tried = self._best(z, turns[np.argmax(every, axis=0)])
        out = tried.margin < 0.0
        if out.any():
            better = self.near(z[out], turns[_peaks(every[:, out])], STEP)
            for one, other in zip(tried, better, strict=True):
                one[out] = other
        return tried

    def near(self, z: Number, angles: Number, half: float) -> Depths:
        """Return the depths at the best angle near one of some (m, n)."""
        if not self.seeks_angle:
            return self._best(z, angles[0])
        many, turned = np.tile(z, len(angles)), angles.ravel()
        while half > FINE:
            tried = turned + half * np.linspace(-1.0, 1.0, PARTS + 1)[:, None]
            best = np.argmax(self._of_angles(many, tried), axis=0)
            turned = np.take_along_axis(tried, best[None], axis=0)[0]
            half *= 2.0 / PARTS
        found = Depths(*(one.reshape(angles.shape) for one in self._best(many, turned)))
        best = np.argmax(found.margin, axis=0)[None]
        return Depths(*(np.take_along_axis(one, best, axis=0)[0] for one in found))

    def _of_angles(self, z: Number, angles: Number) -> Number:
        """Return the margins (m, n) of angles at each place."""
        return self._best(np.broadcast_to(z, angles.shape).ravel(), angles.ravel()).margin.reshape(angles.shape)

    def boundary(self, inside: Number, outside: Number, angles: Number) -> Number:
        """Return the places between pairs where the reach ends, at angles near those of both (2, n)."""
        way = outside - inside

        def margin(part: Number) -> Number:
            return self.near(inside + part * way, angles, BETWEEN).margin

        zero, one = np.zeros(len(way)), np.ones(len(way))
        if self.prescribed.inverse.numbered:
            part, _ = bisect_brackets(lambda part: margin(part) >= 0.0, zero, one, HALVINGS)
            return inside + part * way
        exact = (FLAT_BY_ANGLES, TRIALS_BY_ANGLES) if self.seeks_angle else (FLAT, TRIALS)
        part = false_position(margin, one, np.fmax(margin(zero), 0.0) + ROUNDING**2, margin(one), *exact)
        return inside + np.where(np.isfinite(part), part, 0.0) * way

    def meets(self, z: Number, angle: Number) -> Number:
        """Return whether places are inside at angles, within rounding."""
        return np.any(self.margins(z, angle) >= -ROUNDING, axis=0)

    def occurring(self, z: Number, angle: Number) -> Reach:
        """Return the reach of the configurations alone that occur at some places."""
        if self.prescribed.inverse.numbered:
            return self
        which = np.flatnonzero(np.any(self.margins(z, angle) >= -ROUNDING, axis=1))
        signed = [solver.index for solver in self.prescribed.inverse.solvers if solver.modes == 2]
        table = np.array(np.unravel_index(which, (2,) * max(len(signed), 1)))
        # the last group has the first axis
        return replace(self, live={k: 1 - 2 * table[len(signed) - 1 - n] for n, k in enumerate(signed)})

    def _best(self, z: Number, angle: Number) -> Depths:
        found = self.margins(z, angle)
        number = np.argmax(found, axis=0)
        return Depths(np.take_along_axis(found, number[None], axis=0)[0], angle, number)

    def _parts(self, count: int) -> list[slice]:
        signed = sum(solver.modes == 2 for solver in self.prescribed.inverse.solvers)
        many = 2**signed if self.live is None else len(next(iter(self.live.values()), (1,)))
        wide = max(1, AT_ONCE // max(many, 1))
        return [slice(k, k + wide) for k in range(0, count, wide)] or [slice(0, 0)]

    def _margins(self, z: Number, angle: Number, own: bool) -> Number:
        block, given = self.prescribed.block(z, angle)
        block.limits = EDGE
        with np.errstate(all="ignore"):
            if self.live is None:
                run(self.prescribed.inverse, block, AllModes(self.prescribed.inverse, given, block))
            else:
                count = len(next(iter(self.live.values()), (1,)))
                block.shape = (count, *block.shape)
                run(self.prescribed.inverse, block, ModeSigns({k: v[:, None, None] for k, v in self.live.items()}))
            closed = closed_redundant(self.prescribed.inverse, block)
            found = np.broadcast_to(np.where(closed, self._least(block), -1.0), block.shape).reshape(-1, len(z))
            margins = self.modes.limited(self.prescribed, block, found) if own and self.modes.signs else found
            return np.where(np.isnan(margins), -1.0, margins)

    def _least(self, block: Block) -> Number:
        """Return the least margin of groups, ends of guides and the drivers' ranges."""
        total: Number = np.ones((1, 1))
        for solver in self.prescribed.inverse.solvers:
            margin = solver.margin(block)
            if margin is None:
                place = block.world[solver.group.bodies[0].links[0]].z.c[0]
                margin = np.where(np.isfinite(place), 1.0, -1.0)
            total = np.minimum(total, margin)
        if self.prescribed.inverse.guide_ends.pairs:
            total = np.minimum(total, self.prescribed.inverse.guide_ends.margin(block))
        for name, value in self.prescribed.coordinates(block).items() if self.ranges else ():
            if name in self.ranges:
                total = np.minimum(total, self._inside(name, value.c[0]))
        return total

    def _inside(self, name: str, value: Number) -> Number:
        """Return how far a driver is inside its range, in radians or parts of the size."""
        low, high = self.ranges[name]
        is_angle = self.prescribed.driven.structure.driven_angles[name]
        off = value - (low + high) / 2.0
        half = (high - low) / 2.0
        return half - np.abs(wrapped(off)) if is_angle else (half - np.abs(off)) / self.prescribed.driven.size


def _peaks(values: Number) -> Number:
    """Return the indices (few, n) of the highest peaks of values (m, n) around a turn."""
    high = (values >= np.roll(values, 1, axis=0)) & (values >= np.roll(values, -1, axis=0))
    return np.argsort(np.where(high, values, -np.inf), axis=0)[-PEAKS:]


# A group is in a mode where its poses agree within this part of the size (or radians).
SAME = 1e-7
# Margins above this count as inside: rounding at ends of ranges.
ROUNDING = 1e-9


@dataclass(frozen=True)
class GroupModes:
    """The modes that count, by groups of the driven mechanism; other groups may have any."""

    signs: Mapping[int, int]

    def limited(self, prescribed: PrescribedPoint, block: Block, found: Number) -> Number:
        """Return the margins (configurations, n) of an inverse block, negative in another mode of the driven mechanism.

        Those beyond the ends of a range are included, so that margins have no jumps.
        """
        driven = prescribed.driven
        solved = {name: (one.c[0],) for name, one in prescribed.coordinates(block).items()}
        drives = {**prescribed.inputs.drives, **solved}
        other = driven.start(prescribed.inputs.ends, prescribed.inputs.driven(drives).series(0), 0, block.shape)
        for name in (name for group in driven.structure.groups for name in group.links):
            other.world[name] = block.world[name]
        for k, sign in self.signs.items():
            inside = _in_mode(other, driven.solvers[k], sign, driven.size)
            found = np.minimum(found, np.broadcast_to(inside, block.shape).reshape(found.shape))
        return found


def _in_mode(block: Block, solver: GroupSolver, sign: int, size: float) -> Number:
    """Return the margin of a group of the driven mechanism, negative where it is in another mode."""
    trial = block.copy()
    trial.limits = EDGE
    solver.close(trial, float(sign))
    pairs = [(trial.world[body.links[0]], block.world[body.links[0]]) for body in solver.group.bodies]
    gaps = [np.abs(one.z.c[0] - two.z.c[0]) / size + np.abs(one.u.c[0] - two.u.c[0]) for one, two in pairs]
    away = np.maximum.reduce(gaps)
    margin = solver.margin(trial)
    margin = np.ones((1, 1)) if margin is None else np.maximum(margin, 0.0)
    return np.where(away < SAME, margin, -margin)


def value_in_range(value: float, span: tuple[float, float] | None) -> float:
    """Return a driver's value if its range includes it, else the middle of the range.

    >>> value_in_range(1.0, (0.0, 2.0)), value_in_range(5.0, (0.0, 2.0)), value_in_range(5.0, None)
    (1.0, 1.0, 5.0)
    """
    return value if span is None or span[0] <= value <= span[1] else 0.5 * (span[0] + span[1])


def reference_pose(structure: Structure, values: Mapping[str, float], modes: Mapping[str, int] | str | None) -> Motion:
    """Return one pose of a mechanism, which defines its modes."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnassembledPoses)
        return solve(structure, {name: [value] for name, value in values.items()}, order=0, modes=modes)


def signs_of_pose(pose: Motion) -> dict[int, int]:
    """Return the modes of a pose, by the groups with signs."""
    return {solver.index: pose.sign(solver.index, 0) for solver in pose.solving_order.solvers if solver.modes == 2}


# Cells along the longer side, beside the boundary: with two drivers each takes a microsecond, with three the angle of
# the point's link is searched at each, and groups without a closed form take milliseconds.
CELLS, CELLS_OF_THREE, CELLS_OF_NUMBERED = 320, 128, 48
FEWEST, MOST = 8, 4096
# The search covers the places that driving reaches, and this part of their extent around them.
AROUND = 0.06
EVERY_MODE = "all"


@dataclass(frozen=True, eq=False, repr=False)
class Workspace(CopiesFields):
    """The region of the plane that a point reaches, in the mechanism's unit of length.

    `outer` and `inner` are the closed curves (complex, the last point the first) around it and around its holes. Their
    points are on the boundary to rounding, the straight lines between them within `step`. `ranges` are those of the
    drivers (absent: a full turn), `orientation` is the angle of the point's link where it is fixed, `modes` says which
    assembly modes count, `pose` is one pose of the mechanism.
    """

    point: str
    drivers: tuple[str, ...]
    ranges: Mapping[str, tuple[float, float]]
    orientation: float | None
    modes: str
    outer: tuple[Number, ...]
    inner: tuple[Number, ...]
    lattice: Lattice
    reach: Reach
    pose: Motion

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism."""
        return self.pose.mechanism

    @property
    def link(self) -> str:
        """The link whose angle is the orientation: the first that carries the point."""
        return self.reach.prescribed.carrier

    @property
    def step(self) -> float:
        """The width of the cells beside the boundary. Smaller details, and holes below four cells, may be missed."""
        return self.lattice.step

    @property
    def area(self) -> float:
        """The area of the region without its holes, from the polygons."""
        return sum(signed_area(curve) for curve in (*self.outer, *self.inner))

    @property
    def places(self) -> Number:
        """A square lattice of places (rows, columns), complex."""
        return self.lattice.places

    @property
    def inside(self) -> Number:
        """Whether the point reaches each of the `places`."""
        return self.lattice.inside

    @cached_property
    def condition(self) -> Number:
        """The condition number of the Jacobian to the point, at the `places`.

        Lengths are parts of the size. It is the least of the configurations that lead there, over a dozen angles where
        the orientation is free; NaN outside, and where groups have no closed form.
        """
        found = np.full(self.inside.shape, np.nan)
        if self.reach.live is not None:
            found[self.inside] = least_condition_numbers(self.reach, self.lattice)
        return found

    @cached_property
    def determinants(self) -> Number:
        """The determinants of the inverse Jacobian over the `places`, (configurations, rows, columns).

        Zero where the drivers do not determine the point's velocity (singular of the second kind, parallel). NaN where
        a configuration does not lead there; empty with three drivers and a free orientation.
        """
        return rate_determinants(self.reach, self.lattice)

    def contains(self, points: Any) -> Number:
        """Return whether the point reaches places, complex, by solving the mechanism there.

        >>> from compoundkin.files import load
        >>> workspace(load("five-bar"), "P").contains([59 + 158j, 300 + 0j]).tolist()
        [True, False]
        """
        z = np.asarray(points)
        if z.dtype.kind not in "iufc":
            raise InvalidInput(Problem("points", f"{points!r} are no places", "give complex numbers x + 1j * y"))
        return (self.reach.at(z.astype(complex).ravel()).margin >= -ROUNDING).reshape(z.shape)

    def plot(self, **options: Any) -> Any:
        """Draw the region with its boundary, and the mechanism in one pose, by `compoundkin.plots.workspace`."""
        return display_function("workspace")(self, **options)

    def __repr__(self) -> str:
        holes = f", {len(self.inner)} of them holes" if self.inner else ""
        parts = len(self.outer) + len(self.inner)
        unit = f" {self.mechanism.unit}^2" if self.mechanism.unit else ""
        region = f"{self.area:.6g}{unit}, {parts} boundary curve{'s' if parts > 1 else ''}{holes}"
        return f"Workspace({self.point} by {', '.join(self.drivers)}: {region}; {self.modes})"


@checked
@one_thread
def workspace(
    mechanism: Mechanism | Structure,
    point: str,
    ranges: Mapping[str, Any] | None = None,
    *,
    orientation: float | None = None,
    modes: Mapping[str, int] | str | None = None,
    cells: int | None = None,
) -> Workspace:
    """Return the region that a point reaches by two or three drivers.

    `ranges` of the drivers (low, high) are radians or lengths; a driver of a pin turns fully without one, a cylinder
    goes through its stroke, a slide needs one. With three drivers the point's link may have any angle, or that of
    `orientation`. The region is that of the assembly modes that `solve` takes, or those `modes` by link, whatever the
    solution of the inverse problem; of groups without signs, and with ``modes="all"`` of all, any mode counts. `cells`
    go along the longer side of the region. Dimensions are those of the first design.

    A place is reached where all groups of the mechanism driven there close within the ranges. So the boundary is exact;
    only details finer than a cell may be missed.

    Raises UnknownName for an unknown point; InvalidInput for one driver or four, for missing ranges, and where the
    drivers do not follow from the place; NotAssembled where the point reaches no place.

    >>> from compoundkin.model.elements import drive, link
    >>> arm = Mechanism("Arm", link("frame", A=0), link("upper", A=0, B=2), link("fore", B=0, P=1), drive("upper"),
    ...                 drive("fore", on="upper"))
    >>> found = workspace(arm, "P")
    >>> round(found.area / np.pi, 2), len(found.outer), len(found.inner)
    (8.0, 1, 1)
    """
    if orientation is not None and not np.isfinite(orientation):
        raise InvalidInput(Problem("orientation", f"{orientation} is no angle", "give radians"))
    structure = solving_order_of(mechanism).structure
    known = driver_ranges(structure, ranges)
    free = free_drivers(structure, point, orientation)
    started = starting_values(solving_order_of(structure), {})
    values = {name: value_in_range(value, known.get(name)) for name, value in started.items()}
    prescribed = PrescribedPoint.of(
        structure.mechanism, point, free, {name: v for name, v in values.items() if name not in free}
    )
    pose = reference_pose(structure, values, None if modes == EVERY_MODE else modes)
    own = GroupModes({} if modes == EVERY_MODE else signs_of_pose(pose))
    reach = Reach(prescribed, {name: known[name] for name in free if name in known}, own, None, orientation)
    z, angle = reached_by_driving(prescribed, known)
    met = reach.meets(z, angle) if len(z) else np.zeros(0, dtype=bool)
    if not met.any():
        raise _nothing(reach)
    lattice = _lattice(reach := reach.occurring(z[met], angle[met]), z[met], cells)
    curves = boundaries(reach, lattice)
    outer, inner = (tuple(c for c in curves if (signed_area(c) > 0.0) == is_outer) for is_outer in (True, False))
    counted = "the assembly modes of solve" if own.signs else "every assembly mode"
    return Workspace(point, free, dict(known), orientation, counted, outer, inner, lattice, reach, pose)


def _lattice(reach: Reach, z: Number, cells: int | None) -> Lattice:
    """Return the lattice over the region. Raises NotAssembled where it is empty."""
    usual = CELLS_OF_NUMBERED if reach.live is None else CELLS_OF_THREE if reach.seeks_angle else CELLS
    wide = usual if cells is None else cells
    if not FEWEST <= wide <= MOST:
        raise InvalidInput(Problem("cells", f"{wide} cells are no lattice", f"give {FEWEST} to {MOST}"))
    size = reach.prescribed.driven.size
    if reach.angle is not None:
        # the sampled places have any angle: find the region of this one first
        first = lattice_of(reach, _box(z, size), CELLS_OF_THREE)
        z = first.places[first.inside]
        if not len(z):
            raise _nothing(reach)
    return lattice_of(reach, _box(z, size), wide)


def _nothing(reach: Reach) -> NotAssembled:
    what = f"{reach.prescribed.point} reaches no region: the mechanism cannot be assembled in it within the ranges"
    return NotAssembled(Problem("workspace", what, 'widen the ranges, leave orientation out, or try modes="all"'))


def _box(z: Number, size: float) -> tuple[complex, complex]:
    low, high = complex(np.min(z.real), np.min(z.imag)), complex(np.max(z.real), np.max(z.imag))
    wide = AROUND * max((high - low).real, (high - low).imag) or size
    return low - complex(wide, wide), high + complex(wide, wide)


# Samples of each driver for the extent of the region, with two drivers and with three.
TRIED = {2: 40, 3: 12}
# A full turn is not tried at round angles, where poses are special.
SEAM = 0.123
# So many places suffice for configurations and extent.
ENOUGH = 3000


def driver_ranges(structure: Structure, ranges: Mapping[str, Any] | None) -> dict[str, tuple[float, float]]:
    """Return the ranges of the drivers that have one, from the call or the ends of guides."""
    problems = [
        Problem(f"ranges.{name}", f"there is no driver {name!r}", suggestion(name, list(structure.driven)))
        for name in ranges or {}
        if name not in structure.driven
    ]
    if problems:
        raise InvalidInput(problems)
    found = {}
    for name, step in structure.driven.items():
        own = as_travel_limited(step.pair)
        if ranges and name in ranges:
            found[name] = _range(name, ranges[name])
        elif own is not None and np.all(
            np.isfinite([first_entry(b) for b in own.bounds(structure.mechanism.geometry)])
        ):
            low, high = own.bounds(structure.mechanism.geometry)
            found[name] = float(first_entry(low)), float(first_entry(high))
        elif not step.pair.free_is_angle:
            problems.append(Problem(f"ranges.{name}", "a slide has no end of its own", _example(structure, name)))
    if problems:
        raise InvalidInput(problems)
    # a full turn and more is no limit
    return {name: v for name, v in found.items() if not structure.driven_angles[name] or v[1] - v[0] < TURN}


def _range(name: str, value: Any) -> tuple[float, float]:
    try:
        low, high = (float(one) for one in value)
    except (TypeError, ValueError):
        raise InvalidInput(Problem(f"ranges.{name}", f"{value!r} is not a range", "give (low, high)")) from None
    if not (np.isfinite([low, high]).all() and low < high):
        raise InvalidInput(Problem(f"ranges.{name}", f"{low:g} to {high:g} is not a range", "give (low, high)"))
    return low, high


def _example(structure: Structure, name: str) -> str:
    values = next(drive.values for drive in structure.mechanism.drives if drive.name == name)
    low, high = (float(np.min(values)), float(np.max(values))) if values is not None else (0.0, 0.0)
    if low == high:
        low, high = 0.0, structure.mechanism.geometry.size
    return f"say from where to where: ranges={{{name!r}: ({low:g}, {high:g})}}"


def free_drivers(structure: Structure, point: str, orientation: float | None) -> tuple[str, ...]:
    """Return the drivers that move a point, two or three. Raises UnknownName, and InvalidInput for another number."""
    carriers = structure.mechanism.carriers
    if point not in carriers:
        raise UnknownName(Problem(point, "there is no such point", suggestion(point, list(carriers))))
    moving = set(_drivers_of(structure, carriers[point][0]))
    free = tuple(name for name in structure.driven if name in moving)
    if len(free) in TRIED:
        if orientation is not None and len(free) == 2:
            link = carriers[point][0]
            what = f"two drivers leave {link} no choice of its angle where {point} is"
            raise InvalidInput(Problem("orientation", what, "leave it out"))
        return free
    if len(free) < 2:
        fault = f"one driver ({free[0]}) moves {point}, on a curve" if free else f"no driver moves {point}"
        how = f'a curve is drawn by compoundkin.plots.paths(motion, "{point}"); name a point that more drivers move'
        raise InvalidInput(Problem("workspace", f"{fault}: that is no region", how))
    what = f"{len(free)} drivers ({', '.join(free)}) move {point}, but a place and an angle determine three at most"
    raise InvalidInput(Problem("workspace", what, "hold some: replace their drives by links of one piece"))


def _drivers_of(structure: Structure, link: str) -> Iterator[str]:
    """Yield the drivers that may move a link, possibly repeated."""
    group = next((group for group in structure.groups if link in group.links), None)
    if group is not None:
        yield from (step.drive.name for body in group.bodies for step in body.driven if not step.is_passive)
        for used in group.uses:
            yield from _drivers_of(structure, used)
        return
    for step in structure.ground.driven:
        if step.link == link:
            if not step.is_passive:
                yield step.drive.name
            yield from _drivers_of(structure, step.parent)


def reached_by_driving(prescribed: PrescribedPoint, ranges: Mapping[str, tuple[float, float]]) -> tuple[Number, Number]:
    """Return places (n,) of the point in any mode over the drivers' ranges, and the angles of its link."""
    count = TRIED[len(prescribed.free)]
    axes = [
        np.linspace(*ranges[name], count) if name in ranges else SEAM + TURN * np.arange(count) / count
        for name in prescribed.free
    ]
    grid = [axis.ravel() for axis in np.meshgrid(*axes)]
    sampled = {name: (values[None],) for name, values in zip(prescribed.free, grid, strict=True)}
    drives = {**prescribed.inputs.drives, **sampled}
    given = prescribed.inputs.of_poses(grid[0].size).driven(drives)
    with np.errstate(all="ignore"):
        found = AllModes.of(prescribed.driven, given)
        closed = np.asarray(found.block.failed) == 0
        z, angle, real = (found.full(array).ravel() for array in (*prescribed.placed(found.block), closed))
    z, angle = z[real], angle[real]
    thin = slice(None, None, max(1, z.size // ENOUGH))
    return z[thin], angle[thin]


# Samples of the link's angle where the orientation is free.
RATE_ANGLES = 12


def inverse_rates(reach: Reach, z: Number, angle: Number, number: Number) -> Number:
    """Return the rates (n, drivers, coordinates) of drivers by the coordinates of the prescribed point, without units.

    The coordinates are x, y and, where it is prescribed, the angle of the point's link; `number` is the configuration
    of each place.
    """
    cuts = [slice(k, k + BLOCK) for k in range(0, max(len(z), 1), BLOCK)]
    return np.concatenate([_rates(reach, z[k], angle[k], number[k]) for k in cuts])


def _rates(reach: Reach, z: Number, angle: Number, number: Number) -> Number:
    prescribed, size = reach.prescribed, reach.prescribed.driven.size
    signs = ModeSigns({k: v[number][None] for k, v in (reach.live or {}).items()})
    columns = []
    for moved, unit in ((ALONG, size), (ACROSS, size), *([(TURN_OF, 1.0)] if prescribed.turns else [])):
        block, _ = prescribed.block(z, angle, 1, moved)
        with np.errstate(all="ignore"):
            run(prescribed.inverse, block, signs)
            rates = {name: one.derivative(1) for name, one in prescribed.coordinates(block).items()}
        units = {name: 1.0 if prescribed.driven.structure.driven_angles[name] else size for name in rates}
        columns.append([np.broadcast_to(one, (1, len(z)))[0] * unit / units[name] for name, one in rates.items()])
    return np.moveaxis(np.array(columns), (0, 1, 2), (2, 1, 0))


def least_condition_numbers(reach: Reach, lattice: Lattice) -> Number:
    """Return the least condition numbers (n,) of the Jacobian to the point at the inner places of a lattice.

    They are the least over the configurations that lead there; with a free orientation, over some angles too.
    """
    z = lattice.places[lattice.inside]
    least = np.full(len(z), np.nan)
    for turned in TURN * np.arange(RATE_ANGLES) / RATE_ANGLES if reach.seeks_angle else [reach.angle or 0.0]:
        angle = np.full(len(z), turned)
        for number, on in enumerate(reach.margins(z, angle) >= 0.0):
            count = np.full(np.count_nonzero(on), number)
            least[on] = np.fmin(least[on], _condition(inverse_rates(reach, z[on], angle[on], count)))
    return least


def _condition(rates: Number) -> Number:
    """Return the condition numbers of the point's Jacobian by the drivers, from the drivers' rates."""
    unit = np.eye(rates.shape[1])
    safe = np.where(np.isfinite(rates).all(axis=(1, 2))[:, None, None], rates, 0.0 * unit)
    regular = np.abs(np.linalg.det(safe)) > 0.0
    values = np.linalg.svd(np.linalg.inv(np.where(regular[:, None, None], safe, unit))[:, :2], compute_uv=False)
    return np.where(regular, values[:, 0] / values[:, -1], np.inf)


def rate_determinants(reach: Reach, lattice: Lattice) -> Number:
    """Return the determinants of the drivers' rates over a lattice, (configurations, rows, columns).

    NaN where a configuration does not occur; empty with a free orientation.
    """
    if reach.live is None or reach.seeks_angle:
        return np.empty((0, *lattice.places.shape))
    z, angle = lattice.places.ravel(), lattice.angle.ravel()
    margins = reach.margins(z, angle, own=False)
    found = np.full(margins.shape, np.nan)
    for number, on in enumerate(margins >= 0.0):
        count = np.full(np.count_nonzero(on), number)
        found[number, on] = np.linalg.det(inverse_rates(reach, z[on], angle[on], count))
    return found.reshape(-1, *lattice.places.shape)
