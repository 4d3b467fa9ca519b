"""Intermittent motion: a pin enters a slot, turns its wheel, leaves it, and the wheel stands still until the next.

Each engagement and each dwell is a phase with a mechanism of its own. In a dwell the slot is no pair, and what carries
it is held where it is; the next slot is the same one, where the wheel has turned on.

Source: J. H. Bickford, Mechanisms for Intermittent Motion, Industrial Press 1972, chapter 9.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked, real_numbers
from compoundkin.base.arrays import TURN, Number, whole_turns
from compoundkin.base.display import ShortRepr, count_phrase
from compoundkin.base.errors import DrawnBeyondEnd, InvalidInput, Problem, UnassembledPoses
from compoundkin.base.linear import one_thread
from compoundkin.base.poses import Pose
from compoundkin.dynamics.simulation.phases import opened_items, with_items
from compoundkin.kinematics import solve
from compoundkin.kinematics.configuration import Configuration, dimensions_at, placed_at
from compoundkin.kinematics.gaps import gaps
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import Table, has_quantity, quantity, tables_in_a_row
from compoundkin.model.attributes import OF_LINKS, OF_POINTS, RADIANS
from compoundkin.model.elements import Drawn, Drive, Expectation, Link, Mode
from compoundkin.model.fields import Item
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.contract import as_drivable
from compoundkin.model.pairs.slot import letter_in_slot, slot_elsewhere, slot_with_ends
from compoundkin.model.pairs.travel_limits import TravelLimited
from compoundkin.structure import decompose

# A turn of the driver is looked at in so many steps for the ends of the slot.
STEPS = 720
# A wheel turns on by whole pitches but for this angle, radians: far above rounding, far below what could be meant.
SAME_PITCH = 1e-6
# Poses without values are so many parts of a turn of the driver.
PARTS = 360
# What changes by less than this part of its greatest size in all phases does not jump.
NO_JUMP = 1e-9
ENTERS, LEAVES = "enters", "leaves"


@dataclass(frozen=True, eq=False, repr=False)
class MotionPhase(ShortRepr):
    """A part of an intermittent motion: the driver's first and last value, whether it is engaged, and the motion."""

    first: float
    last: float
    engaged: bool
    motion: Motion


@dataclass(frozen=True, eq=False, repr=False)
class MotionJump(ShortRepr):
    """A quantity that jumps where the pin `enters` or `leaves`: the driver's value there, and both of its values."""

    at: float
    what: str
    quantity: str
    unit: str
    before: complex
    after: complex


@dataclass(frozen=True, eq=False)
class IntermittentMotion:
    """A motion in phases, engaged or at rest. The first and the last pose of each are those where the pin is at an end.

    `engaged` is from where to where the pin of `pair` is in its slot, the driver's values in the first turn; `held` is
    the link that stands still else, `step` the angle by which it turns each time, and `slots` how many there are, 0 of
    a slot that does not turn.
    """

    phases: tuple[MotionPhase, ...]
    pair: str
    held: str
    engaged: tuple[float, float]
    step: float
    slots: int

    def table(self, *names: str) -> Table:
        """Return the quantities of these names as columns, with the number of the phase; angles go on through all.

        What a phase does not have is NaN there. Raises UnknownName for a quantity that none has.
        """
        motions = [phase.motion for phase in self.phases]
        for name in names:
            if not any(has_quantity(motion, name) for motion in motions):
                quantity(motions[0], name)  # says what is wrong with it
        tables = [motion.table(*(name for name in names if has_quantity(motion, name))) if names else motion.table()
                  for motion in motions]  # fmt: skip
        whole = tables_in_a_row(motions[0].mechanism.title, tables)
        lengths = np.cumsum([0, *map(len, tables)])
        return replace(whole, columns=tuple(
            replace(one, values=_going_on(one.values, lengths)) if one.unit == RADIANS else one
            for one in whole.columns))  # fmt: skip

    @cached_property
    def jumps(self) -> tuple[MotionJump, ...]:
        """Velocities and accelerations of links and points that jump from one phase to the next."""
        sizes = _rates_of([phase.motion for phase in self.phases])
        return tuple(one for before, after in pairwise(self.phases) for one in _jumps(before, after, sizes))

    def __repr__(self) -> str:
        title, low, high = self.phases[0].motion.mechanism.title, *np.degrees(self.engaged)
        phases = count_phrase(len(self.phases), "phase")
        return f"IntermittentMotion({title!r}: engaged from {low:.6g} to {high:.6g}°, {phases})"


