"""A drawn plot: shown in notebooks, written to files."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar

from compoundkin.base.suffixes import Kind
from compoundkin.files.saved_files import Savable
from compoundkin.view.plot.plot_style import styled

# No dates and no versions: the same plot is the same file.
METADATA: Mapping[str, Mapping[str, str | None]] = MappingProxyType(
    {
        "png": {"Software": "compoundkin"},
        "svg": {"Date": None, "Creator": "compoundkin"},
        "pdf": {"CreationDate": None, "Creator": "compoundkin", "Producer": "compoundkin"},
    }
)


@dataclass(frozen=True, eq=False)
class Plot(Savable):
    """A plot: `figure` is Matplotlib's, to be changed at will before it is saved.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> from compoundkin.view.plot import plot
    >>> plot(solve(load_named("six-bar")), "bar.angle").content("svg")[:5]
    b'<?xml'
    """

    saved_as: ClassVar[Kind] = "plot"

    figure: Any

    def content(self, form: str) -> bytes:
        """The bytes of a file in the form "png", "svg" or "pdf"; the same every time."""
        written = io.BytesIO()
        with styled():
            self.figure.savefig(written, format=form, metadata=dict(METADATA[form]))
        return written.getvalue()

    def _repr_png_(self) -> bytes:
        return self.content("png")

    def _repr_svg_(self) -> str:
        return self.content("svg").decode("utf-8")

    def __repr__(self) -> str:
        names = [axes.get_ylabel() or axes.get_xlabel() for axes in self.figure.axes]
        return f"Plot({', '.join(map(repr, filter(None, names)))})"
