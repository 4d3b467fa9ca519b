"""What every way of solving a group answers; each way is one file of this folder and one line of its registry."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from compoundkin.base.series import Number
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.configuration_arrays import Configurations
from compoundkin.kinematics.groups.group_equations import GroupEquations
from compoundkin.model.pairs.contract import Ends
from compoundkin.structure.parts import Group


class GroupSolver(ABC):
    """A group of a structure, made ready to be solved on any block: what it needs is bound once.

    `index` is its place in the solving order. `ends` are those of lower pairs that stand for others, `counted_from`
    the links from whose angles, full turns counted, its own are taken.
    """

    modes: ClassVar[int]  # how many: 1, 2, or 0 where configurations are numbered
    sign_means: ClassVar[str] = ""  # what mode +1 is
    tells_margin: ClassVar[bool] = False  # whether it says how far it is from its limit position
    ends: Mapping[str, Ends]
    counted_from: tuple[str, ...] = ()
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
    def why(self, block: Block, at: int) -> str:
        """Say why the group cannot be assembled at a pose, given by its flat index."""

    @property
    def has_limits(self) -> bool:
        """Whether it may come to a limit position that its closed form shows."""
        return self.modes == 2 or self.tells_margin

    @property
    def modes_may_meet(self) -> bool:
        """Whether it may pass from one mode to the other, where its margin is zero."""
        return self.modes == 2 and self.tells_margin

    def margin(self, block: Block) -> Number | None:
        """Return how far it is from its limit position, negative beyond; None where it does not say."""
        return block.margins.get(self.index)

    def in_modes(self, block: Block) -> Configurations:
        """Return the configurations in all modes, for groups of one mode or two."""
        trial = block.leading()
        signs = np.array([1.0, -1.0])[: self.modes].reshape(-1, *[1] * len(block.shape))
        trial.failed = 0
        self.close(trial, signs)
        return Configurations.of_closed_form(
            [trial.world[body.links[0]] for body in self.group.bodies], trial.failed == 0, (self.modes, *block.shape)
        )
