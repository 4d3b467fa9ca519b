"""Chains whose points trace curves: crank-driven linkages with free dimensions, as programs over many designs.

A chain is a four-bar or a slider-crank; each dyad more lies on two of its links. With a dyad on two links of a four-bar
that are not both its crank and frame this gives the six-bars of Watt and Stephenson that a crank on the frame drives
through dyads alone (E. A. Dijksman, Motion Geometry of Mechanisms, Cambridge 1976), with a second dyad eight-bars.

A chain grows by a dyad that carries its point on: with the point at the dyad's joint it traces what it traced before,
so that no growth loses anything.
"""

from __future__ import annotations

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
from compoundkin.model.elements import Item, Link, drive, link, mode
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import slide
from compoundkin.programs.call_numbers import Call
from compoundkin.programs.compiled_path import CompiledPath, compile

CRANK, ROCKER, SLIDER, ROD, LEVER, GUIDE = "crank", "rocker", "slider", "rod", "lever", "guide"
GUIDE_OFFSET = f"{GUIDE}.offset"
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
    """What a chain is made of: a slider-crank or a four-bar, dyads, and the link that has P."""

    with_slider: bool
    dyads: tuple[AddedDyad, ...]
    traced: str


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
        return 4 + 2 * len(self.plan.dyads)

    @property
    def has_slider(self) -> bool:
        """Whether one of its links slides."""
        return self.plan.with_slider

    @cached_property
    def program(self) -> CompiledPath:
        """Its program: the place of P for dimensions and the crank's angle."""
        some = self.dimensions(np.zeros((1, len(self.numbers))))
        return compile(self.mechanism, [f"{POINT}.{POSITION}"], free=list(some))

    def designs(self, units: Number) -> Number:
        """Return designs of an array (designs, numbers) of numbers from 0 to 1."""
        low, high = np.array([[np.log(one[1:3]) if one.is_length else one[1:3]] for one in self.numbers]).T
        return low[0] + (high[0] - low[0]) * units

    def dimensions(self, designs: Number) -> dict[str, Number]:
        """Return the dimensions of designs by name, arrays (designs, 1)."""
        values = {one.name: np.exp(column) if one.is_length else column
                  for one, column in zip(self.numbers, designs.T[:, :, None], strict=True)}  # fmt: skip
        points = {one.point: component_names(one.point) for one in self.numbers if one.point}
        found = {name: values[x] + 1j * values[y] for name, (x, y) in points.items()}
        return found | {one.name: values[one.name] for one in self.numbers if not one.point}

    def size(self, designs: Number) -> Number:
        """Return the greatest length or coordinate of each design."""
        lengths = np.array([one.is_length for one in self.numbers])
        return np.where(lengths, np.exp(np.where(lengths, designs, 0.0)), np.abs(designs)).max(axis=1)

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
        by = [np.broadcast_to(found[output, one.name], shape) for one in self.numbers]
        by = [slope * np.exp(designs[:, [k]]) if one.is_length else slope
              for k, (one, slope) in enumerate(zip(self.numbers, by, strict=True))]  # fmt: skip
        return found[output, ""], np.array(by), found[output, CRANK], clear

    def grown(self, second: str, sign: int) -> CurveChain:
        """Return the chain with a dyad more, whose rod lies on the link of P and carries P on."""
        plan = self.plan
        names = _NAMES[len(plan.dyads)]
        return curve_chain(ChainPlan(plan.with_slider, (*plan.dyads, AddedDyad(plan.traced, second, sign)), names.rod))

    @property
    def parent(self) -> CurveChain:
        """The chain that grew to this by its last dyad."""
        *dyads, last = self.plan.dyads
        return curve_chain(ChainPlan(self.plan.with_slider, tuple(dyads), last.first))

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
        size, still = abs(laying.scale), np.zeros(len(angles))
        z = {name: laying.laid(np.ravel(pose.z.c[0]) + still) for name, pose in motion.poses.items()}
        u = {name: laying.turned(np.ravel(pose.u.c[0]) + still) for name, pose in motion.poses.items()}
        z[FRAME], u[FRAME] = still + 0j, still + 1.0 + 0j
        points = {
            name: {
                letter: complex(laying.laid(p) if name == FRAME else laying.as_seen(size * p))
                for letter, p in each.items()
            }
            for name, each in own.geometry.points.items()
        }
        pairs = list[Item]()
        if GUIDE_OFFSET in dimensions:
            offset = size * float(dimensions[GUIDE_OFFSET])
            pairs.append(guide(float(np.angle(laying.turned(1.0))), -offset if laying.mirrored else offset))
        joints = [
            [p for letter, p in each.items() if letter != POINT] for name, each in points.items() if name != FRAME
        ]
        return Linkage(
            title=own.title,
            links=tuple(link(name, **each) for name, each in points.items()),
            pairs=tuple(pairs),
            places={letter: complex(laying.laid(np.ravel(at.position)[0])) for letter, at in motion.points.items()},
            z=z,
            u=u,
            drivers={CRANK: unwrapped(np.angle(u[CRANK]))},
            pivots=tuple(points[FRAME].values()),
            lengths=tuple(abs(b - a) for each in joints for a, b in combinations(each, 2)),
            error=error,
            outputs=(f"{POINT}.{POSITION}",),
            source="an atlas of coupler curves",
        )

    @property
    def carriers(self) -> tuple[str, ...]:
        """The links that the second link of a dyad more may lie on."""
        added = [name for names in _NAMES[: len(self.plan.dyads)] for name in (names.rod, names.lever)]
        base = (FRAME, CRANK, COUPLER) if self.has_slider else (FRAME, CRANK, COUPLER, ROCKER)
        return tuple(name for name in (*base, *added) if name != self.plan.traced)


