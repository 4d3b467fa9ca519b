"""Constraints of designs: bounds of figures and quantities, distances of points, assembly over the whole motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import TURN, Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.derived import FIGURES
from compoundkin.kinematics.derived.transmission_angle import solver_of_link
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import (
    ANGLE,
    GREATEST,
    LEAST,
    POSITION,
    TRANSMISSION_ANGLE,
    TRANSMISSION_INDEX,
    motion_figure,
)
from compoundkin.studies.goals.design_trial import DesignTrial
from compoundkin.studies.goals.driver_schedule import driver_of
from compoundkin.studies.goals.goal import DesignConstraint, value_text


@dataclass(frozen=True)
class FigureBound:
    """A lower bound of a figure; with the sign -1 an upper bound."""

    name: str
    value: float
    sign: int = 1

    @property
    def description(self) -> str:
        """The figure and its bound."""
        return f"{self.name} at {'least' if self.sign > 0 else 'most'} {value_text(self.name, self.value)}"

    @property
    def figure(self) -> str:
        """The figure, for a quantity its least or greatest value over the motion, between the poses too."""
        is_figure = motion_figure(self.name)[1]
        return self.name if is_figure else f"{self.name}.{LEAST if self.sign > 0 else GREATEST}"


@dataclass(frozen=True)
class BoundConstraint(DesignConstraint):
    """Figures that stay within bounds."""

    bounds: tuple[FigureBound, ...]

    @property
    def description(self) -> str:
        """The figure and its bound."""
        return ", ".join(one.description for one in self.bounds)

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the figures; raises InvalidInput for vectors."""
        for one in self.bounds:
            if quantity(motion, motion_figure(one.name)[0]).is_vector:
                raise InvalidInput(Problem(one.name, "a vector has no least value", f'"{one.name}.length"'))
        return tuple(dict.fromkeys(one.figure for one in self.bounds))

    def margins(self, trial: DesignTrial) -> Number:
        """Return the distance of each figure from its bound."""
        there = trial.closely
        return np.stack([one.sign * (there.values(one.figure) - one.value) for one in self.bounds], axis=1)

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of the margins."""
        there = trial.closely
        return np.stack([one.sign * there.slopes(one.figure) for one in self.bounds], axis=1)


def _bound(where: str, name: str, value: float, sign: int) -> FigureBound:
    if not np.isfinite(value):
        raise InvalidInput(
            Problem(f"{where}.{name}", f"{value} is not a valid bound", "give a finite number, radians for angles")
        )
    return FigureBound(name, float(value), sign)


@checked
def at_least(name: str, value: float) -> DesignConstraint:
    """Return the constraint that a figure is at least a value.

    For a quantity at every pose and between. Angles are in radians. Raises InvalidInput for a number that is not
    finite.

    >>> at_least("ram.displacement.stroke", 60.0).description
    'ram.displacement.stroke at least 60'
    """
    return BoundConstraint((_bound("at_least", name, value, 1),))


@checked
def at_most(name: str, value: float) -> DesignConstraint:
    """Return the constraint that a figure is at most a value.

    For a quantity at every pose and between. Angles are in radians. Raises InvalidInput for a number that is not
    finite.

    >>> at_most("crank.effort", 120.0).description
    'crank.effort at most 120'
    """
    return BoundConstraint((_bound("at_most", name, value, -1),))


@checked
def transmits(link: str, least: float) -> DesignConstraint:
    """Return the constraint of a least transmission angle in the dyad that moves a link.

    Radians, folded to 0 to pi / 2, where a right angle is best. Raises InvalidInput for an angle outside this range.
    Source: H. Alt, 1932.

    >>> transmits("rocker", 0.7).description
    'rocker.transmission_angle at least 40.107°'
    """
    if not 0.0 < least < np.pi / 2:
        what, remedy = f"{least:g} is not between 0 and pi / 2", "give radians, as compoundkin.deg(40)"
        raise InvalidInput(Problem(f"transmits.{link}", what, remedy))
    return at_least(f"{link}.{TRANSMISSION_ANGLE}", least)


@checked
def box(point: str, *, x: tuple[float, float] | None = None, y: tuple[float, float] | None = None) -> DesignConstraint:
    """Return the constraint that a point stays in a box.

    Between two coordinates in x, in y or in both; also for a pivot of the frame. Raises InvalidInput for reversed ends,
    and for none.

    >>> box("G", x=(0, 10)).description
    'G.x at least 0, G.x at most 10'
    """
    sides = {part: ends for part, ends in (("x", x), ("y", y)) if ends is not None}
    if not sides or any(not low < high for low, high in sides.values()):
        raise InvalidInput(
            Problem(
                f"box.{point}", "the ends of the box are missing or reversed", "x=(0, 10), y=(-5, 5), the lesser first"
            )
        )
    ends = [(f"{point}.{part}", *pair) for part, pair in sides.items()]
    bounds = ((_bound("box", name, low, 1), _bound("box", name, high, -1)) for name, low, high in ends)
    return BoundConstraint(tuple(one for both in bounds for one in both))


@dataclass(frozen=True)
class DistanceConstraint(DesignConstraint):
    """Bounds of the distance of two points at all poses; of points of one link, a length."""

    points: tuple[str, str]
    low: float | None
    high: float | None

    @property
    def description(self) -> str:
        """The points and the bounds."""
        bounds = (("least", self.low), ("most", self.high))
        said = " and ".join(f"at {word} {value:g}" for word, value in bounds if value is not None)
        return f"{self.points[0]} from {self.points[1]} {said}"

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the positions of both points."""
        return tuple(f"{one}.{POSITION}" for one in self.points)

    def _between(self, trial: DesignTrial) -> Number:
        one, other = (trial.closely.values(f"{name}.{POSITION}") for name in self.points)
        return np.broadcast_arrays(other - one, np.empty((trial.number, 1)))[0]

    def margins(self, trial: DesignTrial) -> Number:
        """Return the margins of the least and the greatest distance."""
        lengths = np.abs(self._between(trial))
        low = [] if self.low is None else [lengths.min(axis=1) - self.low]
        high = [] if self.high is None else [self.high - lengths.max(axis=1)]
        return np.stack(low + high, axis=1)

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of the margins at their poses."""
        between = self._between(trial)
        lengths = np.abs(between)
        one, other = (trial.closely.slopes(f"{name}.{POSITION}") for name in self.points)
        with np.errstate(invalid="ignore", divide="ignore"):
            unit = between.conj() / lengths
        slopes = np.broadcast_to(((other - one) * unit[..., None]).real, (*lengths.shape, len(trial.coordinates)))
        low = [] if self.low is None else [slopes[np.arange(len(slopes)), lengths.argmin(axis=1)]]
        high = [] if self.high is None else [-slopes[np.arange(len(slopes)), lengths.argmax(axis=1)]]
        return np.stack(low + high, axis=1)


@checked
def distance(one: str, other: str, *, at_least: float | None = None, at_most: float | None = None) -> DesignConstraint:
    """Return the constraint that the distance of two points is within bounds at all poses.

    For points of one link it is a length, of a bar or between two pivots. Raises InvalidInput for invalid bounds, and
    for none.

    >>> distance("A", "B", at_least=5.0, at_most=60.0).description
    'A from B at least 5 and at most 60'
    """
    if one == other:
        raise InvalidInput(Problem(f"distance.{one}", "a point has no distance from itself", 'name two: ("A", "B")'))
    low, high = -np.inf if at_least is None else at_least, np.inf if at_most is None else at_most
    given = [value for value in (at_least, at_most) if value is not None]
    if not given or not np.isfinite(given).all() or not low < high or high <= 0.0:
        where, remedy = f"distance.{one}.{other}", "at_least=5.0, at_most=60.0, the lesser first"
        raise InvalidInput(Problem(where, "these bounds leave no distance", remedy))
    return DistanceConstraint((one, other), at_least, at_most)


# Samples of a full turn, every five degrees; figures are searched between them too.
TURNED = np.linspace(0.0, TURN, 73)
# The sine of some degrees from the limit: nearer ones jam, and slopes are infinite at the limit.
MARGIN = 0.05


@dataclass(frozen=True)
class AssemblyConstraint(DesignConstraint):
    """The transmission index of every group is above a margin, along the motion or over a full turn."""

    margin: float = MARGIN
    turned: bool = False
    driver: str | None = None

    @property
    def description(self) -> str:
        """The range over which it is assembled."""
        return "a full turn of the driver" if self.turned else "assembled over the whole motion"

    @property
    def has_own_poses(self) -> bool:
        """Whether it is for a full turn."""
        return self.turned

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the transmission index of each group, or for groups without one the angle of a link.

        Raises InvalidInput where the driver cannot turn.
        """
        if self.turned:
            name = driver_of("full_turn", motion, self.driver)
            if not motion.drives[name].is_angle:
                raise InvalidInput(Problem("full_turn", f"{name} is a length, and has no turn", "assembles()"))
        groups = {solver_of_link(motion, link): link for link in reversed(list(motion.links))}
        tells = FIGURES["links"][TRANSMISSION_INDEX].lack
        return tuple(
            f"{link}.{ANGLE}" if tells(motion, link) else f"{link}.{TRANSMISSION_INDEX}.{LEAST}"
            for solver, link in groups.items()
            if solver is not None
        )

    def _there(self, trial: DesignTrial) -> DesignTrial:
        if not self.turned:
            return trial.closely
        return trial.at(driver_of("full_turn", trial.designs.path.reference, self.driver), TURNED)

    def margins(self, trial: DesignTrial) -> Number:
        """Return the margin of each group, NaN beyond its limit."""
        there = self._there(trial)
        found = [there.values(name) for name in trial.responses]
        # a group without an index has a margin of 1 where it closes
        return np.stack([one - self.margin if one.ndim == 1 else 1.0 + 0.0 * one.sum(axis=1) for one in found], axis=1)

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of the margins."""
        there = self._there(trial)
        found = [there.slopes(name) for name in trial.responses]
        return np.stack([one if one.ndim == 2 else 0.0 * one.sum(axis=1) for one in found], axis=1)


def _margin(where: str, margin: float) -> float:
    if not 0.0 <= margin < 1.0:
        raise InvalidInput(Problem(where, f"the margin {margin} is not a transmission index", "0 to 1, as 0.05"))
    return float(margin)


@checked
def assembles(margin: float = MARGIN) -> DesignConstraint:
    """Return the constraint that designs are assembled over the whole motion.

    Between its poses too, so that they stay on one circuit, in one configuration. `margin` is the least transmission
    index, a sine: 0 is the limit itself. Raises InvalidInput for a margin outside 0 to 1.

    >>> assembles().description
    'assembled over the whole motion'
    """
    return AssemblyConstraint(_margin("assembles", margin))


@checked
def full_turn(driver: str | None = None, margin: float = MARGIN) -> DesignConstraint:
    """Return the constraint that a driver can make a full turn.

    Independent of the range of the motion; all other drivers stay where the motion begins. For a four-bar it is
    Grashof's condition, with the driver on the shortest link or the frame the shortest. Raises InvalidInput for a
    margin outside 0 to 1.

    >>> full_turn("crank").description
    'a full turn of the driver'
    """
    return AssemblyConstraint(_margin("full_turn", margin), True, driver)
