"""Springs that balance the efforts of drivers, or make them even: stiffnesses, and the fewest springs that do.

Efforts without friction are linear in the stiffnesses, which follow from linear least squares with bounds.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked, is_real
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr, aligned_text, count_phrase
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.dynamics.balance_conditions import BALANCED
from compoundkin.dynamics.counterweights import BalanceFigure
from compoundkin.dynamics.driver_course import DriverCourse, Line, in_units, nodes, smooth_pieces
from compoundkin.dynamics.force_analysis import force_analysis
from compoundkin.dynamics.forces import Forces
from compoundkin.kinematics.extremes import between, extremes
from compoundkin.kinematics.motion import Motion
from compoundkin.model.elements import Expectation
from compoundkin.model.fields import Item
from compoundkin.model.loads.contract import Load
from compoundkin.model.loads.friction import Friction
from compoundkin.model.loads.gravity import Gravity
from compoundkin.model.loads.mass import Mass
from compoundkin.model.loads.pretension import Pretension
from compoundkin.model.loads.spring import PairSpring, Spring, as_spring, is_force_law
from compoundkin.model.mechanism import Mechanism

# So many springs are chosen from at most: their subsets are tried, four thousand of these.
MOST_SPRINGS = 12
# A stiffness below this part of what its spring alone would have is zero: rounding of least squares.
NO_STIFFNESS = 1e-12


@dataclass(frozen=True, eq=False, repr=False)
class SpringBalance(ShortRepr):
    """A mechanism whose springs balance its drivers' efforts, or make them even.

    `stiffnesses` are those of the springs taken, by name; the others have none in the `mechanism`. `rest` is the root
    mean square of what is left over that without springs, `is_reached` says whether it is within what was asked.
    `before` and `after` are figures of each driver's effort without the springs and with them.
    """

    mechanism: Mechanism
    stiffnesses: Mapping[str, float]
    rest: float
    is_reached: bool
    before: tuple[BalanceFigure, ...]
    after: tuple[BalanceFigure, ...]

    def text(self) -> str:
        """Return the springs and a table of efforts without and with them as text."""
        return aligned_text(tuple(self._lines()))

    def _lines(self) -> Iterator[Line]:
        units = self.mechanism.stated_units
        yield (f"{count_phrase(len(self.stiffnesses), 'spring')}, {self.rest:.3g} of the effort is left",)
        for name, stiffness in self.stiffnesses.items():
            is_turning = isinstance(self.mechanism.loads[name], PairSpring)
            unit = "" if is_turning else f"{units.force}/{units.length}"
            yield f"stiffness of {name}", stiffness, unit
        for when, figures in (("without", self.before), ("with", self.after)):
            for one in figures:
                yield in_units(f"{one.name} {when} them, greatest", one.greatest, one.unit)
                yield in_units(f"{one.name} {when} them, rms", one.rms, one.unit)


@checked
def balancing_springs(
    forces: Forces,
    springs: str | Sequence[str] = (),
    *,
    even: bool = False,
    most: Any = None,
    within: float = BALANCED,
) -> SpringBalance:
    """Return the fewest springs, and their stiffnesses, that balance the drivers' efforts over a motion.

    `springs` of the mechanism are chosen from, by default all, whatever their stiffness is; their places and free
    lengths stay. The squared effort, over the poses and between them, is the least for stiffnesses from 0 to `most`,
    one number or a mapping by spring. Of all sets the smallest is taken that leaves no more than the part `within` of
    the root mean square without springs; where none does, the set that leaves least. With ``even=True`` efforts are to
    be even, the least squared differences from their means. Static balance is that of
    ``force_analysis(motion, inertia=False)``.

    Raises InvalidInput for several designs, friction, and springs that are one-sided, preloaded, tables or functions;
    UnknownName for an unknown spring.

    Source: the least squares with bounds of P. B. Stark and R. L. Parker, Computational Statistics 10, 1995, 129-141;
    springs without free length, e.g. R. H. Nathan, J. Mechanisms, Transmissions and Automation in Design 107, 1985.

    >>> from compoundkin.kinematics import solve
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.loads.gravity import gravity
    >>> from compoundkin.model.loads.mass import mass
    >>> from compoundkin.model.loads.spring import spring
    >>> parts = link("frame", A=0, S=0.5j), link("arm", A=0, B=0.4), drive("arm"), mass("arm", 2, at=1, inertia=0)
    >>> loads = gravity(0, -10), spring("arm", "B", at="S", stiffness=1, name="balancer")
    >>> arm = Mechanism("Arm", *parts, *loads, units={"length": "m", "mass": "kg", "force": "N"})
    >>> found = balancing_springs(force_analysis(solve(arm), inertia=False))
    >>> round(found.stiffnesses["balancer"], 9), found.is_reached               # m g l / (a b)
    (100.0, True)
    """
    _check_linear(forces)
    mechanism = forces.motion.mechanism
    names = _springs_named(mechanism, (springs,) if isinstance(springs, str) else tuple(springs))
    if not (is_real(within) and 0.0 <= within < 1.0):
        raise InvalidInput(Problem("within", f"{within!r} is no part of the effort", "from 0 to below 1"))
    efforts = SpringEfforts(forces, names, even)
    chosen, stiffness, rest = _fewest(efforts, _bounds(names, most), within)
    taken = {names[k]: float(value) for k, value in zip(chosen, stiffness, strict=True)}
    without, balanced = (_with_stiffnesses(forces.motion, names, own) for own in ({}, taken))
    figures = [tuple(_figures(other, forces.inertia, even)) for other in (without, balanced)]
    return SpringBalance(balanced.mechanism, taken, rest, rest <= within, figures[0], figures[1])


def _check_linear(forces: Forces) -> None:
    """Raise InvalidInput for several designs, poses that are not assembled, and friction."""
    motion = forces.motion
    if motion.inputs.designs != 1 or not motion.inputs.is_rigid:
        raise InvalidInput(Problem("forces", "only one design is balanced at a time", "solve that design by itself"))
    if motion.inputs.poses < 2 or np.any(motion.failed):
        remedy = "solve a range throughout which it closes, the travel"
        raise InvalidInput(Problem("forces", "the motion must be assembled throughout", remedy))
    if motion.mechanism.frictions:
        what = "with friction efforts are not linear in the stiffnesses"
        raise InvalidInput(Problem("forces", what, "leave the friction out, and put it in again afterwards"))


def _springs_named(mechanism: Mechanism, names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the springs to choose from. Raises UnknownName, and InvalidInput for those that are not linear."""
    known = {name: found for name, load in mechanism.loads.items() if (found := as_spring(load)) is not None}
    if unknown := [name for name in names if name not in known]:
        problem = Problem("springs", f"there is no spring {unknown[0]!r}", suggestion(str(unknown[0]), list(known)))
        raise UnknownName(problem)
    chosen = tuple(dict.fromkeys(names)) or tuple(known)
    if not chosen:
        raise InvalidInput(Problem("springs", "the mechanism has no spring", "add some: ck.spring(..., stiffness=1)"))
    if len(chosen) > MOST_SPRINGS:
        raise InvalidInput(Problem("springs", f"{len(chosen)} are too many to choose from", f"name {MOST_SPRINGS}"))
    for name in chosen:
        if why := _why_not_linear(known[name]):
            raise InvalidInput(Problem(f"springs.{name}", why, "name the others: springs=[...]"))
    return chosen


