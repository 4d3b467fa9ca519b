"""In which order the poses of a motion are shown, and when."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics import Motion
from compoundkin.view.sketch.scene import Scene

# A motion without a time takes so long, seconds, and if a driver makes several turns so many times that at most.
CYCLE, MOST_CYCLES = 4.0, 3.0
# There are at most so many frames a second.
FPS = 25.0
# No screen shows more frames a second, and more of them than this in a file are a mistake.
MOST_FPS, MOST_FRAMES = 60.0, 10_000
# Seconds times frames a second may miss a whole number by this rounding.
ROUNDING = 1e-6
# Frames are taken a little fewer where they then fall on poses, which are as many parts of a frame apart.
EVEN = 0.05


@dataclass(frozen=True, eq=False)
class TimelineLeg:
    """Poses that follow one another without a leap. Places among the assembled ones, with their times from 0 to 1.

    `way` is 1 where the motion goes on, -1 where it goes back.
    """

    poses: Number
    times: Number
    way: int = 1


@dataclass(frozen=True, eq=False, repr=False)
class Timeline(ShortRepr):
    """The legs of an animation in their order. `returns` where it ends as it begins, and `seconds` how long it takes.

    `hold` is for how long a frame is shown, `frames` the places of the frames in `poses` and `ways`.
    """

    legs: tuple[TimelineLeg, ...]
    returns: bool
    seconds: float
    frames: Number

    @property
    def hold(self) -> float:
        """The duration of a frame, seconds."""
        return self.seconds / len(self.frames)

    @cached_property
    def poses(self) -> Number:
        """All poses in the order in which they are shown."""
        return np.concatenate([leg.poses for leg in self.legs])

    @cached_property
    def times(self) -> Number:
        """Their times, from 0 to 1."""
        return np.concatenate([leg.times for leg in self.legs])

    @cached_property
    def directions(self) -> Number:
        """Their directions: 1 forward, -1 back."""
        return np.concatenate([np.full(len(leg.poses), leg.way) for leg in self.legs])

    @cached_property
    def slices(self) -> tuple[slice, ...]:
        """The slices of the legs among all poses."""
        ends = np.cumsum([0, *(len(leg.poses) for leg in self.legs)])
        return tuple(slice(int(a), int(b)) for a, b in pairwise(ends))

    @property
    def has_seam(self) -> bool:
        """Whether a leg goes on where the values of drivers leap. They leap at the end of a turn."""
        return any(len(leg.poses) > 1 and np.ptp(np.sign(np.diff(leg.poses))) > 0 for leg in self.legs)

    def turning(self, angles: Number) -> Number:
        """Return angles over the assembled poses, continuous in every leg.

        The poses are in the order in which they are shown.

        A leg that goes on beyond the end of a turn goes on with the angles of that end.
        """
        found = []
        for leg in self.legs:
            start = leg.poses[0] if leg.way > 0 else leg.poses[-1]
            found.append(angles[leg.poses] + np.where(leg.poses < start, angles[-1] - angles[0], 0.0))
        return np.concatenate(found)


def timeline_of(
    scene: Scene, motion: Motion, design: int, back: bool | None, seconds: float | None, fps: float | None
) -> Timeline:
    """Return the timeline of an animation. Through all poses, and back where the last is not the first again.

    Poses that cannot be assembled are left out; each interval between them is a way there and back of its own. A motion
    in time is shown as fast as it is, any other one in about four seconds, unless `seconds` says how long.
    """
    if back is not None and not isinstance(back, bool):
        raise InvalidInput(Problem("back", f"{back!r} is neither true nor false", "leave it out"))
    rate = _checked("fps", FPS if fps is None else fps, 1.0, MOST_FPS)
    wished = None if seconds is None else _checked("seconds", seconds, 1.0 / rate, MOST_FRAMES)
    pieces, closed = _pieces(scene, motion.inputs.poses)
    legs = _legs(pieces, _clock(motion, design)[scene.known], not closed if back is None else back)
    returns = (closed and back is not True) or legs[-1].way < 0
    length = float(legs[-1].times[-1])
    if wished is None and motion.time is not None:
        wished = length
    legs = [TimelineLeg(leg.poses, leg.times / (length or 1.0), leg.way) for leg in legs]
    usual = CYCLE * min(max(_turns(motion), 1.0), MOST_CYCLES)
    frames = _frames(legs, returns, (wished or usual) * rate)
    return Timeline(tuple(legs), returns, _lasting(wished, usual, len(frames), rate), frames)


def _lasting(wished: float | None, usual: float, count: int, rate: float) -> float:
    """The duration of some frames: the given duration; else about the usual one, with frames of one length.

    A GIF knows whole hundredths of a second only.
    """
    return wished or count * max(round(100.0 * usual / count) / 100.0, 1.0 / rate)


def _checked(name: str, value: Any, low: float, high: float) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not low <= value <= high:
        raise InvalidInput(Problem(name, f"{value!r} does not fit", f"{low:.3g} to {high:g}"))
    return float(value)


def _clock(motion: Motion, design: int) -> Number:
    """When each pose is reached: seconds of a motion in time, else the ways of the drivers in parts of the whole."""
    shape = motion.inputs.designs, motion.inputs.poses
    if motion.time is not None:
        return np.concatenate([[0.0], np.cumsum(np.abs(np.diff(pose_times(motion, design))))])
    ways = [np.abs(np.diff(np.broadcast_to(c[0], shape)[design])) for c in motion.inputs.drives.values()]
    parts = [way / way.sum() for way in ways if way.sum() > 0]
    steps = np.max(parts, axis=0) if parts else np.ones(shape[1] - 1)
    return np.concatenate([[0.0], np.cumsum(steps)])


def _turns(motion: Motion) -> float:
    """The greatest number of full turns of a driver."""
    return max((float(np.max(np.ptp(row[0], axis=-1))) / (2.0 * np.pi) for row in _angles(motion)), default=0.0)


def _angles(motion: Motion) -> list[Number]:
    driven = motion.structure.driven
    return [rows for name, rows in motion.inputs.drives.items() if driven[name].pair.free_is_angle]


def pose_times(motion: Motion, design: int) -> Number:
    """Return the times of all poses of a motion in time, seconds."""
    assert motion.time is not None
    full = np.broadcast_to(np.asarray(motion.time, dtype=float), motion.shape)
    return full.reshape(motion.inputs.designs, motion.inputs.poses)[design]


def _pieces(scene: Scene, poses: int) -> tuple[list[Number], bool]:
    """The assembled poses in pieces without gaps, and whether they are one turn that ends as it begins.

    Where a turn that would do so has gaps, its last piece goes on with the first one.
    """
    known = np.asarray(scene.known)
    pieces = np.split(np.arange(len(known)), np.flatnonzero(np.diff(known) > 1) + 1)
    if not (len(known) > 2 and known[0] == 0 and known[-1] == poses - 1 and scene.closes):
        return pieces, False
    if len(pieces) == 1:
        return pieces, True
    return [np.concatenate([pieces[-1], pieces[0][1:]]), *pieces[1:-1]], False


def _legs(pieces: list[Number], clock: Number, back: bool) -> list[TimelineLeg]:
    """The legs one after another, with times as the clock has them."""
    legs: list[TimelineLeg] = []
    start = 0.0
    for piece in pieces:
        # where a piece goes on beyond the end of the turn, the clock starts anew
        steps = np.diff(clock[piece])
        seam = np.flatnonzero(np.diff(piece) < 0)
        steps[seam] = clock[piece[seam + 1]] - clock[0]
        times = start + np.concatenate([[0.0], np.cumsum(steps)])
        legs.append(TimelineLeg(piece, times))
        if back and len(piece) > 1:
            legs.append(TimelineLeg(piece[::-1], times[-1] + (times[-1] - times[::-1]), -1))
        start = float(legs[-1].times[-1])
    return legs


def _frames(legs: list[TimelineLeg], returns: bool, most: float) -> Number:
    """The places of the frames among the poses of all legs: evenly in time, on poses if they can be."""
    if most > MOST_FRAMES:
        raise InvalidInput(
            Problem("seconds", f"these are {most:,.0f} frames", f"at most {MOST_FRAMES:,}; ask for less")
        )
    times = np.concatenate([leg.times for leg in legs])
    count = len(np.unique(times[times < 1.0] if returns else times))
    if count < 2:
        return np.zeros(1, dtype=int)
    most = int(max(2, min(most + ROUNDING, count)))
    tried = [_nearest(times, n, returns) for n in range(most, most // 2, -1)]
    return min(tried, key=lambda one: round(one[1] / EVEN))[0]


def _nearest(times: Number, count: int, returns: bool) -> tuple[Number, float]:
    """The poses nearest to so many even times, and by how much of a frame the worst of them is off."""
    step = 1.0 / (count if returns else max(count - 1, 1))
    even = np.arange(count) * step
    after = np.clip(np.searchsorted(times, even), 1, len(times) - 1)
    nearest = after - (even - times[after - 1] < times[after] - even)
    return nearest, float(np.max(np.abs(times[nearest] - even)) / step)
