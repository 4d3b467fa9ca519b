"""The drivers' path: from the drawn pose both ways through every value that a motion asks for, by arc length.

It knows no poses: how often, in which order and how far apart they are asked for does not change it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.arrays import TURN, Number, ascending, whole_turns
from compoundkin.base.poses import Pose
from compoundkin.base.series import constant
from compoundkin.kinematics.block import between_poses, picked, picked_slope, slope
from compoundkin.kinematics.driver_values import Inputs
from compoundkin.kinematics.solving_order import SolvingOrder

# One place: so far a driver goes (radians of an angle, or parts of the size of a length).
SPACING = np.pi / 36.0
# No driver of a length goes more places in one piece: a block may travel far on a mechanism whose own dimensions are
# tiny.
MOST = 1000
# Places nearer to each other than this are one: a double root is known to the square root of rounding.
CLOSE = 1e-6
# Places nearer to each other than this are one but for rounding, of the drivers' values and of the double root.
SAME = 2e-12
# Values of several drivers lie on a line if they are aside of it by no more than this part of its length.
ASIDE = 1e-12
# A driver of a length has at least so many samples each way: the mechanism's size, by which they are spaced, may be
# that of a chain of many short links.
FEWEST = 12
# Where dimensions change along the motion a pose is at least so many places from the next one.
APART = 1.0


@dataclass(frozen=True)
class DriverPath:
    """The path, through knots between which all drivers go straight.

    `knots` are its inputs, designs x knots, at the increasing `places`, a SPACING of the fastest driver apart from each
    other; at `home` the mechanism is as it is drawn. Where it `wraps`, values that differ by a whole turn are the same
    pose. Each way from home has `fewest` samples.
    """

    knots: Inputs
    places: Number
    home: float
    wraps: bool = False
    fewest: int = 1

    @property
    def designs(self) -> int:
        """How many designs there are."""
        return self.knots.designs

    @property
    def ends(self) -> tuple[float, float]:
        """The first and the last place."""
        return float(self.places[0]), float(self.places[-1])

    @property
    def moving(self) -> tuple[str, ...]:
        """The drivers that move along it."""
        return tuple(name for name, (value, *_) in self.knots.drives.items() if np.shape(value)[1:] > (1,))

    @property
    def period(self) -> float:
        """After how many places the drivers are at the same pose again; infinite where they never are."""
        return TURN / SPACING if self.wraps else np.inf

    @cached_property
    def samples(self) -> Number:
        """Places no farther than one from each other, with all knots and the home."""
        if len(self.places) == 1:
            return self.places
        knots = ascending(self.places, [self.home])
        lengths = np.diff(knots)
        sides = np.where(knots[1:] > self.home, knots[-1] - self.home, self.home - knots[0])
        counts = np.maximum(np.ceil(np.maximum(lengths, self.fewest * lengths / sides) - CLOSE).astype(int), 1)
        pieces = zip(knots[:-1], knots[1:], counts, strict=True)
        return np.append(np.concatenate([np.linspace(a, b, n, endpoint=False) for a, b, n in pieces]), knots[-1])

    @property
    def samples_of_a_turn(self) -> Number:
        """The samples up to a turn and a place from home where the path wraps, which tell of all turns; else all."""
        away, turn = np.abs(self.samples - self.home), self.period + 1.0
        return self.samples[away <= turn] if np.max(away) > turn else self.samples

    def at_home(self) -> Inputs:
        """Return the inputs of the drawn pose, which is a knot or lies between two."""
        k = int(np.searchsorted(self.places, self.home))
        if self.places[k] == self.home:
            return self.knots.cut(slice(None), slice(k, k + 1)).of_poses(1)
        return self.at(np.array([self.home])).of_poses(1)

    def at(self, places: Number, backward: bool = False) -> Inputs:
        """Return the inputs of all designs at places (n,). Speeds are by the place, of the way on or of that to it."""
        i, weight = self._interval(places, "left" if backward else "right")
        here = partial(between_poses, i=i, weight=weight)
        return self._made(here, lambda v: _by_place(slope(v, i), self._lengths(i))).of_poses(len(places))

    def pick(self, designs: Number, places: Number) -> Inputs:
        """Return the inputs of some designs, each at its own place, as a column. The speeds are those of the way on."""
        return self._picked(designs, *self._interval(places, "right"))

    def behind(self, designs: Number, places: Number) -> Inputs:
        """Do as `pick`, with the speeds of the way to each place."""
        return self._picked(designs, *self._interval(places, "left"))

    def onward(self, solving_order: SolvingOrder, designs: Number, places: Number) -> tuple[Number, Number]:
        """Return the steps (n, drivers), in pure numbers, by which drivers go on from places, and +1.

        At the end of the path they are those that lead back, and -1. A path of one knot goes on as the drivers grow.
        """
        if len(self.places) == 1:
            return np.ones((len(places), len(self.knots.drives))), np.ones(len(places))
        steps = _speeds(solving_order, self.pick(designs, places), len(places))
        back = -_speeds(solving_order, self.behind(designs, places), len(places))
        # where a design rests or the path ends, the other way; where it rests both ways, as the drivers grow
        ends = (places >= self.places[-1] - CLOSE) | ~np.any(steps != 0.0, axis=-1)
        found = np.where(ends[:, None], back, steps)
        rests = ~np.any(found != 0.0, axis=-1)
        return np.where(rests[:, None], 1.0, found), np.where(ends & ~rests, -1.0, 1.0)

    def around(self) -> DriverPath:
        """Return the path of a driver that wraps, a whole turn both ways from home."""
        (name,) = self.moving
        first, last = self.ends
        ends = min(first, self.home - self.period), max(last, self.home + self.period)
        places = np.unique([ends[0], first, self.home, last, ends[1]])
        i, weight = self._interval(places, "right")
        drives = {**self.knots.drives, name: (between_poses(self.knots.drives[name][0], i, weight),)}
        return replace(self, knots=self.knots.driven(drives).of_poses(len(places)), places=places)

    def _interval(self, places: Number, side: str) -> tuple[Number, Number]:
        """Return the knot before each place, and the share of the way to the next one."""
        if len(self.places) == 1:
            return np.zeros(len(places), dtype=int), np.zeros(len(places))
        after = np.searchsorted(self.places, places, side=side)  # type: ignore[call-overload]
        i = np.clip(after - 1, 0, len(self.places) - 2)
        return i, (places - self.places[i]) / self._lengths(i)

    def _lengths(self, i: Number) -> Number:
        return self.places[i + 1] - self.places[i] if len(self.places) > 1 else np.ones(len(i))

    def _picked(self, designs: Number, i: Number, weight: Number) -> Inputs:
        here = partial(picked, designs=designs, i=i, weight=weight)
        length = self._lengths(i)[:, None]
        return self._made(here, lambda v: _by_place(picked_slope(v, designs, i), length))

    def _made(self, here: Callable[[Number], Number], rate: Callable[[Number], Number]) -> Inputs:
        drives = {name: (here(v), rate(v)) for name, (v, *_) in self.knots.drives.items()}
        return self.knots.with_dimensions(here).driven(drives)


def _by_place(change: Number, length: Number) -> Number:
    """Return a change from knot to knot by the place; that of a driver that rests is a number."""
    return change / length if np.ndim(change) else change


def _speeds(solving_order: SolvingOrder, part: Inputs, count: int) -> Number:
    """Return the drivers' speeds as pure numbers, (count, drivers)."""
    columns = [
        np.broadcast_to(v[1] / solving_order.unit_in(part.ends, name), (count, 1)) for name, v in part.drives.items()
    ]
    return np.concatenate(columns, axis=-1)


