"""`compoundkin circuits`, `compoundkin singularities`: circuits and branches; where branches of a motion meet."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.cli.drive_options import DESIGN, drive_options, solve_motion
from compoundkin.cli.file_options import (
    exit_code,
    load_mechanism,
    mechanism_argument,
    put_report,
    report_options,
    solvable_structure,
)
from compoundkin.cli.shell import working

if TYPE_CHECKING:
    from compoundkin.structure import Structure


@click.command(
    epilog="""\b
Examples:
  compoundkin circuits triple-rocker
  compoundkin circuits five-bar --driver left --at right=100
  compoundkin circuits linkage.toml --driver cylinder --from 20 --to 35
  compoundkin circuits stephenson-iii -o circuits.md
"""
)
@mechanism_argument
@click.option("--driver", "driver", metavar="NAME", help="The driver that moves, where there are several.")
@click.option(
    "--at",
    "at",
    multiple=True,
    metavar="NAME=VALUE",
    help="Where another driver stands, degrees or length; as drawn, or the first of its range, if left out.",
)
@click.option("--from", "start", type=float, metavar="VALUE", help="The least value of the driver.")
@click.option("--to", "stop", type=float, metavar="VALUE", help="The greatest one.")
@report_options
def command(
    file: str,
    driver: str | None,
    at: tuple[str, ...],
    start: float | None,
    stop: float | None,
    form: str | None,
    path: str | None,
) -> int:
    """Find all circuits that a driver moves a mechanism through. Print branches, limits, whether it turns fully.

    On a circuit the mechanism gets from any configuration to any other without being taken apart. A limit position
    comes with the group that reaches its limit there. Exit code 3: the mechanism cannot be assembled.
    """
    from compoundkin.configurations.circuit_search import circuits
    from compoundkin.kinematics.solution import solving_order_of
    from compoundkin.view.report.configurations_section import circuits_report

    structure = solving_order_of(load_mechanism(file)).structure
    fixed = _fixed(structure, at)
    with working("following all circuits"):
        result = circuits_report(
            circuits(structure, driver, fixed, between=driver_range(structure, driver, start, stop))
        )
    put_report(result, form, path)
    return 0


def _fixed(structure: Structure, at: Sequence[str]) -> dict[str, float]:
    """Return the values given for other drivers."""
    from compoundkin.cli import typed_values

    named = {text.rpartition("=")[0] for text in at}
    return {name: value for name, value in typed_values.read_pose(structure, at).items() if name in named} if at else {}


def driver_range(
    structure: Structure, driver: str | None, start: float | None, stop: float | None
) -> tuple[float, float] | None:
    """Return the range of the driver, in radians or lengths."""
    import numpy as np

    if start is None and stop is None:
        return None
    if start is None or stop is None:
        raise InvalidInput(Problem("--from, --to", "a range has two ends", "give both"))
    name = driver or structure.mechanism.drives[0].name
    factor = float(np.deg2rad(1.0)) if structure.driven_angles.get(name, False) else 1.0
    return start * factor, stop * factor


@click.command(
    epilog="""\b
Examples:
  compoundkin singularities parallelogram
  compoundkin singularities triple-rocker --from -180 --to 180
  compoundkin singularities slider-crank --output stroke.value
  compoundkin singularities linkage.toml --format json
"""
)
@mechanism_argument
@drive_options
@DESIGN
@report_options
def singularities_command(file: str, design: int, form: str | None, path: str | None, **options: Any) -> int:
    """List the singular poses of a motion, between its poses too: where they are, of which kind, what opens there.

    They are limit positions of the driver, change points with the branches that meet there, dead points of outputs.
    Outputs are those of --output, or of the file. Exit code 3: some poses cannot be assembled.
    """
    from compoundkin.analysis.singularities import singularities
    from compoundkin.kinematics.one_design import motion_of_design
    from compoundkin.view.report.configurations_section import singularities_report

    structure = solvable_structure(file, form, path)
    motion = motion_of_design(solve_motion(structure, options), design)
    with working("finding singular poses"):
        result = singularities_report(singularities(motion, options["outputs"]))
    put_report(result, form, path)
    return exit_code(result)
