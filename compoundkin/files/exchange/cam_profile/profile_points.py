"""Points of a profile, of its pitch curve and of the path of a cutter, in the frame of the cam."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.short_chords import beside_chords, short_chords
from compoundkin.model.pairs.profile_contact import ProfileContact

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
