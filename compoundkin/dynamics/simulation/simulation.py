"""The result of a simulation: the motion in time, its forces, its energy, and events."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import DisplaysHtml, DisplaysText, count_phrase
from compoundkin.dynamics.force_analysis import force_analysis
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.simulation.simulated_energy import SimulatedEnergy
from compoundkin.dynamics.simulation.simulation_events import SimulationEvent
from compoundkin.kinematics.motion import Motion


@dataclass(frozen=True, eq=False)
class Simulation(DisplaysHtml, DisplaysText):
    """The motion of a mechanism under its loads. `motion` is a motion in time, solved again at `times`.

    `events` are in the order of time. `steps` and `evaluations` count those of the integration. `losses` are the
    energies lost at stops and ends of guides, by their names.
    """

    motion: Motion
    energy: SimulatedEnergy
    events: tuple[SimulationEvent, ...]
    tolerance: float
    steps: int
    evaluations: int
    losses: Mapping[str, float] = field(default_factory=dict)

    @property
    def times(self) -> Number:
        """The times of the poses, seconds."""
        return self.motion.time

    @cached_property
    def forces(self) -> Forces:
        """The forces in all pairs. The efforts of free drivers are zero but for the tolerance."""
        return force_analysis(self.motion)

    def __repr__(self) -> str:
        title, last = self.motion.mechanism.title, float(np.ravel(self.times)[-1])
        events = f", {count_phrase(len(self.events), 'event')}" if self.events else ""
        return f"Simulation({title!r} over {last:.6g} s in {count_phrase(self.steps, 'step')}{events})"
