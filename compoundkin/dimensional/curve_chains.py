"""Chains whose points trace curves: crank-driven linkages with free dimensions, as programs over many designs.

A chain is a four-bar, a slider-crank or a geared five-bar; each dyad more lies on two of its links. With a dyad on two
links of a four-bar that are not both its crank and frame this gives the six-bars of Watt and Stephenson that a crank on
the frame drives through dyads alone (E. A. Dijksman, Motion Geometry of Mechanisms, Cambridge 1976), with a second dyad
eight-bars. A geared five-bar has two cranks on the frame that wheels couple; the ratio is whole, so that its curve
closes in one turn (B. Roth and F. Freudenstein, Synthesis of path-generating mechanisms by numerical methods, J. Eng.
Ind. 85 (1963) 298-304).

A chain grows by a dyad that carries its point on: with the point at the dyad's joint it traces what it traced before,
so that no growth loses anything.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import TURN, Number, unwrapped
from compoundkin.base.display import ShortRepr
from compoundkin.dimensional.candidates import COUPLER, POINT, Linkage
from compoundkin.kinematics import solve
from compoundkin.model.attributes import POSITION, component_names
from compoundkin.model.elements import Link, drive, link, mode
from compoundkin.model.fields import Item
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.belt import belt
from compoundkin.model.pairs.gear import gear
from compoundkin.model.pairs.prismatic import slide
from compoundkin.programs.call_numbers import Call
from compoundkin.programs.compiled_path import CompiledPath, compile

CRANK, ROCKER, SLIDER, ROD, LEVER, GUIDE = "crank", "rocker", "slider", "rod", "lever", "guide"
GUIDE_OFFSET = f"{GUIDE}.offset"
# The second crank of a geared five-bar, the bar from there to the coupler, and the wheels that couple both cranks.
SECOND_CRANK, BAR, WHEELS = "crank2", "bar", "wheels"
# What chains begin with.
FOUR_BAR, SLIDER_CRANK, FIVE_BAR = "Four-bar", "Slider-crank", "Geared five-bar"
# By how much the second crank of a geared five-bar turns as the first turns by one.
RATIOS = (-1, 1, -2, 2)
# Teeth of the smaller wheel.
TEETH = 20
# From where to where lengths of cranks and of other links are drawn, coordinates of points and offsets of guides on
# either side of zero; the frame of a four-bar is two long.
CRANKS, LENGTHS, PLACES, OFFSETS = (0.1, 1.2), (0.4, 6.0), (-4.0, 4.0), (-1.5, 1.5)


class FreeNumber(NamedTuple):
    """A number that designs choose: a length, drawn evenly over its logarithm, or a coordinate of `point`."""

    name: str
    low: float
    high: float
    is_length: bool
    point: str = ""


class Laying(NamedTuple):
    """Where a design lies: by ``scale * z + place``, then mirrored at the x axis if `mirrored`."""

    scale: complex
    place: complex
    mirrored: bool

    def as_seen(self, z: Any) -> Any:
        """Return vectors as they are, or mirrored."""
        return np.conj(z) if self.mirrored else z

    def laid(self, z: Any) -> Any:
        """Return places of the chain where they lie."""
        return self.as_seen(self.scale * z + self.place)

    def turned(self, u: Any) -> Any:
        """Return orientations of links of the chain as they are there."""
        return self.as_seen(self.scale / abs(self.scale) * u)


class AddedDyad(NamedTuple):
    """A dyad whose rod lies on link `first` and whose lever lies on `second`, of a mode."""

    first: str
    second: str
    sign: int


class ChainPlan(NamedTuple):
    """What a chain is made of: what it begins with, dyads, the link that has P, and the `ratio` of a five-bar."""

    base: str
    dyads: tuple[AddedDyad, ...]
    traced: str
    ratio: int = 0


@dataclass(frozen=True, eq=False, repr=False)
class CurveChain(ShortRepr):
    """A chain whose point P traces a closed curve; `numbers` are what its designs choose.

    Designs are arrays (designs, numbers): the logarithms of lengths, and coordinates as they are.
    """

    plan: ChainPlan
    title: str
    mechanism: Mechanism
    numbers: tuple[FreeNumber, ...]

    @property
    def links(self) -> int:
        """How many links it has, the frame among them."""
        return (5 if self.plan.base == FIVE_BAR else 4) + 2 * len(self.plan.dyads)

    @property
    def has_slider(self) -> bool:
        """Whether one of its links slides."""
        return self.plan.base == SLIDER_CRANK

    @cached_property
    def program(self) -> CompiledPath:
        """Its program: the place of P for dimensions and the crank's angle."""
        some = self.dimensions(np.zeros((1, len(self.numbers))))
        return compile(self.mechanism, [f"{POINT}.{POSITION}"], free=list(some))

    def designs(self, units: Number) -> Number:
        """Return designs of an array (designs, numbers) of numbers from 0 to 1."""
        low, high = np.array([[np.log(one[1:3]) if one.is_length else one[1:3]] for one in self.numbers]).T
        return low[0] + (high[0] - low[0]) * units

    @cached_property
    def _are_lengths(self) -> Number:
        return np.array([one.is_length for one in self.numbers])

    @cached_property
    def _columns(self) -> Mapping[str, tuple[int, ...]]:
        """The columns of dimensions by name: one, or two of a point."""
        at = {one.name: k for k, one in enumerate(self.numbers)}
        points = {one.point: component_names(one.point) for one in self.numbers if one.point}
        found = {name: tuple(at[part] for part in parts) for name, parts in points.items()}
        return found | {one.name: (at[one.name],) for one in self.numbers if not one.point}

    def measures(self, designs: Number) -> Number:
        """Return the lengths and coordinates of designs (designs, numbers)."""
        return np.exp(designs, out=np.array(designs, float), where=self._are_lengths)

    def dimensions(self, designs: Number) -> dict[str, Number]:
        """Return the dimensions of designs by name, arrays (designs, 1)."""
        values = self.measures(designs).T[:, :, None]
        return {name: values[at[0]] if len(at) == 1 else values[at[0]] + 1j * values[at[1]]
                for name, at in self._columns.items()}  # fmt: skip

    def size(self, designs: Number) -> Number:
        """Return the greatest length or coordinate of each design."""
        return np.abs(self.measures(designs)).max(axis=1)

    def curves(self, designs: Number, poses: int) -> tuple[Number, Number]:
        """Return the curves of designs over a turn, (designs, poses), and which designs are clear of limits."""
        return self.places(designs, turn(poses))

    def places(self, designs: Number, angles: Number) -> tuple[Number, Number]:
        """Return where P of designs is at angles of the crank, (poses,) or (designs, poses), and which are clear."""
        if len(designs) == 1:
            z, clear = self.places(np.repeat(designs, 2, axis=0), angles)
            return z[:1], clear[:1]
        found, clear = self.program.programs.unscreened(Call({CRANK: angles}, self.dimensions(designs)))
        return found[f"{POINT}.{POSITION}"], clear

    def slopes(self, designs: Number, angles: Number) -> tuple[Number, Number, Number, Number]:
        """Return curves, their slopes by the designs' numbers and by the crank, and which designs are clear.

        The crank's angles are (poses,), or (designs, poses); slopes are (numbers, designs, poses).
        """
        if len(designs) == 1:  # for one design other programs would be made
            z, by, by_crank, clear = self.slopes(np.repeat(designs, 2, axis=0), angles)
            return z[:1], by[:, :1], by_crank[:1], clear[:1]
        path = self.program
        found, clear = path.sensitivities.unscreened(Call({CRANK: angles}, self.dimensions(designs)))
        output, shape = f"{POINT}.{POSITION}", (len(designs), np.shape(angles)[-1])
        by = np.empty((len(self.numbers), *shape), complex)
        for slope, one in zip(by, self.numbers, strict=True):
            slope[...] = found[output, one.name]
        by[self._are_lengths] *= np.exp(designs.T[self._are_lengths])[:, :, None]
        return found[output, ""], by, found[output, CRANK], clear

    def grown(self, second: str, sign: int) -> CurveChain:
        """Return the chain with a dyad more, whose rod lies on the link of P and carries P on."""
        plan = self.plan
        names = _NAMES[len(plan.dyads)]
        return curve_chain(plan._replace(dyads=(*plan.dyads, AddedDyad(plan.traced, second, sign)), traced=names.rod))

    @property
    def parent(self) -> CurveChain:
        """The chain that grew to this by its last dyad."""
        *dyads, last = self.plan.dyads
        return curve_chain(self.plan._replace(dyads=tuple(dyads), traced=last.first))

    def grown_designs(self, larger: CurveChain, designs: Number, units: Number, keep: bool = True) -> Number:
        """Return designs of the chain with a dyad more; `units` draw it. To `keep` P keeps its curve."""
        drawn = larger.designs(units)
        names = _NAMES[len(self.plan.dyads)]
        own = {one.name: column for one, column in zip(self.numbers, designs.T, strict=True)}
        for axis in component_names(f"{self.plan.traced}.{POINT}"):
            own[axis.replace(f".{POINT}.", f".{names.on_first}.")] = own.pop(axis)
        if keep:
            own |= dict.fromkeys(component_names(f"{names.rod}.{POINT}"), np.zeros(len(designs)))
        return np.array([own.get(one.name, column) for one, column in zip(larger.numbers, drawn.T, strict=True)]).T

    def linkage(self, design: Number, laying: Laying, angles: Number, error: float = 0.0) -> Linkage:
        """Return a design as a linkage where it is laid, at angles of its crank (positions,)."""
        dimensions = {name: value[0, 0] for name, value in self.dimensions(design[None]).items()}
        own = self.program.mechanism(dimensions)
        motion = solve(own, {CRANK: angles}, modes=self.program.modes, order=0)
        still = np.zeros(len(angles))
        z = {name: laying.laid(np.ravel(pose.z.c[0]) + still) for name, pose in motion.poses.items()}
        u = {name: laying.turned(np.ravel(pose.u.c[0]) + still) for name, pose in motion.poses.items()}
        z[FRAME], u[FRAME] = still + 0j, still + 1.0 + 0j
        points = _laid_points(own, laying)
        return Linkage(
            title=own.title,
            links=tuple(link(name, **each) for name, each in points.items()),
            pairs=tuple(self._laid_pairs(dimensions, laying, u)),
            places={letter: complex(laying.laid(np.ravel(at.position)[0])) for letter, at in motion.points.items()},
            z=z,
            u=u,
            drivers={CRANK: unwrapped(np.angle(u[CRANK]))},
            pivots=tuple(points[FRAME].values()),
            lengths=tuple(abs(b - a) for name, each in points.items() if name != FRAME
                          for a, b in combinations([p for letter, p in each.items() if letter != POINT], 2)),
            error=error,
            outputs=(f"{POINT}.{POSITION}",),
            source="an atlas of coupler curves",
        )  # fmt: skip

    def _laid_pairs(self, dimensions: dict[str, Number], laying: Laying, u: dict[str, Number]) -> Iterator[Item]:
        """Yield the pairs that are no pins, where they lie with links of orientations `u`."""
        if self.has_slider:
            offset = abs(laying.scale) * float(dimensions[GUIDE_OFFSET])
            yield guide(float(np.angle(laying.turned(1.0))), -offset if laying.mirrored else offset)
        if self.plan.base == FIVE_BAR:
            ratio = self.plan.ratio
            yield wheels(ratio, float(np.angle(u[SECOND_CRANK][0] * np.conj(u[CRANK][0]) ** ratio)))

    @property
    def carriers(self) -> tuple[str, ...]:
        """The links that the second link of a dyad more may lie on."""
        added = [name for names in _NAMES[: len(self.plan.dyads)] for name in (names.rod, names.lever)]
        base = {SLIDER_CRANK: (), FOUR_BAR: (ROCKER,), FIVE_BAR: (SECOND_CRANK, BAR)}[self.plan.base]
        return tuple(name for name in (FRAME, CRANK, COUPLER, *base, *added) if name != self.plan.traced)


