"""`compoundkin characteristics`: strokes, dead points, time ratios, transmission and other figures of a motion."""

from __future__ import annotations

from typing import Any

import click

from compoundkin.cli.drive_options import DESIGN, drive_options, solve_motion
from compoundkin.cli.file_options import exit_code, mechanism_argument, put_report, report_options, solvable_structure
from compoundkin.cli.shell import working


@click.command(
    epilog="""\b
Examples:
  compoundkin characteristics crank-shaper
  compoundkin characteristics toggle-press --output press.value --dwell 0.02
  compoundkin characteristics hoecken-straight-line --straight 0.0005
  compoundkin characteristics linkage.toml --from 0 --to 180 --format json
  compoundkin characteristics whitworth-quick-return -o figures.md
"""
)
@mechanism_argument
@drive_options
@DESIGN
@click.option("--dwell", type=float, metavar="PART", help="A dwell stays within this part of the stroke (0.01).")
@click.option("--straight", type=float, metavar="PART",
              help="A straight stretch stays within this part of the path's extent (0.001).")  # fmt: skip
@report_options
def command(
    file: str,
    design: int,
    dwell: float | None,
    straight: float | None,
    form: str | None,
    path: str | None,
    **options: Any,
) -> int:
    """Print the figures of a motion that engineers ask for.

    They are stroke, dead points, time ratio, transmission, advantage, dwells and features of paths. All are solved for
    between the poses too. Outputs are those of --output, or of the file. Exit code 3: some poses cannot be assembled;
    the figures are then of those that can.
    """
    from compoundkin.view.report.performance_section import characteristics_report

    structure = solvable_structure(file, form, path)
    motion = solve_motion(structure, options)
    with working("finding extremes"):
        result = characteristics_report(motion, options["outputs"], design, dwell, straight)
    put_report(result, form, path)
    return exit_code(result)
