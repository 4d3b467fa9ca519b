"""The mechanism of a drawing: its letters, pairs, drivers and loads."""

from __future__ import annotations

import warnings
from cmath import phase, rect
from collections import Counter
from collections.abc import Iterator, Sequence
from math import atan2, ceil, isfinite, log10
from typing import Any

import numpy as np

from compoundkin.base.arrays import TURN, first_entry
from compoundkin.base.display import abbreviated_list, count_phrase
from compoundkin.base.errors import InvalidInput, InvalidMechanism, LikelySlip, Problem
from compoundkin.files.exchange.content import Problems
from compoundkin.files.exchange.contract import Imported
from compoundkin.files.exchange.drawing import (
    Drawing,
    DrawnArc,
    DrawnDriver,
    DrawnGear,
    DrawnGuideway,
    DrawnMass,
    DrawnPoint,
    DrawnRack,
)
from compoundkin.files.exchange.foreign_texts import ForeignNames, letters
from compoundkin.files.read_values import spaced
from compoundkin.model.attributes import OF_POINTS
from compoundkin.model.elements import Drive, drawn, drive, link
from compoundkin.model.fields import Item
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads.force import force
from compoundkin.model.loads.gravity import gravity
from compoundkin.model.loads.mass import mass
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.arc import arc
from compoundkin.model.pairs.belt import belt
from compoundkin.model.pairs.gear import gear
from compoundkin.model.pairs.prismatic import slide
from compoundkin.model.pairs.rack import rack
from compoundkin.model.pairs.slot import slot

# A mechanism of more elements than this takes longer to look at than anybody waits; the largest known have hundreds.
MOST = 2000


def mechanism_of(drawing: Drawing, form: str, where: str = "") -> Imported:
    """Return the mechanism that a drawing shows. Its assembly mode is the one drawn.

    `form` is the word of the format it was read from, `where` the file. Raises InvalidInput where the drawing is of
    more elements than can be looked at, or names what is not there; InvalidMechanism for what cannot be a mechanism.
    """
    problems = Problems(where)
    many = len(drawing.points) + len(drawing.links) + len(drawing.guides)
    if many > MOST:
        problems.add("", f"it has {many} links, points and guides", f"at most {MOST} are read")
        problems.raise_if_any()
    check(drawing, problems)
    problems.raise_if_any()
    letters = DrawnLetters(drawing)
    try:
        pairs = pairs_of(drawing, letters)
        mechanism, notes = _built(drawing, letters, pairs)
    except InvalidMechanism as error:
        told = [_translated(problem, drawing, letters) for problem in error.problems]
        raise InvalidInput(told, heading=f"{where or drawing.title or form}: it cannot be a mechanism") from None
    return Imported(mechanism, form, (*drawing.notes, *_renamed(letters), *notes, *_left_out(drawing)))


def _built(drawing: Drawing, letters: DrawnLetters, pairs: dict[str, Pair]) -> tuple[Mechanism, list[str]]:
    items: list[Item] = [*_links(letters), *pairs.values(), drawn(**letters.places)]
    notes: list[str] = []
    drivers = drivers_of(drawing, letters, pairs, notes)
    about: dict[str, Any] = {"unit": drawing.unit, "source": drawing.source}
    about["outputs"] = tuple(f"{letters.point[key]}.{OF_POINTS[0]}" for key in drawing.outputs)
    mechanism = Mechanism(drawing.title or "Mechanism", *items, *drivers, **about)
    if not (drawing.masses or drawing.forces or drawing.gravity):
        return mechanism, notes
    loads = loads_of(drawing, letters, mechanism, notes)
    if drawing.units is not None:
        about["unit"], about["units"] = "", dict(zip(("length", "mass", "force"), drawing.units, strict=True))
    with warnings.catch_warnings(record=True) as said:
        # what is odd in another program's file is told with what else is told of it
        warnings.simplefilter("always", LikelySlip)
        whole = Mechanism(mechanism.title, *items, *drivers, *loads, **about)
    return whole, [*notes, *(str(one.message) for one in said)]