def _laid_points(own: Mechanism, laying: Laying) -> dict[str, dict[str, complex]]:
    """Return the points of links of a mechanism in its units, where it is laid: those of the frame as places."""
    size = abs(laying.scale)
    return {
        name: {
            letter: complex(laying.laid(p) if name == FRAME else laying.as_seen(size * p)) for letter, p in each.items()
        }
        for name, each in own.geometry.points.items()
    }


def turn(poses: int) -> Number:
    """Return so many angles of a crank over a turn."""
    return np.arange(poses) * (TURN / poses)


def length_number(name: str, between: tuple[float, float] = LENGTHS) -> FreeNumber:
    """Return the number of a length."""
    return FreeNumber(name, *between, True)


def place_numbers(link_name: str, letter: str) -> list[FreeNumber]:
    """Return the numbers of a point on its link."""
    point = f"{link_name}.{letter}"
    return [FreeNumber(name, *PLACES, False, point) for name in component_names(point)]


# The two links that a second dyad lies on, and what the six-bar is then called.
_SIX_BARS: dict[str, dict[tuple[str, str], str]] = {
    FOUR_BAR: {
        (COUPLER, FRAME): "Stephenson III",
        (ROCKER, FRAME): "Watt II",
        (COUPLER, ROCKER): "Watt I",
        (CRANK, COUPLER): "Watt I, its ternary link driven",
        (CRANK, ROCKER): "Stephenson I",
    },
    SLIDER_CRANK: {(COUPLER, FRAME): "Stephenson III with slider", (CRANK, COUPLER): "Watt I with slider"},
}
# Where P lies in the reference drawing.
_POINT = 1.0 + 0.8j


