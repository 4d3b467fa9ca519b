"""Where a simulation starts: which drivers are free, their values and speeds, and the laws of the others."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.arguments import is_finite_real
from compoundkin.base.errors import FewDigits, InvalidInput, Problem, UnassembledPoses, UnknownName, suggestion
from compoundkin.kinematics import solve
from compoundkin.kinematics.approach import drawn_value
from compoundkin.kinematics.chosen_modes import shown_by
from compoundkin.kinematics.configuration import Configuration
from compoundkin.kinematics.driver_values import inputs
from compoundkin.kinematics.gaps import gaps
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import solving_order_of
from compoundkin.model.laws import Law, as_law, constant_speed
from compoundkin.model.mechanism import Mechanism


@dataclass(frozen=True, eq=False)
class SimulationStart:
    """The first pose as a motion. The speeds of free drivers, the laws of others."""

    motion: Motion
    speeds: Mapping[str, float]
    laws: Mapping[str, Law]

    @property
    def values(self) -> Mapping[str, float]:
        """The values of the free drivers."""
        return {name: float(np.ravel(self.motion.inputs.drives[name][0])[0]) for name in self.speeds}


def simulation_start(
    mechanism: Mechanism,
    start: Any,
    prescribed: Mapping[str, Any],
    modes: Mapping[str, int] | str | Configuration | None,
) -> SimulationStart:
    """Return where a simulation starts; raises InvalidInput and UnknownName for what does not fit."""
    names = [own.name for own in mechanism.drives]
    if start is not None and not isinstance(start, Mapping):
        if len(names) != 1:
            raise InvalidInput(Problem("start", "there is more than one driver", "name them: {'driver': value}"))
        start = {names[0]: start}
    told: Mapping[str, Any] = start or {}
    for where, given in (("start", told), ("prescribed", prescribed)):
        for name in given:
            if name not in names:
                raise UnknownName(
                    Problem(f"{where}.{name}", f"there is no driver {name!r}", suggestion(str(name), names))
                )
    laws = _laws(mechanism, told, prescribed)
    free = {name: _pair(f"start.{name}", told[name]) if name in told else (None, 0.0)
            for name in names if name not in laws}  # fmt: skip
    if not free:
        raise InvalidInput(Problem("prescribed", "all drivers are prescribed", "leave one free, or use solve()"))
    motion = _first_pose(mechanism, {name: value for name, (value, _) in free.items()}, laws, modes)
    return SimulationStart(motion, {name: speed for name, (_, speed) in free.items()}, laws)


def _first_pose(
    mechanism: Mechanism,
    free: Mapping[str, float | None],
    laws: Mapping[str, Law],
    modes: Mapping[str, int] | str | Configuration | None,
) -> Motion:
    """Return the first pose. Raises InvalidInput where it cannot be assembled."""
    shown = _shown(mechanism)
    values = {name: shown[name] if value is None else value for name, value in free.items()}
    values |= {name: float(np.ravel(law.coordinate(np.zeros(1), 0).c[0])[0]) for name, law in laws.items()}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnassembledPoses)
        warnings.simplefilter("ignore", FewDigits)  # another pair takes the driver's place there
        motion = solve(mechanism, {name: [value] for name, value in values.items()}, order=1, modes=modes)
    if motion.failed.any():
        reasons = "; ".join(gap.reason for gap in gaps(motion))
        raise InvalidInput(Problem("start", reasons or "it cannot be assembled there", "start elsewhere"))
    return motion


def _laws(mechanism: Mechanism, start: Mapping[str, Any], prescribed: Mapping[str, Any]) -> dict[str, Law]:
    """Return the laws of the drivers that are prescribed, by the call or by the mechanism."""
    found: dict[str, Law] = {}
    for own in mechanism.drives:
        if own.name in prescribed and own.name in start:
            what = "it is given a start as a free driver, and prescribed too"
            raise InvalidInput(Problem(f"prescribed.{own.name}", what, "leave one of both out"))
        if own.name in prescribed:
            given = prescribed[own.name]
            law = constant_speed(0.0, start=given) if is_finite_real(given) else as_law(f"prescribed.{own.name}", given)
            if law is not None:
                found[own.name] = law
        elif own.law is not None and own.name not in start:
            found[own.name] = own.law
    return found


def _pair(where: str, given: Any) -> tuple[float, float]:
    """Return value and speed of a free driver."""
    parts = given if isinstance(given, tuple | list) else (given, 0.0)
    if len(parts) != 2 or not all(is_finite_real(part) for part in parts):
        remedy = "give a value in radians or lengths, or (value, speed)"
        raise InvalidInput(Problem(where, f"{given!r} is no start", remedy))
    return float(parts[0]), float(parts[1])


def _shown(mechanism: Mechanism) -> dict[str, float]:
    """Return the drivers' values of the drawing, else of the first pose."""
    order = solving_order_of(mechanism)
    given = inputs(order, {own.name: 0.0 for own in mechanism.drives if own.values is None}, None, None, None)
    shown = shown_by(order)
    found = {}
    for own in mechanism.drives:
        value = drawn_value(order, given, own.name, shown.poses, shown.beside) if own.values is None else own.values
        found[own.name] = 0.0 if value is None else float(np.ravel(value)[0])
    return found
