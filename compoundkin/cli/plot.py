"""`compoundkin plot`: a motion as a picture."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import alternatives, file_format
from compoundkin.cli.drive_options import drive_options, explain_gaps, load_options, solve_motion
from compoundkin.cli.file_options import load_mechanism, mechanism_argument, put_picture, to_file
from compoundkin.cli.shell import working

if TYPE_CHECKING:
    from compoundkin.kinematics import Motion
    from compoundkin.model.mechanism import Mechanism
    from compoundkin.structure import Structure
    from compoundkin.view.plot import Plot


# Options of how a motion is solved, which circuits do not have, by the names of their values.
OF_MOTIONS = {
    "at": "--at",
    "step": "--step",
    "time": "--time",
    "speeds": "--speed",
    "accelerations": "--acceleration",
    "order": "--order",
    "modes": "--mode",
}

# Options of plots of quantities over something.
OF_QUANTITIES = {"against": "--against", "together": "--together", "others": "--with", "log": "--log",
                 "xlim": "--x-limits", "ylim": "--y-limits"}  # fmt: skip
LOG = ("x", "y", "xy")

# Plots of no motion, and the options that they have instead.
UNSOLVED = {
    "--circuits": "the range of the driver: --from and --to; where others stand: --drive NAME=VALUE",
    "--timing": "the range is that of the laws, or of the mechanism's times",
}


@click.command(
    epilog="""\b
Examples:
  compoundkin plot six-bar G.velocity bar.angle -o six-bar.png
  compoundkin plot crank-rocker rocker.transmission_angle -o transmission.png
  compoundkin plot toggle-press crank.effort --load D=-500,0 -o torque.png
  compoundkin plot six-bar G.x --against bar.angle --step 1 -o six-bar.svg
  compoundkin plot six-bar G.speed --log y --x-limits 90 270 -o part.png
  compoundkin plot crank-rocker rocker.angle --with triple-rocker -o both.png
  compoundkin plot crank-rocker rocker.angle --phase > phase.svg
  compoundkin plot jansen-leg foot --path --every 5 -o foot.pdf
  compoundkin plot elliptic-trammel --centrodes rod frame -o centrodes.png
  compoundkin plot triple-rocker rocker.angle --circuits -o circuits.svg
  compoundkin plot disc-cam-roller-program --timing -o timing.svg
