"""Figures of forces by name, such as "A.force" and "crank.effort": a registry with values and units."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from compoundkin.base.arrays import Number
from compoundkin.dynamics.force_result import ForceResult
from compoundkin.dynamics.reactions.pair_forces import component_words
from compoundkin.kinematics.derived.contract import Figure, Lack
from compoundkin.model.attributes import (
    EFFORT,
    FORCE,
    FORCES,
    MOMENT,
    POWER,
    SHAKING_FORCE,
    SHAKING_MOMENT,
    Dimension,
    Kind,
)
from compoundkin.model.geometry import FRAME

Values = Callable[[Any, str], Number]


def force_figure(kind: Kind, word: str) -> Figure:
    """Return the figure of forces of a word."""
    return _FIGURES[kind][word]


def _of_every_force(motion: Any, name: str) -> Lack | None:
    return None


def _only_of_frame(motion: Any, name: str) -> Lack | None:
    return None if name == FRAME else Lack("only the frame is shaken", f"take {FRAME}.{SHAKING_FORCE}")


def _part(word: str) -> tuple[str, Figure]:
    """Return a part of forces that only some kinds of pairs have."""

    def lack(motion: Any, name: str) -> Lack | None:
        pair = motion.solving_order.pairs[name]
        known = component_words(pair)
        there = ", ".join((FORCE, MOMENT, *known))
        return None if word in known else Lack(f"a {pair.title} has none", f"it has {there}")

    return _row("pairs", word, lambda forces, name: forces.pairs[name].part(word), lack)


def _effort_unit(forces: ForceResult, name: str) -> str:
    return unit_of_force(forces, "moment" if forces.motion.drives[name].is_angle else "force")


def unit_of_force(forces: ForceResult, dimension: Dimension) -> str:
    """Return the unit of forces, moments or powers. Numbers have none."""
    units = forces.units
    return {"force": units.force, "moment": units.moment, "power": units.power, "length": units.length}.get(
        dimension, ""
    )


def scale_of_force(forces: ForceResult, dimension: Dimension) -> float:
    """Return the scale of rounding of forces: the largest of all."""
    of_lengths = 1.0 if dimension == "number" else forces.motion.size
    return {"force": forces.largest, "moment": forces.largest * of_lengths, "power": forces.largest * of_lengths}.get(
        dimension, of_lengths
    )


def _row(kind: Kind, word: str, values: Values, lack: Any = _of_every_force, unit: Any = None) -> tuple[str, Figure]:
    dimension = FORCES[kind][word].dimension or "number"
    of = unit or partial(_unit, dimension)
    return word, Figure(values, lack, of, partial(_scale, dimension))


def _unit(dimension: Dimension, forces: ForceResult, name: str) -> str:
    return unit_of_force(forces, dimension)


def _scale(dimension: Dimension, forces: ForceResult, name: str) -> float:
    return scale_of_force(forces, dimension)


_FIGURES: Mapping[Kind, Mapping[str, Figure]] = {
    "points": {},
    "links": dict(
        (
            _row("links", SHAKING_FORCE, lambda forces, name: forces.shaking.force, _only_of_frame),
            _row("links", SHAKING_MOMENT, lambda forces, name: forces.shaking.moment_about(0j), _only_of_frame),
        )
    ),
    "pairs": dict(
        (
            _row("pairs", FORCE, lambda forces, name: forces.pairs[name].force),
            _row("pairs", MOMENT, lambda forces, name: forces.pairs[name].moment),
            *map(_part, list(FORCES["pairs"])[2:]),
        )
    ),
    "drives": dict(
        (
            _row("drives", EFFORT, lambda forces, name: forces.drives[name].effort, unit=_effort_unit),
            _row("drives", POWER, lambda forces, name: forces.drives[name].power),
        )
    ),
}


# Between the name of the shaking moment and the point of the frame that it is about.
ABOUT = " about "


def shaking_moment(letter: str) -> str:
    """Return the name of the shaking moment about a point of the frame, or about the origin.

    >>> shaking_moment("A"), shaking_moment("")
    ('frame.shaking_moment about A', 'frame.shaking_moment')
    """
    return f"{FRAME}.{SHAKING_MOMENT}{ABOUT}{letter}" if letter else f"{FRAME}.{SHAKING_MOMENT}"


def frame_point(forces: ForceResult) -> str:
    """Return the reference point of the shaking moment: the first driver's, else the frame's first; "" for neither."""
    points = forces.mechanism.geometry.points[FRAME]
    letters = [driven.pair.letters[0] for driven in forces.motion.structure.driven.values()]
    return next((one for one in (*letters, *points) if one in points), "")
