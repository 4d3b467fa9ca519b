"""`compoundkin synthesise` and `trace`: mechanisms that do what a task file says, or follow a drawn curve."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from compoundkin.cli.file_options import check_place, put_report, report_options
from compoundkin.cli.shell import NOT_ASSEMBLED, say, working

if TYPE_CHECKING:
    from compoundkin.dimensional.synthesis import Answer


@click.command(
    epilog="""\b
Examples:
  compoundkin synthesise task.toml
  compoundkin synthesise task.toml --save found --picture found.svg
  compoundkin synthesise task.toml --format json -o found.json

\b
A task file:
  format = 1
  task = "poses"   # points, mixed, curve, function, swing, stroke, dwell
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
    from compoundkin.dimensional.synthesis import synthesise
    from compoundkin.dimensional.task_words import read_task
    from compoundkin.files.parsed_document import parsed, text_of

    _check_places(picture, folder)
    text, syntax = text_of(file, "task")
    task, conditions = read_task(parsed(text, syntax, file, "task"))
    with working("synthesising"):
        answer = synthesise(task, **conditions)
    return _put(answer, folder, picture, form, path)


@click.command(
    epilog="""\b
Examples:
  compoundkin trace curve.csv
  compoundkin trace letter.svg --links 4 --save found --picture found.svg
  compoundkin trace path.dxf --transmission 30 --format html -o found.html
  compoundkin trace tracked.csv --times t       # the driver turns evenly
  compoundkin trace tracked.csv --angles crank  # a column in degrees
  compoundkin trace foot.svg --obstacle box.svg --obstacle ground.csv
"""
)
@click.argument("file", type=click.Path(), metavar="CURVE")
@click.option("--links", type=int, default=6, show_default=True, help="At most so many links: 4, 6 or 8.")
@click.option("--open/--closed", "is_open", default=None, help="What the curve is, where its ends do not tell.")
@click.option("--times", metavar="COLUMN", help="The column of a table with the times of points: an even turn.")
@click.option("--angles", metavar="COLUMN", help="The column of a table with the driver's angles, in degrees.")
@click.option("--transmission", type=float, default=0.0, metavar="DEGREES", help="The least transmission angle.")
@click.option(
    "--obstacle",
    "obstacles",
    type=click.Path(),
    multiple=True,
    metavar="FILE",
    help="A closed curve that pins and links keep clear of; may be repeated.",
)
@click.option(
    "--save", "folder", type=click.Path(), metavar="FOLDER", help="Write each mechanism as a file there: a new folder."
)
@click.option("--picture", "picture", type=click.Path(), metavar="FILE", help="Draw the mechanisms side by side.")
@report_options
def trace_command(
    file: str, links: int, is_open: bool | None, times: str | None, angles: str | None, transmission: float,
    obstacles: tuple[str, ...], folder: str | None, picture: str | None, form: str | None, path: str | None,
) -> int:  # fmt: skip
    """Find linkages whose point follows a drawn curve, of a .csv, .svg or .dxf file.

    A curve whose ends meet is traced once in a turn of the driver, an open one by a part of it. Exit code 3: no
    mechanism without a defect.
    """
    import numpy as np

    from compoundkin.base.errors import InvalidInput, Problem
    from compoundkin.dimensional.synthesis import synthesise
    from compoundkin.dimensional.task_words import FEWEST_OF_CURVE, curve
    from compoundkin.files.curve_files import read_curve, read_timed_curve

    _check_places(picture, folder)
    options: dict[str, Any] = {"closed": None if is_open is None else not is_open, "links": links}
    if not 0.0 <= transmission < 90.0:
        what = f"{transmission:g} degrees are no transmission angle"
        raise InvalidInput(Problem("--transmission", what, "give 0 to 90"))
    if times and angles:
        raise InvalidInput(Problem("--angles", "--times is given too", "leave out one of them"))
    if column := times or angles:
        places, values = read_timed_curve(file, column)
        task = curve(places, **({"times": values} if times else {"at": np.deg2rad(values)}), **options)
    else:
        task = curve(read_curve(file, FEWEST_OF_CURVE), **options)
    walls = [read_curve(wall) for wall in obstacles] or None
    with working("tracing"):
        answer = synthesise(task, transmission=float(np.deg2rad(transmission)), obstacles=walls)
    return _put(answer, folder, picture, form, path)


def _check_places(picture: str | None, folder: str | None) -> None:
    """Check where results will be written, before anything is solved. Raises InvalidInput."""
    from compoundkin.base.suffixes import file_format
    from compoundkin.files.atomic import check_folder_is_new

    if picture is not None:
        file_format("picture", picture)
        check_place(picture)
    if folder is not None:
        check_folder_is_new(folder)


def _put(answer: Answer, folder: str | None, picture: str | None, form: str | None, path: str | None) -> int:
    """Write the report, the picture and the mechanisms of an answer; return the exit code."""
    from compoundkin.base.display import count_phrase
    from compoundkin.base.suffixes import suffix_for
    from compoundkin.files.atomic import new_folder
    from compoundkin.files.saved_files import save
    from compoundkin.view.report.synthesis_report import synthesis_report

    put_report(synthesis_report(answer), form, path)
    if picture is not None:
        answer.draw().save(picture)
    if folder is not None and len(answer):
        with new_folder(folder) as where:
            for k, mechanism in enumerate(answer.mechanisms, start=1):
                save(mechanism, where / f"{k}{suffix_for('mechanism', 'toml')}")
        say(f"Wrote {count_phrase(len(answer), 'mechanism')} to {folder}.")
    return 0 if len(answer) else NOT_ASSEMBLED
