"""Cognates: other linkages that draw the same coupler curve (Roberts and Chebyshev).

Of a four-bar with fixed pivots a, b, joints A, B and the coupler point P, three linkages draw the curve of P. With the
complex ratio ``m = (P - A) / (B - A)``, which is constant, the third pivot is ``c = a + m (b - a)``; the second linkage
has the joints ``a + P - A`` and ``a + m (B - a)``, the third those about b. Cranks at the same pivot belong to
parallelograms, so that the crank of the second turns like the coupler of the first.

Sources: S. Roberts, On three-bar motion in plane space, Proc. London Math. Soc. 7 (1875) 14-23; P. L. Chebyshev, Les
plus simples systemes de tiges articulees, 1878; A. Cayley, On three-bar motion, Proc. London Math. Soc. 7 (1876)
136-166 (the triangle); R. L. Norton, Design of Machinery, chapter 3 (parallel motion, geared five-bars).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, first_entry, unwrapped
from compoundkin.base.display import DisplaysHtml, ShortRepr, count_phrase, display_function
from compoundkin.base.errors import InvalidInput, NotAssembled, Problem, UnknownName, suggestion
from compoundkin.base.linear import one_thread
from compoundkin.dimensional.candidates import COUPLER, POINT, Linkage, of_dyads
from compoundkin.dimensional.dyad_equations import PR, RR, Dyad
from compoundkin.dimensional.tasks import INPUT, OUTPUT
from compoundkin.kinematics import Motion, solve
from compoundkin.model.attributes import POSITION
from compoundkin.model.elements import Drive, drawn, drive, link
from compoundkin.model.fields import Item
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.belt import belt

# Pivots nearer to each other than this part of their distance are one.
SAME = 1e-9
# A link that turns by no more than this (radians) does not turn.
STILL = 1e-6


def crank_cognates(z: Number, u: Number, one: Dyad, other: Dyad) -> Iterator[Linkage]:
    """Yield the linkages whose crank turns like a body that two dyads guide, and that draw the curve of its origin.

    `z` and `u` are origins and orientations of the body, arrays (n,). Two cranks have two, a crank and a slider one.
    """
    for first, second in ((one, other), (other, one)):
        if first.kind == RR:
            made = crank_cognate(z, u, first, second)
            if made is not None:
                yield made


def crank_cognate(z: Number, u: Number, first: Dyad, second: Dyad) -> Linkage | None:
    """Return the cognate about the fixed pivot of `first`, whose crank turns like the body; None where it has none."""
    a, arm = first.fixed, -first.moving
    along = second.moving - first.moving
    if abs(along) < 1e-9 * max(abs(arm), abs(second.moving)) or abs(arm) < 1e-12 * max(first.length, 1e-300):
        return None
    m = arm / along
    # the new coupler: its origin is the point, and it turns like the old crank
    old = z + u * first.moving - a
    turned = old / np.abs(old)
    crank = Dyad(RR, a, complex(-first.length), None, abs(arm))
    joint = (m - 1.0) * first.length
    pivot = complex(a + m * (second.fixed - a))
    if second.kind == PR:
        assert second.direction is not None
        end = Dyad(PR, pivot, complex(joint), second.direction * m / abs(m))
    else:
        end = Dyad(RR, pivot, complex(joint), None, abs(m) * second.length)
    return next(of_dyads(z, turned, [(crank, end)]), None)


@dataclass(frozen=True, eq=False, repr=False)
class Cognate(ShortRepr):
    """A linkage that draws the curve: its mechanism, the motion at the same places of the point, fixed pivots.

    `z` and `u` are places of the point and orientations of the coupler over the motion, `dyads` those that guide it.
    """

    mechanism: Mechanism
    motion: Motion
    z: Number
    u: Number
    dyads: tuple[Dyad, Dyad]

    @property
    def pivots(self) -> tuple[complex, ...]:
        """The fixed pivots."""
        return tuple(dyad.fixed for dyad in self.dyads if dyad.kind == RR)


@dataclass(frozen=True, eq=False, repr=False)
class Cognates(DisplaysHtml):
    """The linkages that draw one curve, the given one first: three of a four-bar, two of a slider-crank.

    `deviation` is the greatest distance between the places of their points, each solved by itself.
    """

    point: str
    members: tuple[Cognate, ...]
    deviation: float

    @property
    def mechanisms(self) -> tuple[Mechanism, ...]:
        """The mechanisms, the given one first."""
        return tuple(one.mechanism for one in self.members)

    @property
    def triangle(self) -> tuple[complex, ...]:
        """The fixed pivots of all of a four-bar: Cayley's triangle, similar to the couplers."""
        found = list[complex]()
        for place in (place for one in self.members for place in one.pivots):
            if all(abs(place - other) > SAME * (1.0 + abs(place)) for other in found):
                found.append(place)
        return tuple(found)

    def parallel_motion(self, number: int = 0) -> Mechanism:
        """Return a six-bar with a link that moves along the curve without turning (`number` of the member begun with).

        The output of one linkage turns like that of a cognate, which is shifted there: both are one link then. Raises
        InvalidInput for a slider-crank, and where the point is a joint.
        """
        member = self._cranks(number)
        swapped = replace(member, dyads=(member.dyads[1], member.dyads[0]))
        for one in (member, swapped):
            made = _parallel_motion(one)
            turn = np.exp(1j * solve(made, order=0).links["plate"].angle)
            # a second coupler that passes a change point may come out of it the other way
            if np.max(np.abs(turn - turn[0])) < STILL:
                return made
        raise InvalidInput(Problem("number", "its second coupler passes a change point", "begin with another member"))

    def geared_five_bar(self, number: int = 0) -> Mechanism:
        """Return a five-bar whose cranks, coupled one to one, draw the curve (`number` of the member begun with).

        Its cranks are those that turn like the coupler, at both pivots. Raises InvalidInput for a slider-crank.
        """
        return _geared_five_bar(self._cranks(number))

    def _cranks(self, number: int) -> Cognate:
        if not 0 <= number < len(self.members):
            known = f"they are 0 to {len(self.members) - 1}"
            raise InvalidInput(Problem("number", f"there is no cognate {number}", known))
        member = self.members[number]
        if len(member.pivots) < 2:
            raise InvalidInput(Problem("number", "a slider-crank has no such cognate", "take a four-bar"))
        return member

    def draw(self, **options: Any) -> Any:
        """Return the picture of all linkages at one place of the curve, with Cayley's triangle."""
        return display_function("cognates_picture")(self, **options)

    def __iter__(self) -> Iterator[Cognate]:
        return iter(self.members)

    def __len__(self) -> int:
        return len(self.members)

    def __getitem__(self, index: int) -> Cognate:
        return self.members[index]

    def __repr__(self) -> str:
        return f"Cognates({count_phrase(len(self.members), 'linkage')} for {self.point}, apart {self.deviation:.1e})"


