"""Hodographs: vectors drawn from one origin, pose by pose."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics import Motion
from compoundkin.model.attributes import readable
from compoundkin.view.plot import canvas, planar, plot_style
from compoundkin.view.plot.plot_picture import Plot
from compoundkin.view.plot.plotted_rows import all_of

SIZE = (6.0, 5.6)


def hodograph(
    motion: Motion,
    *names: str,
    every: int | None = None,
    designs: Sequence[str] = (),
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw the curves that the tips of vectors run along, all from one origin: "G.velocity".

    Equal scales; a dot every so many poses with the driver's value or the time. Vectors of one plot have one unit.
    Raises UnknownName for names that the motion does not have, InvalidInput for what is no vector or has another unit.
    Source: W. R. Hamilton, The Hodograph (1847).

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> hodograph(solve(load_named("six-bar")), "G.velocity").figure.axes[0].get_xlabel()
    'G.velocity, x [mm/s]'
    """
    vectors = all_of(motion, names)
    for one in vectors:
        if not one.is_vector:
            raise InvalidInput(Problem(one.name, "it is no vector", "a hodograph takes vectors such as G.velocity"))
        if one.unit != vectors[0].unit:
            told = f"its unit is {one.unit}, that of {vectors[0].name} {vectors[0].unit}"
            raise InvalidInput(Problem(one.name, told, "draw them one by one"))
    shared = planar.drawing(motion, designs, every)
    with plot_style.styled():
        figure, axes = canvas.panels(1, motion.mechanism.title if title is None else title, size or SIZE)
        shades: Any = plot_style.colours(len(vectors), shared.designs)
        for k, one in enumerate(vectors):
            for d in range(shared.designs):
                colour = shades[k if shared.designs == 1 else d]
                planar.curve(axes[0], shared, d, one.values[d], colour, one.name)
                planar.marks(axes[0], shared, d, one.values[d], colour, shared.designs == len(vectors) == 1)
        axes[0].plot([0.0], [0.0], marker="+", markersize=11, color=plot_style.INK, linestyle="none", zorder=6)
        unit, names_ = readable(vectors[0].unit), ", ".join(one.name for one in vectors)
        canvas.plane(axes[0], f"{names_}, x [{unit}]", f"y [{unit}]")
        planar.finish(figure, axes, shared, True)
        return canvas.finished(figure, shared.labels)
