"""`compoundkin check`: what verifies a motion, as a table."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from compoundkin.cli.drive_options import drive_options, solve_motion
from compoundkin.cli.file_options import load_mechanism, mechanism_argument, put_report, report_options
from compoundkin.cli.shell import FAILED, NOT_ASSEMBLED, say
from compoundkin.cli.structure import report_unsolvable

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
def command(file: str, form: str | None, path: str | None, **asked: Any) -> int:
    """Verify a motion and print a table of all findings. It uses ways without the formulas that solved it.

    Outlines of links are compared too. Exit code 3: some poses cannot be assembled; 4: a check failed, or links touch
    by their outlines, and the pair or link, its group and the pose where it is worst are named.
    """
    from compoundkin.cli.shell import working
    from compoundkin.structure import decompose
    from compoundkin.view.report import report
    from compoundkin.view.report.motion_report import check_report

    structure = decompose(load_mechanism(file))
    if structure.faults:
        put_report(report(structure), form, path)
        return report_unsolvable(len(structure.faults))
    motion = solve_motion(structure, asked)
    with working("checking"):
        made = check_report(motion)
    put_report(made, form, path)
    return _verdict(made)


def _verdict(made: Report) -> int:
    """The exit code of a check; what failed is said on stderr too."""
    failed = made.section("failed")
    if failed is not None:
        for alert in failed.blocks:
            say(f"FAILED: {getattr(alert, 'text', '')}")
        return FAILED
    return NOT_ASSEMBLED if made.outcome.assembled < made.outcome.poses else 0
