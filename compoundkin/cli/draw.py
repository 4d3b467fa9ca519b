"""`compoundkin draw`: a picture of a mechanism."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from compoundkin.cli.driving import drive_options, names, solved, solved_at
from compoundkin.cli.mechanisms import loaded, mechanism_argument
from compoundkin.cli.shell import put, say

if TYPE_CHECKING:
    from compoundkin.drawing import Picture
    from compoundkin.motion import Motion
    from compoundkin.structure import Structure

# What there is to draw besides the sketch.
POLYGONS = ("velocity", "acceleration")
VIEWS = ("graph", "groups", "centres")


@click.command(
    epilog="""\b
Examples:
  compoundkin draw six-bar -o six-bar.svg
  compoundkin draw jansen-leg --at 35 --ghosts 6 --path foot -o leg.svg
  compoundkin draw six-bar --at 35 --vectors velocity --vectors acceleration -o vectors.png
  compoundkin draw six-bar --at 35 --centres -o centres.pdf
  compoundkin draw six-bar --at 35 --polygon velocity -o polygon.svg
  compoundkin draw six-bar --structure groups -o apart.svg
"""
)
@mechanism_argument
@click.option(
    "--pose", "at", multiple=True, metavar="[NAME=]VALUE",
    help="The pose: a driver's value, degrees or length; --at does the same. The drawn one if left out.",
)  # fmt: skip
@click.option("-o", "--to-file", "path", metavar="PATH", help="Write an .svg, .png or .pdf file; SVG on stdout if left out.")
def command(file: str, path: str | None, at: tuple[str, ...]) -> None:
    """Draw a mechanism."""
