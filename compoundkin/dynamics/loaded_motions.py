"""Whether a mechanism has loads at all, and the forces of motions that have."""

from __future__ import annotations

from compoundkin.dynamics.force_analysis import force_analysis
from compoundkin.dynamics.forces import Forces
from compoundkin.kinematics.motion import Motion
from compoundkin.model.mechanism import Mechanism


def has_loads(mechanism: Mechanism) -> bool:
    """Tell whether there are forces to be told: units, and masses or loads."""
    return mechanism.units is not None and bool(mechanism.masses or mechanism.loads)


def loaded_forces(motion: Motion) -> Forces | None:
    """Return the forces of a motion; None without masses and loads.

    Without accelerations there is no inertia to tell: they are those of statics.
    """
    if not has_loads(motion.mechanism) or not motion.assembled.any():
        return None
    return force_analysis(motion, inertia=motion.order >= 2)