class _DyadNames(NamedTuple):
    """The links of an added dyad, its points on the two links that it lies on, and its joint.

    `places` are those points, `length` is that of its links in the reference drawing.
    """

    rod: str
    lever: str
    on_first: str
    on_second: str
    joint: str
    places: tuple[complex, complex]
    length: float


_NAMES = (
    _DyadNames(ROD, LEVER, "E", "F", "G", (1.0 + 1.0j, 0.5 + 1.5j), 2.5),
    _DyadNames("rod2", "lever2", "H", "J", "K", (1.2 + 0.5j, 0.7 + 1.1j), 4.5),
)


@cache
def curve_chains(links: int = 6) -> tuple[CurveChain, ...]:
    """Return the chains of at most so many links: four, six or eight.

    >>> [len(curve_chains(links)) for links in (4, 6, 8)]
    [2, 30, 238]
    """
    found = [curve_chain(ChainPlan(base, (), COUPLER)) for base in _SIX_BARS]
    if links >= 6:
        for base, six_bars in _SIX_BARS.items():
            for pair in six_bars:
                # a link on the frame traces a circle
                traced = (ROD,) if FRAME in pair else (ROD, LEVER)
                found += [curve_chain(ChainPlan(base, (AddedDyad(*pair, sign),), name))
                          for sign in (1, -1) for name in traced]  # fmt: skip
        # of equal wheels either crank may be called the first; the other mode is the mirror image
        found += [curve_chain(ChainPlan(FIVE_BAR, (), name, ratio))
                  for ratio in RATIOS for name in ((COUPLER,) if abs(ratio) == 1 else (COUPLER, BAR))]  # fmt: skip
    if links >= 8:
        six = [one for one in found if one.links == 6]
        found += [one.grown(second, sign) for one in six for second in one.carriers for sign in (1, -1)]
    return tuple(found)