@checked
@one_thread
def intermittent_motion(
    mechanism: Mechanism,
    values: Any = None,
    *,
    pair: str = "",
    slots: int = 0,
    speed: float | None = None,
    acceleration: float | None = None,
    order: int = 2,
) -> IntermittentMotion:
    """Return the motion of a mechanism whose pin comes into a slot once in a turn of its driver, through its dwells.

    The slot is the only one with a `reach`, else that of the `pair`; its two ends are where the pin enters and leaves.
    In between its link is held. `values` are those of the driver (radians, over any number of turns and back), a turn
    from the first entry where they are left out. The wheel has as many `slots` as its steps fill a turn with, unless
    another number is given.

    Raises InvalidInput for a mechanism without such a slot or with several drivers, for a pin that never leaves or
    comes several times in a turn, and for slots that are not where the pin enters.

    >>> from compoundkin.files import load
    >>> found = intermittent_motion(load("geneva-wheel"), np.deg2rad([0, 90, 360, 450]))
    >>> found, found.slots
    (IntermittentMotion('Geneva wheel with four slots, while it moves': engaged from -45 to 45°, 4 phases), 4)
    >>> found.table("wheel.angle").shown["wheel.angle"].values.round(6).tolist()
    [0.0, -45.0, -45.0, -45.0, -45.0, -45.0, -90.0, -135.0, -135.0, -135.0]
    """
    engaged = _Engaged(mechanism, _slot_of(mechanism, pair))
    found = _Phases(engaged, slots)
    low, high = engaged.ends
    given = np.linspace(low, low + TURN, PARTS + 1) if values is None else real_numbers("values", values).reshape(-1)
    if not given.size or not np.isfinite(given).all():
        raise InvalidInput(Problem("values", "they are empty or not finite", "give the driver's angles, in radians"))
    runs = _runs(given, low, high)
    rates = {"speed": speed, "acceleration": acceleration}
    phases = tuple(found.phase(number, np.array(run), rates, order) for number, run in runs)
    return IntermittentMotion(phases, engaged.slot.name, found.drive.link, (low, high), found.step, found.slots)


def _slot_of(mechanism: Mechanism, name: str) -> TravelLimited:
    """Return the slot with ends of a mechanism."""
    if len(mechanism.drives) != 1:
        what = f"it has {count_phrase(len(mechanism.drives), 'driver')}"
        raise InvalidInput(Problem("drives", what, "an intermittent motion has one that turns"))
    able = {own.name: slot for own in mechanism.written_pairs if (slot := slot_with_ends(own)) is not None}
    if (name and name not in able) or len(able) != 1 > len(name):
        what = f"{name!r} is no slot with ends" if name else f"it has {count_phrase(len(able), 'slot')} with ends"
        remedy = f"name one: {', '.join(able)}" if able else 'write slot(..., reach=(25, "E"))'
        raise InvalidInput(Problem("pair", what, remedy))
    return able[name] if name else next(iter(able.values()))


class _Engaged:
    """The mechanism as written, over the turn of its driver in which it was drawn."""

    def __init__(self, mechanism: Mechanism, slot: TravelLimited) -> None:
        self.mechanism, self.slot = mechanism, slot
        self.driver = mechanism.drives[0].name
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UnassembledPoses)
            shown = solve(mechanism, order=1)
            if not shown.drives[self.driver].is_angle:
                what = f"its driver {self.driver} does not turn"
                raise InvalidInput(Problem("drives", what, "drive the link with the pin by its pivot"))
            middle = _middle(np.ravel(shown.drives[self.driver].value), np.ravel(shown.assembled))
            whole = solve(mechanism, {self.driver: np.linspace(middle, middle + TURN, STEPS + 1)}, order=1)
        found = gaps(whole)
        if len(found) != 1 or found[0].pair != slot.name:
            times = count_phrase(len(found), "gap")
            why = f": {found[0].reason}" if len(found) == 1 else ""
            what = f"in a turn of {self.driver} its motion has {times}{why}"
            raise InvalidInput(Problem("pair", what, f"the pin leaves {slot.name} once in a turn, and enters it again"))
        self.ends = self._end(float(found[0].end[self.driver]) - TURN), self._end(float(found[0].begin[self.driver]))

    def _end(self, near: float) -> float:
        """Return the driver's value where the pin is exactly at an end of the slot."""
        motion = self.at(near)
        guide = motion.pairs[self.slot.name]
        place, rate = float(np.ravel(guide.value)[0]), float(np.ravel(guide.rate)[0])
        speed = float(np.ravel(motion.drives[self.driver].rate)[0])
        bounds = [float(np.ravel(one)[0]) for one in self.slot.bounds(self.mechanism.geometry)]
        off = min((place - bound for bound in bounds), key=abs)
        if not (np.isfinite(rate) and np.isfinite(speed)) or rate == 0.0:
            what = f"at an end of {self.slot.name} the motion is singular"
            raise InvalidInput(Problem("pair", what, "let the slot end elsewhere"))
        return near - off / rate * speed

    def at(self, value: float) -> Motion:
        """Return the single pose of a value of the driver."""
        return solve(self.mechanism, {self.driver: [value]}, order=1)


