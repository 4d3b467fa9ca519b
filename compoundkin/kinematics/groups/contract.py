"""What every way of solving a group answers.

Each way is one file of this folder and one line of its registry.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.wrenches import Wrench
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.configuration import Configurations
from compoundkin.kinematics.groups.force_transmission import reactions_of
from compoundkin.kinematics.groups.group_equations import GroupEquations
from compoundkin.kinematics.groups.pair_sides import MountedBody, Reason, reason_text
from compoundkin.model.pairs.contract import Ends
from compoundkin.model.pairs.profile_contact import Approach
from compoundkin.structure.mobility_count import Group


class GroupSolver(ABC):
    """A group of a structure, made ready to be solved on any block. What it needs is bound once.

    `index` is its place in the solving order. `ends` are those of lower pairs that stand for others, `counted_from`
    the links from whose angles, full turns counted, its own are taken.
    """

    modes: ClassVar[int]  # how many: 1, 2, or 0 where configurations are numbered
    sign_means: ClassVar[str] = ""  # what mode +1 is
    tells_margin: ClassVar[bool] = False  # whether it says how far it is from its limit position
    ends: Mapping[str, Ends]
    counted_from: tuple[str, ...] = ()
    # bodies on slides whose angles, full turns counted, are those of the other link and the slide's
    slid: tuple[MountedBody, ...] = ()
    # the equations of a group whose configurations are numbered: states are followed by them
    equations: GroupEquations | None = None

    def __init__(self, index: int, group: Group) -> None:
        self.index = index
        self.group = group
        self.ends = {}

    @classmethod
    @abstractmethod
    def of(cls, index: int, group: Group, size: float, ends: Mapping[str, Ends]) -> GroupSolver | None:
        """Return the solver of a group, None where this way does not fit it.

        `size` is the mechanism's length scale, `ends` are the pairs' sides on their links.
        """

    @abstractmethod
    def close(self, block: Block, mode: Number) -> None:
        """Assemble the group and add its links to what is known.

        `mode` is a sign, or a state of the bodies in `equations`; it has no effect where there is only one.
        """

    @abstractmethod
    def every(self, block: Block) -> Configurations:
        """Return all configurations in these surroundings, in a fixed order."""

    @abstractmethod
    def reasons(self, block: Block) -> tuple[Reason, ...]:
        """Return why the group may not be assembled; the first that holds is told."""

    def why(self, block: Block, at: int) -> str:
        """Say why the group cannot be assembled at a pose's flat index."""
        return reason_text(self.reasons(block), at)

    @property
    def is_numbered(self) -> bool:
        """Whether its configurations are numbered, and states followed: it has equations and no signs."""
        return self.equations is not None

    @property
    def has_limits(self) -> bool:
        """Whether it may come to a limit position that its closed form shows."""
        return self.modes == 2 or self.tells_margin

    @property
    def modes_may_meet(self) -> bool:
        """Whether it may pass between its modes, where its margin is zero."""
        return self.modes == 2 and self.tells_margin

    @property
    def tells_transmission(self) -> bool:
        """Whether it tells how well it transmits forces."""
        return self.has_transmission_angle

    @property
    def has_transmission_angle(self) -> bool:
        """Whether one angle tells that. It does for a dyad, and for a body on a contact."""
        return False

    def transmission(self, block: Block) -> Number:
        """Return a complex number at the transmission angle.

        That is folded to a right angle. Of a group without such an angle it is that of the body that transmits worst.
        The group's links are known in the block; it is asked only of a group that tells it.
        """
        raise NotImplementedError

    def reactions(self, block: Block, loads: Mapping[str, Wrench]) -> dict[str, Wrench]:
        """Return the wrench on the second member of each of its pairs.

        It is that from the first member, by the pairs' names.

        The group is assembled in the block; `loads` are all other wrenches on its links, about the world's origin.
        By the transposed Jacobian, unless a kind knows a closed form.
        """
        return reactions_of(self.group, block, loads)

    def followed(self) -> GroupSolver | None:
        """Return the solver that follows configurations which have no sign here. It is None where there are none."""
        return None

    @property
    def is_angular(self) -> bool:
        """Whether the only number of its state is an angle."""
        return False

    def from_state(self, steps: int = 0) -> GroupSolver | None:
        """Return the solver that closes it from a state nearby, in straight-line arithmetic.

        Its mode is a sequence of numbers, those of `state`; a state that is only predicted takes more `steps`. It is
        None where a sign, or nothing, is enough.
        """
        return None

    @property
    def width(self) -> int:
        """How many numbers a state has, 0 where a sign is enough."""
        return 0

    def state(self, block: Block) -> Sequence[Number]:
        """Return the numbers by which an assembled group is found again, if any."""
        return ()

    def approach(self, block: Block) -> Approach | None:
        """Return how its member comes to a profile, where a state is a contact that can be searched anew.

        The links around the group are known in the block. It is None where states can only be followed.
        """
        return None

    def side(self, block: Block, state: Sequence[Number]) -> Number:
        """Return a number whose sign changes across a singularity."""
        raise NotImplementedError

    def margin(self, block: Block) -> Number | None:
        """Return how far it is from its limit position, negative beyond. It is None where it does not say."""
        return block.margins.get(self.index)

    def in_modes(self, block: Block) -> Configurations:
        """Return the configurations in all modes, for groups of one mode or two."""
        trial = block.leading((*self.group.uses, *self.group.links))
        signs = np.array([1.0, -1.0])[: self.modes].reshape(-1, *[1] * len(block.shape))
        trial.failed = 0
        self.close(trial, signs)
        return Configurations.of_closed_form(
            [trial.world[body.links[0]] for body in self.group.bodies], trial.failed == 0, (self.modes, *block.shape)
        )

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(self.group.links)})"


def equations_of(solver: GroupSolver) -> GroupEquations:
    """Return the equations of a group whose configurations are numbered."""
    assert solver.equations is not None
    return solver.equations
