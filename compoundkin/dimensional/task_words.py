"""Tasks of dimensional synthesis as users write them, in Python and in files, read into data with all checks.

Angles are radians in Python and degrees in files.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arguments import checked, planar_numbers, real_numbers
from compoundkin.base.arrays import LONGEST, SHORTEST, TURN, Number
from compoundkin.base.display import count_phrase, short_repr
from compoundkin.base.errors import InvalidInput, Problem, nearest, suggestion
from compoundkin.dimensional.tasks import (
    INPUT,
    OUTPUT,
    SAME,
    CurveTask,
    CurveTiming,
    DwellTask,
    FunctionTask,
    MixedTask,
    OutputTask,
    PointTask,
    PoseTask,
    StrokeTask,
    SwingTask,
    Task,
    TimedPointTask,
    check_finite,
    extent,
    places,
)
from compoundkin.model.geometry import FRAME
from compoundkin.model.validation import PRINTABLE, is_name

# An output that changes by less than this part of itself is constant.
ROUNDING = 1e-12
# A drawn curve has so many points at least; its ends meet within this part of its extent, or this part of its longest
# step: whoever samples a turn leaves the first point out at its end.
FEWEST_OF_CURVE, MEETING, NEXT = 8, 0.05, 1.2
# A function's error is seen at so many places of its range.
WHOLE = 181


def _check_body(link: Any) -> None:
    """Check that a body has a name of its own beside the links that guide it. Raises InvalidInput."""
    taken = (FRAME, INPUT, OUTPUT)
    if link in taken:
        raise InvalidInput(Problem("link", f"another link is called {link!r}", "give the body a name of its own"))
    if not isinstance(link, str) or not is_name(link):
        raise InvalidInput(Problem("link", f"{link!r} is not a name", PRINTABLE))


@checked
def poses(
    link: str,
    poses: Any,
    *,
    velocities: Any = None,
    accelerations: Any = None,
    links: int | None = None,
    tolerance: float = 0.0,
) -> PoseTask:
    """Return the task of motion generation: a body takes poses, three to five of them exactly.

    `poses` is (n, 3): the place of the body's origin and its angle in radians. `velocities` has (x, y, angular
    velocity) by the index of a pose; such a pose counts twice. `accelerations` likewise; it counts three times then.

    With `links`, 4 or 6, eight poses or more are samples of a course that the body goes along, at any speed: closed if
    its ends meet. Linkages of an atlas with at most so many links, whose crank turns fully, come as near as they can.

    Raises InvalidInput for equal poses, too few or too many of them.

    >>> poses("plate", [(0, 0, 0), (1, 0, 0.5), (1, 1, 1.0)]).in_words
    'plate through 3 poses'
    """
    _check_body(link)
    z, u = read_poses("poses", poses)
    if links is not None:
        return _course(link, z, u, links, bool(velocities or accelerations), _tolerance(tolerance))
    rates = {key: _twists(key, given, len(z)) for key, given in
             (("velocities", velocities), ("accelerations", accelerations))}  # fmt: skip
    lost = sorted(set(rates["accelerations"]) - set(rates["velocities"]))
    if lost:
        what = f"pose {lost[0]} has an acceleration without a velocity"
        raise InvalidInput(Problem("accelerations", what, "give its velocity too"))
    _different("poses", "pose", np.stack([z / extent(z), u], axis=-1))
    return PoseTask(link, z, u, rates["velocities"], rates["accelerations"], tolerance=_tolerance(tolerance))


def _course(link: str, z: Number, u: Number, links: int, has_rates: bool, tolerance: float) -> PoseTask:
    """Return the task of a body along a course. Raises InvalidInput for what is none."""
    if links not in (4, 6):
        raise InvalidInput(Problem("links", f"linkages of {links} links are not in the atlas", "take 4 or 6"))
    if has_rates:
        raise InvalidInput(Problem("velocities", "a course has its own", "leave them out, or leave links out"))
    kept = np.append(True, np.diff(z) != 0.0)
    z, u = z[kept], u[kept]
    if len(z) < FEWEST_OF_CURVE:
        what = f"{count_phrase(len(z), 'different place')}: too few for a course"
        raise InvalidInput(Problem("poses", what, f"give {FEWEST_OF_CURVE} or more, or leave links out"))
    closed = bool(abs(z[-1] - z[0]) <= max(MEETING * extent(z), NEXT * np.abs(np.diff(z)).max()))
    if closed and abs(z[-1] - z[0]) <= SAME * extent(z):
        z, u = z[:-1], u[:-1]
    return PoseTask(link, z, u, links=links, closed=closed, tolerance=tolerance)


@checked
def points(points: Any, *, at: Any = None, tolerance: float = 0.0) -> PointTask | TimedPointTask:
    """Return the task of path generation: a coupler point goes through points in this order, two to nine of them.

    `points` are complex or (n, 2). `at` gives the angles of the crank there (radians, only their differences count),
    for up to five points. Raises InvalidInput for equal points, or angles that are not one for each.

    >>> points([(0, 0), (1, 0.5), (2, 0)]).in_words
    'a point through 3 points'
    """
    found = places("points", points)
    if at is None:
        if len(found) < 2:
            raise InvalidInput(Problem("points", "there must be two or more"))
        _different("points", "point", (found / extent(found))[:, None])
        return PointTask(found, tolerance=_tolerance(tolerance))
    angles = real_numbers("at", at)
    if angles.shape != found.shape:
        what = f"{count_phrase(angles.size, 'angle')} for {count_phrase(len(found), 'point')}"
        raise InvalidInput(Problem("at", what, "give one for each point"))
    _different("at", "crank angle", np.exp(1j * angles)[:, None])
    check_finite("at", angles)
    return TimedPointTask(found, angles, tolerance=_tolerance(tolerance))


@checked
def curve(
    points: Any, *, at: Any = None, times: Any = None, closed: bool | None = None, links: int = 6,
    tolerance: float = 0.0,
) -> CurveTask:  # fmt: skip
    """Return the task of a point that traces a drawn curve; the nearest linkages are found, and how far off they are.

    `points` are complex or (n, 2), eight or more along the curve, joined by straight lines. It is `closed` if its ends
    meet, within a twentieth of its extent or about as near as points follow each other, unless this is said; an open
    one is traced by a part of the driver's turn.
    With any timing, unless the points are those `at` angles of the driver (radians, from any zero, rising where it
    turns counterclockwise), or at `times` of a driver that turns evenly, either way. A closed curve takes a whole turn:
    its last point is the first again, or the last time is followed by a step that is the mean of the others.
    Linkages have four, six or eight `links`; their driver turns fully.
    Within a `tolerance`, the mean distance, or as near as they come.
    Raises InvalidInput for too few points, other numbers of links, and angles or times that go back and forth.

    >>> curve(np.exp(1j * np.linspace(0, 6, 30)) * (2 + np.cos(np.linspace(0, 12, 30)))).in_words
    'a point along an open curve of 30 points'
    """
    found = places("points", points)
    if links not in (4, 6, 8):
        raise InvalidInput(Problem("links", f"linkages of {links} links are not in the atlas", "take 4, 6 or 8"))
    moving = np.concatenate([found[:1], found[1:][np.diff(found) != 0.0]])
    if len(moving) < FEWEST_OF_CURVE:
        what = f"{count_phrase(len(moving), 'different point')}: too few for a curve"
        raise InvalidInput(Problem("points", what, f"give {FEWEST_OF_CURVE} or more, or take the task `points`"))
    if not SHORTEST <= extent(moving) <= LONGEST:
        what = f"the curve has an extent of {extent(moving):g}"
        raise InvalidInput(Problem("points", what, "choose another unit: lengths are between 1e-50 and 1e50 of it"))
    meets = abs(moving[-1] - moving[0]) <= max(MEETING * extent(moving), NEXT * np.abs(np.diff(moving)).max())
    is_closed = bool(meets if closed is None else closed)
    is_timed = at is not None or times is not None
    timing = _timing(at, times, found, is_closed) if is_timed else None
    found = found if is_timed else moving
    if is_closed and found[-1] == found[0]:
        found = found[:-1]
    return CurveTask(found, is_closed, links, timing, tolerance=_tolerance(tolerance))


def _timing(at: Any, times: Any, points: Number, closed: bool) -> CurveTiming:
    """Return when points are reached, of angles or times for each. Raises InvalidInput for what is no timing."""
    if at is not None and times is not None:
        raise InvalidInput(Problem("times", "angles are given too", "leave out at or times"))
    where = "times" if at is None else "at"
    values = real_numbers(where, times if at is None else at)
    if values.shape != (len(points),):
        what = f"{count_phrase(values.size, 'number')} for {count_phrase(len(points), 'point')}"
        raise InvalidInput(Problem(where, what, "give one for each point"))
    check_finite(where, values)
    steps = np.diff(values)
    if not (np.all(steps > 0.0) or (at is not None and np.all(steps < 0.0))):
        k = int(np.flatnonzero(steps * np.sign(steps[0] if at is not None else 1.0) <= 0.0)[0])
        raise InvalidInput(
            Problem(f"{where}[{k + 1}]", "it does not follow the one before", "give them in their order")
        )
    again = closed and points[-1] == points[0]
    long = float(values[-1] - values[0])
    whole = long if again or not closed else long + long / len(steps)
    if at is not None:
        if abs(long) > TURN * (1.0 + SAME):
            raise InvalidInput(
                Problem(
                    where,
                    f"{np.rad2deg(abs(long)):.6g} degrees are more than a turn",
                    "they are radians, in files degrees",
                )
            )
        if not closed and abs(long) > TURN * (1.0 - SAME):
            what = "an open curve takes less than a turn: after one its point is where it began"
            raise InvalidInput(Problem(where, what, "leave out closed, or give less"))
        whole = float(np.copysign(TURN, long)) if closed else long
    parts = (values - values[0]) / whole
    return CurveTiming(parts[:-1] if again else parts, whole if at is not None else TURN * closed, at is None)


@checked
def mixed(*, poses: Any, points: Any, link: str = "coupler", tolerance: float = 0.0) -> MixedTask:
    """Return the task of a body through poses and its origin through points (Alt-Burmester).

    `poses` is (m, 3) with angles in radians, `points` complex or (n, 2); 2 m + n is ten at most. Raises InvalidInput
    for equal ones.

    >>> mixed(poses=[(0, 0, 0), (1, 0, 0.5)], points=[(2, 1)]).in_words
    'coupler through 2 poses and 1 point'
    """
    _check_body(link)
    z, u = read_poses("poses", poses)
    found = places("points", points)
    every = np.concatenate([z, found])
    _different("points", "place", (every / extent(every))[:, None])
    return MixedTask(link, z, u, found, tolerance=_tolerance(tolerance))


@checked
def function(
    pairs: Any,
    *,
    between: Any = None,
    inputs: Any = None,
    outputs: Any = None,
    count: int = 3,
    linkage: str = "four-bar",
    absolute: bool = False,
    links: int | None = None,
    tolerance: float = 0.0,
) -> FunctionTask:
    """Return the task of function generation: pairs (n, 2) of an input angle and an output.

    Or `pairs` is a Python function of an array: its argument `between` two numbers becomes the input's angle between
    those of `inputs`, its value the output between those of `outputs`. It is met at `count` places in Chebyshev's
    spacing, and the error counts over the whole range.

    `linkage` is "four-bar" (output an angle), "slider-crank" (a displacement) or "inverted" (the angle of a swinging
    guide); angles are radians. Only differences of angles and displacements count, unless they are `absolute`: angles
    from the line of fixed pivots then, displacements from the crank's pivot. Three pairs are met by `absolute` ones,
    up to five by others; more, and all with a `tolerance`, are approached.

    With `links`, 4 or 6, eight pairs or more are samples of a function, over a whole turn or a part of it, with gaps
    where nothing is wanted. Linkages of an atlas with at most so many links follow it, whose crank turns fully:
    the output is a link that swings, or with "slider-crank" a slide. Dwells and strokes of even speed are of this
    kind.

    >>> function([(0, 0), (0.5, 0.3), (1, 0.8)]).in_words
    'a four-bar function of 3 pairs'
    >>> log = function(np.log10, between=(1, 10), inputs=np.deg2rad([45, 105]), outputs=np.deg2rad([45, 135]))
    >>> np.rad2deg(log.inputs).round(2).tolist()
    [49.02, 75.0, 100.98]
    """
    known = ("four-bar", "slider-crank", "inverted")
    if linkage not in known:
        raise InvalidInput(Problem("linkage", f"{linkage!r} generates no function", f"one of {', '.join(known)}"))
    found, whole = _read_pairs(pairs, between, inputs, outputs, count)
    if links is not None:
        found, whole = _samples(found if whole is None else whole, links, linkage, absolute), None
    _different("pairs", "input", np.exp(1j * found[:, :1]))
    x, y = found.T
    return FunctionTask(x, y, linkage, absolute, whole, links or 0, tolerance=_tolerance(tolerance))


def _read_pairs(pairs: Any, between: Any, inputs: Any, outputs: Any, count: int) -> tuple[Number, Number | None]:
    """Return pairs, and those over the whole range of a Python function. Raises InvalidInput for what are none."""
    whole = None
    if callable(pairs):
        pairs, whole = _tabulated(pairs, between, inputs, outputs, count)
    elif not (between is None and inputs is None and outputs is None):
        what = "ranges belong to a Python function, not to pairs"
        raise InvalidInput(Problem("between, inputs, outputs", what, "leave them out"))
    found = real_numbers("pairs", pairs)
    if found.ndim != 2 or found.shape[1] != 2 or len(found) < 3:
        raise InvalidInput(Problem("pairs", "they are no three or more pairs", "give (input, output) for each"))
    check_finite("pairs", found)
    return found, whole


def _samples(pairs: Number, links: int, linkage: str, absolute: bool) -> Number:
    """Return the samples of a function without the end of a whole turn. Raises InvalidInput for what is no function."""
    if links not in (4, 6):
        raise InvalidInput(Problem("links", f"linkages of {links} links are not in the atlas", "take 4 or 6"))
    if linkage == "inverted" or absolute:
        what = "linkages of the atlas have no absolute angles and no swinging guide"
        raise InvalidInput(Problem("links", what, 'leave links out, or take "four-bar" or "slider-crank"'))
    if len(pairs) < FEWEST_OF_CURVE:
        what = f"{count_phrase(len(pairs), 'pair')} are no samples of a function"
        raise InvalidInput(Problem("pairs", what, f"give {FEWEST_OF_CURVE} or more, or leave links out"))
    ordered = pairs[np.argsort(pairs[:, 0], kind="stable")]
    around, stroke = ordered[-1, 0] - ordered[0, 0], float(np.ptp(ordered[:, 1]))
    if stroke <= ROUNDING * float(np.abs(ordered[:, 1]).max()):
        raise InvalidInput(Problem("pairs", "the output does not move", "a function has different outputs"))
    if linkage != "slider-crank" and stroke > TURN:
        what = f"the output swings by {np.rad2deg(stroke):.6g} degrees, more than a turn"
        raise InvalidInput(
            Problem(
                "pairs", what, 'angles are radians, in files degrees; displacements are of linkage = "slider-crank"'
            )
        )
    if around > 2.0 * np.pi * (1.0 + SAME):
        raise InvalidInput(Problem("pairs", "they go beyond a turn", "give inputs within one turn"))
    if around > 2.0 * np.pi * (1.0 - SAME):
        if abs(ordered[-1, 1] - ordered[0, 1]) > MEETING * stroke:
            raise InvalidInput(Problem("pairs", "after a turn the output is another", "it is the same after each turn"))
        ordered = ordered[:-1]
    return ordered


def _tabulated(law: Any, between: Any, inputs: Any, outputs: Any, count: int) -> tuple[Number, Number]:
    """Return the pairs of a function at Chebyshev's places, and over its whole range. Raises InvalidInput."""
    ranges = {}
    for name, given in (("between", between), ("inputs", inputs), ("outputs", outputs)):
        if given is None:
            raise InvalidInput(Problem(name, "a Python function needs this range", "give its first and last value"))
        found = real_numbers(name, given)
        if found.shape != (2,) or not np.isfinite(found).all() or found[0] == found[1]:
            raise InvalidInput(Problem(name, "it is no range", "give the first and the last value"))
        ranges[name] = found
    if count < 3:
        raise InvalidInput(Problem("count", f"{count} precision positions are too few", "give three or more"))
    low, high = ranges["between"]
    parts = []
    for x in (chebyshev_spacing(low, high, count), np.linspace(low, high, WHOLE)):
        try:
            y = real_numbers("pairs", law(np.array([low, *x, high])))
        except (TypeError, ValueError, ArithmeticError) as problem:
            raise InvalidInput(Problem("pairs", f"the function fails: {problem}")) from None
        if y.shape != (len(x) + 2,) or not np.isfinite(y).all() or abs(y[-1] - y[0]) <= SAME * np.ptp(y):
            what = "the function gives no finite value at each place, or the same at both ends"
            raise InvalidInput(Problem("pairs", what, "it takes an array, and its ends differ"))
        phi = np.interp((x - low) / (high - low), (0, 1), ranges["inputs"])
        start, end = ranges["outputs"]
        parts.append(np.stack([phi, start + (end - start) * (y[1:-1] - y[0]) / (y[-1] - y[0])], axis=-1))
    return parts[0], parts[1]


