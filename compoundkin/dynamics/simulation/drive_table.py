"""The table of one driver's motion: coefficients of the equation of motion as Chebyshev polynomials, piece by piece.

With one degree of freedom everything but time and speed is a function of the coordinate. It is solved once at Chebyshev
points of pieces that are halved until the polynomials hold to rounding. Places where too many digits are lost, such as
change points, are bridged smoothly.

Source: L. N. Trefethen, Approximation Theory and Approximation Practice, SIAM 2013, chapters 3 and 4.
"""

from __future__ import annotations

import warnings
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from itertools import pairwise

import numpy as np

from compoundkin.base.arrays import Number, first_entry
from compoundkin.base.errors import CompoundkinError
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series
from compoundkin.dynamics.loaded_block import LoadedBlock, loaded_blocks
from compoundkin.dynamics.mass_motion import mass_motions
from compoundkin.dynamics.simulation.load_breaks import LoadBreak, LoadPlace, joined, load_places
from compoundkin.kinematics import solve
from compoundkin.kinematics.configuration import Configuration
from compoundkin.kinematics.extremes import between
from compoundkin.kinematics.motion import Motion
from compoundkin.model.loads.contract import Load
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends

# A pair that moves so many times as fast as a driver, by their scales, is the better coordinate: the equation of motion
# has squares of this ratio and loses twice as many digits.
FASTER = 30.0
# Pieces of a table to begin with, how often they are halved, and the points of each.
PIECES, HALVED, POINTS = 16, 7, 24
# Polynomials are accurate where their last coefficients are below this part of the largest: a hundred roundings.
HOLDS, LAST = 3e-14, 3
# Near a change point accelerations have some ten digits; a corner of a load is still far above this.
HOLDS_NEAR = 1e-8
# Poses of the motion that has the configuration.
POSES = 145


@dataclass(frozen=True, eq=False)
class DriveTable:
    """A table over a range of a driver: accurate pieces in order, with gaps."""

    low: float
    high: float
    pieces: Sequence[TablePiece]
    starts: Sequence[float]
    course: TableCourse
    least: Mapping[int, float]  # sizes of scales whose rows may be rounding alone
    breaks: Sequence[LoadBreak] = ()  # where its loads jump, wake or have corners, which are ends of pieces

    @property
    def motion(self) -> Motion:
        """The motion that has the configuration."""
        return self.course.motion

    def piece(self, value: float) -> TablePiece | None:
        """Return the piece at a value."""
        return piece_at(self.pieces, self.starts, value)

    def sign(self, k: int, value: float) -> float:
        """Return the sign of a dyad's mode at a value."""
        place = _places(np.array([[value]]), (self.low, self.high))
        return float(np.ravel(self.motion.followed.sign(k, np.array([[0]]), place))[0])


def piece_at(pieces: Sequence[TablePiece], starts: Sequence[float], value: float) -> TablePiece | None:
    """Return the piece at a value, None in a gap. Pieces are in order, and begin at the starts."""
    k = bisect_right(starts, value) - 1
    found = pieces[k] if k >= 0 else None
    return found if found is not None and value <= found.high else None


def drive_table(
    first: Configuration, driver: str, low: float, high: float, loads: Sequence[Sequence[Load]], pairs: Sequence[Pair]
) -> DriveTable | None:
    """Return the table of a driver around a configuration, None where it cannot be solved."""
    mechanism = first.structure.mechanism
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            values = np.linspace(low, high, POSES)
            motion = solve(mechanism, {driver: values}, speed=1.0, acceleration=0.0, order=2, modes=first)
            breaks = table_breaks(TableCourse(motion, (low, high)), [load for some in loads for load in some])
            course = TableCourse(motion, (low, high), tuple(one.behind for one in breaks))
            least = {FORCES: _usual_force(motion, loads)}
            found = accurate_pieces(course, partial(drive_terms, loads=loads), DRIVE_SCALES, pairs, least)
    except CompoundkinError:
        return None
    whole = with_bridges(found, high - low)
    return DriveTable(low, high, whole, [piece.low for piece in whole], course, least, breaks)


# The scales of the rows of a table by number: the bias is a derivative of the inertia; both forces have one scale.
DRIVE_SCALES = (0, 0, 1, 1)
FORCES = 1


