"""Random mechanisms built around a pose and drawn exactly there: their first pose is the drawing, whatever the pairs.

Every link has a random pose; pairs are given the dimensions with which they close. Links may have a single point, and
origins far from it.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

import compoundkin as ck

CASES = 72
LIMIT = 1e-6


@dataclass
class Built:
    """Links with their places and angles in the world, and what is written of them."""

    rng: np.random.Generator
    scale: float
    places: dict[str, complex] = field(default_factory=dict)
    origins: dict[str, complex] = field(default_factory=dict)
    angles: dict[str, float] = field(default_factory=dict)
    letters: dict[str, list[str]] = field(default_factory=dict)
    items: list[Any] = field(default_factory=list)
    values: dict[str, float] = field(default_factory=dict)
    # pairs by which an angle is told from those of other links
    tells: list[tuple[str, tuple[str, ...]]] = field(default_factory=list)

    def place(self) -> complex:
        return complex(*self.rng.uniform(-3.0, 3.0, 2)) * self.scale

    def angle(self) -> float:
        return float(self.rng.uniform(-3.1, 3.1))

    def link(self, name: str) -> str:
        far = 10.0 ** self.rng.uniform(0.0, 1.7)
        is_frame = name == "frame"
        self.origins[name] = 0j if is_frame else self.place() * far
        self.angles[name] = 0.0 if is_frame else self.angle()
        self.letters[name] = []
        return name

    def letter(self, place: complex, *links: str) -> str:
        name = f"P{len(self.places)}"
        self.places[name] = place
        for link in links:
            self.letters[link].append(name)
        return name

    def some(self, link: str, other: str) -> str:
        """A letter of a link, a new one or one that it has; none at which it is pinned to another link."""
        known = [k for k in self.letters[link] if k not in self.letters[other]]
        if known and self.rng.random() < 0.6:
            return str(self.rng.choice(known))
        return self.letter(self.place(), link)

    def own(self, link: str, place: complex) -> complex:
        """A place in a link's own frame."""
        return complex(np.exp(-1j * self.angles[link]) * (place - self.origins[link]))

    def guide(self, on: str, link: str, at: str) -> tuple[str, float, float, float]:
        """A line of a link through the place of a letter: a point, angle, offset and displacement."""
        through = self.some(on, link)
        angle = self.angle()
        away = (self.places[at] - self.places[through]) * np.exp(-1j * (angle + self.angles[on]))
        return through, angle, float(away.imag), float(away.real)

    def told(self) -> set[str]:
        """The links of which the drawing tells the pose."""
        known = {"frame", *(link for link, own in self.letters.items() if len(own) > 1)}
        while True:
            more = {link for link, others in self.tells if link not in known and known.issuperset(others)}
            if not more:
                return known
            known |= more

    def mechanism(self) -> ck.Mechanism:
        for link in self.letters:
            if link not in self.told():
                self.letter(self.place(), link)
        links = [
            ck.link(name, **{k: self.own(name, self.places[k]) for k in own}) for name, own in self.letters.items()
        ]
        return ck.Mechanism("built", *links, *self.items, ck.drawn(**self.places))


def pin(built: Built, one: str, other: str) -> tuple[str, float]:
    """Two links pinned together; the pin and the angle from one to the other."""
    free = [k for k in built.letters[other] if sum(k in own for own in built.letters.values()) == 1]
    if free and built.rng.random() < 0.3:
        letter = free[0]
        built.letters[one].append(letter)
    else:
        letter = built.letter(built.place(), one, other)
    return letter, built.angles[other] - built.angles[one]


def slide(built: Built, on: str, link: str) -> tuple[str, float]:
    """A link that slides on another; the name of the slide and the displacement."""
    at = built.some(link, on)
    through, angle, offset, displacement = built.guide(on, link, at)
    turn = built.angles[link] - built.angles[on] - angle
    name = f"s{len(built.items)}"
    built.items.append(ck.slide(link, on=on, at=at, through=through, angle=angle, offset=offset, turn=turn, name=name))
    built.tells += [(link, (on,)), (on, (link,))]
    return name, displacement


def roll(built: Built, on: str, link: str) -> tuple[str, float]:
    """A wheel on a straight line of another link; the pair and the displacement."""
    at = built.some(link, on)
    _, angle, _, displacement = built.guide(on, link, at)
    # a line at the distance of a radius, on either side
    radius, side = built.scale * built.rng.uniform(0.3, 2.0), int(built.rng.choice([1, -1]))
    place = built.places[at] - (displacement + 1j * side * radius) * np.exp(1j * (angle + built.angles[on]))
    through = built.letter(complex(place), on)
    phase = displacement + side * radius * (built.angles[link] - built.angles[on])
    name = f"s{len(built.items)}"
    built.items.append(
        ck.roll(link, on=on, at=at, through=through, angle=angle, radius=radius, side=side, phase=phase, name=name)
    )
    built.tells.append((link, (on,)))
    return name, displacement