def chebyshev_spacing(low: float, high: float, count: int) -> Number:
    """Return places between two numbers such that the error of what agrees there is spread evenly (Chebyshev).

    >>> chebyshev_spacing(1, 10, 3).round(6).tolist()
    [1.602886, 5.5, 9.397114]
    """
    angles = (2 * np.arange(count) + 1) * np.pi / (2 * count)
    found: Number = (low + high) / 2.0 - (high - low) / 2.0 * np.cos(angles)
    return found


@checked
def output(linkage: Any, angles: Any, *, pivot: Any, tolerance: float = 0.0) -> OutputTask:
    """Return the task of a dyad added to a solved linkage: a second output takes angles at its positions (radians).

    It turns about `pivot`, (x, y) or complex; equal angles at neighbouring positions are a dwell. Raises InvalidInput
    unless there is one angle for each of three to five positions.
    """
    if not hasattr(linkage, "candidate"):
        what = f"{short_repr(linkage)} is no solved linkage"
        raise InvalidInput(Problem("linkage", what, "an answer of synthesise() has them: answer[0]"))
    found = real_numbers("angles", angles)
    given = planar_numbers("pivot", pivot)
    place = places("pivot", given[None] if given.shape in ((), (2,)) else given)
    count = len(next(iter(linkage.candidate.z.values())))
    if found.shape != (count,) or not 3 <= count <= 5:
        what = f"{count_phrase(found.size, 'angle')} for a linkage at {count} positions"
        raise InvalidInput(Problem("angles", what, "give one for each of three to five"))
    check_finite("angles", found)
    if len(place) != 1:
        raise InvalidInput(Problem("pivot", "it is no place", "give (x, y) or a complex number"))
    return OutputTask(linkage, found, complex(place[0]), tolerance=_tolerance(tolerance))


