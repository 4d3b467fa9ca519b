"""`compoundkin synthesise`: mechanisms that do what a task file says."""

from __future__ import annotations

import click

from compoundkin.cli.file_options import check_place, put_report, report_options
from compoundkin.cli.shell import NOT_ASSEMBLED, say, working


@click.command(
    epilog="""\b
Examples:
  compoundkin synthesise task.toml
  compoundkin synthesise task.toml --save found --picture found.svg
  compoundkin synthesise task.toml --format json -o found.json

\b
A task file:
  format = 1
  task = "poses"           # or points, mixed, function, swing, stroke, dwell
  link = "plate"
  poses = [[2.9, 0.1, -35], [2.5, 0.4, 12], [1.9, 0.5, 40]]   # x, y, degrees
  [conditions]
  region = [[-5, -5], [5, 5]]   # holds the fixed pivots
  transmission = 30             # degrees, at least
"""
)
@click.argument("file", type=click.Path(), metavar="TASK")
@click.option(
    "--save", "folder", type=click.Path(), metavar="FOLDER", help="Write each mechanism as a file there: a new folder."
)
@click.option("--picture", "picture", type=click.Path(), metavar="FILE", help="Draw the mechanisms side by side.")
@report_options
def command(file: str, folder: str | None, picture: str | None, form: str | None, path: str | None) -> int:
    """Find the mechanisms that do what a task file says, and say what is wrong with the other candidates.

    Angles are degrees in the file. Exit code 3: no mechanism without a defect.
    """
    from compoundkin.base.display import count_phrase
    from compoundkin.base.suffixes import file_format, suffix_for
    from compoundkin.dimensional.synthesis import synthesise
    from compoundkin.dimensional.tasks import read_task
    from compoundkin.files import save
    from compoundkin.files.atomic import check_folder_is_new, new_folder
    from compoundkin.files.parsed_document import parsed, text_of
    from compoundkin.view.report.synthesis_report import synthesis_report

    if picture is not None:
        file_format("picture", picture)
        check_place(picture)
    if folder is not None:
        check_folder_is_new(folder)
    text, syntax = text_of(file, "task")
    task, conditions = read_task(parsed(text, syntax, file, "task"))
    with working("synthesising"):
        answer = synthesise(task, **conditions)
    put_report(synthesis_report(answer), form, path)
    if picture is not None:
        answer.draw().save(picture)
    if folder is not None and len(answer):
        with new_folder(folder) as where:
            for k, mechanism in enumerate(answer.mechanisms, start=1):
                save(mechanism, where / f"{k}{suffix_for('mechanism', 'toml')}")
        say(f"Wrote {count_phrase(len(answer), 'mechanism')} to {folder}.")
    return 0 if len(answer) else NOT_ASSEMBLED
