"""Six-bars of Watt's and Stephenson's chains."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from compoundkin.base.arrays import TURN
from compoundkin.model.elements import drawn, drive, link
from compoundkin.model.geometry import deg
from compoundkin.model.mechanism import Mechanism
from compoundkin.synthesis.four_bars import check_closes, four_bar_pose, grashof
from compoundkin.synthesis.linkage_words import (
    DRAWN,
    UNIT,
    Closure,
    Length,
    PinPlaces,
    Place,
    SixBar,
    drawn_linkage,
    driven_crank,
    linkage,
    place,
    place_on,
    polar_place,
    third_pin,
    wrong,
)

# The places that each kind of six-bar needs beside its lengths.
_SIX_BARS: Mapping[str, tuple[str, ...]] = {
    "Watt I": ("coupler_point", "rocker_point"),
    "Watt II": ("rocker_point", "pivot"),
    "Stephenson I": ("crank_point", "rocker_point"),
    "Stephenson II": ("crank_point", "plate_point"),
    "Stephenson III": ("coupler_point", "pivot"),
}
# The points to which the fifth and the sixth link go, in this order, and the parameters that place them.
_POINTS = {"S": "crank_point", "P": "coupler_point", "Q": "rocker_point"}


@linkage(
    "kind=stephenson-iii ground=60 crank=20 coupler=50 rocker=40 fifth=45 sixth=35 coupler_point=30,40 pivot=90,40",
    kind="Watt I, Watt II, Stephenson I, Stephenson II or Stephenson III.",
    ground="Distance of the fixed pivots A and D.",
    crank="Length of the crank, A to B.",
    coupler="Length of the coupler, B to C.",
    rocker="Length of the rocker, D to C; of a Stephenson II D to G.",
    fifth="Length of the fifth link, to R; of a Stephenson II S to F.",
    sixth="Length of the sixth link, to R; of a Stephenson II the plate, G to C.",
    coupler_point="P on the coupler: its distance from B, and its angle from BC. Watt I, Stephenson III.",
    rocker_point="Q on the rocker: its distance from D, and its angle from DC. Watt I, Watt II, Stephenson I.",
    crank_point="S on the crank: its distance from A, and its angle from AB. Stephenson I, Stephenson II.",
    plate_point="F on the plate: its distance from G, and its angle from GC. Stephenson II.",
    pivot="The third fixed pivot E, x and y from A, the x axis toward D. Watt II, Stephenson III.",
    closure="Which of two ways to assemble coupler and rocker.",
    second="Which of two ways to assemble the fifth and the sixth link.",
    unit=UNIT,
)
def six_bar(
    kind: SixBar, ground: Length, crank: Length, coupler: Length, rocker: Length, fifth: Length, sixth: Length, *,
    coupler_point: Place | None = None, rocker_point: Place | None = None, crank_point: Place | None = None,
    plate_point: Place | None = None, pivot: Place | None = None,
    closure: Closure = "open", second: Closure = "open", unit: str = "",
) -> Mechanism:  # fmt: skip
    """Return a six-bar linkage of Watt's or Stephenson's chain.

    A four-bar ABCD with two more links that meet at R: of a Watt I from P of the coupler and Q of the rocker, of a Watt
    II from Q and the pivot E, of a Stephenson I from S of the crank and Q, of a Stephenson III from P and E. Of a
    Stephenson II crank ABS and plate GCF are joined by the coupler BC and the fifth link SF, and the rocker holds the
    plate at G. Points are a distance and an angle (radians), pivots (x, y). Raises InvalidInput for what is missing or
    too much, and for lengths that cannot be assembled.

    >>> watt = six_bar("Watt II", 60, 20, 50, 40, 45, 35, rocker_point=(25, -0.5), pivot=(100, 10))
    >>> list(watt.links)
    ['frame', 'crank', 'coupler', 'rocker', 'fifth', 'sixth']
    """
    given = {"crank_point": crank_point, "coupler_point": coupler_point, "rocker_point": rocker_point,
             "plate_point": plate_point, "pivot": pivot}  # fmt: skip
    _check_places(kind, given)
    if kind == "Stephenson II":
        return _stephenson_ii((ground, crank, coupler, rocker, fifth, sixth), given, closure, unit)
    check_closes("six-bar", {"ground": ground, "crank": crank, "coupler": coupler, "rocker": rocker})
    points = {letter: polar_place(name, given[name]) for letter, name in _POINTS.items() if given[name] is not None}
    pivots = {} if pivot is None else {"E": place("pivot", pivot)}
    one, other = (*points, *pivots)
    base = four_bar_pose(ground, crank, coupler, rocker, closure)

    def pose(angle: float) -> PinPlaces | None:
        found = base(angle)
        if found is None:
            return None
        sides = {"S": (0j, found["B"]), "P": (found["B"], found["C"]), "Q": (complex(ground), found["C"])}
        found |= {letter: place_on(*sides[letter], point) for letter, point in points.items()}
        ends = found | pivots
        r = third_pin(ends[one], fifth, ends[other], sixth, second)
        return None if r is None else {**found, "R": r}

    own = {letter: {letter: points[letter]} if letter in points else {} for letter in _POINTS}
    return drawn_linkage(
        f"{kind} six-bar", unit, ["rocker.angle", "sixth.angle", "R.position"],
        grashof(ground, crank, coupler, rocker),
        link("frame", A=0, D=ground, **pivots), link("crank", A=0, B=crank, **own["S"]),
        link("coupler", B=0, C=coupler, **own["P"]), link("rocker", D=0, C=rocker, **own["Q"]),
        link("fifth", **{one: 0, "R": fifth}), link("sixth", **{other: 0, "R": sixth}),
        *driven_crank("six-bar", pose),
    )  # fmt: skip


def _check_places(kind: str, given: Mapping[str, Any]) -> None:
    """Raise InvalidInput for a place that a kind of six-bar needs and does not have, or has and does not need."""
    needed = _SIX_BARS[kind]
    for name, one in given.items():
        if (one is None) == (name in needed):
            what = f"a {kind} needs it" if one is None else f"a {kind} has none"
            raise wrong(name, what, f"it needs {' and '.join(needed)}")


def _stephenson_ii(lengths: Sequence[float], given: Mapping[str, Any], closure: Closure, unit: str) -> Mechanism:
    """Return a Stephenson II, driven at its crank: a group of four links, whose poses are found along the rocker."""
    ground, crank, coupler, rocker, fifth, plate = lengths
    s, f = polar_place("crank_point", given["crank_point"]), polar_place("plate_point", given["plate_point"])

    def with_rocker(angle: float, swung: float) -> tuple[PinPlaces | None, float]:
        """Return the pose with the rocker at an angle, but for the fifth link, and by how much that does not fit."""
        b = complex(crank * np.exp(1j * angle))
        g = complex(ground + rocker * np.exp(1j * swung))
        c = third_pin(b, coupler, g, plate, closure)
        if c is None:
            return None, np.nan
        found = {"B": b, "S": place_on(0j, b, s), "G": g, "C": c, "F": place_on(g, c, f)}
        return found, abs(found["F"] - found["S"]) - fifth

    def pose(angle: float) -> PinPlaces | None:
        swings = np.linspace(0.0, TURN, 181)
        off = np.array([with_rocker(angle, float(one))[1] for one in swings])
        changes = np.flatnonzero(off[:-1] * off[1:] <= 0.0)
        if not changes.size:
            return None
        low, high = (float(one) for one in swings[changes[0] : changes[0] + 2])
        for _ in range(60):
            middle = 0.5 * (low + high)
            ends = with_rocker(angle, low)[1] * with_rocker(angle, middle)[1]
            low, high = (low, middle) if ends <= 0.0 else (middle, high)
        return with_rocker(angle, low)[0]

    shown = pose(DRAWN) or next(filter(None, map(pose, np.linspace(0.0, TURN, 24, endpoint=False).tolist())), None)
    if shown is None:
        raise wrong("six-bar", "it cannot be assembled at any angle of its crank", "lengthen what does not reach")
    angle = float(np.angle(shown["B"]))
    return drawn_linkage(
        "Stephenson II six-bar", unit, ["rocker.angle", "plate.angle"],
        "Driven at the crank, its other links are one Assur group of four.",
        link("frame", A=0, D=ground), link("crank", A=0, B=crank, S=s), link("coupler", B=0, C=coupler),
        link("rocker", D=0, G=rocker), link("fifth", S=0, F=fifth), link("plate", G=0, C=plate, F=f),
        drive("crank", values=angle + deg(np.arange(-20, 21, 1))), drawn(**shown),
    )  # fmt: skip
