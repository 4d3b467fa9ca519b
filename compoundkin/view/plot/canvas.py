"""Figures and axes: making them, their scales and ranges, ticks, legends, marks, and labels that cover nothing."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.model.attributes import typeset_unit
from compoundkin.view.plot.plot_style import GREY, INK, SHADE, SMALL_PRINT, Plot, colours
from compoundkin.view.plot.plotted_rows import CONSTANT, Plotted
from compoundkin.view.sketch.sketch_dimensions import RAISED

WIDTH = 7.0
# Characters of a title in a line.
TITLE = 78
# More designs than this get a scale of colours instead of a legend.
LISTED = 8
# Steps of ticks in degrees, as people count them.
DEGREES = (1, 2, 5, 10, 15, 30, 45, 60, 90, 180, 360, 720)
ACROSS, UPWARDS = 9, 6
# Characters that the height of a panel and of a whole figure have room for.
PANEL, WHOLE = 24, 60
# The width of a letter in a legend, inches, and how many letters a handle is wide.
LETTER, HANDLE = 0.078, 9
# How poses next to limit positions are marked.
RING: Mapping[str, Any] = MappingProxyType(
    {"linestyle": "none", "marker": "o", "markersize": 5.5, "markerfacecolor": "white", "markeredgewidth": 1.2}
)


def panels(rows: int, title: str, size: tuple[float, float], columns: int = 1, **options: Any) -> tuple[Any, list[Any]]:
    """Make a figure with a title and its axes, row by row. Raises InvalidInput for an invalid size."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    if not all(0.0 < one < np.inf for one in size):
        raise InvalidInput(
            Problem("size", f"{size!r} is not a size", "give width and height in inches, such as (7, 4)")
        )
    figure = Figure(figsize=size, layout="constrained")
    FigureCanvasAgg(figure)
    if title:
        lines = (textwrap.fill(line, TITLE) for line in title.splitlines())
        figure.suptitle("\n".join(lines), x=0.01, ha="left")
    grid = figure.subplots(rows, columns, squeeze=False, **options)
    return figure, list(grid.ravel())


def finished(figure: Any, labels: Sequence[PointLabel]) -> Plot:
    """Return the picture, its labels placed after everything else has its place."""
    place_labels(figure, labels)
    return Plot(figure)


def degree_step(span: float, most: int) -> float | None:
    """Return the distance between ticks of degrees. None where the usual ones for decimal numbers suit.

    >>> degree_step(360.0, 9), degree_step(44.0, 6), degree_step(1.5, 6)
    (45, 10, None)
    """
    if span < DEGREES[1]:
        return None
    return next((step for step in DEGREES if span / step <= most), None)


def set_round_ticks(axis: Any, is_angle: bool, most: int) -> None:
    """Draw ticks at round numbers: of degrees at parts of a turn."""
    from matplotlib.ticker import MaxNLocator, MultipleLocator

    low, high = axis.get_view_interval()
    step = degree_step(abs(high - low), most) if is_angle else None
    axis.set_major_locator(MultipleLocator(step) if step else MaxNLocator(most, steps=(1, 2, 2.5, 5, 10)))


def axis_labels(axes: Any, x: Plotted | None, y: Plotted, room: int) -> None:
    """Write names and units, and set the ticks that suit them.

    The unit goes below a name with more than `room` characters.
    """
    if x is not None:
        axes.set_xlabel(x.label)
        set_round_ticks(axes.xaxis, x.is_angle, ACROSS)
    lines = y.label.rsplit(" [", 1) if len(y.label) > room else [y.label]
    small = {"fontsize": SMALL_PRINT} if len(lines[0]) > room else {}
    axes.set_ylabel("\n[".join(lines), **small)
    set_round_ticks(axes.yaxis, y.is_angle, UPWARDS)


