"""`compoundkin tolerance`: what tolerances of dimensions and play in pins do to outputs."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.cli.drive_options import explain_gaps, motion_options, read_assembly_modes, split_names
from compoundkin.cli.file_options import (
    is_table,
    mechanism_argument,
    put_report,
    put_table,
    report_or_table_options,
    solvable_structure,
)
from compoundkin.cli.shell import working

if TYPE_CHECKING:
    from compoundkin.kinematics.quantities import Table
    from compoundkin.structure import Structure
    from compoundkin.studies.tolerances.tolerance_analysis import ToleranceAnalysis

HOW = "write NAME=0.05, or NAME=-0.02:0.05 for both deviations"


@click.command(
    epilog="""\b
Examples:
  compoundkin tolerance six-bar --tolerance crank.D=0.05 --output G.x
  compoundkin tolerance six-bar --tolerance crank.D=0.05 --clearance C=0.01
  compoundkin tolerance six-bar --tolerance slot.angle=-0.1:0.2 --at 35
  compoundkin tolerance six-bar --tolerance plate.C=0.02 --percentile 5,50,95
  compoundkin tolerance six-bar --tolerance plate.C=0.02 --bands -o bands.csv
"""
)
@mechanism_argument
@click.option("--tolerance", "tolerances", multiple=True, metavar="NAME=VALUE", help="A dimension and its error to "
              "either side, or NAME=LOWER:UPPER; lengths or degrees. Repeat it, or write commas.")  # fmt: skip
@click.option("--clearance", "clearances", multiple=True, metavar="PAIR=VALUE",
              help="Half the play of a pin, slide or slot.")  # fmt: skip
@click.option("--sigmas", type=float, default=3.0, show_default=True,
              help="How many standard deviations the limits are away.")  # fmt: skip
@click.option("--count", type=int, default=4096, show_default=True, help="How many random designs.")
@click.option("--seed", type=int, default=0, show_default=True, help="Makes them repeatable.")
@click.option("--percentile", "percentiles", multiple=True, metavar="PERCENT", help="Which percentiles of the random "
              "designs, such as 5,50,95; repeat it, or write commas.  [default: 0.135, 50, 99.865]")  # fmt: skip
@click.option("--bands", is_flag=True, help="A table with the bands of the outputs at every pose.")
@motion_options
@report_or_table_options
def command(file: str, bands: bool, form: str | None, path: str | None, **options: Any) -> int:
    """Report what tolerances do to the outputs: worst case, deviation, contributions.

    They follow from exact slopes, percentiles from random designs. -o PATH.csv is the table of contributions, with
    --bands that of all poses.
    """
    from compoundkin.view.report.study_reports import tolerance_report

    tabulated = is_table(path, form, "--bands" if bands else "")
    structure = solvable_structure(file, form, path if not tabulated else None)
    found = analyse(structure, options)
    if tabulated:
        put_table(bands_table(found) if bands else found.table(), path)
    else:
        put_report(tolerance_report(found), form, path)
    return explain_gaps(found.motion)


def bands_table(found: ToleranceAnalysis) -> Table:
    """Return the bands of all outputs. Raises InvalidInput where no output has a value at every pose."""
    if not any(one.is_course for one in found.values()):
        what = "the outputs are figures of the whole motion"
        raise InvalidInput(Problem("--bands", what, "name an output that has a value at every pose"))
    return found.bands()


def analyse(structure: Structure, options: dict[str, Any]) -> ToleranceAnalysis:
    """Return the analysis that the options describe."""
    from compoundkin.cli import typed_values
    from compoundkin.model.attributes import RATES
    from compoundkin.studies.tolerances.tolerance import tolerance

    outputs = options["outputs"] or structure.mechanism.outputs
    if not outputs:
        raise InvalidInput(Problem("--output", "no output is named", "such as --output G.x.stroke"))
    if not options["tolerances"] and not options["clearances"]:
        raise InvalidInput(Problem("--tolerance, --clearance", "nothing has a tolerance", HOW))
    given = dict(read_errors(structure, "--tolerance", options["tolerances"]))
    values, time = typed_values.read_driver_values(structure, options) or None, typed_values.read_times(options["time"])
    rates: dict[str, Any] = {
        rate: typed_values.read_rates(structure, f"--{rate}", options[f"{rate}s"]) for rate in RATES[:2]
    }
    with working("computing tolerances"):
        return tolerance(
            structure.mechanism, given, outputs,
            clearance=dict(read_errors(structure, "--clearance", options["clearances"])),
            values=values, time=time, modes=read_assembly_modes(structure, options["modes"]) or None, **rates,
            **{word: options[word] for word in ("count", "seed", "sigmas")}, **_percentiles(options["percentiles"]),
        )  # fmt: skip


def _percentiles(given: Sequence[str]) -> dict[str, Any]:
    """Return the percentiles given, as an argument of `tolerance`."""
    from compoundkin.cli.typed_values import read_number

    how = "write percents: 5,50,95"
    read = tuple(read_number(text.removesuffix("%"), "--percentile", how) for text in split_names(given))
    return {"percentiles": read} if read else {}


def read_errors(structure: Structure, option: str, given: Sequence[str]) -> Iterator[tuple[str, Any]]:
    """Yield names with their errors in radians or lengths, one number or two. Raises InvalidInput."""
    from math import radians

    from compoundkin.cli.typed_values import read_number
    from compoundkin.studies.study_document import is_angle_dimension

    read = set()
    for text in split_names(given):
        name, _, value = text.rpartition("=")
        where, parts = f"{option} {text}", value.split(":")
        if not name or len(parts) > 2:
            raise InvalidInput(Problem(where, "this is no tolerance", HOW))
        if name in read:
            raise InvalidInput(Problem(where, f"{name} is given twice", "leave one of them out"))
        read.add(name)
        is_angle = is_angle_dimension(structure.mechanism, structure.driven_angles, name)
        numbers = [read_number(re.sub(r"^(\u00b1|\+/?-)", "", part.strip()), where, HOW) for part in parts]
        numbers = [radians(one) if is_angle else one for one in numbers]
        yield name, numbers[0] if len(numbers) == 1 else tuple(numbers)