def _usual_force(motion: Motion, loads: Sequence[Sequence[Load]]) -> float:
    """Return the usual size of forces along a driver: in dwells, and where weights do no work, they are rounding alone.

    It is a median, for next to limit positions forces grow beyond all bounds.
    """
    rows, fall = drive_terms(motion, loads), abs(complex(first_entry(motion.mechanism.free_fall)))
    weights = sum((np.ravel(fall * own.mass * np.abs(own.centre[1])) for own in mass_motions(motion)), np.zeros(1))
    usual = 0.0
    for row in (weights, np.abs(rows[2]), np.abs(rows[3])):
        known = row[np.isfinite(row) & (row > 0.0)]
        usual = max(usual, float(np.median(known)) if known.size else 0.0)
    return usual


@dataclass(frozen=True, eq=False)
class TableCourse:
    """The motion of a table between the ends of the driver, solved again at the points of pieces."""

    motion: Motion
    ends: tuple[float, float]
    breaks: tuple[float, ...] = ()
    known: dict[tuple[tuple[float, float], ...], Motion] = field(default_factory=dict)

    def at(self, parts: Sequence[tuple[float, float]]) -> Motion:
        """Return the motion at the points of some pieces, which several tables ask for."""
        key = tuple(parts)
        if key not in self.known:
            values = np.concatenate([(a + b) / 2.0 + (b - a) / 2.0 * NODES for a, b in parts])
            self.known[key] = between(self.motion, 0, _places(values, self.ends))
        return self.known[key]


def accurate_pieces(
    course: TableCourse,
    terms: Callable[[Motion], Number],
    scales: Sequence[int],
    pairs: Sequence[Pair],
    least: Mapping[int, float] | None = None,
) -> list[TablePiece]:
    """Return the pieces of a table in which its terms hold, in order.

    Rows of one scale have the same number; `least` are sizes of scales whose rows may be rounding alone.
    """
    found, todo = [], list(pairwise(_edges(course)))
    for _ in range(HALVED + 1):
        made = _solved(course, todo, terms, pairs)
        held = [_is_accurate(piece, scales, least or {}) for piece in made]
        found += [piece for piece, holds in zip(made, held, strict=True) if holds]
        broken = [piece for piece, holds in zip(made, held, strict=True) if not holds]
        broken = [one for one in broken if one.least < FASTER]
        todo = [part for one in broken for part in pairwise([one.low, (one.low + one.high) / 2, one.high])]
        if not todo:
            break
    else:
        if course.motion.change_points:
            found += [piece for piece in broken if _is_accurate(piece, scales, least or {}, HOLDS_NEAR)]
    return sorted(found, key=lambda piece: piece.low)


def _edges(course: TableCourse) -> list[float]:
    """Return the ends of the pieces to begin with: even ones, but for those beside a break of a load."""
    low, high = course.ends
    breaks = np.array([one for one in course.breaks if low < one < high])
    even, near = np.linspace(low, high, PIECES + 1), BESIDE_BREAK * (high - low)
    apart = [float(one) for one in even if one in course.ends or not np.any(np.abs(breaks - one) < near)]
    return sorted({*apart, *breaks.tolist()})


# An even end of a piece is left out within this part of the table from a break.
BESIDE_BREAK = 1e-4
# Poses of a table are so many times as dense where breaks are looked for; their places are found by so many steps.
DENSER, REFINED = 8, 60


