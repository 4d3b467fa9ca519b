"""What is wrong with a candidate, found along its motion: order, branch, circuit, full turn, transmission, region.

A candidate's mechanism is followed through all its circuits, and the precision positions are placed on them as
configurations. They must lie on one circuit (else it would have to be taken apart), on one branch of the driver (else
the driver would have to stop and turn back), and in order along it. What passes is solved over that branch and
compared with the positions. The words are those of T. R. Chase and J. A. Mirth, Circuits and branches of
single-degree-of-freedom planar linkages, J. Mech. Des. 115 (1993) 223-230.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import combinations
from typing import NamedTuple

import numpy as np

from compoundkin.analysis.checks import verify
from compoundkin.base.arrays import TURN, Number, unwrapped
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import CompoundkinError
from compoundkin.base.poses import Pose
from compoundkin.configurations.circuit import CircuitPlace
from compoundkin.configurations.circuit_search import Circuits, circuits
from compoundkin.dimensional.candidates import Linkage
from compoundkin.dimensional.tasks import Conditions, extent, inside, meets
from compoundkin.kinematics import Motion, solve
from compoundkin.kinematics.configuration import Configuration, dimensions_at
from compoundkin.kinematics.quantities import owner_of, quantity
from compoundkin.model.attributes import LEAST, TRANSMISSION_INDEX
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism

ORDER, BRANCH, CIRCUIT, TURNING, TRANSMISSION, OBSTACLE, REGION, LENGTH, ASSEMBLY, ACCURACY = (
    "order", "branch", "circuit", "no full turn", "transmission", "obstacle", "region", "length", "assembly",
    "accuracy",
)  # fmt: skip
# The least of defects first: of several drivers the one whose defect is least tells.
SEVERITY = (ACCURACY, TRANSMISSION, OBSTACLE, TURNING, BRANCH, ORDER, CIRCUIT, LENGTH, REGION, ASSEMBLY)
# A solved position may miss its place by so much, in parts of the linkage: next to limit positions rounding grows to
# its root.
MISSED = 1e-6
# A given ground point is met within this part of the linkage.
GROUNDED = 1e-6
# Poses of a motion over a branch.
POSES = 181
# A range in which nothing was found is looked at again with so many times itself on either side.
CLOSER = 8.0
# Driver values nearer to each other than this part of a turn or a stroke are one.
STANDING = 1e-9


@dataclass(frozen=True, eq=False, repr=False)
class Rejection(ShortRepr):
    """A candidate that has a defect: `reason` is its word, `text` says what exactly."""

    reason: str
    text: str
    candidate: Linkage
    driver: str = ""

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism all the same, drawn at the first position."""
        return self.candidate.mechanism(self.driver or next(iter(self.candidate.drivers)))


@dataclass(frozen=True, eq=False, repr=False)
class SolvedLinkage(ShortRepr):
    """A mechanism without a defect: solved over the branch that has all positions, verified.

    `values` are the driver's at the precision positions, `error` by how much the motion misses the task (lengths and
    radians, the greatest), `transmission` the least transmission angle of the motion (radians), NaN where there is
    none, `turns` whether the driver turns fully.
    """

    mechanism: Mechanism
    motion: Motion
    driver: str
    values: Number
    turns: bool
    error: float
    transmission: float
    candidate: Linkage = field(repr=False)

    @property
    def size(self) -> float:
        """The sum of all lengths."""
        return self.candidate.span


def judged(candidate: Linkage, conditions: Conditions, tolerance: float = 0.0) -> SolvedLinkage | Rejection:
    """Return the solution with the best driver of a candidate, one that turns fully first, or what is wrong with it."""
    wrong = _unfulfilled(candidate, conditions)
    if wrong is not None:
        return wrong
    bad, good = list[Rejection](), list[_PositionsInOrder]()
    for driver in candidate.drivers:
        found = _course(candidate, driver, conditions)
        if isinstance(found, Rejection):
            bad.append(found)
            if found.reason == CIRCUIT:  # so it is with every driver
                return found
        else:
            good.append(found)
    for course in sorted(good, key=lambda one: not one.turns):
        solved = _solved(candidate, course, conditions, tolerance)
        if isinstance(solved, SolvedLinkage):
            return solved
        bad.append(solved)
    return min(bad, key=lambda one: SEVERITY.index(one.reason))


def confirmed(one: SolvedLinkage, conditions: Conditions) -> SolvedLinkage | Rejection:
    """Return a solution whose motion passes all checks, with its least transmission angle between the poses too."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            check = verify(one.motion)
            least = least_transmission(one.motion)
    except CompoundkinError as problem:
        return Rejection(ACCURACY, str(problem), one.candidate, one.driver)
    if not check.passed:
        return Rejection(ACCURACY, f"its motion fails {', '.join(check.failed)}", one.candidate, one.driver)
    if least < conditions.transmission:
        return _poor(least, one.candidate, one.driver)
    return replace(one, transmission=least)


def _poor(least: float, candidate: Linkage, driver: str) -> Rejection:
    text = f"the transmission angle falls to {np.rad2deg(least):.4g} degrees"
    return Rejection(TRANSMISSION, text, candidate, driver)


class _PositionsInOrder(NamedTuple):
    """The driver's values at the positions as they follow one another on one branch, and whether it turns fully."""

    driver: str
    values: Number
    turns: bool


