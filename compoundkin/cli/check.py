"""`compoundkin check`: what verifies a motion, as a table."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from compoundkin.cli.drive_options import drive_options, solve_motion
from compoundkin.cli.file_options import exit_code, mechanism_argument, put_report, report_options, solvable_structure
from compoundkin.cli.shell import FAILED, say, working

if TYPE_CHECKING:
    from compoundkin.view.report import Report


@click.command(
    epilog="""\b
Examples:
  compoundkin check six-bar
  compoundkin check six-bar --order 3
  compoundkin check linkage.toml --from 0 --to 90 --step 0.5 --format json
"""
)
@mechanism_argument
@drive_options
@report_options
def command(file: str, form: str | None, path: str | None, **options: Any) -> int:
    """Verify a motion and print a table of all findings. It is independent of the formulas that solved it.

    Outlines of links are compared too. Exit code 3: some poses cannot be assembled; 4: a check failed, or links touch
    by their outlines, and the pair or link, its group and the pose where it is worst are named.
    """
    from compoundkin.view.report.motion_report import check_report

    structure = solvable_structure(file, form, path)
    motion = solve_motion(structure, options)
    with working("checking"):
        result = check_report(motion)
    put_report(result, form, path)
    return _verdict(result)


def _verdict(result: Report) -> int:
    """Write what failed to stderr, and return the exit code."""
    failed = result.section("failed")
    if failed is not None:
        for alert in failed.blocks:
            say(f"FAILED: {getattr(alert, 'text', '')}")
        return FAILED
    return exit_code(result)
