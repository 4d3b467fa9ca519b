"""Sensitivities of a compiled path: how its outputs change with dimensions and drivers, at every pose."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import Problem, UnknownName, nearest
from compoundkin.base.series import Number
from compoundkin.programs.path_values import PathValues


@dataclass(frozen=True, eq=False, repr=False)
class PathSensitivities(PrintsShort):
    """Outputs over designs and poses, and their slopes there.

    `found["G.position"]` is an output, `found["G.position", "plate.C.x"]` its slope by a coordinate of a free point,
    `found["bar.angle", "slot.offset"]` that by a free number, and `found["bar.angle", "crank"]` that by a driver's
    value, its rates kept. They are arrays of the call's shape, complex for planar vectors, NaN where the output is.
    """

    values: PathValues
    slopes: Mapping[tuple[str, str], Number]

    @property
    def by(self) -> tuple[str, ...]:
        """The names of what slopes are by."""
        return tuple(dict.fromkeys(by for _, by in self.slopes))

    @property
    def assembled(self) -> Any:
        """Which poses are assembled, a bool array of the call's shape."""
        return self.values.assembled

    def __getitem__(self, name: str | tuple[str, str]) -> Any:
        """Return an output, or its slope; raises UnknownName.

        >>> import compoundkin as ck
        >>> crank = ck.Mechanism("m", ck.link("frame", A=0), ck.link("crank", A=0, B=2), ck.drive("crank"))
        >>> found = ck.compile(crank, "B", free="crank.B").derivatives([0.0])
        >>> found["B"].tolist(), found["B", "crank.B.y"].imag.tolist(), found["B", "crank"].imag.tolist()
        ([(2+0j)], [1.0], [2.0])
        """
        if not isinstance(name, tuple):
            return self.values[str(name)]
        output, by = map(str, name if len(name) == 2 else ("", name))
        if (output, by) not in self.slopes:
            wrong, known = (output, list(self.values.found)) if by in self.by else (by, list(self.by))
            raise UnknownName(Problem(str(wrong), "there is no such slope", nearest(wrong, known)))
        numbers = self.values.numbers
        return np.broadcast_to(self.slopes[output, by], numbers.extent).reshape(numbers.shape)

    def __iter__(self) -> Iterator[str | tuple[str, str]]:
        """Return the names of the outputs, then those of the slopes."""
        return iter((*self.values, *self.slopes))

    def __repr__(self) -> str:
        return f"PathSensitivities({', '.join(self.values.found)} by {', '.join(self.by)})"