@checked
def dwell(swing: float, *, dwells: Any, tolerance: float = 0.0) -> DwellTask:
    """Return the task of a six-bar whose output swings by an angle and rests at both ends (radians).

    `dwells` are two angles by which the crank turns meanwhile; a `tolerance` is the angle by which the output may move.

    >>> dwell(np.deg2rad(30), dwells=np.deg2rad([60, 40])).in_words
    'a swing of 30 degrees with dwells of 60 and 40'
    """
    if not 0.0 < swing < np.pi:
        raise InvalidInput(Problem("swing", f"a swing of {swing:g} is not possible", "give 0 to pi"))
    found = real_numbers("dwells", dwells)
    if found.shape != (2,) or not np.all((found > 0.0) & (found < np.pi)):
        raise InvalidInput(Problem("dwells", "they are no two angles of the crank", "give two between 0 and pi"))
    return DwellTask(float(swing), (float(found[0]), float(found[1])), tolerance=_tolerance(tolerance))


@checked
def swing(angle: float, *, time_ratio: float = 1.0) -> SwingTask:
    """Return the task of a crank-rocker: its rocker swings by `angle` (radians).

    `time_ratio` is the longer time of a swing by the shorter, 1 or more. Raises InvalidInput for a swing or a ratio
    that no crank-rocker has.

    >>> swing(np.pi / 4, time_ratio=1.2).in_words
    'a swing of 45 degrees in the time ratio 1.2'
    """
    if not 0.0 < angle < np.pi:
        raise InvalidInput(Problem("angle", f"a swing of {angle:g} is not possible", "give 0 to pi"))
    return SwingTask(float(angle), _time_ratio(time_ratio))