def table_breaks(course: TableCourse, loads: Sequence[Load]) -> tuple[LoadBreak, ...]:
    """Return the values of the driver at which loads that depend on the pose alone jump, wake or have corners."""
    places = load_places(loads)
    if not places:
        return ()
    motion, found = course.motion, list[LoadBreak]()
    index = np.linspace(0.0, POSES - 1.0, (POSES - 1) * DENSER + 1)
    dense = between(motion, 0, index)
    for place in places:
        row = _place_row(place, dense)
        known = row[np.isfinite(row)]
        if not known.size:
            continue
        begun = partial(_first_block, dense)
        breaks = place.breaks(float(known.min()), float(known.max()), motion.size, begun)
        goals = np.array([one.behind for one in breaks])
        above = row[:, None] >= goals
        here, which = np.nonzero((above[1:] != above[:-1]) & np.isfinite(row[1:] + row[:-1])[:, None])
        low, high, rises = index[here], index[here + 1], above[here + 1, which]
        for _ in range(REFINED if len(here) else 0):
            middle = 0.5 * (low + high)
            is_behind = (_place_row(place, between(motion, 0, middle)) >= goals[which]) == rises
            low, high = np.where(is_behind, low, middle), np.where(is_behind, middle, high)
        width = (course.ends[1] - course.ends[0]) / (POSES - 1)
        for value, k in zip((course.ends[0] + width * high).tolist(), which.tolist(), strict=True):
            found.append(LoadBreak(value, value, *breaks[k][2:]))
    return joined(found, JOINED * (course.ends[1] - course.ends[0]))


# Breaks within this part of a table are one.
JOINED = 1e-10


def _first_block(motion: Motion) -> LoadedBlock:
    return next(iter(loaded_blocks(motion)))


def _place_row(place: LoadPlace, motion: Motion) -> Number:
    """Return the coordinate of a load at the poses of a motion."""
    return np.concatenate(
        [np.broadcast_to(np.ravel(place.value(at)), at.block.shape[1]) for at in loaded_blocks(motion)]
    )


def _is_accurate(piece: TablePiece, scales: Sequence[int], least: Mapping[int, float], part: float = HOLDS) -> bool:
    rows, largest = np.array(scales), np.zeros(max(scales) + 1)
    for scale, size in least.items():
        largest[scale] = size
    np.maximum.at(largest, rows, np.max(np.abs(piece.terms), axis=1))
    # steep loads have the rounding of the driver's value, enlarged
    slopes = np.abs(piece.terms) @ np.square(_DEGREES) * 2.0 / (piece.high - piece.low)
    rounding = ROUNDINGS * np.finfo(float).eps * max(abs(piece.low), abs(piece.high)) * slopes
    middle, last = (np.max(np.abs(piece.terms[:, some]), axis=1) for some in (FLAT_FROM, LAST_ONES))
    is_flat = (last >= FLAT * middle) & (last <= NOISE * largest[rows])
    return bool(np.all((last <= part * largest[rows] + rounding) | is_flat))