class PosePlaces(NamedTuple):
    """The places of a motion's poses on a path, (1 or designs, poses).

    Where the drawn pose lies beside the way of the poses, the path leaves it at the place `stem`, goes to the drawn
    pose and returns after `length` places: `places` beyond it are told without them.
    """

    places: Number
    stem: float = np.inf
    length: float = 0.0

    def at(self, designs: Number, s: Number) -> Number:
        """Return the places on the path of places `s` along the motion, between poses too."""
        count = self.places.shape[1]
        i = np.clip(np.floor(s).astype(int), 0, max(count - 2, 0))
        rows = designs if len(self.places) > 1 else 0 * designs
        here = self.places[rows, i]
        if count > 1:
            weight = s - i
            here = here * (1.0 - weight) + self.places[rows, i + 1] * weight
        return self.unfolded(here)

    def unfolded(self, places: Number) -> Number:
        """Return places on the path from those that are told without the stem."""
        return places if self.length == 0.0 else np.where(places > self.stem, places + self.length, places)

    @property
    def of_poses(self) -> Number:
        """The places on the path of all poses."""
        return self.unfolded(self.places)


# A path, and where a motion's poses are on it.
PathOfPoses: TypeAlias = tuple[DriverPath, PosePlaces]


def driver_path(
    solving_order: SolvingOrder, given: Inputs, drawn: Mapping[str, Pose], sketch: Mapping[str, Number]
) -> PathOfPoses:
    """Return the path of a motion's drivers, from where they are drawn.

    Values of one driver, or of several on a line, make a straight path, however they are asked for; others are joined
    in their order.
    """
    path, poses = _path(solving_order, given, drawn, sketch)
    angles = solving_order.structure.driven_angles
    return replace(path, fewest=1 if all(angles[name] for name in path.moving) else FEWEST), poses


