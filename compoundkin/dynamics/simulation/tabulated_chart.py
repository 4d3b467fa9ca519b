"""One free driver in a table of its coordinate: the equation of motion as Chebyshev polynomials, piece by piece.

With one degree of freedom everything but time and speed is a function of the coordinate. It is solved once at Chebyshev
points of pieces that are halved until the polynomials hold to rounding. Places where too many digits are lost, such as
change points, are bridged smoothly.

Source: L. N. Trefethen, Approximation Theory and Approximation Practice, SIAM 2013, chapters 3 and 4.
"""

from __future__ import annotations

import warnings
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import pairwise
from typing import Any, NamedTuple, TypeGuard

import numpy as np

from compoundkin.base.arrays import TURN, Number, first_entry, whole_turns
from compoundkin.base.errors import CompoundkinError
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series
from compoundkin.dynamics.loaded_block import LoadedBlock, loaded_blocks
from compoundkin.dynamics.mass_motion import InertiaTerms, mass_motions
from compoundkin.dynamics.simulation.dormand_prince import PlainRates
from compoundkin.dynamics.simulation.driver_chart import DriverChart
from compoundkin.dynamics.simulation.driver_state import (
    TURNS_OF_SENSES,
    DriverState,
    KnownCoordinate,
    LoadedState,
    PushedState,
    Rates,
    loaded_state,
    needs_time,
    rotor_forces,
    rotors_that_lose,
)
from compoundkin.dynamics.simulation.load_breaks import LoadBreak, LoadPlace, joined, load_places
from compoundkin.kinematics import solve
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.configuration import Configuration, dimensions_at, placed_at
from compoundkin.kinematics.extremes import between
from compoundkin.kinematics.motion import Motion
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads.attachments import PairLoad, PlainEffort
from compoundkin.model.loads.contract import Load
from compoundkin.model.loads.motor import Motor, PlainRotor
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends

# A pair that moves so many times as fast as a driver, by their scales, is the better coordinate: the equation of motion
# has squares of this ratio and loses twice as many digits.
FASTER = 30.0
# Poses a full turn apart agree within this part of the size.
SAME = 1e-9
# The reach of a table to both sides: half a turn, or this part of the size.
REACH = 0.5


