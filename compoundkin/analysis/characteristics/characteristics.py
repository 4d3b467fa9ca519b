"""`characteristics`: the figures of a motion that engineers use, with the dead points of its driver."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.analysis.characteristics.linkage_types import FourBar, SliderCrank, linkage_types
from compoundkin.analysis.characteristics.output_figures import OutputFigures
from compoundkin.analysis.characteristics.outputs import chosen_outputs, outputs_of
from compoundkin.analysis.characteristics.placed_figures import (
    Range,
    drivers_at,
    moving_drivers,
    ranges_of,
    scalar_quantity,
)
from compoundkin.analysis.characteristics.transmission import (
    AdvantageFigures,
    GroupFigures,
    advantages,
    coriolis_names,
    group_figures,
    groups_of_outputs,
    index_names,
    pressure_names,
    ratio_names,
)
from compoundkin.base.arguments import check_design, checked
from compoundkin.base.arrays import ascending
from compoundkin.base.display import count_phrase, short_repr
from compoundkin.base.errors import ExplainsAttributes, InvalidInput, Problem, UnknownName, suggestion
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import Measure, between, closed_cycles, driver_dead_points
from compoundkin.kinematics.gaps import gaps
from compoundkin.kinematics.one_design import motion_of_design
from compoundkin.kinematics.quantities import Quantity, quantity
from compoundkin.model.attributes import derivative_order
from compoundkin.model.geometry import FRAME

# Tolerances: of a dwell in parts of the stroke, of a straight stretch in parts of the path's size.
DWELL, STRAIGHT = 0.01, 0.001
# A transmission angle below this (radians) is zero within rounding.
NOTHING = 1e-8


@dataclass(frozen=True, eq=False)
class Characteristics(ExplainsAttributes):
    """The figures of one design of a motion; an output by its name, as in `figures["ram.displacement"].stroke`.

    `groups` have transmission angles or indices, `pressure_angles` and `coriolis` are ranges by the names of pairs'
    quantities, `advantages` those of outputs over the only driver that moves. `dead_points` are the driver's own: limit
    positions. `types` are those of four-bars and slider-cranks, `notes` say what is not defined, and why.
    """

    motion: Motion
    design: int
    outputs: tuple[OutputFigures, ...]
    groups: tuple[GroupFigures, ...]
    pressure_angles: Mapping[str, Range]
    coriolis: Mapping[str, Range]
    advantages: tuple[AdvantageFigures, ...]
    dead_points: tuple[DriverDeadPoint, ...]
    notes: tuple[str, ...]

    @cached_property
    def types(self) -> tuple[FourBar | SliderCrank, ...]:
        """The types of the loops of four links."""
        return linkage_types(self.motion.structure, self.design if self._has_designs else 0)

    @cached_property
    def full_turns(self) -> Mapping[str, int]:
        """The number of full turns of each link over a closed cycle, empty for any other motion."""
        shape = self.motion.failed.shape
        if self.motion.inputs.poses < 3 or not closed_cycles(self.motion)[self.design]:
            return {}
        rows = {
            name: np.broadcast_to(link.angle, self.motion.shape).reshape(shape)[self.design]
            for name, link in self.motion.links.items()
            if name != FRAME
        }
        return {name: round(float(row[-1] - row[0]) / (2.0 * np.pi)) for name, row in rows.items()}

    @property
    def _has_designs(self) -> bool:
        return self.motion.inputs.designs > 1

    @property
    def warnings(self) -> tuple[str, ...]:
        """Transmission angles below 40 degrees in groups that an output depends on, a sentence each."""
        return tuple(
            f"{one.name} falls to {_degrees(one.range.least.number):.3g} degrees on the way to the output"
            for one in self.groups
            if one.is_poor
        )

    def __getitem__(self, name: str) -> OutputFigures:
        """Return the figures of an output. Raises UnknownName with the nearest known name."""
        named = {one.output.owner: one for one in reversed(self.outputs)} | {one.name: one for one in self.outputs}
        if name in named:
            return named[name]
        if not isinstance(name, str):
            raise UnknownName(Problem(short_repr(name), "it is no name of an output", suggestion("", list(named))))
        try:
            meant = outputs_of(self.motion, [name])[0]
        except UnknownName:
            raise UnknownName(Problem(name, "there is no such output", suggestion(name, list(named)))) from None
        if meant.name in named:
            return named[meant.name]
        remedy = f"ask for it: characteristics(motion, [{name!r}])"
        raise UnknownName(Problem(name, f"it is none of the outputs {', '.join(self.names) or '(none)'}", remedy))

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the outputs."""
        return tuple(one.name for one in self.outputs)

    def __repr__(self) -> str:
        parts = [count_phrase(len(self.outputs), "output"), count_phrase(len(self.groups), "group")]
        parts += [count_phrase(len(self.warnings), "warning")] if self.warnings else []
        return f"Characteristics({self.motion.mechanism.title!r}: {', '.join(parts)})"