def _links(letters: DrawnLetters) -> Iterator[Item]:
    """Yield the links by their letters; one whose points are all at one place by these, for nothing is read off."""
    for key, name in letters.link.items():
        own = letters.ordered(key)
        if key != FRAME and len(own) > 1 and letters.axis(key) is None:
            yield link(name, **dict.fromkeys(own, 0j))
        else:
            yield link(name, *own)


def _translated(problem: Problem, drawing: Drawing, letters: DrawnLetters) -> Problem:
    """Return a problem of the mechanism in the words of its file, with points that may be meant to be joined."""
    found = next((one for one in drawing.links if problem.where == f"links.{letters.link[one.key]}"), None)
    if found is None:
        return problem
    hint = next((text for point in drawing.points_of(found.key) for text in _coinciding(point.key, drawing)), "")
    place = found.where or f"link {found.called}"
    return Problem(place, f"link {found.called!r}: {problem.what}", hint or problem.remedy)


def _coinciding(key: str, drawing: Drawing) -> Iterator[str]:
    point = next(one for one in drawing.points if one.key == key)
    for other in drawing.points:
        if other.key != key and abs(other.at - point.at) <= SAME * (abs(point.at) + 1.0):
            yield f"did you mean to join {point.called} and {other.called}, which are at one place?"


def _renamed(letters: DrawnLetters) -> Iterator[str]:
    changed = [f"{old!r} is {new!r}" for old, new in letters.names.changed]
    if changed:
        yield f"names are unique here, without dots and commas: {abbreviated_list(changed)}"


def _left_out(drawing: Drawing) -> Iterator[str]:
    """Yield the one note that counts what is not kinematic."""
    said = [count_phrase(many, what) for what, many in drawing.dropped if many]
    if said:
        yield f"left out, for it does not move anything: {', '.join(said)}"


# Places nearer to each other than this part of the drawing are one: what rounding leaves of sums of coordinates.
SAME = 1e-12


class DrawnLetters:
    """Names and places of a drawing's links and points.

    `link` and `point` have the names by keys; `of` has the letters of each link by its name, `places` the place of each
    letter, as drawn.
    """

    def __init__(self, drawing: Drawing) -> None:
        self.drawing = drawing
        self.names = ForeignNames()
        self._letters = letters(set())
        self.link: dict[str, str] = {FRAME: FRAME}
        for one in drawing.links:
            if one.key != FRAME:
                self.link[one.key] = self.names.give(one.called, "link")
        self.of: dict[str, list[str]] = {name: [] for name in self.link.values()}
        self.places: dict[str, complex] = {}
        self.point: dict[str, str] = {}
        self.size = size_of(drawing)
        merged = _merged(drawing, self.size)
        for point in drawing.points:
            if point.key not in merged:
                self.point[point.key] = self._add(point.called, point.at, point.links)
        for key, other in merged.items():
            self.point[key] = self.point[other]

    def _add(self, wanted: str, at: complex, links: tuple[str, ...]) -> str:
        letter = self.names.give(wanted, next(self._letters))
        self.places[letter] = at
        for key in dict.fromkeys(links):
            self.of[self.link[key]].append(letter)
        return letter

    def added(self, wanted: str, at: complex, link: str) -> str:
        """Add a letter to a link that the other program has no name for. It is not told as renamed."""
        letter = self._add(wanted, at, (link,))
        self.names.changed = [(old, new) for old, new in self.names.changed if new != letter]
        return letter

    def there(self, link: str, at: complex) -> str | None:
        """Return the letter that a link, by its key, has at a place."""
        near = SAME * self.size
        return next((k for k in self.of[self.link[link]] if abs(self.places[k] - at) <= near), None)

    def axis(self, link: str) -> float | None:
        """Return the angle of a link's own x axis as drawn.

        None where its letters are at one place.
        """
        if link == FRAME:
            return 0.0
        first, *others = self.ordered(link) or [""]
        second = next(iter(others), None)
        if second is None or self._is_one(first, second):
            return None
        line = self.places[second] - self.places[first]
        return atan2(line.imag, line.real)

    def ordered(self, link: str) -> list[str]:
        """Return a link's letters.

        The second is at another place than the first wherever there is one.
        """
        own = self.of[self.link[link]]
        other = next((k for k in own[1:] if not self._is_one(own[0], k)), None)
        return own if other is None else [own[0], other, *(k for k in own[1:] if k != other)]

    def _is_one(self, one: str, other: str) -> bool:
        return abs(self.places[one] - self.places[other]) <= SAME * self.size

    def directed(self, link: str, along: complex, word: str) -> None:
        """See to it that a link has a direction.

        One whose letters are at one place is given a letter `along`.
        """
        if self.axis(link) is None:
            own = self.of[self.link[link]]
            self.added(f"{self.link[link]} {word}", (self.places[own[0]] if own else 0j) + along, link)


