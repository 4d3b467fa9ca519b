"""Efforts by virtual work, without reactions: of drivers, and of a pair that holds in the place of the driver.

When one driver alone moves at unit rate, the work of all that acts on the links is that of its effort. Unit rates make
dwells like other poses. Reactions do no work, so that this checks the reverse pass; friction does some, and is not in
it.

Source: the principle of virtual work, e.g. R. L. Norton, Design of Machinery, section 11.10.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.loaded_block import LoadedBlock, loaded_blocks
from compoundkin.dynamics.reactions.link_wrench import DRIVER, LinkWrench
from compoundkin.dynamics.reactions.reverse_pass import JoinedWrenches
from compoundkin.kinematics.extremes.dead_points import moving_driver
from compoundkin.kinematics.jacobian import moved_alone
from compoundkin.kinematics.motion import Motion
from compoundkin.model.definition import pair_by_name


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
    """Return the known wrench on every link."""
    return {link: at.freed(link, wrench) for link, wrench in at.known(inertia).items()}


# A pair that moves by less than this part of its fastest, as the driver moves at unit rate, rests but for rounding.
RESTING_RATE = 1e-10


@dataclass(frozen=True, eq=False, repr=False)
class HoldingEffort(ShortRepr):
    """The effort of a pair that holds in the place of a driver.

    That is `instead_of`, whose own effort is zero. It is infinite where the pair rests while the driver moves: nothing
    holds there.
    """

    motion: Motion = field(repr=False)
    name: str
    instead_of: str
    is_angle: bool
    whole: Number  # (designs, poses)
    rate: Number  # of its coordinate, as the driver moves at unit rate, (designs, poses)

    @property
    def effort(self) -> Number:
        """The torque or thrust along its coordinate, positive where it drives that up."""
        return self.motion.grid.known(self.whole)

    @property
    def power(self) -> Number:
        """Effort times rate: the power that the driver would give."""
        with np.errstate(all="ignore"):
            return self.effort * self.motion.grid.shaped(self.rate) * self.motion.drives[self.instead_of].rate

    @property
    def cannot_hold(self) -> Number:
        """At which poses it cannot hold, since it rests while the driver moves."""
        return self.motion.grid.shaped(is_resting(self.rate))


def is_resting(rate: Number) -> Number:
    """Tell where a rate is zero but for rounding."""
    size = np.abs(rate)
    return np.asarray(size <= RESTING_RATE * np.max(size, initial=0.0, where=np.isfinite(size)))


def holding_effort(motion: Motion, inertia: bool, name: str) -> HoldingEffort:
    """Return the effort by which a pair, a pin or a driver holds.

    Raises UnknownName for an unknown name, InvalidInput for a pair without a coordinate, with friction,
    and where not just one driver moves.
    """
    _check_holding_pair(motion, name)
    driver = moving_driver(motion) if len(motion.inputs.drives) > 1 else next(iter(motion.inputs.drives))
    meant = pair_by_name(motion.mechanism, name)
    assert meant is not None
    rate = np.zeros(motion.failed.shape)
    with np.errstate(all="ignore"):
        for at in loaded_blocks(moved_alone(motion, driver)):
            rate[at.designs, at.poses] = at.coordinate(name).c[1]
        still = is_resting(rate)
        effort = virtual_efforts(motion, inertia)[driver] / np.where(still, np.nan, rate)
    return HoldingEffort(motion, name, driver, meant[0].free_is_angle, np.where(still, np.inf, effort), rate)


def holding_wrenches(motion: Motion, held: HoldingEffort) -> Iterator[LinkWrench]:
    """Yield the wrenches of the effort on both links of its pair."""
    store: JoinedWrenches[tuple[str, str]] = JoinedWrenches(motion.failed.shape)
    with np.errstate(all="ignore"):
        for at in loaded_blocks(motion):
            (one, unit), (other, _) = at.unit_effort(held.name)
            part = unit.times(held.whole[at.designs, at.poses])
            for key, wrench in (((one, other), part), ((other, one), -part)):
                store.take(key, wrench, at.designs, at.poses)
    meant = pair_by_name(motion.mechanism, held.name)
    letter = "" if meant is None else meant[0].letters[0]
    place = np.asarray(motion.points[letter].position).reshape(motion.failed.shape)
    for (link, by), wrench in store.wrenches().items():
        yield LinkWrench(motion, DRIVER, held.name, link, by, letter, wrench, place)


def _check_holding_pair(motion: Motion, name: str) -> None:
    """Raise UnknownName or InvalidInput for a pair that cannot hold."""
    mechanism, meant = motion.mechanism, pair_by_name(motion.mechanism, name)
    if meant is None:
        known = [*motion.drives, *motion.pairs]
        raise UnknownName(Problem(name, "there is no pair, pin or driver of this name", suggestion(name, known)))
    if "effort" not in meant[0].takes:
        what = f"nothing acts along a {meant[0].title}"
        raise InvalidInput(Problem(name, what, "hold by a pin, a slide or a driver"))
    if mechanism.frictions:
        what = "which pair holds is told without friction only"
        raise InvalidInput(Problem("holding", what, "leave friction out"))