@checked
def characteristics(
    motion: Motion, outputs: Sequence[str] = (), design: int = 0, dwell: float = DWELL, straight: float = STRAIGHT
) -> Characteristics:
    """Return the figures of a motion: stroke, time ratio, dead points, transmission, advantage and others.

    `outputs` are names of quantities, by default those of the mechanism. A dwell stays within the part `dwell` of its
    stroke, a straight stretch of a path within the part `straight` of the path's size. Figures are exact between the
    poses too. `notes` name those that are not defined: for a single pose, a motion with gaps, several drivers.

    Raises UnknownName for an unknown output, InvalidInput for an unknown design.

    >>> import compoundkin as ck
    >>> found = characteristics(ck.solve(ck.load("whitworth-quick-return")))
    >>> round(found["ram.value"].stroke.values, 9), round(float(found["ram.value"].time_ratio.values), 9)
    (150.0, 2.0)
    """
    _check(motion, design, dwell, straight)
    own = motion_of_design(motion, design)
    chosen = outputs_of(own, chosen_outputs(own, outputs))
    groups = index_names(own)
    pressures, guides = pressure_names(own), coriolis_names(own)
    moving = moving_drivers(own, 0)
    ratios = ratio_names(own, chosen)
    found = (one for output in chosen for one in output.measures(own))
    measures = {one.name if isinstance(one, Measure) else one: one for one in found}
    besides = dict.fromkeys((*groups, *pressures, *guides, *ratios.values()))
    ranges = ranges_of(own, [*measures.values(), *(name for name in besides if name not in measures)])
    relevant = groups_of_outputs(own.structure, chosen)
    figures = tuple(OutputFigures(own, one, ranges, dwell, straight) for one in chosen)
    return Characteristics(
        motion,
        design,
        figures,
        group_figures(own, groups, ranges, relevant),
        {name: ranges[name] for name in pressures if name in ranges},
        {name: ranges[name] for name in guides if name in ranges},
        advantages(own, chosen, ratios, ranges),
        _dead_points_of_driver(own, figures),
        tuple(_notes(own, moving)),
    )


def _check(motion: Motion, design: int, dwell: float, straight: float) -> None:
    check_design(design, motion.inputs.designs)
    for name, part in (("dwell", dwell), ("straight", straight)):
        if not 0 < part < 1:
            raise InvalidInput(Problem(name, f"{part:g} is no part of a stroke", "give a number between 0 and 1"))


def _degrees(angle: float) -> float:
    """Return an angle in degrees, 0 within rounding."""
    return float(np.rad2deg(angle)) if angle > NOTHING else 0.0


def _notes(motion: Motion, moving: tuple[str, ...]) -> list[str]:
    """Return the figures that are not defined for a motion, with the reasons."""
    notes = []
    if motion.inputs.poses < 2:
        notes.append("A single pose: strokes, dead points, time ratios, dwells and paths take a motion over several.")
    missing = int(np.count_nonzero(motion.failed[0]))
    if missing:
        notes.append(f"{missing:,} of {motion.inputs.poses:,} poses cannot be assembled: figures are of what can be,"
                    " time ratios are not defined.")  # fmt: skip
    if motion.time is None and not any(np.any(rates[1]) for rates in motion.inputs.drives.values()):
        notes.append("No driver has a speed: rates are zero, velocity ratios and mechanical advantage are not defined.")
    if len(moving) > 1:
        notes.append(f"Several drivers move ({', '.join(moving)}): time ratios by a driver's angle, velocity ratios and"
                    " mechanical advantage are not defined.")  # fmt: skip
    return notes


@dataclass(frozen=True, eq=False)
class DriverDeadPoint:
    """A limit position, beyond which the driver cannot move.

    `at` are the drivers' values, `values` those of outputs. `place` counts the poses of the motion from 0. `reason` is
    empty where the motion ends just there.
    """

    at: Mapping[str, Quantity]
    values: Mapping[str, Quantity]
    reason: str
    place: float


def _dead_points_of_driver(motion: Motion, outputs: Iterable[OutputFigures]) -> tuple[DriverDeadPoint, ...]:
    """Return the dead points of the driver along a motion, in its order."""
    if motion.inputs.poses < 2:
        return ()
    found = driver_dead_points(motion)
    places = ascending(found.place)
    if not len(places):
        return ()
    there = between(motion, 0, places, 0)
    # quantities of rates, such as forces, have no limit there
    named = [one.output.coordinate for one in outputs if one.least is not None]
    known = [quantity(there, name) for name in named if derivative_order(name) == 0]
    at = drivers_at(motion, places.tolist())
    return tuple(
        DriverDeadPoint(
            at[k],
            {one.name: scalar_quantity(one.name, float(np.ravel(one.values)[k]), one.unit) for one in known},
            _reason(motion, float(place)),
            float(place),
        )
        for k, place in enumerate(places)
    )


def _reason(motion: Motion, place: float) -> str:
    """Return the reason why poses beside a place cannot be assembled."""
    return next((gap.reason for gap in gaps(motion) if gap.first - 1 <= place <= gap.last + 1), "")