@checked
@one_thread
def cognates(mechanism: Mechanism | Motion, point: str) -> Cognates:
    """Return the linkages that draw the same curve of a coupler point, each solved over the motion by itself.

    The link with the point is pinned to two others, of which each is pinned to the frame, or one slides on it. Raises
    InvalidInput for any other mechanism, and where the point is a joint; UnknownName for a point that is none;
    NotAssembled where no pose is assembled.

    >>> from compoundkin.model.elements import drive, link
    >>> four_bar = Mechanism("m", link("frame", A=0, D=5), link("crank", A=0, B=2), link("rocker", D=0, C=4),
    ...                      link("coupler", B=0, C=5, P=2 + 1.5j), drive("crank"))
    >>> found = cognates(four_bar, "P")
    >>> len(found), len(found.triangle), found.deviation < 1e-9
    (3, 3, True)
    """
    motion = mechanism if isinstance(mechanism, Motion) else solve(mechanism)
    own = _given(motion, point)
    made = list(crank_cognates(own.z, own.u, *own.dyads))
    if not made:
        raise InvalidInput(Problem(point, "it is a joint of the coupler: no other linkage draws its curve"))
    members, deviation = [own], 0.0
    for linkage in made:
        mechanism, values, chosen = _driven(linkage)
        solved = solve(mechanism, values, order=0)
        deviation = max(deviation, float(np.max(np.abs(solved.points[POINT].position - own.z[chosen]))))
        first, second = linkage.dyads
        body = linkage.z[COUPLER][chosen], linkage.u[COUPLER][chosen]
        members.append(Cognate(mechanism, solved, *body, (first, second)))
    return Cognates(point, tuple(members), deviation)


