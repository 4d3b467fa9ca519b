"""Links that turn freely, such as rollers: nobody knows their angle, so that their mass centres are at their pins."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.motion import Motion

# A mass centre is at the pin to this part of the mechanism's size.
AT_PIN = 1e-9


def refuse_off_pin(motion: Motion) -> None:
    """Raise InvalidInput for mass centres off the pins of links that turn freely."""
    problems = tuple(_problems(motion))
    if problems:
        raise InvalidInput(problems)


def _problems(motion: Motion) -> Iterator[Problem]:
    mechanism = motion.mechanism
    for spin in motion.structure.passive:
        mass, middle = mechanism.masses.get(spin.link), mechanism.geometry.points[spin.link][spin.at]
        if mass is not None and np.any(np.abs(mechanism.mass_centre(mass) - middle) > AT_PIN * motion.size):
            what = f"{spin.link} turns freely about {spin.at}: where a mass centre off it goes is not known"
            yield Problem(f"masses.{spin.link}.at", what, f'put it at the pin: at="{spin.at}"')
