"""Mass matrix and bias of an equation of motion, from the links' velocities at unit rates of the drivers.

With velocities v_i of the mass centres and angular velocities w_i at unit rate of driver i, and the accelerations that
the links have at the drivers' true speeds without any acceleration of theirs, the principle of virtual work gives
M_ij = sum m v_i . v_j + J w_i w_j and h_i = sum m v_i . a + J w_i alpha in M(q) q'' + h(q, q') = Q: no constraints, no
differences.

Source: T. R. Kane and D. A. Levinson, Dynamics: Theory and Applications, McGraw-Hill 1985, chapters 2 and 4.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number, cross
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import Pose
from compoundkin.model.geometry import FRAME
from compoundkin.structure.kinematic_structure import Structure

# What is said of arrays.
OF_DESIGNS = "its numbers are arrays, and one design is simulated at a time"


class MovingMass(NamedTuple):
    """The mass of a link that moves, and its centre in the link's frame.

    It is in the units in which forces come out.
    """

    link: str
    centre: complex
    mass: float
    inertia: float


def moving_masses(structure: Structure) -> tuple[MovingMass, ...]:
    """Return the masses of the links. Raises InvalidInput for those that are arrays over designs.

    A link that may turn freely, such as a roller, is not turned: its inertia does nothing.
    """
    mechanism, free = structure.mechanism, {spin.link for spin in structure.passive}
    if np.size(mechanism.gravity) > 1:
        raise InvalidInput(Problem("gravity", OF_DESIGNS, "give single numbers"))
    factor, found = mechanism.stated_units.inertia, []
    for own in mechanism.masses.values():
        at = mechanism.mass_centre(own)
        if any(np.size(value) > 1 for value in (own.mass, own.inertia, at)):
            raise InvalidInput(Problem(f"masses.{own.link}", OF_DESIGNS, "give single numbers"))
        mass, inertia = (float(np.ravel(value)[0]) * factor for value in (own.mass, own.inertia))
        if own.link != FRAME:
            turned = 0.0 if own.link in free else inertia
            found.append(MovingMass(own.link, complex(np.ravel(at)[0]), mass, turned))
    return tuple(found)


class InertiaTerms(NamedTuple):
    """The mass matrix by the drivers, the bias, and the weights.

    The bias is what inertia takes without accelerations of the drivers.
    """

    matrix: Number
    bias: Number
    weight: Number


def inertia_terms(
    masses: Sequence[MovingMass], world: Mapping[str, Pose], count: int, gravity: complex
) -> InertiaTerms:
    """Return the terms of an equation of motion at one pose of `count` drivers.

    Each pose has the rates at unit rate of every driver in a column, and last those of the true motion without
    accelerations of the drivers.
    """
    rates = np.zeros((2 * len(masses), count + 1), dtype=complex)
    second = np.zeros(2 * len(masses), dtype=complex)
    weights = np.empty(2 * len(masses))
    for k, own in enumerate(masses):
        pose = world[own.link]
        centre, u = pose.at(own.centre).c, pose.u.c
        weights[2 * k], weights[2 * k + 1] = own.mass, own.inertia
        if len(centre) > 2:
            rates[2 * k] = _flat(centre[1])
            second[2 * k] = 2.0 * _last(centre[2])
        if len(u) > 2:
            rates[2 * k + 1] = _flat(cross(u[0], u[1]))
            second[2 * k + 1] = 2.0 * _last(cross(u[0], u[2]))
    back = rates[:, :count].conj().T * weights
    falling = np.tile([gravity, 0j], len(masses))
    return InertiaTerms((back @ rates[:, :count]).real, (back @ second).real, (back @ falling).real)


def _flat(value: Number) -> Number:
    return value.reshape(-1) if isinstance(value, np.ndarray) else value


def _last(value: Number) -> Number:
    return value.reshape(-1)[-1] if isinstance(value, np.ndarray) else value
