"""What is known of a singular pose: its kind, what opens there, which branches meet, in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, overload

import numpy as np

from compoundkin.base.arrays import degrees
from compoundkin.base.display import DisplaysHtml, ShortRepr, count_phrase
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import Pose
from compoundkin.kinematics import Motion

LIMIT, CHANGE, SHAKY = "limit position", "change point", "shaky pose"
DEAD, ARCHITECTURE = "dead point", "architecture"
# Rates below this part of a tangent are zero.
STILL = 1e-6


class Twist(NamedTuple):
    """The motion of a link: the velocity of its origin and its angular velocity."""

    velocity: complex
    angular_velocity: float


@dataclass(frozen=True, eq=False, repr=False)
class PoseTangent(ShortRepr):
    """A direction in which a mechanism can move from a pose: rates of drivers, twists of links, velocities of points.

    The driver that moves has the rate 1 (rad/s, or one length/s), so that angular velocities are velocity ratios; where
    none moves, the fastest link turns at 1 rad/s or shifts by the longest link's length a second. The opposite
    direction is the same branch. Branches are numbered from 1, those `followed` by the motion first; `multiplicity` is
    2 where two branches touch.
    """

    number: int
    drivers: Mapping[str, float]
    twists: Mapping[str, Twist]
    velocities: Mapping[str, complex]
    followed: bool = False
    multiplicity: int = 1

    @property
    def in_words(self) -> str:
        """The angular velocities of links, and the speeds of those that do not turn."""
        turning = STILL * max((abs(twist.angular_velocity) for twist in self.twists.values()), default=0.0)
        speeds = (*map(abs, self.velocities.values()), *(abs(twist.velocity) for twist in self.twists.values()))
        shifting = STILL * max(speeds, default=0.0)
        return ", ".join(
            f"{name} {twist.angular_velocity:.6g}" if abs(twist.angular_velocity) > turning
            else f"{name} shifts {abs(twist.velocity):.6g}" if abs(twist.velocity) > shifting else f"{name} rests"
            for name, twist in self.twists.items()
        )  # fmt: skip


@dataclass(frozen=True, eq=False, repr=False)
class Singularity(ShortRepr):
    """A singular pose of a motion, `number` in the order along it from 1.

    `kind` is "limit position", where the driver goes no further and turns back; "change point", where branches meet;
    "shaky pose", where more opens than branches are; "dead point", where an `output` rests while the driver moves; or
    "architecture", singular from `place` to `until`.
    `place` counts poses from 0, in between fractional; `drivers` are their values there, `poses` those of all links.
    `groups` and `links` are those whose equations are singular. `openings` are motions for which the drivers would not
    have to move, as far as velocities tell; at a dead point that of the mechanism while the output rests. `branches`
    are the tangents of the motions through the pose. They are `finite` where second derivatives tell them apart; else
    there is a family of directions besides, and only isolated ones and those along the motion are listed.
    """

    number: int
    kind: str
    design: tuple[int, ...]
    place: float
    until: float
    drivers: Mapping[str, float]
    time: float | None
    groups: tuple[str, ...]
    links: tuple[str, ...]
    output: str
    openings: tuple[PoseTangent, ...]
    branches: tuple[PoseTangent, ...]
    finite: bool
    turns_back: bool
    poses: Mapping[str, Pose] = field(repr=False)
    motion: Motion = field(repr=False)

    @property
    def name(self) -> str:
        """What it is called in reports and pictures."""
        return f"{self.kind} {self.number}"

    @property
    def other_branch(self) -> dict[str, float]:
        """What `solve(branch=...)` takes to go over to the other branch here, where a motion passes smoothly.

        Raises InvalidInput for what is no change point of a motion by one driver.

        >>> from compoundkin import load, singularities, solve
        >>> here = singularities(solve(load("parallelogram"), {"crank": np.deg2rad(np.arange(30.0, 331.0, 5.0))}))[0]
        >>> here.other_branch
        {'coupler': 3.141592653589793}
        """
        if self.kind != CHANGE or len(self.drivers) != 1:
            what = f"{self.name} is no change point of a motion by one driver"
            raise InvalidInput(Problem("branch", what, "only there another branch goes on"))
        (value,) = self.drivers.values()
        return {self.links[0]: value}

    @property
    def meeting(self) -> str:
        """Which branches meet there, in words."""
        count = len(self.branches)
        if self.kind == DEAD:
            return f"{self.output} turns back"
        if self.kind == ARCHITECTURE:
            return "singular all along"
        if not self.finite:
            one = f"{count_phrase(count, 'branch', 'branches')}, and " if count else ""
            return f"{one}a family of directions that second derivatives do not tell apart"
        if self.kind == LIMIT:
            return f"one smooth branch, the driver {'turns back' if self.turns_back else 'rests'}"
        if not count:
            return "no branch leaves: the pose is isolated"
        if count == 1 and self.branches[0].multiplicity > 1:
            return "two branches that touch"
        return (
            f"{count_phrase(count, 'branch', 'branches')} meet"
            if count > 1
            else "one branch, others open in velocity only"
        )

    def text(self) -> str:
        """Return it with its branches as text, angles in degrees."""
        return "\n".join([f"{self.number} {self._where}: {self.kind}{self._of}; {self.meeting}", *self._branches()])

    @property
    def values(self) -> str:
        """The drivers' values in words, angles in degrees."""
        driven, size = self.motion.structure.driven_angles, self.motion.size
        lengths = {name: f"{np.round(value / size, 10) * size + 0.0:.7g}" for name, value in self.drivers.items()}
        angles = {name: f"{np.round(degrees(value), 7) + 0.0:.7g}°" for name, value in self.drivers.items()}
        return ", ".join(f"{name} {(angles if driven[name] else lengths)[name]}" for name in self.drivers)

    @property
    def _where(self) -> str:
        onward = f" to {self.until:.6g}" if self.until > self.place else ""
        return f"{self.values or 'without a driver'} (pose {self.place:.6g}{onward})"

    @property
    def _of(self) -> str:
        return f" of {', '.join(self.links)}" if self.links else ""

    def _branches(self) -> Iterator[str]:
        for one in self.branches if self.kind != DEAD else ():
            yield f"  branch {one.number}{' (followed)' if one.followed else ''}: {one.in_words}"


@dataclass(frozen=True, eq=False, repr=False)
class Singularities(Sequence[Singularity], DisplaysHtml, ShortRepr):
    """The singular poses of a motion, in order along each design."""

    motion: Motion
    found: tuple[Singularity, ...]

    def __len__(self) -> int:
        return len(self.found)

    @overload
    def __getitem__(self, index: int) -> Singularity: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[Singularity, ...]: ...

    def __getitem__(self, index: int | slice) -> Singularity | tuple[Singularity, ...]:
        """Return one of them, or some, by index from 0."""
        return self.found[index]

    def __iter__(self) -> Iterator[Singularity]:
        return iter(self.found)

    def text(self) -> str:
        """Return them as text, angles in degrees."""
        return "\n".join(one.text() for one in self.found) or "No pose along the motion is singular."
