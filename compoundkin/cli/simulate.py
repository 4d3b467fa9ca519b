"""`compoundkin simulate`: how a mechanism moves under its masses and loads."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import SUFFIXES, Kind, alternatives, file_format, suffix_of
from compoundkin.cli.drive_options import MODE, load_options, names_option, read_assembly_modes
from compoundkin.cli.file_options import mechanism_argument, put_report, solvable_structure, to_file
from compoundkin.cli.shell import counting, say, working
from compoundkin.model.attributes import SPEED

if TYPE_CHECKING:
    from compoundkin.dynamics.simulation.simulation import Simulation
    from compoundkin.structure import Structure

# What a simulation is written as: the first kind that has the suffix of the file.
KINDS: tuple[Kind, ...] = ("table", "animation", "page", "report")
# The ending of a driver's name before a given speed.
OF_SPEED = f".{SPEED}"


@click.command(
    epilog="""\b
Examples:
  compoundkin simulate pendulum.toml --until 2 --start arm=60
  compoundkin simulate bar.toml --until 1 --start a=30 --start a.speed=5
  compoundkin simulate bar.toml --until 2 --output a,G.velocity -o fall.csv
  compoundkin simulate five-bar.toml --until 1 --hold left=90 -o fall.html
  compoundkin simulate pendulum.toml --until 2 -o fall.gif
"""
)
@mechanism_argument
@click.option("--until", type=float, required=True, metavar="SECONDS", help="When it ends.")
@click.option("--start", "start", multiple=True, metavar="[NAME=]VALUE",
              help="Where a driver begins, degrees or length; NAME.speed=5 or 300rpm its speed, zero if left out. "
              "Without any it rests as drawn.")  # fmt: skip
@click.option("--hold", "held", multiple=True, metavar="NAME=VALUE", help="A driver that is held there.")
@click.option("--step", type=float, metavar="SECONDS", help="From one pose of the results to the next.")
@click.option("--tolerance", type=float, default=1e-10, show_default=True, help="The error of a step.")
@MODE
@load_options
@names_option("--output", "outputs", "QUANTITY",
              "Columns of a table, such as G.velocity, A.force; repeat it, or write commas.")  # fmt: skip
@to_file(f"Write {alternatives('table')}, {alternatives('animation')}, or the report as .html, .md or .txt.")
def command(file: str, path: str | None, outputs: tuple[str, ...], **options: Any) -> int:
    """Let a mechanism go under its masses and loads, and follow it in time.

    Its drivers do not drive: their coordinates are computed. Those with a law follow it. The energy error is reported.
    """
    from compoundkin.cli.typed_values import with_loads
    from compoundkin.view.report.simulation_report import simulation_report

    kind = output_kind(path)
    structure = solvable_structure(file, None, None, lambda own: with_loads(own, options))
    found = run_simulation(structure, options)
    if path is None or kind == "report":
        put_report(simulation_report(found), None, path)
    else:
        write_simulation(found, kind, path, outputs)
    return 0


def output_kind(path: str | None) -> Kind:
    """Return the kind of file of a path. Raises InvalidInput for an unknown suffix."""
    if path is None:
        return "report"
    found = next((kind for kind in KINDS if suffix_of(path) in SUFFIXES[kind]), KINDS[0])
    file_format(found, path)
    return found


def run_simulation(structure: Structure, options: dict[str, Any]) -> Simulation:
    """Return the simulation that the options describe."""
    import numpy as np

    from compoundkin.dynamics.simulation.forward_dynamics import simulate
    from compoundkin.files.read_values import spaced

    step, until = options["step"], options["until"]
    times = None if step is None else spaced(0.0, until, step)
    held = {
        name: _value(structure, "--hold", f"{name}={value}") for name, value in map(_name_and_value, options["held"])
    }
    modes = read_assembly_modes(structure, options["modes"]) or None
    with counting("simulating", "steps") as progress, np.errstate(all="ignore"):
        return simulate(
            structure.mechanism, start=_start(structure, options["start"]), until=until, prescribed=held or None,
            times=times, tolerance=options["tolerance"], modes=modes, progress=progress,
        )  # fmt: skip


def _name_and_value(text: str) -> tuple[str, str]:
    name, _, value = text.rpartition("=")
    return name, value


def _value(structure: Structure, option: str, text: str) -> float:
    """Return the value of one driver, radians or a length."""
    from compoundkin.cli.typed_values import read_pose

    name = _name_and_value(text)[0] or structure.mechanism.drives[0].name
    return read_pose(structure, [text], option)[name]


def _start(structure: Structure, given: Sequence[str]) -> dict[str, Any] | None:
    """Return initial values and speeds of drivers. Raises InvalidInput for a speed without a value."""
    from compoundkin.cli.typed_values import read_rates

    fast = [text for text in given if _name_and_value(text)[0].endswith(OF_SPEED)]
    places = [text for text in given if text not in fast]
    drivers = [drive.name for drive in structure.mechanism.drives]
    values = {_name_and_value(text)[0] or drivers[0]: _value(structure, "--start", text) for text in places}
    named = [f"{_name_and_value(text)[0].removesuffix(OF_SPEED)}={_name_and_value(text)[1]}" for text in fast]
    speeds = read_rates(structure, "--speed", named) or {}
    for name in speeds:
        if name not in values:
            what = f"the initial value of {name} is missing"
            raise InvalidInput(Problem(f"--start {name}{OF_SPEED}", what, f"give --start {name}=VALUE too"))
    return {name: (value, speeds.get(name, 0.0)) for name, value in values.items()} or None


def write_simulation(found: Simulation, kind: Kind, path: str, outputs: Sequence[str]) -> None:
    """Write a simulation as a table, an animation or a page."""
    from compoundkin.files.saved_files import save

    if kind == "table":
        save(found.table(*outputs), path)
    elif kind == "animation":
        from compoundkin.view.animation import animate

        with counting("drawing", "frames") as progress:
            animate(found.motion).save(path, progress)
    else:
        from compoundkin.view.report.simulation_report import whole_simulation_report

        with working("drawing"):
            whole_simulation_report(found, outputs).page().save(path)
    say(f"Wrote {path}.")
