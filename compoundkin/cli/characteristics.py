"""`compoundkin characteristics`, `compoundkin centres`: strokes, dead points and other figures; instant centres."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import click

from compoundkin.cli.drive_options import AT, DESIGN, drive_options, pose_options, solve_motion, solve_motion_at
from compoundkin.cli.file_options import exit_code, mechanism_argument, put_report, report_options, solvable_structure
from compoundkin.cli.shell import working

if TYPE_CHECKING:
    from compoundkin.kinematics import Motion
    from compoundkin.structure import Structure


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
def centres_command(
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
