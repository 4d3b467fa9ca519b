"""The name of the configuration that a program stays in, in the words that `solve` and configurations use."""

from __future__ import annotations

from compoundkin.kinematics.configuration import SIGNS, named
from compoundkin.kinematics.motion import Motion
from compoundkin.programs.solved_designs import ProgramConfiguration


def program_modes(reference: Motion, configuration: ProgramConfiguration) -> str:
    """Return the signs of all groups that have some, named as configurations are."""
    two = {solver.index for solver in reference.solving_order.solvers if solver.modes == 2}
    signs = {k: SIGNS[sign] for k, sign in configuration.signs.items() if k in two}
    return named(reference.structure, signs)
