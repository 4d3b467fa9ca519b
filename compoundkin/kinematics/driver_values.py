"""What a call and a mechanism say of the drivers: values, rates, laws and times, as the inputs of a solution."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import isfinite
from typing import Any

import numpy as np

from compoundkin.base.arguments import real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem, suggestion
from compoundkin.kinematics.inputs import Inputs, fit, mapped
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.elements import Drive
from compoundkin.model.laws import Law
from compoundkin.model.laws.constant_laws import taylor
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.contract import Ends

# A period is sampled as finely as a full turn in steps of five degrees.
SAMPLES = 73
# Value, speed, acceleration and jerk.
RATES = 4
# A full turn in steps of five degrees: what a driver of a pin does when it is not told otherwise.
FULL_TURN = np.deg2rad(np.arange(0.0, 361.0, 5.0))
FULL_TURN.setflags(write=False)


def inputs(
    solving_order: SolvingOrder,
    values: Mapping[str, Any] | None,
    speed: Any,
    acceleration: Any,
    jerk: Any,
    times: Number | None = None,
    order: int = RATES - 1,
    drives: Sequence[Drive] | None = None,
) -> Inputs:
    """Return the inputs of a solution, in time where `times` are given.

    `drives` may replace the mechanism's own. Raises InvalidInput for unknown drivers or shapes that do not fit.
    """
    mechanism = solving_order.structure.mechanism
    asked = {"values": values, "speed": speed, "acceleration": acceleration, "jerk": jerk}
    _only_known(mechanism, asked)
    given = {one.name: _driver(solving_order, one, asked, times, order) for one in drives or mechanism.drives}
    shape = _shape(solving_order, given)
    fitted = fit(shape)
    driven = {k: tuple(fitted(v) for v in vs) for k, vs in given.items()}
    return Inputs(shape, _fitted_ends(solving_order, fitted), driven)


def _fitted_ends(solving_order: SolvingOrder, fitted: Callable[[Number], Number]) -> Mapping[str, Ends]:
    """Return the pairs' dimensions in the form of the inputs; all numbers are that form already."""
    if solving_order.is_of_numbers:
        return solving_order.ends
    return {k: tuple(mapped(end, fitted) for end in ends) for k, ends in solving_order.ends.items()}


def by_name(mechanism: Mechanism, values: Any) -> Mapping[str, Any] | None:
    """Return the values of the drivers by name. Those of the only one may go without; raises InvalidInput."""
    if values is None or isinstance(values, Mapping):
        return values
    if len(mechanism.drives) != 1:
        raise InvalidInput(Problem("values", "there is more than one driver", "name them: {'driver': ...}"))
    return {mechanism.drives[0].name: values}


def _driver(
    solving_order: SolvingOrder, drive: Drive, asked: Mapping[str, Any], times: Number | None, order: int
) -> tuple[Number, ...]:
    """Value, speed, acceleration and jerk of a driver; those of a law beyond the order are not asked for."""
    value = (asked["values"] or {}).get(drive.name, drive.values)
    if value is None:
        value = _unsaid(solving_order, drive) if times is None else 0.0
    only = len(solving_order.structure.driven) == 1
    rest = [_rate(drive, asked[key], getattr(drive, key), only) for key in ("speed", "acceleration", "jerk")]
    given = tuple(_number(f"{drive.name}", v) for v in (value, *rest))
    if times is None:
        return given
    called = {key: drive.name in what if isinstance(what, Mapping) else what is not None for key, what in asked.items()}
    return timed(drive, given, times, called, order)


def _unsaid(solving_order: SolvingOrder, drive: Drive) -> Number:
    """Return the values of a driver that is given none: a full turn."""
    if not solving_order.structure.driven_angles[drive.name]:
        raise InvalidInput(
            Problem(f"drives.{drive.name}", "it has no values", f"solve(..., {{{drive.name!r}: lengths}})")
        )
    return FULL_TURN


def _rate(drive: Drive, what: Any, default: Number, only: bool) -> Any:
    if what is None:
        return default
    if isinstance(what, Mapping):
        return what.get(drive.name, default)
    if only:
        return what
    raise InvalidInput(
        Problem("speed", "there are several drivers", f"give one for each by name: {{{drive.name!r}: ...}}")
    )


def _number(where: str, value: Any) -> Number:
    if type(value) is float and isfinite(value):
        return value
    out = real_numbers(where, value)
    if out.size == 0 or not np.isfinite(out).all():
        raise InvalidInput(Problem(where, "the value is empty or not finite"))
    return float(out) if out.ndim == 0 else out


def _only_known(mechanism: Mechanism, given: Mapping[str, Any]) -> None:
    names = [d.name for d in mechanism.drives]
    wrong = [
        Problem(f"{what}.{name}", f"there is no driver {name!r}", suggestion(name, names))
        for what, table in given.items()
        if isinstance(table, Mapping)
        for name in table
        if name not in names
    ]
    if wrong:
        raise InvalidInput(wrong)


def _shape(solving_order: SolvingOrder, drives: Mapping[str, tuple[Number, ...]]) -> tuple[int, ...]:
    found: tuple[int, ...] = ()
    named = [(f"drives.{k}", v) for k, vs in drives.items() for v in vs if isinstance(v, np.ndarray)]
    for where, value in (*named, *solving_order.dimension_arrays):
        try:
            found = np.broadcast_shapes(found, np.shape(value))
        except ValueError:
            raise InvalidInput(
                Problem(
                    where, f"shape {np.shape(value)} does not broadcast with {found}", "the last axis is the motion"
                )
            ) from None
    return found


def times_of(
    mechanism: Mechanism, values: Mapping[str, Any] | None, time: Any, drives: Sequence[Drive] | None = None
) -> Number | None:
    """Return the times of a motion; None where the drivers' values are given instead.

    They are `time`, else those that the mechanism states, else 73 over the range on which all laws agree; `drives` may
    replace its own. Raises InvalidInput for times that are not numbers, and where laws need times that nothing tells.

    >>> from compoundkin.model.laws import program, rise
    >>> from compoundkin.model.elements import drive, link
    >>> law = program(rise(1.0, over=2.0))
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=1), drive("crank", law=law))
    >>> float(times_of(crank, None, None)[-1])
    2.0
    """
    if time is not None:
        return _checked(time)
    laws = {d.name: d.law for d in drives or mechanism.drives if d.law is not None}
    known = values or {}
    if known and all(name in known for name in laws):
        return None
    if mechanism.time is not None:
        return _checked(mechanism.time)
    return _agreed(laws) if laws else None


def _checked(time: Any) -> Number:
    out = real_numbers("time", time)
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
    """Return value, speed, acceleration and jerk of a driver at times.

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
        if np.shape(value)[-1:] > (1,):
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
