"""Workspaces: the region that a point reaches, its boundary, singular curves, and the mechanism in one pose."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, degrees, first_entry
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.configurations.workspace import Workspace
from compoundkin.kinematics import Motion
from compoundkin.model.attributes import unit_of
from compoundkin.model.geometry import FRAME
from compoundkin.view.plot import canvas, plot_style
from compoundkin.view.plot.canvas import PointLabel
from compoundkin.view.plot.plot_style import COLOURS, GREY, INK, Plot

SIZE = (7.0, 6.2)
# The region is shaded, the mechanism stands behind it.
REGION, MECHANISM = "#d7e8f3", "#9a9a9a"
# What the region may be coloured by.
CONDITION = "condition"
# Condition numbers above this are drawn in one colour.
WORST = 20.0


@checked
def workspace(
    region: Workspace,
    *,
    colour: str | None = None,
    singular: bool = True,
    title: str | None = None,
    size: tuple[float, float] | None = None,
) -> Plot:
    """Draw a workspace. The region is shaded, with its boundary and the mechanism in one pose.

    Curves of configurations that are singular for the drivers are dashed, unless `singular` is
    False. With ``colour="condition"`` the region is coloured by the condition number of the Jacobian. Raises
    InvalidInput for another colour.

    >>> from compoundkin.configurations.workspace import workspace as region_of
    >>> from compoundkin.files import load
    >>> picture = workspace(region_of(load("five-bar"), "P", cells=40))
    >>> [line.get_label() for line in picture.figure.axes[0].get_lines()[-1:]]
    ['outer boundary']
    """
    if colour not in (None, CONDITION):
        what = f"a workspace cannot be coloured by {colour!r}"
        raise InvalidInput(Problem("colour", what, f"give {CONDITION!r}, or leave it out"))
    labels: list[PointLabel] = []
    with plot_style.styled():
        figure, (axes, *_) = canvas.panels(1, _title(region) if title is None else title, size or SIZE)
        _region(figure, axes, region, colour)
        _mechanism(axes, region.pose, region.point, labels)
        if singular:
            _singular(axes, region)
        for kind, curves, shade in (("inner", region.inner, COLOURS[1]), ("outer", region.outer, COLOURS[0])):
            for k, curve in enumerate(curves):
                axes.plot(curve.real, curve.imag, color=shade, label="" if k else f"{kind} boundary", zorder=4)
        unit = unit_of(region.mechanism.unit, "length")
        canvas.plane_axes(axes, f"x [{unit}]", f"y [{unit}]")
        canvas.draw_legend(axes)
        return canvas.finished(figure, labels)


def _title(region: Workspace) -> str:
    turned = "" if region.orientation is None else f", {region.link} at {degrees(region.orientation):.6g}°"
    return f"{region.mechanism.title}: workspace of {region.point}{turned}"


def _region(figure: Any, axes: Any, region: Workspace, colour: str | None) -> None:
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    curves = [Path(np.stack([c.real, c.imag], axis=-1), closed=True) for c in (*region.outer, *region.inner)]
    outline = Path.make_compound_path(*curves)
    patch = PathPatch(outline, facecolor=REGION, edgecolor="none", zorder=0.5)
    axes.add_patch(patch)
    axes.autoscale_view()
    if colour is None:
        return
    x, y = region.places[0].real, region.places[:, 0].imag
    values = np.minimum(region.condition, WORST)
    shown = axes.pcolormesh(x, y, values, cmap="viridis_r", vmin=1.0, vmax=WORST, shading="nearest", zorder=0.6,
                            rasterized=True)  # fmt: skip
    shown.set_clip_path(patch)
    bar = figure.colorbar(shown, ax=axes, aspect=35, pad=0.02, extend="max")
    bar.set_label("condition number")
    bar.outline.set_visible(False)


def _singular(axes: Any, region: Workspace) -> None:
    """Draw the curves of zero determinants, dashed."""
    x, y = region.places[0].real, region.places[:, 0].imag
    drawn = False
    for values in region.determinants:
        known = values[np.isfinite(values)]
        if known.size and known.min() < 0.0 < known.max():
            axes.contour(x, y, values, levels=[0.0], colors=[INK], linestyles="dashed", linewidths=1.0, zorder=3)
            drawn = True
    if drawn:
        axes.plot([], [], color=INK, linestyle="--", linewidth=1.0, label="drivers lose their hold")


def _mechanism(axes: Any, pose: Motion, point: str, labels: list[PointLabel]) -> None:
    """Draw links as outlines of their points, guides as lines, pins as rings, and the point with its letter."""
    for outline in (*_links(pose), *_guides(pose)):
        axes.plot(outline.real, outline.imag, color=MECHANISM, linewidth=1.6, zorder=2, solid_joinstyle="round")
    for letter in pose.mechanism.pins:
        z = _place(pose, letter)
        on_frame = letter in pose.mechanism.links[FRAME].points
        axes.plot([z.real], [z.imag], marker="o", markersize=5, color=MECHANISM, zorder=2.5, linestyle="none",
                  markerfacecolor=MECHANISM if on_frame else "white")  # fmt: skip
    z = _place(pose, point)
    canvas.draw_dots(axes, [z.real], [z.imag], INK, 5.0)
    labels.append(PointLabel(axes, z.real, z.imag, point, 1 + 1j, GREY))


def _links(pose: Motion) -> Iterator[Number]:
    for name, link in pose.mechanism.links.items():
        if name != FRAME and len(link.points) > 1:
            corners = np.array([_place(pose, letter) for letter in link.points])
            order = np.argsort(np.angle(corners - np.mean(corners)))
            yield np.append(corners[order], corners[order][:1])


def _guides(pose: Motion) -> Iterator[Number]:
    for pair in pose.mechanism.written_pairs:
        known = [letter for letter in pair.letters if letter in pose.mechanism.carriers]
        if pair.is_simple and not pair.free_is_angle and len(known) > 1:
            yield np.array([_place(pose, letter) for letter in known[:2]])


def _place(pose: Motion, letter: str) -> complex:
    return complex(first_entry(np.asarray(pose.points[letter].position)))
