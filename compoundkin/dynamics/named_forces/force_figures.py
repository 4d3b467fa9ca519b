"""What forces have by name, "A.force", "crank.effort": a registry of figures, each with its values and unit."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from compoundkin.base.arrays import Number
from compoundkin.dynamics.found_forces import FoundForces
from compoundkin.dynamics.named_forces.force_parts import parts_of
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
    """Return what is known of a figure of forces by its word."""
    return _FIGURES[kind][word]


def _always(motion: Any, name: str) -> Lack | None:
    return None


def _only_of_frame(motion: Any, name: str) -> Lack | None:
    return None if name == FRAME else Lack("only the frame is shaken", f"take {FRAME}.{SHAKING_FORCE}")


def _part(word: str) -> tuple[str, Figure]:
    """Return a part of forces that only some kinds of pairs have."""

    def lack(motion: Any, name: str) -> Lack | None:
        pair = motion.solving_order.pairs[name]
        known = parts_of(pair)
        there = ", ".join((FORCE, MOMENT, *known))
        return None if word in known else Lack(f"a {pair.title} has none", f"it has {there}")

    return _row("pairs", word, lambda forces, name: forces.pairs[name].part(word), lack)


def _effort_unit(forces: FoundForces, name: str) -> str:
    return unit_of_force(forces, "moment" if forces.motion.drives[name].is_angle else "force")


def unit_of_force(forces: FoundForces, dimension: Dimension, name: str = "") -> str:
    """Return the unit of forces, moments or powers. Numbers have none."""
    units = forces.units
    return {"force": units.force, "moment": units.moment, "power": units.power, "length": units.length}.get(
        dimension, ""
    )


def scale_of_force(forces: FoundForces, dimension: Dimension) -> float:
    """Return what the rounding of forces is relative to: the largest of all."""
    of_lengths = 1.0 if dimension == "number" else forces.motion.size
    return {"force": forces.largest, "moment": forces.largest * of_lengths, "power": forces.largest * of_lengths}.get(
        dimension, of_lengths
    )


def _row(kind: Kind, word: str, values: Values, lack: Any = _always, unit: Any = None) -> tuple[str, Figure]:
    dimension = FORCES[kind][word].dimension or "number"
    of = unit or partial(_unit, dimension)
    return word, Figure(values, lack, of, partial(_scale, dimension))


def _unit(dimension: Dimension, forces: FoundForces, name: str) -> str:
    return unit_of_force(forces, dimension)


def _scale(dimension: Dimension, forces: FoundForces, name: str) -> float:
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
