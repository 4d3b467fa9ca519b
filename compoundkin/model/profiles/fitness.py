"""Why no profile can be made for a motion program."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from compoundkin.base.arrays import LONGEST, TURN
from compoundkin.base.bracketing import bisected
from compoundkin.base.curves import Curve
from compoundkin.base.curves.samples import spans
from compoundkin.base.errors import Problem, nearest
from compoundkin.base.series import Number
from compoundkin.model.laws.motion_programs import Program
from compoundkin.model.laws.program_segments import turn_problems
from compoundkin.model.profiles.envelopes import Oscillating, reach

if TYPE_CHECKING:
    from compoundkin.model.profiles.synthesised import Synthesised

FOLLOWERS = ("knife", "roller", "flat")
# Spans of degrees add up to a full turn but for rounding.
ROUNDING = 1e-9
# A base circle that will do is looked for in these steps (an oscillating face allows but a range of them), from this
# part of the size of the mechanism up to this many times it; then by halving to six digits.
GROWTH = 1.1
MOST = 1e3
DIGITS = 1e-7
# Halving stops at the digits above long before this.
HALVINGS = 60

Span = tuple[float, float]


def faults(made: Synthesised) -> Iterator[Problem]:
    """Find what is wrong with the words: each with its key."""
    wrong = list(_numbers(made)) or list(_words(made))
    yield from wrong
    if not wrong:
        yield from _program(made)
        yield from _dimensions(made)


def _numbers(made: Synthesised) -> Iterator[Problem]:
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
    return known and bool(np.isfinite(value))


def _words(made: Synthesised) -> Iterator[Problem]:
    if not made.base > 0:
        yield Problem("base", f"a base circle cannot have the radius {made.base:g}", "give a positive length")
    if made.follower not in FOLLOWERS:
        yield Problem("follower", f"there is no follower {made.follower!r}", nearest(str(made.follower), FOLLOWERS))
    elif made.follower == "roller" and not made.roller > 0:
        yield Problem("roller", f"a roller cannot have the radius {made.roller:g}", "give a positive length")
    elif made.follower != "roller" and made.roller != 0:
        yield Problem("roller", f"a {made.follower} follower has no roller", 'write follower="roller"')
    if made.side not in (1, -1):
        yield Problem("side", f"{made.side!r} is not a side", "write 1 (rises counterclockwise) or -1 (clockwise)")
    if not isinstance(made.program, Program):
        remedy = "write laws.program(laws.rise(...), laws.dwell(...))"
        yield Problem("program", f"{made.program!r} is not a motion program", remedy)
    yield from _misplaced(made)


def _misplaced(made: Synthesised) -> Iterator[Problem]:
    """Words that belong to the other way of moving."""
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


def _program(made: Synthesised) -> Iterator[Problem]:
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


def _dimensions(made: Synthesised) -> Iterator[Problem]:
    """Find what cannot be assembled on the base circle, or at the greatest lift."""
    if made.pivot is None:
        if made.follower != "flat" and abs(made.offset) >= made.prime:
            what = f"an offset of {made.offset:g} does not meet the prime circle of radius {made.prime:g}"
            yield Problem("offset", what, f"take a base circle of more than {abs(made.offset) - made.roller:g}")
    elif made.pivot == 0:
        yield Problem("pivot", "it is on the axis of the cam", "move it")
    elif made.follower == "flat":
        yield from _face(made, abs(made.pivot))
    else:
        yield from _arm(made, *reach(made.pivot, made.arm))


def _arm(made: Synthesised, least: float, most: float) -> Iterator[Problem]:
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


def _face(made: Synthesised, apart: float) -> Iterator[Problem]:
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
    """Find a profile that would turn back on itself. Between which angles of the cam, and which base circle will do."""
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
    remedy = "no greater base circle mends it" if least is None else f"take a base circle of {_upwards(least)} or more"
    yield Problem("base", f"{what} at cam angles of {between} degrees", remedy)


def undercut_spans(made: Synthesised) -> tuple[Span, ...]:
    """Return the angles of the cam between which its profile would turn back."""
    curve, margins = _turning_back(made)
    found = (spans(curve.samples, 0.0, TURN, margin) for margin in margins)
    return next((between for between in found if between), ())


def _turning_back(made: Synthesised) -> tuple[Curve, tuple[Callable[[Number], Number], ...]]:
    """Return the curve that makes the profile, and what must be positive all along it."""
    envelope = made.envelope
    if made.follower == "flat":
        return envelope.faced(), (lambda s: -envelope.turning(s), envelope.radius)
    pitch = envelope.pitch()
    return pitch, (lambda s: 1.0 + made.roller * pitch.curvature(s),) if made.roller else ()


def least_base(made: Synthesised) -> float | None:
    """Return the least radius of the base circle without undercut, to six digits. None if none is found."""
    size = max(made.prime, abs(made.pivot or 0.0), abs(made.offset), made.program.lift)
    low, high = made.base, made.base
    while not _will_do(replace(made, base=high)):
        low, high = high, max(GROWTH * high, size / MOST)
        if high > MOST * size:
            return None
    return float(bisected(lambda base: _will_do(replace(made, base=float(base))), high, low, HALVINGS, DIGITS)[0])


def _will_do(made: Synthesised) -> bool:
    if any(_dimensions(made)):
        return False
    curve, margins = _turning_back(made)
    return not any(np.any(margin(curve.samples.s) <= 0.0) for margin in margins)


def _upwards(value: float) -> str:
    """Return a number rounded up, to six digits."""
    step = 10.0 ** (np.floor(np.log10(value)) - 5)
    return f"{np.ceil(value / step) * step:.6g}"


def _degrees(angles: list[float]) -> str:
    return f"{', '.join(f'{np.rad2deg(a):.6g}' for a in angles)} degrees of the program"