def _path(
    solving_order: SolvingOrder, given: Inputs, drawn: Mapping[str, Pose], sketch: Mapping[str, Number]
) -> PathOfPoses:
    shown = {name: drawn_value(solving_order, given, name, drawn, sketch) for name in solving_order.structure.driven}
    values = {name: value for name, value in shown.items() if value is not None}
    if given.is_rigid:
        moving = [name for name, (value, *_) in given.drives.items() if _varies(value)]
        if len(moving) == 1 and all(name in moving for name in values):
            return _of_one_driver(solving_order, given, moving[0], values.get(moving[0]))
        line = _line(solving_order, given, moving, values)
        if line is not None:
            return line
    return _polyline(solving_order, given, values)


def _varies(value: Number) -> bool:
    return np.ndim(value) > 1 and value.shape[1] > 1 and bool(np.any(value != value[:, :1]))


def _of_one_driver(solving_order: SolvingOrder, given: Inputs, name: str, drawn: Number | None) -> PathOfPoses:
    """Return the path of the only driver that moves: from its least value to its greatest, with the drawn one."""
    value = given.drives[name][0]
    low, high = value.min(axis=1, keepdims=True), value.max(axis=1, keepdims=True)
    is_angle = solving_order.structure.driven_angles[name]
    home = value[:, :1] if drawn is None else drawn + np.zeros_like(low)
    if drawn is not None and is_angle:
        home = home + _turns_into(home, low, high)
    unit = SPACING * _unit(solving_order, given, name, len(home)) * np.where(_falls(value), -1.0, 1.0)[:, None]
    away = (value - home) / unit
    one, two = (low - home) / unit, (high - home) / unit
    begin, end = np.minimum(np.minimum(one, two), 0.0), np.maximum(np.maximum(one, two), 0.0)
    # an end that is at home but for rounding is home
    far = (-float(begin.min()), float(end.max()))
    if is_angle:
        ends = [(-far[0], home - unit * far[0]), (0.0, home), (far[1], home + unit * far[1])]
    else:
        # lengths of each design go their own way, each in as many places
        far = (min(far[0], MOST), min(far[1], MOST))
        ends = [(-far[0], home + unit * begin), (0.0, home), (far[1], home + unit * end)]
        one, two = (np.divide(a, b, out=np.zeros_like(b), where=b != 0.0) for a, b in ((-far[0], begin), (far[1], end)))
        away = away * np.where(away < 0.0, one, two)
    kept = [knot for k, knot in enumerate(ends) if k == 1 or abs(knot[0]) > CLOSE]
    knots = _first(given).driven({**_first_drives(given), name: (np.concatenate([v for _, v in kept], axis=1),)})
    places = np.array([place for place, _ in kept])
    path = DriverPath(knots.of_poses(len(kept)), places, 0.0, is_angle and not solving_order.turning)
    return path, PosePlaces(away)


def _unit(solving_order: SolvingOrder, given: Inputs, name: str, rows: int) -> Number:
    """Return by how much a driver goes where it goes far; of designs that share one row, where the least does."""
    unit = solving_order.unit_in(given.ends, name)
    return float(np.min(unit)) if rows == 1 else unit


def _falls(value: Number) -> Number:
    """Return for which designs a driver's values fall, from the first to the last, or else to the first other one."""
    change = value[:, -1] - value[:, 0]
    if np.all(change != 0.0):
        return change < 0.0
    first = np.argmax(value != value[:, :1], axis=1)
    return np.where(change != 0.0, change, value[np.arange(len(value)), first] - value[:, 0]) < 0.0