def constant_limits(values: Number, scale: float) -> tuple[float, float] | None:
    """Return limits around values constant but for rounding. None where they are not.

    >>> constant_limits(np.array([1.0, 1.0]), 1.0)
    (0.5, 1.5)
    """
    known = values[np.isfinite(values)]
    if not len(known) or np.ptp(known) > CONSTANT * max(scale, float(np.max(np.abs(known)))):
        return None
    middle = float(np.mean(known))
    half = abs(middle) / 2.0 if abs(middle) > CONSTANT * scale else scale or 1.0
    return middle - half, middle + half


def set_vertical_margins(axes: Any, values: Number, scale: float, margin: float) -> None:
    """Set the vertical limits: around values constant but for rounding, else with margins, parts of their range."""
    still = constant_limits(values, scale)
    if still is not None:
        axes.set_ylim(*still)
    else:
        axes.margins(y=margin)


def write_empty(axes: Any) -> None:
    """Write that there are no values, and leave out the ticks."""
    axes.text(0.5, 0.5, "no values", transform=axes.transAxes, ha="center", va="center", color=GREY)
    axes.set_yticks([])


# Inches for a number below an axis.
TICK_ROOM = 0.65


def plane_axes(axes: Any, x: str, y: str) -> None:
    """Draw the axes of a plane: equal scales."""
    from matplotlib.ticker import MaxNLocator

    axes.set_aspect("equal", adjustable="datalim")
    # as many ticks across as have room for numbers of a hundred thousand
    width = float(axes.get_position().width * axes.figure.get_size_inches()[0])
    axes.xaxis.set_major_locator(MaxNLocator(max(2, min(ACROSS, int(width / TICK_ROOM))), steps=(1, 2, 2.5, 5, 10)))
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.margins(0.1)


def draw_legend(axes: Any) -> None:
    """Draw the legend of an axes, above it at the right. It is drawn if there is more than one thing to distinguish."""
    handles, _ = axes.get_legend_handles_labels()
    if len(handles) > 1:
        columns = min(len(handles), 4)
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=columns, borderaxespad=0.2)


def designs_legend(
    figure: Any, axes: Sequence[Any], names: Sequence[str], shades: Sequence[Any] = (), beside: bool = True
) -> None:
    """Draw the legend of designs. Names beside the plot or above it, or a scale where there are many."""
    from matplotlib.colors import LinearSegmentedColormap, Normalize
    from matplotlib.lines import Line2D

    shades = shades or colours(1, len(names))
    if len(names) <= LISTED:
        handles = [Line2D([], [], color=colour, label=name) for colour, name in zip(shades, names, strict=True)]
        figure.legend(handles=handles, loc="outside right upper" if beside else "outside upper left")
        return
    from matplotlib.cm import ScalarMappable

    scale = LinearSegmentedColormap.from_list("designs", shades, N=len(names))
    bar = figure.colorbar(ScalarMappable(Normalize(-0.5, len(names) - 0.5), scale), ax=list(axes), aspect=35, pad=0.02)
    shown = np.unique(np.linspace(0, len(names) - 1, 6).round().astype(int))
    bar.set_ticks(shown.tolist(), labels=[names[k] for k in shown])
    bar.outline.set_visible(False)


def events_legend(figure: Any, gaps: bool, limits: bool, changes: bool, marks: str = "") -> None:
    """Draw the legend of shades, rings, dashes and dots below the plot."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = []
    if gaps:
        handles.append(Patch(color=SHADE, label="cannot be assembled"))
    if marks:
        handles.append(Line2D([], [], linestyle="none", marker="o", markersize=3.5, color=GREY, label=marks))
    if limits:
        handles.append(ring_handle("next to a gap"))
    if changes:
        handles.append(Line2D([], [], color=GREY, linestyle="--", linewidth=1.0, label="change point"))
    legend_below(figure, handles)


def legend_below(figure: Any, handles: Sequence[Any]) -> None:
    """Draw the legend of a whole figure below it. A long one has two rows."""
    if handles:
        letters = sum(len(one.get_label()) + HANDLE for one in handles)
        rows = 1 if letters * LETTER <= figure.get_figwidth() else 2
        figure.legend(handles=handles, loc="outside lower right", ncols=-(-len(handles) // rows))


def ring_handle(label: str) -> Any:
    """Return the legend's ring for a pose next to a gap."""
    from matplotlib.lines import Line2D

    return Line2D([], [], **RING, color=INK, label=label)


