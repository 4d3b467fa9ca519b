"""The result of the comparison of two mechanisms, as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from compoundkin.base.display import DisplaysHtml, count_phrase
from compoundkin.kinematics import Motion
from compoundkin.structure import Structure

# Two mechanisms are taken for the same where they move no farther apart than this part of their size: files of other
# programs have three decimals of numbers up to a hundred or so, and a mechanism enlarges their rounding somewhat.
TOLERANCE = 1e-4
# Distances below this part of the size are rounding.
ROUNDING = 1e-12


@dataclass(frozen=True)
class ComparedFact:
    """Something that is said of both mechanisms, in words."""

    what: str
    one: str
    other: str

    @property
    def differs(self) -> bool:
        """Whether it is said differently."""
        return self.one != self.other


@dataclass(frozen=True)
class ComparedLength:
    """The distance of two points on a link of each mechanism. Both are in the unit of the first."""

    link: str
    other_link: str
    points: tuple[str, str]
    other_points: tuple[str, str]
    one: float
    other: float

    @property
    def difference(self) -> float:
        """By how much that of the second is longer."""
        return self.other - self.one


@dataclass(frozen=True)
class ComparedDriver:
    """A driver of each mechanism. `sign` is -1 where the two count in opposite directions.

    `start` are their values at the common pose, `other_start` in the second's own unit and sense, `reach` the range of
    displacements from there that both have: radians, or the first's unit of length. `speed` and `other_speed` are their
    speeds at the start, the second's in the first's unit and sense. Driven alike, both go at any speed.
    """

    name: str
    other: str
    is_angle: bool
    sign: int
    start: float
    other_start: float
    reach: tuple[float, float] = (0.0, 0.0)
    speed: float = 1.0
    other_speed: float = 1.0


@dataclass(frozen=True)
class PlaceDifference:
    """How far apart a point of each mechanism comes. `drives` are the first's driver values where it is farthest."""

    point: str
    other: str
    distance: float
    drives: Mapping[str, float]


@dataclass(frozen=True)
class TurnDifference:
    """How differently a link of each mechanism turns. In radians, counted from their first pose."""

    link: str
    other: str
    angle: float
    drives: Mapping[str, float]


@dataclass(frozen=True, eq=False, repr=False)
class MechanismComparison(DisplaysHtml):
    """Two mechanisms side by side. All lengths are in the unit of the first, those of the second times `scale`.

    `points` and `links` tell which name of the first stands for which of the second. `places` are the points' greatest
    distances over `poses` poses, the greatest first, `turns` those of links that points alone do not tell;
    `only_one` and `only_other` are points without a counterpart. `apart` poses can be assembled in one of the two
    alone. Where the motions are not compared, `why` tells the reason.
    """

    structures: tuple[Structure, Structure]
    scale: float
    size: float
    matched_by: str
    points: Mapping[str, str]
    links: Mapping[str, str]
    facts: tuple[ComparedFact, ...]
    lengths: tuple[ComparedLength, ...] = ()
    drivers: tuple[ComparedDriver, ...] = ()
    places: tuple[PlaceDifference, ...] = ()
    turns: tuple[TurnDifference, ...] = ()
    motions: tuple[Motion, Motion] | None = None
    poses: int = 0
    apart: int = 0
    why: str = ""

    @property
    def only_one(self) -> tuple[str, ...]:
        """The points of the first that stand for none of the second."""
        return tuple(k for k in self.structures[0].mechanism.carriers if k not in self.points)

    @property
    def only_other(self) -> tuple[str, ...]:
        """The points of the second that stand for none of the first."""
        known = set(self.points.values())
        return tuple(k for k in self.structures[1].mechanism.carriers if k not in known)

    @property
    def largest(self) -> PlaceDifference | None:
        """Where the two come farthest apart; None where their motions are not compared."""
        return self.places[0] if self.places else None

    def within(self, tolerance: float = TOLERANCE) -> bool:
        """Tell whether the two move alike. No point is off by more than this part of the size, no link by more radians.

        Points that only one of them has do not count.
        """
        if not self.places or self.apart:
            return False
        # what is not a number is no agreement
        near = all(one.distance <= tolerance * self.size for one in self.places)
        return near and all(one.angle <= tolerance for one in self.turns)

    @property
    def verdict(self) -> str:
        """What it comes to in words."""
        largest = self.largest
        if largest is None:
            return f"the motions are not compared: {self.why}"
        unit = f" {self.structures[0].mechanism.unit}".rstrip()
        told = f"at most {largest.distance:.3g}{unit} apart, at {largest.point}"
        told = "they move alike to rounding" if largest.distance <= ROUNDING * self.size else told
        missing = f"; {count_phrase(self.apart, 'pose')} can be assembled in one of them alone" if self.apart else ""
        return f"{told}{missing}"

    def __repr__(self) -> str:
        one, other = (structure.mechanism.title for structure in self.structures)
        return f"MechanismComparison({one!r} with {other!r}: {self.verdict})"
