"""The profile synthesised for a motion program: follower guides, envelope, undercut and its limits."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from math import acos, asin, hypot, sqrt
from typing import Any, ClassVar, Literal

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import LONGEST, TURN, Number, dot
from compoundkin.base.bracketing import bisect_brackets
from compoundkin.base.curves import Analytic, Curve
from compoundkin.base.curves.samples import spans
from compoundkin.base.errors import InvalidMechanism, Problem, suggestion
from compoundkin.base.series import Series, as_series, compose_series, constant, derivative_coefficients
from compoundkin.model.fields import Key
from compoundkin.model.geometry import single_point
from compoundkin.model.laws.motion_programs import Program, turn_problems
from compoundkin.model.profiles.profile import Profile


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
        """The intended assembly mode of the follower."""
        return -self.side if self.oscillates and self.follower != "flat" else 1

    @property
    def prime(self) -> float:
        """The distance of the edge, the roller's centre or the face from the axis on the base circle."""
        return self.base + self.roller

    @property
    def guide(self) -> FollowerGuide:
        """The guide of the follower."""
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

    def _built_curve(self) -> Curve:
        found = list(synthesis_problems(self)) or list(undercuts(self))
        if found:
            raise InvalidMechanism(found)
        return self.envelope.faced() if self.follower == "flat" else self.envelope.rolled()

    def _loop_remedy(self) -> str:
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
    angle=deg(90))``, and does not depend on the offset. An oscillating one turns about `pivot`, a point from the cam's
    axis or a distance along x, and the program rises by angles: its edge or roller is at the end of its `arm`, in the
    direction of its link's x axis; its flat face is along that axis, beyond its pivot by `face`, ``face(..., angle=0,
    side=-side)``. `side` 1: it rises counterclockwise, -1: clockwise. The follower's mode is `Synthesised.mode`, its
    coordinate then `Synthesised.coordinate`.

    Raises InvalidMechanism, with the cam's angles, for an impossible profile: a program that does not take one turn or
    does not return, an arm that does not reach, an undercut (with the least sufficient base circle), a hollow under a
    face.

    Source: R. L. Norton, Cam Design and Manufacturing Handbook, 2nd ed., chapter 13.

    >>> from compoundkin.model.laws import dwell, fall, program, rise
    >>> quarter = np.pi / 2
    >>> lift = program(dwell(quarter), rise(10, over=quarter), dwell(quarter), fall(10, over=quarter))
    >>> cam = synthesise(lift, base=30, follower="roller", roller=8)
    >>> [round(float(abs(cam.curve.at(s).c[0])), 6) for s in (0.5, 4.0)]
    [30.0, 40.0]
    """
    pin = None if pivot is None else single_point(pivot, "pivot")
    made = Synthesised(program, base, follower, roller, offset, angle, pin, arm, face, side, clockwise, start)
    found = list(made.problems(""))
    if found:
        raise InvalidMechanism(found, heading="" if len(found) == 1 else "no cam can be synthesised")
    return made


@dataclass(frozen=True)
class Lift:
    """The lift of the follower from the base circle by the cam's angle: a motion program around the cam."""

    program: Program
    start: float
    clockwise: bool

    def at(self, s: Series) -> Series:
        """Return the lift and its derivatives."""
        turned = self.start - s if self.clockwise else s - self.start
        return self.program.at(turned, repeat=True)

    @property
    def breaks(self) -> tuple[float, ...]:
        """The cam's angles at which a law begins and derivatives may jump."""
        sense = -1.0 if self.clockwise else 1.0
        return tuple((self.start + sense * piece.start) % TURN for piece in self.program.pieces)


class FollowerGuide(ABC):
    """The guide of a follower, `Translating` or `Oscillating`."""

    @property
    @abstractmethod
    def home(self) -> float:
        """The coordinate on the base circle."""

    @property
    def sense(self) -> float:
        """+1 where the coordinate grows as the follower rises, else -1."""
        return 1.0

    @abstractmethod
    def middle(self, coordinate: Series) -> Series:
        """Return the knife edge or the centre of the roller, in the carrier's frame."""

    @abstractmethod
    def facing(self, coordinate: Series) -> tuple[Series, Series]:
        """Return a flat face in the carrier's frame: its normal away from the cam, its distance from the cam's axis."""


