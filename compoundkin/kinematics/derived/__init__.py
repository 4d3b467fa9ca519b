"""What is derived of a motion at each pose and has a name: one file for each kind of figure, and this registry."""

from __future__ import annotations

from collections.abc import Mapping

from compoundkin.base.arrays import Number
from compoundkin.kinematics.derived.contract import Figure, HasQuantities, Lack, force_figures
from compoundkin.kinematics.derived.guides import coriolis, no_coriolis, no_pressure_angle, pressure_angle
from compoundkin.kinematics.derived.transmission_angle import no_angle, no_index, transmission_angle, transmission_index
from compoundkin.kinematics.derived.velocity_ratio import no_turning, ratio_of, unit_of_ratio
from compoundkin.model.attributes import (
    ADVANTAGE,
    CORIOLIS,
    PRESSURE_ANGLE,
    TRANSMISSION_ANGLE,
    TRANSMISSION_INDEX,
    VELOCITY_RATIO,
    Kind,
)


def _always(motion: HasQuantities, name: str) -> Lack | None:
    """Return that nothing is lacking."""
    return None


def _ratios(kind: Kind) -> Mapping[str, Figure]:
    """Return the ratios of a kind of owner. Only links may not turn."""

    def velocity_ratio(motion: HasQuantities, name: str) -> Number:
        return ratio_of(motion, kind, name).velocity_ratio

    def advantage(motion: HasQuantities, name: str) -> Number:
        return ratio_of(motion, kind, name).advantage

    lack = no_turning if kind == "links" else _always
    return {
        VELOCITY_RATIO: Figure(velocity_ratio, lack, lambda motion, name: unit_of_ratio(motion, kind, name)),
        ADVANTAGE: Figure(advantage, lack, lambda motion, name: unit_of_ratio(motion, kind, name, inverse=True)),
    }


FIGURES: Mapping[Kind, Mapping[str, Figure]] = {
    "points": {},
    "links": {
        TRANSMISSION_ANGLE: Figure(transmission_angle, no_angle),
        TRANSMISSION_INDEX: Figure(transmission_index, no_index),
        **_ratios("links"),
        **force_figures("links"),
    },
    "pairs": {
        PRESSURE_ANGLE: Figure(pressure_angle, no_pressure_angle),
        CORIOLIS: Figure(coriolis, no_coriolis),
        **_ratios("pairs"),
        **force_figures("pairs"),
    },
    "drives": {**_ratios("drives"), **force_figures("drives")},
}
