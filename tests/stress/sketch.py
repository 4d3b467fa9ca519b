"""A mechanism as the stress suite draws it: places of letters in one pose, pairs between links, drives, frames.

Everything is known in the world, at the drawn pose; `Placed` has it in the links' own frames, in which the words of the
package and the suite's own equations are written. Nothing here is read from the package.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

import compoundkin as ck

FRAME = "frame"


@dataclass
class Joint:
    """A pair other than a pin: its kind, the links in the order of its equations, and what it is drawn with."""

    kind: str
    name: str
    links: tuple[str, ...]
    at: tuple[str, ...]
    drawn: dict[str, Any]


@dataclass
class Driver:
    """A driver of the pin `pair` or of the joint `pair`: `sign` -1 where the link written is the first one."""

    name: str
    link: str
    on: str
    pair: str
    kind: str
    sign: int = 1


@dataclass
class Sketch:
    """What is drawn: `own` are poses of links given by coordinates, the others are as drawn."""

    places: dict[str, complex] = field(default_factory=dict)
    letters: dict[str, list[str]] = field(default_factory=dict)
    own: dict[str, tuple[complex, float]] = field(default_factory=dict)
    as_drawn: set[str] = field(default_factory=set)
    joints: list[Joint] = field(default_factory=list)
    drivers: list[Driver] = field(default_factory=list)

    def copy(self) -> Sketch:
        letters = {k: list(v) for k, v in self.letters.items()}
        own, drawn = dict(self.own), set(self.as_drawn)
        return Sketch(dict(self.places), letters, own, drawn, list(self.joints), list(self.drivers))

    def letter(self, place: complex, *links: str) -> str:
        name = f"P{len(self.places)}"
        self.places[name] = complex(place)
        for link in links:
            self.letters[link].append(name)
        return name

    def pins(self) -> dict[str, list[str]]:
        """The links of every letter that is a pin."""
        found: dict[str, list[str]] = {k: [] for k in self.places}
        for link, letters in self.letters.items():
            for letter in letters:
                found[letter].append(link)
        return {k: v for k, v in found.items() if len(v) > 1}

    def pose(self, link: str) -> tuple[complex, float]:
        """Origin and angle of a link's frame in the drawn pose."""
        if link == FRAME:
            return 0j, 0.0
        if self.is_read_off(link):
            first, second = (self.places[k] for k in self.letters[link][:2])
            return first, float(np.angle(second - first))
        return self.own[link]

    def is_read_off(self, link: str) -> bool:
        return link in self.as_drawn and len(self.letters[link]) > 1

    def shows(self, link: str) -> bool:
        """Whether the drawing shows how a link is turned."""
        return link == FRAME or len(self.letters[link]) > 1

    @property
    def size(self) -> float:
        places = np.array(list(self.places.values()))
        return float(max(np.ptp(places.real), np.ptp(places.imag)))


class Placed:
    """A sketch in the links' own frames: local points, and the numbers of every joint."""

    def __init__(self, sketch: Sketch) -> None:
        self.sketch = sketch
        self.poses = {link: sketch.pose(link) for link in sketch.letters}
        self.turn = {link: np.exp(1j * angle) for link, (_, angle) in self.poses.items()}
        self.points = {
            link: {k: self.local(link, sketch.places[k]) for k in letters} for link, letters in sketch.letters.items()
        }
        self.joints = {joint.name: NUMBERS[joint.kind](self, joint) for joint in sketch.joints}

    def local(self, link: str, place: complex) -> complex:
        return complex(np.conj(self.turn[link]) * (place - self.poses[link][0]))

    def angle(self, link: str) -> float:
        return self.poses[link][1]

    def values(self) -> dict[str, float]:
        """The drivers' values in the drawn pose."""
        return {d.name: self._value(d) for d in self.sketch.drivers}

    def _value(self, driver: Driver) -> float:
        if driver.kind == "R":
            return self.angle(driver.link) - self.angle(driver.on)
        return driver.sign * float(self.joints[driver.pair]["value"])

    def mechanism(self, title: str) -> ck.Mechanism:
        """It in the words of the package."""
        s = self.sketch
        items: list[Any] = []
        for link, letters in s.letters.items():
            if s.is_read_off(link):
                items.append(ck.link(link, *letters))
            else:
                items.append(ck.link(link, **self.points[link]))
        items += [WORDS[j.kind](self, j) for j in s.joints]
        items += [ck.drive(d.link, on=d.on, pair=d.pair, name=d.name) for d in s.drivers]
        return ck.Mechanism(title, *items, ck.drawn(**s.places))


