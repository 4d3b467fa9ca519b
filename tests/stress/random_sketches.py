"""Random mechanisms drawn at a pose that closes by construction: drivers, groups of every class, single links.

Each is grown link by link. What is attached is drawn at random places and then asked, by the suite's own equations,
whether it holds as much as it must: only mechanisms with a regular drawn pose are kept.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tests.stress.equations import Equations
from tests.stress.sketch import FRAME, Driver, Joint, Placed, Sketch

# Places are drawn in a square of this half width, before all lengths are scaled.
WIDE = 5.0
# A drawn pose is regular where the inverse of its Jacobian (radians, sizes) is no greater than this.
REGULAR = 1e4
# So often is a group drawn anew that does not hold; then the next kind of group is tried.
TRIES = 8

LOWER = ("R", "P", "L", "O")
WEIGHTS = (0.66, 0.22, 0.06, 0.06)
HIGHER = ("S", "A", "C", "F", "G", "B", "K")
HIGHER_WEIGHTS = (0.24, 0.16, 0.16, 0.12, 0.12, 0.1, 0.1)


@dataclass(frozen=True)
class Flavour:
    """What a mechanism is made of: how many links, which kinds of groups, how links are given."""

    links: int
    groups: tuple[str, ...]
    weights: tuple[float, ...]
    as_drawn: float
    multiple: float
    drivers: int
    pins_only: bool


class Grown:
    """A sketch that grows."""

    def __init__(self, rng: np.random.Generator, flavour: Flavour) -> None:
        self.rng, self.flavour = rng, flavour
        self.sketch = Sketch()
        self.sketch.letters[FRAME] = []
        self.spots: dict[str, tuple[complex, float]] = {}
        self.used: list[str] = []

    # --- small draws ---

    def pick(self, options: list[str] | tuple[str, ...], weights: tuple[float, ...] | None = None) -> str:
        share = None if weights is None else np.array(weights) / sum(weights)
        return options[int(self.rng.choice(len(options), p=share))]

    def chance(self, share: float) -> bool:
        return bool(self.rng.random() < share)

    def place(self, *links: str) -> complex:
        """A random place, near where a short crank of these is."""
        spots = [self.spots[k] for k in links if k in self.spots]
        if spots:
            middle, radius = spots[0]
            return middle + radius * self.rng.uniform(0.3, 1.0) * self.direction()
        return complex(*self.rng.uniform(-WIDE, WIDE, 2))

    def direction(self) -> complex:
        return complex(np.exp(1j * self.rng.uniform(-np.pi, np.pi)))

    def known(self) -> list[str]:
        return list(self.sketch.letters)

    def kind(self) -> str:
        return "R" if self.flavour.pins_only else self.pick(LOWER, WEIGHTS)

    # --- links and pairs ---

    def link(self) -> str:
        name = f"L{len(self.sketch.letters)}"
        self.sketch.letters[name] = []
        self.sketch.own[name] = (complex(*self.rng.uniform(-WIDE, WIDE, 2)), float(self.rng.uniform(-np.pi, np.pi)))
        if self.chance(self.flavour.as_drawn):
            self.sketch.as_drawn.add(name)
        return name

    def join(self, kind: str, one: str, other: str) -> str:
        """Join two links by a pair, and return the letter or the pair's name."""
        if kind == "R":
            return self._pin(one, other)
        if kind in "GB":
            return self._wheels(kind, one, other)
        if self.chance(0.5):
            one, other = other, one
        return {"C": self._oval, "F": self._oval, "A": self._round, "O": self._round}.get(kind, self._line)(
            kind, one, other
        )

    def _pin(self, one: str, other: str) -> str:
        letters = self.sketch.letters
        if self.chance(self.flavour.multiple):
            free = [k for k in letters[one] if k not in letters[other] and k in self.sketch.pins()]
            if free:
                letter = self.pick(free)
                letters[other].append(letter)
                return letter
        return self.sketch.letter(self.place(one, other), one, other)

    def _point(self, link: str) -> str:
        """A letter of a link that is there, or a new one."""
        letters = self.sketch.letters[link]
        return self.pick(letters) if letters and self.chance(0.3) else self.sketch.letter(self.place(link), link)

    def _add(self, kind: str, links: tuple[str, ...], at: tuple[str, ...], **drawn: object) -> str:
        name = f"{kind.lower()}{len(self.sketch.joints)}"
        self.sketch.joints.append(Joint(kind, name, links, at, {**drawn, "unsaid": self.chance(0.4)}))
        return name

    def _line(self, kind: str, on: str, link: str) -> str:
        through, at = self._point(on), self._point(link)
        direction = float(np.angle(self.direction()))
        if kind in "LK":
            self._apart(on, link, at, through)
        if not self.chance(0.3):
            return self._add(kind, (on, link), (at, through), direction=direction)
        toward = self.sketch.letter(self.sketch.places[through] + self.rng.uniform(0.5, 4) * self.direction(), on)
        return self._add(kind, (on, link), (at, through, toward))

    def _apart(self, on: str, link: str, at: str, through: str) -> None:
        """A letter that both links have cannot be a wheel's distance from itself."""
        if at == through:
            raise Unfit

    def _round(self, kind: str, on: str, link: str) -> str:
        centre, at = self._point(on), self._point(link)
        if centre == at:
            raise Unfit
        inside = self.chance(0.4)
        share = self.rng.uniform(0.3, 2.0) if inside else self.rng.uniform(0.2, 0.8)
        return self._add(kind, (on, link), (at, centre), inside=inside, share=float(share))

    def _oval(self, kind: str, on: str, link: str) -> str:
        at = self._point(link)
        a = self.rng.uniform(0.8, 3.0)
        b = a if self.chance(0.25) else a * self.rng.uniform(0.6, 0.95)
        count = 64 if a != b and self.chance(0.3) else 0
        oval = (float(a), float(b), float(self.rng.uniform(-np.pi, np.pi)), count)
        if kind == "F":
            side, along = self.pick(("+", "-")), float(self.rng.normal())
            drawn = {"direction": float(np.angle(self.direction())), "side": 1 if side == "+" else -1, "along": along}
            return self._add(kind, (on, link), (at,), oval=oval, unit=1.0, **drawn)
        inside = self.chance(0.25)
        # a roller inside is smaller than the least radius of curvature
        radius = 0.0 if self.chance(0.4) else self.rng.uniform(0.1, 0.8) * (b * b / a if inside else 1.0)
        s = float(self.rng.uniform(-np.pi, np.pi))
        return self._add(kind, (on, link), (at,), oval=oval, unit=1.0, s=s, radius=float(radius), inside=inside)

    def _wheels(self, kind: str, one: str, other: str) -> str:
        """A gear or belt pair between two links that are pinned to a third."""
        carriers = [
            (carrier, first, second)
            for carrier in self.known()
            if carrier not in (one, other)
            for first in self._axes(one, carrier)
            for second in self._axes(other, carrier)
            if first != second
        ]
        if not carriers:
            raise Unfit
        carrier, first, second = carriers[int(self.rng.integers(len(carriers)))]
        alike, radii = self.chance(0.4), self.chance(0.4)
        sizes = sorted(float(n) for n in self.rng.choice(np.arange(12, 60), 2, replace=False))
        if not (kind == "G" and alike) and self.chance(0.5):
            sizes = sizes[::-1]
        slack = 1.0 if kind == "G" else float(self.rng.uniform(0.3, 0.9))
        links, at = (one, other, carrier), (first, second)
        return self._add(kind, links, at, sizes=tuple(sizes), alike=alike, radii=radii, slack=slack)

    def _axes(self, link: str, carrier: str) -> list[str]:
        return [k for k in self.sketch.letters[link] if k in self.sketch.letters[carrier]]

    # --- drivers and groups ---

    def driver(self, on: str) -> str:
        """A new link, driven on another."""
        link, kind = self.link(), self.kind()
        letter = self.join(kind, on, link)
        if kind == "R" and self.chance(0.6):
            self.spots[link] = (self.sketch.places[letter], float(self.rng.uniform(0.5, 2.0)))
        link_first = self.chance(0.2) and on != FRAME
        written = (on, link) if link_first else (link, on)
        sign = 1
        if kind != "R":
            joint = self.sketch.joints[-1]
            sign = -1 if kind == "O" and written[0] != joint.links[1] else 1
        name = f"d{len(self.sketch.drivers)}"
        self.sketch.drivers.append(Driver(name, *written, letter, kind, sign))
        return link

    def dyad(self) -> None:
        a, b = self.link(), self.link()
        one, other = self._outer(2, {a, b})
        for kind, pair in zip((self.kind() for _ in range(3)), ((a, one), (a, b), (b, other)), strict=True):
            self.join(kind, *pair)

    def triad(self) -> None:
        """A ternary link on three others, one of which may be split by a driver."""
        middle = self.link()
        legs = [self.link() for _ in range(3)]
        for leg, out in zip(legs, self._outer(3, {middle, *legs}), strict=True):
            self.join(self.kind(), middle, leg)
            self.join(self.kind(), self._end(leg), out)

    def ring(self) -> None:
        """Two ternary links in a ring of four (class IV), or more in a longer one."""
        count = int(self.rng.choice([4, 4, 4, 6]))
        ring = [self.link() for _ in range(count)]
        for one, other in zip(ring, [*ring[1:], ring[0]], strict=True):
            self.join(self.kind(), one, other)
        # a ring of n links holds 2 n of its 3 n freedoms: n / 2 outer pairs do the rest
        for link, out in zip(ring[::2], self._outer(count // 2, set(ring)), strict=True):
            self.join(self.kind(), link, out)

    def chain(self) -> None:
        """Random pairs between some new links and what is there, as many as they need; some are driven."""
        count = int(self.rng.choice([2, 4, 4, 6]))
        new = [self.link() for _ in range(count)]
        old = [k for k in self.known() if k not in new]
        both = set(new)
        for k, link in enumerate(new):
            other = self.pick(new[:k]) if k and self.chance(0.7) else self.pick(old)
            self.join(self.kind(), link, other)
        for _ in range(count // 2):
            one = self.pick(new)
            rest = [k for k in (*new, *old) if k != one]
            self.join(
                self.kind(), self._end(one), self.pick([k for k in rest if k in both] if self.chance(0.4) else rest)
            )

    def mixed(self, higher: tuple[str, ...] = HIGHER, weights: tuple[float, ...] = HIGHER_WEIGHTS) -> None:
        """Links held by a pair of two and higher pairs of one."""
        count = int(self.rng.choice([1, 1, 2, 3]))
        new = [self.link() for _ in range(count)]
        old = [k for k in self.known() if k not in new]
        for k, link in enumerate(new):
            self.join(self.kind(), link, self.pick(new[:k]) if k and self.chance(0.7) else self.pick(old))
        for k in range(count):
            one = new[k]
            self.join(self.pick(higher, weights), one, self.pick([n for n in (*new, *old) if n != one]))

    def cams(self) -> None:
        """Links held by a pair of two and a profile."""
        self.mixed(("C", "F"), (0.6, 0.4))

    def loose(self) -> None:
        """One link in three slots or on three profiles."""
        new = self.link()
        old = [k for k in self.known() if k != new]
        for _ in range(3):
            self.join(self.pick(HIGHER[:4]), new, self.pick(old))

    def wheel(self) -> None:
        """A wheel pinned on a carrier and geared to another wheel there."""
        pins = [(links, letter) for letter, links in self.sketch.pins().items()]
        if not pins:
            raise Unfit
        links, _ = pins[int(self.rng.integers(len(pins)))]
        carrier, other = (links[int(k)] for k in self.rng.choice(len(links), 2, replace=False))
        new = self.link()
        self.sketch.letter(self.place(carrier), carrier, new)
        self._wheels(self.pick(("G", "B")), other, new)

    def pinion(self) -> None:
        """A rack on a slide, or a pinion on a pin."""
        new = self.link()
        old = [k for k in self.known() if k != new]
        self.join(self.pick(("R", "P")), new, self.pick(old))
        self.join("K", new, self.pick(old))

    def _outer(self, count: int, without: set[str]) -> list[str]:
        """Links to attach a group to: different ones where there are enough."""
        known = [k for k in self.known() if k not in without]
        return [known[int(k)] for k in self.rng.choice(len(known), count, replace=len(known) < count)]

    def _end(self, link: str) -> str:
        """The link itself, or another that is driven on it: the two are one composite link."""
        if len(self.sketch.drivers) < self.flavour.drivers and self.chance(0.3):
            return self.driver(link)
        return link


class Unfit(Exception):
    """What was drawn does not go."""


GROUPS: dict[str, Callable[[Grown], None]] = {
    "dyad": Grown.dyad,
    "triad": Grown.triad,
    "ring": Grown.ring,
    "chain": Grown.chain,
    "mixed": Grown.mixed,
    "cams": Grown.cams,
    "loose": Grown.loose,
    "wheel": Grown.wheel,
    "pinion": Grown.pinion,
}
# Mechanisms of different flavours: how much of each kind of group.
TASTES: tuple[dict[str, float], ...] = (
    {"dyad": 1.0},
    {"dyad": 0.3, "triad": 0.5, "ring": 0.3, "chain": 0.4},
    {"dyad": 0.4, "mixed": 0.6, "loose": 0.1},
    {"dyad": 0.4, "wheel": 0.5, "pinion": 0.3, "mixed": 0.2},
    {"dyad": 1.0, "triad": 0.3, "ring": 0.2, "chain": 0.3, "mixed": 0.5, "loose": 0.1, "wheel": 0.3, "pinion": 0.2},
)


# Cams between any links, as drivers and driven, on each other; held by three profiles.
CAMS: tuple[dict[str, float], ...] = ({"dyad": 0.3, "cams": 1.0, "loose": 0.2},)


def flavour_of(rng: np.random.Generator, small: bool, tastes: tuple[dict[str, float], ...] = TASTES) -> Flavour:
    taste = tastes[int(rng.integers(len(tastes)))]
    large = rng.random()
    sizes = ((3, 6), (3, 6), (6, 9), (6, 9)) if small else ((3, 7), (7, 10), (10, 19), (19, 61))
    links = int(rng.integers(*sizes[int(np.searchsorted((0.6, 0.88, 0.98), large))]))
    return Flavour(
        links,
        tuple(taste),
        tuple(taste.values()),
        as_drawn=float(rng.choice([0.0, 0.5, 1.0], p=[0.4, 0.3, 0.3])),
        multiple=float(rng.choice([0.0, 0.4], p=[0.6, 0.4])),
        drivers=int(rng.choice([1, 2, 3, 4], p=[0.6, 0.25, 0.1, 0.05])),
        pins_only=bool(rng.random() < 0.25),
    )


def random_sketch(
    rng: np.random.Generator, small: bool = False, tastes: tuple[dict[str, float], ...] = TASTES
) -> tuple[Sketch, list[str]]:
    """A random mechanism, all lengths near 5, and the names of what it was grown from."""
    while True:
        grown = Grown(rng, flavour_of(rng, small, tastes))
        used = _grow(grown)
        if used and regular(_finished(grown.sketch, rng)):
            return grown.sketch, used


def _grow(grown: Grown) -> list[str]:
    flavour, used = grown.flavour, []
    grown.sketch.letter(grown.place(), FRAME)
    if grown.chance(flavour.as_drawn):
        grown.sketch.as_drawn.add(FRAME)
    if not _attempt(grown, lambda: grown.driver(FRAME)):
        return []
    misses = 0
    while len(grown.sketch.letters) < flavour.links and misses < TRIES:
        name = grown.pick(flavour.groups, flavour.weights)
        if grown.chance(0.3) and len(grown.sketch.drivers) < flavour.drivers:
            on = grown.pick(grown.known())
            misses += not _attempt(grown, lambda on=on: grown.driver(on))
        if _attempt(grown, lambda name=name: GROUPS[name](grown)):
            used.append(name)
        else:
            misses += 1
    return used


def _attempt(grown: Grown, attach: Callable[[], object]) -> bool:
    """Attach something, again with other numbers where it does not go."""
    before, spots = grown.sketch, dict(grown.spots)
    for _ in range(TRIES):
        grown.sketch = before.copy()
        try:
            attach()
        except Unfit:
            continue
        if regular(grown.sketch):
            return True
    grown.sketch, grown.spots = before, spots
    return False


def regular(sketch: Sketch) -> bool:
    """Whether all links are held, and not nearly singular, at the drawn pose."""
    if any(len(letters) == 0 for letters in sketch.letters.values()):
        return False
    for link, letters in sketch.letters.items():
        if sketch.is_read_off(link) and abs(sketch.places[letters[0]] - sketch.places[letters[1]]) < 0.1:
            return False
    for joint in sketch.joints:
        # links of another pair are not pinned as well
        if set(sketch.letters[joint.links[0]]) & set(sketch.letters[joint.links[1]]):
            return False
    equations = Equations(Placed(sketch))
    if equations.size != equations.unknowns:
        return False
    jacobian = equations.jacobian(equations.drawn)
    try:
        return bool(np.max(np.abs(np.linalg.inv(jacobian))) < REGULAR)
    except np.linalg.LinAlgError:
        return False


def _finished(sketch: Sketch, rng: np.random.Generator) -> Sketch:
    """Some links get points more, that only are there; all but blocks need two to show how they are turned."""
    blocks = {joint.links[1] for joint in sketch.joints if joint.kind == "P"}
    blocks -= {link for joint in sketch.joints if joint.kind in "GBKLO" for link in joint.links}
    for link in list(sketch.letters):
        if rng.random() < 0.2 or (link not in blocks and not sketch.shows(link)):
            sketch.letter(complex(*rng.uniform(-WIDE, WIDE, 2)), link)
    return sketch
