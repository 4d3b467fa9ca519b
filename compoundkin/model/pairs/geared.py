"""Two wheels on a common carrier with a fixed ratio, as gears and belts: sizes, axes, lines of action."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field, replace
from typing import Any, ClassVar, NamedTuple

import numpy as np

from compoundkin.base.arrays import TURN, Number, first_entry
from compoundkin.base.errors import InvalidMechanism, Problem, suggestion
from compoundkin.base.poses import End
from compoundkin.base.series import Series
from compoundkin.base.wrenches import Wrench
from compoundkin.model.fields import link_key, value_key
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contact import CoupleFriction
from compoundkin.model.pairs.contract import (
    DimensionFit,
    DrawnPair,
    Ends,
    Osculation,
    Pair,
    Point,
    Poses,
    Replaceable,
    TurnCounting,
    as_drivable,
    jacobian_of_rows,
)
from compoundkin.model.pairs.loop_terms import Auxiliary, LoopTerms, angle_of, difference
from compoundkin.model.pairs.symbols import known_range

# A drawing shows the angles of wheels to this part of a turn.
DRAWN_TURN = 0.02


@dataclass(frozen=True, eq=False)
class Geared(TurnCounting, Replaceable):
    """Links `first` and `second`, which turn on the link `carrier` in a fixed ratio.

    An axis is the point that a link shares with the carrier; `first_at` and `second_at` name it where there are
    several. The ratio is that of `teeth` or of `radii`, numbers for first and second. With both angles taken from
    the carrier, ``second = phase - ratio * first`` where `ratio` is `sizes` one over the other, negative for wheels
    that turn alike; `phase` (radians) is read off the drawing where it is not stated, or zero.

    Held: that sum of angles. Free: the angle of the first from the carrier. Source: e.g. R. L. Norton, Design of
    Machinery, chapter 9 (gear trains by Willis's equation).
    """

    first: str = field(metadata=link_key("The link with the first wheel."))
    second: str = field(metadata=link_key("The link with the second wheel."))
    _: KW_ONLY
    carrier: str = field(default="frame", metadata=link_key("The link that carries both axes."))
    teeth: Sizes = field(default=None, metadata=value_key("two", "Numbers of teeth of the two wheels."))
    radii: Sizes = field(default=None, metadata=value_key("two", "Radii of the wheels, of pitch circles for gears."))
    phase: Number | None = field(
        default=None,
        metadata=value_key("angle", "Angle of the second from the carrier where that of the first is zero."),
    )
    first_at: str = field(
        default="",
        metadata=value_key("name", "The axis of the first link, where it shares several points with the carrier."),
    )
    second_at: str = field(
        default="",
        metadata=value_key("name", "The axis of the second link, where it shares several points with the carrier."),
    )

    held: ClassVar[int] = 1
    held_angles: ClassVar[tuple[int, ...]] = (0,)
    free: ClassVar[tuple[str, ...]] = ("angle",)
    free_is_angle: ClassVar[bool] = True
    is_geared: ClassVar[bool] = True

    def __post_init__(self) -> None:
        """Two sizes are numbers or arrays."""
        super().__post_init__()
        for name in ("teeth", "radii"):
            object.__setattr__(self, name, two_sizes(name, getattr(self, name)))

    @property
    def turns_alike(self) -> bool:
        """Whether, seen from the carrier, both wheels turn in one direction."""
        raise NotImplementedError

    @property
    def members(self) -> tuple[str, ...]:
        """The two wheels and their carrier."""
        return self.first, self.second, self.carrier

    @property
    def letters(self) -> tuple[str, ...]:
        """The axes of the two wheels."""
        return self.first_at, self.second_at

    @property
    def sizes(self) -> Two:
        """The two numbers whose ratio counts, the second negative for wheels that turn alike."""
        one, two = self.teeth or self.radii or (1.0, 1.0)
        return one, -two if self.turns_alike else two

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find unknown links, one link twice, axes that the carrier lacks, and invalid sizes."""
        yield from wheel_problems(links, self.members, self.letters, where)
        yield from size_problems(self.teeth, self.radii, where)

    def completed(self, links: Mapping[str, tuple[str, ...]]) -> Geared:
        """Return the pair with its axes: an unnamed one is the only point that its wheel shares with the carrier."""
        found: dict[str, Any] = {}
        for key, name in (("first_at", self.first), ("second_at", self.second)):
            shared = [letter for letter in links.get(name, ()) if letter in links.get(self.carrier, ())]
            if not getattr(self, key) and len(shared) == 1:
                found[key] = shared[0]
        return replace(self, **found) if found else self

    @property
    def axes(self) -> str:
        """Where its axes are, in words."""
        return f"{self.first_at} and {self.second_at} on {self.carrier!r}"

    def distance(self, geometry: Geometry) -> Number:
        """Return the distance between the two axes on the carrier."""
        axes = geometry.points[self.carrier]
        return np.abs(axes[self.second_at] - axes[self.first_at])

    def distance_fit(self, key: str, distance: Number, required: Number, reason: str) -> DimensionFit:
        """Return what fits where the axes have the required distance, for a reason in words."""
        room = FITS * np.abs(distance) - np.abs(required - distance)
        words = (f"{reason} ", required, f", but {self.axes} are ", distance, " apart")
        return DimensionFit(
            key, room, words, "change the sizes or move an axis; give teeth alone for a distance as it is"
        )

    def ends(self, geometry: Geometry) -> Ends:
        """Return axes and sizes on the wheels, and on the carrier the phase, read off a drawing of all three links."""
        one, two = self.sizes
        first = End(geometry.points[self.first][self.first_at], None, one)
        second = End(geometry.points[self.second][self.second_at], None, two)
        return first, second, End(geometry.points[self.carrier][self.first_at], None, self._phase(geometry))

    def _phase(self, geometry: Geometry) -> Number:
        if self.phase is not None or any(name not in geometry.drawn for name in self.members):
            return 0.0 if self.phase is None else self.phase
        first, second, carrier = (geometry.drawn[name].angle.c[0] for name in self.members)
        one, two = self.sizes
        return (second - carrier) + (first - carrier) * (one / two)

    def drawn_angle(self, seen: DrawnPair, own: int) -> Number | None:
        """Return the second wheel's angle; the first one's is not unique, as a drawing shows no turns."""
        first, _, carrier = seen.poses
        if own != 1 or first is None or carrier is None:
            return None
        return carrier.angle.c[0] + seen.ends[2].measure - ratio(seen.ends) * (first.angle - carrier.angle).c[0]

    def with_link_turns(self, ends: Ends, geometry: Geometry, turns: tuple[Number, ...]) -> Ends:
        """Return the ends with a drawn phase advanced by whole turns of wheels and carrier."""
        if self.phase is not None or any(name not in geometry.drawn for name in self.members):
            return ends
        one, two, carrier = turns
        ahead = 2.0 * np.pi * ((two - carrier) + (one - carrier) * ratio(ends))
        return *ends[:2], ends[2]._replace(measure=ends[2].measure + ahead)

    def stated_turns(self, ends: Ends, angles: tuple[Number, ...], own: Sequence[int]) -> Number:
        """Return the turns by which the phase, where it is stated, puts members ahead of their drawn angles."""
        n = ratio(ends)
        by_angle = (n, 1.0, -1.0 - n)
        ahead = sum(by_angle[k] for k in own)
        if self.phase is None or np.any(ahead == 0.0):
            return 0.0
        missing = ends[2].measure - sum(a * b for a, b in zip(by_angle, angles, strict=True))
        turns = missing / (TURN * ahead)
        return np.where(np.abs(turns - np.round(turns)) < DRAWN_TURN, np.round(turns), 0.0)

    def closure(self, ends: Ends, poses: Poses) -> tuple[Series, ...]:
        """Return the angle of the second wheel less that by the first."""
        first, second, carrier = (pose.angle for pose in poses)
        return ((second - carrier) + (first - carrier) * ratio(ends) - ends[2].measure,)

    def coordinate(self, ends: Ends, poses: Poses) -> Series:
        """Return the angle of the first wheel from the carrier."""
        return poses[0].angle - poses[2].angle

    def jacobian(self, ends: Ends, poses: Poses) -> Number:
        """Return the rows of the sum of angles and of the first angle."""
        turned = ratio(ends)
        return jacobian_of_rows(
            (0.0, 0.0, turned, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0 - turned), (0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0)
        )

    def centre(self, ends: Ends, poses: Poses) -> Point:
        """Return the pitch point on the line of axes, at infinity for equal wheels that turn alike."""
        one, two = ends[0].measure, ends[1].measure
        first, second = axes_of(ends, poses)
        place = first * two + second * one
        return Point(-place.real / two, -place.imag / two, -(one + two) / two)

    def loop_terms(self, ends: Ends) -> LoopTerms:
        """Return the equation of its angles; no loop runs through it."""
        first, second, carrier = (angle_of(name) for name in self.members)
        turned = difference(carrier, first).times(-ratio(ends))
        tied = difference(turned, difference(carrier, second)).plus(-ends[2].measure)
        equation = Auxiliary(self.name, tied, counts_turns=True)
        return LoopTerms(
            (ends[0].point, ends[1].point), (self.first_at, self.second_at), equations=(equation,), is_crossed=False
        )

    def reach(self, one: Number, two: Number, distance: Number) -> Number:
        """Return the factor from the sizes to the radii of the circles that the line of action touches."""
        return distance / (2.0 * (np.abs(one) + np.abs(two)))

    def circles(self, ends: Ends, poses: Poses) -> tuple[Number, Number]:
        """Return the radii of the circles that a line of action touches, the second negative for outer tangents."""
        first, second = axes_of(ends, poses)
        one, two = (end.measure for end in ends[:2])
        reach = self.reach(one, two, np.abs(second - first))
        return one * reach, two * reach

    def osculation(self, ends: Ends, poses: Poses) -> Osculation:
        """Return where the line of action, of involutes or of a belt, touches the circles about the axes."""
        line = line_of_action(axes_of(ends, poses), self.circles(ends, poses))
        return Osculation(line.first, line.second, line.across * 1j)

    def is_affine(self, lower: Pair, own: int) -> bool:
        """Return whether a pair is a pin, at which any member turns in proportion."""
        return lower.free_is_angle and as_drivable(lower) is not None

    def generic(self, rng: np.random.Generator) -> Ends:
        """Return axes at random places with the given ratio, which may lock a train."""
        one, two = (float(first_entry(size)) for size in self.sizes)
        places = (complex(*rng.standard_normal(2)) for _ in range(2))
        return *(End(place, None, size) for place, size in zip(places, (one, two), strict=True)), End(0j, None, 0.0)

    @property
    def rank_key(self) -> Hashable:
        """The kind and the ratio."""
        one, two = (float(first_entry(size)) for size in self.sizes)
        return type(self), one / two

    def apart(self, ends: Ends, poses: Poses) -> float:
        """Return the distance of the axes, the same at all poses."""
        first, second = axes_of(ends, poses)
        return known_range(abs(second - first))[0]


class ToothFriction(CoupleFriction):
    """Teeth or a belt, whose losses are a part of the torque that they transmit."""

    @property
    def arm(self) -> Number:
        """One: its normal force is a torque."""
        return 1.0


class FrictionMesh(Geared, ToothFriction):
    """Teeth or a belt with losses: a part of the torque on the second wheel, of which the carrier takes the reaction.

    It is lost by the wheel's speed against the carrier, so that a train has the efficiency of its carrier at rest.
    Source: the basic efficiency of epicyclic trains, e.g. J. H. Glover, Machine Design 1965; F. L. Litvin et al.
    """

    @property
    def rubbing(self) -> tuple[str, str]:
        """The carrier and the second wheel."""
        return self.carrier, self.second

    def normal_forces(self, ends: Ends, poses: Poses, wrench: Wrench, length: Number | None) -> tuple[Number, ...]:
        """Return the torque on the second wheel about its axis."""
        return (wrench.about(axes_of(ends, poses)[1]),)


class LineOfAction(NamedTuple):
    """Where a line touches the circles about two axes, in the world. `across` is a unit vector at right angles."""

    first: Number
    second: Number
    across: Number


def ratio(ends: Ends) -> Number:
    """Return the backward turns of the second wheel for one of the first, relative to the carrier."""
    return ends[0].measure / ends[1].measure


def axes_of(ends: Ends, poses: Poses) -> tuple[Number, Number]:
    """Return where the axes of two wheels are."""
    first, second = (pose.at(end.point).c[0] for pose, end in zip(poses[:2], ends[:2], strict=True))
    return first, second


def line_of_action(axes: tuple[Number, Number], radii: tuple[Number, Number], side: float = 1.0) -> LineOfAction:
    """Return a common tangent of the circles about two axes.

    It is the inner one; the outer one where the second radius is negative. It touches the first circle to the left of
    the line from axis to axis, or to the right for a `side` of -1.

    >>> complex(line_of_action((0j, 5 + 0j), (1.0, -1.0)).second)
    (5+1j)
    """
    (first, second), (one, two) = axes, radii
    distance = np.abs(second - first)
    cosine = (one + two) / distance
    across = (second - first) / distance * (cosine + 1j * side * np.sqrt(1.0 - cosine**2))
    return LineOfAction(first + one * across, second - two * across, across)


Two = tuple[Number, Number]
Sizes = Sequence[Number] | None
# Radii fit a centre distance that they meet to this part of it: drawings are given to some five digits.
FITS = 1e-5


def two_sizes(key: str, value: Any) -> Two | None:
    """Return two sizes as numbers or arrays. Raises InvalidMechanism naming the key for anything else.

    >>> two_sizes("teeth", (20, 40))
    (20.0, 40.0)
    """
    if value is None:
        return None
    try:
        one, two = (np.asarray(size, dtype=float) for size in value)
    except (TypeError, ValueError):
        what = f"{value!r} are not two numbers"
        raise InvalidMechanism(Problem(key, what, f"write {key}=(20, 40)")) from None
    return one.item() if one.ndim == 0 else one, two.item() if two.ndim == 0 else two


def wheel_problems(
    links: Mapping[str, tuple[str, ...]], members: Sequence[str], axes: Sequence[str], where: str
) -> Iterator[Problem]:
    """Find unknown links, one link twice, and axes that are not shared."""
    named = dict(zip(("first", "second", "carrier"), members, strict=True))
    missing = [(key, name) for key, name in named.items() if name not in links]
    for key, name in missing:
        yield Problem(f"{where}.{key}", f"there is no link {name!r}", suggestion(name, list(links)))
    if not missing and len(set(members)) < len(members):
        yield Problem(where, "the two wheels and their carrier are not three different links", "name three links")
    elif not missing:
        for key, axis in zip(("first", "second"), axes, strict=True):
            yield from _axis_problems(links, (named[key], named["carrier"]), axis, where, key)


def _axis_problems(
    links: Mapping[str, tuple[str, ...]], pinned: tuple[str, str], axis: str, where: str, key: str
) -> Iterator[Problem]:
    """Find an axis that a wheel and its carrier, the links `pinned`, do not share."""
    name, carrier = pinned
    shared = [letter for letter in links[name] if letter in links[carrier]]
    if axis and axis not in shared:
        what = f"{name!r} and {carrier!r} do not share the point {axis!r}"
        yield Problem(f"{where}.{key}_at", what, suggestion(axis, shared))
    elif not shared:
        what = f"{carrier!r} does not carry the axis of {name!r}: they share no point"
        yield Problem(f"{where}.carrier", what, "give both a point of one letter, or name another carrier")
    elif not axis:
        what = f"{name!r} and {carrier!r} share several points"
        yield Problem(f"{where}.{key}_at", what, f"name the axis: {', '.join(shared)}")


def size_problems(teeth: Sizes, radii: Sizes, where: str) -> Iterator[Problem]:
    """Find invalid sizes, and teeth and radii of different ratios."""
    if teeth is None and radii is None:
        yield Problem(where, "it has no sizes", "give teeth = (20, 40) or radii = (10, 20)")
    for key, sizes in (("teeth", teeth), ("radii", radii)):
        if sizes is None:
            continue
        if not all(np.all(np.asarray(size) > 0) for size in sizes):
            yield Problem(f"{where}.{key}", f"{_sizes_text(sizes)} are not two positive numbers")
        elif key == "teeth" and not all(np.all(np.asarray(size) == np.round(size)) for size in sizes):
            yield Problem(f"{where}.{key}", f"{_sizes_text(sizes)} are not whole numbers", "give radii instead")
    if teeth is not None and radii is not None and not _proportional(teeth, radii):
        what = f"teeth {_sizes_text(teeth)} and radii {_sizes_text(radii)} have different ratios"
        yield Problem(where, what, "leave one of them out")


def _proportional(one: Sequence[Number], two: Sequence[Number]) -> bool:
    return bool(np.all(np.abs(one[0] * two[1] - one[1] * two[0]) <= FITS * np.abs(one[0] * two[1])))


def _sizes_text(sizes: Sequence[Number]) -> str:
    return " and ".join(f"{size:g}" if np.ndim(size) == 0 else str(np.asarray(size).tolist()) for size in sizes)


def pressure_problems(angle: Number, where: str) -> Iterator[Problem]:
    """Find an invalid pressure angle."""
    if np.ndim(angle) or not 0.0 <= angle < np.pi / 2.0:
        text = f"{np.rad2deg(angle):g} degrees" if np.ndim(angle) == 0 else "an array"
        remedy = "give one angle from 0 up to 90 degrees, such as pressure_angle=ck.deg(20)"
        yield Problem(f"{where}.pressure_angle", f"{text} is not a pressure angle", remedy)


def radius_problems(where: str, key: str, radius: Number | None) -> Iterator[Problem]:
    """Find a radius, or another length or number, that is not positive."""
    if radius is not None and not np.all(np.asarray(radius) > 0):
        text = f"{radius:g}" if np.ndim(radius) == 0 else str(np.asarray(radius).tolist())
        yield Problem(f"{where}.{key}", f"{text} is not positive", "give the size of the wheel")
