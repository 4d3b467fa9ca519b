"""`compoundkin solve`: a motion as a table."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.suffixes import alternatives, file_format
from compoundkin.cli.drive_options import drive_options, explain_gaps, names_option, solve_motion
from compoundkin.cli.file_options import load_mechanism, mechanism_argument, put_table, to_file
from compoundkin.cli.shell import put, say

if TYPE_CHECKING:
    from compoundkin.kinematics import Motion


@click.command(
    epilog="""\b
Examples:
  compoundkin solve six-bar --at 35 --output G.velocity,bar.angle
  compoundkin solve six-bar --from 0 --to 360 --step 1 -o six-bar.csv
  compoundkin solve six-bar --speed 300rpm --order 3 -o six-bar.parquet
  compoundkin solve five-bar --drive left=0:90:10 --drive right=90:0:-10
  compoundkin solve crank-rocker --mode coupler=-1 | head -3
  compoundkin solve five-bar-led --forward left,right -o forward.toml
"""
)
@mechanism_argument
@drive_options
@to_file(f"Write a table here: {alternatives('table')}.")
@names_option(
    "--forward",
    "forward",
    "LINK",
    "Write the mechanism driven at these links by the laws of this motion, LINK/ON relative to a link other than the "
    "frame. Repeat it, or write commas.",
)
def command(file: str, path: str | None, forward: tuple[str, ...], **options: Any) -> int:
    """Solve a mechanism and print a table (CSV). It has a row per pose, a column per quantity.

    Without --output, everything there is. Angles are in degrees in CSV and JSON, in radians in NPZ and Parquet.
    Where a pose cannot be assembled its numbers are nan (null in JSON); stderr says why, and the exit code is 3.
    """
    from compoundkin.structure import decompose

    if path is not None:
        file_format("mechanism" if forward else "table", path)
    structure = decompose(load_mechanism(file))
    motion = solve_motion(structure, options)
    if forward:
        return _write_driven(motion, forward, path)
    put_table(motion.table(*options["outputs"]), path)
    return explain_gaps(motion)


def _write_driven(motion: Motion, links: tuple[str, ...], path: str | None) -> int:
    """Write the mechanism driven at some links by laws taken from a motion, or print it as TOML."""
    from compoundkin.files import dumps
    from compoundkin.files.saved_files import save
    from compoundkin.model.elements import Drive
    from compoundkin.model.geometry import FRAME
    from compoundkin.synthesis.inversion import driven_forward

    ends = [(link, on or FRAME) for link, _, on in (name.partition("/") for name in links)]
    result = driven_forward(motion, *(Drive(link, link, on) for link, on in ends))
    if path is None:
        put(dumps(result).encode("utf-8"))
    else:
        save(result, path)
        say(f"Wrote {result.title!r}, driven at {', '.join(links)}, to {path}.")
    return 0
