"""A block on which a mechanism is recorded: what keeps its groups from closing is noted one by one."""

from __future__ import annotations

from dataclasses import dataclass, field, fields

from compoundkin.base.series import Number
from compoundkin.kinematics.block import Block


@dataclass
class RecordedBlock(Block):
    """A block that notes the truths on which its groups hang.

    `goods` are (index, truth) in the order in which they are met.
    """

    goods: list[tuple[int, Number]] = field(default_factory=list)

    @classmethod
    def of(cls, block: Block) -> RecordedBlock:
        """Return a block as one that notes truths."""
        return cls(**{one.name: getattr(block, one.name) for one in fields(block)})

    def fail(self, good: Number, index: int) -> None:
        """Note that a group does not close where `good` is false."""
        self.goods.append((index, good))