def _unfulfilled(candidate: Linkage, conditions: Conditions) -> Rejection | None:
    """Return what conditions on places and lengths a candidate misses."""
    for pivot in candidate.pivots:
        if not conditions.holds(pivot):
            return Rejection(REGION, f"a fixed pivot is at ({pivot.real:.6g}, {pivot.imag:.6g})", candidate)
    span = max(extent(np.array(candidate.pivots)), max(candidate.lengths, default=0.0))
    for place in conditions.ground:
        apart = min((abs(pivot - place) for pivot in candidate.pivots), default=np.inf)
        if apart > GROUNDED * span:
            text = f"no fixed pivot is at ({place.real:.6g}, {place.imag:.6g}), the nearest is {apart:.3g} away"
            return Rejection(REGION, text, candidate)
    if conditions.lengths is not None:
        low, high = conditions.lengths
        wrong = [one for one in candidate.lengths if not low <= one <= high]
        if wrong:
            return Rejection(LENGTH, f"a length is {wrong[0]:.6g}, not {low:g} to {high:g}", candidate)
    return None


def _course(candidate: Linkage, driver: str, conditions: Conditions) -> _PositionsInOrder | Rejection:
    """Return how a driver passes the positions, or what prevents it."""
    given = candidate.drivers[driver]
    if _out_of_order(given, candidate.u[driver]):
        return Rejection(ORDER, f"{driver} passes the positions in another order", candidate, driver)
    try:
        found, placed = _placed(candidate, driver)
    except CompoundkinError as error:
        return Rejection(ASSEMBLY, str(error), candidate, driver)
    on = [place.circuit for place in placed]
    if len(set(on)) > 1:
        other = next(k for k, number in enumerate(on) if number != on[0])
        text = f"position {other} is on circuit {on[other]}, position 0 on circuit {on[0]}"
        return Rejection(CIRCUIT, text, candidate, driver)
    branches = [place.branch for place in placed]
    if len(set(branches)) > 1:
        other = next(k for k, number in enumerate(branches) if number != branches[0])
        limits = [one.value for one in found.circuits[on[0] - 1].limits]
        text = f"{driver} would turn back at {_limits(limits, found)} between positions 0 and {other}"
        return Rejection(BRANCH, text, candidate, driver)
    circuit, branch = found.circuits[on[0] - 1], found.branches[branches[0] - 1]
    turns = circuit.turns_fully and not circuit.limits
    values = _along(np.array([place.value for place in placed]), branch.low, found.period, turns)
    if values is None:
        return Rejection(ORDER, f"{driver} passes the positions in another order", candidate, driver)
    if conditions.turning and not turns:
        text = f"{driver} goes from {_value(circuit.low, found)} to {_value(circuit.high, found)}"
        return Rejection(TURNING, text, candidate, driver)
    return _PositionsInOrder(driver, values, turns)


def _out_of_order(values: Number, u: Number) -> bool:
    """Return whether a driver passes positions in another order whatever its circuits are like, which is quickly seen.

    A slide cannot go on in one sense, a link on a pin not even with whole turns.
    """
    if _turned(u):
        return _along(np.angle(u), 0.0, TURN, True) is None
    steps = np.diff(values)
    return bool(np.any(steps > 0.0) and np.any(steps < 0.0))


def _turned(u: Number) -> bool:
    """Return whether a link turns at all, as one on a slide does not."""
    return bool(np.any(u != u[0]))


def _placed(candidate: Linkage, driver: str) -> tuple[Circuits, list[CircuitPlace]]:
    """Return the circuits of a driver and the places of the positions on them.

    A range so small that it lies between the places where circuits are sought is looked at by itself.
    """
    mechanism = candidate.mechanism(driver)
    try:
        found = circuits(mechanism)
        return found, [found.at(one) for one in positions(candidate, found)]
    except CompoundkinError:
        values = candidate.drivers[driver]
        values = unwrapped(values) if _turned(candidate.u[driver]) else values
        low, high = float(np.min(values)), float(np.max(values))
        room = CLOSER * (high - low) + STANDING
        found = circuits(mechanism, between=(low - room, high + room))
        return found, [found.at(one) for one in positions(candidate, found)]


def positions(candidate: Linkage, found: Circuits) -> Iterator[Configuration]:
    """Yield the configurations of a candidate at its precision positions."""
    dimensions = dimensions_at(found.structure, 0, 0)
    for k, value in enumerate(candidate.drivers[found.driver]):
        poses = {name: Pose.of(complex(z[k]), complex(candidate.u[name][k])) for name, z in candidate.z.items()}
        yield Configuration(found.structure, {found.driver: float(value)}, poses, {}, {}, dimensions)