def _middle(values: Number, assembled: Number) -> float:
    """Return the middle of the assembled values that go on to the least one."""
    parts = np.split(np.arange(len(values)), np.flatnonzero(np.diff(assembled.astype(int))) + 1)
    nearest = min((part for part in parts if assembled[part[0]]), key=lambda part: np.min(np.abs(values[part])))
    return float(np.mean(values[nearest[[0, -1]]]))


@dataclass(frozen=True)
class _Segment:
    """The mechanism between two ends of engagements, and its configuration at one of them."""

    mechanism: Mechanism
    begin: Configuration | None


class _Phases:
    """Engagements and dwells by number, even and odd ones; that of the drawing is 0. Each begins where another ends."""

    def __init__(self, engaged: _Engaged, slots: int) -> None:
        self.engaged, (self.low, self.high) = engaged, engaged.ends
        self.items = opened_items(engaged.mechanism, engaged.slot)
        self.drive = self._held()
        self.enters, self.leaves = (placed_at(engaged.at(value).poses, (0, 0)) for value in engaged.ends)
        self.segments = {0: _Segment(engaged.mechanism, None)}
        one, other = (poses[self.drive.link].u.c[0] for poses in (self.enters, self.leaves))
        self.step = self._turned(complex(one), complex(other))
        self.slots = self._slots(slots)

    def _turned(self, one: complex, other: complex) -> float:
        """Return the angle by which the wheel turns in an engagement, with its turns."""
        between = np.linspace(self.low, self.high, STEPS + 1)
        motion = solve(self.engaged.mechanism, {self.engaged.driver: between}, order=0)
        angle = np.unwrap(motion.links[self.drive.link].angle)
        rough, exact = float(angle[-1] - angle[0]), float(np.angle(other / one))
        return exact + float(whole_turns(rough - exact))

    def _slots(self, given: int) -> int:
        """Return the number of slots. Raises InvalidInput where none is where the pin enters."""
        if abs(self.step) < SAME_PITCH:
            return 0
        count = given or max(1, round(TURN / abs(self.step)))
        pitches = abs(self.step) * count / TURN
        if abs(pitches - round(pitches)) * TURN / count > SAME_PITCH:
            step = np.degrees(abs(self.step))
            what = f"{self.drive.link} turns by {step:.6g} degrees, {pitches:.6g} times the pitch of {count} slots"
            remedy = "let the pin enter and leave where a slot stands, or give the number of slots"
            raise InvalidInput(Problem("slots", what, remedy))
        return count

    def _held(self) -> Drive:
        """Return the driver that holds what the pin has left."""
        mechanism, slot = self.engaged.mechanism, self.engaged.slot
        structure = decompose(with_items(mechanism, self.items))
        driven = {own.pair.name for own in structure.driven.values()}
        pairs = [one for one in structure.pairs if as_drivable(one) is not None and one.name not in driven]
        for link in slot.members:
            for own in (one for one in pairs if link in one.members):
                other = next(name for name in own.members if name != link)
                drive = Drive(link if link != self.engaged.driver else f"{link} held", link, other, speed=0.0)
                if not decompose(with_items(mechanism, [*self.items, drive])).faults:
                    return drive
        what = f"nothing that a driver could hold carries {slot.name}"
        raise InvalidInput(Problem("pair", what, "pin the wheel to another link"))

    def border(self, number: int, side: int) -> float:
        """Return the driver's value at the beginning (side 0) or the end (1) of a phase."""
        turns, dwells = divmod(number + side, 2)
        return (self.high if dwells else self.low) + turns * TURN

    def segment(self, number: int) -> _Segment:
        """Return a phase, made from that before it, or behind it."""
        if number not in self.segments:
            side = 0 if number > 0 else 1
            before = self.segment(number - 1 if number > 0 else number + 1)
            value = self.border(number, side)
            poses = placed_at(self._solved(before, np.array([value]), {}, 0).poses, (0, 0))
            items: Sequence[Item] = [*self.items, self.drive] if number % 2 else [*self._next_slot(poses, side)]
            mechanism = with_items(self.engaged.mechanism, items)
            structure = decompose(mechanism)
            values = {self.engaged.driver: value}
            if number % 2:
                own = structure.driven[self.drive.name]
                ends = own.pair.ends(mechanism.geometry)
                series = own.pair.coordinate(ends, tuple(poses[one] for one in own.pair.members))
                values[self.drive.name] = float(np.ravel(series.c[0])[0]) * float(own.pair.driven_by(own.drive.link))
            begin = Configuration(structure, values, poses, {}, {}, dimensions_at(structure, 0, 0))
            self.segments[number] = _Segment(mechanism, begin)
        return self.segments[number]

    def _next_slot(self, poses: Mapping[str, Pose], side: int) -> Iterator[Item]:
        """Yield the items with the slot, or the pin, where it is when the pin enters."""
        mechanism, slot, link = self.engaged.mechanism, self.engaged.slot, self.drive.link
        stood, stands = (self.leaves if side else self.enters)[link], poses[link]
        u = complex(stood.u.c[0] / stands.u.c[0])

        def moved(place: Any) -> complex:
            return complex((stood.z.c[0] + stood.u.c[0] * place - stands.z.c[0]) / stands.u.c[0])

        letter = letter_in_slot(slot, link)
        entering = f"{letter} of the next slot"
        points = {entering: moved(mechanism.geometry.points[link][letter])}
        following = slot_elsewhere(slot, link, entering, u, mechanism.geometry)
        for item in mechanism.items:
            if isinstance(item, Link) and item.name == link:
                yield replace(item, points={**item.points, **points})
            elif item is slot:
                yield following
            elif not isinstance(item, Drawn | Mode | Expectation):
                yield item

    def phase(self, number: int, values: Number, rates: Mapping[str, float | None], order: int) -> MotionPhase:
        """Return the phase of a number at values of the driver."""
        motion = self._solved(self.segment(number), values, rates, order)
        return MotionPhase(float(values[0]), float(values[-1]), number % 2 == 0, motion)

    def _solved(self, one: _Segment, values: Number, rates: Mapping[str, float | None], order: int) -> Motion:
        driver, begin = self.engaged.driver, one.begin
        held = {} if begin is None else {name: value for name, value in begin.values.items() if name != driver}
        moved = {word: {driver: rate} for word, rate in rates.items() if rate is not None}
        with warnings.catch_warnings():
            if begin is not None:
                # the mechanism is drawn with another slot
                warnings.simplefilter("ignore", DrawnBeyondEnd)
            return solve(one.mechanism, {driver: values, **held}, order=order, modes=begin, **moved)


