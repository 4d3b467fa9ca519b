"""`compoundkin study`: many designs of a mechanism, as a study file says."""

from __future__ import annotations

from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.cli.drive_options import names_option
from compoundkin.cli.file_options import FORMATS, put_report
from compoundkin.cli.shell import NOT_ASSEMBLED, counting, say

if TYPE_CHECKING:
    from compoundkin.studies.study import Study
    from compoundkin.studies.study_result import StudyResult


# How many designs there are where nobody says it.
DESIGNS = 1024


@click.command(
    epilog="""\b
Examples:
  compoundkin study press.toml
  compoundkin study press.toml -o press-study --workers 2
  compoundkin study press.toml --greatest ram.stroke --best 5
  compoundkin study press.toml -o press-study --format json > press.json
  compoundkin study crank-rocker --free crank.B.x=1.8:2.2 --count 1000000
"""
)
@click.argument("file", metavar="FILE", type=click.Path())
@names_option(
    "--free",
    "free",
    "NAME=LOW:HIGH",
    "Of a mechanism instead of a study file: a dimension and its range, "
    "lengths or degrees. Repeat it, or write commas.",
)
@names_option(
    "--output",
    "outputs",
    "FIGURE",
    "With --free: what is found of each design, such as rocker.angle.stroke; the outputs of the file if left out.",
)
@click.option("--count", type=click.IntRange(1), metavar="DESIGNS", help="With --free: how many; 1024 if left out.")
@click.option("--seed", type=int, metavar="NUMBER", help="With --free: makes them repeatable; 0 if left out.")
@click.option("-o", "--to-folder", "folder", metavar="FOLDER", help="Keep all rows here, as Parquet files. Where some "
              "are there already, the others are computed.")  # fmt: skip
@click.option("--workers", type=click.IntRange(1), metavar="NUMBER", help="Processes instead of threads of one.")
@click.option("--chunk", type=click.IntRange(1), metavar="ROWS", help="How many designs a worker computes at a time.")
@names_option("--least", "least", "NAME", "List the designs with the least of a figure. Repeat it, or write commas.")
@names_option("--greatest", "greatest", "NAME", "The same with the greatest.")
@click.option("--best", type=click.IntRange(1), default=1, show_default=True, metavar="NUMBER", help="So many of each.")
@click.option("--format", "form", type=click.Choice(FORMATS), help="Of the summary.")
def command(
    file: str,
    free: tuple[str, ...],
    outputs: tuple[str, ...],
    count: int | None,
    seed: int | None,
    folder: str | None,
    least: tuple[str, ...],
    greatest: tuple[str, ...],
    best: int,
    form: str | None,
    **how: int | None,
) -> int:
    """Compute the designs of a study file, or of a mechanism with --free, and sum up their figures.

    Ctrl-C stops it: with -o the rows computed remain, and the same command goes on from there.
    Exit code 3: no design assembles.
    """
    from compoundkin.studies.study import load_study
    from compoundkin.view.report.study_reports import study_report

    studied = _of_mechanism(file, free, outputs, count, seed) if free else load_study(_study_file(file, outputs))
    check_figures(studied, (*least, *greatest))
    found = run_with_progress(studied, folder, **how)
    put_report(study_report(found, least, greatest, best), form, None)
    if folder is not None:
        say(f"{len(found):,} rows are in {folder}.")
    return 0 if found.assembled.any() else NOT_ASSEMBLED


def _study_file(file: str, outputs: tuple[str, ...]) -> str:
    """Return the path of a study file. Raises InvalidInput for a mechanism, of which --free says what may vary."""
    from compoundkin.base.suffixes import SUFFIXES, suffix_of

    how = (
        "study files end in .toml or .json, compoundkin new study writes one; of a mechanism say what varies: "
        "--free crank.B.x=18:22 --output rocker.angle.stroke"
    )
    if outputs:
        raise InvalidInput(Problem("--output", "a study file says it itself", how))
    if suffix_of(file) not in SUFFIXES["study"]:
        raise InvalidInput(Problem(file, "this is no study file", how))
    return file


def _of_mechanism(
    file: str, free: tuple[str, ...], outputs: tuple[str, ...], count: int | None, seed: int | None
) -> Study:
    """Return the study of a mechanism, its dimensions in ranges."""
    from compoundkin.cli.file_options import load_mechanism
    from compoundkin.cli.optimise import read_ranges
    from compoundkin.structure import decompose
    from compoundkin.studies.study import study

    mechanism = load_mechanism(file)
    ranges = dict(read_ranges(decompose(mechanism), free))
    return study(mechanism, ranges, outputs or mechanism.outputs, count=count or DESIGNS, seed=seed or 0)


def check_figures(studied: Study, names: tuple[str, ...]) -> None:
    """Raise UnknownName for names that are no figures of a study."""
    known = [one.name for one in studied.columns if one.is_figure]
    for name in names:
        if name not in known:
            raise UnknownName(Problem(name, "it is no figure or dimension of the study", suggestion(name, known)))


def run_with_progress(studied: Study, folder: str | None, workers: int | None, chunk: int | None) -> StudyResult:
    """Run a study with a line of progress; after Ctrl-C a message names the folder of the rows computed."""
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context
    from signal import SIG_IGN, SIGINT, signal

    where: dict[str, Any] = {} if folder is None else {"folder": folder}
    with ExitStack() as stack:
        on = None
        if workers is not None:
            # spawned processes do not inherit locks of this one's threads; they leave Ctrl-C to this process
            ignore = signal, (SIGINT, SIG_IGN)
            on = stack.enter_context(ProcessPoolExecutor(workers, get_context("spawn"), *ignore))
        progress = stack.enter_context(counting("computing", "designs"))
        try:
            return studied.run(**where, on=on, chunk=chunk, progress=progress)
        except KeyboardInterrupt:
            if folder is not None:
                say(f"The rows computed are in {folder}: run it again to go on.")
            raise
