"""`compoundkin structure`: what a mechanism is made of."""

from __future__ import annotations

import click

from compoundkin.cli.file_options import loaded, mechanism_argument, put_report, report_options
from compoundkin.cli.shell import say


@click.command(
    epilog="""\b
Examples:
  compoundkin structure six-bar
  compoundkin structure linkage.toml --format markdown
  compoundkin structure stephenson-ii --alternatives
  compoundkin structure slider-crank --equations -o loops.md
"""
)
@mechanism_argument
@click.option("--alternatives", is_flag=True, help="Add every other choice of frame and driver, and what it gives.")
@click.option("--equations", is_flag=True, help="Add the vector-loop equations; as LaTeX in Markdown and JSON.")
@report_options
def command(file: str, alternatives: bool, equations: bool, form: str | None, path: str | None) -> int:
    """Take a mechanism apart: links, pairs, mobility, loops, Assur groups in solving order.

    Nothing is solved. What keeps a mechanism from being solved is named with its remedies (exit code 2).
    """
    from dataclasses import replace

    from compoundkin.cli.progress import working
    from compoundkin.structure import decompose
    from compoundkin.view.report import report

    with working("taking the mechanism apart"):
        structure = decompose(loaded(file))
        made = report(structure)
    if equations:
        from compoundkin.view.report.loop_sections import equations_section

        made = replace(made, sections=(*made.sections, equations_section(structure)))
    if alternatives:
        from compoundkin.view.report.atlas_sections import alternatives_section

        made = replace(made, sections=(*made.sections, alternatives_section(structure)))
    put_report(made, form, path)
    return unsolvable(len(structure.faults)) if structure.faults else 0


def unsolvable(faults: int) -> int:
    """Say on stderr that a structure cannot be solved; the exit code for that."""
    from compoundkin.base.errors import NotDetermined
    from compoundkin.view.report.wording import counted

    say(f"The mechanism cannot be solved: {counted(faults, 'fault')}, explained in the report.")
    return NotDetermined.exit_code