def roll_around(built: Built, on: str, link: str) -> tuple[str, float]:
    """A wheel on a circle of another link; the pair and the direction of the line of centres."""
    at, centre = built.some(link, on), built.letter(built.place(), on)
    line = built.places[at] - built.places[centre]
    share, inside = built.rng.uniform(0.2, 0.8), bool(built.rng.random() < 0.5)
    circle, radius = (abs(line) / (1 - share), abs(line) / (1 - share) * share) if inside else (
        abs(line) * share, abs(line) * (1 - share))  # fmt: skip
    turns = 1.0 + circle / (-radius if inside else radius)
    direction = float(np.angle(line * np.exp(-1j * built.angles[on])))
    phase = built.angles[link] - built.angles[on] - turns * direction
    name = f"s{len(built.items)}"
    built.items.append(
        ck.roll_around(
            link, on=on, at=at, centre_at=centre, circle=circle, radius=radius, inside=inside, phase=phase, name=name
        )
    )
    built.tells.append((link, (on,)))
    return name, direction


Joining = Callable[[Built, str, str], tuple[str, float]]
JOINTS: tuple[Joining, ...] = (pin, slide, roll, roll_around)


def slot(built: Built, on: str, link: str) -> None:
    at = built.letter(built.place(), link)
    through, angle, offset, _ = built.guide(on, link, at)
    built.items.append(
        ck.slot(link, on=on, at=at, through=through, angle=angle, offset=offset, name=f"s{len(built.items)}")
    )


def arc(built: Built, on: str, link: str) -> None:
    at, centre = built.letter(built.place(), link), built.letter(built.place(), on)
    radius = abs(built.places[at] - built.places[centre])
    built.items.append(ck.arc(link, on=on, at=at, centre_at=centre, radius=radius, name=f"s{len(built.items)}"))


def cam(built: Built, on: str, link: str) -> None:
    """A roller on an oval; its middle a new point of the follower."""
    size, s = built.scale * built.rng.uniform(0.5, 1.5), built.rng.uniform(0.0, 2.0 * np.pi)
    middle, roller = built.own(on, built.place()), built.scale * 0.2
    profile = ck.profiles.formula(
        lambda t: middle + size * (1.3 * np.cos(t) + 1j * np.sin(t) + 0.1 * np.cos(2.0 * t)), 0.0, 2.0 * np.pi
    )
    place = middle + size * (1.3 * np.cos(s) + 1j * np.sin(s) + 0.1 * np.cos(2.0 * s))
    along = -1.3 * np.sin(s) + 1j * np.cos(s) - 0.2 * np.sin(2.0 * s)
    centre = built.origins[on] + np.exp(1j * built.angles[on]) * (place - 1j * along / abs(along) * roller)
    at = built.letter(complex(centre), link)
    built.items.append(ck.cam(link, on=on, at=at, profile=profile, radius=roller, name=f"s{len(built.items)}"))


def face(built: Built, on: str, link: str) -> None:
    """A flat face on a round disc."""
    at, angle, side = built.some(link, on), built.angle(), int(built.rng.choice([1, -1]))
    radius = built.scale * built.rng.uniform(0.5, 1.5)
    along = np.exp(1j * (angle + built.angles[link]))
    centre = built.places[at] + along * (built.scale * built.rng.uniform(-2.0, 2.0) + 1j * side * radius)
    middle = built.own(on, complex(centre))
    profile = ck.profiles.disc(radius, (middle.real, middle.imag))
    built.items.append(
        ck.face(link, on=on, at=at, profile=profile, angle=angle, side=side, name=f"s{len(built.items)}")
    )


HIGHER: tuple[Callable[[Built, str, str], None], ...] = (slot, arc, cam, face)


def geared(built: Built, carrier: str, first: str) -> None:
    """A wheel that a gear or a belt turns by a link that is pinned to its carrier."""
    shared = [k for k in built.letters[first] if k in built.letters[carrier]]
    first_at = shared[0]
    second = built.link(f"L{len(built.letters)}")
    second_at = built.letter(built.place(), carrier, second)
    word, sign = (ck.gear, 1.0) if built.rng.random() < 0.5 else (ck.belt, -1.0)
    teeth = [int(n) for n in built.rng.integers(12, 60, 2)]
    a, b, c = (built.angles[name] for name in (first, second, carrier))
    phase = (b - c) + sign * teeth[0] / teeth[1] * (a - c)
    built.items.append(
        word(
            first, second, carrier=carrier, teeth=teeth, phase=phase, first_at=first_at, second_at=second_at,
            name=f"s{len(built.items)}",
        )
    )  # fmt: skip
    built.tells.append((second, (first, carrier)))


