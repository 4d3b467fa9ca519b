"""Quantities against each other: phase plots, hodographs, polar plots."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.forces import Forces, moved
from compoundkin.kinematics import Motion
from compoundkin.model.attributes import LENGTH, PARTS, readable
from compoundkin.view.plot import canvas, planar, plot_style
from compoundkin.view.plot.plot_style import Plot
from compoundkin.view.plot.plotted_rows import Plotted, all_of, driver, rate_name, shown

# Sizes in inches.
PHASE, HODOGRAPH, POLAR = (6.0, 5.0), (6.0, 5.6), (5.6, 5.8)
# What Matplotlib leaves out of legends begins so.
ZERO = "_zero"
# Where the radii may be written, degrees, between the lines of angles.
FREE_ANGLES = np.arange(15.0, 375.0, 30.0)
# Free space inside the lowest and outside the highest value, as a part of their distance.
MARGIN = 0.08


@checked
def phase(
    motion: Motion | Forces,
    name: str,
    rate: str | None = None,
    *,
    every: int | None = None,
    designs: Sequence[str] = (),
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw a quantity against its rate: "rocker.angle" against "rocker.angular_velocity".

    `rate` is any other quantity to take in place of the rate. A dot every so many poses tells the driver's value or the
    time, the arrow the direction of the motion; designs are a family of curves. Raises UnknownName for names that the
    motion does not have and for quantities without a rate (take a component of a vector: "G.velocity.x"), InvalidInput
    for vectors and where the motion's order is too low.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> picture = phase(solve(load_named("crank-rocker")), "rocker.angle")
    >>> picture.figure.axes[0].get_ylabel()
    'rocker.angular_velocity [rad/s]'
    """
    motion = moved(motion)
    x, y = shown(motion, name), shown(motion, rate or rate_name(motion, name))
    for one in (x, y):
        if one.is_vector:
            raise InvalidInput(Problem(one.name, "it is a vector", f"take a component: {one.name}.{next(iter(PARTS))}"))
    shared = planar.drawing(motion, designs, every)
    with plot_style.styled():
        figure, axes = canvas.panels(1, motion.mechanism.title if title is None else title, size or PHASE)
        shades: Any = plot_style.colours(1, shared.designs)
        for d in range(shared.designs):
            z = x.values[d] + 1j * y.values[d]
            planar.curve(axes[0], shared, d, z, shades[d], shared.called[d])
            planar.marks(axes[0], shared, d, z, shades[d], shared.designs == 1)
        axes[0].margins(0.1)
        canvas.axis_labels(axes[0], x, y, canvas.WHOLE)
        planar.finish(figure, axes, shared, True)
        return canvas.finished(figure, shared.labels)