@checked
def stroke(
    length: float, *, time_ratio: float = 1.0, linkage: str = "slider-crank", offset: float | None = None
) -> StrokeTask:
    """Return the task of a slide of stroke `length`, whose longer time of a stroke by the shorter is `time_ratio`.

    `linkage` is "slider-crank", with the `offset` of its guide from the crank's pivot if given, or "crank-shaper".

    >>> stroke(100, time_ratio=1.25, offset=40).in_words
    'a slider-crank of stroke 100 in the time ratio 1.25'
    """
    known = ("slider-crank", "crank-shaper")
    if linkage not in known:
        raise InvalidInput(Problem("linkage", f"{linkage!r} has no stroke", f"one of {', '.join(known)}"))
    if not 0.0 < length < np.inf:
        raise InvalidInput(Problem("length", f"a stroke of {length:g} is not possible", "give a length above zero"))
    if offset is not None and not 0.0 <= offset < np.inf:
        raise InvalidInput(Problem("offset", f"an offset of {offset:g} is not possible", "give zero or more"))
    return StrokeTask(float(length), _time_ratio(time_ratio), linkage, offset)


def read_poses(where: str, given: Any) -> tuple[Number, Number]:
    """Return the origins and orientations of poses (x, y, angle). Raises InvalidInput."""
    found = real_numbers(where, given)
    if found.ndim != 2 or found.shape[1] != 3 or len(found) < 1:
        raise InvalidInput(Problem(where, "these are no poses", "give (x, y, angle in radians) for each"))
    check_finite(where, found)
    return found[:, 0] + 1j * found[:, 1], np.exp(1j * found[:, 2])


