"""`compoundkin configurations`, `circuits`, `singularities`, `workspace`: all ways to assemble, and ways between them.

Each verb has a command of its own here.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.errors import InvalidInput, Problem, UnassembledPoses
from compoundkin.base.suffixes import alternatives, file_format
from compoundkin.cli.drive_options import AT, DESIGN, MODE, drive_options, read_assembly_modes, solve_motion
from compoundkin.cli.file_options import (
    exit_code,
    load_mechanism,
    mechanism_argument,
    put_report,
    report_options,
    solvable_structure,
    to_file,
)
from compoundkin.cli.shell import put, say, working

if TYPE_CHECKING:
    from compoundkin.structure import Structure


@click.command(
    epilog="""\b
Examples:
  compoundkin circuits triple-rocker
  compoundkin circuits five-bar --driver left --at right=100
  compoundkin circuits linkage.toml --driver cylinder --from 20 --to 35
  compoundkin circuits stephenson-iii -o circuits.md
"""
)
@mechanism_argument
@click.option("--driver", "driver", metavar="NAME", help="The driver that moves, where there are several.")
@click.option(
    "--at",
    "at",
    multiple=True,
    metavar="NAME=VALUE",
    help="Where another driver stands, degrees or length; as drawn, or the first of its range, if left out.",
)
@click.option("--from", "start", type=float, metavar="VALUE", help="The least value of the driver.")
@click.option("--to", "stop", type=float, metavar="VALUE", help="The greatest one.")
@report_options
def command(
    file: str,
    driver: str | None,
    at: tuple[str, ...],
    start: float | None,
    stop: float | None,
    form: str | None,
    path: str | None,
) -> int:
    """Find all circuits that a driver moves a mechanism through. Print branches, limits, whether it turns fully.

    On a circuit the mechanism gets from any configuration to any other without being taken apart. A limit position
    comes with the group that reaches its limit there. Exit code 3: the mechanism cannot be assembled.
    """
    from compoundkin.configurations.circuit_search import circuits
    from compoundkin.kinematics.solution import solving_order_of
    from compoundkin.view.report.configurations_section import circuits_report

    structure = solving_order_of(load_mechanism(file)).structure
    fixed = _fixed(structure, at)
    with working("following all circuits"):
        result = circuits_report(
            circuits(structure, driver, fixed, between=driver_range(structure, driver, start, stop))
        )
    put_report(result, form, path)
    return 0


def _fixed(structure: Structure, at: Sequence[str]) -> dict[str, float]:
    """Return the values given for other drivers."""
    from compoundkin.cli import typed_values

    named = {text.rpartition("=")[0] for text in at}
    return {name: value for name, value in typed_values.read_pose(structure, at).items() if name in named} if at else {}


def driver_range(
    structure: Structure, driver: str | None, start: float | None, stop: float | None
) -> tuple[float, float] | None:
    """Return the range of the driver, in radians or lengths."""
    import numpy as np

    if start is None and stop is None:
        return None
    if start is None or stop is None:
        raise InvalidInput(Problem("--from, --to", "a range has two ends", "give both"))
    name = driver or structure.mechanism.drives[0].name
    factor = float(np.deg2rad(1.0)) if structure.driven_angles.get(name, False) else 1.0
    return start * factor, stop * factor


@click.command(
    epilog="""\b
Examples:
  compoundkin singularities parallelogram
  compoundkin singularities triple-rocker --from -180 --to 180
  compoundkin singularities slider-crank --output stroke.value
  compoundkin singularities linkage.toml --format json
"""
)
@mechanism_argument
@drive_options
@DESIGN
@report_options
def singularities_command(file: str, design: int, form: str | None, path: str | None, **options: Any) -> int:
    """List the singular poses of a motion, between its poses too: where they are, of which kind, what opens there.

    They are limit positions of the driver, change points with the branches that meet there, dead points of outputs.
    Outputs are those of --output, or of the file. Exit code 3: some poses cannot be assembled.
    """
    from compoundkin.analysis.singularities import singularities
    from compoundkin.kinematics.one_design import motion_of_design
    from compoundkin.view.report.configurations_section import singularities_report

    structure = solvable_structure(file, form, path)
    motion = motion_of_design(solve_motion(structure, options), design)
    with working("finding singular poses"):
        result = singularities_report(singularities(motion, options["outputs"]))
    put_report(result, form, path)
    return exit_code(result)


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
def workspace_command(
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


@click.command(
    epilog="""\b
Examples:
  compoundkin configurations six-bar --at 35
  compoundkin configurations five-bar --at left=60 --at right=100
  compoundkin configurations class-iii-six-bar --format json
"""
)
@mechanism_argument
@AT
@report_options
def configurations_command(file: str, at: tuple[str, ...], form: str | None, path: str | None) -> int:
    """List all configurations of a mechanism at one pose. It says how many of how many possible, names and angles.

    A name of the list chooses a configuration in Python: solve(..., modes="..."). Exit code 3: there is none.
    """
    from dataclasses import replace

    from compoundkin.cli import typed_values
    from compoundkin.configurations.enumeration import configurations
    from compoundkin.kinematics import solve
    from compoundkin.kinematics.solution import solving_order_of
    from compoundkin.view.report.configurations_section import configurations_report

    structure = solving_order_of(load_mechanism(file)).structure
    driven = typed_values.read_pose(structure, at)
    with working("finding all configurations"):
        result = configurations_report(configurations(structure, driven))
    with warnings.catch_warnings():
        # where there is no configuration, the report says so
        warnings.simplefilter("ignore", UnassembledPoses)
        motion = solve(structure, driven)
    put_report(replace(result, subject=motion), form, path)
    return 0
