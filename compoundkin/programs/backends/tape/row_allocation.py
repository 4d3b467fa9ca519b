"""Which row of a buffer holds which value: rows are taken again as soon as nothing needs what they hold."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field

from compoundkin.programs.backends.tape.tape_instructions import Instruction


@dataclass
class RowAllocation:
    """The row of each value; truths have rows of their own.

    A result goes where an operand that is needed no more was, so that as few rows as possible stay in the cache.
    """

    rows: dict[int, tuple[bool, int]] = field(default_factory=dict)
    counts: dict[bool, int] = field(default_factory=lambda: {False: 0, True: 0})
    _free: dict[bool, list[int]] = field(default_factory=lambda: {False: [], True: []})

    def take(self, value: int, is_truth: bool) -> None:
        """Give a value the row that was last set free, or a new one."""
        if not self._free[is_truth]:
            self._free[is_truth].append(self.counts[is_truth])
            self.counts[is_truth] += 1
        self.rows[value] = is_truth, self._free[is_truth].pop()

    def release(self, value: int) -> None:
        """Set the row of a value free."""
        is_truth, row = self.rows[value]
        self._free[is_truth].append(row)


def allocated(steps: Sequence[Instruction], kept: Collection[int]) -> RowAllocation:
    """Give every result of some instructions a row. What is `kept` stays in its own."""
    last = {value: at for at, step in enumerate(steps) for value in step.used()}
    found = RowAllocation()
    for at, step in enumerate(steps):
        ending = dict.fromkeys(v for v in step.used() if last[v] == at and v in found.rows and v not in kept)
        early = [value for value in step.overwritable() if value in ending]
        for value in dict.fromkeys(early):
            found.release(value)
            del ending[value]
        if step.result is not None:
            found.take(step.result, step.is_truth)
            if step.result not in last and step.result not in kept:
                found.release(step.result)
        for value in ending:
            found.release(value)
    return found
