"""`compoundkin forces`: what acts in all pairs or on a link, drivers' efforts, what the frame is shaken by."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import click

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import SUFFIXES, alternatives, file_format, suffix_of
from compoundkin.cli.drive_options import (
    DESIGN,
    HOLDING,
    STATICS,
    drive_options,
    explain_gaps,
    find_forces,
    load_options,
    solve_motion,
    with_options,
)
from compoundkin.cli.file_options import (
    exit_code,
    is_table,
    mechanism_argument,
    put_picture,
    put_report,
    put_table,
    report_or_table_options,
    solvable_structure,
    to_file,
)
from compoundkin.cli.shell import put, working

SHEET = click.option(
    "--sheet", is_flag=True, help="Write free bodies and equations of each link at one pose, to be printed."
)
ON = click.option("--on", "on", default="", metavar="LINK", help="Print all that acts on a link: its free body.")

# Options of the forces along bars, and the names of those that need --strength.
OF_STRENGTH = ("bars", "sections", "elasticity", "pins")
STRENGTH_OPTIONS: tuple[Any, ...] = (
    click.option("--strength", is_flag=True, help="Print forces along the bars of links; with -o PATH.svg their "
                 "diagrams, with -o PATH.csv all loads on each link."),
    click.option("--bar", "bars", multiple=True, metavar="LINK", help="Of this link alone; may be repeated."),
    click.option("--section", "sections", multiple=True, metavar="LINK=SIZE", help="Its section, for stresses: "
                 "rod=8x20, width and height in the plane, rod=12, a diameter, rod=12/2, a tube with its wall."),
    click.option("--elasticity", multiple=True, metavar="LINK=NUMBER", help="Its modulus of elasticity, for "
                 "buckling; with --section."),
    click.option("--pin", "pins", multiple=True, metavar="PIN=DIAMETER,WIDTH", help="The diameter of a pin and the "
                 "width in its bearing, for shear and pressure; a third number: how many sections are sheared."),
)  # fmt: skip


def strength_options(command: Any) -> Any:
    """Add the options of the forces along bars to a command."""
    return with_options(command, STRENGTH_OPTIONS)


@click.command(
    epilog="""\b
Examples:
  compoundkin forces linkage.toml
  compoundkin forces linkage.toml --speed 300rpm --step 1
  compoundkin forces linkage.toml --at 35 --statics
  compoundkin forces linkage.toml --at 35 --on rod
  compoundkin forces linkage.toml --at 35 --statics --sheet -o sheet.html
  compoundkin forces linkage.toml --speed 300rpm --strength
  compoundkin forces linkage.toml --speed 300rpm --strength -o bars.svg
  compoundkin forces linkage.toml --strength --section rod=8x20 --pin B=12,20
  compoundkin forces scissor-lift --at 1.6 --statics --load T=0,-3000
  compoundkin forces linkage.toml --output crank.effort,A.force -o forces.csv
  compoundkin forces linkage.toml -o forces.md
"""
)
@mechanism_argument
@drive_options
@DESIGN
@STATICS
@HOLDING
@load_options
@ON
@SHEET
@strength_options
@report_or_table_options
def command(
    file: str, design: int, statics: bool, holding: str, on: str, sheet: bool, strength: bool, form: str | None,
    path: str | None, **options: Any,
) -> int:  # fmt: skip
    """Print forces in all pairs, efforts of drivers, the force on the frame.

    The mechanism states its units of length, mass and force, and has masses or loads. What is assumed comes first.
    With --output or -o PATH.csv it is a table with a row per pose. Exit code 3: some poses cannot be assembled.
    """
    from compoundkin.cli import typed_values
    from compoundkin.view.report.forces_section import forces_report
    from compoundkin.view.report.forces_section import sheet as force_sheet

    if strength:
        others = {"--on": on, "--sheet": sheet, "--output": options["outputs"], "--format": form}
        if excluded := next((name for name, given in others.items() if given), ""):
            raise InvalidInput(Problem("--strength", f"it does not go with {excluded}", "leave one of them out"))
        return _strength(file, path, statics, holding, options)
    report = _report_name(on, sheet, options)
    tabulated = is_table(path, form, "--output" if options["outputs"] else "", report)
    structure = solvable_structure(
        file, form, path if not tabulated else None, lambda own: typed_values.with_loads(own, options)
    )
    if on:
        structure.mechanism.link(on)
    forces = find_forces(solve_motion(structure, options), statics, holding)
    if tabulated:
        put_table(forces.table(*options["outputs"]), path)
        return explain_gaps(forces.motion)
    if sheet:
        put_report(force_sheet(forces, design=design), form, path)
        return explain_gaps(forces.motion)
    with working("finding extremes"):
        result = forces_report(forces, design, on)
    put_report(result, form, path)
    return exit_code(result)


@click.command(
    epilog="""\b
Examples:
  compoundkin size shaper-cutting-force
  compoundkin size press.toml --speed 60rpm --motors mine.toml
  compoundkin size press.toml --speed 60rpm --gear 12 > motors.txt
  compoundkin size shaper-cutting-force --motor "servo 100 W" -o servo.svg
