"""`compoundkin singularities`: limit positions, change points, dead points, and the branches that meet there."""

from __future__ import annotations

from typing import Any

import click

from compoundkin.cli.drive_options import DESIGN, drive_options, solve_motion
from compoundkin.cli.file_options import exit_code, mechanism_argument, put_report, report_options, solvable_structure
from compoundkin.cli.shell import working


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
def command(file: str, design: int, form: str | None, path: str | None, **options: Any) -> int:
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
