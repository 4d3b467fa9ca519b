"""`Plot`, a drawn plot, and the one style of all plots, in force only while one is drawn or written."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar

from compoundkin.base.errors import missing_extra
from compoundkin.base.suffixes import Kind
from compoundkin.files.saved_files import Savable

INK, GREY, SHADE = "#222222", "#767676", "#dcdcdc"
# Distinguished with every kind of colour blindness: M. Okabe, K. Ito, Color Universal Design (2008); the yellow is left
# out, for it is too light for thin lines.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
# Even in lightness and safe for the colour-blind; its light end would be lost on white.
FAMILY, LIGHTEST = "viridis", 0.88
# What is many and not meant: further circuits, designs that cannot be assembled.
FAINT = "#a8a8a8"
SMALL_PRINT = 8.5
STYLE: Mapping[str, Any] = MappingProxyType(
    {
        "font.family": "DejaVu Sans",  # comes with Matplotlib, so that every computer draws the same
        "font.size": 10,
        "axes.titlesize": 10,
        "axes.labelsize": 10,
        "xtick.labelsize": 9,
        "ytick.labelsize": 9,
        "legend.fontsize": 9,
        "figure.titlesize": 11,
        "figure.facecolor": "white",
        "axes.edgecolor": GREY,
        "axes.labelcolor": INK,
        "text.color": INK,
        "xtick.color": GREY,
        "ytick.color": GREY,
        "xtick.labelcolor": INK,
        "ytick.labelcolor": INK,
        "axes.grid": True,
        "axes.axisbelow": True,
        "grid.color": "#e6e6e6",
        "grid.linewidth": 0.6,
        "axes.linewidth": 0.8,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "lines.linewidth": 1.5,
        "legend.frameon": False,
        "legend.handlelength": 3.2,  # so long that a dash differs from a dot
        "savefig.dpi": 150,
        "text.parse_math": False,  # a dollar sign in a name is a dollar sign
        "svg.hashsalt": "compoundkin",  # otherwise the names inside an SVG differ from run to run
        "svg.fonttype": "path",
        "pdf.fonttype": 42,
    }
)
# No dates and no versions: the same plot is the same file.
METADATA: Mapping[str, Mapping[str, str | None]] = MappingProxyType(
    {
        "png": {"Software": "compoundkin"},
        "svg": {"Date": None, "Creator": "compoundkin"},
        "pdf": {"CreationDate": None, "Creator": "compoundkin", "Producer": "compoundkin"},
    }
)


def require_matplotlib() -> None:
    """Raise InvalidInput with the remedy where Matplotlib is not installed."""
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        raise missing_extra("", "plots need matplotlib", "plot") from None


@contextmanager
def styled() -> Iterator[None]:
    """Draw in the style of the house, whatever the user's own settings are. They are back afterwards."""
    require_matplotlib()
    from matplotlib import style

    with style.context(dict(STYLE), after_reset=True):
        yield


def colours(count: int, designs: int) -> tuple[Any, ...]:
    """Return a colour for each of `count` curves. For each of several designs they run from dark to light.

    >>> colours(2, 1)
    ('#0072B2', '#D55E00')
    """
    if designs == 1:
        return tuple(COLOURS[k % len(COLOURS)] for k in range(count))
    from matplotlib import colormaps

    return tuple(colormaps[FAMILY](LIGHTEST * k / (designs - 1)) for k in range(designs))


@dataclass(frozen=True, eq=False)
class Plot(Savable):
    """A plot: `figure` is Matplotlib's, to be changed at will before it is saved.

    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> from compoundkin.view.plot import plot
    >>> plot(solve(load("six-bar")), "bar.angle").content("svg")[:5]
    b'<?xml'
    """

    saved_as: ClassVar[Kind] = "plot"

    figure: Any

    def content(self, form: str) -> bytes:
        """Return the bytes of a file in the form "png", "svg" or "pdf". The same every time."""
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