@dataclass(frozen=True)
class Translating(FollowerGuide):
    """Along a guide in a direction, `offset` to its left. `prime` is the distance of the edge or face at home."""

    prime: float
    angle: float
    offset: float
    flat: bool

    @property
    def home(self) -> float:
        """The displacement along the guide from the foot of the cam's axis."""
        return self.prime if self.flat else sqrt(self.prime**2 - self.offset**2)

    def middle(self, coordinate: Series) -> Series:
        """Return a place on the guide."""
        return (coordinate + 1j * self.offset) * self._along

    def facing(self, coordinate: Series) -> tuple[Series, Series]:
        """Return a face square to the guide."""
        return constant(self._along), coordinate

    @property
    def _along(self) -> complex:
        return complex(np.cos(self.angle), np.sin(self.angle))


@dataclass(frozen=True)
class Oscillating(FollowerGuide):
    """About a pivot; the coordinate is the angle of the arm or face. `face` is how far the face is beyond the pivot.

    `side` +1: the arm rises counterclockwise, so that it is on the left of the line from the pivot to the cam.
    """

    prime: float
    pivot: complex
    arm: float
    face: float
    side: int
    flat: bool

    @property
    def opening(self) -> float:
        """The angle at home between arm and line from pivot to cam's axis."""
        apart = abs(self.pivot)
        if self.flat:
            return asin((self.prime - self.face) / apart)
        return acos((self.arm**2 + apart**2 - self.prime**2) / (2.0 * self.arm * apart))

    @property
    def home(self) -> float:
        """The angle of the arm or the face."""
        return float(np.angle(-self.pivot)) + self.side * self.opening

    @property
    def sense(self) -> float:
        """By the side."""
        return float(self.side)

    def middle(self, coordinate: Series) -> Series:
        """Return the end of the arm."""
        return coordinate.turn() * self.arm + self.pivot

    def facing(self, coordinate: Series) -> tuple[Series, Series]:
        """Return a face square to the arm."""
        normal = coordinate.turn() * (1j * self.side)
        return normal, normal.dot(self.pivot) + self.face


@dataclass(frozen=True)
class Envelope:
    """The envelope of a follower that moves around a cam."""

    lift: Lift
    guide: FollowerGuide
    roller: float

    def coordinate(self, s: Series) -> Series:
        """Return the follower's coordinate by the cam's angle."""
        return self.lift.at(s) * self.guide.sense + self.guide.home

    def pitch(self) -> Analytic:
        """Return the path of the knife edge or roller's middle, in the cam's frame."""
        return self._curve(lambda s: self.guide.middle(self.coordinate(s)) * (-s).turn())

    def rolled(self) -> Analytic:
        """Return the envelope of the roller: the parallel curve on the cam's side."""
        return self.pitch().offset(self.roller) if self.roller else self.pitch()

    def faced(self) -> Analytic:
        """Return the envelope of the face.

        With the face at n . C = h, the envelope has n' . C = h' too: C = n (h + i h' / w), w the rate at which n turns.
        """
        return self._curve(self._touched)

    def turning(self, s: Number) -> Number:
        """Return the rate at which the face turns in the cam's frame. It must be negative throughout."""
        return self._facing(_along(s, 1))[0].turning().c[0]

    def radius(self, s: Number) -> Number:
        """Return the radius of curvature under a flat face; where it is negative, the envelope turns back."""
        normal = self._facing(_along(s, 1))[0]
        along = self.faced().derivatives(s, 1)[1]
        return dot(along, -1j * normal.c[0]) / np.abs(normal.turning().c[0])

    def _curve(self, function: Callable[[Series], Series]) -> Analytic:
        return Analytic(function, 0.0, TURN, True, self.lift.breaks)

    def _facing(self, s: Series) -> tuple[Series, Series]:
        normal, distance = self.guide.facing(self.coordinate(s))
        return normal * (-s).turn(), distance

    def _touched(self, s: Series) -> Series:
        normal, distance = self._facing(_along(s.c[0], s.order + 1))
        aside = Series(derivative_coefficients(distance.c)) / normal.turning()
        place = Series(normal.c[:-1]) * (Series(distance.c[:-1]) + aside * 1j)
        return compose_series(place.c, s)


def _along(s: Number, order: int) -> Series:
    """Return the parameter itself as a series."""
    return Series((s, 1.0, *[0.0] * (order - 1)))


def arm_range(pivot: complex, arm: float) -> tuple[float, float]:
    """Return the least and greatest distance of an arm's end from the cam's axis.

    >>> arm_range(4j, 3.0)
    (1.0, 7.0)
    """
    apart = hypot(pivot.real, pivot.imag)
    return abs(apart - arm), apart + arm


FOLLOWERS = ("knife", "roller", "flat")
# Spans of degrees add up to a full turn but for rounding.
ROUNDING = 1e-9
# A sufficient base circle is searched in these steps (an oscillating face allows only a range of them), from this
# part of the size of the mechanism up to this multiple of it; then by bisection to six digits.
GROWTH = 1.1
MOST = 1e3
DIGITS = 1e-7
# Halving stops at the digits above long before this.
HALVINGS = 60
Span = tuple[float, float]


