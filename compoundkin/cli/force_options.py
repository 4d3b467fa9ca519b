"""The options of pictures with forces, and what they ask for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from compoundkin.dynamics.forces import Forces
    from compoundkin.kinematics import Motion
    from compoundkin.structure import Structure
    from compoundkin.view.sketch import Picture

F = TypeVar("F", bound=Callable[..., Any])

STATICS = click.option("--statics", is_flag=True, help="Leave inertia out: masses have weight only.")
HOLDING = click.option("--holding", default="", metavar="PAIR",
                       help="A pair, pin or driver that holds in the drivers' place.")  # fmt: skip
# What is drawn with forces: options, and the names of their values.
FORCE_PICTURES = {
    "forces": "forces",
    "free-bodies": "free_bodies",
    "free-body": "free_body",
    "force-polygons": "force_polygons",
    "force-polygon": "force_polygon",
}
_OPTIONS = (
    click.option("--forces", is_flag=True, help="Draw the forces in pairs, of drivers, loads and inertia."),
    click.option("--free-bodies", is_flag=True, help="Draw every link on its own with all that acts on it."),
    click.option("--free-body", metavar="LINK", help="The same of one link."),
    click.option("--force-polygons", is_flag=True, help="Draw the forces on every link head to tail."),
    click.option("--force-polygon", metavar="LINK", help="The same of one link."),
    STATICS,
    HOLDING,
)


def force_options(command: F) -> F:
    """Add the options of pictures with forces."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


def wanted_of_forces(asked: Mapping[str, Any]) -> bool:
    """Tell whether a picture with forces is asked for."""
    return any(asked[name] for name in FORCE_PICTURES.values())


def picture_of_forces(
    shown: Motion | Structure, at: Mapping[str, float] | None, asked: Mapping[str, Any], words: Mapping[str, Any]
) -> Picture:
    """Return the picture with forces that is asked for, at a pose."""
    from compoundkin.view.sketch import draw

    forces = forces_of(shown, asked["statics"], asked["holding"])
    if asked["forces"]:
        return draw(forces, at, labels=asked["labels"], **words)
    kind = "free-bodies" if asked["free_bodies"] or asked["free_body"] else "force-polygon"
    return draw(forces, at, kind=kind, link=asked["free_body"] or asked["force_polygon"], **words)


def forces_of(what: Motion | Structure, statics: bool, holding: str = "") -> Forces:
    """Return the forces of a motion, or of a structure over its range."""
    from compoundkin.cli.progress import working
    from compoundkin.dynamics.force_analysis import force_analysis
    from compoundkin.kinematics import Motion, solve

    motion = what if isinstance(what, Motion) else solve(what)
    with working("finding forces"):
        return force_analysis(motion, inertia=not statics, holding=holding)
