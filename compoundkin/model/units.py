"""The units of length, mass and force in which a mechanism is written; seconds and radians are understood."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import pi
from typing import Any

from compoundkin.base.errors import InvalidMechanism, Problem, suggestion

# In metres, kilograms, newtons; feet, pounds and their kin as defined by the international agreement of 1959, the
# pound-force by the standard acceleration of 9.80665 m/s^2.
_FOOT, _POUND, STANDARD_GRAVITY = 0.3048, 0.45359237, 9.80665
LENGTHS = {"m": 1.0, "dm": 1e-1, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "in": _FOOT / 12.0, "ft": _FOOT}
MASSES = {
    **{"kg": 1.0, "g": 1e-3, "mg": 1e-6, "t": 1e3, "lb": _POUND, "lbm": _POUND, "oz": _POUND / 16.0},
    # a pound-force accelerates these by one foot, one inch per second squared
    **{"slug": _POUND * STANDARD_GRAVITY / _FOOT, "blob": _POUND * STANDARD_GRAVITY / (_FOOT / 12.0)},
}
FORCES = {
    **{"N": 1.0, "uN": 1e-6, "mN": 1e-3, "kN": 1e3, "MN": 1e6, "dyn": 1e-5, "kgf": STANDARD_GRAVITY},
    **{"lbf": _POUND * STANDARD_GRAVITY, "ozf": _POUND * STANDARD_GRAVITY / 16.0},
    **{"kip": 1e3 * _POUND * STANDARD_GRAVITY},
}
# In watts; products of powers of ten that differ by rounding alone are one unit.
_POWERS, _SAME = {"W": 1.0, "uW": 1e-6, "mW": 1e-3, "kW": 1e3, "MW": 1e6}, 1e-12
KNOWN: Mapping[str, Mapping[str, float]] = {"length": LENGTHS, "mass": MASSES, "force": FORCES}
# Angular velocities as solved, and as they stand on the plate of a motor: (unit, how many there are in the first).
ANGULAR_VELOCITY, TURNS = "rad/s", ("rpm", 30.0 / pi)


@dataclass(frozen=True)
class Units:
    """The units of length, mass and force. Numbers are converted by them, never reinterpreted.

    >>> Units("mm", "kg", "N").inertia
    0.001
    """

    length: str
    mass: str
    force: str

    @property
    def inertia(self) -> float:
        """The force that gives a unit of mass a unit of acceleration."""
        return LENGTHS[self.length] * MASSES[self.mass] / FORCES[self.force]

    @property
    def metre(self) -> float:
        """A metre in units of length."""
        return 1.0 / LENGTHS[self.length]

    @property
    def moment(self) -> str:
        """The unit of moments."""
        return f"{self.force} {self.length}"

    @property
    def power(self) -> str:
        """The unit of power: a moment per second, or its own name.

        >>> Units("mm", "kg", "N").power, Units("in", "blob", "lbf").power
        ('mW', 'lbf in/s')
        """
        watts = LENGTHS[self.length] * FORCES[self.force]
        own = (name for name, size in _POWERS.items() if abs(watts / size - 1.0) < _SAME)
        return next(own, f"{self.moment}/s")


def customary_unit(unit: str, energy: bool = False) -> tuple[str, float] | None:
    """Return the unit in which a speed, a torque or a power is customary, and how many of it one of `unit` is.

    rpm, N m (of an energy J) and W; None for other quantities and where `unit` is that already.

    >>> customary_unit("N mm"), customary_unit("kW"), customary_unit("N"), customary_unit("N m", energy=True)
    (('N m', 0.001), ('W', 1000.0), None, ('J', 1.0))
    """
    if unit == ANGULAR_VELOCITY:
        return TURNS
    force, _, rest = unit.partition(" ")
    length, _, per = rest.partition("/")
    if unit in _POWERS:
        found = "W", _POWERS[unit]
    elif force in FORCES and length in LENGTHS and per in ("", "s"):
        found = "W" if per else "J" if energy else "N m", FORCES[force] * LENGTHS[length]
    else:
        return None
    return found if found[0] != unit else None


def with_customary(value: float, unit: str) -> str:
    """Return a number with its unit, and in parentheses in the unit in which it is customary.

    >>> with_customary(120000.0, "N mm"), with_customary(10 * pi, "rad/s"), with_customary(5.0, "mm/s")
    ('120000 N mm (120 N m)', '31.4159 rad/s (300 rpm)', '5 mm/s')
    """
    own, other = f"{value + 0.0:.6g} {unit}", customary_unit(unit)
    return own if other is None else f"{own} ({value * other[1] + 0.0:.6g} {other[0]})"


def as_units(given: Any) -> Units | None:
    """Return units from a mapping of names or a `Units` object, None from None.

    Raises InvalidMechanism for unknown or missing units.

    >>> as_units({"length": "in", "mass": "blob", "force": "lbf"}).inertia
    1.0
    """
    if given is None or isinstance(given, Units):
        return given
    problems = list(_unit_problems(given))
    if problems:
        raise InvalidMechanism(problems)
    return Units(given["length"], given["mass"], given["force"])


def checked_units(given: Any, unit: str) -> tuple[Units | None, list[Problem]]:
    """Return units and their problems. A `unit` of length beside them is one of these.

    >>> checked_units({"length": "mm", "mass": "kg", "force": "N"}, "mm")[1][0].what
    'units name the unit of length already'
    """
    twice = Problem("unit", "units name the unit of length already", "leave unit out")
    problems = [twice] if given is not None and unit else []
    try:
        return as_units(given), problems
    except InvalidMechanism as error:
        return None, [*problems, *error.problems]


def _unit_problems(given: Any) -> Iterator[Problem]:
    if not isinstance(given, Mapping):
        remedy = 'write units={"length": "mm", "mass": "kg", "force": "N"}'
        yield Problem("units", f"{given!r} does not name units", remedy)
        return
    for key in given:
        if key not in KNOWN:
            yield Problem(f"units.{key}", f"{key!r} has no unit here", "known: length, mass, force")
    for key, known in KNOWN.items():
        if key not in given:
            yield Problem(f"units.{key}", f"the unit of {key} is missing", f"known: {', '.join(known)}")
        elif given[key] not in known:
            what = f"{given[key]!r} is no known unit of {key}"
            yield Problem(f"units.{key}", what, suggestion(given[key], list(known)))