class TabulatedChart(DriverChart):
    """The chart of one free driver. Where its table is not accurate, states are solved."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.is_angle = self.start.structure.driven_angles[self.free[0]]
        self.reach = TURN / 2.0 if self.is_angle else REACH * self.order.size
        self.timeless = tuple(tuple(load for load in loads if self._is_timeless(load)) for loads in self.loads)
        self.others = tuple(tuple(load for load in loads if load not in known)
                            for loads, known in zip(self.loads, self.timeless, strict=True))  # fmt: skip
        self.table: DriveTable | None = None
        self.wraps = False
        self.contact_forces: tuple[DriveTable, Any] | None = None  # by the table for which they are made
        self._straight: dict[int, tuple[float, float]] = {}
        self.followed = -np.inf  # where the states of groups without signs are those
        first = {name: float(np.ravel(v[0])[0]) for name, v in self.start.inputs.drives.items()}[self.free[0]]
        self._tabulate(first, self.start.poses)

    def _is_timeless(self, load: Load) -> bool:
        """Whether a load depends on the pose alone, not on how many turns were made."""
        if load.needs_rates or needs_time(self.start, load):
            return False
        block = next(iter(loaded_blocks(self.start)))
        amounts = load.amounts_held
        comes_again = bool(amounts) and all(map(_comes_again, amounts))
        return comes_again or not counted_angles(load, block)

    def rates(self, time: float, values: Number, speeds: Number) -> Rates:
        """Return the rates of a state."""
        value, speed = float(values[0]), float(speeds[0])
        piece, value = self._piece(value)
        if piece is None:
            return super().rates(time, values, speeds)
        basis = piece.basis(value)
        inertia, bias, stored, other = (piece.terms[:4] @ basis).tolist()
        if self.has_others:
            at = self.loaded_at(piece, basis, time, values, speed)
            more = [float(at.along(loads)[0]) if loads else 0.0 for loads in self.others]
            stored, other = stored + more[0], other + more[1]
            if motors := self.rotors_that_lose:
                dry = np.array([(stored + other - bias * speed * speed) / inertia])
                other += float(rotor_forces(at, motors, dry, lambda along: along / inertia)[0])
        return Rates(np.array([(stored + other - bias * speed * speed) / inertia]), other * speed)

    def plain_rates(self) -> PlainRates:
        """Return the acceleration and the power as a function of plain numbers, until contacts change."""

        def asked(time: float, value: float, speed: float) -> tuple[float, float]:
            found = self.followed_rates(time, np.array([value]), np.array([speed]))
            return float(found.accelerations[0]), float(found.power)

        if type(self) is not TabulatedChart or self.held is not None or self._added:
            return asked
        efforts, rotors = self.plain_efforts, self.plain_rotors
        if efforts is None or rotors is None:
            return asked

        table, piece = self.table, None
        idle = not efforts and not rotors and not self.timeless[1]

        def known(time: float, value: float, speed: float) -> tuple[float, float]:
            nonlocal table, piece
            if table is not self.table:
                table, piece = self.table, None
            if table is None:
                return asked(time, value, speed)
            inside = table.low + (value - table.low) % TURN if self.wraps else value
            if piece is None or not piece.low <= inside <= piece.high:
                piece = table.piece(inside)
                if piece is None:
                    return asked(time, value, speed)
            x = (inside - piece.low) * piece.pace
            k = min(int(x), CELLS - 1)
            place, cell = 2.0 * (x - k) - 1.0, piece.cells[k]
            pushed, bias = _both(cell[0], place)
            if idle:
                return pushed - bias * speed * speed, 0.0
            mobility, other = _both(cell[1], place)
            for push, sign in efforts:
                more = sign * push(sign * value, sign * speed, time)
                pushed, other = pushed + more * mobility, other + more
            if rotors:
                given = [(rotor, sign, rotor.torque(sign * value, sign * speed, time)) for rotor, sign in rotors]
                return _with_rotors(given, pushed - bias * speed * speed, mobility, other, speed)
            return pushed - bias * speed * speed, other * speed

        return known

    @property
    def longest_moves(self) -> Number:
        """The longest move of the driver in a step."""
        return self.scales if self.is_angle else np.array([max(float(self.scales[0]), self.reach)])

    @cached_property
    def plain_efforts(self) -> tuple[tuple[PlainEffort, float], ...] | None:
        """The loads that depend on time or speed as functions of plain numbers; None where one is no such function."""
        stored, others = self.others
        if stored:
            return None
        found = []
        for load in others:
            if load in self.rotors_that_lose:
                continue
            plain = load.plain_effort() if isinstance(load, PairLoad) else None
            sense = self._own_sense(load)
            if plain is None or sense is None:
                return None
            found.append((plain, sense))
        return tuple(found)

    @cached_property
    def plain_rotors(self) -> tuple[tuple[PlainRotor, float], ...] | None:
        """The motors whose effort depends on the acceleration, in plain numbers; None where one is not known so."""
        found = []
        for motor in self.rotors_that_lose:
            plain, sense = motor.plain_rotor(self.mechanism.stated_units.inertia), self._own_sense(motor)
            if plain is None or sense is None:
                return None
            found.append((plain, sense))
        return tuple(found)

    def _own_sense(self, load: Load) -> float | None:
        """Return the sense of a load's coordinate by the driver's, None where it is another one."""
        own = self.start.structure.driven[self.free[0]]
        meant = self.order.pair_meant(load.pair) if isinstance(load, PairLoad) else None
        return (
            None if meant is None or meant[0].name != own.pair.name else meant[1] * own.pair.driven_by(own.drive.link)
        )

    @cached_property
    def rotors_that_lose(self) -> tuple[Motor, ...]:
        """The motors whose effort depends on the acceleration, which the table does not have."""
        return rotors_that_lose(self.loads[1])

    @cached_property
    def has_others(self) -> bool:
        """Whether some loads depend on time or speed."""
        return any(self.others)

    def loaded_at(self, piece: TablePiece, basis: Number, time: float, values: Number, speed: float) -> LoadedState:
        """Return a state of a piece as loads see it. Rates of its columns are those at unit rate, and the true ones."""
        columns = _Columns(piece, basis, speed)
        block = Block((2, 1), self.ends, columns, {}, 1)
        at = loaded_state(self.start, block, time, 1, lambda pair, angle: self.turns_of(pair, angle, values))
        known = self._driven(float(values[0]), speed)
        for pair in () if isinstance(piece, BridgePiece) else self.loaded_pairs:
            free, rate, second = (piece.coordinate(pair, self.ends[pair.name]) @ basis).tolist()
            value = self.turns_of(pair.name, free, values) if pair.free_is_angle else free
            known[pair.name] = KnownCoordinate(value, rate * speed, np.array([rate]), second * speed * speed)
        return replace(at, driven=known)

    @cached_property
    def pushing(self) -> tuple[str, ...]:
        """The names of the pairs along which loads act that depend on time or speed."""
        named = (load.pair for loads in self.others for load in loads if self._is_along(load))
        return tuple(dict.fromkeys(named))

    def _is_along(self, load: Load) -> TypeGuard[PairLoad]:
        """Whether a load is known by its effort along a pair, whatever links turn freely."""
        return isinstance(load, PairLoad) and not self.start.structure.passive

    @cached_property
    def touched(self) -> tuple[str, ...]:
        """The links on which other loads act that depend on time or speed."""
        value = [float(np.ravel(v[0])[0]) for name, v in self.start.inputs.drives.items() if name in self.free]
        return self._touched_by(self.state(0.0, np.array(value), np.zeros(1)).loaded)

    def _touched_by(self, at: LoadedState) -> tuple[str, ...]:
        """Return them at a state."""
        loads = (load for loads in self.others for load in loads if not self._is_along(load))
        return tuple(dict.fromkeys(link for load in loads for link, _ in load.wrenches(at) if link != FRAME))

    def wrenches_of_others(self, at: LoadedState, touched: tuple[str, ...]) -> Number | None:
        """Return the forces of loads that depend on time or speed, and how they act on links and along pairs.

        That is their forces along x and y and moments by the links they touch, then their efforts by pairs.
        """
        first = 2 + 3 * len(touched)
        found = np.zeros(first + len(self.pushing))
        for k, loads in enumerate(self.others):
            for load in loads:
                if self._is_along(load):
                    effort = float(np.ravel(load.effort(at))[0])
                    found[k] += effort * at.rates_of(load.pair)[0][0]
                    found[first + self.pushing.index(load.pair)] += effort
                    continue
                for link, wrench in load.wrenches(at):
                    if link == FRAME:
                        continue
                    if link not in touched:
                        return None
                    assert at.columns is not None
                    found[k] += np.ravel(at.freed(link, wrench).power(at.columns[link]))[0]
                    force, moment = complex(np.ravel(wrench.force)[0]), float(np.ravel(wrench.moment)[0])
                    own = 2 + 3 * touched.index(link)
                    found[own : own + 3] += force.real, force.imag, moment
        return found

    @cached_property
    def loaded_pairs(self) -> tuple[Pair, ...]:
        """The pairs but the driver's along whose coordinates loads, stops and latches act."""
        named = (load.pair for load in self.mechanism.loads.values() if isinstance(load, PairLoad))
        meant = (self.order.pair_meant(name) for name in named)
        found = {one[0].name: one[0] for one in meant if one is not None}
        return tuple(pair for name, pair in found.items() if name in self.ends and name not in self.driven)

    def seen(self, time: float, values: Number, speeds: Number) -> PushedState:
        """Return a state as contacts see it, from the table where that has it."""
        piece, value = self._piece(float(values[0]))
        if piece is None or self.laws:
            return super().seen(time, values, speeds)
        basis = piece.basis(value)
        loaded = self.loaded_at(piece, basis, time, values, float(speeds[0]))
        return TableState(loaded, speeds, *(piece.terms[:2] @ basis).tolist())

    def _driven(self, value: float, speed: float) -> dict[str, KnownCoordinate]:
        """Return the coordinate of the driver's pair."""
        own = self.start.structure.driven[self.free[0]]
        sign = own.pair.driven_by(own.drive.link)
        return {own.pair.name: KnownCoordinate(sign * value, sign * speed, np.array([float(sign)]))}

    def state(self, time: float, values: Number, speeds: Number) -> DriverState:
        """Return the state at a value and a speed of the driver."""
        self._follow_table(float(values[0]))
        return super().state(time, values, speeds)

    def _follow_table(self, value: float) -> None:
        """Take the states of groups without signs from the table: in a table they are not followed.

        In its gaps and beyond its ends they are those of the nearest place of the table, or of the last state.
        """
        if not self.states or self.table is None:
            return
        piece, inside = self._piece(value)
        if piece is None:
            nearest = min(((abs(end - inside), end, one) for one in self.table.pieces for end in (one.low, one.high)),
                          default=None, key=lambda found: found[0])  # fmt: skip
            if nearest is None or abs(value - self.followed) <= nearest[0]:
                return
            _, inside, piece = nearest
        self.followed = value + inside - self.tabulated(value)
        world = _Columns(piece, piece.basis(inside), 0.0)
        for link, near in self.near.items():
            # the table has the angles of links without their turns
            pose = world[link]
            angle = float(np.ravel(pose.angle.c[0])[0])
            counted = angle + float(whole_turns(near.at(np.array([value])) - angle))
            world[link] = Pose(pose.z, pose.u, Series((counted,)))
        self._store_states(world)

    @property
    def memory(self) -> tuple[Any, ...]:
        """The configuration, with the table."""
        return (*super().memory, self.table, self.wraps)

    def recall(self, memory: tuple[Any, ...]) -> None:
        """Restore a configuration."""
        super().recall(memory)
        self.table, self.wraps = memory[4:]

    def accept(self, time: float, values: Number, speeds: Number) -> None:
        """Update the configuration at an accepted state."""
        value = float(values[0])
        table = self.table
        if self.turned or self.order.turning or table is None or self._piece(value)[0] is None:
            # counted angles are followed in the table as well, for states beyond it
            super().accept(time, values, speeds)
            self.followed = value
        if table is not None and not self.wraps and not table.low < value < table.high:
            if not self.is_angle and len(table.pieces) == PIECES:
                # the mechanism is small against the way that it goes, as one of a letter for each link
                self.reach *= 2.0
            self._tabulate(value, self.state(time, values, speeds).block.world)

    def sign(self, k: int, values: Number) -> float:
        """Return the sign of a dyad's mode, which changes where the motion of the table passes a change point."""
        table = self.table
        if table is None or k not in table.motion.change_points:
            return super().sign(k, values)
        return table.sign(k, self.tabulated(float(values[0])))

    def is_regular(self, values: Number) -> bool:
        """Return whether no pair moves much faster than the driver."""
        piece, _ = self._piece(float(values[0]))
        return piece is not None and piece.ratio < FASTER

    def _piece(self, value: float) -> tuple[TablePiece | None, float]:
        table = self.table
        if table is None:
            return None, value
        value = self.tabulated(value)
        return table.piece(value), value

    def tabulated(self, value: float) -> float:
        """Return a value in the turn that the table has, where it is the same in all."""
        return value if self.table is None or not self.wraps else self.table.low + (value - self.table.low) % TURN

    def _tabulate(self, value: float, poses: Mapping[str, Pose]) -> None:
        """Make the table around a pose."""
        structure, name = self.start.structure, self.free[0]
        here = Configuration(structure, {name: value}, placed_at(poses, (0, 0)), {}, {},
                             dimensions_at(structure, 0, 0))  # fmt: skip
        ends = value - self.reach, value + self.reach
        self.table = drive_table(here, name, *ends, self.timeless, self.candidates)
        self.wraps = self.table is not None and self.is_angle and not self.order.turning and self._comes_back()

    def is_in_gap(self, value: float) -> bool:
        """Return whether a value is between pieces of the table."""
        return self.table is not None and self._piece(value)[0] is None

    def breaks(self, low: float, high: float) -> list[LoadBreak]:
        """Return where the loads of the table jump, wake or have corners, between two values in neighbouring turns."""
        table = self.table
        if table is None:
            return []
        turns = [self._turned_by(value) for value in (low, high)] if self.wraps else [0.0]
        near = max(abs(table.low), abs(table.high))
        moved = (own.moved(turn, near) for turn in sorted({*turns}) for own in table.breaks)
        return [one for one in moved if low <= one.behind and one.before <= high]

    def _turned_by(self, value: float) -> float:
        """Return the turns between a value and where the table has it."""
        assert self.table is not None
        return TURN * float(np.floor((value - self.table.low) / TURN))

    def has_in_table(self, load: Load, values: Number) -> bool:
        """Return whether the table has a load at values of the driver."""
        table = self.table
        if table is None or load not in (*self.timeless[0], *self.timeless[1]):
            return False
        return self.wraps or bool(table.low <= min(values) and max(values) <= table.high)

    def straight(self, place: LoadPlace) -> tuple[float, float]:
        """Return the slope of a load's coordinate by the driver, zero where it is another one, and its offset."""
        known = self._straight.get(id(place))
        if known is None:
            own = self.start.structure.driven[self.free[0]]
            meant = self.order.pair_meant(place.pair) if place.pair else None
            known = 0.0, 0.0
            if meant is not None and meant[0].name == own.pair.name:
                first = np.array([float(np.ravel(self.start.inputs.drives[self.free[0]][0])[0])])
                slope = float(meant[1] * own.pair.driven_by(own.drive.link))
                begun = place.value(self.seen(0.0, first, np.zeros(1)).loaded)
                known = slope, float(np.ravel(begun)[0]) - slope * float(first[0])
            self._straight[id(place)] = known
        return known

    def _comes_back(self) -> bool:
        """Whether all poses are the same after a whole turn."""
        assert self.table is not None
        motion = self.table.motion
        if motion.failed.any():
            return False
        for pose in motion.poses.values():
            for series, scale in ((pose.z, motion.size), (pose.u, 1.0)):
                row = np.ravel(series.c[0])
                if not abs(row[-1] - row[0]) < SAME * scale:
                    return False
        return True


