"""`compoundkin report` and `compoundkin open`: everything about a mechanism, in the terminal, a file or the browser."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from compoundkin.cli.drive_options import DESIGN, drive_options, solve_motion
from compoundkin.cli.file_options import (
    draw_page,
    load_mechanism,
    mechanism_argument,
    put_report,
    report_options,
    report_unsolvable,
)
from compoundkin.cli.shell import FAILED, NOT_ASSEMBLED, say, working

if TYPE_CHECKING:
    from compoundkin.structure import Structure
    from compoundkin.view.report import Report
    from compoundkin.view.report.report_data import Section

F = TypeVar("F", bound=Callable[..., Any])


def reporting_options(command: F) -> F:
    """Add the options that select what is reported."""
    centres = click.option(
        "--centres", "centres", metavar="VALUES", help="Add the instant centres at a pose: 35 or left=60,right=100."
    )
    equations = click.option(
        "--equations", is_flag=True, help="Add the equations of motion with their numbers at the first pose."
    )
    return drive_options(DESIGN(centres(equations(command))))


@click.command(
    epilog="""\b
Examples:
  compoundkin report six-bar
  compoundkin report six-bar --output G.speed --output rocker.angle
  compoundkin report six-bar --from 0 --to 90 --step 5 -o six-bar.md
  compoundkin report six-bar -o six-bar.html
  compoundkin report six-bar --at 35 --equations --centres 35 -o worked.html
  compoundkin report linkage.toml --format json
"""
)
@mechanism_argument
@reporting_options
@report_options
def command(file: str, form: str | None, path: str | None, **options: Any) -> int:
    """Report a mechanism. It covers its structure, motion over the cycle, the checks, and published numbers.

    Angles are in degrees and lengths in the unit of the file. An .html file is a page with the moving sketch and plots.
    Exit code 3: some poses cannot be assembled; 4: a check failed or a published number was not reproduced.
    """
    report, assembled = mechanism_report(file, options)
    put_report(report, form, path)
    return report_exit_code(report, assembled)


@click.command(
    epilog="""\b
Examples:
  compoundkin open six-bar
  compoundkin open linkage.toml --output G.velocity,bar.angle
  compoundkin open six-bar -o six-bar.html
"""
)
@mechanism_argument
@reporting_options
@click.option("-o", "--to-file", "path", metavar="PATH", help="Write the page here; else to a temporary file.")
def open_command(file: str, path: str | None, **options: Any) -> int:
    """Show the report of a mechanism in the browser. It is one page with the moving sketch, plots and tables.

    The page is a file that needs no network and no server. Exit codes are those of `report`.
    """
    from compoundkin.view.page.report_page import open_in_browser, temporary_page

    report, assembled = mechanism_report(file, options)
    page = draw_page(report)
    target = Path(path) if path else temporary_page()
    page.save(target)
    if open_in_browser(target):
        say(f"Opened {target}.")
    else:
        say(f"No browser can be opened here; the page is in {target}.")
    return report_exit_code(report, assembled)


def mechanism_report(file: str, options: Mapping[str, Any]) -> tuple[Report, bool]:
    """Return the report of a mechanism, and whether every pose is assembled."""
    from dataclasses import replace

    from compoundkin.structure import decompose
    from compoundkin.view.report import report

    structure, design = decompose(load_mechanism(file)), options["design"]
    if structure.faults or structure.mechanism.unplaced:
        return report(structure), True
    motion = solve_motion(structure, options)
    with working("checking and reporting"):
        parts = [report(motion, options["outputs"], design)]
        if options["equations"]:
            parts.append(replace(parts[0], sections=tuple(_equations(structure, options))))
        if options["centres"] is not None:
            parts.append(_of_centres(structure, options["centres"].split(","), design, options))
    assembled = all(part.outcome.assembled == part.outcome.poses for part in parts)
    return replace(parts[0], sections=tuple(section for part in parts for section in part.sections)), assembled


def _equations(structure: Structure, options: Mapping[str, Any]) -> list[Section]:
    """Return the sections of the loop equations, with their numbers at the first pose."""
    import numpy as np

    from compoundkin.cli.structure import equation_sections
    from compoundkin.cli.typed_values import read_driver_values

    values = read_driver_values(structure, {**options, "time": None})
    shown = {name: np.rad2deg(v) if structure.driven_angles[name] else v for name, v in values.items()}
    first = tuple(f"{name}={float(np.ravel(value)[0])!r}" for name, value in shown.items())
    return equation_sections(structure, {**options, "order": 2, "at": first, "newton": False, "estimates": ()})[0]


def report_exit_code(report: Report, assembled: bool) -> int:
    """Write what failed to stderr, and return the exit code."""
    if (faults := report.section("faults")) is not None:
        return report_unsolvable(len(faults.blocks) - 1)
    if not report.outcome.passed and (report.outcome.assembled or not report.outcome.poses):
        say("A check or a published number FAILED, or links touch; the report says which.")
        return FAILED
    return 0 if assembled else NOT_ASSEMBLED


def _of_centres(structure: Structure, at: Sequence[str], design: int, options: Mapping[str, Any]) -> Report:
    """Return the instant centres at a pose, with the rates and modes of the motion."""
    from compoundkin.cli.characteristics import solve_pose
    from compoundkin.view.report.motion_report import centres_report

    rates = {key: options[key] for key in ("speeds", "modes")}
    return centres_report(solve_pose(structure, at, rates, "--centres"), design)