def synthesis_problems(made: Synthesised) -> Iterator[Problem]:
    """Find problems of the arguments, each with its key."""
    wrong = list(_number_problems(made)) or list(_keyword_problems(made))
    yield from wrong
    if not wrong:
        yield from _program_problems(made)
        yield from _dimension_problems(made)


def _number_problems(made: Synthesised) -> Iterator[Problem]:
    for key in ("base", "roller", "offset", "angle", "arm", "face", "start"):
        value: Any = getattr(made, key)
        if not _is_number(value) or np.iscomplexobj(value):
            yield Problem(key, f"{value!r} is not a finite number", "give one number; one profile for each design")
        elif abs(value) > LONGEST:
            yield Problem(key, f"{value!r} is too great", "choose another unit")
    if made.pivot is not None and not _is_number(made.pivot):
        yield Problem("pivot", f"{made.pivot!r} is not a point", "give one point; one profile for each design")
    if not isinstance(made.clockwise, bool | np.bool_):
        yield Problem("clockwise", f"{made.clockwise!r} is neither True nor False")


def _is_number(value: Any) -> bool:
    known = isinstance(value, int | float | complex | np.number) and not isinstance(value, bool)
    # an integer of more than 64 bits is no number of NumPy's
    large = isinstance(value, int) and abs(value) >= 2**63
    return known and not large and bool(np.isfinite(value))


def _keyword_problems(made: Synthesised) -> Iterator[Problem]:
    if not made.base > 0:
        yield Problem("base", f"a base circle cannot have the radius {made.base:g}", "give a positive length")
    if made.follower not in FOLLOWERS:
        yield Problem("follower", f"there is no follower {made.follower!r}", suggestion(str(made.follower), FOLLOWERS))
    elif made.follower == "roller" and not made.roller > 0:
        yield Problem("roller", f"a roller cannot have the radius {made.roller:g}", "give a positive length")
    elif made.follower != "roller" and made.roller != 0:
        yield Problem("roller", f"a {made.follower} follower has no roller", 'write follower="roller"')
    if made.side not in (1, -1):
        yield Problem("side", f"{made.side!r} is not a side", "write 1 (rises counterclockwise) or -1 (clockwise)")
    if not isinstance(made.program, Program):
        remedy = "write laws.program(laws.rise(...), laws.dwell(...))"
        yield Problem("program", f"{made.program!r} is not a motion program", remedy)
    yield from _misplaced_keywords(made)


def _misplaced_keywords(made: Synthesised) -> Iterator[Problem]:
    """Find arguments of the other sort of follower."""
    if made.pivot is None:
        for key in ("arm", "face"):
            if getattr(made, key) != 0:
                yield Problem(key, f"a translating follower has no {key}", "give the pivot of an oscillating one")
    elif made.offset != 0:
        yield Problem("offset", "an oscillating follower has no offset", "move its pivot, or leave the pivot out")
    elif made.follower == "flat" and made.arm != 0:
        yield Problem("arm", "a flat face has no arm", "leave it out; `face` is its distance from the pivot")
    elif made.follower != "flat" and made.face != 0:
        yield Problem("face", f"a {made.follower} follower has no face", "leave it out")


def _program_problems(made: Synthesised) -> Iterator[Problem]:
    program = made.program
    yield from turn_problems(program.period, "program")
    back = float(program.values[-1] - program.values[0])
    if abs(back) > ROUNDING * program.lift:
        what = f"the program does not return: it ends {abs(back):.6g} {'above' if back > 0 else 'below'} its beginning"
        yield Problem("program", what, "let it fall as much as it rises")
    lowest = float(np.min(program.values))
    if lowest < -ROUNDING * program.lift:
        what = f"the program goes {-lowest:.6g} below the base circle"
        yield Problem("program", what, f"let it start at {program.start - lowest:.6g}, or make it begin with a rise")
    jumps = [one.place for one in program.discontinuities(repeat=True) if one.order == 1]
    if jumps and made.follower != "knife":
        what = f"the velocity jumps at {_degrees(jumps)}: the profile would have a corner there"
        yield Problem("program", what, "choose another law, such as cycloidal")