def _with_rotors(
    motors: Sequence[tuple[PlainRotor, float, float]], dry: float, mobility: float, other: float, speed: float
) -> tuple[float, float]:
    """Return the acceleration and the power with motors, each with its sense and its torque, from those without them.

    What a rotor leaves of its torque goes through its gear, with a loss either way. The sense in which power goes
    through each is that of the acceleration that follows, which is the only one: the sum falls as that grows.
    """
    through = [rotor.efficiency for rotor, _, _ in motors]
    a = dry
    for _ in range(TURNS_OF_SENSES):
        push = mass = 0.0
        for (rotor, sign, torque), part in zip(motors, through, strict=True):
            push += sign * rotor.gear * part * torque
            mass += rotor.gear * rotor.inertia * (1.0 - part)
        a = (dry + mobility * push) / (1.0 - mobility * mass)
        now = [rotor.part(torque - rotor.inertia * sign * a, sign * speed) for rotor, sign, torque in motors]
        if now == through:
            break
        through = now
    return a, (other + push + mass * a) * speed


# A period is a part of a turn but for rounding of the degrees it was written in.
PART_OF_A_TURN = 1e-9


def _comes_again(amount: Any) -> bool:
    """Return whether an amount is a table that repeats after a turn at the latest."""
    period = getattr(amount, "period", None)
    return period is not None and abs(TURN / period - round(TURN / period)) < PART_OF_A_TURN


