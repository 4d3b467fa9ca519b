"""`compoundkin forces`: what acts in all pairs or on a link, drivers' efforts, what the frame is shaken by."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.suffixes import SUFFIXES, file_format, suffix_of
from compoundkin.cli.drive_options import DESIGN, HOLDING, STATICS, drive_options, find_forces, solve_motion
from compoundkin.cli.file_options import (
    load_mechanism,
    mechanism_argument,
    put_report,
    put_table,
    report_or_table_options,
)
from compoundkin.cli.shell import NOT_ASSEMBLED
from compoundkin.cli.solve import explain_gaps
from compoundkin.cli.structure import report_unsolvable

if TYPE_CHECKING:
    from compoundkin.dynamics.forces import Forces
    from compoundkin.view.report import Report

ON = click.option("--on", "on", default="", metavar="LINK", help="Print all that acts on a link: its free body.")


@click.command(
    epilog="""\b
Examples:
  compoundkin forces linkage.toml
  compoundkin forces linkage.toml --speed 300rpm --step 1
  compoundkin forces linkage.toml --at 35 --statics
  compoundkin forces linkage.toml --at 35 --on rod
  compoundkin forces linkage.toml --output crank.effort,A.force -o forces.csv
  compoundkin forces linkage.toml -o forces.md
"""
)
@mechanism_argument
@drive_options
@DESIGN
@STATICS
@HOLDING
@ON
@report_or_table_options
def command(
    file: str, design: int, statics: bool, holding: str, on: str, form: str | None, path: str | None, **asked: Any
) -> int:
    """Print forces in all pairs, efforts of drivers, the force on the frame.

    The mechanism states its units of length, mass and force, and has masses or loads. What is assumed comes first.
    With --output or -o PATH.csv it is a table with a row per pose. Exit code 3: some poses cannot be assembled.
    """
    from compoundkin.structure import decompose
    from compoundkin.view.report import report

    tabulated = is_force_table(form, path, on, asked["outputs"])
    structure = decompose(load_mechanism(file))
    if structure.faults:
        put_report(report(structure), form, path if not tabulated else None)
        return report_unsolvable(len(structure.faults))
    if on:
        structure.mechanism.link(on)
    forces = find_forces(solve_motion(structure, asked), statics, holding)
    if not tabulated:
        return _put_forces_report(forces, design, on, form, path)
    put_table(forces.table(*asked["outputs"]), path)
    return 0 if forces.motion.assembled.all() else explain_gaps(forces.motion)


def is_force_table(form: str | None, path: str | None, on: str, outputs: tuple[str, ...]) -> bool:
    """Tell whether a table is asked for. Raises InvalidInput for options that exclude each other, and suffixes."""
    from compoundkin.base.errors import InvalidInput, Problem

    only_table = path is not None and suffix_of(path) in SUFFIXES["table"].keys() - SUFFIXES["report"].keys()
    tabulated = bool(outputs) or (only_table and form is None and not on)
    other = f"--format {form}" if form else f"--on {on}" if on else ""
    if tabulated and other:
        raise InvalidInput(Problem(other, "it does not go with --output, which is a table", "leave one of them out"))
    if path is not None and (tabulated or form is None):
        file_format("table" if tabulated else "report", path)
    return tabulated


def _put_forces_report(forces: Forces, design: int, on: str, form: str | None, path: str | None) -> int:
    """Print or write the report, and return the exit code."""
    from compoundkin.cli.shell import working
    from compoundkin.view.report.forces_section import forces_report

    with working("finding extremes"):
        made = forces_report(forces, design, on)
    put_report(made, form, path)
    return _exit_code(made)


def _exit_code(made: Report) -> int:
    """Return the exit code where some poses cannot be assembled."""
    return NOT_ASSEMBLED if made.outcome.assembled < made.outcome.poses else 0
