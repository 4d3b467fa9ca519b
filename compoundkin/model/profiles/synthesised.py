"""The profile made for a motion program. The cam that gives its follower a wanted motion."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Literal

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.curves import Analytic, Curve
from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.base.series import Series, as_series
from compoundkin.model.fields import Key
from compoundkin.model.geometry import place_of
from compoundkin.model.laws.motion_programs import Program
from compoundkin.model.profiles.contract import Profile
from compoundkin.model.profiles.envelopes import Envelope, FollowerGuide, Lift, Oscillating, Translating
from compoundkin.model.profiles.fitness import faults, undercuts


@dataclass(frozen=True)
class Synthesised(Profile):
    """The profile of a cam that moves its follower by a program; see `synthesise`."""

    program: Program
    base: float
    follower: str = "knife"
    roller: float = 0.0
    offset: float = 0.0
    angle: float = np.pi / 2.0
    pivot: complex | None = None
    arm: float = 0.0
    face: float = 0.0
    side: int = 1
    clockwise: bool = False
    start: float = 0.0

    kind: ClassVar[str] = "made"
    keys: ClassVar[tuple[Key, ...]] = (
        Key("program", "program", "The lift over one turn of the cam, from the base circle: segments.", required=True),
        Key("base", "number", "Radius of the base circle, the least of the cam's.", required=True),
        Key("follower", "name", "knife, roller or flat.", default="knife"),
        Key("roller", "number", "Radius of the roller.", default=0.0),
        Key(
            "offset", "number", "How far a translating follower's guide is to the left of the cam's axis.", default=0.0
        ),
        Key("angle", "turn", "The direction in which a translating follower rises.", default=np.pi / 2.0),
        Key("pivot", "place", "The pin of an oscillating follower, from the cam's axis; none if it translates."),
        Key("arm", "number", "The distance from the pivot to the knife edge or the roller's middle.", default=0.0),
        Key("face", "number", "How far an oscillating flat face is beyond its pivot, seen from the cam.", default=0.0),
        Key("side", "sign", "1 where an oscillating follower rises counterclockwise, -1 clockwise.", default=1),
        Key("clockwise", "flag", "Whether the cam turns clockwise as the program goes on.", default=False),
        Key("start", "turn", "The cam's angle at which the program begins.", default=0.0),
    )

    def __post_init__(self) -> None:
        if isinstance(self.program, Program):
            # a cam goes round and round anyway
            object.__setattr__(self, "program", replace(self.program, repeat=False))

    @property
    def oscillates(self) -> bool:
        """Whether the follower turns about a pivot, so that the program rises by angles."""
        return self.pivot is not None

    @property
    def mode(self) -> int:
        """The assembly mode of the follower that is meant."""
        return -self.side if self.oscillates and self.follower != "flat" else 1

    @property
    def prime(self) -> float:
        """The radius of the edge, the roller's middle or the face at home."""
        return self.base + self.roller

    @property
    def guide(self) -> FollowerGuide:
        """How the follower moves."""
        flat = self.follower == "flat"
        if self.pivot is None:
            return Translating(self.prime, self.angle, self.offset, flat)
        return Oscillating(self.prime, self.pivot, self.arm, self.face, self.side, flat)

    @cached_property
    def envelope(self) -> Envelope:
        """The follower carried round the cam."""
        return Envelope(Lift(self.program, self.start, self.clockwise), self.guide, self.roller)

    @cached_property
    def pitch_curve(self) -> Analytic | None:
        """The path of the knife edge or roller's middle in the cam's frame. It is None for a flat face."""
        return None if self.follower == "flat" else self.envelope.pitch()

    def coordinate(self, angle: Series | Any) -> Series:
        """Return the follower's coordinate at a cam angle (radians), with all derivatives.

        The angle is from the cam's carrier.
        A displacement along the guide from the foot of the cam's axis, or the angle of the arm or face.
        """
        return self.envelope.coordinate(as_series(angle))

    def _made(self) -> Curve:
        found = list(faults(self)) or list(undercuts(self))
        if found:
            raise InvalidMechanism(found)
        return self.envelope.faced() if self.follower == "flat" else self.envelope.rolled()

    def problems(self, where: str) -> Iterator[Problem]:
        """Find what makes it no profile. A program that does not close, a base circle too small."""
        yield from super().problems(where)

    def _without_loop(self) -> str:
        return "take a greater base circle or a smaller roller"


@checked
def synthesise(
    program: Program,
    *,
    base: float,
    follower: Literal["knife", "roller", "flat"] = "knife",
    roller: float = 0.0,
    offset: float = 0.0,
    angle: float = np.pi / 2.0,
    pivot: Any = None,
    arm: float = 0.0,
    face: float = 0.0,
    side: int = 1,
    clockwise: bool = False,
    start: float = 0.0,
) -> Synthesised:
    """Return the cam profile that moves a follower by a program over a turn.

    The cam's link is pinned to its carrier at its origin and turns with its angle s (radians), counterclockwise as the
    program goes on or `clockwise`; at s = `start` the program begins. The parameter of the curve is s: the follower
    touches the point that has the parameter s when the cam's angle is s. `base` is the radius of the base circle, at
    which the program's value is 0. Lengths as in the mechanism, angles in radians; the program is over radians.

    A translating follower rises in the direction `angle` on a guide `offset` to its left: ``slide("follower",
    on="frame", through="A", angle=angle, offset=offset)``, A the cam's axis; a flat face is square to it, ``face(...,
    angle=deg(90))``, and minds no offset. An oscillating one turns about `pivot`, a point from the cam's axis or a
    distance along x, and the program rises by angles: its edge or roller is at the end of its `arm`, in the direction
    of its link's x axis; its flat face is along that axis, beyond its pivot by `face`, ``face(..., angle=0,
    side=-side)``. `side` 1: it rises counterclockwise, -1: clockwise. The follower's mode is `Synthesised.mode`, its
    coordinate then `Synthesised.coordinate`.

    Raises InvalidMechanism, with the cam's angles, for what cannot be made: a program that does not take one turn or
    does not return, an arm that does not reach, an undercut (with the least base circle that will do), a hollow under a
    face.

    Source: R. L. Norton, Cam Design and Manufacturing Handbook, 2nd ed., chapter 13.

    >>> from compoundkin.model.laws import dwell, fall, program, rise
    >>> quarter = np.pi / 2
    >>> lift = program(dwell(quarter), rise(10, over=quarter), dwell(quarter), fall(10, over=quarter))
    >>> cam = synthesise(lift, base=30, follower="roller", roller=8)
    >>> [round(float(abs(cam.curve.at(s).c[0])), 6) for s in (0.5, 4.0)]
    [30.0, 40.0]
    """
    pin = None if pivot is None else place_of(pivot, "pivot")
    made = Synthesised(program, base, follower, roller, offset, angle, pin, arm, face, side, clockwise, start)
    found = list(made.problems(""))
    if found:
        raise InvalidMechanism(found, heading="" if len(found) == 1 else "no cam can be made")
    return made
