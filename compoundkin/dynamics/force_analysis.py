"""Kinetostatics: the forces in all pairs of a motion, and the efforts of its drivers."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.friction.rubbed_motion import with_friction
from compoundkin.dynamics.loaded_block import LoadedBlock, loaded_blocks
from compoundkin.dynamics.named_forces.link_wrench import LinkWrench
from compoundkin.dynamics.reactions.free_links import refuse_off_pin
from compoundkin.dynamics.reactions.held_pair import held_wrenches, holding_effort
from compoundkin.dynamics.reactions.joined_wrenches import ON_FRAME, joined_reactions
from compoundkin.dynamics.reactions.reverse_pass import Reactions, found_reactions
from compoundkin.dynamics.reactions.singular_poses import at_singular_poses
from compoundkin.kinematics.motion import Motion


@checked
def force_analysis(motion: Motion, *, inertia: bool = True, holding: str = "") -> Forces:
    """Return the forces in all pairs at every pose, and the drivers' efforts.

    With ``inertia=False`` masses have weight only: statics. A pair, a pin or a driver named by `holding` holds in the
    place of the driver that moves: its effort is `forces.held.effort`, the driver's own is zero.

    Raises InvalidInput for a mechanism without units, for a motion without accelerations where masses move, or without
    velocities where loads ask for them, for a mass centre off the pin of a roller that turns freely, and for what
    cannot hold; UnknownName for what there is not.
    """
    _hold(motion, inertia)
    refuse_off_pin(motion)
    found = _wrenches(motion, inertia, holding)
    singular = at_singular_poses(motion, found, lambda other: _wrenches(other, inertia, holding))
    on_frame, told = found.pop(ON_FRAME), replace(motion, loading={"inertia": inertia, "holding": holding})
    held = holding_effort(told, inertia, holding) if holding else None
    more = () if held is None else tuple(held_wrenches(told, held))
    forces = Forces(told, inertia, found, on_frame, singular=singular, more=more, held=held)
    if motion.mechanism.frictions:
        forces = with_friction(forces)
    # quantities of forces are read from their motion, which need not find them again
    vars(told)["forces"] = forces
    return forces


def _wrenches(motion: Motion, inertia: bool, holding: str) -> dict[str, Wrench]:
    """Return the wrenches in all pairs by their names, and that on the frame."""
    more = tuple(held_wrenches(motion, holding_effort(motion, inertia, holding))) if holding else ()
    with np.errstate(all="ignore"):
        return joined_reactions(motion, ((at, _found(at, inertia, more)) for at in loaded_blocks(motion)))


def _found(at: LoadedBlock, inertia: bool, more: Iterable[LinkWrench]) -> Reactions:
    """Return the reactions of a block under all that is known to act, and more on links."""
    known = at.known(inertia)
    for one in more:
        known[one.on] = known.get(one.on, Wrench()) + one.whole.part(at.designs, at.poses)
    return found_reactions(at, known)


def _hold(motion: Motion, inertia: bool) -> None:
    """Raise InvalidInput for a mechanism and a motion of which no forces can be told."""
    mechanism = motion.mechanism
    _ = mechanism.stated_units
    if inertia and mechanism.masses and motion.order < 2:
        what = f"the motion was solved to order {motion.order}, and inertia takes accelerations"
        raise InvalidInput(Problem("motion", what, "solve(..., order=2), or inertia=False for statics"))
    asking = [name for name, load in mechanism.loads.items() if load.needs_rates]
    asking += [f"friction of {name}" for name in mechanism.frictions]
    if asking and not motion.order:
        what = f"the motion was solved to order 0, and its velocities are asked for by {', '.join(asking)}"
        raise InvalidInput(Problem("motion", what, "solve(..., order=1), or 2"))
