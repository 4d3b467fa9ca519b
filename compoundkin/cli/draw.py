"""`compoundkin draw`: a picture of a mechanism."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import click

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import alternatives, file_format
from compoundkin.cli.drive_options import (
    ARROWS,
    FORCE_PICTURES,
    LABELS,
    PATHS,
    VECTORS,
    force_options,
    force_picture,
    has_force_picture,
    load_options,
    pose_options,
    solve_motion_at,
)
from compoundkin.cli.file_options import load_mechanism, mechanism_argument, put_picture, to_file

if TYPE_CHECKING:
    from compoundkin.kinematics import Motion
    from compoundkin.structure import Structure
    from compoundkin.view.sketch import Picture

VIEWS = ("groups", "loops", "graph", "circle")
# Options of the sketch alone.
OF_SKETCH = ("ghosts", "paths", "centres", "vectors", "labels", "dimensions")
# Pictures instead of the sketch: the options and the names of their values.
ASSEMBLED = ("configurations", "circuits", "singularities")
INSTEAD = {
    "structure": "view",
    "polygon": "polygon",
    "construction": "construction",
    **{kind: kind for kind in ASSEMBLED},
    **FORCE_PICTURES,
}


@click.command(
    epilog="""\b
Examples:
  compoundkin draw six-bar -o six-bar.svg
  compoundkin draw jansen-leg --at 35 --ghosts 6 --path foot -o leg.svg
  compoundkin draw six-bar --at 35 --vectors velocity -o vectors.png
  compoundkin draw six-bar --at 35 --centres -o centres.pdf
  compoundkin draw slider-crank-offset --dimensions -o dimensions.svg
  compoundkin draw six-bar --at 35 --polygon velocity -o polygon.svg
  compoundkin draw six-bar --at 35 --construction plate -o circles.svg
  compoundkin draw six-bar --structure groups -o apart.svg
  compoundkin draw six-bar --configurations --at 35 -o configurations.svg
  compoundkin draw stephenson-iii --circuits -o circuits.svg
  compoundkin draw parallelogram --singularities -o branches.svg
  compoundkin draw loaded.toml --at 35 --forces -o forces.svg
  compoundkin draw loaded.toml --at 35 --free-body plate -o plate.svg
  compoundkin draw loaded.toml --at 35 --along-bars bending-moment -o bars.svg
"""
)
@mechanism_argument
@click.option(
    "--at",
    "at",
    multiple=True,
    metavar="[NAME=]VALUE",
    help="The pose: a driver's value, degrees or length; the one nearest to the drawing if left out.",
)
@click.option("--ghosts", type=int, default=0, metavar="COUNT", help="Draw so many other poses faintly.")
@PATHS
@click.option("--centres", is_flag=True, help="Draw the instant centres with the lines that give them.")
@ARROWS
@click.option("--polygon", type=click.Choice(VECTORS), help="Instead: the polygon of the vectors from one pole.")
@click.option(
    "--construction", metavar="LINK", help="Instead: the circles and lines that give the dyad with this link."
)
@click.option(
    "--structure",
    "view",
    type=click.Choice(VIEWS),
    help="Instead: taken apart into groups; the independent loops; the graph of links and pairs; the circle diagram "
    "of centres.",
)
@click.option(
    "--configurations", is_flag=True, help="Instead: all configurations at the drivers' values, to one scale."
)
@click.option(
    "--circuits", is_flag=True, help="Instead: all circuits of the driver that --at leaves out, the first of those."
)
@click.option(
    "--singularities", is_flag=True, help="Instead: the singular poses of the motion, the branches that meet there."
)
@force_options
@load_options
@pose_options
@click.option("--dimensions", is_flag=True, help="Add lengths, angles, radii, offsets of pivots and guides.")
@LABELS
@click.option("--size", type=float, metavar="PIXELS", help="The longer side.")
@to_file(f"Write an {alternatives('picture')} file; else SVG to stdout.")
def command(file: str, path: str | None, **options: Any) -> None:
    """Draw a mechanism in the conventions of textbooks, at one pose.

    A mechanism that cannot be solved is shown as drawn.
    """
    from compoundkin.cli.typed_values import with_loads
    from compoundkin.structure import decompose

    if path is not None:
        file_format("picture", path)
    put_picture(_picture(decompose(with_loads(load_mechanism(file), options)), options), path)


def _picture(structure: Structure, options: Mapping[str, Any]) -> Picture:
    """Return the picture that the options describe. Raises InvalidInput for options that exclude each other."""
    from compoundkin.view.sketch import draw

    _check_options(options)
    if options["view"]:
        return draw(structure, kind=options["view"], size=options["size"])
    for kind in (kind for kind in ASSEMBLED if options[kind]):
        return draw(
            structure, _values(structure, options["at"], kind), kind=kind, **_chosen_options(options, "labels", "size")
        )
    motion, at = _motion(structure, options)
    words = _chosen_options(options, "design", "size")
    if has_force_picture(options):
        return force_picture(motion, at, options, words)
    if options["polygon"]:
        return draw(motion, at, kind="polygon", vectors=options["polygon"], **words)
    if options["construction"] is not None:
        return draw(motion, at, kind="construction", link=options["construction"], **words)
    return draw(motion, at, **words, **_chosen_options(options, *OF_SKETCH))


def _chosen_options(options: Mapping[str, Any], *names: str) -> dict[str, Any]:
    return {name: options[name] for name in names}


def _values(structure: Structure, given: Sequence[str], kind: str) -> dict[str, float] | None:
    """Return drivers' values: all for configurations, the given ones for circuits; None where none is given."""
    from compoundkin.cli import typed_values

    if not given:
        return None
    found = typed_values.read_pose(structure, given)
    named = {text.rpartition("=")[0] for text in given}
    return found if kind == "configurations" else {name: value for name, value in found.items() if name in named}


def _check_options(options: Mapping[str, Any]) -> None:
    """Raise InvalidInput for options that exclude each other."""
    instead = [option for option, name in INSTEAD.items() if options[name] not in (None, False)]
    how = [option for option in ("statics", "holding") if options[option]]
    if how and not any(option in FORCE_PICTURES for option in instead):
        raise InvalidInput(Problem(f"--{how[0]}", "it concerns forces", "give --forces too"))
    unfit = instead[1:] + [key for key in OF_SKETCH if key != "labels" and options[key]]
    if options["view"]:
        unfit += [key for key in ("at", "speeds", "modes") if options[key]]
    if any(options[kind] for kind in ASSEMBLED):
        unfit += [key for key in ("speeds", "modes", "design") if options[key]]
    if instead and unfit:
        option = unfit[0][:-1] if unfit[0] in ("paths", "speeds", "modes") else unfit[0]
        raise InvalidInput(Problem(f"--{option}", f"it does not go with --{instead[0]}", "leave one of them out"))


def _motion(structure: Structure, options: Mapping[str, Any]) -> tuple[Motion | Structure, dict[str, float] | None]:
    """Return the motion over the drivers' own ranges, or the structure if it cannot be solved, and the pose."""
    from compoundkin.cli import typed_values
    from compoundkin.view.sketch.picture_options import solved_over

    at = typed_values.read_pose(structure, options["at"]) if options["at"] else None
    own = solved_over(structure.mechanism)
    if own is None or not (options["speeds"] or options["modes"]):
        return (structure if own is None else own), at
    return solve_motion_at(own.structure, {}, {"accelerations": (), "outputs": (), "order": 2, **options}), at
