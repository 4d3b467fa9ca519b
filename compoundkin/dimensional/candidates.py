"""Candidates: linkages that meet a task at its precision positions, made of dyads or of pivots and joints.

A pair of dyads on one body is a four-bar (RR RR), a slider-crank (RR PR), an inverted one (RR RP), an elliptic trammel
(PR PR) and so on. The dyads' links are the `input` and the `output`; the fixed pivots are A0 and B0, the joints on the
body A and B.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.dimensional.dyad_equations import PR, RP, RR, Dyad
from compoundkin.dimensional.tasks import INPUT, OUTPUT
from compoundkin.model.attributes import ANGLE, POSITION
from compoundkin.model.elements import Link, drawn, drive, link
from compoundkin.model.fields import Item
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.prismatic import slide

# The coupler's name where a task names no body, and its point.
COUPLER, POINT = "coupler", "P"
# What pairs of dyads are called.
TITLES = {
    (RR, RR): "Four-bar",
    (RR, PR): "Slider-crank",
    (RR, RP): "Inverted slider-crank",
    (PR, PR): "Elliptic trammel",
    (PR, RP): "Conchoidal linkage",
    (RP, RP): "Cross-slide linkage",
}
# A joint nearer to another of its link than this part of the linkage is the same.
COINCIDENT = 1e-6


@dataclass(frozen=True, eq=False, repr=False)
class Linkage(ShortRepr):
    """A linkage that meets a task at n precision positions, and may have any defect.

    `links` and `pairs` are written as users write them, `places` has every point at the first position. `z` and `u` are
    origins and orientations of all links at all positions, arrays (n,) by the link's name; `drivers` the values (n,) of
    each link on the frame that may drive, by its name. `pivots` and `lengths` are what conditions bound; `error` is by
    how much the positions miss the task, `outputs` what tables of the mechanism show.
    """

    title: str
    links: tuple[Link, ...]
    pairs: tuple[Item, ...]
    places: Mapping[str, complex]
    z: Mapping[str, Number]
    u: Mapping[str, Number]
    drivers: Mapping[str, Number]
    pivots: tuple[complex, ...]
    lengths: tuple[float, ...]
    error: float = 0.0
    outputs: tuple[str, ...] = ()
    source: str = ""
    dyads: tuple[Dyad, ...] = field(default=(), repr=False)

    @property
    def span(self) -> float:
        """The sum of all lengths, and the distances of fixed pivots."""
        return float(sum(self.lengths) + abs(self.pivots[0] - self.pivots[-1])) if self.pivots else sum(self.lengths)

    def places_at(self, index: int) -> dict[str, complex]:
        """Return where every point is at one of the positions."""
        found = dict(self.places)
        for item in self.links:
            z, u = self.z[item.name][index], self.u[item.name][index]
            found |= {letter: complex(z + u * point) for letter, point in item.points.items()}
        return found

    def driven_by(self, driver: str) -> Linkage:
        """Return the linkage with one of its drivers alone."""
        return replace(self, drivers={driver: self.drivers[driver]})

    def mechanism(self, driver: str, values: Number = None) -> Mechanism:
        """Return the mechanism, drawn at the first precision position, with one of its drivers."""
        sketch = {letter: (place.real, place.imag) for letter, place in self.places.items()}
        moving = drive(driver) if values is None else drive(driver, values=values)
        return Mechanism(self.title, *self.links, *self.pairs, moving, drawn(**sketch), outputs=list(self.outputs),
                         source=self.source)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Candidates:
    """What a method gives: `linkages`, `complete`, what of how many there are, and a `note` on what is special.

    `found` may be the dyads that they are made of. `nearest` says where there are none how far a task would have to
    give, and which tolerance would do. `is_family` marks some linkages of infinitely many. Where a method has judged
    its linkages already, `verdicts` are what it found, one for each.
    """

    linkages: Iterable[Linkage]
    complete: str
    note: str = ""
    found: object = None
    nearest: str = ""
    is_family: bool = False
    verdicts: tuple[Any, ...] | None = None

    def __iter__(self) -> Iterator[Linkage]:
        return iter(self.linkages)


def of_dyads(
    z: Number, u: Number, pairs: Iterable[tuple[Dyad, Dyad]], body: str = COUPLER, point: complex = 0j, **extra: object
) -> Iterator[Linkage]:
    """Yield the linkages of pairs of dyads on one body with origins `z` and orientations `u`, arrays (n,).

    The coupler point P has the body's coordinates `point`.
    """
    for pair in pairs:
        if _parted(pair):
            first, second = sorted(pair, key=lambda dyad: (RR, PR, RP).index(dyad.kind))
            yield _of_pair(z, u, first, second, body, point, **extra)


def of_points(points: Number, a: Number, b: Number, A: Number, B: Number, body: str = COUPLER) -> Iterator[Linkage]:
    """Yield four-bars whose coupler point goes through `points`, complex (n,).

    `a`, `b` are fixed pivots and `A`, `B` the joints when the point is at the first, complex arrays (candidates,). The
    orientations of the coupler at the other points follow from both cranks' lengths, which are linear in its cosine and
    sine.
    """
    a, b, A, B = (np.atleast_1d(np.asarray(v, dtype=complex)) for v in (a, b, A, B))
    for fixed in zip(a, b, A, B, strict=True):
        u = coupler_orientations(points, *map(complex, fixed))
        ends = (Dyad(RR, f, m - points[0], None, abs(m - f)) for f, m in zip(fixed[:2], fixed[2:], strict=True))
        yield from of_dyads(points, u, [tuple(ends)], body)  # type: ignore[list-item]


def coupler_orientations(points: Number, a: complex, b: complex, A: complex, B: complex) -> Number:
    """Return the orientations of a coupler at points, unit vectors (n,); 1 at the first. The point is its origin."""
    rows, right = [], []
    for centre, joint in ((a, A), (b, B)):
        arm = joint - points[0]
        m = np.conj(points - centre) * arm
        rows.append(np.stack([m.real, -m.imag], axis=-1))
        right.append((abs(joint - centre) ** 2 - np.abs(points - centre) ** 2 - abs(arm) ** 2) / 2.0)
    matrix, values = np.stack(rows, axis=-2), np.stack(right, axis=-1)
    found = np.einsum("nij,nj->ni", np.linalg.pinv(matrix), values)
    u = found[:, 0] + 1j * found[:, 1]
    return u / np.abs(u)


def _parted(pair: tuple[Dyad, Dyad]) -> bool:
    """Return whether two dyads hold the body at two different places."""
    one, other = pair
    if one.kind != other.kind:
        return True
    size = max(abs(one.moving - other.moving), abs(one.fixed - other.fixed), one.length, other.length)
    if one.direction is not None and other.direction is not None:
        parallel = abs((np.conj(one.direction) * other.direction).imag) < COINCIDENT
        if one.kind == RP:
            return not parallel or abs(one.fixed - other.fixed) > COINCIDENT * size
        return not parallel
    return min(abs(one.moving - other.moving), abs(one.fixed - other.fixed)) > COINCIDENT * size


class _DyadParts(NamedTuple):
    """What a dyad adds between the frame and a body: its link and pair, places of its points, and its poses.

    `pivot` is the place on the frame and `joint` the one on the body, in their own coordinates; `joint_place` is where
    the joint is at first. `z`, `u` are the link's origins and orientations, `driver` its values, arrays (n,).
    """

    link: Link
    pairs: tuple[Item, ...]
    pivot: complex
    joint: complex
    joint_place: complex
    z: Number
    u: Number
    driver: Number
    lengths: tuple[float, ...] = ()


def _crank(z: Number, u: Number, dyad: Dyad, name: str, letter: str) -> _DyadParts:
    joint = z + u * dyad.moving
    turned = (joint - dyad.fixed) / np.abs(joint - dyad.fixed)
    item = link(name, **_xy({f"{letter}0": 0j, letter: complex(dyad.length)}))
    still = np.full(len(z), dyad.fixed)
    return _DyadParts(item, (), dyad.fixed, dyad.moving, joint[0], still, turned, np.angle(turned), (dyad.length,))


def _slider_on_frame(z: Number, u: Number, dyad: Dyad, name: str, letter: str) -> _DyadParts:
    assert dyad.direction is not None
    joint, way, pivot = z + u * dyad.moving, dyad.direction, f"{letter}0"
    foot = complex(dyad.fixed + way * (np.conj(way) * (joint[0] - dyad.fixed)).real)
    guide = slide(name, on=FRAME, at=letter, through=pivot, angle=float(np.angle(way)), name=f"{name} slide")
    travel = (np.conj(way) * (joint - foot)).real
    item = link(name, **_xy({letter: 0j}))
    return _DyadParts(item, (guide,), foot, dyad.moving, joint[0], joint, np.full(len(z), way), travel)


def _slider_on_body(z: Number, u: Number, dyad: Dyad, name: str, letter: str, body: str) -> _DyadParts:
    assert dyad.direction is not None
    pivot, turned, way = f"{letter}0", u * dyad.direction, float(np.angle(dyad.direction))
    guide = slide(name, on=body, at=pivot, through=letter, angle=way, name=f"{name} slide")
    item = link(name, **_xy({pivot: 0j}))
    still, place = np.full(len(z), dyad.fixed), z[0] + u[0] * dyad.moving
    return _DyadParts(item, (guide,), dyad.fixed, dyad.moving, place, still, turned, np.angle(turned))


def _dyad_parts(z: Number, u: Number, dyad: Dyad, name: str, letter: str, body: str) -> _DyadParts:
    if dyad.kind == RP:
        return _slider_on_body(z, u, dyad, name, letter, body)
    return (_crank if dyad.kind == RR else _slider_on_frame)(z, u, dyad, name, letter)


def _of_pair(z: Number, u: Number, one: Dyad, other: Dyad, body: str, point: complex, **extra: object) -> Linkage:
    parts = {name: _dyad_parts(z, u, dyad, name, letter, body)
             for dyad, name, letter in ((one, INPUT, "A"), (other, OUTPUT, "B"))}  # fmt: skip
    made = dict(zip("AB", parts.values(), strict=True))
    points = {letter: part.joint for letter, part in made.items()}
    pivots = {f"{letter}0": part.pivot for letter, part in made.items()}
    places = {**pivots, **{letter: complex(part.joint_place) for letter, part in made.items()}}
    lengths = [length for part in parts.values() for length in part.lengths]
    if RP not in (one.kind, other.kind):
        lengths.append(abs(one.moving - other.moving))
    known = next((letter for letter, place in points.items() if abs(place - point) == 0.0), "")
    if not known:
        points[POINT] = point
        places[POINT] = complex(z[0] + u[0] * point)
    links = (link(FRAME, **_xy(pivots)), *(part.link for part in parts.values()), link(body, **_xy(points)))
    still = np.zeros(len(z), complex)
    return Linkage(
        TITLES[one.kind, other.kind], links, tuple(pair for part in parts.values() for pair in part.pairs), places,
        {FRAME: still, body: z, **{name: part.z for name, part in parts.items()}},
        {FRAME: still + 1.0, body: u, **{name: part.u for name, part in parts.items()}},
        {name: part.driver for name, part in parts.items()}, tuple(pivots.values()), tuple(lengths),
        outputs=(f"{known or POINT}.{POSITION}", f"{body}.{ANGLE}"), dyads=(one, other),
        **extra,  # type: ignore[arg-type]
    )  # fmt: skip


def _xy(points: Mapping[str, complex]) -> dict[str, tuple[float, float]]:
    return {letter: (float(place.real), float(place.imag)) for letter, place in points.items()}


def pairs_of(dyads: Sequence[Dyad]) -> list[tuple[Dyad, Dyad]]:
    """Return all pairs of dyads."""
    return [(one, other) for i, one in enumerate(dyads) for other in dyads[i + 1 :]]
