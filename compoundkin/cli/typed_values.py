"""Values of drivers, rates and assembly modes as they are written on the command line."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import isfinite
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number, degrees, first_entry
from compoundkin.base.errors import InvalidInput, Problem, suggestion
from compoundkin.files.read_values import MOST_VALUES, rate, spaced, warn_of_radians, worded_rate, written_end
from compoundkin.kinematics.driver_values import FULL_TURN
from compoundkin.model.elements import Drive
from compoundkin.structure import Structure

HOW = "write 35, 0,35,60 or 0:360:5 (from:to:step)"
TIMES = "write seconds: 0.5, 0,0.5,1 or 0:2:0.01 (from:to:step)"

# By the option, and whether the driver's coordinate is an angle.
HOW_RATES = {
    ("--speed", True): "write 10 (rad/s), 300rpm or 90deg (a second)",
    ("--speed", False): "write 0.5 (lengths a second)",
    ("--acceleration", True): "write 7 (rad/s^2) or 90deg (a second, each second)",
    ("--acceleration", False): "write 0.5 (lengths a second, each second)",
}


def read_driver_values(structure: Structure, options: Mapping[str, Any]) -> dict[str, Number]:
    """Return the values given by driver, as `solve` takes them: radians or lengths.

    Raises InvalidInput for invalid numbers, for unknown drivers, and for ranges of different lengths.
    """
    texts: dict[str, str] = {}
    for name, text in _by_driver(structure, "--drive", options["drives"]):
        if name in texts:
            raise _invalid(f"--drive {name}", "the driver's values are given twice", "leave one of them out")
        texts[name] = text
    shown = {name: read_numbers(text, f"--drive {name}") for name, text in texts.items()}
    span = {key: options[key] for key in ("at", "start", "stop", "step") if options[key] is not None}
    if span:
        name = _only_driver(structure, "--at" if "at" in span else "--from, --to, --step")
        if name in shown:
            raise _invalid(f"--drive {name}", "the driver's values are given twice", "leave one of them out")
        shown[name] = _spanned(structure, name, span)
    angles = structure.driven_angles
    for name, v in ((name, v) for name, v in shown.items() if angles[name]):
        warn_of_radians(f"--drive {name}", v[0], written_end(texts.get(name, span.get("at")), span.get("stop", v[-1])))
    values = {name: np.deg2rad(v) if angles[name] else v for name, v in shown.items()}
    if options.get("time") is None:
        _of_one_length(structure, values)
    return {name: float(v[0]) if len(v) == 1 else v for name, v in values.items()}


def read_times(text: str | None) -> Number | None:
    """Return the times given, in seconds; None where none are.

    >>> read_times("0:1:0.5").tolist()
    [0.0, 0.5, 1.0]
    """
    return None if text is None else read_numbers(text, "--time", TIMES)


def read_pose(structure: Structure, given: Sequence[str], option: str = "--at") -> dict[str, float]:
    """Return one value of every driver, radians or lengths: the one given, else the first of its own range."""
    names = [drive.name for drive in structure.mechanism.drives]
    if len(names) > 1 and any("=" not in text for text in given):
        raise _invalid(option, f"there are {len(names)} drivers", f"write NAME=VALUE, NAME one of {', '.join(names)}")
    found, angles = _first(structure), structure.driven_angles
    shown = list(_by_driver(structure, option, given))
    for name, text in shown:
        if sum(other == name for other, _ in shown) > 1:
            raise _invalid(f"{option} {name}", "the driver's value is given twice", "leave one of them out")
        found[name] = _single(text, f"{option} {text}", angles[name])
    return found


def _first(structure: Structure) -> dict[str, float]:
    """Return the first value of every driver that has values, a law, or a full turn."""
    own = {drive.name: _values_of(structure, drive) for drive in structure.mechanism.drives}
    return {name: float(first_entry(values)) for name, values in own.items() if values is not None}


def _values_of(structure: Structure, drive: Drive) -> Number | None:
    """Return a driver's own values; of a law the first one."""
    if drive.law is not None:
        time = structure.mechanism.time
        first = float(first_entry(time)) if time is not None else (drive.law.span or (0.0,))[0]
        return drive.law.coordinate(np.array([first]), 0).c[0]
    return FULL_TURN if drive.values is None and structure.driven_angles[drive.name] else drive.values


def _single(text: str, where: str, is_angle: bool) -> float:
    try:
        value = read_number(text, where)
    except InvalidInput:
        raise _invalid(where, "this is not one number", "give the value of a single pose") from None
    return float(np.deg2rad(value)) if is_angle else value


def read_numbers(text: str, where: str, how: str = HOW) -> Number:
    """Return numbers written one by one, or as from:to:step.

    >>> read_numbers("0:10:5", "--at").tolist()
    [0.0, 5.0, 10.0]
    """
    parts = text.split(":")
    if len(parts) == 1:
        return np.array([read_number(part, where, how) for part in text.split(",")])
    if len(parts) != 3:
        raise _invalid(where, f"{text!r} is not a range", how)
    start, stop, step = (read_number(part, where, how) for part in parts)
    return stepped_values(start, stop, step, where)