def _twists(where: str, given: Any, count: int) -> dict[int, tuple[complex, float]]:
    """Return twists by the index of their pose."""
    found = dict[int, tuple[complex, float]]()
    if given is None:
        return found
    if not isinstance(given, Mapping):
        raise InvalidInput(Problem(where, "they are no table by the index of a pose", "write {0: (x, y, angular)}"))
    for index, twist in given.items():
        if isinstance(index, bool) or not isinstance(index, int) or not 0 <= index < count:
            raise InvalidInput(Problem(where, f"there is no pose {index!r}", f"they are 0 to {count - 1}"))
        numbers = real_numbers(f"{where}[{index}]", twist)
        if numbers.shape != (3,) or not np.isfinite(numbers).all() or not numbers.any():
            raise InvalidInput(Problem(f"{where}[{index}]", "it is no twist", "give (x, y, angular), not all zero"))
        found[index] = complex(numbers[0], numbers[1]), float(numbers[2])
    return dict(sorted(found.items()))


def _different(where: str, noun: str, rows: Number) -> None:
    """Raise InvalidInput for two rows of complex numbers that are equal."""
    from scipy.spatial import KDTree

    tree = KDTree(np.hstack([rows.real, rows.imag]))
    equal = min(tree.query_pairs(SAME, p=np.inf), default=None)
    if equal is not None:
        what = f"{noun} {equal[0]} and {noun} {equal[1]} are equal"
        near = "; a pose infinitely near is written as a velocity" if where == "poses" else ""
        raise InvalidInput(Problem(where, what, f"leave one out{near}"))