# --- numbers of joints, in the frames of their links -------------------------------------------------------


def _line(placed: Placed, joint: Joint) -> dict[str, Any]:
    """A line of the first link past a point of the second: where it starts, its angle, how far the point is off."""
    on, link = joint.links
    at, through = (placed.sketch.places[k] for k in joint.at[:2])
    if len(joint.at) > 2:
        direction = np.angle(placed.points[on][joint.at[2]] - placed.points[on][through_of(joint)])
        world = direction + placed.angle(on)
    else:
        world = joint.drawn["direction"]
        direction = world - placed.angle(on)
    e = np.exp(1j * world)
    gap = np.conj(e) * (at - through)
    return {
        "angle": float(direction),
        "offset": float(gap.imag),
        "value": float(gap.real),
        "start": placed.points[on][through_of(joint)],
        "point": placed.points[link][joint.at[0]],
    }


def through_of(joint: Joint) -> str:
    return joint.at[1]


def _slide(placed: Placed, joint: Joint) -> dict[str, Any]:
    numbers = _line(placed, joint)
    on, link = joint.links
    numbers["turn"] = placed.angle(link) - placed.angle(on) - numbers["angle"]
    return numbers


def _circle(placed: Placed, joint: Joint) -> dict[str, Any]:
    on, link = joint.links
    pin, centre = (placed.sketch.places[k] for k in joint.at)
    return {
        "centre": placed.points[on][joint.at[1]],
        "point": placed.points[link][joint.at[0]],
        "radius": float(abs(pin - centre)),
    }


def _wheel_on_line(placed: Placed, joint: Joint) -> dict[str, Any]:
    numbers = _line(placed, joint)
    on, link = joint.links
    away = numbers.pop("offset")
    numbers["radius"], numbers["side"] = abs(away), 1 if away > 0 else -1
    numbers["phase"] = numbers["value"] + away * (placed.angle(link) - placed.angle(on))
    return numbers


def _wheel_on_circle(placed: Placed, joint: Joint) -> dict[str, Any]:
    on, link = joint.links
    pin, centre = (placed.sketch.places[k] for k in joint.at)
    distance, inside = float(abs(pin - centre)), bool(joint.drawn["inside"])
    radius = distance * joint.drawn["share"]
    circle = distance + radius if inside else distance - radius
    turns = 1.0 - circle / radius if inside else 1.0 + circle / radius
    direction = float(np.angle((pin - centre) * np.conj(placed.turn[on])))
    return {
        "centre": placed.points[on][joint.at[1]],
        "point": placed.points[link][joint.at[0]],
        "distance": distance,
        "radius": radius,
        "circle": circle,
        "inside": inside,
        "turns": turns,
        "value": direction,
        "phase": placed.angle(link) - placed.angle(on) - turns * direction,
    }


def _wheels(placed: Placed, joint: Joint) -> dict[str, Any]:
    first, second, carrier = (placed.angle(k) for k in joint.links)
    one, two = joint.drawn["sizes"]
    if joint.drawn["radii"]:
        apart = abs(placed.sketch.places[joint.at[1]] - placed.sketch.places[joint.at[0]])
        meshed_inside = joint.kind == "G" and joint.drawn["alike"]
        scale = apart / (abs(two - one) if meshed_inside else one + two)
        one, two = one * scale * joint.drawn["slack"], two * scale * joint.drawn["slack"]
    ratio = -one / two if joint.drawn["alike"] else one / two
    return {"sizes": (one, two), "ratio": ratio, "phase": (second - carrier) + ratio * (first - carrier)}


