"""Results of an optimisation: the motion before and after, and where its searches began and ended."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import TURN, Number
from compoundkin.base.errors import suppress_pose_warnings
from compoundkin.kinematics import Motion, solve
from compoundkin.kinematics.configuration import Configuration
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import POSITION, motion_figure, unit_of
from compoundkin.model.mechanism import Mechanism
from compoundkin.studies.optimisation.optimum import Optimum
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.canvas import HEADROOM, PointLabel
from compoundkin.view.plot.plot_style import COLOURS, FAINT, GREY, INK, Plot
from compoundkin.view.plot.plotted_rows import Plotted, horizontal_axis, plotted_quantity
from compoundkin.view.plot.study_columns import title_with_summary
from compoundkin.view.report.wording import objective_quantity, objective_text

# Heights of a path and of a course, and of all that stands around them, inches.
PATH, COURSE, AROUND = 5.0, 2.2, 1.1
# So many poses at most are dots on a path.
FEW = 40
# Beside so many target points at most stand their numbers.
NUMBERED = 24


@dataclass(frozen=True, eq=False)
class ImprovementPanel:
    """A panel: a quantity before and after; of a point, also its target points."""

    name: str
    is_path: bool
    targets: Number | None = None

    @property
    def height(self) -> float:
        """How high its panel is, inches."""
        return PATH if self.is_path else COURSE


@checked
def improvement(
    optimum: Optimum, *names: str, title: str | None = None, size: tuple[float, float] | None = None
) -> Plot:
    """Draw paths and quantities before and after an optimisation.

    `names` are quantities; without any, those of the goals. Of points the paths are drawn, through a whole turn
    of a driver that turns far, with their target points, numbered in their order; of all else the courses over
    the driver or time. The mechanism before is dashed.

    Raises UnknownName for quantities that are unknown, InvalidInput without Matplotlib.

    >>> from compoundkin.files import load
    >>> from compoundkin.studies.goals.value_goals import least
    >>> from compoundkin.studies.optimisation.design_optimisation import optimise
    >>> free = {"rocker.C.x": (3.5, 4.5)}
    >>> found = optimise(load("crank-rocker"), free, least("rocker.angle.stroke"), starts=4)
    >>> [line.get_label() for line in improvement(found).figure.axes[0].get_lines()]
    ['before', 'after']
    """
    before, after = optimum.before, optimum.motion
    # of the figures of goals the quantities that they are taken from
    aims = [motion_figure(name)[0] for goal in optimum.goals for name in goal.outputs(before)]
    goal_quantities = list(dict.fromkeys(aims))
    panels = [_compared(optimum, name) for name in names or goal_quantities]
    dense = _dense_motions(optimum) if any(panel.is_path for panel in panels) else (before, after)
    labels: list[PointLabel] = []
    with plot_style.styled():
        text = title_with_summary(after.mechanism.title if title is None else title, objective_summary(optimum))
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


def objective_summary(optimum: Optimum) -> str:
    """Return the objective before and after."""
    if not np.isfinite(optimum.value_before):
        return f"objective {objective_text(optimum, optimum.value)}, before not assembled"
    return f"objective {' → '.join(objective_text(optimum, one) for one in (optimum.value_before, optimum.value))}"


def _target_points(optimum: Optimum) -> dict[str, Number]:
    """The target points of the goals, by point."""
    return {point: places for goal in optimum.goals for point, places in goal.places.items()}


def _compared(optimum: Optimum, name: str) -> ImprovementPanel:
    found = quantity(optimum.motion, name)
    point = found.name.removesuffix(f".{POSITION}")
    is_path = found.is_vector and point in optimum.motion.points
    return ImprovementPanel(
        point if is_path else found.name, is_path, _target_points(optimum).get(point) if is_path else None
    )


def _dense_motions(optimum: Optimum) -> tuple[Motion, Motion]:
    best, before = optimum.minima[0], optimum.before
    both = (before.mechanism, before), (best.mechanism, best.motion)
    old, new = (dense_motion(mechanism, motion, best.modes) for mechanism, motion in both)
    return old, new


def _path(
    axes: Any, panel: ImprovementPanel, dense: Sequence[Motion], motions: Sequence[Motion], labels: list[PointLabel]
) -> None:
    """The path of a point before and after, where it is at the poses of the motion, and the target points."""
    for look, curve, motion in zip(LOOKS, dense, motions, strict=True):
        z, at = (np.ravel(quantity(one, panel.name).values) for one in (curve, motion))
        axes.plot(z.real, z.imag, **look)
        if len(at) <= FEW:
            axes.plot(
                at.real, at.imag, linestyle="none", marker="o", markersize=3.5, color=look["color"], label="_poses"
            )
    if panel.targets is not None:
        axes.plot(panel.targets.real, panel.targets.imag, linestyle="none", marker="+", markersize=9, color=COLOURS[1],
                  label="wanted", zorder=6)  # fmt: skip
        labels += _numbers(axes, panel.targets)
    unit = unit_of(motions[0].mechanism.unit, "length")
    canvas.plane_axes(axes, f"{panel.name}, x [{unit}]", f"y [{unit}]")


LOOKS: tuple[dict[str, Any], ...] = (
    {"color": FAINT, "linestyle": "--", "label": "before"},
    {"color": COLOURS[0], "linestyle": "-", "label": "after"},
)


def _numbers(axes: Any, targets: Number) -> list[PointLabel]:
    """The numbers of the places in their order, away from their middle."""
    middle = complex(np.mean(targets))
    away = [complex(z) - middle or 1j for z in targets[: NUMBERED + 1]]
    if len(targets) > NUMBERED:
        return []
    return [
        PointLabel(axes, float(z.real), float(z.imag), str(k), towards, GREY)
        for k, (z, towards) in enumerate(zip(targets, away, strict=True), 1)
    ]


def _course(axes: Any, panel: ImprovementPanel, motions: Sequence[Motion]) -> None:
    """A quantity over the driver or time, of a vector its length."""
    last = Plotted(panel.name, "", np.zeros((1, 1)))
    for look, motion in zip(LOOKS, motions, strict=True):
        x, found = horizontal_axis(motion, None)[0], plotted_quantity(motion, panel.name)
        last = found.parts[-1]
        axes.plot(x.values[0], last.values[0], **look)
    values = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in axes.get_lines()])
    canvas.set_vertical_margins(axes, values, last.scale, HEADROOM)
    if np.ptp(x.values) > 0:
        axes.set_xlim(x.values.min(), x.values.max())
    canvas.axis_labels(axes, x, last, canvas.PANEL)


SIZE = (7.0, 4.2)
# Objectives that differ by this factor are drawn by their powers of ten.
FAR = 50.0
# An objective that is nothing is drawn at this part of the least that is something.
BELOW = 0.1


@checked
def starts(optimum: Optimum, *, title: str | None = None, size: tuple[float, float] | None = None) -> Plot:
    """Draw at which objectives the searches of an optimum began and ended.

    The best come first. Where many ended at the best objective, one can be surer of it. Searches that ended where
    constraints do not hold as well as at the best are crosses where they began. Raises InvalidInput without Matplotlib.

    >>> from compoundkin.files import load
    >>> from compoundkin.studies.goals.value_goals import least
    >>> from compoundkin.studies.optimisation.design_optimisation import optimise
    >>> free = {"rocker.C.x": (3.5, 4.5)}
    >>> found = optimise(load("crank-rocker"), free, least("rocker.angle.stroke"), starts=4)
    >>> starts(found).figure.axes[0].get_xlabel()
    'searches, the best first'
    """
    with plot_style.styled():
        said = f"{optimum.agreed:,} of {optimum.starts:,} searches agree"
        text = title_with_summary(optimum.motion.mechanism.title if title is None else title, said)
        figure, (axes,) = canvas.panels(1, text, size or SIZE)
        _draw(axes, optimum)
        axes.set_xlabel("searches, the best first")
        axes.set_ylabel(objective_quantity(optimum, 0.0).label)
        canvas.legend_below(figure, axes.get_legend_handles_labels()[0])
        return canvas.finished(figure, ())


def _draw(axes: Any, optimum: Optimum) -> None:
    from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator

    order = np.argsort(np.where(np.isfinite(optimum.ended), optimum.ended, np.inf), kind="stable")
    begun, ended = (objective_quantity(optimum, own[order]).values for own in (optimum.begun, optimum.ended))
    before = float(objective_quantity(optimum, optimum.value_before).values)
    least = _least(np.concatenate([begun, ended, [before]]))
    ranks = np.arange(1, len(begun) + 1)
    lost = ~np.isfinite(ended)
    low = np.maximum(ended, least) if least is not None else ended
    axes.vlines(ranks[~lost], low[~lost], begun[~lost], color=FAINT, linewidth=0.8, zorder=1.5)
    dots: dict[str, Any] = {"linestyle": "none", "clip_on": False, "zorder": 3}
    axes.plot(ranks[~lost], begun[~lost], marker="o", markersize=3.0, color=FAINT, label="began", **dots)
    axes.plot(ranks[~lost], low[~lost], marker="o", markersize=4.5, color=COLOURS[0], label="ended", **dots)
    if lost.any():
        axes.plot(
            ranks[lost], begun[lost], marker="x", markersize=4.5, color=GREY, label="constraints do not hold", **dots
        )
    if np.isfinite(before):
        said = f"before: {objective_text(optimum, optimum.value_before)}"
        axes.axhline(before, color=INK, linestyle="--", linewidth=1.0, label=said)
    if least is not None:
        axes.set_yscale("log")
        # powers of ten as numbers: the style of the house reads no formulas
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.set_xlim(0.5, len(begun) + 0.5)
    few = len(begun) <= canvas.ACROSS
    axes.xaxis.set_major_locator(FixedLocator(ranks.tolist()) if few else MaxNLocator(canvas.ACROSS, integer=True))


def _least(values: Number) -> float | None:
    """The least that is drawn by powers of ten; None where objectives are drawn as they are."""
    known = values[np.isfinite(values)]
    some = known[known > 0.0]
    if not len(some) or (known < 0.0).any() or known.max() <= FAR * some.min():
        return None
    return float(some.min()) * (BELOW if (known == 0.0).any() else 1.0)


# So many poses make a smooth curve.
POSES = 361
# A driver that turns through more than this is shown over its whole turn, rad.
MUCH = np.pi / 2.0


def dense_motion(mechanism: Mechanism, motion: Motion, modes: str | Configuration) -> Motion:
    """Solve a mechanism at many poses between those of a motion.

    A single driver that turns far goes through its whole turn; poses that cannot be assembled are gaps.
    """
    with suppress_pose_warnings():
        if motion.time is not None:
            times = np.ravel(motion.time)
            return solve(mechanism, time=np.linspace(times.min(), times.max(), POSES), modes=modes, order=0)
        values = {name: _refined_values(np.ravel(drive.value)) for name, drive in motion.drives.items()}
        if len(values) == 1:
            (name,) = values
            if motion.drives[name].is_angle and np.ptp(values[name]) > MUCH:
                begin = float(np.ravel(motion.drives[name].value)[0])
                values = {name: begin + np.linspace(0.0, TURN, POSES)}
        return solve(mechanism, values, modes=modes, order=0)


def _refined_values(values: Number) -> Number:
    """Values between those of some poses."""
    if len(values) < 2:
        return np.asarray(values)
    return np.interp(np.linspace(0.0, len(values) - 1.0, POSES), np.arange(len(values)), values)