def _tolerance(tolerance: float) -> float:
    if not 0.0 <= tolerance < np.inf:
        raise InvalidInput(Problem("tolerance", f"{tolerance:g} is no tolerance", "give zero or more"))
    return float(tolerance)


def _time_ratio(ratio: float) -> float:
    if not 0.0 < ratio < np.inf:
        raise InvalidInput(Problem("time_ratio", f"{ratio:g} is no ratio of times", "give 1 or more"))
    return float(max(ratio, 1.0 / ratio))


FORMAT = 1


class _TaskOfFile(NamedTuple):
    """A kind of task in files: its function, the keys that must be there, and those that may be left out."""

    make: Callable[..., Task]
    needed: tuple[str, ...]
    optional: tuple[str, ...]


# Numbers that are angles are degrees in files.
_KINDS: Mapping[str, _TaskOfFile] = {
    "poses": _TaskOfFile(poses, ("link", "poses"), ("velocities", "accelerations", "links", "tolerance")),
    "points": _TaskOfFile(points, ("points",), ("at", "tolerance")),
    "mixed": _TaskOfFile(mixed, ("poses", "points"), ("link", "tolerance")),
    "curve": _TaskOfFile(curve, ("points",), ("at", "times", "closed", "links", "tolerance")),
    "function": _TaskOfFile(function, ("pairs",), ("linkage", "absolute", "links", "tolerance")),
    "swing": _TaskOfFile(swing, ("angle",), ("time_ratio",)),
    "stroke": _TaskOfFile(stroke, ("length",), ("time_ratio", "linkage", "offset")),
    "dwell": _TaskOfFile(dwell, ("swing", "dwells"), ("tolerance",)),
}
# The keys of each kind, and those of conditions.
KEYS: Mapping[str, tuple[str, ...]] = {kind: (*one.needed, *one.optional) for kind, one in _KINDS.items()}
CONDITIONS = ("region", "lengths", "ground", "transmission", "turning", "prefer", "obstacles")