def guide(angle: float, offset: float) -> Item:
    """Return the guide of a slider at a distance from the crank's pivot."""
    return slide(SLIDER, on=FRAME, at="C", through="A", angle=angle, offset=offset, name=GUIDE)


def wheels(ratio: int, phase: float) -> Item:
    """Return what couples both cranks of a geared five-bar: gears, or a belt or chain where they turn alike."""
    return (gear if ratio < 0 else belt)(
        CRANK, SECOND_CRANK, teeth=(abs(ratio) * TEETH, TEETH), phase=phase, name=WHEELS
    )


@cache
def curve_chain(plan: ChainPlan) -> CurveChain:
    """Return the chain of a plan, with its reference drawing."""
    points: dict[str, dict[str, complex]] = {}
    added: list[FreeNumber] = []
    for names, dyad in zip(_NAMES, plan.dyads, strict=False):
        on_first, on_second = (dyad.first, names.on_first), (dyad.second, names.on_second)
        for (name, letter), place in zip((on_first, on_second), names.places, strict=True):
            points.setdefault(name, {})[letter] = place
            added += place_numbers(name, letter)
        points.setdefault(names.rod, {})
        added += [length_number(component_names(f"{name}.{names.joint}")[0]) for name in (names.rod, names.lever)]
    points.setdefault(plan.traced, {})[POINT] = _POINT
    items, numbers = base_items(plan, points)
    for names, dyad in zip(_NAMES, plan.dyads, strict=False):
        for name, letter in ((names.rod, names.on_first), (names.lever, names.on_second)):
            items.append(link(name, **{letter: 0, names.joint: names.length}, **points.get(name, {})))
        items.append(mode(dyad.sign, names.lever))
    title = _title(plan)
    mechanism = Mechanism(title, *items, drive(CRANK))
    return CurveChain(plan, title, mechanism, (*numbers, *added, *place_numbers(plan.traced, POINT)))


