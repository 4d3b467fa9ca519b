"""A curve of configurations: what still moves while all drivers stand still, for dimensions that are special."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from compoundkin.base.arrays import first_entry
from compoundkin.kinematics.configuration import Configuration, ConfigurationCurve, dimensions_at
from compoundkin.kinematics.inputs import Inputs
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.redundancy.constraint_equations import ConstraintEquations
from compoundkin.structure.redundancy.diagnosis import WIDEST
from compoundkin.structure.redundancy.finite_motion import resting_motion

# A link moves if its part of the motion is above this.
MOVES = 1e-6


def curve_at(structure: Structure, given: Inputs) -> ConfigurationCurve | None:
    """Find a curve of configurations at the first driver values. None where the search meets none."""
    equations = ConstraintEquations(structure.mechanism)
    if equations.width > WIDEST:
        return None
    values = {name: float(first_entry(numbers[0])) for name, numbers in given.drives.items()}
    found = resting_motion(equations, np.array(list(values.values())), len(structure.passive))
    if found is None:
        return None
    share = np.linalg.norm(found.along, axis=1)
    links = tuple(name for name, k in equations.column.items() if np.max(share[k : k + 3]) > MOVES)
    return ConfigurationCurve(links, _at(structure, values, equations, found.state))


def _at(
    structure: Structure, values: Mapping[str, float], equations: ConstraintEquations, state: np.ndarray
) -> Configuration:
    return Configuration(structure, values, equations.poses(state), {}, {}, dimensions_at(structure, 0, 0))
