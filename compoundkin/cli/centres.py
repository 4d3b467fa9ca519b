"""`compoundkin centres`: all instant centres at one pose."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import click

from compoundkin.cli.drive_options import AT, pose_options, solve_motion_at
from compoundkin.cli.file_options import exit_code, mechanism_argument, put_report, report_options, solvable_structure

if TYPE_CHECKING:
    from compoundkin.kinematics import Motion
    from compoundkin.structure import Structure


@click.command(
    epilog="""\b
Examples:
  compoundkin centres six-bar --at 35
  compoundkin centres six-bar --derivation
  compoundkin centres five-bar --at left=60 --at right=100 --speed left=2
  compoundkin centres slider-crank --at 90 -o centres.md
"""
)
@mechanism_argument
@AT
@pose_options
@click.option("--derivation", is_flag=True, help="The steps in order, for any pose; without --at nothing else.")
@report_options
def command(
    file: str, at: tuple[str, ...], design: int, derivation: bool, form: str | None, path: str | None, **options: Any
) -> int:
    """Print the instant centres of every two links at one pose. The velocities that follow from them are added.

    Primary centres, which pairs give, come first; then each secondary one with the two lines that give it.
    Exit code 3: the pose cannot be assembled.
    """
    from dataclasses import replace

    from compoundkin.view.report import Report
    from compoundkin.view.report.centres_section import derivation_section
    from compoundkin.view.report.motion_report import centres_report
    from compoundkin.view.report.report_data import NOT_SOLVED

    structure = solvable_structure(file, form, path)
    result = Report(structure.mechanism.title, (), NOT_SOLVED, structure)
    if at or not derivation:
        result = centres_report(solve_pose(structure, at, options), design)
    if derivation:
        result = replace(result, sections=(derivation_section(structure), *result.sections))
    put_report(result, form, path)
    return exit_code(result)


def solve_pose(structure: Structure, at: Sequence[str], options: Mapping[str, Any], option: str = "--at") -> Motion:
    """Return the motion at one pose, with velocities. Raises InvalidInput for values that do not fit the drivers."""
    from compoundkin.cli import typed_values

    driven = typed_values.read_pose(structure, at, option)
    return solve_motion_at(structure, driven, {"accelerations": (), "outputs": (), "order": 1, **options})
