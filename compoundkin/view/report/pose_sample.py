"""Sample: one design of a motion, its drivers, and the poses of it that tables show."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.arguments import check_design
from compoundkin.kinematics import Motion
from compoundkin.kinematics.quantities import Quantity, owner_of, quantity, read_of
from compoundkin.kinematics.solution import uncertain
from compoundkin.model.attributes import OF_FORCES, TIME, VALUE, unit_of
from compoundkin.view.report.report_data import Column
from compoundkin.view.report.wording import listed, number_text

# A table over the cycle has at most this many rows besides the last pose.
ROWS = 25


# Numbers below this part of the mechanism's natural scale are rounding, and shown as zero.
ROUNDING = 1e-12


# At most so many poses are listed.
MOST_LISTED = 10


@dataclass(frozen=True, eq=False)
class Sample:
    """One design of a motion.

    Raises InvalidInput for a design that the motion does not have.
    """

    motion: Motion
    design: int = 0

    def __post_init__(self) -> None:
        check_design(self.design, self.motion.inputs.designs)

    @property
    def poses(self) -> int:
        """How many poses it has."""
        return self.motion.inputs.poses

    def of(self, values: Any) -> Any:
        """Return this design's part of an array: one entry a pose. The array has the motion's shape."""
        full = np.broadcast_to(values, self.motion.shape)
        return full.reshape(self.motion.inputs.designs, self.poses)[self.design]

    def quantity(self, name: str) -> Quantity:
        """Return a quantity of this design, angles in degrees."""
        found = quantity(self.motion, name).shown
        return replace(found, values=self.of(found.values))

    @cached_property
    def assembled(self) -> Any:
        """Which poses are assembled."""
        return self.of(self.motion.assembled)

    @cached_property
    def drivers(self) -> tuple[Quantity, ...]:
        """The values of the drivers, angles in degrees."""
        found = [(name, read_of(owner_of(self.motion, "drives", name), VALUE).shown) for name in self.motion.drives]
        return tuple(replace(one, name=name, values=self.of(one.values)) for name, one in found)

    @cached_property
    def varying(self) -> tuple[Quantity, ...]:
        """The drivers that change along the motion. They are all of them where there is but one pose."""
        return tuple(d for d in self.drivers if self.poses == 1 or np.ptp(d.values) > 0)

    @cached_property
    def times(self) -> Any:
        """The times of its poses; None for a motion that is not in time."""
        return None if self.motion.time is None else self.of(self.motion.time)

    @cached_property
    def places(self) -> tuple[Column, Any]:
        """What distinguishes poses. The time, the value of the only driver that changes, else their numbers, from 0."""
        if self.times is not None:
            return Column(TIME, unit_of("", "time"), "fixed"), self.times
        if len(self.varying) == 1:
            return self.driver_column(self.varying[0]), self.varying[0].values
        return Column("pose", style="each"), np.arange(self.poses)

    @cached_property
    def few_digits(self) -> str:
        """Where rates have fewer than three digits, in words; "" where all have more."""
        few = np.flatnonzero(uncertain(self.motion)[self.design])
        column, values = self.places
        places = [f"{column.name} {number_text(float(values[k]))}" for k in few[:MOST_LISTED]]
        more = [f"{len(few) - MOST_LISTED} more"] if len(few) > MOST_LISTED else []
        return listed([*places, *more]) if places else ""

    @cached_property
    def every(self) -> int:
        """A table shows every k-th pose: this is k."""
        return max(1, -(-(self.poses - 1) // (ROWS - 1)))

    @cached_property
    def rows(self) -> tuple[int, ...]:
        """The poses a table shows, the last one among them."""
        shown = list(range(0, self.poses, self.every))
        return tuple(shown if shown[-1] == self.poses - 1 else [*shown, self.poses - 1])

    def driver_column(self, driver: Quantity) -> Column:
        """Return the column of a driver in a table."""
        return Column(driver.name, driver.unit, "fixed", ROUNDING * float(np.max(np.abs(driver.values), initial=0.0)))

    def floor(self, found: Quantity) -> float:
        """Return the bound below which a quantity is rounding.

        It goes by the mechanism's size, its drivers' rates, and its own vectors; of forces by the largest of all.
        """
        if found.dimension in OF_FORCES:
            return ROUNDING * found.scale
        size = 1.0 if found.dimension in ("angle", "number") else self.motion.mechanism.geometry.size
        values = np.abs(found.values)
        largest = float(np.max(values, initial=0.0, where=np.isfinite(values))) if found.is_vector else 0.0
        return ROUNDING * max(largest, size * self._rate**found.order)

    @cached_property
    def _rate(self) -> float:
        """The greatest rate of a driver, slides by the mechanism's size."""
        size = self.motion.mechanism.geometry.size
        rates = [(drive, self.motion.inputs.drives[name][1]) for name, drive in self.motion.drives.items()]
        return max((float(np.max(np.abs(r))) / (1.0 if d.is_angle else size) for d, r in rates), default=0.0)