def size_of(drawing: Drawing) -> float:
    """Return the diagonal of the box around all that is drawn."""
    return size_around([point.at for point in drawing.points] + [guide.through for guide in drawing.guides])


def size_around(places: Sequence[complex]) -> float:
    """Return the diagonal of the box around places.

    Where they are one it is their distance from the origin, where that is nothing 1.

    >>> size_around([1j, 3 + 1j, 4j]), size_around([2j]), size_around([])
    (4.242640687119285, 2.0, 1.0)
    """
    if not places:
        return 1.0
    wide = max(p.real for p in places) - min(p.real for p in places)
    high = max(p.imag for p in places) - min(p.imag for p in places)
    return abs(complex(wide, high)) or max(map(abs, places)) or 1.0


def _merged(drawing: Drawing, size: float) -> dict[str, str]:
    """Return points that guides have for themselves where their link has another: its key by theirs."""
    guided = {guide.at for guide in drawing.guides} | {one.at for one in drawing.arcs}
    own = {point.key: point for point in drawing.points if len(point.links) == 1 and point.key in guided}
    found: dict[str, str] = {}
    for key, point in own.items():
        other = next((o for o in drawing.points_of(point.links[0]) if _stands_in(o, point, size)), None)
        if other is not None and other.key not in found:
            found[key] = other.key
    return found


def _stands_in(other: DrawnPoint, point: DrawnPoint, size: float) -> bool:
    return other.key != point.key and abs(other.at - point.at) <= SAME * size


def check(drawing: Drawing, problems: Problems) -> None:
    """Note what no drawing may have.

    Such are keys that are not there or twice, places that are not finite.
    """
    keys = {link.key for link in drawing.links} | {FRAME}
    known = {point.key for point in drawing.points}
    if len(known) < len(drawing.points) or len(keys - {FRAME}) < sum(link.key != FRAME for link in drawing.links):
        problems.add("", "two elements have the same key")
    for point in drawing.points:
        if not (isfinite(point.at.real) and isfinite(point.at.imag)):
            problems.add(point.where, f"point {point.called!r} has no finite place")
        if not point.links or not keys.issuperset(point.links):
            problems.add(point.where, f"point {point.called!r} is of a link that is not there")
    guided: tuple[DrawnGuideway | DrawnArc, ...] = (*drawing.guides, *drawing.arcs)
    for pair in guided:
        if not {pair.link, pair.on} <= keys or pair.at not in known:
            problems.add(pair.where, f"{pair.key!r} names a link or a point that is not there")


# How the letters are called that guides and wheels need and the other program has none for.
GUIDE, CENTRE, AXIS = "guide", "centre", "axis"


