"""`bar_diagrams`: normal force, shear and bending moment along the bars of links, over the cycle and at a pose."""

from __future__ import annotations

from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.dynamics.strength import BENDING, NORMAL, SHEAR, BarForces, Strength, pose_text
from compoundkin.model.attributes import typeset_unit
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.canvas import PointLabel, value_text
from compoundkin.view.plot.plot_style import GREY, INK, SMALL_PRINT, Plot

# So wide is a bar's column, so high a panel, and so high what is above and below, inches.
COLUMN, PANEL, REST = 4.4, 2.0, 1.1
# What the envelope is filled with is this part of its colour.
FILLED = 0.16
# The quantities in the order of textbooks.
QUANTITIES = (NORMAL, SHEAR, BENDING)
# Extremes below this part of the largest are rounding, and have no mark.
ROUNDING = 1e-9


@checked
def bar_diagrams(
    found: Strength,
    *bars: str,
    pose: int | None = None,
    design: int = 0,
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw normal force, shear and bending moment along bars: the envelope of all poses, and one pose.

    A column for each of the `bars`, all if none is named, a panel for each quantity. The envelope is filled between the
    least and the greatest value at each place; the thick line is the pose with the greatest bending moment of the bar,
    without bending the greatest normal force, or the one with the index `pose`. Dots are the extremes over all poses.
    Signs are those of `strength`. `size` is in inches.

    Raises UnknownName for a bar that is not there, InvalidInput where there is none, and for a pose or design that is
    not there.

    >>> from compoundkin.dynamics.force_analysis import force_analysis
    >>> from compoundkin.dynamics.strength import strength
    >>> from compoundkin.files import load
    >>> from compoundkin.kinematics import solve
    >>> picture = bar_diagrams(strength(force_analysis(solve(load("engine-gas-pressure")))), "rod")
    >>> picture.figure.axes[2].get_ylabel()
    'bending moment [N m]'
    """
    names = bars or tuple(found.bars)
    motion = found.forces.motion
    if not names:
        why = "; ".join(f"{link}: {reason}" for link, reason in found.undefined.items())
        raise InvalidInput(Problem("bars", f"no link has a bar ({why})"))
    for name in names:
        if name not in found.bars:
            what = found.undefined.get(name, "there is no such bar")
            raise UnknownName(Problem(name, what, suggestion(name, list(found.bars))))
    for what, index, count in (("pose", pose, motion.inputs.poses), ("design", design, motion.inputs.designs)):
        if index is not None and not 0 <= index < count:
            raise InvalidInput(Problem(what, f"there is no {what} {index}", f"0 to {count - 1}"))
    rows = len(QUANTITIES)
    wide = size or (max(canvas.WIDTH, COLUMN * len(names)), REST + PANEL * rows)
    with plot_style.styled():
        text = motion.mechanism.title if title is None else title
        figure, axes = canvas.panels(rows, text, wide, columns=len(names), sharex="col")
        labels: list[PointLabel] = []
        for k, name in enumerate(names):
            _draw_bar(axes[k :: len(names)], name, found.bars[name], design, pose, labels)
        _draw_legend(figure, motion.inputs.poses)
        figure.align_ylabels(axes)
        return canvas.finished(figure, labels)


def _draw_bar(axes: Any, name: str, bar: BarForces, design: int, pose: int | None, labels: list[PointLabel]) -> None:
    """Draw the column of one bar."""
    units, motion = bar.motion.mechanism.stated_units, bar.motion
    places = bar.stations(design)
    shown = _telling_pose(bar, design) if pose is None else pose
    for one, what, colour in zip(axes, QUANTITIES, plot_style.COLOURS, strict=False):
        values = bar.along(what, places, design)
        unit = units.moment if what == BENDING else units.force
        one.axhline(0.0, color=GREY, linewidth=0.8, zorder=1)
        if len(values) > 1:
            _, least, greatest = bar.envelope(what, design)
            one.fill_between(places, least, greatest, color=colour, alpha=FILLED, linewidth=0, zorder=2)
            one.plot(places, least, color=colour, linewidth=0.8, zorder=3)
            one.plot(places, greatest, color=colour, linewidth=0.8, zorder=3)
            _mark_extremes(one, bar, what, design, colour, labels)
        one.plot(places, values[shown], color=INK, linewidth=1.7, zorder=4)
        one.set_ylabel(f"{what} [{typeset_unit(unit)}]")
        canvas.set_round_ticks(one.yaxis, False, canvas.UPWARDS)
        one.margins(x=0.0, y=0.16)
        _mark_letters(one, bar, design)
    axes[0].set_title(f"{name}, line at {pose_text(motion, design, shown)}\n", loc="left", fontsize=SMALL_PRINT + 1)
    axes[-1].set_xlabel(f"distance from {bar.letters[0]} [{typeset_unit(units.length)}]")
    canvas.set_round_ticks(axes[-1].xaxis, False, canvas.UPWARDS)


def _telling_pose(bar: BarForces, design: int) -> int:
    """Return the pose of the greatest bending moment, without bending that of the greatest normal force."""
    sizes = {what: max(bar.extremes(what, design), key=lambda one: abs(one.value)) for what in (BENDING, NORMAL)}
    bends = abs(sizes[BENDING].value) > ROUNDING * abs(sizes[NORMAL].value) * float(bar.length[design])
    return sizes[BENDING if bends else NORMAL].pose


def _mark_extremes(axes: Any, bar: BarForces, what: str, design: int, colour: str, labels: list[PointLabel]) -> None:
    """Draw dots at the least and the greatest value, with the value and the pose."""
    ends = bar.extremes(what, design)
    largest = max(abs(one.value) for one in ends)
    for one, side in zip(ends, (-1j, 1j), strict=True):
        if np.isfinite(one.value) and abs(one.value) > ROUNDING * largest:
            canvas.draw_dots(axes, [one.position], [one.value], colour)
            text = f"{value_text(one.value)}, {pose_text(bar.motion, design, one.pose)}"
            labels.append(PointLabel(axes, one.position, one.value, text, side, colour))


def _mark_letters(axes: Any, bar: BarForces, design: int) -> None:
    """Draw lines at the letters of a bar, and name them above."""
    for letter, place in bar.places(design).items():
        axes.axvline(place, color=GREY, linewidth=0.8, linestyle=":", zorder=1)
        where = {"ha": "center", "va": "bottom", "fontsize": SMALL_PRINT, "color": GREY}
        axes.text(place, 1.0, letter, transform=axes.get_xaxis_transform(), **where)


def _draw_legend(figure: Any, poses: int) -> None:
    """Draw what fill and line mean below the plot."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    if poses > 1:
        fill = Patch(color=plot_style.COLOURS[0], alpha=FILLED, label="between least and greatest of all poses")
        dot = Line2D(
            [], [], linestyle="none", marker="o", markersize=4.5, color=plot_style.COLOURS[0], label="extremes"
        )
        line = Line2D([], [], color=INK, linewidth=1.7, label="at one pose")
        canvas.legend_below(figure, [fill, dot, line])
