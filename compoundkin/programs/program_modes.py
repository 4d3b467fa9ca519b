"""The configuration that a program stays in, in the form that `solve` takes."""

from __future__ import annotations

from compoundkin.kinematics.configuration import SIGNS, Configuration, named
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import first_configuration
from compoundkin.programs.limits.solved_designs import ProgramConfiguration


def program_modes(reference: Motion, configuration: ProgramConfiguration) -> str | Configuration:
    """Return the signs of all groups that have some, named as configurations are.

    Numbers of configurations are those at one pose: where a group has them it is the configuration itself.
    """
    near = first_configuration(reference, 0) if reference.solving_order.numbered else None
    if near is not None:
        return near
    two = {solver.index for solver in reference.solving_order.solvers if solver.modes == 2}
    return named(reference.structure, {k: SIGNS[sign] for k, sign in configuration.signs.items() if k in two})
