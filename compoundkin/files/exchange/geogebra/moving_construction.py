"""The mechanism that a construction of GeoGebra is: its links, pairs and drivers, read off how its points move.

A construction says how points are drawn, not what holds them. So its objects are evaluated at many values of what
moves it: points whose distances stay are on one link, those that keep to a line of a link slide on it, links whose
turns stay in proportion are geared. What is drawn goes first, then what is constructed, then what merely stays; each is
taken where it holds something that nothing before it holds, until no more than the drivers is free. Whether the
mechanism moves as the construction does is then tried by solving it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from compoundkin.base.arrays import TURN, Number
from compoundkin.base.display import abbreviated_list, count_phrase
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.geogebra.construction_commands import Straight, is_point
from compoundkin.files.exchange.geogebra.read_construction import (
    AUTHOR,
    ConstructionValues,
    DrawnChoices,
    ReadConstruction,
)

# Distances that change by less than this part of the size stay; the drawn places have all their digits.
STAYS = 1e-8
# A constraint adds to those before it if this part of it is new.
_NEW = 1e-7
# So many poses near the drawn one, and over the whole ranges of all drivers.
_NEAR, _FAR = 24, 40
# How far near poses are, as a part of a driver's range.
_NEARLY = 0.02
# A slide without ends is tried so far, as a part of the size.
_REACH = 0.1
# More points than this are not of a mechanism that anybody drew; all pairs of them are looked at.
_MOST_POINTS = 150
# Kinds of objects that show something and move nothing.
_SHOWN_ONLY = ("text", "image", "button", "boolean", "locus", "list", "textfield", "penstroke", "function", "audio",
               "inlinetext", "video", "angle")  # fmt: skip


@dataclass(frozen=True)
class MovingInput:
    """What moves a construction: its range in its own measure, and where it is drawn."""

    name: str
    low: float
    high: float
    here: float


@dataclass
class RigidBody:
    """A link: its points, those that tell its pose first, and the name of what it is drawn by."""

    points: list[str]
    name: str = ""
    level: int = 0


@dataclass(frozen=True)
class PointGuide:
    """A point on a straight line of a body, by its index, -1 for the frame; `along` in space as drawn."""

    point: str
    on: int
    along: complex


@dataclass(frozen=True)
class TurnRatio:
    """Two bodies that turn in proportion against a third, about points that they share with it."""

    first: int
    second: int
    carrier: int
    first_at: str
    second_at: str
    ratio: float


class MovingConstruction:
    """A construction over many poses, with its links, slides and gears.

    `places` has its points over all of them, the drawn pose first. Raises InvalidInput for what moves in another way.
    """

    def __init__(self, read: ReadConstruction, where: str) -> None:
        self.read, self.where = read, where
        self.choices = DrawnChoices()
        self.notes: list[str] = []
        self.drawn = ConstructionValues(read, self.choices, {})
        self.needs = _needs(read)
        self.inputs = self._inputs()
        self.poses = self._random_poses(self.inputs)
        self.found = self.evaluated(self.poses)
        self.places = self._points()
        if len(self.places) > _MOST_POINTS:
            raise InvalidInput(Problem(where, f"it has {len(self.places)} points", f"at most {_MOST_POINTS} are read"))
        corners = np.array([row[0] for row in self.places.values()])
        self.size = float(max(np.ptp(corners.real), np.ptp(corners.imag), 1e-300))
        self.bodies: list[RigidBody] = []
        self.guides: list[PointGuide] = []
        self.ratios: list[TurnRatio] = []
        self._known_parts: dict[str, set[str]] = {}
        self._find_pairs()

    # --- what moves it ------------------------------------------------------------------------------------------------

    def _inputs(self) -> list[MovingInput]:
        """Return the drivers: sliders, and points dragged along fixed paths; sliders of lengths are dimensions."""
        sliders = [*self._sliders()]
        dragged = [*self._dragged({one.name for one in sliders})]
        every = [*sliders, *dragged]
        if not every:
            what = "nothing moves it: it has neither a slider nor a point on a fixed circle or line"
            raise InvalidInput(Problem(self.where, what, "turn the crank by a slider, or put its pin on a circle"))
        if self.read.author == AUTHOR:
            return every
        plain = [one for one in every if one in dragged or self._keeps_lengths(one)]
        moving = plain or every
        for one in every:
            if one not in moving:
                self.notes.append(f"the slider {one.name} changes lengths: it is a dimension, {one.here:.6g} as drawn")
        return moving

    def _sliders(self) -> Iterator[MovingInput]:
        used = {name for needed in self.needs.values() for name in needed}
        for name in self.read.elements:
            span = self.read.range_of(name)
            if span and name in self.drawn.values and name not in self.needs and name in used:
                here = float(self.drawn.values[name][0])
                if self._moves(name, here, (span[1] - span[0]) * 1e-3):
                    yield MovingInput(name, *span, here)

    def _dragged(self, sliders: set[str]) -> Iterator[MovingInput]:
        """Yield points that are dragged along paths that do not move, if anything follows them."""
        followed = {name for name, needed in self.needs.items() for name in needed}
        for name, way in self.choices.way.items():
            (path,) = next(step.arguments for step in self.read.steps if name in step.gives)[:1]
            needed = self.needs[name]
            if needed & sliders or needed & self.choices.way.keys():
                self.notes.append(f"{name} can be dragged along {path}: it stays where it is drawn on it")
            elif name in followed:
                shape = self.drawn.computed(path)
                if not isinstance(shape, Straight):
                    yield MovingInput(name, way, way + TURN, way)
                elif shape.length is not None:
                    yield MovingInput(name, 0.0, float(shape.length[0]), way)
                else:
                    places = [value[0] for value in self.drawn.values.values() if is_point(value)]
                    reach = _REACH * max(abs(one - places[0]) for one in places)
                    yield MovingInput(name, way - reach, way + reach, way)

    def _moves(self, name: str, here: float, step: float) -> bool:
        """Return whether a number moves any point."""
        other = ConstructionValues(self.read, self.choices, {name: np.array([here + step, here - step])})
        return any(
            is_point(value) and is_point(self.drawn.values.get(key)) and bool(np.any(value != self.drawn.values[key]))
            for key, value in other.values.items()
        )

    def _keeps_lengths(self, one: MovingInput) -> bool:
        """Return whether what is drawn keeps its lengths while a slider alone moves."""
        step = (one.high - one.low) * 1e-3
        rows = {one.name: np.array([one.here, one.here + step, one.here - step])}
        found = ConstructionValues(self.read, self.choices, rows)
        for name, value in found.values.items():
            length = getattr(value, "radius", getattr(value, "length", None))
            if length is None or (isinstance(value, Straight) and not self.read.is_shown(name)):
                continue
            good = length[np.isfinite(length)]
            if good.size and np.ptp(good) > 1e-9 * np.max(np.abs(good)):
                return False
        return not any(
            name == one.name or name in self.needs[place]
            for place, step in self._polar_lengths()
            for name in step
            if one.name in ({name} | self.needs.get(name, set()))
        )

    def _polar_lengths(self) -> Iterator[tuple[str, list[str]]]:
        """Yield points by expressions such as A + (r; α), with the names in their lengths."""
        for step in self.read.steps:
            if not step.command and ";" in step.arguments[0]:
                texts = re.findall(r"\(([^();]*);", step.arguments[0])
                yield step.gives[0], [name for name in self.read.elements for text in texts if _mentions(text, name)]

    # --- poses --------------------------------------------------------------------------------------------------------

    def _random_poses(self, inputs: Sequence[MovingInput]) -> dict[str, Number]:
        """Return the drawn pose, poses near it, and some over the whole ranges."""
        rng = np.random.default_rng(0)
        rows = {}
        for one in inputs:
            span = one.high - one.low
            near = one.here + _NEARLY * span * rng.uniform(-1.0, 1.0, _NEAR)
            rows[one.name] = np.concatenate([[one.here], near, rng.uniform(one.low, one.high, _FAR)])
        return rows

    def evaluated(self, rows: Mapping[str, Number]) -> ConstructionValues:
        """Return all objects at values of the drivers."""
        return ConstructionValues(self.read, self.choices, rows)

    def _points(self) -> dict[str, Number]:
        """Return the points, of those that are always together the first that is shown."""
        steady = [n for n in self.read.elements if self.read.kind(n) == "point" and is_point(self.found.values.get(n))]
        steady = [n for n in steady if np.isfinite(self.found.values[n][: _NEAR + 1]).sum() > _NEAR // 2]
        steady.sort(key=lambda name: not self.read.is_shown(name))
        rows = {name: self.found.values[name] for name in steady}
        self.same: dict[str, str] = {}
        scale = max((abs(row[0]) for row in rows.values()), default=1.0) or 1.0
        kept: dict[str, Number] = {}
        for name, row in rows.items():
            twin = next((k for k, other in kept.items() if np.nanmax(np.abs(other - row)) <= STAYS * scale), None)
            self.same[name] = twin or name
            if twin is None:
                kept[name] = row
        wanted = [name for name in self.read.elements if name in kept]
        if len(wanted) < 2:
            raise InvalidInput(Problem(self.where, "it has no points that move together", "draw links as segments"))
        return {name: kept[name] for name in wanted}

    def stays(self, values: Number, count: int = 0) -> bool:
        """Return whether values do not change, at the poses where they are known."""
        good = values[np.isfinite(values)]
        if count:
            good = values[:count][np.isfinite(values[:count])]
        return good.size > _NEAR // 2 and float(np.max(np.abs(good - good[0]))) <= STAYS * self.size

    # --- links and pairs ----------------------------------------------------------------------------------------------

    def _find_pairs(self) -> None:
        """Find links, slides and gears. Raises InvalidInput for what moves in another way."""
        self._refuse_unread()
        self.fixed = [name for name, row in self.places.items() if self.stays(row)]
        everything = [name for name in self.places if name not in self.fixed]
        drawn = {self.same.get(name, name) for ends in self._drawn_shapes().values() for name in ends}
        shown = [name for name in everything if self.read.is_shown(name) or name in drawn]
        if not everything:
            raise InvalidInput(Problem(self.where, "none of its points moves", "let a slider turn the crank"))
        for chosen in dict.fromkeys((tuple(shown), tuple(everything))):
            self.moving = list(chosen)
            left = self._explain() if chosen else ["?"]
            if not left:
                break
        else:
            texts = {name: step.text for step in self.read.steps for name in step.gives}
            raise InvalidInput(
                [Problem(f"point {n}", f"{n} = {texts.get(n, 'free')} moves in a way that no links, pins, slides and "
                         "gears tell", "draw the links that hold it as segments") for n in left],
                heading=f"{self.where or 'the construction'}: {count_phrase(len(left), 'point')} not understood",
            )  # fmt: skip

    def _refuse_unread(self) -> None:
        """Refuse links whose ends have no value, note what else has none."""
        unread = {n: why for n, why in self.drawn.unread.items() if self.read.kind(n) not in _SHOWN_ONLY}
        needed = [n for ends in self._drawn_shapes().values() for n in ends if n in unread]
        lines = {name: step.line for step in self.read.steps for name in step.gives}
        if needed:
            raise InvalidInput(
                [Problem(f"line {lines[n]}: {n}", unread[n], "construct it by lines, circles and their intersections")
                 for n in dict.fromkeys(needed)],
                heading=f"{self.where or 'the construction'}: ends of links are not understood",
            )  # fmt: skip
        if unread:
            told = [f"{name} ({why})" for name, why in unread.items()]
            self.notes.append(f"not understood, and left out: {abbreviated_list(told)}")

    def _drawn_shapes(self) -> dict[str, tuple[str, ...]]:
        """Return the segments, polygons and vectors with their corners by name."""
        found = {}
        for step in self.read.steps:
            if step.command in ("Segment", "Polygon", "PolyLine", "Vector") and step.gives:
                ends = [name for name in step.arguments if self.read.kind(name) == "point"]
                ends += [name for name in step.gives[1:] if self.read.kind(name) == "point"]
                if len(ends) > 1:
                    found[step.gives[0]] = tuple(ends)
        return found

    def _explain(self) -> list[str]:
        """Find links and pairs until no more than the drivers is free; return the points that are still free."""
        self.bodies, self.guides, self.ratios = [], [], []
        known = {*self.moving, *self.fixed}
        self.held = _Constraints([*self.moving], {n: row for n, row in self.places.items() if n in known})
        self.wanted = 2 * len(self.moving) - len(self.inputs)
        drawn, built = self._pairs()
        self._add_bodies(drawn, built)
        for step in (
            self._guide_points,
            self._attach_points,
            self._gear_bodies,
            self._hold_distances,
            self._centre_paths,
        ):
            if self.held.rank < self.wanted:
                step()
        if self.held.rank < self.wanted:
            free = self.held.free()
            return [name for name in free if name in self.read.elements] or self.moving[:1]
        return []

    def _pairs(self) -> tuple[dict[tuple[str, str], str], list[tuple[str, str]]]:
        """Return the pairs of points whose distance stays: those drawn, with the shape, and those constructed."""
        drawn: dict[tuple[str, str], str] = {}
        for shape, ends in self._drawn_shapes().items():
            for one, other in combinations(dict.fromkeys(self.same.get(n, n) for n in ends), 2):
                if self._is_bar(one, other):
                    drawn.setdefault((one, other), shape)
        built = []
        for name in self.moving:
            for other in self.made_of(name):
                if self._is_bar(other, name) and not {(name, other), (other, name)} & drawn.keys():
                    built += [(other, name)]
        return drawn, built

    def _is_bar(self, one: str, other: str) -> bool:
        known = {*self.moving, *self.fixed}
        if one == other or not {one, other} <= known or {one, other} <= set(self.fixed):
            return False
        return self.stays(np.abs(self.places[one] - self.places[other]))

    def made_of(self, name: str) -> list[str]:
        """Return the points of which a point is made without another between."""
        makes = {given: step for step in self.read.steps for given in step.gives}
        found: dict[str, None] = {}
        todo, seen = [name], set()
        while todo:
            step = makes.get(todo.pop())
            for text in step.arguments if step else ():
                for other in self.read.names:
                    if other not in seen and _mentions(text, other):
                        seen.add(other)
                        if self.read.kind(other) == "point":
                            found[self.same.get(other, other)] = None
                        else:
                            todo.append(other)
        return [other for other in found if other in self.places]

    def _add_bodies(self, drawn: Mapping[tuple[str, str], str], built: Sequence[tuple[str, str]]) -> None:
        """Add links of the pairs that keep their distance: those that share a point and keep their angle are one."""
        bars = [*drawn, *built]
        root = list(range(len(bars)))

        def first(k: int) -> int:
            while root[k] != k:
                root[k] = k = root[root[k]]
            return k

        for j, k in combinations(range(len(bars)), 2):
            shared = {*bars[j]} & {*bars[k]}
            if len(shared) == 1:
                (one,), (other,) = {*bars[j]} - shared, {*bars[k]} - shared
                if self._keeps_angle(one, other, next(iter(shared))):
                    root[first(k)] = first(j)
        together: dict[int, list[int]] = {}
        for k in range(len(bars)):
            together.setdefault(first(k), []).append(k)
        for rows in sorted(together.values(), key=lambda rows: (rows[0] >= len(drawn), rows[0])):
            points = list(dict.fromkeys(name for k in rows for name in bars[k]))
            shape = next((drawn[bars[k]] for k in rows if bars[k] in drawn), "")
            self._add_body(points, shape)

    def _keeps_angle(self, one: str, other: str, apex: str) -> bool:
        first, second, corner = (self.places[name] for name in (one, other, apex))
        with np.errstate(all="ignore"):
            turned = (first - corner) / (second - corner)
        return self.stays(turned * self.size)

    def _add_body(self, points: list[str], shape: str) -> None:
        """Add a link, unless it has two points alone and holds nothing that others do not."""
        lead = max(combinations(points, 2), key=lambda pair: abs(self.places[pair[0]][0] - self.places[pair[1]][0]))
        ordered = [*lead, *(name for name in points if name not in lead)]
        new = self.held.bar(*lead)
        for name in ordered[2:]:
            new = self.held.attached(name, *lead) or new
        if new or len(points) > 2:
            self.bodies.append(RigidBody(ordered, self._link_name(shape, points)))
        elif shape:
            self.notes.append(f"{shape} holds nothing that the others do not hold: it is left out")

    def _link_name(self, shape: str, points: Sequence[str]) -> str:
        if self.read.author == AUTHOR and (found := re.fullmatch(r"f_(?:\{(.+)\}|(\w))", shape)):
            return found[1] or found[2]
        caption = self.read.attribute(shape, "caption", "val") if shape else ""
        if caption and "%" not in caption and "$" not in caption:
            return caption
        names = [name for name in self.places if name in points]
        return "".join(map(plain_name, names[:4])) if shape or len(points) > 2 else "".join(map(plain_name, points))

    def _relative(self, name: str, on: int) -> Number:
        """Return where a point is in the axes of a body, whose turn in the drawn pose is none."""
        if on < 0:
            return self.places[name]
        a, b = (self.places[key] for key in self.bodies[on].points[:2])
        with np.errstate(all="ignore"):
            turn = (b - a) / (b[0] - a[0])
            return a[0] + (self.places[name] - a) / turn

    def _hosts(self, name: str) -> Iterator[int]:
        """Yield the frame and the bodies that a point is not on."""
        yield -1
        yield from (k for k, body in enumerate(self.bodies) if name not in body.points)

    def _guide_points(self) -> None:
        """Let points that keep to straight lines run on them: those of the frame first."""
        for on in range(-1, len(self.bodies)):
            for name in [*self.moving, *(self.fixed if on >= 0 else ())]:
                if self.held.rank >= self.wanted:
                    return
                if on >= 0 and (name in self.bodies[on].points or not self._is_near(name, on)):
                    continue
                along = self._straight(self._relative(name, on))
                pair = self.bodies[on].points[:2] if on >= 0 else ()
                if along is not None and self.held.guided(name, along, *pair):
                    self.guides.append(PointGuide(name, on, along))

    def _is_near(self, name: str, on: int) -> bool:
        """Return whether a point is made of points of a body, or these of it, or a line of theirs is drawn."""
        own = self.bodies[on].points
        return any(other in own for other in self._through(name)) or any(name in self._through(other) for other in own)

    def _through(self, name: str) -> set[str]:
        if name not in self._known_parts:
            self._known_parts[name] = {self.same.get(n, n) for n in (*self.made_of(name), *self.needs.get(name, ()))}
        return self._known_parts[name]

    def _straight(self, row: Number) -> complex | None:
        """Return the direction of a path if it is straight, as long as it goes anywhere."""
        good = row[np.isfinite(row)]
        if good.size <= _NEAR // 2:
            return None
        far = good[np.argmax(np.abs(good - good[0]))] - good[0]
        if abs(far) <= 1e-5 * self.size:
            return None
        along = complex(far / abs(far))
        across = ((good - good[0]) * np.conj(along)).imag
        return along if float(np.max(np.abs(across))) <= STAYS * self.size else None

    def _attach_points(self) -> None:
        """Put points that stay in the axes of a body on it."""
        for name in self.moving:
            if any(name in body.points for body in self.bodies):
                continue
            for k, body in enumerate(self.bodies):
                if self.stays(self._relative(name, k)) and self.held.attached(name, *body.points[:2]):
                    body.points.append(name)
                    break

    def _hold_distances(self) -> None:
        """Add bars between points that keep their distance, though nothing drawn says so."""
        for one, other in combinations([*self.fixed, *self.moving], 2):
            if self.held.rank >= self.wanted:
                return
            if self._is_bar(one, other) and self.held.bar(one, other):
                self.bodies.append(RigidBody([one, other], self._link_name("", (one, other))))

    def _centre_paths(self) -> None:
        """Add bars to the centres of circles that points keep to, on the frame or on bodies, where no point is."""
        for name in list(self.moving):
            for on in self._hosts(name):
                if self.held.rank >= self.wanted:
                    return
                centre = self._round(self._relative(name, on))
                label = f"{name}_0" if on < 0 else f"{name}_{on + 1}"
                own = self.fixed if on < 0 else self.bodies[on].points
                if centre is None or any(abs(self.places[n][0] - centre) <= STAYS * self.size for n in own):
                    continue
                if on < 0:
                    row = np.full(len(self.places[name]), centre)
                    self.fixed.append(label)
                else:
                    a, b = (self.places[key] for key in self.bodies[on].points[:2])
                    row = a + (centre - a[0]) * (b - a) / (b[0] - a[0])
                    self.moving.append(label)
                    self.wanted += 2
                self.places[label] = row
                self.held.add(label, row, fixed=on < 0)
                if on >= 0:
                    self.held.attached(label, *self.bodies[on].points[:2])
                    self.bodies[on].points.append(label)
                if self.held.bar(label, name):
                    self.bodies.append(RigidBody([label, name], self._link_name("", (label, name))))

    def _round(self, row: Number) -> complex | None:
        """Return the centre of a path if it is an arc."""
        good = row[np.isfinite(row)]
        if good.size <= _NEAR // 2:
            return None
        z = good - good[0]
        matrix = np.stack([2 * z.real, 2 * z.imag, np.ones(z.size)], axis=1)
        found, _, rank, _ = np.linalg.lstsq(matrix, np.abs(z) ** 2, rcond=1e-10)
        centre = complex(found[0], found[1])
        if rank < 3 or not abs(centre) < 1e3 * self.size:
            return None
        return good[0] + centre if self.stays(np.abs(z - centre)) else None

    def _gear_bodies(self) -> None:
        """Gear bodies whose turns against a common carrier, or the frame, stay in proportion."""
        for carrier in range(-1, len(self.bodies)):
            on = self.fixed if carrier < 0 else self.bodies[carrier].points
            pinned = [
                (k, next(n for n in body.points if n in on))
                for k, body in enumerate(self.bodies)
                if k != carrier and any(n in on for n in body.points)
            ]
            if carrier >= 0:
                pinned += [(-1, n) for n in self.bodies[carrier].points if n in self.fixed][:1]
            for (one, at), (other, there) in combinations(pinned, 2):
                if self.held.rank >= self.wanted:
                    return
                if at != there:
                    self._gear(one, other, carrier, at, there)

    def _gear(self, one: int, other: int, carrier: int, at: str, there: str) -> None:
        near = slice(0, _NEAR + 1)
        first, second, base = (self._turn(k)[near] for k in (one, other, carrier))
        first, second = first - base, second - base
        good = np.isfinite(first) & np.isfinite(second)
        if good.sum() <= _NEAR // 2 or float(np.ptp(second[good])) < 1e-6:
            return
        ratio = float(np.dot(first[good], second[good]) / np.dot(second[good], second[good]))
        if abs(ratio) < 1e-3 or not self.stays((first - ratio * second) * self.size, _NEAR + 1):
            return
        ends = [self.bodies[k].points[:2] if k >= 0 else [] for k in (one, other, carrier)]
        if self.held.geared(ends, ratio):
            self.ratios.append(TurnRatio(one, other, carrier, at, there, ratio))

    def _turn(self, k: int) -> Number:
        """Return how far a body is turned from the drawn pose, near it."""
        if k < 0:
            return np.zeros(len(next(iter(self.places.values()))))
        a, b = (self.places[name] for name in self.bodies[k].points[:2])
        with np.errstate(all="ignore"):
            return np.angle((b - a) / (b[0] - a[0]))


@dataclass
class _Constraints:
    """What holds points: rows over their velocities, each of which is told whether it adds to those before."""

    names: list[str]
    places: dict[str, Number]
    rank: int = 0
    _basis: list[Number] = field(default_factory=list)

    def __post_init__(self) -> None:
        pose = next(k for k in range(1, _NEAR + 1) if all(np.isfinite(row[k]) for row in self.places.values()))
        self._at = {name: complex(row[pose]) for name, row in self.places.items()}
        self._index = {name: k for k, name in enumerate(self.names)}

    def add(self, name: str, row: Number, *, fixed: bool) -> None:
        """Add a point."""
        self._at[name] = complex(row[1])
        if not fixed:
            self._index[name] = len(self._index)
            self.names.append(name)
            self._basis = [np.concatenate([one, [0.0, 0.0]]) for one in self._basis]

    def bar(self, one: str, other: str) -> bool:
        """Hold the distance of two points."""
        gap = self._at[other] - self._at[one]
        return self._new({other: gap, one: -gap})

    def attached(self, name: str, one: str, other: str) -> bool:
        """Hold a point on the body of two others, in both its directions."""
        part = (self._at[name] - self._at[one]) / (self._at[other] - self._at[one])
        new = False
        for way in (1 + 0j, 1j):
            # the part of (v - v1 - part (v2 - v1)) along a way
            new = self._new({name: way, one: -way + way * part.conjugate(), other: -way * part.conjugate()}) or new
        return new

    def guided(self, name: str, along: complex, *body: str) -> bool:
        """Hold a point on a line of the frame, or of the body of two points; `along` as drawn in the first pose."""
        if not body:
            return self._new({name: 1j * along})
        one, other = body
        start = (self.places[other][0] - self.places[one][0]) / abs(self.places[other][0] - self.places[one][0])
        gap = self._at[other] - self._at[one]
        normal = 1j * along * gap / abs(gap) / start
        across = 1j * gap / abs(gap) ** 2
        # v - v1 - turning rate x arm, along the normal
        turning = (normal.conjugate() * 1j * (self._at[name] - self._at[one])).real
        return self._new({name: normal, one: -normal + turning * across, other: -turning * across})

    def geared(self, ends: Sequence[Sequence[str]], ratio: float) -> bool:
        """Hold the turning rates of two bodies against a third in proportion; a body without ends is the frame."""
        row: dict[str, complex] = {}
        for own, factor in zip(ends, (1.0, -ratio, ratio - 1.0), strict=True):
            if own:
                gap = self._at[own[1]] - self._at[own[0]]
                for name, sign in ((own[1], 1.0), (own[0], -1.0)):
                    row[name] = row.get(name, 0j) + sign * factor * 1j * gap / abs(gap) ** 2
        return self._new(row)

    def _new(self, terms: Mapping[str, complex]) -> bool:
        row = np.zeros(2 * len(self.names))
        for name, way in terms.items():
            if name in self._index:
                row[2 * self._index[name] : 2 * self._index[name] + 2] += way.real, way.imag
        long = float(np.linalg.norm(row))
        if not long > 0.0:
            return False
        row /= long
        for _ in range(2):
            for one in self._basis:
                row = row - np.dot(row, one) * one
        left = float(np.linalg.norm(row))
        if left <= _NEW:
            return False
        self._basis.append(row / left)
        self.rank += 1
        return True

    def free(self) -> list[str]:
        """Return the points that nothing holds, those that are freest first."""
        space = np.eye(2 * len(self.names))
        for one in self._basis:
            space = space - np.outer(space @ one, one)
        own = np.linalg.norm(space.reshape(len(self.names), -1), axis=1)
        return [self.names[k] for k in np.argsort(-own, kind="stable") if own[k] > 0.5 * own.max()]


def _mentions(text: str, name: str) -> bool:
    return re.search(rf"(?<![^\W]){re.escape(name)}(?![\w'])", text) is not None


def _needs(read: ReadConstruction) -> dict[str, set[str]]:
    """Return what each object that is made depends on."""
    found: dict[str, set[str]] = {}
    for step in read.steps:
        direct = {name for name in read.names if any(_mentions(text, name) for text in step.arguments)}
        whole = direct.union(*(found.get(name, set()) for name in direct))
        for name in step.gives:
            found[name] = whole
    return found


def plain_name(name: str) -> str:
    """Return a name without the marks of its index.

    >>> plain_name("O_2"), plain_name("P_{tip}"), plain_name("A")
    ('O2', 'Ptip', 'A')
    """
    return re.sub(r"[_{}]", "", name)
