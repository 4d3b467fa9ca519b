"""`compoundkin configurations`: every way in which a mechanism can be assembled at one pose."""

from __future__ import annotations

import warnings

import click

from compoundkin.base.errors import UnassembledPoses
from compoundkin.cli.drive_options import AT
from compoundkin.cli.file_options import load_mechanism, mechanism_argument, put_report, report_options
from compoundkin.cli.shell import working


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
def command(file: str, at: tuple[str, ...], form: str | None, path: str | None) -> int:
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
