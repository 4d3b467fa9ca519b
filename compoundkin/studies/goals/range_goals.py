"""Goals over a part of a driver's range: dwells, even outputs and straight lines."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.extremes import closed_cycles
from compoundkin.kinematics.motion import Motion
from compoundkin.model.attributes import POSITION, motion_figure
from compoundkin.studies.goals.design_trial import DesignTrial, real_parts
from compoundkin.studies.goals.driver_schedule import driver_of
from compoundkin.studies.goals.goal import Goal


@dataclass(frozen=True)
class DwellGoal(Goal):
    """The differences of an output from its mean at all poses of a stretch."""

    output: str
    stretch: DriverStretch

    @property
    def description(self) -> str:
        """The output and the stretch."""
        return f"{self.output} even{self.stretch.description}"

    @property
    def has_own_poses(self) -> bool:
        """Whether it is for a part of the motion."""
        return self.stretch.ends is not None

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the output; raises InvalidInput for the figure of a whole course."""
        self.stretch.check(motion)
        of, figure = motion_figure(self.output)
        if figure:
            raise InvalidInput(Problem(self.output, "it is a figure, and always even", f'take "{of}"'))
        return (self.output,)

    def residuals(self, trial: DesignTrial) -> Number:
        """Return the differences from the mean."""
        found = self.stretch.of(trial).values(self.output)
        return real_parts(found - found.mean(axis=1, keepdims=True))

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of the residuals."""
        found = self.stretch.of(trial).slopes(self.output)
        return real_parts(found - found.mean(axis=1, keepdims=True))


@checked
def dwell(output: str, between: object, *, driver: str | None = None) -> Goal:
    """Return the goal that an output stands still between two values of the driver.

    The squared differences from its mean are summed over 25 poses; points are possible too. Raises InvalidInput for an
    invalid stretch.

    >>> dwell("rocker.angle", (1.0, 2.0)).description
    'rocker.angle even between 1 and 2'
    """
    return DwellGoal(output, driver_stretch(f"dwell.{output}", () if between is None else between, driver))


@checked
def even(output: str) -> Goal:
    """Return the goal that an output is as even as possible.

    For example "crank.effort" over the whole motion. The squared differences from its mean are summed over the poses.

    >>> even("crank.effort").description
    'crank.effort even'
    """
    return DwellGoal(output, driver_stretch(f"even.{output}", None, None))


# Poses are equally spaced over a cycle within this part of their mean distance: rounding of what was written.
SPACING = 1e-6


@dataclass(frozen=True)
class HarmonicsGoal(Goal):
    """The amplitudes of some harmonics of an output over a closed cycle of equally spaced poses."""

    output: str
    orders: tuple[int, ...]

    @property
    def description(self) -> str:
        """The output and the orders."""
        return f"{self.output} without harmonics {', '.join(map(str, self.orders))}"

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the output.

        Raises InvalidInput for a figure, for a motion that is no closed cycle of equally spaced poses, and for too few
        of these.
        """
        of, figure = motion_figure(self.output)
        if figure:
            raise InvalidInput(Problem(self.output, "it is a figure, and has no harmonics", f'take "{of}"'))
        where, remedy = f"without_harmonics.{self.output}", 'values={"crank": np.linspace(0, 2 * np.pi, 73)}'
        if motion.inputs.poses < 2 or not closed_cycles(motion).all():
            raise InvalidInput(Problem(where, "the motion is no closed cycle", remedy))
        along = next(iter(motion.drives.values())).value if motion.time is None else motion.time
        steps = np.diff(np.reshape(along, (-1, np.shape(along)[-1])), axis=1)
        if np.any(np.abs(steps - steps.mean()) > SPACING * np.abs(steps.mean())):
            raise InvalidInput(Problem(where, "its poses are not equally spaced over the cycle", remedy))
        if 2 * max(self.orders) >= motion.inputs.poses - 1:
            what = f"{motion.inputs.poses - 1} poses of a cycle do not show order {max(self.orders)}"
            raise InvalidInput(Problem(where, what, remedy))
        return (self.output,)

    def residuals(self, trial: DesignTrial) -> Number:
        """Return the coefficients of cosine and sine, of a vector those of both senses."""
        return self._coefficients(trial.values(self.output))

    def slopes(self, trial: DesignTrial) -> Number:
        """Return the slopes of the residuals."""
        return self._coefficients(trial.slopes(self.output))

    def _coefficients(self, values: Number) -> Number:
        count = values.shape[1] - 1
        orders = np.array(self.orders)
        # of a number both senses are conjugate to each other: twice one of them has its amplitude
        senses, size = (np.concatenate([orders, -orders]), 1.0) if np.iscomplexobj(values) else (orders, 2.0)
        waves = np.exp(-2j * np.pi / count * senses[:, None] * np.arange(count)) * (size / count)
        found = np.moveaxis(np.tensordot(waves, values[:, :-1], axes=(1, 1)), 0, 1)
        return np.concatenate([found.real, found.imag], axis=1)