def _why_not_linear(one: Spring | PairSpring) -> str:
    if one.only is not None:
        return f"it acts in {one.only} only: its force is not linear in the stiffness"
    if is_force_law(one.stiffness):
        return "its force is a function or a table, and has no stiffness to choose"
    return "it has a preload, which a free length stands for" if np.any(np.asarray(one.preload) != 0.0) else ""


def _bounds(names: tuple[str, ...], most: Any) -> Number:
    """Return the greatest stiffness of each spring."""
    given = most if isinstance(most, Mapping) else dict.fromkeys(names, np.inf if most is None else most)
    for name, value in given.items():
        if name not in names:
            raise UnknownName(Problem("most", f"{name!r} is none of the springs", suggestion(str(name), list(names))))
        if not (is_real(value) and float(value) > 0.0):
            raise InvalidInput(Problem(f"most.{name}", f"{value!r} is no greatest stiffness", "a number above 0"))
    return np.array([float(given.get(name, np.inf)) for name in names])


class SpringEfforts:
    """The efforts of drivers without springs, and those of each spring of unit stiffness, at Gauss's places."""

    def __init__(self, forces: Forces, names: tuple[str, ...], even: bool) -> None:
        designs, places, weights = nodes(smooth_pieces(forces.motion))
        self.at = between(forces.motion, designs, places, 2 if forces.inertia else 1)
        self.weights, self.even, self.size = weights, even, forces.motion.size
        alone = [_only_spring(self.at, name) for name in names]
        self.columns = np.stack([self._efforts(one, False) for one in alone], axis=-1)
        self.aims = -self._efforts(_with_stiffnesses(self.at, names, {}), forces.inertia)

    def _efforts(self, motion: Motion, inertia: bool) -> Number:
        """Return the weighted efforts of all drivers one after another, thrusts times the size."""
        found, rows = force_analysis(motion, inertia=inertia).drives, []
        for name, drive in motion.drives.items():
            effort = np.ravel(found[name].effort)
            if self.even:
                effort = effort - np.sum(self.weights * effort) / np.sum(self.weights)
            rows.append(np.sqrt(self.weights) * effort * (1.0 if drive.is_angle else self.size))
        return np.concatenate(rows)

    def fit(self, chosen: Sequence[int], most: Number) -> tuple[Number, float]:
        """Return the stiffnesses of some springs, and the part of the efforts that they leave."""
        # scipy.optimize takes long to import
        from scipy.optimize import lsq_linear

        whole = float(np.linalg.norm(self.aims))
        columns = self.columns[:, list(chosen)]
        scales = np.linalg.norm(columns, axis=0)
        if not len(chosen) or not whole or not scales.all():
            return np.zeros(len(chosen)), 1.0 if whole else 0.0
        bounds = np.zeros(len(chosen)), most[list(chosen)] * scales / whole
        found = lsq_linear(columns / scales, self.aims / whole, bounds, method="bvls", tol=1e-15).x
        found = np.where(found > NO_STIFFNESS, found, 0.0) * whole / scales
        return found, float(np.linalg.norm(columns @ found - self.aims)) / whole


