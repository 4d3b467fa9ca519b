"""The result of a simulation: the motion in time, its forces, its energy, and events."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import DisplaysHtml, DisplaysText, count_phrase
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.force_analysis import force_analysis
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.simulation.phases import SimulationPhase
from compoundkin.dynamics.simulation.simulated_course import SimulatedCourse
from compoundkin.dynamics.simulation.simulated_energy import SimulatedEnergy
from compoundkin.dynamics.simulation.simulation_events import SimulationEvent
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import Table, has_quantity, quantity, tables_in_a_row


@dataclass(frozen=True, eq=False)
class Simulation(DisplaysHtml, DisplaysText):
    """The motion of a mechanism under its loads. `motion` is a motion in time, solved again at `times`.

    Where pairs come apart there are several `phases`, each with its own mechanism and motion, and no single motion.

    `events` are in the order of time. `steps` and `evaluations` count those of the integration.
    """

    phases: tuple[SimulationPhase, ...]
    energy: SimulatedEnergy
    events: tuple[SimulationEvent, ...]
    tolerance: float
    steps: int
    evaluations: int
    course: SimulatedCourse = field(repr=False)

    @property
    def times(self) -> Number:
        """The times of the poses, seconds; a phase has its first and its last one."""
        return np.concatenate([phase.motion.time for phase in self.phases])

    @property
    def motion(self) -> Motion:
        """The motion of the only phase. Raises InvalidInput where there are several."""
        if len(self.phases) > 1:
            what = f"pairs come apart, and there are {len(self.phases)} phases, each with a motion of its own"
            raise InvalidInput(Problem("motion", what, "take .phases[0].motion and so on"))
        return self.phases[0].motion

    def table(self, *names: str) -> Table:
        """Return the quantities of these names as columns, of several phases with the number of each.

        A quantity that a phase does not have is NaN there; without names it is everything. Raises UnknownName for one
        that no phase has.
        """
        if len(self.phases) == 1:
            return self.motion.table(*names)
        wanted = [[name for name in names if has_quantity(phase.motion, name)] for phase in self.phases]
        for name in names:
            if not any(name in own for own in wanted):
                quantity(self.phases[0].motion, name)  # says what is wrong with it
        # where a phase has none of them, its drivers stand for it
        tables = [phase.motion.table(*(own or (list(phase.motion.drives)[:1] if names else ())))
                  for phase, own in zip(self.phases, wanted, strict=True)]  # fmt: skip
        return tables_in_a_row(self.phases[0].mechanism.title, tables)

    @cached_property
    def losses(self) -> Mapping[str, float]:
        """The energies lost at stops, at ends of guides and by friction in pairs, by their names."""
        return self.course.losses

    @cached_property
    def forces(self) -> Forces:
        """The forces in all pairs. The efforts of free drivers are zero but for the tolerance."""
        return force_analysis(self.motion)

    def __getstate__(self) -> dict[str, Any]:
        """Return what is kept of it: all but its course, of which the losses are known."""
        return {**self.__dict__, "losses": self.losses, "course": None}

    def __repr__(self) -> str:
        title, last = self.phases[0].mechanism.title, float(np.ravel(self.times)[-1])
        events = f", {count_phrase(len(self.events), 'event')}" if self.events else ""
        return f"Simulation({title!r} over {last:.6g} s in {count_phrase(self.steps, 'step')}{events})"
