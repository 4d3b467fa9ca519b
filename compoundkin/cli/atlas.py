"""`compoundkin atlas`: all kinematic chains, trusses and Assur groups of a number of links."""

from __future__ import annotations

import click

from compoundkin.cli.file_options import put_report, report_options
from compoundkin.cli.shell import working


@click.command(
    epilog="""\b
Examples:
  compoundkin atlas --links 8
  compoundkin atlas --links 6 --inversions
  compoundkin atlas --links 7 --trusses
  compoundkin atlas --links 4 --groups --format json
"""
)
@click.option("--links", required=True, type=int, help="How many links: up to 10 at once, up to 12 with some patience.")
@click.option("--mobility", default=1, show_default=True, type=int, help="The mobility of the chains.")
@click.option("--inversions", is_flag=True, help="Also every mechanism that fixing a link gives.")
@click.option("--trusses", is_flag=True, help="The Baranov trusses with so many links instead.")
@click.option("--groups", is_flag=True, help="The Assur groups with so many links instead.")
@report_options
def command(
    links: int, mobility: int, inversions: bool, trusses: bool, groups: bool, form: str | None, path: str | None
) -> None:
    """List all kinematic chains of revolute pairs with a number of links, each once.

    Each has its number, name, links by their numbers of pairs, symmetries, inversions, graph6 and pairs.
    """
    from compoundkin.view.report.atlas_sections import atlas_report

    with working("listing chains"):
        made = atlas_report(links, mobility, inversions, trusses, groups)
    put_report(made, form, path)
