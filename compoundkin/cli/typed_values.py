"""Values of drivers, rates, masses and loads as they are written on the command line."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import isfinite
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number, degrees, first_entry
from compoundkin.base.display import count_phrase
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.files.read_values import MOST_VALUES, rate, spaced, warn_of_radians, worded_rate, written_end
from compoundkin.kinematics.driver_values import FULL_TURN
from compoundkin.model.elements import Drive
from compoundkin.model.fields import Item
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads.gravity import gravity
from compoundkin.model.loads.mass import mass
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.units import KNOWN, Units, as_units
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
    """Return one finite number; degrees may say so: 60deg, 60\u00b0."""
    try:
        value = float(text.strip().removesuffix("deg").removesuffix("\u00b0") if "deg" not in how else text)
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


HOW_LOADS = {
    "--load": 'write POINT=X,Y, such as C=0,-500 or "C=0,-0.5 kN"',
    "--torque": 'write LINK=VALUE, such as rocker=-120 or "rocker=-0.12 N m"',
    "--mass": 'write LINK=VALUE, such as arm=15 or "arm=150 g"',
    "--gravity": "write two numbers in m/s^2: 0,-9.81",
    "--units": "write a unit of length, of mass and of force: mm,kg,N",
}


def with_loads(mechanism: Mechanism, options: Mapping[str, Any]) -> Mechanism:
    """Return the mechanism with the masses and loads of the command line, which replace those of the same name.

    Raises InvalidInput for what cannot be read, UnknownName for unknown points and links.
    """
    given = {option: options[name] for option, name in LOADS.items() if options[name]}
    if not given:
        return mechanism
    from compoundkin.model.loads.force import torque

    units = _units(mechanism, options["units"])
    items = [_force(mechanism, units, text) for text in options["forces_at"]]
    for text in options["torques"]:
        link, (value,) = _of_link(mechanism, "--torque", text, _moments(units))
        items.append(torque(link, value, name=f"torque {link}"))
    for text in options["masses"]:
        link, (value,) = _of_link(mechanism, "--mass", text, _sizes("mass", units.mass))
        items.append(mass(link, value))
    if options["gravity"]:
        x, y = _measured("--gravity", options["gravity"], options["gravity"], 2, {})
        items.append(gravity(x, y))
    twice = next((one for k, one in enumerate(items) if _key(one) in map(_key, items[:k])), None)
    if twice is not None:
        raise _invalid("--load, --torque, --mass", f"two are on {_key(twice)[-1]}", "add them up, or leave one out")
    words: dict[str, Any] = {} if mechanism.units is not None else {"unit": "", "units": units}
    return mechanism.replace(*items, **words)


# The options of masses and loads, by their values' names.
LOADS = {"--load": "forces_at", "--torque": "torques", "--mass": "masses", "--gravity": "gravity", "--units": "units"}


def _key(item: Item) -> tuple[str, ...]:
    """Return what a mass or a load replaces."""
    return type(item).__name__, str(getattr(item, "name", "")), str(getattr(item, "link", ""))


def _force(mechanism: Mechanism, units: Units, text: str) -> Item:
    """Return a force on a pin, or on a point of one link."""
    from compoundkin.model.loads.force import force

    place, x, y = _named("--load", text, 2, _sizes("force", units.force))
    link, _, letter = place.rpartition(".")
    carriers = mechanism.carriers
    if letter not in carriers:
        own = [one for one, links in carriers.items() if letter in links and FRAME not in links]
        what = f"{letter!r} is a link; a force acts on a point" if own else f"there is no point {letter!r}"
        remedy = f"its points are {', '.join(own)}" if own else suggestion(letter, list(carriers))
        raise UnknownName(Problem(f"--load {text}", what, remedy))
    if link and link not in mechanism.links:
        raise UnknownName(
            Problem(f"--load {text}", f"there is no link {link!r}", suggestion(link, list(mechanism.links)))
        )
    if link and link not in carriers[letter]:
        raise _invalid(f"--load {text}", f"{link} has no point {letter}", f"it is on {', '.join(carriers[letter])}")
    if set(carriers[letter]) == {FRAME}:
        raise _invalid(
            f"--load {text}", f"{letter} is on the frame alone, which holds every force", "name another point"
        )
    if not link and len(carriers[letter]) > 1:
        return force(letter, (x, y), name=f"load {letter}")
    return force(link or carriers[letter][0], (x, y), at=letter, name=f"load {letter}")


def _of_link(mechanism: Mechanism, option: str, text: str, sizes: Mapping[str, float]) -> tuple[str, tuple[float]]:
    """Return a link and its value."""
    name, value = _named(option, text, 1, sizes)
    if name not in mechanism.links:
        where = f"{option} {text}"
        raise UnknownName(Problem(where, f"there is no link {name!r}", suggestion(name, list(mechanism.links))))
    return name, (value,)


def _named(option: str, text: str, count: int, sizes: Mapping[str, float]) -> tuple[Any, ...]:
    """Return a name and its numbers."""
    name, equals, value = text.partition("=")
    if not (equals and name.strip()):
        raise _invalid(f"{option} {text}", "it names nothing", HOW_LOADS[option])
    return name.strip(), *_measured(option, text, value, count, sizes)


def _measured(option: str, text: str, value: str, count: int, sizes: Mapping[str, float]) -> list[float]:
    """Return numbers in the mechanism's units; `sizes` are those of the units that may stand behind them."""
    where, how = f"{option} {text}", HOW_LOADS[option]
    *first, last = value.split(",")
    number, _, unit = last.strip().partition(" ")
    unit = unit.strip()
    if unit and unit not in sizes:
        raise _invalid(where, f"{unit!r} is no unit here", suggestion(unit, list(sizes)) if sizes else how)
    numbers = [read_number(part, where, how) for part in (*first, number)]
    if len(numbers) != count:
        raise _invalid(where, f"{count_phrase(len(numbers), 'number')} instead of {count}", how)
    return [one * sizes.get(unit, 1.0) for one in numbers]


