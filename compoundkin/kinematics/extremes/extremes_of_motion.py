"""The least and greatest values of quantities over a motion, between its poses too."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.extremes.extreme_search import ExtremeSearch
from compoundkin.kinematics.extremes.measures import Measure, measures_of
from compoundkin.kinematics.extremes.places import Places, closed_cycles
from compoundkin.kinematics.extremes.stretches import Stretches, stretches_of
from compoundkin.kinematics.motion import Motion


@dataclass(frozen=True, eq=False, repr=False)
class Extreme(ShortRepr):
    """The least or greatest values of a quantity, one of each design or piece.

    Values are in the quantity's unit (radians), NaN where nothing is assembled, infinite where they grow without limit
    towards a limit position. `at` is where they are first taken, `until` the pose to which they are kept from there.
    """

    value: Number
    at: Places
    until: Number


@dataclass(frozen=True, eq=False, repr=False)
class Extremes(ShortRepr):
    """The least and greatest values of a quantity, of each design or piece."""

    name: str
    unit: str
    least: Extreme
    greatest: Extreme
    is_constant: Number

    @property
    def stroke(self) -> Number:
        """The greatest less the least value."""
        return self.greatest.value - self.least.value


@dataclass(frozen=True, eq=False, repr=False)
class AssembledPieces(ShortRepr):
    """The assembled pieces of a motion, in order along each design; arrays (n,).

    Each goes from `begin` to `end`; `limits` (n, 2) tells at which ends it stops being assembled. A piece that goes on
    through the end of a closed cycle begins after its end.
    """

    begin: Places
    end: Places
    limits: Number


@checked
def extremes(motion: Motion, *quantities: str | Measure, by_piece: bool = False) -> tuple[Extremes, ...]:
    """Return the least and greatest values of quantities, between the poses too.

    Names are those of `quantity` that mean numbers ("G.velocity.length", "bar.angle"); arrays are of shape (designs,),
    or ``by_piece`` of shape (pieces,), one for each of `pieces`. They are found by solving again, so that they do not
    depend on the poses; where a derivative jumps the values on both sides count, and next to a limit position rates may
    grow without limit. Raises UnknownName for names that the motion does not have, InvalidInput for vectors and a
    motion of a single pose.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> found, = extremes(solve(load("slider-crank-offset")), "B.x")
    >>> found.greatest.value.round(6), np.rad2deg(found.greatest.at.drives["crank"]).round(6)
    (array([158.745079]), array([352.819244]))
    """
    _hold(motion)
    stretches = stretches_of(motion)
    group, designs = stretches.design, np.arange(motion.inputs.designs)
    if by_piece:
        group, first, _ = _piece_groups(motion)
        designs = stretches.design[first]
    return _extremes(motion, quantities, stretches, group, designs)


@checked
def pieces(motion: Motion) -> AssembledPieces:
    """Return the assembled pieces of a motion. Raises InvalidInput for a single pose.

    >>> import warnings
    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> with warnings.catch_warnings(action="ignore"):
    ...     motion = solve(load("triple-rocker"), np.deg2rad(np.arange(0.0, 361.0, 5.0)))
    >>> found = pieces(motion)  # one piece, through the end of the cycle
    >>> np.rad2deg([found.begin.drives["driver"], found.end.drives["driver"]]).round(4).tolist()
    [[271.0232], [88.9768]]
    """
    _hold(motion)
    stretches, (_, first, last) = stretches_of(motion), _piece_groups(motion)
    begin, end = (Places(motion, stretches.design[k], at[k])
                  for k, at in ((first, stretches.low), (last, stretches.high)))  # fmt: skip
    return AssembledPieces(begin, end, np.stack([stretches.limits[first, 0], stretches.limits[last, 1]], axis=-1))


def _piece_groups(motion: Motion) -> tuple[Number, Number, Number]:
    """Return the number of the piece of each stretch, and the first and the last stretch of each piece.

    The first piece of a closed cycle goes on from its last one.
    """
    s = stretches_of(motion)
    group, closed = s.piece.copy(), closed_cycles(motion)
    first, last = (
        np.flatnonzero(np.diff(s.piece, prepend=-1) if k == 0 else np.diff(s.piece, append=-1)) for k in (0, 1)
    )
    for design in np.flatnonzero(closed):
        mine = np.flatnonzero(s.design[first] == design)
        if len(mine) > 1:
            group[group == mine[-1]] = mine[0]
            first[mine[0]] = first[mine[-1]]
    kept = np.unique(group)
    return np.searchsorted(kept, group), first[kept], last[kept]


def _hold(motion: Motion) -> None:
    if motion.inputs.poses < 2:
        raise InvalidInput(Problem("motion", "a single pose has no extremes", "solve it at several values of a driver"))


def _extremes(
    motion: Motion, quantities: tuple[str | Measure, ...], stretches: Stretches, group: Number, designs: Number
) -> tuple[Extremes, ...]:
    measures = measures_of(motion, quantities)
    search = ExtremeSearch(motion, measures, stretches, group, len(designs))
    found = search.peaks()
    constant = found.value[:, 1] - found.value[:, 0] <= found.slack
    made = []
    for k, one in enumerate(measures):
        sides = []
        for sign in range(2):
            at = Places(motion, designs, found.place[k, sign])
            until = _kept(search.values[k], found.value[k, sign], at, found.slack[k])
            sides.append(Extreme(found.value[k, sign], at, until))
        made.append(Extremes(one.name, one.unit, sides[0], sides[1], constant[k]))
    return tuple(made)


def _kept(values: Number, value: Number, at: Places, slack: Number) -> Number:
    """Return to which pose values are kept from their places on; `values` are those at poses, (designs, poses)."""
    until, last = at.place.copy(), values.shape[1] - 1
    for k in np.flatnonzero(np.isfinite(at.place) & (at.place < last)):
        row = values[at.design[k], int(np.ceil(at.place[k])) :]
        # what is infinite differs from itself by nothing that is a number
        with np.errstate(invalid="ignore"):
            level = (row == value[k]) | (np.abs(row - value[k]) <= slack[k])
        count = len(level) if level.all() else int(np.argmin(level))
        if count > 1:
            until[k] = last - len(row) + count
    return until