def pairs_of(drawing: Drawing, letters: DrawnLetters) -> dict[str, Pair]:
    """Return the pairs by their keys, and give the links what letters they need."""
    _direct(drawing, letters)
    found: dict[str, Pair] = {}
    for guide in drawing.guides:
        found[guide.key] = _guide(guide, letters)
    for one in drawing.arcs:
        found[one.key] = _arc(one, letters)
    for wheels in drawing.gears:
        found[wheels.key] = _gear(wheels, letters)
    for line in drawing.racks:
        found[line.key] = _rack(line, letters)
    return _distinguished(found)


def _direct(drawing: Drawing, letters: DrawnLetters) -> None:
    """Give a direction to the links whose own angle counts: carriers, wheels, blocks in two guides."""
    slides = [guide for guide in drawing.guides if guide.kind == "slide"]
    often = Counter(guide.link for guide in slides)
    for guide in drawing.guides:
        along = rect(letters.size, guide.angle)
        if guide.on != FRAME:
            if letters.there(guide.on, guide.through) is None and not guide.ends:
                letters.added(f"{letters.point[guide.at]} {GUIDE}", guide.through, guide.on)
            letters.directed(guide.on, along, AXIS)
        if guide.kind == "slide" and guide.link != FRAME and often[guide.link] > 1:
            letters.directed(guide.link, along, AXIS)
    for one in _wheels(drawing):
        letters.directed(one, complex(letters.size), AXIS)


def _wheels(drawing: Drawing) -> Iterator[str]:
    for gear_ in drawing.gears:
        yield from (link for link in (gear_.first, gear_.second, gear_.carrier) if link != FRAME)
    for line in drawing.racks:
        yield from (link for link in (line.rack, line.pinion) if link != FRAME)


def _guide(guide: DrawnGuideway, letters: DrawnLetters) -> Pair:
    at = letters.point[guide.at]
    through, words = _line(guide, letters)
    offset = (rect(1.0, -guide.angle) * (letters.places[at] - letters.places[through])).imag
    if abs(offset) > SAME * letters.size:
        words["offset"] = offset if guide.ends or guide.kind == "slide" else 0.0
    words["on"], words["at"], words["through"] = letters.link[guide.on], at, through
    if guide.reach is not None:
        moved = (rect(1.0, -guide.angle) * (guide.through - letters.places[through])).real
        words["reach"] = (guide.reach[0] + moved, guide.reach[1] + moved)
    word: Any = slide if guide.kind == "slide" else slot
    made: Pair = word(letters.link[guide.link], name=guide.name, **words)
    return made


def _line(guide: DrawnGuideway, letters: DrawnLetters) -> tuple[str, dict[str, Any]]:
    """Return the letter that a guide runs through, and its direction: toward a letter, or by its angle."""
    if guide.ends:
        return letters.point[guide.ends[0]], {"toward": letters.point[guide.ends[1]]}
    name = f"{letters.point[guide.at]} {GUIDE}"
    through = letters.there(guide.on, guide.through) or letters.added(name, guide.through, guide.on)
    return through, {"angle": _own_angle(guide.angle, guide.on, letters)}


def _own_angle(angle: float, link: str, letters: DrawnLetters) -> float:
    """Return an angle in space as one from the x axis of a link, between -pi and pi."""
    if link == FRAME:
        return angle
    return phase(rect(1.0, angle - (letters.axis(link) or 0.0)))


def _arc(one: DrawnArc, letters: DrawnLetters) -> Pair:
    centre = letters.point[one.centre_at] if one.centre_at else letters.there(one.on, one.centre)
    at = letters.point[one.at]
    made: Pair = arc(
        letters.link[one.link],
        on=letters.link[one.on],
        at=at,
        centre_at=centre or letters.added(f"{at} {CENTRE}", one.centre, one.on),
        radius=one.radius,
        name=one.name,
    )
    return made


