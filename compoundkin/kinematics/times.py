"""Motions in time: at which times a mechanism is solved, and where its drivers are then."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.model.elements import Drive
from compoundkin.model.laws import Law
from compoundkin.model.laws.constant_laws import taylor
from compoundkin.model.mechanism import Mechanism

# A period is sampled as finely as a full turn in steps of five degrees.
SAMPLES = 73
# Value, speed, acceleration and jerk.
RATES = 4


def times_of(mechanism: Mechanism, values: Mapping[str, Any] | None, time: Any) -> Number | None:
    """The times of a motion; None where the drivers' values are given instead.

    They are `time`, else those that the mechanism states, else 73 over the range on which all laws agree. Raises
    InvalidInput for times that are not numbers, and where laws need times that nothing tells.

    >>> from compoundkin.model.laws.motion_programs import program, rise
    >>> from compoundkin.model.elements import drive, link
    >>> law = program(rise(1.0, over=2.0))
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=1), drive("crank", law=law))
    >>> float(times_of(crank, None, None)[-1])
    2.0
    """
    if time is not None:
        return _checked(time)
    laws = {d.name: d.law for d in mechanism.drives if d.law is not None}
    known = values or {}
    if known and all(name in known for name in laws):
        return None
    if mechanism.time is not None:
        return _checked(mechanism.time)
    return _agreed(laws) if laws else None


def _checked(time: Any) -> Number:
    try:
        out = np.asarray(time, dtype=float)
    except (TypeError, ValueError):
        raise InvalidInput(Problem("time", f"{time!r} is not a number or an array of numbers")) from None
    if out.size == 0 or not np.isfinite(out).all():
        raise InvalidInput(Problem("time", "the times are empty or not finite", "give seconds, in order of the motion"))
    return out


def _agreed(laws: Mapping[str, Law]) -> Number:
    spans = list(dict.fromkeys(law.span for law in laws.values()))
    if len(spans) == 1 and spans[0] is not None:
        return np.linspace(*spans[0], SAMPLES)
    told = ", ".join(f"{name} from {law.span[0]:g} to {law.span[1]:g} s" for name, law in laws.items() if law.span)
    what = f"the laws have different ranges: {told}" if told else "nothing tells for how long the drivers move"
    raise InvalidInput(
        Problem("time", what, "give time=numpy.linspace(0, 2, 201), --time 0:2:0.01, or time in the file")
    )


def timed(
    drive: Drive, given: tuple[Number, ...], times: Number, asked: Mapping[str, bool], order: int
) -> tuple[Number, ...]:
    """Value, speed, acceleration and jerk of a driver at times.

    `given` are those without a law, from which the driver moves as a polynomial in time; `asked` tells which of
    them the call gives. Raises InvalidInput where a driver has a law and is given them as well, or where they vary
    along the motion.
    """
    if drive.law is not None:
        for what in [key for key, called in asked.items() if called]:
            remedy = f"leave the {what} out, or give values for every driver and no time"
            raise InvalidInput(Problem(f"{what}.{drive.name}", "the driver moves by its law in time", remedy))
        return _by_law(drive, times, order)
    for what, value in zip(asked, given, strict=True):
        if np.ndim(value) and np.shape(value)[-1] > 1:
            text = f"its {what} {'vary' if what == 'values' else 'varies'} along the motion, which the times do already"
            remedy = "give a single number, where it is at time 0, or a law" if what == "values" else "give one number"
            raise InvalidInput(Problem(f"drives.{drive.name}.{what}", text, remedy))
    moved = taylor(given, times, RATES - 1)
    return tuple(moved.derivative(k) for k in range(RATES))


def _by_law(drive: Drive, times: Number, order: int) -> tuple[Number, ...]:
    law: Any = drive.law
    try:
        moved = law.coordinate(times, order)
    except InvalidInput as error:
        problems = [replace(p, where=f"drives.{drive.name}.{p.where}") for p in error.problems]
        raise InvalidInput(problems) from error.__cause__
    return tuple(moved.derivative(k) for k in range(RATES))
