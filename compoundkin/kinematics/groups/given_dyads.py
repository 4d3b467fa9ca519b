"""Dyads given by moving points and lines: assembled by the solvers' formulas, and what is told of the links found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number, entry
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, NotAssembled, Problem, UnassembledPoses, warn
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Series, as_series
from compoundkin.kinematics.groups.dyad import COINCIDENT, DyadSolver, OuterPair
from compoundkin.kinematics.moving_lines import MovingLine, MovingPoint, Travel, numbers_of, shape_of

# The letters of the outer pairs and the inner one, in what is said of a dyad that cannot be assembled.
LETTERS = ("A", "C", "B")
LEGEND = "A and B are the outer pairs, C is the inner one"
# What a solver of a dyad asks for.
Sides = tuple[OuterPair, tuple[End, End], OuterPair]


@dataclass(frozen=True, eq=False, repr=False)
class SolvedDyad(ShortRepr):
    """Two links found: the motion of their inner pair and of both. Numbers or arrays of the shape of what was given.

    `inner` is the inner pin, or the place on a guide where its block is; `first` and `second` are the two links, each a
    line of its own (see the routine), angles between -pi and pi; `travels` are those of the slides, in the order of the
    dyad's name. Where `assembled` is False all are NaN. `margin` tells how far it is from its limit position, negative
    beyond: for two modes the squared sine of the angle in which they differ, for one the sine between the guides. At
    the limit position itself rates are not finite.
    """

    inner: MovingPoint
    first: MovingLine
    second: MovingLine
    travels: tuple[Travel, ...]
    assembled: Number
    margin: Number


class GivenDyad(NamedTuple):
    """A dyad as it is given: sides, mode, shape, and where all is known."""

    sides: Sides
    mode: Number
    shape: tuple[int, ...]
    known: Number

    @classmethod
    def of(cls, sides: Sides, mode: Any = 1, **given: Any) -> GivenDyad:
        """Make one of its sides, whose parts are given by their names."""
        signs = numbers_of("mode", mode)
        if not np.all(np.abs(signs) == 1.0):
            raise InvalidInput(Problem("mode", "a mode is +1 or -1", "the two ways to assemble a dyad"))
        shape = shape_of(mode=signs, **given)
        parts = [part for part in given.values() if isinstance(part, MovingPoint | MovingLine)]
        known = np.broadcast_to(np.all([np.broadcast_to(part.known, shape) for part in parts], axis=0), shape)
        if not known.any():
            raise InvalidInput(Problem(", ".join(given), "NaN at every pose: no position is known", "give numbers"))
        return cls(sides, signs, shape, known)

    def closed(self, kind: type[DyadSolver]) -> FoundDyad:
        """Have it assembled. Raises NotAssembled where it never can be, warns where it sometimes cannot."""
        first, inner, second = self.sides
        with np.errstate(all="ignore"):
            poses, margin, meeting = kind.assemble(first, inner, second, self.mode)
            if meeting is not None:
                reach = np.abs(as_series(first.world.point).c[0]) + np.abs(as_series(second.world.point).c[0])
                margin = np.where(np.sqrt(meeting.c[0]) > COINCIDENT * reach, margin, np.nan)
            margin = np.where(self.known, margin, np.nan)
        found = FoundDyad(poses, margin >= 0, margin, self.shape)
        if missing := np.argwhere(self.known & ~found.assembled).tolist():
            self._tell(kind, missing, found)
        return found

    def _tell(self, kind: type[DyadSolver], missing: list[list[int]], found: FoundDyad) -> None:
        """Say of poses that cannot be assembled how many they are, and why the first one cannot."""
        at = tuple(missing[0])
        first, inner, second = self.sides
        one, two = (OuterPair(_picked(pair.world, at), _picked(pair.local, at)) for pair in (first, second))
        why = kind.explain(one, (_picked(inner[0], at), _picked(inner[1], at)), two, 0, LETTERS)
        text = f"{len(missing)} of {found.assembled.size} poses cannot be assembled: {why}" if at else why
        if not found.assembled.any():
            raise NotAssembled(Problem(kind.name, text, LEGEND))
        where = f"{text} at {at if len(at) > 1 else at[0]}; {LEGEND}"
        warn(f"{kind.name}: {where}; `assembled` masks them", UnassembledPoses)


class FoundDyad(NamedTuple):
    """The two bodies of a dyad as they were assembled, and where."""

    poses: tuple[Pose, Pose]
    assembled: Number
    margin: Number
    shape: tuple[int, ...]

    def told(self, inner: Series, lines: tuple[tuple[Series, Series], ...], *travels: Series) -> SolvedDyad:
        """Return what is told of it. The lines of both links are each a point and a direction."""
        first, second = (MovingLine(MovingPoint(*self._rates(z)), *self._rates(u.angle())) for z, u in lines)
        slides = tuple(Travel(*(numbers_of("travel", rate) for rate in self._rates(travel))) for travel in travels)
        assembled, margin = (np.broadcast_to(value, self.shape) for value in (self.assembled, self.margin))
        if not self.shape:
            return SolvedDyad(MovingPoint(*self._rates(inner)), first, second, slides, bool(assembled), float(margin))
        return SolvedDyad(MovingPoint(*self._rates(inner)), first, second, slides, assembled, margin)

    def _rates(self, series: Series) -> list[Number]:
        """Return position, velocity and acceleration of a series, NaN where it is not assembled."""
        unknown = complex(np.nan, np.nan) if np.iscomplexobj(series.c[0]) else np.nan
        return [np.where(self.assembled, np.broadcast_to(series.derivative(k), self.shape), unknown) for k in range(3)]


def _picked(end: End, at: tuple[int, ...]) -> End:
    """Return a side of a pair at one design and pose."""
    point, along = (None if v is None else Series((entry(as_series(v).c[0], at),)) for v in end[:2])
    return End(point, along)