@checked
def hodograph(
    motion: Motion | Forces,
    *names: str,
    every: int | None = None,
    designs: Sequence[str] = (),
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw the curves of vectors' tips, all from one origin: "G.velocity".

    Equal scales; a dot every so many poses with the driver's value or the time. Vectors of one plot have one unit.
    Raises UnknownName for names that the motion does not have, InvalidInput for what is no vector or has another unit.
    Source: W. R. Hamilton, The Hodograph (1847).

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> hodograph(solve(load_named("six-bar")), "G.velocity").figure.axes[0].get_xlabel()
    'G.velocity, x [mm/s]'
    """
    motion = moved(motion)
    vectors = all_of(motion, names)
    for one in vectors:
        if not one.is_vector:
            raise InvalidInput(Problem(one.name, "it is no vector", "a hodograph takes vectors such as G.velocity"))
        if one.unit != vectors[0].unit:
            told = f"its unit is {one.unit}, that of {vectors[0].name} {vectors[0].unit}"
            raise InvalidInput(Problem(one.name, told, "draw them one by one"))
    shared = planar.drawing(motion, designs, every)
    with plot_style.styled():
        figure, axes = canvas.panels(1, motion.mechanism.title if title is None else title, size or HODOGRAPH)
        planar.curves(axes[0], shared, [one.values for one in vectors], [one.name for one in vectors])
        axes[0].plot([0.0], [0.0], marker="+", markersize=11, color=plot_style.INK, linestyle="none", zorder=6)
        unit, names_ = readable(vectors[0].unit), ", ".join(one.name for one in vectors)
        canvas.plane(axes[0], f"{names_}, x [{unit}]", f"y [{unit}]")
        planar.finish(figure, axes, shared, True)
        return canvas.finished(figure, shared.labels)


@checked
def polar(
    motion: Motion | Forces,
    *names: str,
    around: str | None = None,
    designs: Sequence[str] = (),
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw quantities as radii over an angle: the first driver that moves, or `around`.

    Vectors are drawn by their length. Radii begin at zero, or with negative values below the lowest one; then the zero
    circle is drawn. All quantities of a plot have one unit. Raises UnknownName for names that the motion does not
    have, InvalidInput where units differ or `around` is no angle.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> polar(solve(load_named("crank-shaper")), "E.velocity").figure.axes[0].name
    'polar'
    """
    motion = moved(motion)
    radii = tuple(one.part(LENGTH) if one.is_vector else one for one in all_of(motion, names))
    angle = driver(motion) if around is None else shown(motion, around)
    _check(radii, angle)
    shared = planar.drawing(motion, designs, None)
    with plot_style.styled():
        text = motion.mechanism.title if title is None else title
        figure, axes = canvas.panels(1, text, size or POLAR, subplot_kw={"projection": "polar"})
        shades: Any = plot_style.colours(len(radii), shared.designs)
        for k, one in enumerate(radii):
            for d in range(shared.designs):
                colour = shades[k if shared.designs == 1 else d]
                _line(axes[0], shared, d, angle, one, colour)
        _rings(axes[0], radii)
        axes[0].set_rlabel_position(_free_angle(axes[0]))
        axes[0].set_xlabel(f"{replace(radii[0], name=', '.join(one.name for one in radii)).label} over {angle.label}")
        planar.finish(figure, axes, shared, False)
        return canvas.finished(figure, [])


def _check(radii: Sequence[Plotted], angle: Plotted) -> None:
    if not angle.is_angle:
        raise InvalidInput(Problem(angle.name, "it is no angle", 'name one: around="crank.angle"'))
    for one in radii:
        if one.unit != radii[0].unit:
            told = f"its unit is {one.unit}, that of {radii[0].name} {radii[0].unit}"
            raise InvalidInput(Problem(one.name, told, "draw them one by one"))


def _line(axes: Any, shared: planar.SharedCurves, d: int, angle: Plotted, radius: Plotted, colour: Any) -> None:
    around, out = radius.curve(d, angle)
    axes.plot(np.deg2rad(around), out, color=colour, label=radius.name)
    beside = shared.happened.beside(d, angle.values.shape[1])
    canvas.ring(axes, np.deg2rad(angle.values[d][beside]), radius.values[d][beside], colour)


def _rings(axes: Any, radii: Sequence[Plotted]) -> None:
    """The range of radii and few rings, the zero circle among them where it lies inside."""
    from matplotlib.ticker import MaxNLocator

    values = np.concatenate([one.values[np.isfinite(one.values)] for one in radii])
    scale = max(one.scale for one in radii)
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    low = 0.0 if low >= 0.0 else low
    pad = MARGIN * (high - low) or scale
    axes.set_rlim(low - pad if low < 0.0 else 0.0, high + pad)
    axes.yaxis.set_major_locator(MaxNLocator(4, steps=(1, 2, 2.5, 5, 10)))
    axes.set_thetagrids(range(0, 360, 30))
    axes.tick_params(axis="y", labelcolor=plot_style.GREY)
    axes.spines["polar"].set_color("#c8c8c8")
    if low < 0.0:
        turn = np.linspace(0.0, 2.0 * np.pi, 181)
        axes.plot(turn, np.zeros(len(turn)), color=plot_style.GREY, linewidth=1.0, zorder=0.4, label=ZERO)


def _free_angle(axes: Any) -> float:
    """The angle, of those between the lines of angles, at which the rings are farthest from all curves."""
    low, high = axes.get_ylim()
    rings = np.array([r for r in axes.yaxis.get_majorticklocs() if low < r < high])
    free = np.full(len(FREE_ANGLES), np.inf)
    for line in axes.get_lines():
        known = np.isfinite(line.get_ydata()) & (line.get_label() != ZERO)
        angle, radius = np.asarray(line.get_xdata())[known], np.asarray(line.get_ydata())[known]
        if len(angle) and len(rings):
            apart = np.abs(np.exp(1j * angle) - np.exp(1j * np.deg2rad(FREE_ANGLES))[:, None])
            distance = np.abs(radius[:, None] - rings).min(axis=1) / (high - low)
            free = np.minimum(free, np.min(apart + distance, axis=1))
    return float(FREE_ANGLES[np.argmax(free)])