def _dimension_problems(made: Synthesised) -> Iterator[Problem]:
    """Find dimensions that cannot be assembled on the base circle or at the greatest lift."""
    if made.pivot is None:
        if made.follower != "flat" and abs(made.offset) >= made.prime:
            what = f"an offset of {made.offset:g} does not meet the prime circle of radius {made.prime:g}"
            yield Problem("offset", what, f"take a base circle of more than {abs(made.offset) - made.roller:g}")
    elif made.pivot == 0:
        yield Problem("pivot", "it is on the axis of the cam", "move it")
    elif made.follower == "flat":
        yield from _face_problems(made, abs(made.pivot))
    else:
        yield from _arm_problems(made, *arm_range(made.pivot, made.arm))


def _arm_problems(made: Synthesised, least: float, most: float) -> Iterator[Problem]:
    if not made.arm > 0:
        yield Problem("arm", f"an arm cannot have the length {made.arm:g}", "give a positive length")
    elif not least < made.prime < most:
        what = (
            f"the arm does not reach the prime circle of radius {made.prime:g}: "
            f"its end is {least:g} to {most:g} from the axis"
        )
        yield Problem("arm", what, "change the arm or the pivot")
    elif _highest(made) >= np.pi:
        what = f"at the greatest lift the arm would be {np.rad2deg(_highest(made)):.6g} degrees from the cam's axis"
        yield Problem("arm", f"{what}, beyond its stretched position", "take a smaller lift or a longer arm")


def _face_problems(made: Synthesised, apart: float) -> Iterator[Problem]:
    if abs(made.base - made.face) >= apart:
        what = f"a face {made.face:g} beyond its pivot, {apart:g} from the axis, does not reach the base circle"
        yield Problem("face", what, "move the pivot away or change the base circle")
    elif _highest(made) >= np.pi / 2.0:
        what = f"at the greatest lift the face would be {np.rad2deg(_highest(made)):.6g} degrees from the cam's axis"
        yield Problem("program", what, "it must stay below 90: take a smaller lift or move the pivot away")


def _highest(made: Synthesised) -> float:
    """Return the greatest angle of the arm or face from the cam's axis."""
    guide = made.guide
    assert isinstance(guide, Oscillating)
    return guide.opening + float(np.max(made.program.values))


# --- undercut -------------------------------------------------------------------------------------------


def undercuts(made: Synthesised) -> Iterator[Problem]:
    """Find undercut: between which angles of the cam, and the least base circle without it."""
    found = undercut_spans(made)
    if not found:
        return
    between = " and ".join(f"{np.rad2deg(a):.6g} to {np.rad2deg(b):.6g}" for a, b in found)
    what = (
        "the face would have to enter a hollow of the profile"
        if made.follower == "flat"
        else f"the profile is undercut, its pitch curve bent to a radius below the roller's {made.roller:g},"
    )
    least = least_base(made)
    remedy = "no greater base circle helps" if least is None else f"take a base circle of {_rounded_up(least)} or more"
    yield Problem("base", f"{what} at cam angles of {between} degrees", remedy)


def undercut_spans(made: Synthesised) -> tuple[Span, ...]:
    """Return the angles of the cam between which its profile is undercut."""
    curve, margins = _undercut_margin(made)
    found = (spans(curve.samples, 0.0, TURN, margin) for margin in margins)
    return next((between for between in found if between), ())


def _undercut_margin(made: Synthesised) -> tuple[Curve, tuple[Callable[[Number], Number], ...]]:
    """Return the curve of the profile, and the margins that must be positive all along it."""
    envelope = made.envelope
    if made.follower == "flat":
        return envelope.faced(), (lambda s: -envelope.turning(s), envelope.radius)
    pitch = envelope.pitch()
    return pitch, (lambda s: 1.0 + made.roller * pitch.curvature(s),) if made.roller else ()


def least_base(made: Synthesised) -> float | None:
    """Return the least radius of the base circle without undercut, to six digits, or None."""
    size = max(made.prime, abs(made.pivot or 0.0), abs(made.offset), made.program.lift)
    low, high = made.base, made.base
    while not _is_sufficient(replace(made, base=high)):
        low, high = high, max(GROWTH * high, size / MOST)
        if high > MOST * size:
            return None
    return float(
        bisect_brackets(lambda base: _is_sufficient(replace(made, base=float(base))), high, low, HALVINGS, DIGITS)[0]
    )


def _is_sufficient(made: Synthesised) -> bool:
    if any(_dimension_problems(made)):
        return False
    curve, margins = _undercut_margin(made)
    return not any(np.any(margin(curve.samples.s) <= 0.0) for margin in margins)


def _rounded_up(value: float) -> str:
    """Return a number rounded up, to six digits."""
    step = 10.0 ** (np.floor(np.log10(value)) - 5)
    return f"{np.ceil(value / step) * step:.6g}"


def _degrees(angles: list[float]) -> str:
    return f"{', '.join(f'{np.rad2deg(a):.6g}' for a in angles)} degrees of the program"