def draw_rings(axes: Any, x: Number, y: Number, colour: Any) -> None:
    """Draw rings around poses next to limit positions and ends of guides."""
    if len(x):
        axes.plot(x, y, **RING, color=colour, zorder=4)


def draw_dots(axes: Any, x: Any, y: Any, colour: Any, size: float = 4.5) -> None:
    """Draw dots on a curve."""
    axes.plot(x, y, linestyle="none", marker="o", markersize=size, color=colour, zorder=5, clip_on=False)


def draw_arrow(axes: Any, x: Number, y: Number, colour: Any) -> None:
    """Draw an arrow along a curve, an eighth of its poses after its begin. None where nothing moves."""
    known = np.isfinite(x) & np.isfinite(y)
    moves = np.flatnonzero(known[:-1] & known[1:] & ((np.diff(x) != 0) | (np.diff(y) != 0)))
    if len(moves):
        k = int(moves[len(moves) // 8])
        style = {"arrowstyle": "-|>", "color": colour, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 13}
        axes.annotate("", (x[k + 1], y[k + 1]), (x[k], y[k]), arrowprops=style, zorder=5)


def write_note(axes: Any, text: str) -> None:
    """Write a remark in small print above an axes, at the left."""
    axes.set_title(text, loc="left", fontsize=SMALL_PRINT, color=GREY)


def design_names(shape: tuple[int, ...], given: Sequence[str]) -> tuple[str, ...]:
    """Return the names of designs: as given, or by their indices.

    >>> design_names((2, 5), ()), design_names((1, 2, 5), ())
    (('design 0', 'design 1'), ('design 0, 0', 'design 0, 1'))
    """
    indices = np.ndindex(*shape[:-1])
    return tuple(given) or tuple("design " + ", ".join(map(str, index)) for index in indices)


# What may be logarithmic, and what a logarithmic axis has ticks at, parts of a power of ten.
LOG, SUBS = ("x", "y", "xy"), (1.0, 2.0, 5.0)
# From how many times its lower end on an axis has ticks at powers of ten only, and about at how many.
FEW, DECADES = 500.0, 8
# What is below this part of a quantity's size is zero but for rounding.
ROUNDING = 1e-12


@dataclass(frozen=True)
class AxisScales:
    """The limits of both axes, and which are logarithmic. Limits are None where they follow from the curves."""

    xlim: tuple[float, float] | None = None
    ylim: tuple[float, float] | None = None
    log: str = ""

    @classmethod
    def checked(cls, xlim: tuple[float, float] | None, ylim: tuple[float, float] | None, log: str | None) -> AxisScales:
        """Return the axes of given limits. Raises InvalidInput for limits or words that are not valid."""
        if log is not None and log not in LOG:
            raise InvalidInput(Problem("log", f"{log!r} is not an axis", 'write "x", "y" or "xy"'))
        for name, ends in (("x", xlim), ("y", ylim)):
            if ends is None:
                continue
            if not (np.isfinite(ends).all() and ends[0] < ends[1]):
                what = f"from {ends[0]:g} to {ends[1]:g} is not a range"
                raise InvalidInput(Problem(f"{name}lim", what, "give the lower end and the upper one"))
            if name in (log or "") and ends[0] <= 0.0:
                what = f"it begins at {ends[0]:g}, and the axis is logarithmic"
                raise InvalidInput(Problem(f"{name}lim", what, "begin above zero"))
        return cls(xlim, ylim, log or "")

    def check_fit(self, across: Sequence[Plotted], titles: Sequence[Plotted], curves: Iterable[Plotted]) -> None:
        """Raise InvalidInput where limits or scales do not fit.

        They do not where limits are meant for several units, or an axis cannot be logarithmic.
        """
        units = list(dict.fromkeys(typeset_unit(one.unit) or "numbers" for one in titles))
        if self.ylim is not None and len(units) > 1:
            what = f"the panels are in {', '.join(units)}"
            raise InvalidInput(Problem("ylim", what, "draw quantities of one unit, or leave it out"))
        values = np.concatenate([one.values.ravel() for one in across])
        if self.xlim is not None and not np.any((values >= self.xlim[0]) & (values <= self.xlim[1])):
            what = f"{across[0].name} goes from {value_text(np.nanmin(values))} to {value_text(np.nanmax(values))}"
            raise InvalidInput(Problem("xlim", f"no pose is between {self.xlim[0]:g} and {self.xlim[1]:g}", what))
        for name, rows in (("x", across), ("y", curves)):
            for one in rows if name in self.log else ():
                _check_positive(one)

    def visible(self, x: Number, y: Number) -> Number:
        """Return the values of a curve that are within the horizontal limits."""
        return y if self.xlim is None else y[(x >= self.xlim[0]) & (x <= self.xlim[1])]

    def drawable(self, values: Number, scale: float) -> Number:
        """Return the values that a vertical axis can show. A logarithmic one shows what is not nothing."""
        return values[values > ROUNDING * scale] if "y" in self.log else values

    def shows(self, x: float, y: float) -> bool:
        """Return whether a place of a curve is within the limits."""
        return self.reaches(x) and (self.ylim is None or self.ylim[0] <= y <= self.ylim[1])

    def reaches(self, x: float) -> bool:
        """Return whether a place of the horizontal axis is within its limits."""
        return self.xlim is None or self.xlim[0] <= x <= self.xlim[1]

    def make_log(self, axes: Any) -> None:
        """Make axes logarithmic."""
        for name in self.log:
            axes.set(**{f"{name}scale": "log"})

    def ticks(self, axes: Any) -> None:
        """Put plain numbers at the ticks of logarithmic axes."""
        from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

        for name in self.log:
            axis = axes.xaxis if name == "x" else axes.yaxis
            low, high = axis.get_view_interval()
            axis.set_major_locator(LogLocator(subs=SUBS) if high < FEW * low else LogLocator(numticks=DECADES))
            axis.set_major_formatter(FuncFormatter(lambda value, _: value_text(value)))
            axis.set_minor_formatter(NullFormatter())


def _check_positive(one: Plotted) -> None:
    known = one.values[np.isfinite(one.values)]
    if len(known) and known.min() <= ROUNDING * one.scale:
        low, high = (value_text(float(end), one.scale) for end in (known.min(), known.max()))
        what = f"{one.name} goes from {low} to {high}, and a logarithmic axis has positive values only"
        remedy = "leave it out, or draw what is positive, such as a length"
        raise InvalidInput(Problem("log", what, remedy))


# Beside limit positions rates grow without limit: what exceeds the inner nine tenths of the values this many times
# would press all else flat, and is cut off. Where a motion has no limit position it may end just before one, or have
# true peaks, which are cut off only where nothing else could be seen.
INNER, TALL, TALL_WITHOUT_LIMITS, MARGIN = (5.0, 95.0), 3.0, 50.0, 0.35
# Free space above and below curves, for the values of extremes; a part of their range.
HEADROOM = 0.16


def set_range(
    axes: Any, curves: Sequence[Plotted], lines: Sequence[tuple[Number, Number]], scales: AxisScales, near_limits: bool
) -> tuple[float, float] | None:
    """Set the vertical range of curves, and return it where values lie outside."""
    if scales.ylim is not None:
        axes.set_ylim(*scales.ylim)
        return None
    scale = max(curve.scale for curve in curves)
    seen = scales.drawable(np.concatenate([scales.visible(*line) for line in lines]), scale)
    values = np.concatenate([curve.values.ravel() for curve in curves]) if scales.xlim is None else seen
    still, window = constant_limits(seen, scale), _window(curves, values, near_limits)
    if still is not None:
        axes.set_ylim(*still)
    elif window is not None and "y" not in scales.log:
        axes.set_ylim(*window)
        write_note(axes, f"cut off: from {value_text(np.nanmin(values))} to {value_text(np.nanmax(values))}")
        return window
    elif np.isfinite(seen).any():
        window = _with_room(float(np.nanmin(seen)), float(np.nanmax(seen)), "y" in scales.log)
        axes.set_ylim(*window)
        return window if "y" in scales.log else None
    return None


def _with_room(low: float, high: float, is_log: bool) -> tuple[float, float]:
    """A range with room above and below, on a logarithmic axis by a part of its powers."""
    if not is_log:
        return low - HEADROOM * (high - low), high + HEADROOM * (high - low)
    room = (high / low) ** HEADROOM
    return low / room, high * room


def _window(curves: Sequence[Plotted], values: Number, near_limits: bool) -> tuple[float, float] | None:
    """The values to show where rates grow without limit; None for all of them."""
    known = values[np.isfinite(values)]
    if not len(known) or not any(curve.is_unbounded for curve in curves):
        return None
    low, high = np.percentile(known, INNER)
    span = high - low
    if span == 0.0 or np.ptp(known) <= (TALL if near_limits else TALL_WITHOUT_LIMITS) * span:
        return None
    edge, far = HEADROOM * span, MARGIN * span
    return float(max(low - far, known.min() - edge)), float(min(high + far, known.max() + edge))


# Distance from a point to the edge of its text, in points.
CLEARANCE = 4.0
# Directions that are tried, as parts of a turn counterclockwise from the one that is wished for.
TURNS = (0.0, 0.125, -0.125, 0.25, -0.25, 0.375, -0.375, 0.5)
# A text that is farther away from its point: twice and three times the clearance, after all else.
FARTHER = (1.0, 2.5, 4.5)
# Points nearer to each other than so many pixels are one.
SAME = 3.0
# White around a text that keeps curves off it.
HALO = 1.5
# Places examined on a curve, a few pixels from each other.
PLACES = 1500
# A value smaller than this part of its scale is zero but for interpolation.
NOTHING = 1e-6
# From where four digits would need a power of ten, and from where one is easier to read than the digits.
MANY_DIGITS, POWER_OF_TEN = 1e4, 1e6


@dataclass(frozen=True, eq=False)
class PointLabel:
    """A text that belongs to a point of an axes' plot. `towards` is its preferred direction, complex."""

    axes: Any
    x: float
    y: float
    text: str
    towards: complex = 1j
    colour: Any = INK


def value_text(value: float, scale: float = 0.0) -> str:
    """Return a value in four digits, with a proper minus sign, far from 1 with a power of ten.

    Zero where it is nothing beside the scale.

    >>> value_text(-12.34567), value_text(12345.6), value_text(1e-14, 1.0), value_text(1.085e6)
    ('−12.35', '12346', '0', '1.085·10⁶')
    """
    if abs(value) <= NOTHING * scale:
        return "0"
    form = ".0f" if MANY_DIGITS <= abs(value) < POWER_OF_TEN else ".4g"
    digits, _, power = format(value, form).partition("e")
    return f"{digits.replace('-', '−')}{f'·10{str(int(power)).translate(RAISED)}' if power else ''}"


def place_labels(figure: Any, labels: Sequence[PointLabel]) -> None:
    """Write the labels, each where it covers least. One that finds no free place is left out."""
    figure.get_layout_engine().execute(figure)
    for axes in figure.axes:
        axes.apply_aspect()
    # settled now: the labels are placed for this layout, and writing a file need not find it again
    figure.set_layout_engine(None)
    renderer = figure.canvas.get_renderer()
    scale = figure.dpi / 72.0
    taken: dict[Any, list[Number]] = {}
    curves: dict[Any, Number] = {}
    for label in _distinct(labels):
        written = _written(label)
        if label.axes not in curves:
            curves[label.axes], taken[label.axes] = _pixels(label.axes), []
        box = written.get_window_extent(renderer)
        half = np.array([box.width, box.height]) / 2.0 + HALO
        anchor = label.axes.transData.transform((label.x, label.y))
        found = _free(
            anchor, half, label.towards, scale, curves[label.axes], taken[label.axes], label.axes.bbox.extents
        )
        if found is None:
            written.remove()
            continue
        taken[label.axes].append(np.concatenate([found - half, found + half]))
        written.set_position(tuple((found - anchor) / scale))


def _distinct(labels: Sequence[PointLabel]) -> list[PointLabel]:
    """The labels without repetitions at one place, as of a component that is the whole length."""
    found: list[PointLabel] = []
    for label in labels:
        place = label.axes.transData.transform((label.x, label.y))
        same = (one for one in found if (one.axes, one.text) == (label.axes, label.text))
        if all(np.abs(place - one.axes.transData.transform((one.x, one.y))).max() > SAME for one in same):
            found.append(label)
    return found


def _written(label: PointLabel) -> Any:
    from matplotlib.patheffects import withStroke

    written = label.axes.annotate(
        label.text,
        (label.x, label.y),
        (0.0, 0.0),
        textcoords="offset points",
        ha="center",
        va="center",
        color=label.colour,
        fontsize=SMALL_PRINT,
        path_effects=[withStroke(linewidth=2.0 * HALO, foreground="white")],
        zorder=6,
    )
    # where it stands is settled here; the layout must not move the axes for it again
    written.set_in_layout(False)
    return written


def _free(
    anchor: Number, half: Number, towards: complex, scale: float, curves: Number, taken: list[Number], inside: Number
) -> Number | None:
    """The middle of the free place that covers least of the curves; None without a free place."""
    best, least = None, np.inf
    for farther in FARTHER:
        for turn in TURNS:
            way = towards / abs(towards) * np.exp(2j * np.pi * turn)
            heading = np.array([way.real, way.imag])
            middle = anchor + heading * (CLEARANCE * scale * farther + half)
            low, high = middle - half, middle + half
            if (low < inside[:2]).any() or (high > inside[2:]).any() or any(_overlap(low, high, b) for b in taken):
                continue
            covered = int(((curves > low) & (curves < high)).all(axis=1).sum())
            if covered < least:
                best, least = middle, covered
        if least == 0:
            break
    return best


def _overlap(low: Number, high: Number, box: Number) -> bool:
    return bool((low < box[2:]).all() and (high > box[:2]).all())


def _pixels(axes: Any) -> Number:
    """Pixels of all curves of an axes, close to each other."""
    found = [np.zeros((0, 2))]
    for line in axes.get_lines():
        if line.get_transform() != axes.transData or len(line.get_xdata()) < 2:
            continue
        corners = axes.transData.transform(np.column_stack([line.get_xdata(), line.get_ydata()]).astype(float))
        steps = np.linspace(0.0, len(corners) - 1.0, PLACES)
        found.append(np.column_stack([np.interp(steps, np.arange(len(corners)), corners[:, k]) for k in (0, 1)]))
    return np.concatenate(found)


def broken_label(label: str, room: int) -> str:
    """Return a name with its unit in lines of so many characters.

    It is broken behind dots and before its unit, behind underscores where a part is longer than a line.

    >>> broken_label("plate.transmission_angle.least [°]", 20)
    'plate.\\ntransmission_angle.\\nleast [°]'
    """
    parts = [one for part in re.findall(r"[^. ]+[. ]*|[. ]+", label) for one in _short_parts(part, room)]
    lines = [""]
    for part in parts:
        if len(lines[-1]) + len(part.rstrip()) <= room:
            lines[-1] += part
        else:
            lines.append(part)
    return "\n".join(line.rstrip() for line in lines if line.strip())


def _short_parts(part: str, room: int) -> list[str]:
    if len(part.rstrip()) <= room:
        return [part]
    pieces = re.findall(r"[^_]+_?|_", part)
    return [piece[k : k + room] for piece in pieces for k in range(0, len(piece), room)]