def turn(poses: int) -> Number:
    """Return so many angles of a crank over a turn."""
    return np.arange(poses) * (TURN / poses)


def _length(name: str, between: tuple[float, float] = LENGTHS) -> FreeNumber:
    return FreeNumber(name, *between, True)


def _place(link_name: str, letter: str) -> list[FreeNumber]:
    point = f"{link_name}.{letter}"
    return [FreeNumber(name, *PLACES, False, point) for name in component_names(point)]


# The two links of a four-bar that a second dyad lies on, and what the six-bar is then called.
_SIX_BARS = {
    (COUPLER, FRAME): "Stephenson III",
    (ROCKER, FRAME): "Watt II",
    (COUPLER, ROCKER): "Watt I",
    (CRANK, COUPLER): "Watt I, its ternary link driven",
    (CRANK, ROCKER): "Stephenson I",
}
# Those of a slider-crank.
_SIX_BARS_WITH_SLIDER = {(COUPLER, FRAME): "Stephenson III with slider", (CRANK, COUPLER): "Watt I with slider"}
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
    [2, 24, 232]
    """
    found = [curve_chain(ChainPlan(with_slider, (), COUPLER)) for with_slider in (False, True)]
    if links >= 6:
        for with_slider in (False, True):
            for pair in _SIX_BARS_WITH_SLIDER if with_slider else _SIX_BARS:
                # a link on the frame traces a circle
                traced = (ROD,) if FRAME in pair else (ROD, LEVER)
                found += [curve_chain(ChainPlan(with_slider, (AddedDyad(*pair, sign),), name))
                          for sign in (1, -1) for name in traced]  # fmt: skip
    if links >= 8:
        six = [one for one in found if one.links == 6]
        found += [one.grown(second, sign) for one in six for second in one.carriers for sign in (1, -1)]
    return tuple(found)


def guide(angle: float, offset: float) -> Item:
    """Return the guide of a slider at a distance from the crank's pivot."""
    return slide(SLIDER, on=FRAME, at="C", through="A", angle=angle, offset=offset, name=GUIDE)


@cache
def curve_chain(plan: ChainPlan) -> CurveChain:
    """Return the chain of a plan, with its reference drawing."""
    points: dict[str, dict[str, complex]] = {}
    added: list[FreeNumber] = []
    for names, dyad in zip(_NAMES, plan.dyads, strict=False):
        on_first, on_second = (dyad.first, names.on_first), (dyad.second, names.on_second)
        for (name, letter), place in zip((on_first, on_second), names.places, strict=True):
            points.setdefault(name, {})[letter] = place
            added += _place(name, letter)
        points.setdefault(names.rod, {})
        added += [_length(component_names(f"{name}.{names.joint}")[0]) for name in (names.rod, names.lever)]
    points.setdefault(plan.traced, {})[POINT] = _POINT
    items, numbers = _base(plan.with_slider, points)
    for names, dyad in zip(_NAMES, plan.dyads, strict=False):
        for name, letter in ((names.rod, names.on_first), (names.lever, names.on_second)):
            items.append(link(name, **{letter: 0, names.joint: names.length}, **points.get(name, {})))
        items.append(mode(dyad.sign, names.lever))
    title = _title(plan)
    mechanism = Mechanism(title, *items, drive(CRANK))
    return CurveChain(plan, title, mechanism, (*numbers, *added, *_place(plan.traced, POINT)))


def _title(plan: ChainPlan) -> str:
    if not plan.dyads:
        return "Slider-crank" if plan.with_slider else "Four-bar"
    known = _SIX_BARS_WITH_SLIDER if plan.with_slider else _SIX_BARS
    first, second, _ = plan.dyads[0]
    six = known.get((first, second)) or known.get((second, first)) or f"Six-bar, with a dyad on {first} and {second}"
    if len(plan.dyads) == 1:
        return six
    first, second, _ = plan.dyads[1]
    return f"Eight-bar: {six}, with a dyad on {first} and {second}"


def _base(with_slider: bool, extra: dict[str, dict[str, complex]]) -> tuple[list[Item], list[FreeNumber]]:
    """Return the items of a four-bar or a slider-crank with more points on its links, and its numbers."""

    def points(name: str, **own: complex) -> Link:
        return link(name, **own, **extra.get(name, {}))

    crank, numbers = points(CRANK, A=0, B=0.5), [_length("crank.B.x", CRANKS), _length("coupler.C.x")]
    items: list[Item]
    if with_slider:
        items = [points(FRAME, A=0), crank, points(COUPLER, B=0, C=2), link(SLIDER, C=0)]
        items += [guide(0.0, 0.3), mode(1, SLIDER)]
        return items, [*numbers, FreeNumber(GUIDE_OFFSET, *OFFSETS, False)]
    items = [points(FRAME, A=0, D=2), crank, points(COUPLER, B=0, C=2), points(ROCKER, D=0, C=2), mode(1, ROCKER)]
    return items, [*numbers, _length("rocker.C.x")]
