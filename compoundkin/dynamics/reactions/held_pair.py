"""A pair that holds in the place of the driver that moves: its effort by virtual work, and what it does to links."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.dynamics.loaded_block import loaded_blocks
from compoundkin.dynamics.named_forces.link_wrench import DRIVER, LinkWrench
from compoundkin.dynamics.reactions.joined_wrenches import JoinedWrenches
from compoundkin.dynamics.work.virtual_work import virtual_efforts
from compoundkin.kinematics.extremes.dead_points import moving_driver
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.unit_rates import moved_alone
from compoundkin.model.definition import pair_by_name

# A pair that moves by less than this part of its fastest, as the driver moves at unit rate, rests but for rounding.
RESTS = 1e-10


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
        """Effort times rate: what the driver would give."""
        with np.errstate(all="ignore"):
            return self.effort * self.motion.grid.shaped(self.rate) * self.motion.drives[self.instead_of].rate

    @property
    def cannot_hold(self) -> Number:
        """At which poses it cannot hold, since it rests while the driver moves."""
        return self.motion.grid.shaped(resting(self.rate))


def resting(rate: Number) -> Number:
    """Tell where a rate is zero but for rounding."""
    size = np.abs(rate)
    return np.asarray(size <= RESTS * np.max(size, initial=0.0, where=np.isfinite(size)))


def holding_effort(motion: Motion, inertia: bool, name: str) -> HoldingEffort:
    """Return the effort by which a pair, a pin or a driver holds.

    Raises UnknownName for a name that there is not, InvalidInput for a pair along which nothing acts, with friction,
    and where not just one driver moves.
    """
    _hold(motion, name)
    driver = moving_driver(motion) if len(motion.inputs.drives) > 1 else next(iter(motion.inputs.drives))
    meant = pair_by_name(motion.mechanism, name)
    assert meant is not None
    rate = np.zeros(motion.failed.shape)
    with np.errstate(all="ignore"):
        for at in loaded_blocks(moved_alone(motion, driver)):
            rate[at.designs, at.poses] = at.coordinate(name).c[1]
        still = resting(rate)
        effort = virtual_efforts(motion, inertia)[driver] / np.where(still, np.nan, rate)
    return HoldingEffort(motion, name, driver, meant[0].free_is_angle, np.where(still, np.inf, effort), rate)


def held_wrenches(motion: Motion, held: HoldingEffort) -> Iterator[LinkWrench]:
    """Yield what the effort does to both links of its pair."""
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


def _hold(motion: Motion, name: str) -> None:
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
