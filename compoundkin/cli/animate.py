"""`compoundkin animate`: a motion as an animation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.suffixes import alternatives
from compoundkin.cli.drive_options import (
    ARROWS,
    DESIGN,
    LABELS,
    PATHS,
    drive_options,
    explain_gaps,
    find_forces,
    solve_motion_at,
)
from compoundkin.cli.file_options import load_mechanism, mechanism_argument, to_file
from compoundkin.cli.shell import counting, put, say

if TYPE_CHECKING:
    from compoundkin.base.arrays import Number
    from compoundkin.structure import Structure

# Options that set the drivers' values; without them drivers go through their own ranges.
DRIVEN_BY = ("at", "start", "stop", "step", "drives", "time")
# Options that `animate` of Python takes as they are.
PASSED_ON = ("paths", "vectors", "centres", "labels", "seconds", "fps", "back", "size", "design")


@click.command(
    epilog="""\b
Examples:
  compoundkin animate six-bar -o six-bar.gif
  compoundkin animate jansen-leg --path foot -o leg.svg
  compoundkin animate six-bar --vectors velocity --size 1280 -o six-bar.mp4
  compoundkin animate geneva-wheel --seconds 6 --fps 50 -o geneva.gif
  compoundkin animate crank-rocker --at 0 --speed 9 --time 0:2:0.01 -o a.mp4
  compoundkin animate engine-gas-pressure --forces -o engine.gif
"""
)
@mechanism_argument
@drive_options
@DESIGN
@PATHS
@ARROWS
@click.option("--forces", is_flag=True, help="Draw the forces in pairs, of drivers, loads and inertia, to one scale.")
@click.option("--centres", is_flag=True, help="Draw the instant centres that are on the picture.")
@LABELS
@click.option(
    "--seconds", type=float, metavar="SECONDS", help="How long it takes; about 4, in time as long as it does."
)
@click.option("--fps", type=float, metavar="COUNT", help="Frames a second at most; 25 if left out.")
@click.option("--back/--no-back", default=None, help="Go back the way it came; else where it does not end as it began.")
@click.option("--size", type=float, metavar="PIXELS", help="The longer side.")
@to_file(f"Write a {alternatives('animation')} file; else SVG to stdout.")
def command(file: str, path: str | None, **options: Any) -> int:
    """Animate the motion of a mechanism.

    GIF needs CairoSVG and Pillow, MP4 the program ffmpeg too; SVG needs nothing and moves by itself in a browser. Poses
    that cannot be assembled are left out; stderr says why, and the exit code is 3.
    """
    from compoundkin.structure import decompose
    from compoundkin.view.animation import animate
    from compoundkin.view.animation.animation import ready_for

    if path is not None:
        ready_for(path)
    structure = decompose(load_mechanism(file))
    order = 2 if options["order"] is None else options["order"]
    motion = solve_motion_at(structure, _driver_values(structure, options), {**options, "order": order})
    shown = find_forces(motion, statics=False) if options["forces"] else motion
    animation = animate(shown, **{key: options[key] for key in PASSED_ON})
    if path is None:
        put(animation.svg)
    else:
        with counting("drawing", "frames") as progress:
            animation.save(path, progress)
        say(f"Wrote {path}.")
    return explain_gaps(motion)


def _driver_values(structure: Structure, options: Mapping[str, Any]) -> dict[str, Number]:
    """Return the drivers' values that the options set, else those of their own ranges, refined."""
    from compoundkin.cli import typed_values
    from compoundkin.view.animation.animation import finer_values
    from compoundkin.view.sketch.picture_options import solved_over

    if any(options[key] not in (None, ()) for key in DRIVEN_BY):
        return typed_values.read_driver_values(structure, options)
    own = solved_over(structure)
    return (finer_values(own) if own is not None else None) or {}
