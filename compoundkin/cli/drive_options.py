"""Options that drive a mechanism, show its sketch and its forces; the motion and the forces that they define."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

import click

from compoundkin.base.errors import (
    ChangePointWarning,
    DrawnBeyondEnd,
    FewDigits,
    InvalidInput,
    Problem,
    UnassembledPoses,
    suggestion,
)
from compoundkin.cli.shell import NOT_ASSEMBLED, say, working
from compoundkin.model.attributes import ACCELERATION, VELOCITY

if TYPE_CHECKING:
    from compoundkin.dynamics.forces import Forces
    from compoundkin.kinematics import Motion
    from compoundkin.structure import Structure
    from compoundkin.view.sketch import Picture


F = TypeVar("F", bound=Callable[..., Any])
SPEED = click.option("--speed", "speeds", multiple=True, metavar="[NAME=]VALUE",
                     help="A driver's rate in rad/s or length/s; also 300rpm or 90deg (a second).")  # fmt: skip
SECOND_RATE = click.option("--acceleration", "accelerations", multiple=True, metavar="[NAME=]VALUE",
                           help="Its second rate in rad/s^2 or length/s^2.")  # fmt: skip
MODE = click.option("--mode", "modes", multiple=True, metavar="LINK=SIGN",
                    help="Assembly mode, +1 or -1, of the group with this link.")  # fmt: skip
DESIGN = click.option("--design", default=0, show_default=True, metavar="INDEX",
                      help="Which one, where dimensions are arrays.")  # fmt: skip
AT = click.option("--at", "at", multiple=True, metavar="[NAME=]VALUE",
                  help="The pose: a driver's value, degrees or length; the first of its range "
                  "if left out.")  # fmt: skip
ORDER = click.option("--order", type=click.IntRange(0, 3), help="0 position, 1 velocity, 2 acceleration, 3 jerk; "
                     "otherwise what the outputs need, at least 2.")  # fmt: skip
# Options of sketches.
VECTORS = (VELOCITY, ACCELERATION)
ARROWS = click.option("--vectors", multiple=True, type=click.Choice(VECTORS), help="Draw the vectors of all points.")
LABELS = click.option("--labels/--no-labels", default=True, help="Letters at points and numbers on links.")
# Options of forces.
STATICS = click.option("--statics", is_flag=True, help="Leave inertia out: masses have weight only.")
HOLDING = click.option("--holding", default="", metavar="PAIR",
                       help="A pair, pin or driver that holds in the drivers' place.")  # fmt: skip
# Pictures of forces: the options and the names of their values.
FORCE_PICTURES = {
    "forces": "forces",
    "free-bodies": "free_bodies",
    "free-body": "free_body",
    "force-polygons": "force_polygons",
    "force-polygon": "force_polygon",
    "along-bars": "along_bars",
}
# What is drawn along the bars of links.
ALONG_BARS = ("normal-force", "shear", "bending-moment")
FORCE_OPTIONS: tuple[Any, ...] = (
    click.option("--forces", is_flag=True, help="Draw the forces in pairs, of drivers, loads and inertia."),
    click.option("--free-bodies", is_flag=True, help="Draw every link on its own with all that acts on it."),
    click.option("--free-body", metavar="LINK", help="The same of one link."),
    click.option("--force-polygons", is_flag=True, help="Draw the forces on every link head to tail."),
    click.option("--force-polygon", metavar="LINK", help="The same of one link."),
    click.option(
        "--along-bars",
        type=click.Choice(ALONG_BARS),
        help="Draw it along the bars of links, with its envelope over all poses.",
    ),
    STATICS,
    HOLDING,
)


# Masses and loads beside those of the file; `typed_values.with_loads` reads them.
LOAD_OPTIONS: tuple[Any, ...] = (
    click.option("--load", "forces_at", multiple=True, metavar="POINT=X,Y",
                 help='A force on a point, or LINK.POINT: C=0,-500, "C=0,-0.5 kN". In the axes of the frame.'),
    click.option("--torque", "torques", multiple=True, metavar="LINK=VALUE",
                 help='A torque on a link, counterclockwise: rocker=-120, "rocker=-0.12 N m".'),
    click.option("--mass", "masses", multiple=True, metavar="LINK=VALUE",
                 help='The mass of a link, a uniform body: arm=15, "arm=150 g".'),
    click.option("--gravity", "gravity", metavar="X,Y", help="In m/s^2: 0,-9.81."),
    click.option("--units", "units", metavar="LENGTH,MASS,FORCE",
                 help="Of a file without them: mm,kg,N; its own unit of length, kg and N if left out."),
)  # fmt: skip


def load_options(command: F) -> F:
    """Add the options of masses and loads beside those of the file."""
    return with_options(command, LOAD_OPTIONS)


def names_option(flag: str, name: str, metavar: str, text: str) -> Callable[[F], F]:
    """Return an option of names, each given by itself or several with commas between them."""
    return click.option(flag, name, multiple=True, metavar=metavar, callback=lambda _c, _p, given: split_names(given),
                        help=text)  # fmt: skip


def split_names(given: Sequence[str]) -> tuple[str, ...]:
    """Return names given one by one or with commas between them.

    >>> split_names(["G.x,G.y", "bar"])
    ('G.x', 'G.y', 'bar')
    """
    return tuple(name.strip() for text in given for name in text.split(",") if name.strip())


# The options of a motion but for its order.
OPTIONS: tuple[Any, ...] = (
    click.option("--at", "at", metavar="VALUES", help="Solve at these values of the only driver: 35 or 0,35,60."),
    click.option("--from", "start", type=float, metavar="VALUE", help="First value of the only driver."),
    click.option("--to", "stop", type=float, metavar="VALUE", help="Last value of the only driver."),
    click.option("--step", "step", type=float, metavar="VALUE", help="Distance between its values."),
    click.option("--drive", "drives", multiple=True, metavar="NAME=VALUES",
                 help="Values of a driver: crank=35, crank=0,35,60 or crank=0:360:5 (from:to:step)."),
    click.option("--time", "time", metavar="SECONDS",
                 help="Solve at these times: 0:2:0.01 (from:to:step) or 0,0.5,1. Drivers move by their laws, others "
                 "from their value by their speed and acceleration."),
    SPEED,
    SECOND_RATE,
    MODE,
    names_option("--output", "outputs", "QUANTITY",
                 "Such as G.velocity, G.speed, bar.angle, slot.rate; repeat it, or write commas."),
)  # fmt: skip
PATHS = names_option("--path", "paths", "POINT",
                     "Draw the path of a point: its coupler curve. Repeat it, or write commas.")  # fmt: skip


def drive_options(command: F) -> F:
    """Add the options of a command that solves a mechanism. Values are degrees or lengths."""
    return motion_options(ORDER(command))


def motion_options(command: F) -> F:
    """Add the options of a motion without its order, which follows from the outputs."""
    return with_options(command, OPTIONS)


def pose_options(command: F) -> F:
    """Add the options of a command that shows one pose: rates, modes, which design."""
    return with_options(command, (SPEED, MODE, DESIGN))


def force_options(command: F) -> F:
    """Add the options of pictures with forces."""
    return with_options(command, FORCE_OPTIONS)


def with_options(command: F, options: Sequence[Any]) -> F:
    """Add options to a command, in their order."""
    for option in reversed(options):
        command = option(command)
    return command


def solve_motion(structure: Structure, options: Mapping[str, Any]) -> Motion:
    """Return the motion that the options describe; a warning on stderr counts poses that cannot be assembled.

    Raises InvalidInput for options that do not fit the mechanism, and whatever `solve` raises.
    """
    from compoundkin.cli import typed_values

    return solve_motion_at(structure, typed_values.read_driver_values(structure, options), options)


def solve_motion_at(structure: Structure, driven: Mapping[str, Any], options: Mapping[str, Any]) -> Motion:
    """Solve as `solve_motion`, at these values of the drivers."""
    from compoundkin.cli import typed_values
    from compoundkin.kinematics import solve
    from compoundkin.model.attributes import RATES

    rates = {what: typed_values.read_rates(structure, f"--{what}", options[f"{what}s"]) for what in RATES[:2]}
    modes = read_assembly_modes(structure, options["modes"])
    time = typed_values.read_times(options.get("time"))
    with working("solving"), warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", UnassembledPoses)
        warnings.simplefilter("always", ChangePointWarning)
        warnings.simplefilter("always", FewDigits)
        motion = solve(structure, driven, time=time, **rates, order=_order(structure, options), modes=modes)
    for warning in caught:
        _repeat_warning(warning, motion)
    return motion


def explain_gaps(motion: Motion) -> int:
    """Write to stderr which poses cannot be assembled and why, and return the exit code: 0 where there are none."""
    if motion.assembled.all():
        return 0
    from compoundkin.kinematics.gaps import gaps
    from compoundkin.view.report.pose_sample import Sample
    from compoundkin.view.report.verification_sections import MOST_GAPS, gap_sentence

    found, sample = gaps(motion), Sample(motion)
    for gap in found[:MOST_GAPS]:
        design = f"Design {', '.join(map(str, gap.design))}: " if gap.design else ""
        say(f"  {design}{gap_sentence(sample, gap)}")
    if len(found) > MOST_GAPS:
        say(f"  ... and {len(found) - MOST_GAPS:,} more.")
    return NOT_ASSEMBLED


def read_assembly_modes(structure: Structure, given: Sequence[str]) -> dict[str, int]:
    """Return assembly modes by link. Raises InvalidInput for unknown links and other signs."""
    signs = {"+1": 1, "1": 1, "+": 1, "-1": -1, "-": -1}
    found = {}
    for text in given:
        link, _, sign = text.rpartition("=")
        where, name = f"--mode {text}", link or text
        if name not in structure.mechanism.links:
            remedy = suggestion(name, list(structure.mechanism.links))
            raise InvalidInput(Problem(where, f"there is no link {name!r}", remedy))
        if sign not in signs:
            raise InvalidInput(Problem(where, f"{sign!r} is not an assembly mode", f"write {name}=+1 or {name}=-1"))
        found[link] = signs[sign]
    return found


def _order(structure: Structure, options: Mapping[str, Any]) -> int:
    """Return the order given, or the highest that an output needs. Raises InvalidInput where they disagree."""
    from compoundkin.model.attributes import derivative_order

    order = options["order"]
    if order is None:
        return max([2, *(derivative_order(name) for name in options["outputs"] or structure.mechanism.outputs)])
    for name in options["outputs"]:
        if derivative_order(name) > order:
            remedy = f"leave --order out, or give --order {derivative_order(name)}"
            raise InvalidInput(Problem(f"--order {order}", f"{name} needs a higher order", remedy))
    return int(order)


def _repeat_warning(warning: warnings.WarningMessage, motion: Motion) -> None:
    """Write the number of poses that cannot be assembled, or any other warning as it is."""
    if issubclass(warning.category, UnassembledPoses):
        missing = int((motion.failed != 0).sum())
        say(f"Warning: {missing:,} of {motion.failed.size:,} poses cannot be assembled.")
    elif issubclass(warning.category, DrawnBeyondEnd | ChangePointWarning | FewDigits):
        say(f"Warning: {warning.message}.")
    else:
        warnings.warn_explicit(warning.message, warning.category, warning.filename, warning.lineno)


def read_estimates(unknowns: Mapping[str, bool], given: Sequence[str]) -> dict[str, float]:
    """Return estimates of unknowns in radians or lengths; `unknowns` holds whether each is an angle.

    >>> read_estimates({"rod": True, "s(stroke)": False}, ["s(stroke)=0.2"])
    {'s(stroke)': 0.2}
    """
    from math import radians

    from compoundkin.cli.typed_values import read_number

    found = {}
    for text in given:
        where, (name, _, value) = f"--estimate {text}", text.rpartition("=")
        if name not in unknowns:
            what = f"there is no unknown {name!r}" if name else "the unknown is not named"
            raise InvalidInput(Problem(where, what, suggestion(name, list(unknowns)) if name else "write NAME=VALUE"))
        if name in found:
            raise InvalidInput(Problem(where, "the unknown is estimated twice", "leave one of them out"))
        estimate = read_number(value, where, "write one number, degrees or a length")
        found[name] = radians(estimate) if unknowns[name] else estimate
    return found


def has_force_picture(options: Mapping[str, Any]) -> bool:
    """Return whether an option of a picture with forces is given."""
    return any(options[name] for name in FORCE_PICTURES.values())


def force_picture(
    motion: Motion | Structure, at: Mapping[str, float] | None, options: Mapping[str, Any], words: Mapping[str, Any]
) -> Picture:
    """Return the picture with forces that the options describe, at a pose."""
    from compoundkin.view.sketch import draw

    forces = find_forces(motion, options["statics"], options["holding"])
    if options["forces"]:
        return draw(forces, at, labels=options["labels"], **words)
    if options["along_bars"]:
        return draw(forces, at, kind=options["along_bars"], labels=options["labels"], **words)
    kind = "free-bodies" if options["free_bodies"] or options["free_body"] else "force-polygon"
    return draw(forces, at, kind=kind, link=options["free_body"] or options["force_polygon"], **words)


def find_forces(what: Motion | Structure, statics: bool, holding: str = "") -> Forces:
    """Return the forces of a motion, or of a structure over its drivers' ranges."""
    from compoundkin.dynamics.force_analysis import force_analysis
    from compoundkin.kinematics import Motion, solve

    motion = what if isinstance(what, Motion) else solve(what)
    if motion.mechanism.units is None:
        what_lacks = "forces need units of length, mass and force, and the file has none"
        raise InvalidInput(Problem("--units", what_lacks, "give --units mm,kg,N, or write them in the file"))
    with working("finding forces"):
        return force_analysis(motion, inertia=not statics, holding=holding)