def _turns_into(home: Number, low: Number, high: Number) -> Number:
    """Return the whole turns that bring angles into ranges, or nearest to them; none where they lie in them."""
    below, above = np.ceil((low - home) / TURN - CLOSE), np.floor((high - home) / TURN + CLOSE)
    inside = np.clip(0.0, below, np.maximum(below, above))
    # a range without any: the nearer one of the turns beside it
    under, over = np.floor((low - home) / TURN), np.ceil((high - home) / TURN)
    nearer = np.where(low - (home + TURN * under) <= home + TURN * over - high, under, over)
    return TURN * np.where(below <= above, inside, nearer)


def _first(given: Inputs) -> Inputs:
    return given.cut(slice(None), slice(0, 1))


def _first_drives(given: Inputs) -> dict[str, tuple[Number, ...]]:
    return {name: (v[0] if np.ndim(v[0]) == 0 else v[0][:, :1],) for name, v in given.drives.items()}


def _line(
    solving_order: SolvingOrder, given: Inputs, moving: list[str], values: Mapping[str, Number]
) -> PathOfPoses | None:
    """Return the path of several drivers whose values lie on a line. None where they do not, or all rest."""
    if not moving:
        return None
    count = max(len(given.drives[name][0]) for name in moving)
    columns = (given.drives[name][0] / _unit(solving_order, given, name, count) for name in moving)
    value = np.stack(np.broadcast_arrays(*columns), axis=-1)
    shares = _shares(value)
    if shares is None:
        return None
    share, farthest = shares
    foot, rows = _nearest(solving_order, given, values) if values else 0.0, np.arange(len(value))
    each = np.max(np.abs(value[rows, farthest] - value[:, 0]), axis=-1, keepdims=True) / SPACING
    places, far = _places_on_line(share, _between_poses(share, foot), each)
    # from its least share to its greatest; the poses' own values are exact, the path's those of its ends
    order = np.argsort(share, axis=1, kind="stable")
    drives = _first_drives(given)
    keeps = [k for k, wanted in enumerate((far[0] > CLOSE, True, far[1] > CLOSE)) if wanted]
    for name in moving:
        own = np.broadcast_to(given.drives[name][0], value.shape[:2])
        knots = [own[rows, order[:, 0]][:, None], _between_poses(own, foot), own[rows, order[:, -1]][:, None]]
        drives[name] = (np.concatenate([knots[k] for k in keeps], axis=1),)
    knots_at = np.array([(-far[0], 0.0, far[1])[k] for k in keeps])
    path = DriverPath(_first(given).driven(drives).of_poses(len(keeps)), knots_at, 0.0)
    return _with_stem(solving_order, path, PosePlaces(places), values)


def _between_poses(rows: Number, at: float) -> Number:
    """Return rows (designs, poses) at an index between two poses, as a column."""
    i = min(int(at), max(rows.shape[1] - 2, 0))
    found: Number = rows[:, i : i + 1] * (1.0 - (at - i)) + rows[:, i + 1 : i + 2] * (at - i)
    return found


def _places_on_line(share: Number, foot: Number, each: Number) -> tuple[Number, tuple[float, float]]:
    """Return the places of shares of a line with so many places `each`, from a foot on, and how far they go both ways.

    Designs go their own way, each in as many places.
    """
    below, above = foot - share.min(axis=1, keepdims=True), share.max(axis=1, keepdims=True) - foot
    far = float((each * below).max()), float((each * above).max())
    scale = np.where(
        share < foot,
        np.divide(far[0], below, out=np.zeros_like(below), where=below > 0.0),
        np.divide(far[1], above, out=np.zeros_like(above), where=above > 0.0),
    )
    return (share - foot) * scale, far


def _shares(value: Number) -> tuple[Number, Number] | None:
    """Return how far along their line values (designs, poses, drivers) lie, 1 at the farthest, and which that is.

    None where some design's do not lie on a line.
    """
    way = value - value[:, :1]
    farthest = np.argmax(np.sum(way**2, axis=-1), axis=1)
    along = way[np.arange(len(way)), farthest][:, None]
    length2 = np.sum(along**2, axis=-1, keepdims=True)
    onward = np.divide(along, length2, out=np.zeros_like(along), where=length2 > 0.0)
    share: Number = np.sum(way * onward, axis=-1)
    aside = way - share[..., None] * along
    return None if np.any(np.abs(aside) > ASIDE * np.sqrt(length2)) else (share, farthest)


