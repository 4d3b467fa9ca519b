"""`compoundkin tolerance`: what tolerances of dimensions and play in pins do to outputs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.suffixes import SUFFIXES, file_format, suffix_of
from compoundkin.cli.drive_options import motion_options
from compoundkin.cli.file_options import (
    load_mechanism,
    mechanism_argument,
    put_report,
    put_table,
    report_or_table_options,
)
from compoundkin.cli.solve import explain_gaps
from compoundkin.cli.structure import report_unsolvable

if TYPE_CHECKING:
    from compoundkin.kinematics.table import Table
    from compoundkin.structure import Structure
    from compoundkin.studies.tolerances.tolerance_analysis import ToleranceAnalysis

HOW = "write NAME=0.05, or NAME=-0.02:0.05 for both deviations"


@click.command(
    epilog="""\b
Examples:
  compoundkin tolerance six-bar --tolerance crank.D=0.05 --output G.x
  compoundkin tolerance six-bar --tolerance crank.D=0.05 --clearance C=0.01
  compoundkin tolerance six-bar --tolerance slot.angle=-0.1:0.2 --at 35
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
@click.option("--bands", is_flag=True, help="A table with the bands of the outputs at every pose.")
@motion_options
@report_or_table_options
def command(file: str, bands: bool, form: str | None, path: str | None, **asked: Any) -> int:
    """Tell what tolerances do to the outputs: worst case, deviation, who contributes what.

    It is found from exact slopes, and beside it in random designs. -o PATH.csv is the table of contributions, with
    --bands that of all poses.
    """
    from compoundkin.structure import decompose
    from compoundkin.view.report import report
    from compoundkin.view.report.study_reports import tolerance_report

    tabulated = is_tolerance_table(bands, form, path)
    structure = decompose(load_mechanism(file))
    if structure.faults:
        put_report(report(structure), form, path if not tabulated else None)
        return report_unsolvable(len(structure.faults))
    found = analyse(structure, asked)
    if tabulated:
        put_table(bands_table(found) if bands else found.table(), path)
    else:
        put_report(tolerance_report(found), form, path)
    return 0 if found.motion.assembled.all() else explain_gaps(found.motion)


def is_tolerance_table(bands: bool, form: str | None, path: str | None) -> bool:
    """Tell whether a table is asked for. Raises InvalidInput for suffixes that do not fit."""
    from compoundkin.base.errors import InvalidInput, Problem

    if bands and form is not None:
        raise InvalidInput(Problem(f"--format {form}", "--bands is a table", "leave one of them out"))
    only_table = path is not None and suffix_of(path) in SUFFIXES["table"].keys() - SUFFIXES["report"].keys()
    tabulated = bands or (only_table and form is None)
    if path is not None and form is None:
        file_format("table" if tabulated else "report", path)
    return tabulated


def bands_table(found: ToleranceAnalysis) -> Table:
    """Return the bands of all outputs that have some."""
    from compoundkin.base.errors import InvalidInput, Problem

    if not any(one.is_course for one in found.values()):
        what = "the outputs are figures of the whole motion"
        raise InvalidInput(Problem("--bands", what, "name an output that has a value at every pose"))
    return found.bands()


def analyse(structure: Structure, asked: dict[str, Any]) -> ToleranceAnalysis:
    """Return the analysis that the options ask for."""
    from compoundkin.base.errors import InvalidInput, Problem
    from compoundkin.cli import typed_values
    from compoundkin.cli.drive_options import read_assembly_modes
    from compoundkin.cli.shell import working
    from compoundkin.model.attributes import RATES
    from compoundkin.studies.tolerances.tolerance import tolerance

    outputs = asked["outputs"] or structure.mechanism.outputs
    if not outputs:
        raise InvalidInput(Problem("--output", "no output is named", "such as --output G.x.stroke"))
    given = dict(read_errors(structure, "--tolerance", asked["tolerances"]))
    rates: dict[str, Any] = {
        what: typed_values.read_rates(structure, f"--{what}", asked[f"{what}s"]) for what in RATES[:2]
    }
    with working("finding what tolerances do"):
        return tolerance(
            structure.mechanism, given, outputs,
            clearance=dict(read_errors(structure, "--clearance", asked["clearances"])),
            values=typed_values.read_driver_values(structure, asked) or None, time=typed_values.read_times(asked["time"]),
            modes=read_assembly_modes(structure, asked["modes"]) or None, **rates,
            **{word: asked[word] for word in ("count", "seed", "sigmas")},
        )  # fmt: skip


def read_errors(structure: Structure, option: str, given: Sequence[str]) -> Iterator[tuple[str, Any]]:
    """Yield names with their errors, radians or lengths: one number, or two. Raises InvalidInput."""
    from math import radians

    from compoundkin.base.errors import InvalidInput, Problem
    from compoundkin.cli.drive_options import split_names
    from compoundkin.cli.typed_values import read_number
    from compoundkin.studies.study_document import is_angle_dimension

    told = set()
    for text in split_names(given):
        name, _, value = text.rpartition("=")
        where, parts = f"{option} {text}", value.split(":")
        if not name or len(parts) > 2:
            raise InvalidInput(Problem(where, "this is no tolerance", HOW))
        if name in told:
            raise InvalidInput(Problem(where, f"{name} is given twice", "leave one of them out"))
        told.add(name)
        is_angle = is_angle_dimension(structure.mechanism, structure.driven_angles, name)
        numbers = [read_number(part, where, HOW) for part in parts]
        numbers = [radians(one) if is_angle else one for one in numbers]
        yield name, numbers[0] if len(numbers) == 1 else tuple(numbers)
