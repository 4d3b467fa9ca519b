"""`compoundkin compare`: two mechanisms side by side."""

from __future__ import annotations

from math import isnan

import click

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.cli.file_options import complete_mechanism, load_mechanism, put_report, report_options
from compoundkin.cli.shell import FAILED, say


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
def command(one: str, other: str, tolerance: float | None, form: str | None, path: str | None) -> int:
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
