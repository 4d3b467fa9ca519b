"""A drawn plot: shown in notebooks, written to files."""

from __future__ import annotations

import io
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.atomic import write_atomically
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
class Plot:
    """A plot: `figure` is Matplotlib's, to be changed at will before it is saved.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> from compoundkin.view.plot import plot
    >>> plot(solve(load_named("six-bar")), "bar.angle").content("svg")[:5]
    b'<?xml'
    """

    figure: Any

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a .png, .svg or .pdf file, by its suffix, whole or not at all.

        Raises InvalidInput for another suffix and where the file cannot be written.
        """
        form = form_of(path)
        content = self.content(form)
        write_atomically(path, lambda file: file.write(content))

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


def form_of(path: str | os.PathLike[str]) -> str:
    """The form that a file's suffix tells; raises InvalidInput where it tells none.

    >>> form_of("G.SVG")
    'svg'
    """
    form = Path(path).suffix.lower().removeprefix(".")
    if form not in METADATA:
        known = ", ".join(f".{name}" for name in METADATA)
        raise InvalidInput(Problem(str(path), "the name does not tell the format", f"plots end in {known}"))
    return form