def _gear(wheels: DrawnGear, letters: DrawnLetters) -> Pair:
    word: Any = belt if "belt" in wheels.kind else gear
    sense = {"ring": {"internal": True}, "crossed belt": {"crossed": True}}.get(wheels.kind, {})
    made: Pair = word(
        letters.link[wheels.first],
        letters.link[wheels.second],
        carrier=letters.link[wheels.carrier],
        first_at=letters.point[wheels.first_at],
        second_at=letters.point[wheels.second_at],
        name=wheels.name,
        **{"teeth" if wheels.in_teeth else "radii": wheels.sizes},
        **sense,
    )
    return made


def _rack(line: DrawnRack, letters: DrawnLetters) -> Pair:
    at = letters.point[line.at]
    through = letters.there(line.rack, line.through) or letters.added(f"{at} {GUIDE}", line.through, line.rack)
    left = (rect(1.0, -line.angle) * (letters.places[at] - line.through)).imag > 0
    made: Pair = rack(
        letters.link[line.rack],
        letters.link[line.pinion],
        through=through,
        at=at,
        angle=_own_angle(line.angle, line.rack, letters),
        radius=line.radius,
        side=1 if left else -1,
        name=line.name,
    )
    return made


def _distinguished(pairs: dict[str, Pair]) -> dict[str, Pair]:
    """Return pairs with names of their own: of several that would be called alike, all but the first are numbered."""
    from dataclasses import replace

    used: set[str] = set()
    found = {}
    for key, pair in pairs.items():
        name = next(
            n for k in range(1, len(pairs) + 2) if (n := pair.name if k == 1 else f"{pair.name} {k}") not in used
        )
        used.add(name)
        found[key] = pair if name == pair.name else replace(pair, name=name)
    return found


# How far a length is driven, as a part of the size, where the other program does not say.
TRAVEL = 0.1


# So many steps, of which each has few digits where the way has few, as the seventy-second part has not.
STEPS = 80


# So many digits of a way are written: fewer would be seen, more are rounding.
_DIGITS = 12


def drivers_of(drawing: Drawing, letters: DrawnLetters, pairs: dict[str, Pair], notes: list[str]) -> list[Drive]:
    """Return the drivers.

    One that is told no way makes a full turn, or goes a little both ways along its guide, which is noted. Several of
    them start together from the pose as drawn, each at its own speed: at once from zero most could not be assembled.
    """
    several = len(drawing.drivers) > 1
    found = []
    for one in drawing.drivers:
        guide = next((guide for guide in drawing.guides if guide.key == one.at), None)
        start = _drawn_value(guide, one, letters)
        travel = one.travel or _reach(guide, letters)
        words: dict[str, Any] = {} if one.speed is None else {"speed": one.speed}
        if travel is not None:
            words["values"] = _direction(start, *travel, guide is None)
        elif guide is not None:
            reach = TRAVEL * letters.size
            words["values"] = _direction(start, 0.0 if several else -reach, reach, guide is None)
            how = "one way" if several else "both ways"
            notes.append(f"{letters.link[one.link]} is driven over a length of {reach:.4g} {how}: no way is told")
        elif several:
            words["values"] = _direction(start, 0.0, TURN * _pace(one, drawing), guide is None)
        found.append(_driver(one, letters, pairs, words))
    return found


def _direction(start: float, low: float, high: float, is_angle: bool) -> Any:
    """Return values in even steps such as files write: from, to and step in degrees or lengths, in few digits."""
    ends = np.array([start, start + low, start + high])
    _, first, last = (np.rad2deg(ends) if is_angle else ends).tolist()
    digits = _DIGITS - ceil(log10(abs(last - first) or 1.0))
    first, step = round(first, digits), round((last - first) / STEPS, digits + 2)
    found = spaced(first, first + STEPS * step, step) if step else None
    if found is None or found.size != STEPS + 1:
        return np.linspace(start + low, start + high, STEPS + 1)
    return np.deg2rad(found) if is_angle else found