def _given(motion: Motion, point: str) -> Cognate:
    """Return the given linkage as two dyads on the body with the point. Raises InvalidInput for any other."""
    mechanism = motion.mechanism
    if point not in motion.points:
        raise UnknownName(Problem(point, "there is no such point", suggestion(point, list(motion.points))))
    if len(motion.shape) > 1:
        raise InvalidInput(Problem("mechanism", "it has several designs", "take one design"))
    bodies = [name for name in mechanism.carriers[point] if name != FRAME]
    dyads = [dyad for name in bodies for dyad in [_dyads_on(motion, name, point)] if len(dyad) == 2]
    if len(bodies) != 1 or not dyads or all(dyad.kind == PR for dyad in dyads[0]):
        what = f"{point!r} is no coupler point of a four-bar or slider-crank"
        how = "it lies on one link, which is pinned to two links that are pinned to the frame, or slide on it"
        raise InvalidInput(Problem(point, what, how))
    good = np.broadcast_to(motion.assembled, motion.shape)
    if not good.any():
        raise NotAssembled(Problem("mechanism", "its motion has no assembled pose", "change a length, or the values"))
    z = np.broadcast_to(motion.points[point].position, motion.shape)[good]
    u = np.exp(1j * np.broadcast_to(motion.links[bodies[0]].angle, motion.shape)[good])
    one, other = sorted(dyads[0], key=lambda dyad: dyad.kind == PR)
    return Cognate(mechanism, motion, z, u, (one, other))


def _dyads_on(motion: Motion, body: str, point: str) -> list[Dyad]:
    """Return the RR and PR dyads between the frame and a body, whose origin is a point of it."""
    points = motion.mechanism.geometry.points
    pairs = [pair for pair in motion.solving_order.pairs.values() if pair.is_simple and len(pair.members) == 2]
    found = []
    for near in (pair for pair in pairs if body in pair.members and pair.free_is_angle):
        other = next(name for name in near.members if name != body)
        for far in (pair for pair in pairs if {other, FRAME} == set(pair.members)):
            letter = near.letters[0]
            moving = complex(points[body][letter] - points[body][point])
            if far.free_is_angle:
                pivot = complex(points[FRAME][far.letters[0]])
                length = abs(complex(points[other][letter] - points[other][far.letters[0]]))
                found.append(Dyad(RR, pivot, moving, None, length))
            else:
                ends = motion.inputs.ends[far.name]
                guide = ends[far.members.index(FRAME)]
                way = complex(first_entry(guide.along.c[0]))
                place = complex(first_entry(motion.points[letter].position))
                found.append(Dyad(PR, place, moving, way / abs(way)))
    return found


def _driven(linkage: Linkage) -> tuple[Mechanism, dict[str, Number], Number]:
    """Return the mechanism of a linkage with a driver that goes on and on over the positions, its values, and which.

    Where each of its links turns back somewhere, the longest stretch of positions over which the first goes on.
    """
    choices = [(name, FRAME) for name in linkage.drivers]
    choices += [(COUPLER, name) for name in (INPUT, OUTPUT) if linkage.dyads[name == OUTPUT].kind == RR]
    best: tuple[int, Drive, Number, Number] | None = None
    for name, on in choices:
        angular = on != FRAME or linkage.dyads[name == OUTPUT].kind == RR
        turned = linkage.u[name] / linkage.u[on]
        values = unwrapped(np.angle(turned)) if angular else linkage.drivers[name]
        stretch = _longest_stretch(values)
        if best is None or len(stretch) > best[0]:
            best = len(stretch), drive(name, on=on), values[stretch], stretch
    assert best is not None
    _, chosen, values, stretch = best
    there = replace(linkage, places=linkage.places_at(int(stretch[0])))
    made = there.mechanism(next(iter(linkage.drivers)))
    items = [item for item in made.items if not isinstance(item, Drive)]
    driven = Mechanism(f"{made.title}, cognate", *items, replace(chosen, values=values), outputs=list(made.outputs))
    return driven, {chosen.name: values}, stretch


def _longest_stretch(values: Number) -> Number:
    """Return the indices of the longest stretch over which values grow, or fall, all along."""
    signs = np.sign(np.diff(values))
    cuts = np.flatnonzero((signs[1:] != signs[:-1]) | (signs[1:] == 0)) + 1
    ends = [0, *cuts.tolist(), len(values) - 1]
    low, high = max(pairwise(ends), key=lambda pair: pair[1] - pair[0])
    return np.arange(low, high + 1)


