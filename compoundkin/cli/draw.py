"""`compoundkin draw`: a picture of a mechanism."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import click

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
    pose_options,
    solve_motion_at,
)
from compoundkin.cli.file_options import load_mechanism, mechanism_argument, to_file
from compoundkin.cli.shell import put, say

if TYPE_CHECKING:
    from compoundkin.kinematics import Motion
    from compoundkin.structure import Structure
    from compoundkin.view.sketch import Picture

VIEWS = ("groups", "loops", "graph", "circle")
# What belongs to the sketch only, by the names of the values of the options.
OF_SKETCH = ("ghosts", "paths", "centres", "vectors", "labels", "dimensions")
# What is drawn instead of the sketch: options, and the names of their values.
ASSEMBLED = ("configurations", "circuits")
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
  compoundkin draw loaded.toml --at 35 --forces -o forces.svg
  compoundkin draw loaded.toml --at 35 --free-body plate -o plate.svg
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
@force_options
@pose_options
@click.option("--dimensions", is_flag=True, help="Add lengths, angles, radii, offsets of pivots and guides.")
@LABELS
@click.option("--size", type=float, metavar="PIXELS", help="The longer side.")
@to_file(f"Write an {alternatives('picture')} file; else SVG to stdout.")
def command(file: str, path: str | None, **asked: Any) -> None:
    """Draw a mechanism in the conventions of textbooks, at one pose.

    A mechanism that cannot be solved is shown as drawn.
    """
    from compoundkin.structure import decompose

    if path is not None:
        file_format("picture", path)
    picture = _picture(decompose(load_mechanism(file)), asked)
    if path is None:
        put(picture.svg)
    else:
        picture.save(path)
        say(f"Wrote {path}.")


def _picture(structure: Structure, asked: Mapping[str, Any]) -> Picture:
    """The picture asked for; raises InvalidInput for options that do not go together."""
    from compoundkin.view.sketch import draw

    _check_options(asked)
    if asked["view"]:
        return draw(structure, kind=asked["view"], size=asked["size"])
    for kind in (kind for kind in ASSEMBLED if asked[kind]):
        return draw(
            structure, _values(structure, asked["at"], kind), kind=kind, **_chosen_options(asked, "labels", "size")
        )
    shown, at = _motion(structure, asked)
    words = _chosen_options(asked, "design", "size")
    if has_force_picture(asked):
        return force_picture(shown, at, asked, words)
    if asked["polygon"]:
        return draw(shown, at, kind="polygon", vectors=asked["polygon"], **words)
    if asked["construction"] is not None:
        return draw(shown, at, kind="construction", link=asked["construction"], **words)
    return draw(shown, at, **words, **_chosen_options(asked, *OF_SKETCH))


def _chosen_options(asked: Mapping[str, Any], *names: str) -> dict[str, Any]:
    return {name: asked[name] for name in names}


def _values(structure: Structure, given: Sequence[str], kind: str) -> dict[str, float] | None:
    """Driver values: all of them for configurations, those that are named for circuits; None where none is given."""
    from compoundkin.cli import typed_values

    if not given:
        return None
    found = typed_values.read_pose(structure, given)
    named = {text.rpartition("=")[0] for text in given}
    return found if kind == "configurations" else {name: value for name, value in found.items() if name in named}


def _check_options(asked: Mapping[str, Any]) -> None:
    from compoundkin.base.errors import InvalidInput, Problem

    instead = [option for option, name in INSTEAD.items() if asked[name] not in (None, False)]
    how = [option for option in ("statics", "holding") if asked[option]]
    if how and not any(option in FORCE_PICTURES for option in instead):
        raise InvalidInput(Problem(f"--{how[0]}", "it tells how forces are found", "give --forces too"))
    unfit = instead[1:] + [key for key in OF_SKETCH if key != "labels" and asked[key]]
    if asked["view"]:
        unfit += [key for key in ("at", "speeds", "modes") if asked[key]]
    if any(asked[kind] for kind in ASSEMBLED):
        unfit += [key for key in ("speeds", "modes", "design") if asked[key]]
    if instead and unfit:
        option = unfit[0][:-1] if unfit[0] in ("paths", "speeds", "modes") else unfit[0]
        raise InvalidInput(Problem(f"--{option}", f"it does not go with --{instead[0]}", "leave one of them out"))


def _motion(structure: Structure, asked: Mapping[str, Any]) -> tuple[Motion | Structure, dict[str, float] | None]:
    """The motion over the drivers' own ranges, and the pose in it; the structure where it cannot be solved."""
    from compoundkin.cli import typed_values
    from compoundkin.view.sketch.picture_options import solved_over

    at = typed_values.read_pose(structure, asked["at"]) if asked["at"] else None
    own = solved_over(structure.mechanism)
    if own is None or not (asked["speeds"] or asked["modes"]):
        return (structure if own is None else own), at
    return solve_motion_at(own.structure, {}, {"accelerations": (), "outputs": (), "order": 2, **asked}), at