@checked
def without_harmonics(output: str, orders: Iterable[int] | int) -> Goal:
    """Return the goal that an output has as little as can be of some harmonics.

    For example "frame.shaking_moment", orders 1 and 2. Their squared amplitudes over the motion, a closed cycle of
    equally spaced poses, are summed: of a vector those that turn with the cycle and against it. Raises InvalidInput for
    what are no orders.

    >>> without_harmonics("frame.shaking_moment", [1, 2]).description
    'frame.shaking_moment without harmonics 1, 2'
    """
    given = (orders,) if isinstance(orders, int) else tuple(orders)
    if not given or any(isinstance(one, bool) or not isinstance(one, int | np.integer) or one < 1 for one in given):
        problem = Problem(
            f"without_harmonics.{output}", f"{short_repr(orders)} are no orders", "whole numbers from 1: [1, 2]"
        )
        raise InvalidInput(problem)
    return HarmonicsGoal(output, tuple(dict.fromkeys(int(one) for one in given)))


@dataclass(frozen=True)
class StraightLineGoal(Goal):
    """The distances of a point from the line of best fit, whose direction may be fixed."""

    point: str
    stretch: DriverStretch
    angle: float | None = None

    @property
    def description(self) -> str:
        """The point and the stretch."""
        return f"{self.point} along a straight line{self.stretch.description}"

    @property
    def has_own_poses(self) -> bool:
        """Whether it is for a part of the motion."""
        return self.stretch.ends is not None

    @property
    def _output(self) -> str:
        return f"{self.point}.{POSITION}"

    def outputs(self, motion: Motion) -> tuple[str, ...]:
        """Return the position of the point."""
        self.stretch.check(motion)
        return (self._output,)

    def residuals(self, trial: DesignTrial) -> Number:
        """Return the distances, to the left of the line."""
        about = _about(self.stretch.of(trial).values(self._output))
        return (about * self._direction(about).conj()).imag

    def _direction(self, about: Number) -> Number:
        """Return the direction of the line of each design, (designs, 1): the first principal axis."""
        if self.angle is not None:
            return np.exp(1j * np.full((len(about), 1), self.angle))
        return np.exp(0.5j * np.angle((about**2).sum(axis=1, keepdims=True)))

    def slopes(self, trial: DesignTrial) -> Number:
        """Return their slopes; the line turns with the designs."""
        there = self.stretch.of(trial)
        about, by = _about(there.values(self._output)), _about(there.slopes(self._output))
        along = self._direction(about)
        found = (by * along.conj()[..., None]).imag
        if self.angle is not None:
            return np.asarray(found)
        squares = (about**2).sum(axis=1)[:, None]
        # a point at rest has no line
        turn = ((about[..., None] * by).sum(axis=1) / np.where(squares == 0.0, 1.0, squares)).imag
        return found - turn[:, None, :] * (about * along.conj()).real[..., None]


def _about(places: Number) -> Number:
    return places - places.mean(axis=1, keepdims=True)


@checked
def straight_line(point: str, between: object = None, *, angle: float | None = None, driver: str | None = None) -> Goal:
    """Return the goal that a point goes along a straight line.

    Between two values of the driver, or over all poses. The squared distances from the line of best fit are summed;
    `angle` fixes its direction (radians). Combine it with a length, `at_least("G.x.stroke", 20)`: a point at rest has
    no distance from a line. Raises InvalidInput for an invalid stretch. Source of the fit: K. Pearson, Phil. Mag. 2
    (1901) 559-572.

    >>> straight_line("G", (1.0, 2.0)).description
    'G along a straight line between 1 and 2'
    """
    if angle is not None and not np.isfinite(angle):
        raise InvalidInput(Problem(f"straight_line.{point}", "the angle is not finite", "angle=0.0, radians"))
    return StraightLineGoal(point, driver_stretch(f"straight_line.{point}", between, driver), angle)


# Poses of a stretch: enough for a course with one or two bends.
POSES = 25


@dataclass(frozen=True)
class DriverStretch:
    """A stretch of a driver's values; without `ends` the whole motion."""

    where: str
    ends: tuple[float, float] | None = None
    driver: str | None = None

    @property
    def description(self) -> str:
        """The ends as text, empty for the whole motion."""
        return "" if self.ends is None else f" between {self.ends[0]:g} and {self.ends[1]:g}"

    def check(self, motion: Motion) -> None:
        """Raise InvalidInput for an ambiguous driver."""
        if self.ends is not None:
            driver_of(self.where, motion, self.driver)

    def of(self, trial: DesignTrial) -> DesignTrial:
        """Return the designs at its poses."""
        if self.ends is None:
            return trial
        return trial.at(driver_of(self.where, trial.designs.path.reference, self.driver), self.values)

    @property
    def values(self) -> Number:
        """Values of the driver."""
        assert self.ends is not None
        return np.linspace(*self.ends, POSES)


def driver_stretch(where: str, between: object, driver: str | None) -> DriverStretch:
    """Return the stretch between two values of a driver, by default the whole motion.

    Raises InvalidInput for other objects.
    """
    if between is None:
        return DriverStretch(where, None, driver)
    try:
        low, high = (float(one) for one in between)  # type: ignore[attr-defined]
        given = np.isfinite(low) and np.isfinite(high) and low != high
    except (TypeError, ValueError):
        given = False
    if not given:
        raise InvalidInput(
            Problem(where, "these are not two different values", "between=(1.0, 2.5), values of the driver")
        )
    return DriverStretch(where, (low, high), driver)
