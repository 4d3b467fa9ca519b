"""One free driver whose equation of motion is read from a table of its coordinate."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, NamedTuple, TypeGuard

import numpy as np

from compoundkin.base.arrays import TURN, Number, whole_turns
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series
from compoundkin.dynamics.friction.friction_contacts import LoadedContact
from compoundkin.dynamics.loaded_block import LoadedBlock, loaded_blocks
from compoundkin.dynamics.mass_motion import InertiaTerms
from compoundkin.dynamics.simulation.dormand_prince import PlainRates
from compoundkin.dynamics.simulation.drive_table import (
    CELLS,
    FASTER,
    PIECES,
    BridgePiece,
    DriveTable,
    TablePiece,
    drive_table,
)
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
from compoundkin.dynamics.simulation.load_breaks import LoadBreak, LoadPlace
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.configuration import Configuration, dimensions_at, placed_at
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads.attachments import PairLoad, PlainEffort
from compoundkin.model.loads.contract import Load
from compoundkin.model.loads.motor import Motor, PlainRotor
from compoundkin.model.pairs import Pair

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
        return asked if efforts is None or rotors is None else self._table_rates(efforts, rotors, asked)

    def _table_rates(
        self,
        efforts: Sequence[tuple[PlainEffort, float]],
        rotors: Sequence[tuple[PlainRotor, float]],
        asked: PlainRates,
    ) -> PlainRates:
        """Return these by the cells of the table, with the efforts of loads along the driver; beyond it as `asked`."""
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
    def contacts(self) -> tuple[LoadedContact, ...]:
        """The pairs with friction: none."""
        return ()

    def acceleration_and_frictions(self, time: float, values: Number, speeds: Number) -> tuple[float, Number]:
        """Return the acceleration of the driver, and the frictions as far as they are known."""
        found = self.followed_rates(time, values, speeds)
        return float(found.accelerations[0]), np.zeros(len(self.contacts))

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


def _both(row: Sequence[float], s: float) -> tuple[float, float]:
    """Return two polynomials of a cell at a place in it."""
    a7, a6, a5, a4, a3, a2, a1, a0, b7, b6, b5, b4, b3, b2, b1, b0 = row
    return (
        ((((((a7 * s + a6) * s + a5) * s + a4) * s + a3) * s + a2) * s + a1) * s + a0,
        ((((((b7 * s + b6) * s + b5) * s + b4) * s + b3) * s + b2) * s + b1) * s + b0,
    )