def _along(values: Number, low: float, period: float, turns: bool) -> Number | None:
    """Return the driver's values as they follow one another, None where they are not in order."""
    if len(values) < 2:
        return values
    if not turns:
        # limits are known to the root of rounding: a position at the low end stays there
        values = low + np.mod(values - low + STANDING**0.5, period) - STANDING**0.5 if period else values
        steps = np.diff(values)
        return values if np.all(steps > 0.0) or np.all(steps < 0.0) else None
    for sense in (1.0, -1.0):
        steps = np.mod(sense * np.diff(values), period)
        if np.sum(steps) < period:
            return values[0] + sense * np.append(0.0, np.cumsum(steps))
    return None


def _limits(limits: list[float], found: Circuits) -> str:
    return " and ".join(_value(value, found) for value in limits) or "a limit position"


def _value(value: float, found: Circuits) -> str:
    return f"{np.rad2deg(value):.4g} degrees" if found.period else f"{value:.4g}"


def _solved(
    candidate: Linkage, course: _PositionsInOrder, conditions: Conditions, tolerance: float
) -> SolvedLinkage | Rejection:
    """Return the solution over a branch with all positions, or why it is none."""
    driver, values, turns = course
    sense = 1.0 if len(values) < 2 or values[1] >= values[0] else -1.0
    way = values[0] + sense * np.linspace(0.0, TURN, POSES) if turns else np.linspace(values[0], values[-1], POSES)
    mechanism = candidate.mechanism(driver, way if len(values) > 1 else values)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            motion = solve(mechanism)
            missed = missed_by(candidate, solve(mechanism, {driver: values}, order=0))
    except CompoundkinError as problem:
        return Rejection(ASSEMBLY, str(problem), candidate, driver)
    size = extent(np.array(list(candidate.places.values())))
    if not motion.assembled.all() or not (missed[0] <= MISSED * size and missed[1] <= MISSED):
        text = f"the solved motion misses a position by {missed[0]:.3g} and {missed[1]:.3g} radians"
        return Rejection(ACCURACY, text, candidate, driver)
    if not np.isfinite(candidate.error):
        return Rejection(ACCURACY, "it does not assemble over the whole range", candidate, driver)
    if candidate.error > tolerance:
        allowed = f"more than {tolerance:.3g}" if tolerance else "and no tolerance is given"
        return Rejection(ACCURACY, f"it misses the task by {candidate.error:.3g}, {allowed}", candidate, driver)
    least = least_transmission(motion, between=False)
    if least < conditions.transmission:
        return _poor(least, candidate, driver)
    met = _met(motion, conditions)
    if met:
        return Rejection(OBSTACLE, met, candidate, driver)
    return SolvedLinkage(mechanism, motion, driver, values, turns, candidate.error + max(missed), least, candidate)


def _met(motion: Motion, conditions: Conditions) -> str:
    """Return which link meets an obstacle where over a motion, else nothing: pins and lines between points of links."""
    at = {letter: np.ravel(point.position) + np.zeros(motion.inputs.poses) for letter, point in motion.points.items()}
    for k, obstacle in enumerate(conditions.obstacles):
        for letter, carriers in motion.mechanism.carriers.items():
            if FRAME in carriers and inside(at[letter][:1], obstacle)[0]:
                return f"the fixed pivot {letter} is in obstacle {k}"
        for name, each in motion.mechanism.geometry.points.items():
            for a, b in combinations(each, 2) if name != FRAME else ():
                found = np.flatnonzero(meets(at[a], at[b], obstacle))
                if len(found):
                    place = at[a][found[0]]
                    return f"{name} meets obstacle {k}, with {a} at ({place.real:.6g}, {place.imag:.6g})"
    return ""


def missed_by(candidate: Linkage, motion: Motion) -> tuple[float, float]:
    """Return by how much a motion over the precision positions misses them: the greatest length, the greatest angle."""
    apart = [(np.abs(motion.poses[name].z.c[0] - z), np.abs(motion.poses[name].u.c[0] - candidate.u[name]))
             for name, z in candidate.z.items()]  # fmt: skip
    lengths, angles = (np.array([np.max(part) for part in parts]) for parts in zip(*apart, strict=True))
    return float(np.max(np.nan_to_num(lengths, nan=np.inf))), float(np.max(np.nan_to_num(angles, nan=np.inf)))


def least_transmission(motion: Motion, *, between: bool = True) -> float:
    """Return the least transmission angle of all dyads over a motion (radians), NaN where there is none.

    Of a single pose, or not `between`, the poses alone count.
    """
    found = []
    for group in motion.structure.groups:
        owner = owner_of(motion, "links", group.links[0])
        if owner.has(TRANSMISSION_INDEX):
            name = f"{group.links[0]}.{TRANSMISSION_INDEX}"
            values = quantity(motion, f"{name}.{LEAST}" if between and motion.inputs.poses > 1 else name).values
            found.append(float(np.arcsin(np.clip(np.nanmin(values), 0.0, 1.0))))
    return min(found, default=np.nan)
