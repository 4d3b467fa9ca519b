"""What masses in motion do to the frame and to the drivers: the figures by which balancing is judged."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from compoundkin.base.arrays import Number, cross
from compoundkin.base.display import ShortRepr
from compoundkin.dynamics.drives.course_quadrature import nodes, smooth_pieces
from compoundkin.dynamics.work.mass_motion import mass_motions
from compoundkin.kinematics.extremes import Measure, between, extremes
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.unit_rates import moved_alone


@dataclass(frozen=True)
class BalanceFigure:
    """The greatest absolute value of a quantity, and its root mean square."""

    name: str
    unit: str
    greatest: float
    rms: float


@dataclass(frozen=True, eq=False, repr=False)
class InertiaAlone(ShortRepr):
    """What masses alone do, without weights and loads. The shaking moment is about a place of the world."""

    about: complex
    factor: float

    def force(self, motion: Motion) -> Number:
        """Return the shaking force."""
        return -self.factor * sum((mass.force for mass in mass_motions(motion)), 0j)

    def length(self, motion: Motion) -> Number:
        """Return the length of the shaking force."""
        return _shaped(motion, np.abs(self.force(motion)))

    def moment(self, motion: Motion) -> Number:
        """Return the shaking moment, drivers' reactions included."""
        total = -self.factor * sum(mass.moment for mass in mass_motions(motion))
        return _shaped(motion, total - cross(self.about, self.force(motion)))

    def effort(self, driver: str, motion: Motion) -> Number:
        """Return the effort of a driver, by virtual work."""
        rows = zip(mass_motions(motion), mass_motions(moved_alone(motion, driver)), strict=True)
        return _shaped(motion, self.factor * sum(mass.product(2, unit, 1) for mass, unit in rows))


def _shaped(motion: Motion, value: Number) -> Number:
    found: Number = np.broadcast_to(value, motion.failed.shape).reshape(motion.shape)
    return found


def balance_figures(motion: Motion, about: complex) -> tuple[BalanceFigure, ...]:
    """Return the figures of a motion of one design. Shaking force, shaking moment, and the effort of each driver."""
    measures = tuple(_measures(motion, about))
    designs, places, weights = nodes(smooth_pieces(motion))
    at = between(motion, designs, places, 2)
    found = []
    for one, ends in zip(measures, extremes(motion, *measures), strict=True):
        greatest = max(abs(float(ends.least.value[0])), abs(float(ends.greatest.value[0])))
        mean = float(np.sum(weights * one.of(at) ** 2) / np.sum(weights))
        found.append(BalanceFigure(one.name, one.unit, greatest, float(np.sqrt(mean))))
    return tuple(found)


def _measures(motion: Motion, about: complex) -> Iterator[Measure]:
    units = motion.mechanism.stated_units
    alone = InertiaAlone(about, units.inertia)
    scale = float(np.nanmax(sum(np.abs(mass.force) for mass in mass_motions(motion)))) * units.inertia
    yield Measure("shaking force", units.force, 2, alone.length, squared=True, scale=scale)
    yield Measure("shaking moment", units.moment, 2, alone.moment, scale=scale * motion.size)
    for name, drive in motion.drives.items():
        size, unit = (motion.size, units.moment) if drive.is_angle else (1.0, units.force)
        yield Measure(f"effort {name}", unit, 2, partial(alone.effort, name), scale=scale * size)
