"""What a compiled path finds: its outputs by name, and which poses are assembled."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.kinematics.lost_digits import Told
from compoundkin.kinematics.motion import Motion
from compoundkin.programs.call_numbers import CallNumbers, picked


@dataclass(frozen=True, eq=False, repr=False)
class PathValues(PrintsShort):
    """Outputs over designs and poses, arrays of the call's shape."""

    numbers: CallNumbers
    found: Mapping[str, Number]
    failed: Number | None  # (designs, poses): the first group that does not close plus one; None where all do
    solving: Callable[[CallNumbers], Told]

    def __getitem__(self, name: str) -> Any:
        """Return an output by its name."""
        return np.broadcast_to(self.found[name], self.numbers.extent).reshape(self.numbers.shape)

    @property
    def assembled(self) -> Any:
        """Which poses are assembled, a bool array of the call's shape."""
        if self.failed is None:
            return np.broadcast_to(np.True_, self.numbers.shape)
        return (self.failed == 0).reshape(self.numbers.shape)

    @checked
    def motion(self, design: int = 0) -> Motion:
        """Return one design solved by `solve`, which tells what fails and why.

        `design` counts along all axes but the last. Raises InvalidInput where there is no such design, NotAssembled
        where it has no pose at all.

        >>> import compoundkin as ck
        >>> found = ck.compile(ck.catalog.load_named("slider-crank"), "B")()
        >>> ck.gaps(found.motion())
        ()
        """
        count = self.numbers.extent[0]
        if not 0 <= design < count:
            raise InvalidInput(Problem("design", f"there is no design {design}", f"0 to {count - 1}"))
        with np.errstate(all="ignore"):
            return self.solving(picked(self.numbers, np.array([design]))).motion

    def __repr__(self) -> str:
        return f"PathValues({', '.join(self.found)} at {self.numbers.shape} poses)"
