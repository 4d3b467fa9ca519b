"""`compoundkin structure`: what a mechanism is made of."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.cli.drive_options import AT, SECOND_RATE, pose_options, read_estimates, solve_motion_at
from compoundkin.cli.file_options import (
    load_mechanism,
    mechanism_argument,
    put_report,
    report_options,
    report_unsolvable,
)
from compoundkin.cli.shell import NOT_ASSEMBLED, working

if TYPE_CHECKING:
    from compoundkin.kinematics import Motion
    from compoundkin.structure import Structure
    from compoundkin.view.report.report_data import Section

# Options of the equations, by the names of their values; all but the first need a pose.
OF_EQUATIONS = {
    "order": "--order",
    "at": "--at",
    "newton": "--newton",
    "estimates": "--estimate",
    "speeds": "--speed",
    "accelerations": "--acceleration",
    "modes": "--mode",
    "design": "--design",
}


@click.command(
    epilog="""\b
Examples:
  compoundkin structure six-bar
  compoundkin structure linkage.toml --format markdown
  compoundkin structure stephenson-ii --alternatives
  compoundkin structure slider-crank --equations -o loops.md
  compoundkin structure slider-crank --equations --order 2 --at 35
  compoundkin structure four-bar-norton --equations --at 40 --newton
"""
)
@mechanism_argument
@click.option("--alternatives", is_flag=True, help="Add every other choice of frame and driver, and what it gives.")
@click.option("--equations", is_flag=True, help="Add the vector-loop equations; as LaTeX in Markdown and JSON.")
@click.option("--order", type=click.IntRange(0, 2), default=0, metavar="ORDER",
              help="With --equations: 1 adds the equations of velocities, 2 of accelerations.")  # fmt: skip
@AT
@pose_options
@SECOND_RATE
@click.option("--newton", is_flag=True, help="With --equations: add Newton's iterations of the pose.")
@click.option("--estimate", "estimates", multiple=True, metavar="NAME=VALUE",
              help="Where they start: an unknown, degrees or length; as drawn if left out.")  # fmt: skip
@report_options
def command(file: str, alternatives: bool, equations: bool, form: str | None, path: str | None, **options: Any) -> int:
    """Take a mechanism apart: links, pairs, mobility, loops, Assur groups in solving order.

    Nothing is solved, unless equations are evaluated at a pose. What keeps a mechanism from being solved is listed with
    its remedies (exit code 2); exit code 3: the pose cannot be assembled.
    """
    from dataclasses import replace

    from compoundkin.structure import decompose
    from compoundkin.view.report import report

    _check_options(equations, options)
    with working("taking the mechanism apart"):
        structure = decompose(load_mechanism(file))
        result = report(structure)
    code = 0
    if equations:
        sections, code = equation_sections(structure, options)
        result = replace(result, sections=(*result.sections, *sections))
    if alternatives:
        from compoundkin.view.report.atlas_sections import alternatives_section

        result = replace(result, sections=(*result.sections, alternatives_section(structure)))
    put_report(result, form, path)
    return report_unsolvable(len(structure.faults)) if structure.faults else code


def _check_options(equations: bool, options: dict[str, Any]) -> None:
    """Raise InvalidInput for options that need others."""
    given = [option for name, option in OF_EQUATIONS.items() if options[name]]
    if given and not equations:
        raise InvalidInput(Problem(given[0], "it goes with the equations", "add --equations"))
    for name, order in (("speeds", 1), ("accelerations", 2)):
        if options[name] and options["order"] < order:
            what = f"without --order {order} it has no effect"
            raise InvalidInput(Problem(OF_EQUATIONS[name], what, f"add --order {order}"))
    if options["estimates"] and not options["newton"]:
        raise InvalidInput(Problem("--estimate", "estimates are for Newton's iterations", "add --newton"))


def equation_sections(structure: Structure, options: Mapping[str, Any]) -> tuple[list[Section], int]:
    """Return the sections of the equations, and the exit code."""
    from compoundkin.analysis.equations.loop_equations import loop_equations
    from compoundkin.view.report.equations_sections import constants_section, equations_section, rates_section

    found = loop_equations(structure, options["order"])
    sections = [equations_section(found), constants_section(found), rates_section(found) if found.rates else None]
    code = 0
    if any(options[name] for name in OF_EQUATIONS if name != "order") and not structure.faults:
        from compoundkin.view.report.equations_sections import pose_section

        driven, motion = _solved(structure, options)
        sections.append(pose_section(found, motion, options["design"]))
        if options["newton"]:
            sections.append(_newton(structure, driven, motion, options["estimates"]))
        code = 0 if motion.assembled.all() else NOT_ASSEMBLED
    return [section for section in sections if section is not None], code


def _solved(structure: Structure, options: Mapping[str, Any]) -> tuple[dict[str, float], Motion]:
    """Return the drivers' values at the pose, and the motion there."""
    from compoundkin.cli import typed_values

    driven = typed_values.read_pose(structure, options["at"])
    rest = {name: options[name] for name in ("speeds", "accelerations", "modes")}
    return driven, solve_motion_at(structure, driven, {**rest, "outputs": (), "order": max(options["order"], 1)})


def _newton(structure: Structure, driven: dict[str, float], motion: Motion, estimates: tuple[str, ...]) -> Section:
    """Return the section on Newton's iterations."""
    import numpy as np

    from compoundkin.analysis.equations.loop_equations import loop_equations
    from compoundkin.analysis.equations.newton_iterations import newton_iterations
    from compoundkin.analysis.equations.reduced_system import pose_values
    from compoundkin.view.report.equations_sections import newton_section

    unknowns = loop_equations(structure).system.unknowns
    start = read_estimates({own.key: own.is_angle for own in unknowns}, estimates)
    values = {**{name: float(np.ravel(one.value)[0]) for name, one in motion.drives.items()}, **driven}
    solved = {key: float(np.ravel(value)[0]) for key, value in pose_values(motion).items()}
    found = newton_iterations(structure, values, start)
    mechanism = structure.mechanism
    return newton_section(found, mechanism.unit, mechanism.geometry.size, solved if motion.assembled.all() else None)
