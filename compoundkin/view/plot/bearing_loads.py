"""Polar diagrams of bearing loads: the tip of a pair's force, in the frame and as its links see it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.dynamics.forces import Forces
from compoundkin.kinematics import Motion
from compoundkin.model.attributes import FORCE
from compoundkin.model.elements import FRAME
from compoundkin.view.plot import canvas, planar, plot_style
from compoundkin.view.plot.plot_style import Plot

# So wide and high is a panel, inches.
PANEL, HEIGHT = 4.6, 5.0


@checked
def bearing_loads(
    motion: Motion | Forces,
    *pairs: str,
    every: int | None = None,
    designs: Sequence[str] = (),
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw polar diagrams of bearing loads, the force on each pair's second link.

    A panel shows the force in the frame, another one in the axes of each moving link of the pair, where it tells on
    which side a journal or a bush is worn; in the first link's axes it is the opposite force, which acts on that link.
    `pairs` are names; several are in one panel in the frame's axes only. A dot every so many poses has the driver's
    value or the time.

    Raises UnknownName for pairs that there are not, InvalidInput where none is named. Source: polar load diagrams of
    engine bearings, e.g. C. F. Taylor, The Internal-Combustion Engine in Theory and Practice.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.loads import gravity, mass
    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.kinematics import solve
    >>> items = link("frame", A=0), link("crank", A=0, B=2), drive("crank"), mass("crank", 1.0, at="B")
    >>> units = {"length": "m", "mass": "kg", "force": "N"}
    >>> picture = bearing_loads(solve(Mechanism("m", *items, gravity(0, -9.81), units=units), speed=3.0), "A")
    >>> [axes.get_title() for axes in picture.figure.axes]
    ['in the frame', 'in the axes of crank']
    """
    if not pairs:
        raise InvalidInput(Problem("pairs", "no pair is named", 'name some: bearing_loads(forces, "A")'))
    forces = motion if isinstance(motion, Forces) else motion.forces
    panels = _panels(forces, pairs)
    shared = planar.drawing(forces.motion, designs, every)
    with plot_style.styled():
        text = forces.mechanism.title if title is None else title
        figure, axes = canvas.panels(1, text, size or (PANEL * len(panels), HEIGHT), columns=len(panels))
        unit = forces.units.force
        for one, (said, drawn) in zip(axes, panels, strict=True):
            planar.curves(one, shared, drawn, [f"{name}.{FORCE}" for name in pairs])
            one.plot([0.0], [0.0], marker="+", markersize=11, color=plot_style.INK, linestyle="none", zorder=6)
            canvas.plane(one, f"{', '.join(pairs)}: force, x [{unit}]", f"y [{unit}]")
            one.set_title(said, fontsize="medium")
        planar.finish(figure, axes, shared, True)
        return canvas.finished(figure, shared.labels)


def _panels(forces: Forces, pairs: Sequence[str]) -> list[tuple[str, list[Number]]]:
    """What each panel is called, and its curves, (designs, poses)."""
    rows = [_rows(forces, forces.pairs[name].force) for name in pairs]
    found = [("in the frame", rows)]
    if len(pairs) > 1:
        return found
    held = forces.pairs[pairs[0]]
    for side, link in enumerate(held.pair.members[:2]):
        if link != FRAME:
            turned = _rows(forces, np.exp(-1j * np.asarray(forces.links[link].angle)))
            found.append((f"in the axes of {link}", [(rows[0] if side else -rows[0]) * turned]))
    return found


def _rows(forces: Forces, values: Number) -> Number:
    return np.broadcast_to(np.asarray(values), forces.shape).reshape(forces.inputs.designs, -1)