def _fewest(efforts: SpringEfforts, most: Number, within: float) -> tuple[Sequence[int], Number, float]:
    """Return the smallest set of springs that leaves little enough, else that which leaves least."""
    moving = [k for k in range(len(most)) if np.any(efforts.columns[:, k])]
    found, rest = efforts.fit(moving, most)
    if rest <= within:
        for size in range(len(moving)):
            tried = [(chosen, *efforts.fit(chosen, most)) for chosen in combinations(moving, size)]
            best = min(tried, key=lambda one: one[2])
            if best[2] <= within:
                return best
    kept = np.flatnonzero(found)
    return [moving[k] for k in kept], found[kept], rest


def _with_stiffnesses(motion: Motion, names: tuple[str, ...], own: Mapping[str, float]) -> Motion:
    """Return the motion of the mechanism whose springs have these stiffnesses, those not named none."""
    loads = motion.mechanism.loads
    items = [replace(loads[name], stiffness=own.get(name, 0.0)) for name in names]  # type: ignore[call-arg]
    return _of(motion, motion.mechanism.replace(*items))


def _only_spring(motion: Motion, name: str) -> Motion:
    """Return the motion of the mechanism with nothing but one spring of unit stiffness."""
    mechanism = motion.mechanism
    removed = (Mass, Gravity, Load, Friction, Pretension, Expectation)
    items: list[Item] = [item for item in mechanism.items if not isinstance(item, removed)]
    items.append(replace(mechanism.loads[name], stiffness=1.0))  # type: ignore[call-arg]
    return _of(motion, Mechanism(mechanism.title, *items, **mechanism.unit_words))


def _of(motion: Motion, mechanism: Mechanism) -> Motion:
    return replace(motion, structure=replace(motion.structure, mechanism=mechanism))


def _figures(motion: Motion, inertia: bool, even: bool) -> Iterator[BalanceFigure]:
    """Yield the greatest absolute value and the root mean square of each driver's effort, or of its unevenness."""
    forces = force_analysis(motion, inertia=inertia)
    designs, places, weights = nodes(smooth_pieces(motion))
    at = between(motion, designs, places, 2 if inertia else 1)
    for name in motion.drives:
        course = DriverCourse(forces, name)
        efforts = np.ravel(course.effort(at))
        mean = float(np.sum(weights * efforts) / np.sum(weights)) if even else 0.0
        (ends,) = extremes(motion, course.above(np.array([mean])))
        greatest = max(abs(float(ends.least.value[0])), abs(float(ends.greatest.value[0])))
        rms = float(np.sqrt(np.sum(weights * (efforts - mean) ** 2) / np.sum(weights)))
        yield BalanceFigure(f"{name} effort less its mean" if even else f"{name} effort", course.unit, greatest, rms)