"""
)
@mechanism_argument
@drive_options
@DESIGN
@load_options
@click.option("--motors", metavar="FILE", help="A TOML file with your own [[motors]]; generic ones without it.")
@click.option("--gear", type=float, help="The speed of the shaft over that of the driver; the best one without it.")
@click.option("--efficiency", type=float, default=1.0, show_default=True, help="The efficiency of the gear.")
@click.option("--driver", metavar="NAME", help="The driver to size; may be left out where there is one.")
@click.option("--motor", metavar="NAME", help="The motor to draw; the smallest that does without it.")
@to_file(f"Draw the torque over the speed at the motor's shaft: {alternatives('plot')}.")
def size_command(
    file: str, design: int, motors: str | None, gear: float | None, efficiency: float, driver: str | None,
    motor: str | None, path: str | None, **options: Any,
) -> int:  # fmt: skip
    """Print what a driver needs over the motion, and which motors give it, each behind its best gear.

    Torques are in N m, speeds in rpm. Exit code 1: no motor of the list does.
    """
    from compoundkin.cli import typed_values
    from compoundkin.dynamics.motor_sizing import sizing

    if path is not None:
        file_format("plot", path)
    elif motor is not None:
        raise InvalidInput(Problem("--motor", "it is of the plot", "give -o PATH.svg too"))
    structure = solvable_structure(file, None, None, lambda own: typed_values.with_loads(own, options))
    forces = find_forces(solve_motion(structure, options), False, "")
    found = sizing(forces, motors, driver=driver, gear=gear, efficiency=efficiency, design=design)
    if path is None:
        put(found.text() + "\n")
    else:
        from compoundkin.view.plot import motor_curves

        put_picture(motor_curves(found, motor), path)
    return 0 if found.chosen else 1


def _report_name(on: str, sheet: bool, options: Mapping[str, Any]) -> str:
    """Return the option that asks for another report. Raises InvalidInput for what does not go with it."""
    if unused := next((name for name in OF_STRENGTH if options[name]), ""):
        raise InvalidInput(Problem(f"--{unused.removesuffix('s')}", "it concerns bars", "give --strength too"))
    if on and sheet:
        raise InvalidInput(Problem("--sheet", f"it has all links, --on {on} one", "leave one of them out"))
    return "--sheet" if sheet else f"--on {on}" if on else ""


def _strength(file: str, path: str | None, statics: bool, holding: str, options: dict[str, Any]) -> int:
    """Print forces along the bars of links, or write the loads on them; return the exit code."""
    from compoundkin.cli import typed_values
    from compoundkin.dynamics.strength import strength

    is_plot = path is not None and suffix_of(path) in SUFFIXES["plot"]
    if path is not None and not is_plot:
        file_format("table", path)
    own = _sizes(options)
    structure = solvable_structure(file, None, None, lambda own: typed_values.with_loads(own, options))
    found = strength(find_forces(solve_motion(structure, options), statics, holding), *options["bars"], **own)
    if path is None:
        put(f"{found.text()}\n")
    elif is_plot:
        from compoundkin.view.plot import bar_diagrams

        put_picture(bar_diagrams(found), path)
    else:
        put_table(found.table(), path)
    return explain_gaps(found.forces.motion)


def _sizes(options: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Return sections, moduli and pins as `strength` takes them."""
    sections, moduli, pins = (_named(name, options[key]) for name, key in
                              (("section", "sections"), ("elasticity", "elasticity"), ("pin", "pins")))  # fmt: skip
    return {
        "sections": {link: _size_of_section(where, text) for where, link, text in sections},
        "elasticity": {link: _numbers(where, text, ",")[0] for where, link, text in moduli},
        "pins": {letter: _numbers(where, text, ",") for where, letter, text in pins},
    }


def _named(option: str, given: Sequence[str]) -> Iterator[tuple[str, str, str]]:
    """Yield option, name and text of each NAME=TEXT. Raises InvalidInput for another."""
    for text in given:
        name, sign, value = text.partition("=")
        if not (name and sign and value):
            raise InvalidInput(
                Problem(f"--{option} {text}", "it is no name with a value", f"write --{option} NAME=...")
            )
        yield f"--{option} {name}", name, value


def _numbers(where: str, text: str, sign: str) -> tuple[float, ...]:
    from compoundkin.cli.typed_values import read_number

    return tuple(read_number(part, where, f"write numbers with {sign!r} between") for part in text.split(sign))


def _size_of_section(where: str, text: str) -> dict[str, float]:
    """Return the section that a text means: 8x20, 12 or 12/2."""
    names, sign = (("width", "height"), "x") if "x" in text else (("diameter", "wall"), "/")
    numbers = _numbers(where, text, sign)
    if len(numbers) > 2 or (sign == "x" and len(numbers) < 2):
        raise InvalidInput(Problem(where, f"{text!r} is no section", "write 8x20, a diameter, or a diameter/wall"))
    return dict(zip(names, numbers, strict=False))
