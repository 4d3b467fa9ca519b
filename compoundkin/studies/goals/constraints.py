"""Constraints of designs: bounds of figures and quantities, distances of points, assembly over the whole motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import TURN, Number, degrees
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
    is_angle_word,
    motion_figure,
)
from compoundkin.studies.goals.design_trial import DesignTrial
from compoundkin.studies.goals.driver_schedule import driver_of
from compoundkin.studies.goals.goal import DesignConstraint


@dataclass(frozen=True)
class FigureBound:
    """A figure that is at least a value, with the sign -1 at most."""

    name: str
    value: float
    sign: int = 1

    @property
    def told(self) -> str:
        """What is bounded, and how."""
        is_angle = is_angle_word(motion_figure(self.name)[0].rpartition(".")[2])
        value = f"{degrees(self.value):g} deg" if is_angle else f"{self.value:g}"
        return f"{self.name} at {'least' if self.sign > 0 else 'most'} {value}"

    @property
    def figure(self) -> str:
        """The figure, of a quantity its least or greatest value.

        That is over the motion, between the poses too.
        """
        is_figure = motion_figure(self.name)[1]
        return self.name if is_figure else f"{self.name}.{LEAST if self.sign > 0 else GREATEST}"


@dataclass(frozen=True)
class BoundConstraint(DesignConstraint):
    """Figures that stay within bounds."""

    bounds: tuple[FigureBound, ...]

    @property
    def told(self) -> str:
        """What is bounded, and how."""
        return ", ".join(one.told for one in self.bounds)

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the figures; raises InvalidInput for vectors."""
        for one in self.bounds:
            if quantity(motion, motion_figure(one.name)[0]).is_vector:
                raise InvalidInput(Problem(one.name, "it is a vector, and has no least value", f'"{one.name}.length"'))
        return tuple(dict.fromkeys(one.figure for one in self.bounds))

    def margins(self, trial: DesignTrial) -> Number:
        """Return how far each is from its bound."""
        there = trial.closely
        return np.stack([one.sign * (there.values(one.figure) - one.value) for one in self.bounds], axis=1)

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of those."""
        there = trial.closely
        return np.stack([one.sign * there.slopes(one.figure) for one in self.bounds], axis=1)


def _bound(where: str, name: str, value: float, sign: int) -> FigureBound:
    if not np.isfinite(value):
        raise InvalidInput(
            Problem(f"{where}.{name}", f"{value} is no bound", "give a finite number, radians for angles")
        )
    return FigureBound(name, float(value), sign)


@checked
def at_least(name: str, value: float) -> DesignConstraint:
    """Return the constraint that a figure is at least a value.

    A quantity is so at every pose and between. Radians for angles. Raises InvalidInput for what is no number.

    >>> at_least("ram.displacement.stroke", 60.0).told
    'ram.displacement.stroke at least 60'
    """
    return BoundConstraint((_bound("at_least", name, value, 1),))


@checked
def at_most(name: str, value: float) -> DesignConstraint:
    """Return the constraint that a figure is at most a value.

    A quantity is so at every pose and between. Radians for angles. Raises InvalidInput for what is no number.

    >>> at_most("crank.effort", 120.0).told
    'crank.effort at most 120'
    """
    return BoundConstraint((_bound("at_most", name, value, -1),))


@checked
def transmits(link: str, least: float) -> DesignConstraint:
    """Return the constraint that a transmission angle is at least so great.

    It is that of the dyad that moves a link, in radians, folded to 0 to pi / 2, a right angle is best. Raises
    InvalidInput for what is no such angle. Source: H. Alt, 1932.

    >>> transmits("rocker", 0.7).told
    'rocker.transmission_angle at least 40.107 deg'
    """
    if not 0.0 < least < np.pi / 2:
        what, remedy = f"{least:g} is no angle between 0 and pi / 2", "give radians, as compoundkin.deg(40)"
        raise InvalidInput(Problem(f"transmits.{link}", what, remedy))
    return at_least(f"{link}.{TRANSMISSION_ANGLE}", least)


@checked
def box(point: str, *, x: tuple[float, float] | None = None, y: tuple[float, float] | None = None) -> DesignConstraint:
    """Return the constraint that a point stays in a box.

    That is between two coordinates in x, in y or in both. A pivot of the frame is such a point too. Raises InvalidInput
    for ends that are reversed, and where none are given.

    >>> box("G", x=(0, 10)).told
    'G.x at least 0, G.x at most 10'
    """
    sides = {part: ends for part, ends in (("x", x), ("y", y)) if ends is not None}
    if not sides or any(not low < high for low, high in sides.values()):
        raise InvalidInput(Problem(f"box.{point}", "this is no box", "x=(0, 10), y=(-5, 5), the lesser first"))
    ends = [(f"{point}.{part}", *pair) for part, pair in sides.items()]
    bounds = ((_bound("box", name, low, 1), _bound("box", name, high, -1)) for name, low, high in ends)
    return BoundConstraint(tuple(one for both in bounds for one in both))


@dataclass(frozen=True)
class DistanceConstraint(DesignConstraint):
    """The distance of two points at all poses.

    Of one link it is a length.
    """

    points: tuple[str, str]
    low: float | None
    high: float | None

    @property
    def told(self) -> str:
        """The points and the bounds."""
        bounds = (("least", self.low), ("most", self.high))
        said = " and ".join(f"at {word} {value:g}" for word, value in bounds if value is not None)
        return f"{self.points[0]} from {self.points[1]} {said}"

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the places of both."""
        return tuple(f"{one}.{POSITION}" for one in self.points)

    def _between(self, trial: DesignTrial) -> Number:
        one, other = (trial.closely.values(f"{name}.{POSITION}") for name in self.points)
        return np.broadcast_arrays(other - one, np.empty((trial.number, 1)))[0]

    def margins(self, trial: DesignTrial) -> Number:
        """Return how far the least and the greatest distance are from their bounds."""
        lengths = np.abs(self._between(trial))
        low = [] if self.low is None else [lengths.min(axis=1) - self.low]
        high = [] if self.high is None else [self.high - lengths.max(axis=1)]
        return np.stack(low + high, axis=1)

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of those, at the poses that have them."""
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
    """Return the constraint that two points keep a distance at all poses.

    Points of one link keep a length, that of a bar or between two pivots. Raises InvalidInput for bounds that are
    none, and where none are given.

    >>> distance("A", "B", at_least=5.0, at_most=60.0).told
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


