"""Cam profiles as tables of points, written for CAD and machine tools; curves as chords within a stated error."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.base.suffixes import suffix_for
from compoundkin.files.exchange.contract import Exported, Writable, positive, whole
from compoundkin.files.exchange.posed_mechanism import PosedMechanism
from compoundkin.model.pairs.profile_contact import ProfileContact, as_profile_contact

# How far chords may be off where it is not said, in parts of the profile's size.
CHORD = 1e-5


# No machine is finer than this part of the profile's size.
FINEST = 1e-8


FEWEST, MOST = 8, 1_000_000


class CamProfileFormat(Writable):
    """Points of a profile as CSV, a row for each."""

    name: ClassVar[str] = "cam-profile"
    program: ClassVar[str] = "milling and eroding machines"
    title: ClassVar[str] = "cam profile"
    suffix: ClassVar[str] = suffix_for("table", "csv")
    options: ClassVar[Mapping[str, str]] = MappingProxyType(
        {
            "cam": "the pair whose profile it is, where there are several",
            "tolerance": "how far chords may be off, a length; 1/100000 of the profile's size if left out",
            "points": "instead of a tolerance so many points at equal steps, of the cam's angle where made for one",
            "cutter": "the radius of a cutter, whose path is added",
        }
    )

    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
        """Return the table. Raises InvalidInput or UnknownName where it is not said of which cam."""
        pair = _pair(shown, options.get("cam"))
        tolerance = positive("tolerance", options.get("tolerance"), CHORD * pair.extent, FINEST * pair.extent)
        cutter = None if options.get("cutter") is None else positive("cutter", options["cutter"], 0.0)
        found = profile_points(pair, tolerance, cutter, _count(options))
        unit = shown.mechanism.unit
        text = io.StringIO()
        rows = csv.writer(text, lineterminator="\n")
        rows.writerow(_heads(found, unit))
        rows.writerows(_rows(found))
        return Exported(text.getvalue().encode("utf-8"), self.name, tuple(_notes(pair, found, unit)))


def _pair(shown: PosedMechanism, name: Any) -> ProfileContact:
    """The pair that is asked for, or the only one."""
    known = {pair.name: found for pair in shown.pairs if (found := as_profile_contact(pair)) is not None}
    if not known:
        raise InvalidInput(Problem(shown.mechanism.title, "it has no cam", "export another mechanism"))
    if name is None and len(known) > 1:
        raise InvalidInput(Problem("cam", f"there are {len(known)}", f"name one: {', '.join(known)}"))
    wanted = next(iter(known)) if name is None else str(name)
    if wanted not in known:
        raise UnknownName(Problem("cam", f"there is no cam pair {wanted!r}", suggestion(wanted, list(known))))
    return known[wanted]


def _count(options: Mapping[str, Any]) -> int | None:
    """How many points are asked for, if any."""
    if options.get("points") is None:
        return None
    if options.get("tolerance") is not None:
        raise InvalidInput(Problem("points", "points and a tolerance are both given", "leave one of them out"))
    return whole("points", options["points"], FEWEST, MOST)


def _heads(found: ProfilePoints, unit: str) -> Iterator[str]:
    lengths = f" [{unit}]" if unit else ""
    yield "parameter"
    for curve in found.curves:
        yield from (f"{curve} {axis}{lengths}" for axis in "xy")
    yield from ("normal x", "normal y", f"radius of curvature{lengths}")


def _rows(found: ProfilePoints) -> Iterator[tuple[float, ...]]:
    places = [part for row in (*found.curves.values(), found.normals) for part in (row.real, row.imag)]
    # lists of Python floats, which are written with as many digits as distinguish them
    return zip(found.parameters.tolist(), *(row.tolist() for row in places), found.radii.tolist(), strict=True)


def _notes(pair: ProfileContact, found: ProfilePoints, unit: str) -> Iterator[str]:
    closed = "closed: the last is the first again" if pair.curve.closed else "open"
    yield f"{len(found.parameters)} points of the profile of {pair.name}, in the frame of {pair.on}; {closed}"
    yield f"chords between them are off by {found.error:.3g}{f' {unit}' if unit else ''} at most"
    if pair.is_flat:
        yield "a flat face has no pitch curve"


FORMAT = CamProfileFormat()


# The profile is first cut into so many steps, besides at its own breaks.
FIRST = 48


# Shares of a step at which the error of its chord is looked for.
LOOKED_AT = np.linspace(0.0, 1.0, 9)[1:-1]


# A cutter that is nearer to the profile than its radius by this part of the profile's size cuts into it; less is
# rounding.
CUTS = 1e-9


@dataclass(frozen=True, eq=False)
class ProfilePoints:
    """Points of a cam's curves at the same parameters, complex, by the curves' names.

    `error` is that of chords.

    `normals` point towards the follower; `radii` of curvature are negative in a hollow. The last point of a closed
    profile is the first again.
    """

    parameters: Number
    curves: Mapping[str, Number]
    normals: Number
    radii: Number
    error: float


def profile_points(
    pair: ProfileContact, tolerance: float, cutter: float | None = None, count: int | None = None
) -> ProfilePoints:
    """Return points within a tolerance, or a count of them.

    These are at equal steps of the parameter. The cutter's path is that of its middle. Raises InvalidInput for a cutter
    that cuts into the profile.
    """
    away = {"profile": 0.0}
    if not pair.is_flat:
        away["pitch"] = pair.roller
    if cutter is not None:
        away["cutter"] = cutter
    offsets = np.array(list(away.values()))[:, None] * pair.outward

    def places(s: Number) -> Number:
        return pair.curve.at(s).c[0] + offsets * pair.curve.normal(s).c[0]

    low, high = pair.curve.low, pair.curve.high
    if count is None:
        within = [s for s in pair.curve.breaks if low < s < high]
        s, rows, _ = short_chords(np.unique([*np.linspace(low, high, FIRST + 1), *within]), places, tolerance)
    else:
        s = np.linspace(low, high, count + 1 if pair.curve.closed else count)
        rows = places(s)
    between = [beside_chords(rows[:, :-1], rows[:, 1:], places(s[:-1] + share * np.diff(s))) for share in LOOKED_AT]
    error = np.max(between)
    with np.errstate(divide="ignore"):
        radii = 1.0 / (pair.outward * pair.curve.curvature(s))
    normals = pair.curve.normal(s).c[0] * pair.outward
    if cutter is not None:
        _hold_cutter(pair, rows[-1], cutter)
    return ProfilePoints(s, dict(zip(away, rows, strict=True)), normals, radii, float(error))


def _hold_cutter(pair: ProfileContact, middles: Number, cutter: float) -> None:
    """Raise InvalidInput where a cutter takes away what it should leave, in a hollow or anywhere else."""
    nearest = np.abs(middles - pair.curve.at(pair.curve.foot(middles).c[0]).c[0])
    worst = int(np.argmin(nearest))
    if nearest[worst] < cutter - CUTS * pair.extent:
        at = middles[worst]
        what = (
            f"with its middle at ({at.real:.6g}, {at.imag:.6g}) it cuts {cutter - nearest[worst]:.3g} into the profile"
        )
        raise InvalidInput(Problem("cutter", what, "take a smaller one"))


# --- curves as chords ----------------------------------------------------------------------------------------

# The steps of a curve are halved so often at most: what turns back in one has no error by chords.
HALVINGS = 12
# A chord is taken as short enough where its middle is off by this part of what is allowed: bends are not even.
MIDDLE = 0.5


def short_chords(s: Number, places: Callable[[Number], Number], tolerance: float) -> tuple[Number, Number, float]:
    """Return parameters, the places of curves there, and the error of chords.

    Parameters given are among them. The error is the tolerance, or more where curves bend so sharply that halving steps
    came to its end. `places` are those of all curves at parameters (n,), complex (curves, n); not a number where there
    is none.

    >>> s, found, error = short_chords(np.linspace(0, 1, 3), lambda s: np.exp(1j * s)[None], 1e-3)
    >>> len(s), error
    (17, 0.001)
    """
    rows = places(s)
    fresh = np.ones(len(s) - 1, dtype=bool)
    for _ in range(HALVINGS):
        steps = np.flatnonzero(fresh)
        middle = 0.5 * (s[steps] + s[steps + 1])
        found = places(middle)
        height = beside_chords(rows[:, steps], rows[:, steps + 1], found).max(axis=0)
        off = height > MIDDLE * tolerance
        if not off.any():
            return s, rows, tolerance
        split = steps[off] + 1
        s, rows = np.insert(s, split, middle[off]), np.insert(rows, split, found[:, off], axis=1)
        after = split + np.arange(len(split))
        fresh = np.zeros(len(s) - 1, dtype=bool)
        fresh[np.concatenate((after - 1, after))] = True
    return s, rows, max(tolerance, float(height.max()))


def beside_chords(a: Number, b: Number, middle: Number) -> Number:
    """Return how far middles are from the chords beside which they lie. It is nothing where one is not known.

    >>> beside_chords(np.array([0j]), np.array([2 + 0j]), np.array([1 + 1j])).tolist()
    [1.0]
    """
    chord = b - a
    length = np.abs(chord)
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.clip(((middle - a) * np.conjugate(chord)).real / length**2, 0.0, 1.0)
    return np.nan_to_num(np.abs(middle - a - np.where(length > 0, share, 0.0) * chord))
