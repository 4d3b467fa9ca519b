"""`compoundkin exercise`: variants of an exercise with sheets, worked solutions and a table of answers."""

from __future__ import annotations

import click

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.cli.drive_options import names_option
from compoundkin.cli.file_options import load_mechanism, mechanism_argument
from compoundkin.cli.shell import say, working


@click.command(
    epilog="""\b
Examples:
  compoundkin exercise crank-rocker --vary 10% --seed 7 --count 30 -o sheets
  compoundkin exercise six-bar --question positions,velocities -o sheets
  compoundkin exercise four-bar:60,20,50,40 --count 5 -o sheets
"""
)
@mechanism_argument
@click.option("--vary", default="10%", show_default=True, metavar="PART", help="How far lengths vary: 10% or 0.1.")
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="The same seed, the same variants.")
@click.option("--count", type=click.IntRange(1), default=1, show_default=True, help="How many variants.")
@names_option("--question", "questions", "KIND", "mobility, groups, positions, velocities, accelerations, forces; all "
              "where it is left out. Repeat it, or write commas.")  # fmt: skip
@click.option("-o", "--to-folder", "folder", metavar="FOLDER", required=True, help="A new folder for all files.")
def command(file: str, vary: str, seed: int, count: int, questions: tuple[str, ...], folder: str) -> int:
    """Make exercises of a mechanism: a sheet with figure, given values and questions, and a worked solution of each.

    Variant 7 is 07.md, 07.html, 07.tex and its solution 07-solution.md and so on, its figure 07.svg, its mechanism
    file 07.toml; answers.csv has all answers. Given values are rounded as textbooks print them, and the rounded
    values are what is solved.
    """
    from compoundkin.files.atomic import check_folder_is_new
    from compoundkin.view.report.exercises import exercise

    part = _fraction(vary)
    check_folder_is_new(folder)
    mechanism = load_mechanism(file)
    with working("making exercises"):
        made = exercise(mechanism, vary=part, seed=seed, count=count, questions=questions)
        made.save(folder)
    if made.fixed and part:
        say(f"The same in all variants, as it does not assemble with others: {', '.join(made.fixed)}.")
    say(f"Wrote {count} {'variant' if count == 1 else 'variants'} to {folder}; the answers are in answers.csv.")
    return 0


def _fraction(text: str) -> float:
    """Return "10%" or "0.1" as a number.

    >>> _fraction("10%"), _fraction("0.25")
    (0.1, 0.25)
    """
    try:
        return float(text[:-1]) / 100.0 if text.endswith("%") else float(text)
    except ValueError:
        raise InvalidInput(Problem("--vary", f"{text!r} is no part", "write 10% or 0.1")) from None
