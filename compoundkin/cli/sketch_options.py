"""The options of commands that draw a sketch, at one pose or moving."""

from __future__ import annotations

import click

from compoundkin.cli.drive_options import names
from compoundkin.model.attributes import ACCELERATION, VELOCITY

VECTORS = (VELOCITY, ACCELERATION)

PATHS = click.option("--path", "paths", multiple=True, metavar="POINT", callback=lambda _c, _p, given: names(given),
                     help="Draw the path of a point: its coupler curve. Repeat it, or write commas.")  # fmt: skip
ARROWS = click.option("--vectors", multiple=True, type=click.Choice(VECTORS), help="Draw the vectors of all points.")
LABELS = click.option("--labels/--no-labels", default=True, help="Letters at points and numbers on links.")