def _polyline(solving_order: SolvingOrder, given: Inputs, values: Mapping[str, Number]) -> PathOfPoses:
    """Return the path through the values in their order; poses of the same values and dimensions are one knot."""
    steps = np.zeros(max(given.poses - 1, 0))
    for name, (value, *_) in given.drives.items():
        if np.ndim(value) > 1 and value.shape[1] > 1:
            far = np.max(np.abs(np.diff(value, axis=1)) / (solving_order.unit_in(given.ends, name) * SPACING), axis=0)
            steps = np.maximum(steps, far if solving_order.structure.driven_angles[name] else np.minimum(far, MOST))
    if not given.is_rigid:
        steps = np.maximum(steps, APART)
    places = np.append(0.0, np.cumsum(steps))
    foot = _nearest(solving_order, given, values) if values else 0.0
    i = min(int(foot), max(given.poses - 2, 0))
    home = float(places[i] + (steps[i] * (foot - i) if len(steps) else 0.0))
    kept = np.append(0, np.flatnonzero(steps > 0.0) + 1).astype(float)
    between = foot not in kept and home not in places
    at = np.union1d(kept, [foot]) if between else kept
    at_knots = np.interp(at, np.arange(given.poses), places)
    knots = given.at(at) if given.poses > 1 else _first(given)
    knots = knots.driven({name: (v[0],) for name, v in knots.drives.items()}).of_poses(len(at))
    return _with_stem(solving_order, DriverPath(knots, at_knots, home), PosePlaces(places[None]), values)


def _with_stem(
    solving_order: SolvingOrder, path: DriverPath, poses: PosePlaces, values: Mapping[str, Number]
) -> PathOfPoses:
    """Return a path that goes from its home to the drawn pose and back, where that lies beside it."""
    foot = path.at_home()
    drawn, length = _drawn_beside(solving_order, foot, values)
    if length <= CLOSE:
        return path, poses
    k, last = int(np.searchsorted(path.places, path.home)), len(path.places) - 1
    # at an end of the path the drawn pose becomes the end; elsewhere the path goes to it and back
    before, after = np.arange(k + 1 if k else 0), np.arange(k, last + 1 if k < last else k)
    if last == 0:
        before, after = np.arange(0), np.arange(1)
    folded = len(before) > 0 and len(after) > 0
    home = path.home + (length if len(before) else -length)
    places = np.concatenate([path.places[before], [home], path.places[after] + (2.0 * length if folded else 0.0)])
    index = np.concatenate([before, [k], after])
    drives = {}
    for name, (value, *_) in path.knots.drives.items():
        own = drawn[name] if name in drawn else foot.drives[name][0]
        rows = max((len(v) for v in (value, own) if np.ndim(v) > 1), default=1)
        at = np.array(np.broadcast_to(value, (rows, last + 1))[:, index])
        at[:, len(before)] = np.ravel(own)
        drives[name] = (at,)
    knots = path.knots.with_dimensions(lambda v: v if np.ndim(v) == 0 or v.shape[1] == 1 else v[:, index])
    whole = replace(path, knots=knots.driven(drives).of_poses(len(places)), places=places, home=home, wraps=False)
    return whole, PosePlaces(poses.places, path.home, 2.0 * length) if folded else poses


def _drawn_beside(
    solving_order: SolvingOrder, foot: Inputs, values: Mapping[str, Number]
) -> tuple[dict[str, Number], float]:
    """Return the drawn values of drivers, in the turns of their values at a foot, and how many places away they are."""
    drawn, length = dict[str, Number](), 0.0
    for name, value in values.items():
        way = foot.drives[name][0] - value
        is_angle = solving_order.structure.driven_angles[name]
        way = way - whole_turns(way) if is_angle else way
        drawn[name] = foot.drives[name][0] - way
        far = float(np.max(np.abs(way) / (solving_order.unit_in(foot.ends, name) * SPACING)))
        length = max(length, far if is_angle else min(far, MOST))
    return drawn, length


