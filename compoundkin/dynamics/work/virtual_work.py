"""Efforts of drivers by virtual work: without a single reaction, at unit rates, so that dwells are like other poses.

The work of all that acts on the links, when one driver alone moves at unit rate, is that of its effort. Reactions do
none, so that this holds against the reverse pass; friction does some, and is not in it.

Source: the principle of virtual work, e.g. R. L. Norton, Design of Machinery, section 11.10.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.loaded_block import LoadedBlock, loaded_blocks
from compoundkin.dynamics.named_forces.link_wrench import LinkWrench
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.unit_rates import moved_alone


def virtual_efforts(motion: Motion, inertia: bool, more: Iterable[LinkWrench] = ()) -> dict[str, Number]:
    """Return the effort of every driver by virtual work, (designs, poses).

    `more` acts on links too, such as friction. NaN where the motion at unit rate is not determined.
    """
    found = {name: np.zeros(motion.failed.shape) for name in motion.inputs.drives}
    alone = {name: moved_alone(motion, name) for name in motion.inputs.drives}
    with np.errstate(all="ignore"):
        for parts in zip(loaded_blocks(motion), *map(loaded_blocks, alone.values()), strict=True):
            at, *units = parts
            known = free_wrenches(at, inertia)
            for name, unit in zip(alone, units, strict=True):
                found[name][at.designs, at.poses] = -work(known, unit)
                for one in more:
                    found[name][at.designs, at.poses] -= one.whole.part(at.designs, at.poses).power(unit.pose(one.on))
    return found


def work(wrenches: Mapping[str, Wrench], moving: LoadedBlock) -> Number:
    """Return the power of wrenches on links as the links move."""
    total: Number = np.zeros(moving.block.shape)
    for link, wrench in wrenches.items():
        total = total + wrench.power(moving.pose(link))
    return total


def free_wrenches(at: LoadedBlock, inertia: bool) -> dict[str, Wrench]:
    """Return what is known to act on every link."""
    return {link: at.freed(link, wrench) for link, wrench in at.known(inertia).items()}