# Where a whole turn is looked at: every five degrees, and between these places as far as figures do.
TURNED = np.linspace(0.0, TURN, 73)
# A sine of some degrees from the limit: what is nearer jams, and slopes grow beyond all bounds at the limit itself.
MARGIN = 0.05


@dataclass(frozen=True)
class AssemblyConstraint(DesignConstraint):
    """The least transmission index of every group is above a margin.

    It is looked at along the motion, or over a whole turn of a driver.
    """

    margin: float = MARGIN
    turned: bool = False
    driver: str | None = None

    @property
    def told(self) -> str:
        """Where it is assembled."""
        return "a full turn of the driver" if self.turned else "assembled over the whole motion"

    @property
    def has_own_poses(self) -> bool:
        """Whether a whole turn is looked at."""
        return self.turned

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the index of each group.

        Where there is none, the angle of a link says whether it closes. Raises InvalidInput where the driver that is to
        turn does not.
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
        """Return how far each group is from its limit; NaN where it is beyond."""
        there = self._there(trial)
        found = [there.values(name) for name in trial.responses]
        # what only tells whether it closes is far from any limit where it does
        return np.stack([one - self.margin if one.ndim == 1 else 1.0 + 0.0 * one.sum(axis=1) for one in found], axis=1)

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of those."""
        there = self._there(trial)
        found = [there.slopes(name) for name in trial.responses]
        return np.stack([one if one.ndim == 2 else 0.0 * one.sum(axis=1) for one in found], axis=1)


def _margin(where: str, margin: float) -> float:
    if not 0.0 <= margin < 1.0:
        raise InvalidInput(Problem(where, f"the margin {margin} is no transmission index", "0 to 1, as 0.05"))
    return float(margin)


@checked
def assembles(margin: float = MARGIN) -> DesignConstraint:
    """Return the constraint that designs are assembled over the whole motion.

    That is between its poses too. So they stay on one circuit, in one configuration. `margin` is the least transmission
    index that is left, a sine: 0 is the limit itself. Raises InvalidInput for what is none.

    >>> assembles().told
    'assembled over the whole motion'
    """
    return AssemblyConstraint(_margin("assembles", margin))


@checked
def full_turn(driver: str | None = None, margin: float = MARGIN) -> DesignConstraint:
    """Return the constraint that a driver can make a full turn.

    It is asked whatever of the turn the motion needs. All other drivers stay where the motion begins. Of a four-bar it
    is Grashof's condition, with the driver on the shortest link or the frame the shortest. Raises InvalidInput for a
    margin that is none.

    >>> full_turn("crank").told
    'a full turn of the driver'
    """
    return AssemblyConstraint(_margin("full_turn", margin), True, driver)