@dataclass(frozen=True)
class Oval:
    """An ellipse: its middle, half axes and tilt in its link's frame. `count` points stand for it where not 0."""

    middle: complex
    a: float
    b: float
    tilt: float
    count: int = 0

    def at(self, s: Any) -> Any:
        return self.middle + np.exp(1j * self.tilt) * (self.a * np.cos(s) + 1j * self.b * np.sin(s))

    def slope(self, s: Any) -> Any:
        return np.exp(1j * self.tilt) * (-self.a * np.sin(s) + 1j * self.b * np.cos(s))

    def bend(self, s: Any) -> Any:
        return self.middle - self.at(s)

    def normal(self, s: Any) -> Any:
        n = self.b * np.cos(s) + 1j * self.a * np.sin(s)
        return np.exp(1j * self.tilt) * n / np.abs(n)

    def parameter(self, normal: complex) -> float:
        """Where its outward normal is this one."""
        n = normal * np.exp(-1j * self.tilt)
        return float(np.arctan2(n.imag * self.b, n.real * self.a))

    def profile(self) -> Any:
        if self.a == self.b:
            return ck.profiles.disc(self.a, self.middle)
        if self.count:
            return ck.profiles.profile(list(self.at(np.linspace(0.0, 2.0 * np.pi, self.count, endpoint=False))))
        return ck.profiles.formula(self.at, 0.0, 2.0 * np.pi)


def _oval(joint: Joint, middle: complex, scale: float) -> Oval:
    a, b, tilt, count = joint.drawn["oval"]
    return Oval(middle, a * scale, b * scale, tilt, count)


def _cam(placed: Placed, joint: Joint) -> dict[str, Any]:
    on, link = joint.links
    s, radius, inside = joint.drawn["s"], joint.drawn["radius"] * joint.drawn["unit"], joint.drawn["inside"]
    oval = _oval(joint, 0j, joint.drawn["unit"])
    away = -radius if inside else radius
    middle = placed.local(on, placed.sketch.places[joint.at[0]]) - (oval.at(s) + away * oval.normal(s))
    point = placed.points[link][joint.at[0]]
    oval = _oval(joint, complex(middle), joint.drawn["unit"])
    return {"oval": oval, "radius": radius, "away": away, "inside": inside, "point": point, "s": s}


def _face(placed: Placed, joint: Joint) -> dict[str, Any]:
    on, link = joint.links
    e, side = np.exp(1j * joint.drawn["direction"]), joint.drawn["side"]
    place = placed.sketch.places[joint.at[0]] + e * joint.drawn["along"] * joint.drawn["unit"]
    oval = _oval(joint, 0j, joint.drawn["unit"])
    s = oval.parameter(complex(e * (-1j * side) * np.conj(placed.turn[on])))
    middle = placed.local(on, complex(place)) - oval.at(s)
    return {
        "oval": _oval(joint, complex(middle), joint.drawn["unit"]),
        "angle": float(joint.drawn["direction"] - placed.angle(link)),
        "side": side,
        "point": placed.points[link][joint.at[0]],
        "s": s,
    }


NUMBERS: dict[str, Any] = {
    "P": _slide,
    "S": _line,
    "A": _circle,
    "L": _wheel_on_line,
    "O": _wheel_on_circle,
    "G": _wheels,
    "B": _wheels,
    "K": _wheel_on_line,
    "C": _cam,
    "F": _face,
}


# --- joints in the words of the package ------------------------------------------------------------------


def _guide(joint: Joint, numbers: dict[str, Any]) -> dict[str, Any]:
    through = {"at": joint.at[0], "through": through_of(joint)}
    return {**through, "toward": joint.at[2]} if len(joint.at) > 2 else {**through, "angle": numbers["angle"]}


