"""`plot`: quantities over the driver, the time or any other quantity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from compoundkin.base.arguments import checked
from compoundkin.dynamics.forces import Forces, moved
from compoundkin.kinematics import Motion
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.axis_scales import AxisScales
from compoundkin.view.plot.plot_style import Plot
from compoundkin.view.plot.plotted_motions import called, plotted
from compoundkin.view.plot.point_labels import PointLabel
from compoundkin.view.plot.quantity_panels import QuantityPanel, across, legends

FIRST, EACH = 2.0, 2.0


@checked
def plot(
    motion: Motion | Forces | Sequence[Motion | Forces],
    *names: str,
    against: str | None = None,
    stacked: bool = True,
    extremes: bool | None = None,
    designs: Sequence[str] = (),
    xlim: tuple[float, float] | None = None,
    ylim: tuple[float, float] | None = None,
    log: str | None = None,
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw quantities of a motion or its forces over driver, time or others.

    `names` as `quantity` takes them ("G.velocity", "crank.effort"), also "G.velocity.x", "G.velocity.length"; a vector
    is drawn as its components and its length; none means the mechanism's outputs.
    `against` is "time", "driver", "pose" or a quantity; without it the time of a motion in time, else the first driver
    that moves. Every quantity has a panel of its own; with ``stacked=False`` those of one unit share one. Angles are in
    degrees. The highest and lowest values are marked, between poses too, unless `extremes` is False or there are many
    curves; where a derivative jumps, the curve does; between poses it is solved, so that it is smooth. Designs are a
    family of curves, called `designs` if that is given; so are several motions, whose quantities have one unit.
    `xlim` and `ylim` are the ends of the axes in the units that are shown, `log` is "x", "y" or "xy". `size` is in
    inches.

    What cannot be assembled is shaded, poses next to limit positions are ringed, change points dashed. Raises
    UnknownName for names that the motion does not have, InvalidInput for a motion of a single pose, a vector to draw
    against, units that differ, a logarithmic axis of values that are not positive, or without Matplotlib.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> picture = plot(solve(load_named("six-bar")), "bar.angle", "G.velocity")
    >>> [axes.get_ylabel() for axes in picture.figure.axes]
    ['bar.angle [deg]', 'G.velocity [mm/s]']
    """
    motions = [moved(one) for one in ([motion] if isinstance(motion, Motion | Forces) else motion)]
    known, scales = called(motions, tuple(designs)), AxisScales.asked(xlim, ylim, log)
    drawn = plotted(motions, names, against, stacked)
    panels = [QuantityPanel(drawn, k, scales, extremes) for k in range(len(drawn[0].panels))]
    scales.hold(
        [one.x for one in drawn], [one.title for one in panels], [curve for one in panels for curve in one.curves]
    )
    heading = (motions[0].mechanism.title if len(motions) == 1 else "") if title is None else title
    with plot_style.styled():
        height = FIRST + EACH * len(panels)
        figure, axes = canvas.panels(len(panels), heading, size or (canvas.WIDTH, height), sharex=True)
        across(axes[0], drawn, scales)
        labels = _draw(axes, panels, scales)
        legends(figure, axes, drawn, known)
        return canvas.finished(figure, labels)


def _draw(axes: Sequence[Any], panels: Sequence[QuantityPanel], scales: AxisScales) -> list[PointLabel]:
    """Draw the panels, and return the labels that are to be placed."""
    labels: list[PointLabel] = []
    for one, panel in zip(axes, panels, strict=True):
        scales.make_log(one)
        panel.draw(one, labels)
        canvas.axis_labels(one, panel.across if one is axes[-1] else None, panel.title, canvas.PANEL)
        scales.ticks(one)
        panel.events(one)
    return labels
