"""The drawing of a construction's mechanism: its links, slides and gears, and what its sliders drive."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from compoundkin.base.arrays import TURN, Number
from compoundkin.base.display import abbreviated_list
from compoundkin.base.errors import CompoundkinError, InvalidInput, Problem
from compoundkin.files.exchange.content import Content
from compoundkin.files.exchange.contract import Imported
from compoundkin.files.exchange.drawing import (
    Drawing,
    DrawnDriver,
    DrawnGear,
    DrawnGuideway,
    DrawnLink,
    DrawnPoint,
    GearKind,
)
from compoundkin.files.exchange.drawn_mechanism import mechanism_of
from compoundkin.files.exchange.geogebra.moving_construction import (
    STAYS,
    MovingConstruction,
    MovingInput,
    PointGuide,
    plain_name,
)
from compoundkin.files.exchange.geogebra.read_construction import construction_in
from compoundkin.kinematics.solution import quietly_solved
from compoundkin.model.geometry import FRAME
from compoundkin.structure import decompose

# So many poses a driver's range is looked at.
_ALONG = 241


@dataclass(frozen=True)
class _DrivenCourse:
    """What an input may drive: its course over the range, from where it is drawn first."""

    kind: str
    is_even: bool
    driver: DrawnDriver
    course: Number


# What is driven, of what goes evenly: turns on the frame first.
_KINDS = ("turn", "slide", "turn on a link", "way between")


def _is_even(row: Number) -> bool:
    """Return whether a course goes in equal steps."""
    steps = np.diff(row[1:])
    steps = steps[np.isfinite(steps)]
    return steps.size > 0 and float(np.ptp(steps)) <= 1e-7 * float(np.max(np.abs(steps)))


def _off(place: complex, path: Number) -> float:
    """Return how far a place is from a line of segments."""
    if path.size == 1:
        return float(abs(place - path[0]))
    start, gap = path[:-1], np.diff(path)
    with np.errstate(all="ignore"):
        part = np.clip(np.nan_to_num(((place - start) * np.conj(gap)).real / np.abs(gap) ** 2), 0.0, 1.0)
    return float(np.min(np.abs(start + part * gap - place)))


def read_construction(content: Content, form: str) -> Imported:
    """Return the mechanism of a construction.

    Raises InvalidInput where it is damaged, where nothing moves it, or where points move in a way that no links, pins,
    slides and gears say.
    """
    read = construction_in(content)
    moving = MovingConstruction(read, content.where)
    shown = _ConstructionDrawing(moving)
    drawing = replace(shown.drawing(), title=read.title or content.name)
    found = mechanism_of(drawing, form, content.where)
    return replace(found, notes=(*found.notes, *shown.tried(found)))


class _ConstructionDrawing:
    """The links and pairs of a construction as a drawing, with drivers in place of what moves it."""

    def __init__(self, moving: MovingConstruction) -> None:
        self._moving, self.read, self.where, self.notes = moving, moving.read, moving.where, moving.notes
        self.inputs, self.poses, self.places, self.size = moving.inputs, moving.poses, moving.places, moving.size
        self.bodies, self.guides, self.ratios = moving.bodies, moving.guides, moving.ratios
        self.fixed, self.moving, self.same = moving.fixed, moving.moving, moving.same

    def drawing(self) -> Drawing:
        """Return the drawing."""
        links = [DrawnLink(FRAME), *(DrawnLink(f"link {k}", body.name) for k, body in enumerate(self.bodies))]
        on: dict[str, list[str]] = {name: [] for name in [*self.fixed, *self.moving]}
        for k, body in enumerate(self.bodies):
            for name in body.points:
                on[name].append(f"link {k}")
        guides = [*self._drawn_guides(links, on)]
        drivers = []
        for one in self.inputs:
            driver, extra = self._driver(one, guides, links, on)
            drivers.append(driver)
            guides += extra
        for name in self.fixed:
            if on[name] or self.read.is_shown(name):
                on[name].insert(0, FRAME)
        points = tuple(
            DrawnPoint(name, complex(self.places[name][0]), tuple(own), plain_name(name))
            for name, own in on.items() if own
        )  # fmt: skip
        lost = [name for name, own in on.items() if not own and name in self.moving]
        if lost:
            self.notes.append(f"on no link, and left out: {', '.join(lost)}")
        return Drawing(
            self.read.title, tuple(links), points, tuple(guides), gears=tuple(self._gears()), drivers=tuple(drivers),
            outputs=tuple(n for n in self._traced() if on.get(n) and n in self.moving), notes=tuple(self.notes),
            dropped=tuple(self._dropped()),
        )  # fmt: skip

    def _traced(self) -> Iterator[str]:
        for step in self.read.steps:
            if step.command == "Locus" and step.arguments:
                yield self.same.get(step.arguments[0], step.arguments[0])

    def _dropped(self) -> Iterator[tuple[str, int]]:
        kinds = Counter(self.read.kind(name) for name in self.read.elements)
        made = {name for step in self.read.steps for name in step.gives}
        del kinds["angle"]
        kinds["angle mark"] = sum(self.read.kind(name) == "angle" and name in made for name in self.read.elements)
        for kind in ("text", "image", "button", "list", "function", "textfield", "penstroke", "angle mark"):
            yield kind, kinds[kind]

    def _drawn_guides(self, links: list[DrawnLink], on: dict[str, list[str]]) -> Iterator[DrawnGuideway]:
        """Yield the slides; a link with two parallel ones slides itself, else a block is pinned to the point."""
        left = list(self.guides)
        while left:
            guide = left.pop(0)
            host = FRAME if guide.on < 0 else f"link {guide.on}"
            twin = next((other for other in left if other.on == guide.on and self._is_one(guide, other, on)), None)
            if twin is not None:
                left.remove(twin)
                link = next(k for k in on[guide.point] if k in on[twin.point])
            else:
                link = f"block {guide.point} {host}"
                links.append(DrawnLink(link, f"block {plain_name(guide.point)}"))
                on[guide.point].append(link)
            key = f"slide {guide.point} {host}"
            place, along = self._line_of(guide)
            yield DrawnGuideway(key, "slide", link, host, guide.point, place, float(np.angle(along)))

    def _line_of(self, guide: PointGuide) -> tuple[complex, complex]:
        """Return a place on a guide and its direction: from a point of its body on it, else as the point goes."""
        here = complex(self.places[guide.point][0])
        for name in self.fixed if guide.on < 0 else self.bodies[guide.on].points:
            there = complex(self.places[name][0])
            gap = here - there
            if abs(gap) > STAYS * self.size and abs((gap * guide.along.conjugate()).imag) <= STAYS * self.size:
                return there, gap
        along = complex(round(guide.along.real, 12), round(guide.along.imag, 12))
        return here, along if (along.real, along.imag) > (0.0, 0.0) else -along

    def _is_one(self, guide: PointGuide, other: PointGuide, on: Mapping[str, Sequence[str]]) -> bool:
        parallel = abs((guide.along * other.along.conjugate()).imag) <= 1e-9
        return parallel and any(k in on[other.point] for k in on[guide.point])

    def _gears(self) -> Iterator[DrawnGear]:
        for k, one in enumerate(self.ratios):
            first, second, carrier = (FRAME if j < 0 else f"link {j}" for j in (one.first, one.second, one.carrier))
            at, there, ratio = one.first_at, one.second_at, one.ratio
            if 0.0 < ratio < 1.0:  # of a ring the second is the ring
                first, second, at, there, ratio = second, first, there, at, 1.0 / ratio
            gap = abs(complex(self.places[at][0] - self.places[there][0]))
            key, sizes = f"gear {k}", (gap / (1.0 - ratio), gap * ratio / (ratio - 1.0))
            kind: GearKind = "gears"
            if abs(ratio - 1.0) < STAYS:
                kind, sizes = "belt", (gap / 4.0, gap / 4.0)
            elif ratio > 0.0:
                kind, sizes = "ring", (gap / (ratio - 1.0), gap * ratio / (ratio - 1.0))
            yield DrawnGear(key, kind, first, second, carrier, at, there, sizes)

    # --- drivers ------------------------------------------------------------------------------------------------------

    def _driver(
        self, one: MovingInput, guides: Sequence[DrawnGuideway], links: list[DrawnLink], on: dict[str, list[str]]
    ) -> tuple[DrawnDriver, list[DrawnGuideway]]:
        """Return the driver of an input: what goes evenly with it, a turn, a slide, or the length of a cylinder.

        A cylinder takes a barrel and a rod.
        """
        over, rest = self._alone(one), self._others(one)
        found = [*self._turned(over, rest, guides), *self._slid(over, rest, guides), *self._lengthened(over, rest)]
        if not found:
            what = f"{one.name} drives neither the turn of a link, nor a slide, nor the distance of two points"
            raise InvalidInput(Problem(self.where, what, "drive a crank, a slider or a cylinder"))
        best = min(found, key=lambda choice: (not choice.is_even, _KINDS.index(choice.kind)))
        travel = self._travel(one, best.course)
        pace = abs(travel[1] - travel[0]) / (one.high - one.low)
        if not any(abs(pace - unit) <= 1e-6 * unit for unit in (1.0, TURN / 360.0)):
            self.notes.append(f"{one.name} is not itself the driver: what it moves is, over the same way")
        if best.kind == "turn" and len(self.inputs) == 1 and abs(abs(travel[1] - travel[0]) - TURN) < 1e-9:
            return best.driver, []  # the whole turn
        if best.kind != "way between":
            return replace(best.driver, travel=travel), []
        start, end = best.driver.link, best.driver.on
        barrel, rod = f"barrel {plain_name(one.name)}", f"rod {plain_name(one.name)}"
        links += [DrawnLink(barrel), DrawnLink(rod)]
        on[start].append(barrel)
        on[end].append(rod)
        here, there = (complex(self.places[name][0]) for name in (start, end))
        key = f"cylinder {plain_name(one.name)}"
        guide = DrawnGuideway(key, "slide", rod, barrel, end, here, float(np.angle(there - here)))
        return DrawnDriver(rod, barrel, key, None, travel), [guide]

    def _alone(self, one: MovingInput) -> Mapping[str, Number]:
        """Return all points while one driver goes over its range, from where it is drawn first."""
        rows = {other.name: np.full(_ALONG + 1, other.here) for other in self.inputs}
        rows[one.name] = np.concatenate([[one.here], np.linspace(one.low, one.high, _ALONG)])
        return self._placed(rows)

    def _others(self, one: MovingInput) -> Mapping[str, Number]:
        rows = dict(self.poses)
        rows[one.name] = np.full(len(rows[one.name]), one.here)
        return self._placed(rows)

    def _placed(self, rows: Mapping[str, Number]) -> Mapping[str, Number]:
        found = self._moving.evaluated(rows)
        return {name: found.values[name] for name in self.places if name in found.values}

    def _follows(self, row: Number, rest: Number) -> bool:
        """Return whether a measure goes one way with a driver, and with no other."""
        good = row[1:][np.isfinite(row[1:])]
        if good.size < _ALONG // 10 or np.ptp(good) <= 1e-6 * self.size:
            return False
        steps = np.diff(good)
        one_way = bool(np.all(steps > 0.0) or np.all(steps < 0.0))
        return one_way and (len(self.inputs) == 1 or self._moving.stays(rest))

    def _travel(self, one: MovingInput, row: Number) -> tuple[float, float]:
        """Return how far a measure goes from where it is drawn."""
        good = np.flatnonzero(np.isfinite(row[1:])) + 1
        if good.size < _ALONG:
            self.notes.append(f"{one.name} goes as far as the construction has its points")
        return float(row[good[0]] - row[0]), float(row[good[-1]] - row[0])

    def _turned(
        self, over: Mapping[str, Number], rest: Mapping[str, Number], guides: Sequence[DrawnGuideway]
    ) -> Iterator[_DrivenCourse]:
        """Yield the turns of links about pins: on the frame, on each other, on blocks."""
        for base in range(-1, len(self.bodies)):
            own = self.fixed if base < 0 else self.bodies[base].points
            host = FRAME if base < 0 else f"link {base}"
            blocks = [(one.at, one.link) for one in guides if one.on == host and one.link.startswith("block ")]
            for k, body in enumerate(self.bodies):
                places = [(n, host) for n in body.points if n in own] or [b for b in blocks if b[0] in body.points]
                if k == base or not places:
                    continue
                row, others = (self._angle(k, base, rows) for rows in (over, rest))
                if row is not None and others is not None and self._follows(row * self.size, others * self.size):
                    at, link = places[0]
                    kind = "turn" if link == FRAME else "turn on a link"
                    yield _DrivenCourse(kind, _is_even(row), DrawnDriver(f"link {k}", link, at), row)

    def _slid(
        self, over: Mapping[str, Number], rest: Mapping[str, Number], guides: Sequence[DrawnGuideway]
    ) -> Iterator[_DrivenCourse]:
        for guide in guides:
            if guide.on.startswith("barrel "):
                continue
            row, others = (self._along_guide(guide, rows) for rows in (over, rest))
            if row is not None and others is not None and self._follows(row, others):
                yield _DrivenCourse("slide", _is_even(row), DrawnDriver(guide.link, guide.on, guide.key), row)

    def _lengthened(self, over: Mapping[str, Number], rest: Mapping[str, Number]) -> Iterator[_DrivenCourse]:
        """Yield distances between points, those that are made of each other first; link and on stand for the points."""
        near = [(a, b) for b in self.moving for a in self._moving.made_of(b)]
        for start, end in dict.fromkeys([*near, *combinations([*self.fixed, *self.moving], 2)]):
            if start in over and end in over and not {start, end} <= set(self.fixed):
                row, others = (np.abs(rows[end] - rows[start]) for rows in (over, rest))
                if self._follows(row, others):
                    yield _DrivenCourse("way between", _is_even(row), DrawnDriver(start, end, ""), row)

    def _angle(self, k: int, base: int, rows: Mapping[str, Number]) -> Number | None:
        turned = self._direction(k, rows)
        under = 1.0 if base < 0 else self._direction(base, rows)
        if turned is None or under is None:
            return None
        with np.errstate(all="ignore"):
            row = np.angle(turned * np.conj(under))
        good = np.isfinite(row)
        row[1:][good[1:]] = np.unwrap(row[1:][good[1:]])
        if good[0] and good[1:].any():  # the drawn pose is on the way
            near = row[1:][good[1:]]
            row[0] += TURN * np.round(
                (near[np.argmin(np.abs(np.exp(1j * near) - np.exp(1j * row[0])))] - row[0]) / TURN
            )
        return row

    def _direction(self, k: int, rows: Mapping[str, Number]) -> Number | None:
        a, b = (rows.get(name) for name in self.bodies[k].points[:2])
        return None if a is None or b is None else b - a

    def _along_guide(self, guide: DrawnGuideway, rows: Mapping[str, Number]) -> Number | None:
        place = rows.get(guide.at)
        if place is None:
            return None
        if guide.on == FRAME:
            return (place * np.exp(-1j * guide.angle)).real
        a, b = (rows.get(name) for name in self.bodies[int(guide.on.split()[1])].points[:2])
        if a is None or b is None:
            return None
        turn = (b - a) / (self._drawn_gap(guide.on))
        return ((place - a) / turn * np.exp(-1j * guide.angle)).real

    def _drawn_gap(self, link: str) -> complex:
        a, b = (self.places[name][0] for name in self.bodies[int(link.split()[1])].points[:2])
        return complex(b - a)

    # --- tried --------------------------------------------------------------------------------------------------------

    def tried(self, found: Imported) -> Iterator[str]:
        """Yield notes where the mechanism, solved, has its points elsewhere than the construction."""
        mechanism = found.mechanism
        try:
            motion = quietly_solved(decompose(mechanism))
        except CompoundkinError as error:
            told = getattr(error, "problems", ())
            yield f"it was not tried by solving it: {told[0].what if told else error}"
            return
        if len(self.inputs) != 1:
            return
        alone = self._alone(self.inputs[0])
        letters = {name: plain_name(name) for name in self.moving if plain_name(name) in mechanism.carriers}
        good = np.ravel(motion.assembled)
        worst = {}
        for name, letter in letters.items():
            if name not in alone or not good.any():
                continue
            path = alone[name][1:][np.isfinite(alone[name][1:])]
            places = np.broadcast_to(np.ravel(motion.points[letter].position), good.shape)[good]
            if path.size:
                worst[name] = float(max(_off(place, path) for place in places))
        far = [name for name, gap in worst.items() if gap > 1e-3 * self.size]
        if far:
            share = max(worst[name] for name in far)
            yield (
                f"{abbreviated_list(far)} leave the paths that the construction has, by {share:.3g} at the most: "
                "it may take another mode where links are in line"
            )
