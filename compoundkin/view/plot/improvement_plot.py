"""What a search of better dimensions made better: paths with the places wanted, and courses, before and after."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.series import Number
from compoundkin.kinematics import Motion
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import POSITION, course_figure, unit_of
from compoundkin.studies.optimisation.optimum import Optimum
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.dense_motion import dense_motion
from compoundkin.view.plot.plot_style import COLOURS, FAINT, GREY, Plot
from compoundkin.view.plot.plotted_rows import Plotted, along, shown
from compoundkin.view.plot.point_labels import PointLabel
from compoundkin.view.plot.study_columns import headed
from compoundkin.view.plot.vertical_ranges import HEADROOM
from compoundkin.view.report.objective_words import objective_words

# Heights of a path and of a course, and of all that stands around them, inches.
PATH, COURSE, AROUND = 5.0, 2.2, 1.1
# So many poses at most are dots on a path.
FEW = 40
# Beside so many wanted places at most stand their numbers.
NUMBERED = 24


@dataclass(frozen=True, eq=False)
class ComparedCourse:
    """A panel: a quantity before and after, of a point with the places wanted."""

    name: str
    is_path: bool
    wanted: Number | None = None

    @property
    def height(self) -> float:
        """How high its panel is, inches."""
        return PATH if self.is_path else COURSE


@checked
def improvement(
    optimum: Optimum, *names: str, title: str | None = None, size: tuple[float, float] | None = None
) -> Plot:
    """Draw what a search of better dimensions made better, before and after.

    `names` are quantities; without any, those that the goals ask. Of points the paths are drawn, through a whole turn
    of a driver that turns far, with the places that goals want, numbered in their order; of all else the courses over
    the driver or time. Before is the mechanism as it stood, dashed.

    Raises UnknownName for quantities that there are not, InvalidInput without Matplotlib.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.studies.goals.least_goal import least
    >>> from compoundkin.studies.optimisation.better_dimensions import optimise
    >>> free = {"rocker.C.x": (3.5, 4.5)}
    >>> found = optimise(load_named("crank-rocker"), free, least("rocker.angle.stroke"), starts=4)
    >>> [line.get_label() for line in improvement(found).figure.axes[0].get_lines()]
    ['before', 'after']
    """
    before, after = optimum.before, optimum.motion
    panels = [_compared(optimum, name) for name in names or _asked(optimum)]
    dense = _dense(optimum) if any(panel.is_path for panel in panels) else (before, after)
    labels: list[PointLabel] = []
    with plot_style.styled():
        text = headed(after.mechanism.title if title is None else title, told(optimum))
        heights = [panel.height for panel in panels]
        figure, axes = canvas.panels(len(panels), text, size or (canvas.WIDTH, sum(heights) + AROUND),
                                     gridspec_kw={"height_ratios": heights})  # fmt: skip
        for one, panel in zip(axes, panels, strict=True):
            if panel.is_path:
                _path(one, panel, dense, (before, after), labels)
            else:
                _course(one, panel, (before, after))
        canvas.legend_below(figure, axes[0].get_legend_handles_labels()[0])
        return canvas.finished(figure, labels)


def told(optimum: Optimum) -> str:
    """Say what the objective was and is."""
    if not np.isfinite(optimum.value_before):
        return f"objective {objective_words(optimum, optimum.value)}, before not assembled"
    return f"objective {' → '.join(objective_words(optimum, one) for one in (optimum.value_before, optimum.value))}"


def _wanted(optimum: Optimum) -> dict[str, Number]:
    """The places that points are to be at."""
    return {point: places for goal in optimum.goals for point, places in goal.places.items()}


def _asked(optimum: Optimum) -> list[str]:
    """The quantities that goals ask, of figures the courses that they are of."""
    names = [name for goal in optimum.goals for name in goal.outputs(optimum.before)]
    return list(dict.fromkeys(course_figure(name)[0] for name in names))


def _compared(optimum: Optimum, name: str) -> ComparedCourse:
    found = quantity(optimum.motion, name)
    point = found.name.removesuffix(f".{POSITION}")
    is_path = found.is_vector and point in optimum.motion.points
    return ComparedCourse(point if is_path else found.name, is_path, _wanted(optimum).get(point) if is_path else None)


def _dense(optimum: Optimum) -> tuple[Motion, Motion]:
    best, before = optimum.minima[0], optimum.before
    both = (before.mechanism, before), (best.mechanism, best.motion)
    old, new = (dense_motion(mechanism, motion, best.modes) for mechanism, motion in both)
    return old, new


def _path(
    axes: Any, panel: ComparedCourse, dense: Sequence[Motion], motions: Sequence[Motion], labels: list[PointLabel]
) -> None:
    """The path of a point before and after, where it is at the poses asked, and the places wanted."""
    for look, curve, motion in zip(LOOKS, dense, motions, strict=True):
        z, at = (np.ravel(quantity(one, panel.name).values) for one in (curve, motion))
        axes.plot(z.real, z.imag, **look)
        if len(at) <= FEW:
            axes.plot(
                at.real, at.imag, linestyle="none", marker="o", markersize=3.5, color=look["color"], label="_poses"
            )
    if panel.wanted is not None:
        axes.plot(panel.wanted.real, panel.wanted.imag, linestyle="none", marker="+", markersize=9, color=COLOURS[1],
                  label="wanted", zorder=6)  # fmt: skip
        labels += _numbers(axes, panel.wanted)
    unit = unit_of(motions[0].mechanism.unit, "length")
    canvas.plane(axes, f"{panel.name}, x [{unit}]", f"y [{unit}]")


LOOKS: tuple[dict[str, Any], ...] = (
    {"color": FAINT, "linestyle": "--", "label": "before"},
    {"color": COLOURS[0], "linestyle": "-", "label": "after"},
)


def _numbers(axes: Any, wanted: Number) -> list[PointLabel]:
    """The numbers of the places in their order, away from their middle."""
    middle = complex(np.mean(wanted))
    away = [complex(z) - middle or 1j for z in wanted[: NUMBERED + 1]]
    if len(wanted) > NUMBERED:
        return []
    return [
        PointLabel(axes, float(z.real), float(z.imag), str(k), towards, GREY)
        for k, (z, towards) in enumerate(zip(wanted, away, strict=True), 1)
    ]


def _course(axes: Any, panel: ComparedCourse, motions: Sequence[Motion]) -> None:
    """A quantity over the driver or time, of a vector its length."""
    last = Plotted(panel.name, "", np.zeros((1, 1)))
    for look, motion in zip(LOOKS, motions, strict=True):
        x, found = along(motion, None)[0], shown(motion, panel.name)
        last = found.parts[-1]
        axes.plot(x.values[0], last.values[0], **look)
    values = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in axes.get_lines()])
    still = canvas.steady(values, last.scale)
    if still is not None:
        axes.set_ylim(*still)
    else:
        axes.margins(y=HEADROOM)
    if np.ptp(x.values) > 0:
        axes.set_xlim(x.values.min(), x.values.max())
    canvas.axis_labels(axes, x, last, canvas.PANEL)
