"""Figures and quantities that are to stay within bounds: transmission angles, boxes of points, forces, speeds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, degrees
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import GREATEST, LEAST, TRANSMISSION_ANGLE, is_angle_word, motion_figure
from compoundkin.studies.goals.contract import DesignConstraint
from compoundkin.studies.goals.design_trial import DesignTrial


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