def _title(plan: ChainPlan) -> str:
    base = f"{plan.base}, ratio {plan.ratio}" if plan.base == FIVE_BAR else plan.base
    if not plan.dyads:
        return base
    known = _SIX_BARS.get(plan.base, {})
    first, second, _ = plan.dyads[0]
    added = "".join(f", with a dyad on {first} and {second}" for first, second, _ in plan.dyads[1:])
    six = known.get((first, second)) or known.get((second, first))
    if six is None:
        six = f"Six-bar, with a dyad on {first} and {second}" if plan.base != FIVE_BAR else ""
    if not six:
        return f"{base}, with a dyad on {first} and {second}{added}"
    return f"Eight-bar: {six}{added}" if added else six


def base_items(plan: ChainPlan, extra: dict[str, dict[str, complex]]) -> tuple[list[Item], list[FreeNumber]]:
    """Return the items that a chain begins with, with more points on its links, and its numbers."""

    def points(name: str, **own: complex) -> Link:
        return link(name, **own, **extra.get(name, {}))

    crank, coupler = points(CRANK, A=0, B=0.5), points(COUPLER, B=0, C=2)
    numbers = [length_number("crank.B.x", CRANKS), length_number("coupler.C.x")]
    if plan.base == SLIDER_CRANK:
        sliding: list[Item] = [link(SLIDER, C=0), guide(0.0, 0.3), mode(1, SLIDER)]
        return [points(FRAME, A=0), crank, coupler, *sliding], [*numbers, FreeNumber(GUIDE_OFFSET, *OFFSETS, False)]
    frame = points(FRAME, A=0, D=2)
    if plan.base == FOUR_BAR:
        return [frame, crank, coupler, points(ROCKER, D=0, C=2), mode(1, ROCKER)], [
            *numbers,
            length_number("rocker.C.x"),
        ]
    second: list[Item] = [
        points(SECOND_CRANK, D=0, E0=0.3 + 0.3j),
        points(BAR, E0=0, C=2),
        mode(1, BAR),
        wheels(plan.ratio, 0.0),
    ]
    ends = [FreeNumber(name, -CRANKS[1], CRANKS[1], False, f"{SECOND_CRANK}.E0")
            for name in component_names(f"{SECOND_CRANK}.E0")]  # fmt: skip
    return [frame, crank, coupler, *second], [*numbers, length_number("bar.C.x"), *ends]
