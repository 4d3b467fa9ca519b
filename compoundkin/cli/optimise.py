"""`compoundkin optimise`: better dimensions."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from math import radians
from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import file_format, suffix_for, suffix_of
from compoundkin.cli.drive_options import explain_gaps, motion_options, read_assembly_modes, split_names
from compoundkin.cli.file_options import mechanism_argument, put_report, report_or_mechanism_options, solvable_structure
from compoundkin.cli.shell import counting, say, working

if TYPE_CHECKING:
    from compoundkin.dimensional.coupler_atlas import CouplerAtlas
    from compoundkin.model.mechanism import Mechanism
    from compoundkin.structure import Structure
    from compoundkin.studies.optimisation.optimum import Optimum

RANGES = "write NAME=LOW:HIGH, lengths or degrees: crank.B.x=10:30"
ATLAS = "write how many designs are made for it, --atlas 20000, or a folder that has one"
BOUNDS = "write FIGURE=VALUE: ram.stroke=45, rod.transmission_angle.least=40"

# Designs of an atlas that is made for one search, at most: they take a third of a gigabyte.
MOST_DESIGNS = 1_000_000


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
  compoundkin optimise crank-rocker --free crank.B.x=1:4,coupler.C.x=3:8
      --target rocker.angle.stroke=70 --atlas 20000
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
@click.option(
    "--atlas",
    metavar="NUMBER|FOLDER",
    help="Begin at designs that turn fully, of an atlas of coupler curves: of so many, or of a folder.",
)
@click.option("--seed", type=int, default=0, show_default=True, help="Makes the search repeatable.")
@motion_options
@report_or_mechanism_options
def command(file: str, form: str | None, path: str | None, **options: Any) -> int:
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
        from compoundkin.files.saved_files import save

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
    atlas = read_atlas(structure.mechanism, options["atlas"])
    with counting("searching", "designs") as progress:
        return optimise(
            structure.mechanism, dict(read_ranges(structure, options["free"])), sum(aims[1:], aims[0]), constraints,
            values=read_driver_values(structure, options) or None, time=read_times(options["time"]),
            modes=read_assembly_modes(structure, options["modes"]) or None,
            starts=options["starts"], atlas=atlas, seed=options["seed"], progress=progress, **rates,
        )  # fmt: skip


def read_atlas(mechanism: Mechanism, given: str | None) -> CouplerAtlas | None:
    """Return the atlas of an option: so many designs of as many links as the mechanism, or a folder's.

    Raises InvalidInput for a mechanism of other numbers of links than an atlas has, and where a folder has none.
    """
    if given is None:
        return None
    from compoundkin.dimensional.coupler_atlas import CouplerAtlas, coupler_atlas
    from compoundkin.dimensional.curve_chains import curve_chains

    where = f"--atlas {given}"
    if not given.isdecimal():
        if not os.path.isdir(given):
            raise InvalidInput(Problem(where, "there is no such folder", ATLAS))
        return CouplerAtlas.open(given)
    links = next((most for most in (4, 6, 8) if len(mechanism.links) <= most), None)
    if links is None:
        what = f"{mechanism.title} has {len(mechanism.links)} links"
        raise InvalidInput(Problem(where, what, "chains of an atlas have four to eight: leave it out"))
    least, count = len(curve_chains(links)), int(given)
    if not least <= count <= MOST_DESIGNS:
        what = f"no atlas of {links} links is made for a search with so many designs"
        raise InvalidInput(Problem(where, what, f"{least} to {MOST_DESIGNS}; more are kept in a folder"))
    with working("making an atlas"):
        return coupler_atlas(links, count)


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