# So many roundings of the driver's value may be in a load.
ROUNDINGS = 8.0
# What no longer falls over the second half of the coefficients, within this part, and is below this part of the
# largest, is rounding of reactions that cancel: no halving makes it less.
FLAT_FROM, LAST_ONES, FLAT, NOISE = slice(POINTS // 2, -LAST), slice(-LAST, None), 0.2, 1e-11


def _solved(
    course: TableCourse,
    parts: Sequence[tuple[float, float]],
    terms: Callable[[Motion], Number],
    pairs: Sequence[Pair],
) -> list[TablePiece]:
    """Return pieces, solved together."""
    at = course.at(parts)
    rows = terms(at)
    # beyond a travel limit groups still close
    rows[:, (at.failed[0] > 0) & (at.failed[0] <= len(at.structure.groups))] = np.nan
    ratios = _ratios(at, pairs)
    slowest = np.where(np.isfinite(rows).all(axis=0), ratios, np.inf)
    cuts = [slice(k * POINTS, (k + 1) * POINTS) for k in range(len(parts))]
    return [
        TablePiece(float(a), float(b), rows[:, cut] @ TO_COEFFICIENTS.T, float(np.max(ratios[cut])), at.poses, cut,
                   float(np.min(slowest[cut])))
        for (a, b), cut in zip(parts, cuts, strict=True)
    ]  # fmt: skip


def _places(values: Number, ends: tuple[float, float]) -> Number:
    """Return the places of values along the motion of a table."""
    places: Number = np.clip((values - ends[0]) / (ends[1] - ends[0]), 0.0, 1.0) * (POSES - 1)
    return places


def drive_terms(motion: Motion, loads: Sequence[Sequence[Load]]) -> Number:
    """Return inertia, bias, stored forces and others at all poses of a motion at unit speed."""
    mechanism = motion.mechanism
    factor, fall = mechanism.stated_units.inertia, complex(first_entry(mechanism.free_fall))
    rows = np.zeros((4, motion.failed.shape[1]))
    for own in mass_motions(motion):
        rows[0] += np.ravel(own.product(1, own, 1)) * factor
        rows[1] += np.ravel(own.product(1, own, 2)) * factor
        rows[2] += np.ravel((np.conj(fall) * own.centre[1]).real * own.mass) * factor
    for loaded in loaded_blocks(motion):
        for row, some in zip(rows[2:], loads, strict=True):
            for load in some:
                for link, wrench in load.wrenches(loaded):
                    row[loaded.poses] += np.ravel(loaded.freed(link, wrench).power(loaded.pose(link)))
    return rows


def _ratios(motion: Motion, pairs: Sequence[Pair]) -> Number:
    """Return the greatest scaled speed of the pairs."""
    found = np.zeros(motion.failed.shape[1])
    for pair in pairs:
        scale = 1.0 if pair.free_is_angle else motion.size
        found = np.fmax(found, np.abs(np.ravel(motion.pairs[pair.name].rate)) / scale)
    return found


_ANGLES = (np.arange(POINTS) + 0.5) * np.pi / POINTS
NODES = np.cos(_ANGLES)
TO_COEFFICIENTS = np.cos(np.outer(np.arange(POINTS), _ANGLES)) * (2.0 / POINTS)
TO_COEFFICIENTS[0] /= 2.0
_DEGREES = np.arange(POINTS)
# A piece has so many cells, each a polynomial through so many points: polynomials that hold in a piece have singular
# points at a half of it or more, and errors there fall by the width of a cell over four times that.
CELLS, CELL_POINTS = 64, 8
_CELL_NODES = np.cos((np.arange(CELL_POINTS) + 0.5) * np.pi / CELL_POINTS)
CELL_BASES = np.polynomial.chebyshev.chebvander(
    np.ravel((2.0 * np.arange(CELLS)[:, None] + 1.0 + _CELL_NODES) / CELLS - 1.0), POINTS - 1
).T
# To the coefficients of powers, the highest first.
TO_POWERS = np.linalg.inv(np.vander(_CELL_NODES))


@dataclass(eq=False)
class TablePiece:
    """A piece of a table: polynomials of inertia, bias, stored and other forces, and the poses at its points."""

    low: float
    high: float
    terms: Number  # (rows, POINTS)
    ratio: float  # the greatest scaled speed of a pair
    nodes: Mapping[str, Pose]
    place: slice
    least: float = 0.0  # the least of these at its points, infinite where nothing is assembled: no use to halve it
    known: dict[str, Number] = field(default_factory=dict)
    pairs: dict[str, Number] = field(default_factory=dict)

    def basis(self, value: float) -> Number:
        """Return Chebyshev's polynomials at a value."""
        x = (2.0 * value - self.low - self.high) / (self.high - self.low)
        found: Number = np.cos(_DEGREES * np.arccos(min(1.0, max(-1.0, x))))
        return found

    def pose(self, link: str, basis: Number, speed: float) -> Pose:
        """Return the pose of a link. Its rates are those at unit rate and at a speed."""
        if self.nodes[link] is FIXED:
            return FIXED
        z, moved, u, turned = self.of(link) @ basis
        pace = np.array([1.0, speed])
        return Pose(Series((complex(z), moved * pace)), Series((complex(u), turned * pace)))

    def of(self, link: str) -> Number:
        """Return the polynomials of a link's origin and orientation, each with its rate."""
        if link not in self.known:
            self.known[link] = self.polynomials(link)
        return self.known[link]

    @cached_property
    def pace(self) -> float:
        """The number of cells in a unit of the driver."""
        return CELLS / (self.high - self.low)

    @cached_property
    def cells(self) -> list[list[list[float]]]:
        """The polynomials in each of equal parts, in powers of a place from -1 to 1, the highest first.

        They are those of forces and bias over the inertia, of one over it and of the forces without a potential.
        """
        inertia, bias, stored, other = self.terms[:4] @ CELL_BASES
        rows = np.array([(stored + other) / inertia, bias / inertia, 1.0 / inertia, other])
        powers = rows.reshape(4, CELLS, CELL_POINTS) @ TO_POWERS.T
        found: list[list[list[float]]] = powers.transpose(1, 0, 2).reshape(CELLS, 2, 2 * CELL_POINTS).tolist()
        return found

    def coordinate(self, pair: Pair, ends: Ends) -> Number:
        """Return the polynomials of a pair's coordinate, its rate and its acceleration at unit rate; angles go on."""
        if pair.name not in self.pairs:
            poses = tuple(self.nodes[link] for link in pair.members)
            found = pair.coordinate(ends, poses)
            rows = np.array([self._row(Series((found.derivative(k),)), 0) for k in range(3)])
            if pair.free_is_angle:
                rows[0] = np.unwrap(rows[0])
            self.pairs[pair.name] = rows @ TO_COEFFICIENTS.T
        return self.pairs[pair.name]

    def polynomials(self, link: str) -> Number:
        """Make these polynomials."""
        pose = self.nodes[link]
        rows = [self._row(series, k) for series in (pose.z, pose.u) for k in (0, 1)]
        return np.array(rows) @ TO_COEFFICIENTS.T

    def _row(self, series: Series, k: int) -> Number:
        value = series.c[k] if k < len(series.c) else 0.0
        row = np.ravel(value)
        return np.broadcast_to(row, POINTS) if row.size == 1 else row[self.place]


# A bridge is fitted to so many widths of the gap on both sides, with a polynomial of this degree.
BESIDE, DEGREE = 1.9, 12
# Bridged gaps are at most this part of the table; below this part of a piece they are rounding.
WIDEST, NO_GAP = 1.0 / 200.0, 1e-9
# The polynomial fits the neighbouring pieces within this part of the largest value.
FITS = 1e-9


class BridgePiece(TablePiece):
    """A piece that continues its neighbours."""

    beside: Sequence[tuple[TablePiece, float]]  # neighbouring pieces with places there

    def polynomials(self, link: str) -> Number:
        """Make the polynomials of a link's origin and orientation, each with its rate."""
        return self.through(lambda piece: piece.of(link))[0]

    def through(self, polynomials: Callable[[TablePiece], Number]) -> tuple[Number, float]:
        """Return polynomials fitted to the neighbouring pieces, and the error of the fit."""
        places = np.array([place for _, place in self.beside])
        values = np.array([polynomials(piece) @ piece.basis(place) for piece, place in self.beside])
        middle, reach = (self.low + self.high) / 2.0, (BESIDE + 0.5) * (self.high - self.low)
        rows = np.polynomial.chebyshev.chebvander((places - middle) / reach, DEGREE)
        fitted = np.linalg.lstsq(rows, values, rcond=None)[0]
        inside = np.polynomial.chebyshev.chebvander(NODES / (2.0 * BESIDE + 1.0), DEGREE)
        return (inside @ fitted).T @ TO_COEFFICIENTS.T, float(np.max(np.abs(rows @ fitted - values)))


def with_bridges(pieces: Sequence[TablePiece], width: float) -> list[TablePiece]:
    """Return pieces in order, with bridges over narrow gaps."""
    starts, found = [piece.low for piece in pieces], list(pieces[:1])
    for left, right in pairwise(pieces):
        gap = right.low - left.high
        is_narrow = NO_GAP * (left.high - left.low) < gap <= WIDEST * width
        bridge = _bridge(pieces, starts, left, right) if is_narrow else None
        found += [right] if bridge is None else [bridge, right]
    return found


def _bridge(
    pieces: Sequence[TablePiece], starts: Sequence[float], left: TablePiece, right: TablePiece
) -> BridgePiece | None:
    """Return the piece between two others, None where no polynomial continues both."""
    made = BridgePiece(left.high, right.low, left.terms, max(left.ratio, right.ratio), left.nodes, left.place)
    spread = (NODES[:: POINTS // DEGREE] + 1.0) / 2.0 * BESIDE * (made.high - made.low)
    places = np.concatenate([made.low - spread, made.high + spread]).tolist()
    known = [(pieces[max(bisect_right(starts, place) - 1, 0)], place) for place in places]
    if not all(piece.low <= place <= piece.high for piece, place in known):
        return None
    made.beside = known
    made.terms, off = made.through(lambda piece: piece.terms)
    return made if off <= FITS * float(np.max(np.abs(left.terms))) else None
