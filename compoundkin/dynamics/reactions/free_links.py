"""Links that turn freely, such as rollers: nothing holds them against a moment, so that none may act on them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.loaded_block import loaded_blocks
from compoundkin.kinematics.motion import Motion
from compoundkin.structure.parts import Passive

# Moments about the pin below this part of the force at the mechanism's size are rounding.
SLIGHT = 1e-9


def refuse_turned(motion: Motion) -> None:
    """Raise InvalidInput for masses and loads that would turn a link that turns freely. Its angle is not known."""
    if motion.structure.passive:
        problems = dict.fromkeys(_problems(motion))
        if problems:
            raise InvalidInput(problems)


def _problems(motion: Motion) -> Iterator[Problem]:
    """Find mass centres off the pin, and moments about it."""
    mechanism = motion.mechanism
    for spin in motion.structure.passive:
        mass, middle = mechanism.masses.get(spin.link), mechanism.geometry.points[spin.link][spin.at]
        if mass is not None and np.any(np.abs(mechanism.mass_centre(mass) - middle) > SLIGHT * motion.size):
            what = f"{spin.link} turns freely about {spin.at}: where a mass centre off it goes is not known"
            yield Problem(f"masses.{spin.link}.at", what, f'put it at the pin: at="{spin.at}"')
        yield from _turning_loads(motion, spin)


def _turning_loads(motion: Motion, spin: Passive) -> Iterator[Problem]:
    """Find loads with a moment about the pin."""
    for at in loaded_blocks(motion):
        middle = at.place(spin.link, spin.at).c[0]
        for name, load in motion.mechanism.loads.items():
            for wrench in (wrench for link, wrench in load.wrenches(at) if link == spin.link):
                if np.any(np.abs(wrench.about(middle)) > SLIGHT * np.abs(wrench.force) * motion.size):
                    what = f"{spin.link} turns freely about {spin.at}: nothing holds it against a moment"
                    yield Problem(f"loads.{name}", what, f"let it act at {spin.at}, or on {spin.on}")