def _parallel_motion(one: Cognate) -> Mechanism:
    """Return the six-bar: the linkage, and its cognate shifted until both outputs are one link."""
    first, second = one.dyads
    m = first.moving / (first.moving - second.moving)
    shift = second.fixed - (first.fixed + m * (second.fixed - first.fixed))
    if abs(shift) < SAME * (abs(second.fixed - first.fixed) + second.length):
        raise InvalidInput(Problem("number", "the point is the output's joint: both pivots are one", "take another"))
    z, u = one.z[0], one.u[0]
    joints = [complex(z + u * dyad.moving) for dyad in one.dyads]
    output = (joints[1] - second.fixed) / second.length
    # the cognate's output is the own one, turned and scaled by m about its pivot
    far = m * second.length
    place = complex(second.fixed + output * far)
    end = complex(z + shift)
    links = (
        link(FRAME, A0=first.fixed, B0=second.fixed),
        link(INPUT, A0=0j, A=complex(first.length)),
        link(COUPLER, A=first.moving, B=second.moving, **{POINT: 0j}),
        link(OUTPUT, B0=0j, B=complex(second.length), C=complex(far)),
        link("second coupler", C=0j, Q=complex(abs(end - place))),
        link("plate", **{POINT: 0j, "Q": complex(shift)}),
    )
    places = {"A": joints[0], "B": joints[1], "C": place, "Q": end, POINT: complex(z)}
    return _with_best_driver("Parallel motion generator", links, (), places, one, (INPUT, FRAME))


def _geared_five_bar(one: Cognate) -> Mechanism:
    """Return the five-bar of the two cranks that turn like the coupler, coupled one to one by a belt."""
    first, second = one.dyads
    z, u = one.z[0], one.u[0]
    radius = abs(second.fixed - first.fixed) / 4.0
    links, places = [link(FRAME, A0=first.fixed, B0=second.fixed)], {POINT: complex(z)}
    for dyad, letter, name, bar in ((first, "A", INPUT, "first bar"), (second, "B", OUTPUT, "second bar")):
        pivot, joint = f"{letter}0", f"{letter}1"
        arm = -dyad.moving
        place = complex(dyad.fixed + u * arm)
        links += [link(name, **{pivot: 0j, joint: complex(arm)}), link(bar, **{joint: 0j, POINT: complex(dyad.length)})]
        places[joint] = place
    phase = belt(INPUT, OUTPUT, radii=(radius, radius), name="belt")
    return _with_best_driver("Geared five-bar", tuple(links), (phase,), places, one, (INPUT, FRAME))


def _with_best_driver(
    title: str,
    links: tuple[Item, ...],
    pairs: tuple[Item, ...],
    places: Mapping[str, complex],
    one: Cognate,
    usual: tuple[str, str],
) -> Mechanism:
    """Return the mechanism with the driver that goes on over the motion."""
    first, second = one.dyads
    cranks = {INPUT: (one.z + one.u * first.moving - first.fixed) / first.length,
              OUTPUT: (one.z + one.u * second.moving - second.fixed) / second.length}  # fmt: skip
    if pairs:  # of the five-bar the bars turn like the linkage's cranks, its cranks like the coupler
        choices = {(INPUT, FRAME): one.u, ("first bar", INPUT): cranks[INPUT] / one.u,
                   ("second bar", OUTPUT): cranks[OUTPUT] / one.u}  # fmt: skip
    else:
        choices = {(INPUT, FRAME): cranks[INPUT], (OUTPUT, FRAME): cranks[OUTPUT],
                   (COUPLER, INPUT): one.u / cranks[INPUT]}  # fmt: skip
    angles = {key: unwrapped(np.angle(turned)) for key, turned in choices.items()}
    name, on = max(angles, key=lambda key: (len(_longest_stretch(angles[key])), key == usual))
    values = angles[name, on]
    sketch = {letter: (place.real, place.imag) for letter, place in places.items()}
    chosen = drive(name, on=on, values=values[_longest_stretch(values)])
    return Mechanism(title, *links, *pairs, chosen, drawn(**sketch), outputs=[f"{POINT}.{POSITION}"])
