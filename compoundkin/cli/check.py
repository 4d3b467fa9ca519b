"""`compoundkin check` and `compoundkin compare`: what verifies a motion, and two mechanisms side by side."""

from __future__ import annotations

from math import isnan
from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.cli.drive_options import drive_options, solve_motion
from compoundkin.cli.file_options import (
    complete_mechanism,
    exit_code,
    load_mechanism,
    mechanism_argument,
    put_report,
    report_options,
    solvable_structure,
)
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


@click.command(
    epilog="""\b
Examples:
  compoundkin compare six-bar mine.toml
  compoundkin compare crane.toml crane.linkage2 --tolerance 1e-6
  compoundkin compare mine.toml 'https://app.pmksplus.com/?...' -o both.md
"""
)
@click.argument("one", metavar="A", shell_complete=complete_mechanism)
@click.argument("other", metavar="B", shell_complete=complete_mechanism)
@click.option("--tolerance", type=click.FloatRange(min=0.0), metavar="PART",
              help="How far apart they may come, as a part of the size; 1e-4 if left out.")  # fmt: skip
@report_options
def compare_command(one: str, other: str, tolerance: float | None, form: str | None, path: str | None) -> int:
    """Compare two mechanisms: structure, dimensions, and how far apart they come when driven alike.

    A and B are mechanism files, names of the catalog, files of other programs or links, in any mixture. Points stand
    for each other by their places at a pose that both have, else by their names. Exit code 4: they are farther apart
    than the tolerance, or cannot be driven alike.
    """
    from compoundkin.analysis.comparison import TOLERANCE, compare
    from compoundkin.view.report.study_reports import comparison_report

    if tolerance is not None and isnan(tolerance):
        raise InvalidInput(Problem("--tolerance", "nan is no number", "give a part of the size, such as 1e-4"))
    found = compare(load_mechanism(one), load_mechanism(other))
    put_report(comparison_report(found), form, path)
    allowed = TOLERANCE if tolerance is None else tolerance
    if found.within(allowed):
        return 0
    say(f"They are not the same to {allowed:g} of the size: {found.verdict}.")
    return FAILED