def read_number(text: str, where: str, how: str = HOW) -> float:
    """Return one finite number."""
    try:
        value = float(text)
    except ValueError:
        raise _invalid(where, f"{text!r} is not a number", how) from None
    if not isfinite(value):
        raise _invalid(where, f"{text!r} is not finite", how)
    return value


def stepped_values(start: float, stop: float, step: float, where: str) -> Number:
    """Return the values from start to stop in steps.

    Raises InvalidInput where the step leads elsewhere or is too small.
    """
    if not all(map(isfinite, (start, stop, step))) or step == 0 or (stop - start) * step < 0:
        raise _invalid(where, f"steps of {step:g} do not lead from {start:g} to {stop:g}")
    found = spaced(start, stop, step)
    if found is None:
        raise _invalid(where, f"these are more than {MOST_VALUES:,} values", "take a greater step")
    return found


def read_rates(structure: Structure, option: str, given: Sequence[str]) -> dict[str, float] | None:
    """Return rates by driver; None where none is given."""
    angles = structure.driven_angles
    named = _by_driver(structure, option, given)
    return {name: _rate(text, option, name, angles[name]) for name, text in named} or None


def _rate(text: str, option: str, name: str, is_angle: bool) -> float:
    where, how = f"{option} {name}", HOW_RATES[option, is_angle]
    worded = worded_rate(text)
    if worded is text:
        return read_number(text, where, how)
    if not is_angle:
        raise _invalid(where, f"{text!r} is not a valid speed", "write lengths a second")
    return float(rate(worded, where, True))


def _by_driver(structure: Structure, option: str, given: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Yield drivers with the texts of their values; the only driver need not be named."""
    drivers = [drive.name for drive in structure.mechanism.drives]
    for text in given:
        name, equals, value = text.rpartition("=")
        name = name if equals else _only_driver(structure, f"{option} {text}", "write NAME=VALUE, NAME one of ")
        if name not in drivers:
            raise _invalid(f"{option} {text}", f"there is no driver {name!r}", suggestion(name, drivers))
        yield name, value


def _only_driver(structure: Structure, where: str, how: str = "name one with --drive: ") -> str:
    """Return the only driver. Raises InvalidInput where there is none, or several."""
    drivers = [drive.name for drive in structure.mechanism.drives]
    if len(drivers) == 1:
        return drivers[0]
    if not drivers:
        raise _invalid(where, "the mechanism has no driver")
    raise _invalid(where, f"there are {len(drivers)} drivers", f"{how}{', '.join(drivers)}")


def _spanned(structure: Structure, name: str, span: Mapping[str, Any]) -> Number:
    """Return the values of --at, or of --from, --to and --step, completed from the driver's own range."""
    if "at" in span:
        if len(span) > 1:
            raise _invalid("--at", "it does not go with --from, --to and --step", "leave one of them out")
        return read_numbers(span["at"], "--at")
    own = _own_range(structure, name)
    if own is None and not {"start", "stop", "step"} <= set(span):
        raise _invalid("--from, --to, --step", f"the driver {name!r} has no range of its own", "give all three")
    start, stop, step = own if own is not None else (0.0, 0.0, 0.0)
    start, stop, step = span.get("start", start), span.get("stop", stop), span.get("step", abs(step))
    # "--from 90 --to 0 --step 5" can only mean to go back
    return stepped_values(start, stop, step if stop >= start or step < 0 else -step, "--from, --to, --step")


def _own_range(structure: Structure, name: str) -> tuple[float, float, float] | None:
    """Return first value, last value and step of a driver's own range, in the first design."""
    drive = next(drive for drive in structure.mechanism.drives if drive.name == name)
    is_angle = structure.driven_angles[name]
    if drive.values is None and not is_angle:
        return None
    values = np.atleast_1d(FULL_TURN if drive.values is None else drive.values)
    values = values.reshape(-1, values.shape[-1])[0]
    if len(values) < 2:
        return None
    shown = degrees(values) if is_angle else values
    return float(shown[0]), float(shown[-1]), float(shown[1] - shown[0])


def _of_one_length(structure: Structure, values: Mapping[str, Number]) -> None:
    full = {drive.name: _values_of(structure, drive) for drive in structure.mechanism.drives}
    lengths = {name: np.shape(v)[-1] for name, v in {**full, **values}.items() if v is not None and np.shape(v)}
    if len({length for length in lengths.values() if length > 1}) > 1:
        counts = ", ".join(f"{name} has {length}" for name, length in lengths.items())
        what = f"the drivers have different numbers of values: {counts}"
        raise _invalid("--drive", what, "give every driver as many values, or a single one")


def _invalid(where: str, what: str, remedy: str = "") -> InvalidInput:
    return InvalidInput(Problem(where, what, remedy))
