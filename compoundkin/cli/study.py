"""`compoundkin study`, `compoundkin optimise`: many designs of a mechanism, as a study file says, and better ones."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from math import radians
from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.base.suffixes import file_format, suffix_for, suffix_of
from compoundkin.cli.drive_options import explain_gaps, motion_options, names_option, read_assembly_modes, split_names
from compoundkin.cli.file_options import (
    FORMATS,
    mechanism_argument,
    put_report,
    report_or_mechanism_options,
    solvable_structure,
)
from compoundkin.cli.shell import NOT_ASSEMBLED, counting, say

if TYPE_CHECKING:
    from compoundkin.structure import Structure
    from compoundkin.studies.optimisation.optimum import Optimum
    from compoundkin.studies.study import Study
    from compoundkin.studies.study_result import StudyResult


RANGES = "write NAME=LOW:HIGH, lengths or degrees: crank.B.x=10:30"
BOUNDS = "write FIGURE=VALUE: ram.stroke=45, rod.transmission_angle.least=40"


def _repeated(flag: str, name: str, metavar: str, text: str) -> Callable[[Any], Any]:
    return click.option(flag, name, multiple=True, metavar=metavar, help=text)


@click.command(
    epilog="""\b
Examples:
  compoundkin optimise crank-rocker --free rocker.C.x=3.5:4.5
      --least rocker.angle.stroke
  compoundkin optimise crank-rocker --free crank.B.x=1:3 --full-turn
      --target rocker.angle.stroke=60 -o better.toml
  compoundkin optimise six-bar --free crank.D.x=10:18,bar.G.x=50:60
      --greatest G.x.stroke -o better.html
"""
)
@mechanism_argument
@_repeated("--free", "free", "NAME=LOW:HIGH", "A dimension that may change, and how far; lengths or degrees.")
@_repeated("--least", "least", "FIGURE", "Make a figure as small as can be.")
@_repeated("--greatest", "greatest", "FIGURE", "Make it as great as can be.")
@_repeated("--target", "target", "FIGURE=VALUE", "Bring it to a value, degrees for angles.")
@_repeated("--at-least", "at_least", "FIGURE=VALUE", "It must not be smaller; a quantity at no pose.")
@_repeated("--at-most", "at_most", "FIGURE=VALUE", "It must not be greater.")
@click.option("--full-turn", is_flag=True, help="The driver must be able to turn fully.")
@click.option("--assembled", is_flag=True, help="It must be assembled all along the motion, in one configuration.")
@click.option("--starts", type=click.IntRange(min=1), default=64, show_default=True, help="How many searches begin.")
@click.option("--seed", type=int, default=0, show_default=True, help="Makes the search repeatable.")
@motion_options
@report_or_mechanism_options
def optimise_command(file: str, form: str | None, path: str | None, **options: Any) -> int:
    """Find the dimensions with which a mechanism does best, and report what changed and how sure it is.

    Several goals are summed up with equal weights. -o PATH.toml writes the mechanism with its new dimensions.
    Exit code 4: not all constraints hold.
    """
    from compoundkin.view.report.study_reports import optimum_report

    is_mechanism = path is not None and form is None and suffix_of(path) == suffix_for("mechanism", "toml")
    if path is not None and form is None and not is_mechanism:
        file_format("report", path)
    found = search(solvable_structure(file, form, None), options)
    if is_mechanism:
        from compoundkin.files import save

        put_report(optimum_report(found, options["outputs"]), form, None)
        save(found.mechanism, str(path))
        say(f"Wrote {path}.")
    else:
        put_report(optimum_report(found, options["outputs"]), form, path)
    return explain_gaps(found.motion) or (0 if found.is_held else 4)


def search(structure: Structure, options: dict[str, Any]) -> Optimum:
    """Return the best design of what the options ask for. Raises InvalidInput for what they do not say."""
    from compoundkin.cli.typed_values import read_driver_values, read_rates, read_times
    from compoundkin.model.attributes import RATES
    from compoundkin.studies.goals.constraints import assembles, at_least, at_most, full_turn
    from compoundkin.studies.goals.value_goals import greatest, least, target
    from compoundkin.studies.optimisation.design_optimisation import optimise

    aims = [least(name) for name in split_names(options["least"])]
    aims += [greatest(name) for name in split_names(options["greatest"])]
    aims += [target(*one) for one in _values("--target", options["target"])]
    if not aims:
        what = "nothing is said to be least, greatest or at a target"
        raise InvalidInput(Problem("--least, --greatest, --target", what, "such as --least rocker.angle.stroke"))
    constraints = [at_least(*one) for one in _values("--at-least", options["at_least"])]
    constraints += [at_most(*one) for one in _values("--at-most", options["at_most"])]
    constraints += [full_turn()] if options["full_turn"] else []
    constraints += [assembles()] if options["assembled"] else []
    rates: dict[str, Any] = {rate: read_rates(structure, f"--{rate}", options[f"{rate}s"]) for rate in RATES[:2]}
    with counting("searching", "designs") as progress:
        return optimise(
            structure.mechanism, dict(read_ranges(structure, options["free"])), sum(aims[1:], aims[0]), constraints,
            values=read_driver_values(structure, options) or None, time=read_times(options["time"]),
            modes=read_assembly_modes(structure, options["modes"]) or None,
            starts=options["starts"], seed=options["seed"], progress=progress, **rates,
        )  # fmt: skip


def read_ranges(structure: Structure, given: Sequence[str]) -> Iterator[tuple[str, tuple[float, float]]]:
    """Yield dimensions with the bounds between which they may be, radians or lengths. Raises InvalidInput."""
    from compoundkin.cli.typed_values import read_number
    from compoundkin.studies.study_document import is_angle_dimension

    if not given:
        raise InvalidInput(Problem("--free", "no dimension may change", RANGES))
    read = set()
    for text in split_names(given):
        name, _, bounds = text.partition("=")
        low, colon, high = bounds.partition(":")
        where = f"--free {text}"
        if not name or not colon:
            raise InvalidInput(Problem(where, "this is no dimension with its bounds", RANGES))
        if name in read:
            raise InvalidInput(Problem(where, f"{name} is given twice", "leave one of them out"))
        read.add(name)
        is_angle = is_angle_dimension(structure.mechanism, structure.driven_angles, name)
        numbers = [read_number(part, where, RANGES) for part in (low, high)]
        yield name, tuple(radians(one) if is_angle else one for one in numbers)  # type: ignore[misc]


def _values(option: str, given: Sequence[str]) -> Iterator[tuple[str, float]]:
    """Yield figures with values, radians for angles. Raises InvalidInput."""
    from compoundkin.cli.typed_values import read_number
    from compoundkin.model.attributes import is_angle_word, motion_figure

    for text in split_names(given):
        name, equals, value = text.partition("=")
        if not name or not equals:
            raise InvalidInput(Problem(f"{option} {text}", "this is no figure with its value", BOUNDS))
        number = read_number(value, f"{option} {text}", BOUNDS)
        is_angle = is_angle_word(motion_figure(name)[0].rpartition(".")[2])
        yield name, radians(number) if is_angle else number


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
