"""Phase plots: a quantity against its rate."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics import Motion
from compoundkin.view.plot import canvas, planar, plot_style
from compoundkin.view.plot.plot_picture import Plot
from compoundkin.view.plot.plotted_rows import rate_name, shown

SIZE = (6.0, 5.0)


def phase(
    motion: Motion,
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
    x, y = shown(motion, name), shown(motion, rate or rate_name(motion, name))
    for one in (x, y):
        if one.is_vector:
            raise InvalidInput(Problem(one.name, "it is a vector", f"take a component: {one.name}.x"))
    shared = planar.drawing(motion, designs, every)
    with plot_style.styled():
        figure, axes = canvas.panels(1, motion.mechanism.title if title is None else title, size or SIZE)
        shades: Any = plot_style.colours(1, shared.designs)
        for d in range(shared.designs):
            z = x.values[d] + 1j * y.values[d]
            planar.curve(axes[0], shared, d, z, shades[d], shared.called[d])
            planar.marks(axes[0], shared, d, z, shades[d], shared.designs == 1)
        axes[0].margins(0.1)
        canvas.axis_labels(axes[0], x, y, canvas.WHOLE)
        planar.finish(figure, axes, shared, True)
        return canvas.finished(figure, shared.labels)
