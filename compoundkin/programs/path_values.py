"""What a compiled path finds: its outputs by name, and which poses are assembled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.display import PrintsShort
from compoundkin.base.series import Number
from compoundkin.programs.call_numbers import CallNumbers


@dataclass(frozen=True, eq=False, repr=False)
class PathValues(PrintsShort):
    """Outputs over designs and poses, arrays of the call's shape."""

    numbers: CallNumbers
    found: Mapping[str, Number]
    failed: Number | None = None  # (designs, poses): the first group that does not close plus one; None where all do

    def __getitem__(self, name: str) -> Any:
        """Return an output by its name."""
        return np.broadcast_to(self.found[name], self.numbers.extent).reshape(self.numbers.shape)

    @property
    def assembled(self) -> Any:
        """Which poses are assembled, a bool array of the call's shape."""
        if self.failed is None:
            return np.broadcast_to(np.True_, self.numbers.shape)
        return (self.failed == 0).reshape(self.numbers.shape)

    def __repr__(self) -> str:
        return f"PathValues({', '.join(self.found)} at {self.numbers.shape} poses)"