def read_task(document: Mapping[str, Any]) -> tuple[Task, dict[str, Any]]:
    """Return the task of a document, and the conditions as arguments of `synthesise`. Angles are degrees.

    Raises InvalidInput for keys that do not belong there, with the nearest there is, and what the tasks raise.

    >>> read_task({"format": 1, "task": "swing", "angle": 45, "conditions": {"transmission": 30}})[0].in_words
    'a swing of 45 degrees in the time ratio 1'
    """
    kind: Any = document.get("task")
    if document.get("format") != FORMAT:
        raise InvalidInput(Problem("format", "it is no known version of the format", f"write format = {FORMAT}"))
    if not isinstance(kind, str) or kind not in _KINDS:
        known = list(_KINDS)
        near = f"{suggestion(kind, known)} " if nearest(kind, known) else ""
        raise InvalidInput(Problem("task", f"{short_repr(kind)} is no task", f"{near}one of {', '.join(known)}"))
    make, needed, optional = _KINDS[kind]
    given = {key: value for key, value in document.items() if key not in ("format", "task", "conditions")}
    _known("", given, (*needed, *optional))
    said = document.get("conditions", {})
    if not isinstance(said, Mapping):
        raise InvalidInput(Problem("conditions", "it is no table", "write [conditions], then a line for each"))
    _known("conditions.", said, CONDITIONS)
    conditions = dict(said)
    if "transmission" in conditions:
        least = _radians(where := "conditions.transmission", conditions["transmission"])
        if not isinstance(least, float) or not 0.0 <= least < np.pi / 2.0:
            what = f"{short_repr(conditions['transmission'])} is no transmission angle"
            raise InvalidInput(Problem(where, what, "write degrees, from 0 to 90"))
        conditions["transmission"] = least
    missing = next((key for key in needed if key not in given), None)
    if missing is not None:
        raise InvalidInput(Problem(missing, "it is missing", f"a task of {kind} needs {', '.join(needed)}"))
    return make(**_in_radians(kind, given)), conditions


def _known(where: str, given: Mapping[str, Any], known: Sequence[str]) -> None:
    for key in given:
        if key not in known:
            raise InvalidInput(Problem(f"{where}{key}", "there is no such key", suggestion(key, list(known))))


def _in_radians(kind: str, given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the arguments of a task with its angles in radians."""
    found = dict(given)
    if "poses" in found:
        found["poses"] = _last_in_radians("poses", found["poses"])
    for key in ("velocities", "accelerations"):
        if isinstance(found.get(key), Mapping):
            found[key] = {_index(key, name): _last_in_radians(key, [twist])[0] for name, twist in found[key].items()}
    for key in ("at", "angle", "swing", "dwells"):
        if key in found:
            found[key] = _radians(key, found[key])
    if kind == "function":
        pairs = real_numbers("pairs", found["pairs"])
        angular = found.get("linkage", "four-bar") != "slider-crank"
        found["pairs"] = pairs * np.deg2rad(1.0) if angular else pairs * np.array([np.deg2rad(1.0), 1.0])
    return found


def _radians(where: str, value: Any) -> Number | float:
    found = np.deg2rad(real_numbers(where, value))
    return found if found.ndim else float(found)


def _last_in_radians(where: str, given: Any) -> Number:
    found = real_numbers(where, given).copy()
    if found.ndim != 2 or found.shape[1] != 3:
        raise InvalidInput(Problem(where, "they are not three numbers each", "write [x, y, degrees]"))
    found[:, 2] = np.deg2rad(found[:, 2])
    return found


def _index(where: str, name: str) -> int:
    if not name.isdecimal():
        raise InvalidInput(Problem(f"{where}.{name}", "it is no index of a pose", "write 0 = [x, y, degrees]"))
    return int(name)