def _sizes(kind: str, own: str) -> dict[str, float]:
    """Return how many of a mechanism's own unit of mass or force each unit has."""
    return {name: size / KNOWN[kind][own] for name, size in KNOWN[kind].items()}


def _moments(units: Units) -> dict[str, float]:
    """Return how many of a mechanism's unit of moments each unit has."""
    forces, lengths = _sizes("force", units.force), _sizes("length", units.length)
    return {f"{force} {length}": a * b for force, a in forces.items() for length, b in lengths.items()}


def _units(mechanism: Mechanism, given: str | None) -> Units:
    """Return the mechanism's units; of one without, those given, else its unit of length, kg and N."""
    if mechanism.units is not None:
        if given:
            own = mechanism.units
            what = f"the file has units: {own.length}, {own.mass}, {own.force}"
            raise _invalid(f"--units {given}", what, "leave the option out")
        return mechanism.units
    words = [word.strip() for word in given.split(",")] if given else [mechanism.unit, "kg", "N"]
    if len(words) != 3:
        raise _invalid(f"--units {given}", f"{count_phrase(len(words), 'unit')} instead of 3", HOW_LOADS["--units"])
    if not given and mechanism.unit not in KNOWN["length"]:
        what = (
            f"the file's unit of length, {mechanism.unit!r}, has no size" if mechanism.unit else "the file has no units"
        )
        raise _invalid("--units", what, HOW_LOADS["--units"])
    found = as_units(dict(zip(KNOWN, words, strict=True)))
    assert found is not None
    if given and mechanism.unit in KNOWN["length"] and found.length != mechanism.unit:
        raise _invalid(
            f"--units {given}", f"the file's lengths are in {mechanism.unit}", f"begin with {mechanism.unit}"
        )
    return found


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