def driven(built: Built, on: str, link: str, joint: Joining) -> None:
    pair, value = joint(built, on, link)
    name = f"d{len(built.values)}"
    built.items.append(ck.drive(link, on=on, pair=pair, name=name))
    built.values[name] = value


def random_drawing(seed: int) -> tuple[Built, ck.Mechanism]:
    """A driven link and some groups after it, of all kinds of pairs."""
    rng = np.random.default_rng(seed)
    built = Built(rng, 10.0 ** rng.uniform(-6.0, 6.0))
    known = [built.link("frame"), built.link("L1")]
    driven(built, "frame", "L1", JOINTS[rng.integers(4)])
    for _ in range(rng.integers(1, 4)):
        kind = rng.integers(5)
        outside = [str(name) for name in rng.choice(known, 3)]
        new = [built.link(f"L{len(built.letters) + i}") for i in range(1)]
        if kind == 0:  # one body on a pair and a higher pair
            JOINTS[rng.integers(2)](built, outside[0], new[0])
            other = next(name for name in reversed(known) if name != outside[0])
            HIGHER[rng.integers(4)](built, other, new[0])
        elif kind == 1:  # two bodies, of which a wheel may be one
            new.append(built.link(f"L{len(built.letters)}"))
            codes = rng.integers(0, 3, 3)
            while np.all(codes == 1):
                codes = rng.integers(0, 3, 3)
            JOINTS[codes[0]](built, outside[0], new[0])
            JOINTS[codes[1]](built, outside[1], new[1])
            JOINTS[codes[2]](built, new[0], new[1])
        elif kind == 2:  # a class III group, with a slide now and then
            legs = [built.link(f"L{len(built.letters)}") for _ in range(3)]
            new += legs
            for leg, base in zip(legs, outside, strict=True):
                JOINTS[int(rng.random() < 0.2)](built, base, leg)
                pin(built, new[0], leg)
        elif kind == 3:  # a cylinder between two links that are known: a driver between moving links
            new.append(built.link(f"L{len(built.letters)}"))
            third = built.link(f"L{len(built.letters)}")
            new.append(third)
            driven(built, new[0], new[1], JOINTS[int(rng.integers(2))])
            pin(built, outside[0], new[0])
            pin(built, new[1], third)
            JOINTS[rng.integers(2)](built, outside[1], third)
        else:  # three higher pairs
            for other in outside:
                HIGHER[rng.integers(2)](built, other, new[0])
        known += new
    pins = [
        (other, link)
        for link in known
        for other in ("frame", "L1")
        if other != link and rng.random() < 0.3 and set(built.letters[link]) & set(built.letters[other])
    ]
    for carrier, first in pins[:2]:
        geared(built, carrier, first)
    return built, built.mechanism()


@pytest.mark.parametrize("part", range(6))
def test_the_first_pose_is_the_drawing(part: int) -> None:
    """The points to a millionth of the size, and the angles of all links, those of one point among them."""
    wrong = [found for seed in range(part, CASES, 6) if (found := fault(seed))]
    assert not wrong


def fault(seed: int) -> str:
    """What is wrong with a case; nothing where the drawing is met, or where its count does not fit."""
    built, mechanism = random_drawing(seed)
    if ck.decompose(mechanism).faults:
        return ""
    step = {
        name: 1e-4 if angle else 1e-4 * built.scale for name, angle in ck.decompose(mechanism).driven_angles.items()
    }
    values = {name: value + step[name] * np.arange(3) for name, value in built.values.items()}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
        try:
            motion = ck.solve(mechanism, values, order=0)
        except ck.errors.NotAssembled as error:
            return f"{seed}: {error}"
    if not motion.assembled.flat[0]:
        return f"{seed}: not assembled"
    size = mechanism.geometry.size
    off = max(abs(motion.points[k].position.flat[0] - p) for k, p in built.places.items()) / size
    turned = max(abs(np.exp(1j * motion.links[k].angle.flat[0]) - np.exp(1j * a)) for k, a in built.angles.items())
    return "" if off < LIMIT and turned < LIMIT else f"{seed}: {off:.1e} of the size, {turned:.1e} rad off"