def approach(path: DriverPath, poses: PosePlaces) -> Inputs | None:
    """Return the inputs from home to the nearest pose of a motion. None where home lies among its poses."""
    low, high = float(poses.of_poses.min(axis=1).max()), float(poses.of_poses.max(axis=1).min())
    if poses.length > 0.0:
        begin, end = poses.stem, path.home
    elif path.home < low or path.home > high:
        begin, end = sorted((path.home, low if path.home < low else high))
    else:
        return None
    return path.at(path.samples[(path.samples >= begin) & (path.samples <= end)])


def drawn_value(
    solving_order: SolvingOrder, given: Inputs, name: str, drawn: Mapping[str, Pose], sketch: Mapping[str, Number]
) -> Number | None:
    """Return the driver's coordinate as the drawing shows it, a number or (designs, 1). None where it does not."""
    driven = solving_order.structure.driven[name]
    pair = driven.pair
    told = pair.drawn_value(drawn, sketch)
    if told is not None:
        return first_of(told)
    if any(link not in drawn for link in pair.members):
        length = pair.drawn_length(sketch)
        return None if length is None else _signed(first_of(length), given.drives[name][0])
    ends = _first(given).ends[pair.name]
    poses = (as_column(drawn[pair.members[0]]), as_column(drawn[pair.members[1]]))
    return pair.drawn_coordinate(ends, poses) * pair.driven_by(driven.drive.link)


def _signed(length: Number, values: Number) -> Number:
    """Return a length that is drawn without its sign. Its sign is the one that brings it nearer to some value."""
    ahead, behind = (np.min(np.abs(np.atleast_2d(values - way)), axis=-1, keepdims=True) for way in (length, -length))
    return np.where(ahead <= behind, length, -length)


def _nearest(solving_order: SolvingOrder, given: Inputs, values: Mapping[str, Number]) -> float:
    """Return the place, between poses too, whose drivers are nearest to the drawn ones, over all designs.

    Of places that are equally near, as the ends of a full turn, it is the one whose values are nearest by themselves.
    """
    if given.poses == 1:
        return 0.0
    # from each pose to the next the drivers go straight on: the foot of the perpendicular to that line
    here = [_off(solving_order, given, name, value)[:, :-1] for name, value in values.items()]
    steps = [_step(given.drives[name][0]) / solving_order.unit_in(given.ends, name) for name in values]
    square = sum((step**2).sum(axis=0) for step in steps)
    back = sum((step * off).sum(axis=0) for step, off in zip(steps, here, strict=True))
    share = np.divide(-back, square, out=np.zeros(given.poses - 1), where=square > 0.0)
    share = np.where(share < CLOSE, 0.0, np.where(share > 1.0 - CLOSE, 1.0, share))
    near = np.arange(given.poses - 1)
    for turns in (False, True):
        offs = (_off(solving_order, given, name, value, turns)[:, :-1] for name, value in values.items())
        worst = sum(np.abs(off + share * step) for off, step in zip(offs, steps, strict=True)).max(axis=0)[near]
        # equal but for rounding
        near = near[worst <= worst.min() + CLOSE]
        if len(near) == 1:
            break
    return float(near[0] + share[near[0]])


def _off(solving_order: SolvingOrder, given: Inputs, name: str, value: Number, turns: bool = False) -> Number:
    """Return how far a driver is from where it is drawn, with whole turns or without.

    It is (1 or designs, poses), in radians or parts of the size.
    """
    off = given.drives[name][0] - value
    if solving_order.structure.driven_angles[name] and not turns:
        off = off - whole_turns(off)
    off = np.atleast_2d(off / solving_order.unit_in(given.ends, name))
    return off if off.shape[1] == given.poses else np.broadcast_to(off, (len(off), given.poses))


def _step(value: Number) -> Number:
    """Return the steps of a driver's values from pose to pose, (1 or designs, poses - 1). They may be one zero."""
    return value[:, 1:] - value[:, :-1] if np.ndim(value) > 1 and value.shape[1] > 1 else np.zeros((1, 1))


def first_of(value: Number) -> Number:
    """Return a dimension at the first pose of each design. It is a number, or an array (designs, 1)."""
    if isinstance(value, complex | float) or np.ndim(value) == 0:
        return value
    array = np.asarray(value)
    return array[..., :1].reshape(-1, 1)


def as_column(pose: Pose) -> Pose:
    """Return a pose at the first pose of each design."""
    return pose.mapped(lambda series: constant(first_of(series.c[0])))