def counted_angles(load: Load, block: LoadedBlock) -> set[str]:
    """Return the pairs whose angles, counted along the motion, a load depends on."""
    unknown = _UnknownAngles()
    list(load.wrenches(replace(block, counted=unknown)))
    return set(unknown)


class _UnknownAngles(dict[str, Number]):
    """Angles of pairs, of which none is known: those that are used are added."""

    def __contains__(self, name: object) -> bool:
        return True

    def __missing__(self, name: str) -> Number:
        self[name] = np.full((1, 1), np.nan)
        return self[name]


class TableState(NamedTuple):
    """A state in a table as contacts see it."""

    loaded: LoadedState
    speeds: Number
    inertia: float
    bias: float

    @property
    def prescribed(self) -> Number:
        """Nothing: the only driver is free."""
        return np.empty(0)

    @property
    def terms(self) -> InertiaTerms:
        """The inertia and the bias; weights are among the loads of the table."""
        return InertiaTerms(np.array([[self.inertia]]), self.bias * np.square(self.speeds), np.zeros(1))

    def response(self, along: Number) -> Number:
        """Return the acceleration by a force along the driver alone."""
        return along / self.inertia


class _Columns(dict[str, Pose]):
    """The poses of a piece at a value, made on access."""

    def __init__(self, piece: TablePiece, basis: Number, speed: float) -> None:
        super().__init__()
        self.piece, self.basis, self.speed = piece, basis, speed

    def __missing__(self, link: str) -> Pose:
        found = self[link] = self.piece.pose(link, self.basis, self.speed)
        return found


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


def _both(row: Sequence[float], s: float) -> tuple[float, float]:
    """Return two polynomials of a cell at a place in it."""
    a7, a6, a5, a4, a3, a2, a1, a0, b7, b6, b5, b4, b3, b2, b1, b0 = row
    return (
        ((((((a7 * s + a6) * s + a5) * s + a4) * s + a3) * s + a2) * s + a1) * s + a0,
        ((((((b7 * s + b6) * s + b5) * s + b4) * s + b3) * s + b2) * s + b1) * s + b0,
    )


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
