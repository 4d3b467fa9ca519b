"""`compoundkin forces`: what acts in all pairs, drivers' efforts, and what the frame is shaken by."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from compoundkin.cli.drive_options import DESIGN, drive_options, solved
from compoundkin.cli.file_options import loaded, mechanism_argument, put_report, report_options
from compoundkin.cli.force_options import HOLDING, STATICS, forces_of
from compoundkin.cli.shell import NOT_ASSEMBLED
from compoundkin.cli.structure import unsolvable

if TYPE_CHECKING:
    from compoundkin.view.report import Report


@click.command(
    epilog="""\b
Examples:
  compoundkin forces linkage.toml
  compoundkin forces linkage.toml --speed 300rpm --step 1
  compoundkin forces linkage.toml --at 35 --statics
  compoundkin forces linkage.toml -o forces.md
"""
)
@mechanism_argument
@drive_options
@DESIGN
@STATICS
@HOLDING
@report_options
def command(
    file: str, design: int, statics: bool, holding: str, form: str | None, path: str | None, **asked: Any
) -> int:
    """Print forces in all pairs, efforts of drivers, the force on the frame.

    The mechanism states its units of length, mass and force, and has masses or loads. What is assumed comes first.
    Exit code 3: some poses cannot be assembled.
    """
    from compoundkin.cli.progress import working
    from compoundkin.structure import decompose
    from compoundkin.view.report import report
    from compoundkin.view.report.forces_section import forces_report

    structure = decompose(loaded(file))
    if structure.faults:
        put_report(report(structure), form, path)
        return unsolvable(len(structure.faults))
    forces = forces_of(solved(structure, asked), statics, holding)
    with working("finding extremes"):
        made = forces_report(forces, design)
    put_report(made, form, path)
    return _missing(made)


def _missing(made: Report) -> int:
    """Return the exit code where some poses cannot be assembled."""
    return NOT_ASSEMBLED if made.outcome.assembled < made.outcome.poses else 0
