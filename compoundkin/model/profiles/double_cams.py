"""Cams with positive drive, without a spring: conjugate discs, and one disc of constant breadth.

The follower carries two rollers or faces, rigidly joined. The second one follows the inverted program, seen from the
other side of the cam's axis; so the second disc is synthesised like any other.

Source: H. A. Rothbart (ed.), Cam Design Handbook, McGraw-Hill 2004, chapter 1 (positive drive); R. L. Norton, Cam
Design and Manufacturing Handbook, 2nd ed., Industrial Press 2009, chapter 1.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import TURN
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.base.series import Series
from compoundkin.model.geometry import single_point
from compoundkin.model.laws.motion_programs import Program
from compoundkin.model.profiles.synthesised import ROUNDING, Synthesised

# Places of half a turn at which a program is compared with itself half a turn later.
PLACES = 1441


@dataclass(frozen=True, repr=False)
class DoubleCam(ShortRepr):
    """Two profiles on one shaft that drive a follower both ways; see `conjugate` and `constant_breadth`.

    `second` is `first` for a single disc.
    """

    first: Synthesised
    second: Synthesised

    @property
    def is_single(self) -> bool:
        """Whether it is a single disc."""
        return self.second == self.first

    @property
    def oscillates(self) -> bool:
        """Whether the follower turns about a pivot."""
        return self.first.oscillates

    @property
    def apart(self) -> float:
        """The distance of the two ends of the follower.

        The distance of the rollers' centres, or faces, along the guide of a translating follower: of flat faces the
        breadth. The angle (radians) from the second arm or face to the first one, in the sense of `side`, of one that
        oscillates.
        """
        values = self.first.program.values
        ends = (self.first.guide, self.second.guide)
        if not self.oscillates:
            return ends[0].home + ends[1].home + float(np.min(values) + np.max(values))
        home = float(np.angle(-(self.first.pivot or 0j)))
        openings = sum(end.sense * (end.home - home) for end in ends)
        return openings + float(np.min(values) + np.max(values))


@checked
def conjugate(
    program: Program,
    *,
    base: float,
    second_base: float | None = None,
    follower: Literal["knife", "roller", "flat"] = "roller",
    roller: float = 0.0,
    second_roller: float | None = None,
    offset: float = 0.0,
    angle: float = np.pi / 2.0,
    pivot: Any = None,
    arm: float = 0.0,
    second_arm: float | None = None,
    face: float = 0.0,
    second_face: float | None = None,
    side: int = 1,
    clockwise: bool = False,
    start: float = 0.0,
) -> DoubleCam:
    """Return two discs for a program, which drive their follower both ways.

    The arguments are those of `synthesise`; those of the second disc and its roller are the same by default. The
    second one lies on the other side of the cam's axis, on the same guide, or drives an arm to the other side: it falls
    as the first one rises. `cams.cam_mechanism` writes the mechanism.

    Raises InvalidMechanism, with the disc, for an impossible profile.

    Source: H. A. Rothbart (ed.), Cam Design Handbook, McGraw-Hill 2004, chapter 1.

    >>> from compoundkin.model.laws import fall, program, rise
    >>> cams = conjugate(program(rise(20, over=np.pi), fall(20, over=np.pi)), base=40, roller=10)
    >>> cams.apart  # 50 + 50 + 20
    120.0
    """
    pin = None if pivot is None else single_point(pivot, "pivot")
    first = Synthesised(program, base, follower, roller, offset, angle, pin, arm, face, side, clockwise, start)
    other = {"base": second_base, "roller": second_roller, "arm": second_arm, "face": second_face}
    return _checked_double_cam(
        first, _opposite(first, {key: value for key, value in other.items() if value is not None})
    )


@checked
def constant_breadth(
    program: Program,
    *,
    base: float,
    follower: Literal["knife", "roller", "flat"] = "flat",
    roller: float = 0.0,
    angle: float = np.pi / 2.0,
    clockwise: bool = False,
    start: float = 0.0,
) -> DoubleCam:
    """Return the disc that drives a yoke both ways.

    The yoke translates, with two parallel faces, or two rollers on a line through the cam's axis. The program and
    itself half a turn later must add up to a constant: the faces are then `DoubleCam.apart` from each other, twice the
    base circle and that constant, in every direction. `cams.cam_mechanism` writes the mechanism.

    Raises InvalidMechanism for a program that does not add up, with the place and the difference, and for an impossible
    profile.

    Source: H. A. Rothbart (ed.), Cam Design Handbook, McGraw-Hill 2004, chapter 1 (yoke cams).

    >>> from compoundkin.model.laws import fall, program, rise
    >>> constant_breadth(program(rise(20, over=np.pi), fall(20, over=np.pi)), base=30).apart
    80.0
    """
    made = Synthesised(program, base, follower, roller, angle=angle, clockwise=clockwise, start=start)
    return _checked_double_cam(made, made, list(_uneven(program)))


def inverted_program(program: Program) -> Program:
    """Return the program that falls where another one rises, between the same values.

    >>> from compoundkin.model.laws import fall, program, rise
    >>> inverted_program(program(fall(3, over=1), rise(5, over=2), start=3.0)).values.tolist()
    [2.0, 5.0, 0.0]
    """
    total = float(np.min(program.values) + np.max(program.values))
    segments = tuple(replace(segment, rise=0.0 - segment.rise) for segment in program.segments)
    return replace(program, segments=segments, start=total - program.start)


def _opposite(first: Synthesised, other: Mapping[str, Any]) -> Synthesised:
    """Return the profile on the other side of the axis, or of the arm to the other side."""
    behind = np.pi if first.pivot is None else 0.0
    return replace(
        first,
        program=inverted_program(first.program),
        # what is on the left of a direction is on the right of the opposite one
        offset=0.0 - first.offset,
        angle=first.angle + behind,
        side=-first.side,
        **other,
    )


def _checked_double_cam(first: Synthesised, second: Synthesised, wrong: list[Problem] | None = None) -> DoubleCam:
    found = list(first.problems("")) or wrong or []
    if not found and second != first:
        found = [replace(one, where=f"second {one.where}".strip()) for one in second.problems("")]
    if found:
        raise InvalidMechanism(found, heading="" if len(found) == 1 else "no cam can be synthesised")
    return DoubleCam(first, second)


def _uneven(program: Program) -> Iterator[Problem]:
    """Find the worst place at which a program and itself half a turn later do not add up to a constant."""
    half = TURN / 2.0
    q = np.unique(np.concatenate([np.linspace(0.0, half, PLACES), np.mod(program.breaks, half)]))
    here, there = (np.asarray(program.at(Series((x,)), repeat=True).c[0]) for x in (q, q + half))
    total = float(np.min(program.values) + np.max(program.values))
    off = here + there - total
    worst = int(np.argmax(np.abs(off)))
    if abs(off[worst]) > ROUNDING * program.lift:
        at = float(np.rad2deg(q[worst]))
        what = (
            f"at {at:.6g} and {at + 180.0:.6g} degrees it rises to {here[worst]:.6g} and {there[worst]:.6g}: "
            f"{abs(off[worst]):.6g} {'more' if off[worst] > 0 else 'less'} than its lowest and highest place together, "
            f"{total:.6g}"
        )
        remedy = "answer each rise by an equal fall half a turn later, or take two discs: profiles.conjugate(...)"
        yield Problem("program", what, remedy)
