"""The modes of a design written into its mechanism, so that it moves as it did in the search."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from compoundkin.base.errors import CompoundkinError
from compoundkin.kinematics.chosen_modes import read_name
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import solve
from compoundkin.model.elements import mode
from compoundkin.model.mechanism import Mechanism


def with_modes(mechanism: Mechanism, motion: Motion, moved: Mapping[str, Any]) -> Mechanism:
    """Return the mechanism, with its modes where it would not move so by itself.

    `moved` is what `solve` is told of the motion. Configurations that are numbered cannot be written: such a mechanism
    is returned as it is.
    """
    modes, alone = moved["modes"], {**moved, "modes": None}
    if not isinstance(modes, str) or _moves_so(mechanism, motion, alone):
        return mechanism
    written = mechanism.replace(*_modes(mechanism, motion, modes))
    return written if _moves_so(written, motion, alone) else mechanism


def _modes(mechanism: Mechanism, motion: Motion, modes: str) -> list[Any]:
    # as they are asked for: at a change point the motion itself has neither sign
    found = []
    for index, sign in read_name(motion.solving_order, modes).items():
        links = motion.structure.groups[index].links
        own = next((one for one in mechanism.modes if set(one.links) & set(links)), None)
        found.append(mode(sign, *(own.links if own else links[:1])))
    return found


def _moves_so(mechanism: Mechanism, motion: Motion, moved: Mapping[str, Any]) -> bool:
    """Tell whether a mechanism takes the motion by itself."""
    try:
        own = solve(mechanism, **moved)
    except CompoundkinError:
        return False
    there, wanted = (np.array([point.position for point in found.points.values()]) for found in (own, motion))
    size = np.nanmax(np.abs(wanted), initial=1.0)
    return bool(np.allclose(there, wanted, rtol=0.0, atol=NEAR * size, equal_nan=True))


# Numbered configurations are found by Newton's steps to some ten digits.
NEAR = 1e-8