def _phase(placed: Placed, joint: Joint, numbers: dict[str, Any]) -> dict[str, Any]:
    """The phase is left to the drawing where that shows it and the joint says so."""
    left = joint.drawn.get("unsaid") and all(placed.sketch.shows(link) for link in joint.links)
    return {} if left else {"phase": numbers["phase"]}


def _slide_word(placed: Placed, joint: Joint) -> Any:
    n = placed.joints[joint.name]
    left = joint.drawn.get("unsaid") and all(placed.sketch.is_read_off(k) for k in joint.links)
    said = {} if left else {"offset": n["offset"], "turn": n["turn"]}
    return ck.slide(joint.links[1], on=joint.links[0], name=joint.name, **_guide(joint, n), **said)


def _slot_word(placed: Placed, joint: Joint) -> Any:
    n = placed.joints[joint.name]
    return ck.slot(joint.links[1], on=joint.links[0], name=joint.name, offset=n["offset"], **_guide(joint, n))


def _arc_word(placed: Placed, joint: Joint) -> Any:
    radius, (at, centre) = placed.joints[joint.name]["radius"], joint.at
    return ck.arc(joint.links[1], on=joint.links[0], name=joint.name, at=at, centre_at=centre, radius=radius)


def _wheel_words(placed: Placed, joint: Joint) -> dict[str, Any]:
    n = placed.joints[joint.name]
    sizes = {"radius": n["radius"], "side": n["side"]}
    return {"name": joint.name, **_guide(joint, n), **sizes, **_phase(placed, joint, n)}


def _roll_word(placed: Placed, joint: Joint) -> Any:
    return ck.roll(joint.links[1], on=joint.links[0], **_wheel_words(placed, joint))


def _rack_word(placed: Placed, joint: Joint) -> Any:
    return ck.rack(joint.links[0], joint.links[1], **_wheel_words(placed, joint))


def _around_word(placed: Placed, joint: Joint) -> Any:
    n = placed.joints[joint.name]
    sizes = {k: n[k] for k in ("circle", "radius", "inside")}
    where = {"on": joint.links[0], "at": joint.at[0], "centre_at": joint.at[1], "name": joint.name}
    return ck.roll_around(joint.links[1], **where, **sizes, **_phase(placed, joint, n))


def _wheels_word(placed: Placed, joint: Joint) -> Any:
    n = placed.joints[joint.name]
    first, second, carrier = joint.links
    words = {"carrier": carrier, "first_at": joint.at[0], "second_at": joint.at[1], "name": joint.name}
    words |= {"radii" if joint.drawn["radii"] else "teeth": n["sizes"], **_phase(placed, joint, n)}
    if joint.kind == "G":
        return ck.gear(first, second, internal=joint.drawn["alike"], **words)
    return ck.belt(first, second, crossed=not joint.drawn["alike"], **words)


def _cam_word(placed: Placed, joint: Joint) -> Any:
    n = placed.joints[joint.name]
    words = {"at": joint.at[0], "radius": n["radius"], "inside": n["inside"], "name": joint.name}
    return ck.cam(joint.links[1], on=joint.links[0], profile=n["oval"].profile(), **words)


def _face_word(placed: Placed, joint: Joint) -> Any:
    n = placed.joints[joint.name]
    words = {"at": joint.at[0], "angle": n["angle"], "side": n["side"], "name": joint.name}
    return ck.face(joint.links[1], on=joint.links[0], profile=n["oval"].profile(), **words)


WORDS: dict[str, Any] = {
    "P": _slide_word,
    "S": _slot_word,
    "A": _arc_word,
    "L": _roll_word,
    "O": _around_word,
    "G": _wheels_word,
    "B": _wheels_word,
    "K": _rack_word,
    "C": _cam_word,
    "F": _face_word,
}