"""
)
@mechanism_argument
@click.argument("quantities", nargs=-1, metavar="[QUANTITY]...")
@drive_options
@load_options
@click.option("--against", metavar="QUANTITY", help="What to draw over: driver, time, pose, or a quantity.")
@click.option("--together", is_flag=True, help="Quantities of one unit in one panel.")
@click.option("--with", "others", multiple=True, metavar="FILE", help="Another mechanism in the same plot.")
@click.option("--x-limits", "xlim", type=float, nargs=2, metavar="LOW HIGH", help="Ends of the horizontal axis.")
@click.option("--y-limits", "ylim", type=float, nargs=2, metavar="LOW HIGH", help="Ends of the vertical axes.")
@click.option("--log", type=click.Choice(LOG), help="Which axes are logarithmic.")
@click.option("--phase", "kinds", flag_value="phase", multiple=True, help="The quantity against its rate.")
@click.option("--polar", "kinds", flag_value="polar", multiple=True, help="Radii over the driver's angle.")
@click.option("--hodograph", "kinds", flag_value="hodograph", multiple=True, help="The curve of a vector's tip.")
@click.option("--bearing", "kinds", flag_value="bearing_loads", multiple=True,
              help="Polar diagrams of the forces in pairs: QUANTITY is the name of a pair.")  # fmt: skip
@click.option("--path", "kinds", flag_value="paths", multiple=True, help="The paths of points: coupler curves.")
@click.option("--centrodes", nargs=2, metavar="LINK ON", help="Fixed and moving centrode of a link seen from another.")
@click.option(
    "--circuits",
    "kinds",
    flag_value="circuits",
    multiple=True,
    help="Every branch of all circuits over the driver. Other drivers stand where --drive NAME=VALUE says.",
)
@click.option(
    "--timing",
    "kinds",
    flag_value="timing_chart",
    multiple=True,
    help="When drivers with laws, or cams made for programs, rise, fall and dwell.",
)
@click.option("--driver", metavar="NAME", help="With --circuits: the driver that moves, where there are several.")
@click.option("--every", type=click.IntRange(1), metavar="POSES", help="Distance of the marks along curves in a plane.")
@click.option("--title", help="Instead of the mechanism's own.")
@to_file(f"Write a {alternatives('plot')} file; SVG on stdout if left out.")
def command(file: str, quantities: tuple[str, ...], path: str | None, **options: Any) -> int:
    """Draw quantities of a motion. They go over its driver, over time, against each other, or as curves in the plane.

    QUANTITY is such as G.velocity, G.velocity.x, bar.angle, slot.rate; with --path a point. Without any, the file's own
    outputs. What cannot be assembled is shaded; stderr says why, and the exit code is 3.
    """
    from compoundkin.structure import decompose
    from compoundkin.view.plot.plot_style import require_matplotlib

    if path is not None:
        file_format("plot", path)
    require_matplotlib()
    _check_options(options)
    if "timing_chart" in options["kinds"]:
        put_picture(_timing_plot(load_mechanism(file), (*quantities, *options["outputs"]), options), path)
        return 0
    from compoundkin.cli.typed_values import with_loads

    structures = [decompose(with_loads(load_mechanism(one), options)) for one in (file, *options["others"])]
    names = (*quantities, *options["outputs"])
    if "circuits" in options["kinds"]:
        put_picture(_circuits_plot(structures[0], names, options), path)
        return 0
    order = _order(options, names or structures[0].mechanism.outputs)
    motions = [solve_motion(structure, {**options, "outputs": (), "order": order}) for structure in structures]
    put_picture(_plot_of_motions(motions, names, {**options, "files": (file, *options["others"])}), path)
    return next((code for motion in motions if (code := explain_gaps(motion))), 0)


def _check_options(options: Mapping[str, Any]) -> None:
    """Raise InvalidInput for options that do not go together."""
    called = {"paths": "path", "timing_chart": "timing", "bearing_loads": "bearing"}
    kinds = [f"--{called.get(kind, kind)}" for kind in options["kinds"]] + ["--centrodes"] * bool(options["centrodes"])
    if len(kinds) > 1:
        raise InvalidInput(Problem(" ".join(kinds), "a plot is of one kind", "leave all but one out"))
    for key, option in OF_QUANTITIES.items():
        if kinds and options[key]:
            raise InvalidInput(Problem(option, f"it does not go with {kinds[0]}", "leave one of them out"))
    if options["every"] and kinds in ([], ["--polar"], ["--circuits"], ["--timing"]):
        raise InvalidInput(Problem("--every", "it marks curves in a plane", "give --path, --phase or --hodograph too"))
    if options["driver"] and kinds != ["--circuits"]:
        raise InvalidInput(Problem("--driver", "it selects the driver of --circuits", "give --circuits too"))
    unfit = [key for key in OF_MOTIONS if options[key] not in (None, ())] if (kinds or [""])[0] in UNSOLVED else []
    if unfit:
        raise InvalidInput(Problem(OF_MOTIONS[unfit[0]], f"it does not go with {kinds[0]}", UNSOLVED[kinds[0]]))


def _order(options: Mapping[str, Any], names: tuple[str, ...]) -> int:
    """Return the order given, or the one that the quantities need: at least 2, one more for rates of phase plots."""
    from compoundkin.model.attributes import HIGHEST_ORDER, derivative_order

    if options["order"] is not None:
        return int(options["order"])
    against = () if options["against"] is None else (options["against"],)
    highest = max((derivative_order(name) for name in (*names, *against)), default=0)
    return min(max(2, highest + ("phase" in options["kinds"])), HIGHEST_ORDER)


def _plot_of_motions(motions: list[Motion], names: tuple[str, ...], options: Mapping[str, Any]) -> Plot:
    from compoundkin.view import plot

    title, every, motion = options["title"], options["every"], motions[0]
    if options["centrodes"]:
        if names:
            raise InvalidInput(Problem(names[0], "centrodes take no quantities", "leave it out"))
        return plot.centrodes(motion, *options["centrodes"], every=every, title=title)
    if not options["kinds"]:
        axes: dict[str, Any] = {key: options[key] for key in ("against", "xlim", "ylim", "log", "title")}
        called = options["files"] if len(motions) > 1 else ()
        return plot.plot(motions, *names, stacked=not options["together"], designs=called, **axes)
    kind = options["kinds"][0]
    if kind == "phase":
        if not 1 <= len(names) <= 2:
            what = f"there are {len(names)} quantities"
            raise InvalidInput(Problem("--phase", what, "name one, or two to be drawn against each other"))
        return plot.phase(motion, *names, every=every, title=title)
    if kind == "polar":
        return plot.polar(motion, *names, title=title)
    draw: Any = getattr(plot, kind)
    picture: Plot = draw(motion, *names, every=every, title=title)
    return picture


def _timing_plot(mechanism: Mechanism, names: tuple[str, ...], options: Mapping[str, Any]) -> Plot:
    from compoundkin.view import plot

    if names:
        raise InvalidInput(Problem(names[0], "a timing chart takes no quantities", "leave it out"))
    ranges = {"--from": options["start"], "--to": options["stop"], "--drive": options["drives"] or None}
    for option in (option for option, given in ranges.items() if given is not None):
        raise InvalidInput(Problem(option, "it does not go with --timing", UNSOLVED["--timing"]))
    return plot.timing_chart(mechanism, title=options["title"])


def _circuits_plot(structure: Structure, names: tuple[str, ...], options: Mapping[str, Any]) -> Plot:
    from compoundkin.cli import typed_values
    from compoundkin.cli.circuits import driver_range
    from compoundkin.view import plot

    given = {text.rpartition("=")[0] for text in options["drives"]}
    drivers = [drive.name for drive in structure.mechanism.drives]
    if given & {"", options["driver"] or "", *(drivers if len(drivers) == 1 else [])}:
        what = "the driver that moves takes all its values"
        raise InvalidInput(Problem("--drive", what, "for a part of them: --from and --to"))
    fixed = {k: v for k, v in typed_values.read_pose(structure, options["drives"], "--drive").items() if k in given}
    between = driver_range(structure, options["driver"], options["start"], options["stop"])
    with working("following all circuits"):
        return plot.circuits(
            structure, *names, driver=options["driver"], values=fixed, between=between, title=options["title"]
        )
