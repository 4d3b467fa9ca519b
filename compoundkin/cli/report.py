"""`compoundkin report`: everything there is to say about a mechanism."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import click

from compoundkin.cli.driving import drive_options, solved
from compoundkin.cli.mechanisms import loaded, mechanism_argument
from compoundkin.cli.output import put_report, report_options
from compoundkin.cli.shell import FAILED, NOT_ASSEMBLED, say
from compoundkin.cli.structure import unsolvable

if TYPE_CHECKING:
    from compoundkin.reports import Report
    from compoundkin.structure import Structure


@click.command(
    epilog="""\b
Examples:
  compoundkin report six-bar
  compoundkin report six-bar --output G.speed --output rocker.angle
  compoundkin report six-bar --from 0 --to 90 --step 5 -o six-bar.md
  compoundkin report linkage.toml --format json
"""
)
@mechanism_argument
@drive_options
@click.option("--design", default=0, show_default=True, metavar="INDEX", help="Which one, where dimensions are arrays.")
@click.option(
    "--centres", "centres", metavar="VALUES", help="Add the instant centres at a pose: 35 or left=60,right=100."
)
@report_options
def command(file: str, design: int, centres: str | None, form: str | None, path: str | None, **asked: Any) -> int:
    """Report a mechanism: its structure, its motion over the cycle, the checks, and published numbers.

    Angles are in degrees and lengths in the unit of the file. Exit code 3: some poses cannot be assembled;
    4: a check failed or a published number was not reproduced.
    """
    from dataclasses import replace

    from compoundkin.cli.progress import working
    from compoundkin.freedom import solvable
    from compoundkin.reports import report

    structure = solvable(loaded(file))
    if structure.faults:
        put_report(report(structure), form, path)
        return unsolvable(len(structure.faults))
    motion = solved(structure, asked)
    with working("checking and reporting"):
        parts = [report(motion, asked["outputs"], design)]
        if centres is not None:
            parts.append(_of_centres(structure, centres.split(","), design, asked))
    made = replace(parts[0], sections=tuple(section for part in parts for section in part.sections))
    put_report(made, form, path)
    if not made.outcome.passed:
        say("A check or a published number FAILED; the report says which.")
        return FAILED
    return NOT_ASSEMBLED if any(part.outcome.assembled < part.outcome.poses for part in parts) else 0


def _of_centres(structure: Structure, at: Sequence[str], design: int, asked: Mapping[str, Any]) -> Report:
    """The instant centres at a pose, with the rates and modes of the motion."""
    from compoundkin.cli.centres import solved_at_pose
    from compoundkin.reports.partial import centres_report

    rates = {key: asked[key] for key in ("speeds", "modes")}
    return centres_report(solved_at_pose(structure, at, rates, "--centres"), design)
