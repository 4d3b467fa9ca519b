"""`compoundkin simulate`: how a mechanism moves under its masses and loads."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.suffixes import SUFFIXES, Kind, alternatives, file_format, suffix_of
from compoundkin.cli.drive_options import read_assembly_modes, split_names
from compoundkin.cli.file_options import load_mechanism, mechanism_argument, put_report, to_file
from compoundkin.cli.shell import say
from compoundkin.cli.structure import report_unsolvable
from compoundkin.model.attributes import SPEED

if TYPE_CHECKING:
    from compoundkin.dynamics.simulation.simulation import Simulation
    from compoundkin.structure import Structure

# What a simulation is written as, by the suffix of the file; the first that has it.
KINDS: tuple[Kind, ...] = ("table", "animation", "page", "report")
# After the name of a driver whose speed is given.
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
@click.option("--step", type=float, metavar="SECONDS", help="From one pose told to the next.")
@click.option("--tolerance", type=float, default=1e-10, show_default=True, help="The error of a step.")
@click.option("--mode", "modes", multiple=True, metavar="LINK=SIGN", help="Assembly mode, +1 or -1.")
@click.option("--output", "outputs", multiple=True, metavar="QUANTITY", callback=lambda _c, _p, given: split_names(given),
              help="Columns of a table, such as G.velocity, A.force; repeat it, or write commas.")  # fmt: skip
@to_file(f"Write {alternatives('table')}, {alternatives('animation')}, or the report as .html, .md or .txt.")
def command(file: str, path: str | None, outputs: tuple[str, ...], **asked: Any) -> int:
    """Let a mechanism go under its masses and loads, and follow it in time.

    Its drivers do not drive: their coordinates are found. Those with a law keep it. The energy error is told.
    """
    from compoundkin.structure import decompose
    from compoundkin.view.report import report
    from compoundkin.view.report.motion_report import simulation_report

    kind = output_kind(path)
    structure = decompose(load_mechanism(file))
    if structure.faults:
        put_report(report(structure), None, None)
        return report_unsolvable(len(structure.faults))
    found = run_simulation(structure, asked)
    if path is None or kind == "report":
        put_report(simulation_report(found), None, path)
    else:
        write_simulation(found, kind, path, outputs)
    return 0


def output_kind(path: str | None) -> Kind:
    """Return as what a path is written. Raises InvalidInput for a suffix of none."""
    if path is None:
        return "report"
    found = next((kind for kind in KINDS if suffix_of(path) in SUFFIXES[kind]), KINDS[0])
    file_format(found, path)
    return found


def run_simulation(structure: Structure, asked: dict[str, Any]) -> Simulation:
    """Return the simulation that the options ask for."""
    import numpy as np

    from compoundkin.cli.shell import counting
    from compoundkin.dynamics.simulation.forward_dynamics import simulate
    from compoundkin.files.written_quantities import spaced

    step, until = asked["step"], asked["until"]
    times = None if step is None else spaced(0.0, until, step)
    held = {name: _value(structure, "--hold", f"{name}={value}") for name, value in map(_name_and_value, asked["held"])}
    modes = read_assembly_modes(structure, asked["modes"]) or None
    with counting("simulating", "steps") as progress, np.errstate(all="ignore"):
        return simulate(
            structure.mechanism, start=_start(structure, asked["start"]), until=until, prescribed=held or None,
            times=times, tolerance=asked["tolerance"], modes=modes, progress=progress,
        )  # fmt: skip


def _name_and_value(text: str) -> tuple[str, str]:
    name, _, value = text.rpartition("=")
    return name, value


def _value(structure: Structure, option: str, text: str) -> float:
    """The value of one driver, radians or a length."""
    from compoundkin.cli.typed_values import read_pose

    name = _name_and_value(text)[0] or structure.mechanism.drives[0].name
    return read_pose(structure, [text], option)[name]


def _start(structure: Structure, given: Sequence[str]) -> dict[str, Any] | None:
    """Where drivers begin and how fast. Raises InvalidInput for a speed without a value."""
    from compoundkin.base.errors import InvalidInput, Problem
    from compoundkin.cli.typed_values import read_rates

    fast = [text for text in given if _name_and_value(text)[0].endswith(OF_SPEED)]
    places = [text for text in given if text not in fast]
    drivers = [drive.name for drive in structure.mechanism.drives]
    values = {_name_and_value(text)[0] or drivers[0]: _value(structure, "--start", text) for text in places}
    named = [f"{_name_and_value(text)[0].removesuffix(OF_SPEED)}={_name_and_value(text)[1]}" for text in fast]
    speeds = read_rates(structure, "--speed", named) or {}
    for name in speeds:
        if name not in values:
            what = f"where {name} begins is not told"
            raise InvalidInput(Problem(f"--start {name}{OF_SPEED}", what, f"give --start {name}=VALUE too"))
    return {name: (value, speeds.get(name, 0.0)) for name, value in values.items()} or None


def write_simulation(found: Simulation, kind: Kind, path: str, outputs: Sequence[str]) -> None:
    """Write a simulation as a table, an animation or a page."""
    from compoundkin.cli.shell import counting, working
    from compoundkin.files import save

    if kind == "table":
        save(found.motion.table(*outputs), path)
    elif kind == "animation":
        from compoundkin.view.animation import animate

        with counting("drawing", "frames") as progress:
            animate(found.motion).save(path, progress)
    else:
        from compoundkin.view.report.motion_report import whole_simulation_report

        with working("drawing"):
            whole_simulation_report(found, outputs).page().save(path)
    say(f"Wrote {path}.")