def _runs(values: Number, low: float, high: float) -> list[tuple[int, list[float]]]:
    """Return the numbers of the phases through which values of the driver go, each with its values and its ends."""

    def number(value: float) -> int:
        turns = np.floor((value - low) / TURN)
        return 2 * int(turns) + int(value - turns * TURN > high)

    def border(phase: int) -> float:
        turns, dwells = divmod(phase, 2)
        return (high if dwells else low) + turns * TURN

    runs = [(number(float(values[0])), [float(values[0])])]
    for value in values[1:].tolist():
        while (here := runs[-1][0]) != (there := number(value)):
            up = there > here
            at = border(here + 1 if up else here)
            if at != runs[-1][1][-1]:
                runs[-1][1].append(at)
            runs.append((here + 1 if up else here - 1, [at]))
        if value != runs[-1][1][-1]:
            runs[-1][1].append(value)
    return runs


def _going_on(values: Number, ends: Number) -> Number:
    """Return angles of several phases in a row with turns such that none jumps from one phase to the next."""
    found, last = np.array(values), np.nan
    for first, end in pairwise(ends.tolist()):
        if np.isfinite(last) and np.isfinite(found[first]):
            found[first:end] += whole_turns(last - found[first])
        last = found[end - 1]
    return found


# What may jump: velocities and accelerations.
RATES = {"links": OF_LINKS[1:3], "points": OF_POINTS[1:3]}


def _rates_of(motions: Sequence[Motion]) -> dict[str, float]:
    """Return the velocities and accelerations that all motions have, by name, with their greatest sizes."""
    names = [
        f"{owner}.{word}"
        for kind, words in RATES.items()
        for owner in getattr(motions[0], kind)
        if all(owner in getattr(motion, kind) for motion in motions)
        for word in words[: motions[0].order]
    ]
    sizes = ((float(np.nanmax(np.abs(quantity(motion, name).values))) for motion in motions) for name in names)
    return {name: max(size) for name, size in zip(names, sizes, strict=True)}


def _jumps(before: MotionPhase, after: MotionPhase, sizes: Mapping[str, float]) -> Iterator[MotionJump]:
    """Yield what jumps between two phases."""
    what = ENTERS if after.engaged else LEAVES
    for name, size in sizes.items():
        one, other = (quantity(phase.motion, name) for phase in (before, after))
        last, first = np.ravel(one.values)[-1], np.ravel(other.values)[0]
        if abs(first - last) > NO_JUMP * size:
            yield MotionJump(after.first, what, name, one.unit, last.item(), first.item())
