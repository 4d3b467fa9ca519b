"""`compoundkin workspace`: the region that a point reaches, as numbers or as a picture."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import alternatives, file_format
from compoundkin.cli.drive_options import MODE, read_assembly_modes
from compoundkin.cli.file_options import load_mechanism, mechanism_argument, to_file
from compoundkin.cli.shell import put, say, working

if TYPE_CHECKING:
    from compoundkin.configurations.workspace import Workspace
    from compoundkin.structure import Structure


@click.command(
    epilog="""\b
Examples:
  compoundkin workspace five-bar P
  compoundkin workspace five-bar P --drive left=60:180 -o five-bar.png
  compoundkin workspace hydraulic-digger M --condition -o digger.svg
  compoundkin workspace 3-rrr P --orientation 0 -o 3-rrr.pdf
"""
)
@mechanism_argument
@click.argument("point")
@click.option("--drive", "drives", multiple=True, metavar="NAME=LOW:HIGH",
              help="The range of a driver, degrees or lengths; a full turn or a stroke if left out.")  # fmt: skip
@click.option("--orientation", type=float, metavar="DEGREES", help="The angle of the point's link; any if left out.")
@MODE
@click.option("--every-mode", is_flag=True, help="Every assembly mode, not only that of the drawing.")
@click.option("--cells", type=int, metavar="NUMBER", help="How many cells go along the region.")
@click.option("--condition", is_flag=True, help="Colour the picture by the condition number.")
@click.option("--title", help="Instead of the mechanism's own.")
@to_file(f"Draw it in a {alternatives('plot')} file.")
def command(
    file: str, point: str, drives: tuple[str, ...], modes: tuple[str, ...], path: str | None, **options: Any
) -> int:
    """Print the region that a point reaches by two or three drivers: its area, extent and boundary.

    With -o it is drawn: the outer and inner boundary, singular curves, the mechanism.
    """
    from math import radians

    from compoundkin.configurations.workspace import EVERY_MODE, workspace
    from compoundkin.kinematics.solution import solving_order_of

    if path is not None:
        file_format("plot", path)
    if options["every_mode"] and modes:
        raise InvalidInput(Problem("--every-mode", "--mode says which one", "leave one of them out"))
    structure = solving_order_of(load_mechanism(file)).structure
    chosen = EVERY_MODE if options["every_mode"] else read_assembly_modes(structure, modes)
    turned = None if options["orientation"] is None else radians(options["orientation"])
    ranges = driver_ranges(structure, drives)
    with working("computing the workspace"):
        found = workspace(structure, point, ranges, orientation=turned, modes=chosen, cells=options["cells"])
    put("\n".join(workspace_lines(found)) + "\n")
    if path is not None:
        with working("drawing"):
            found.plot(colour="condition" if options["condition"] else None, title=options["title"]).save(path)
        say(f"Wrote {path}.")
    return 0


def driver_ranges(structure: Structure, given: Sequence[str]) -> dict[str, tuple[float, float]]:
    """Return the ranges of drivers, radians or lengths, from texts NAME=LOW:HIGH."""
    from math import radians

    from compoundkin.cli import typed_values

    found = {}
    for text in given:
        name, _, span = text.rpartition("=")
        parts = span.split(":")
        if not name or len(parts) != 2:
            raise InvalidInput(Problem(f"--drive {text}", "this is no range", "write NAME=LOW:HIGH, such as left=0:90"))
        low, high = (typed_values.read_number(part, f"--drive {text}") for part in parts)
        is_angle = structure.driven_angles.get(name, False)
        found[name] = (radians(low), radians(high)) if is_angle else (low, high)
    return found


def workspace_lines(found: Workspace) -> list[str]:
    """Return the description of a workspace, line by line."""
    from math import degrees

    import numpy as np

    unit = found.mechanism.unit
    length, area = (f" {unit}", f" {unit}²") if unit else ("", "")
    outline = np.concatenate(found.outer)
    x, y = ((float(np.min(part)), float(np.max(part))) for part in (outline.real, outline.imag))
    angles = found.reach.prescribed.driven.structure.driven_angles
    spans = []
    for name in found.drivers:
        low, high = found.ranges.get(name, (0.0, 2.0 * np.pi))
        is_angle, sign = angles[name], "°" if angles[name] else length
        spans.append(
            f"{name} {degrees(low) if is_angle else low:.6g} to {degrees(high) if is_angle else high:.6g}{sign}"
        )
    return [
        f"{found.mechanism.title}: workspace of {found.point}",
        f"  drivers: {'; '.join(spans)}",
        f"  in {found.modes}"
        + ("" if found.orientation is None else f", {found.link} at {degrees(found.orientation):.6g}°"),
        f"  area {found.area:.4g}{area}; x {x[0]:.4g} to {x[1]:.4g}{length}, y {y[0]:.4g} to {y[1]:.4g}{length}",
        f"  boundary: {len(found.outer)} outer, {len(found.inner)} inner;"
        f" corners and details within {found.step:.2g}{length}",
    ]