def _driver(one: DrawnDriver, letters: DrawnLetters, pairs: dict[str, Pair], words: dict[str, Any]) -> Drive:
    link, on = letters.link[one.link], letters.link[one.on]
    shared = [letter for letter in letters.of[link] if letter in letters.of[on]]
    if len(shared) + sum({*pair.members} == {link, on} for pair in pairs.values()) > 1:
        words["pair"] = pairs[one.at].name if one.at in pairs else letters.point[one.at]
    if one.name:
        words["name"] = one.name
    made = drive(link, on=on, **words)
    assert isinstance(made, Drive)
    return made


def _pace(one: DrawnDriver, drawing: Drawing) -> float:
    """Return how fast a driver turns as a part of the fastest, by its sense; 1 where no speeds are told."""
    fastest = max(abs(other.speed or 0.0) for other in drawing.drivers)
    return 1.0 if one.speed is None or not fastest else one.speed / fastest


def _reach(guide: DrawnGuideway | None, letters: DrawnLetters) -> tuple[float, float] | None:
    """Return how far a guide lets its point go from where it is drawn, or None where it does not say."""
    if guide is None or guide.reach is None:
        return None
    here = _along(guide, guide.through, letters)
    return guide.reach[0] - here, guide.reach[1] - here


def _along(guide: DrawnGuideway, start: complex, letters: DrawnLetters) -> float:
    """Return how far along its line a guide's point is drawn."""
    return float(((letters.places[letters.point[guide.at]] - start) * rect(1.0, -guide.angle)).real)


def _drawn_value(guide: DrawnGuideway | None, one: DrawnDriver, letters: DrawnLetters) -> float:
    """Return the value that the drawing shows of a driver."""
    if guide is None:
        return phase(rect(1.0, (letters.axis(one.link) or 0.0) - (letters.axis(one.on) or 0.0)))
    start = letters.point[guide.ends[0]] if guide.ends else letters.there(guide.on, guide.through)
    return _along(guide, letters.places[str(start)], letters)


def loads_of(drawing: Drawing, letters: DrawnLetters, mechanism: Mechanism, notes: list[str]) -> Iterator[Item]:
    """Yield masses, forces, gravity; places as drawn become places in the links' own frames."""
    for one in drawing.masses:
        yield _mass(one, letters, mechanism, notes)
    for count, load in enumerate(drawing.forces, start=1):
        name = letters.link[load.link]
        turned = _own(mechanism, name, load.force, 0j) if load.turns else load.force
        place = _own(mechanism, name, load.at, None)
        if place is None or turned is None:
            notes.append(f"force {load.name or count} is left out: the drawing does not show how {name!r} is turned")
            continue
        xy, at = (turned.real, turned.imag), (place.real, place.imag)
        yield force(name, xy, at=at, fixed_in=name if load.turns else FRAME, name=load.name or f"force {count}")
    if drawing.gravity is not None:
        yield gravity(drawing.gravity.real, drawing.gravity.imag, unit="m/s^2")


def _mass(one: DrawnMass, letters: DrawnLetters, mechanism: Mechanism, notes: list[str]) -> Item:
    name = letters.link[one.link]
    centre = None if one.centre is None else _own(mechanism, name, one.centre, None)
    if one.centre is not None and centre is None:
        notes.append(f"the mass centre of {name!r} is at its point: the drawing does not show how it is turned")
        centre = 0j
    at = None if centre is None else (centre.real, centre.imag)
    made: Item = mass(name, one.mass, at=at, inertia=one.inertia)
    return made


def _own(mechanism: Mechanism, link: str, place: complex, origin: complex | None) -> complex | None:
    """Return a place as drawn in a link's own frame, a direction where `origin` is 0; None where that is not shown."""
    pose = mechanism.drawn_poses.get(link)
    if pose is None:
        return None
    u = complex(first_entry(pose.u.c[0]))
    start = complex(first_entry(pose.z.c[0])) if origin is None else origin
    return (place - start) * u.conjugate()
