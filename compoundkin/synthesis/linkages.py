"""Linkages from their lengths: each an ordinary mechanism, in a pose that is drawn.

Lengths and angles are as books give them; what cannot be assembled is refused with the lengths that would do.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches
from typing import Any, TypeAlias

import numpy as np

from compoundkin.base.arrays import TURN
from compoundkin.base.errors import OTHER_WORDS, Problem, UnknownName, plain_word, suggestion
from compoundkin.model.attributes import POSITION
from compoundkin.model.cam_mechanism import cam_mechanism
from compoundkin.model.elements import Drive, Item, drawn, drive, link
from compoundkin.model.geometry import deg
from compoundkin.model.laws import dwell, fall, program
from compoundkin.model.laws import rise as rise_by
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import belt, gear, slide, slot
from compoundkin.model.profiles.synthesised import synthesise
from compoundkin.synthesis.linkage_words import (
    LINKAGES,
    Angle,
    ArmOrSun,
    Closure,
    Count,
    Follower,
    Length,
    LinkageKind,
    Place,
    QuickReturn,
    Real,
    RiseLaw,
    SixBar,
    linkage,
    place,
    polar_place,
    wrong,
)

# Cranks are drawn at this angle where they can be.
DRAWN = np.pi / 3.0
# A pose is looked for at so many angles of a crank; a driver that does not turn fully has so many poses.
TRIED, POSES = 720, 73
# Links in one line, or lengths whose sums are equal, but for rounding: parts of a length, or of its square.
FOLDED = 1e-12
# A scissor lift of more stages takes minutes to solve.
MOST_STAGES = 100

# --- geometry ---------------------------------------------------------------------------------------------------


def _pin(first: complex, one: float, second: complex, two: float, closure: Closure) -> complex | None:
    """Return where circles about two places meet, to the left of the way from the first to the second where open."""
    way = second - first
    distance = abs(way)
    if distance == 0.0:  # one pin: any place of two equal circles, none that is chosen
        return None
    along = (distance**2 + one**2 - two**2) / (2.0 * distance)
    square = one**2 - along**2
    if square < -FOLDED * max(one, distance) ** 2:
        return None
    across = np.sqrt(max(square, 0.0))
    return complex(first + way / distance * (along + (1j if closure == "open" else -1j) * across))


Pose: TypeAlias = "dict[str, complex]"


def _driven(name: str, pose: Callable[[float], Pose | None], crank: str = "crank") -> tuple[Drive, Item]:
    """Return the driver of a crank over all angles at which there is a pose, and one of these poses as drawn.

    It is the longest stretch of angles where there are several. Raises InvalidInput where there is no pose at all.
    """
    angles = np.linspace(0.0, TURN, TRIED, endpoint=False)
    closed = np.array([pose(float(angle)) is not None for angle in angles])
    if closed.all():
        shown = pose(DRAWN)
        assert shown is not None
        return _turning(crank), drawn(**shown)
    if not closed.any():
        what = "it cannot be assembled at any angle of its crank"
        raise wrong(name, what, "lengthen what does not reach")
    first, count = _longest_run(closed)
    low, high = angles[first], angles[first] + TURN / TRIED * (count - 1)
    low, high = (low - TURN, high - TURN) if low + high > TURN + 1e-9 else (low, high)
    near = DRAWN if low < DRAWN < high else low + 0.5 * (high - low)
    shown = pose(near)
    assert shown is not None
    return drive(crank, values=np.linspace(low, high, POSES) if count > 1 else low), drawn(**shown)


def _longest_run(closed: np.ndarray) -> tuple[int, int]:
    """Return where the longest run of true values on a circle begins, and how long it is."""
    begins = np.flatnonzero(closed & ~np.roll(closed, 1))
    ends = np.flatnonzero(closed & ~np.roll(closed, -1))
    lengths = [int((ends[np.searchsorted(ends, k) % len(ends)] - k) % len(closed)) + 1 for k in begins]
    longest = int(np.argmax(lengths))
    return int(begins[longest]), lengths[longest]


def _check_closes(name: str, lengths: Mapping[str, float]) -> None:
    """Raise InvalidInput where the longest link is as long as all others together."""
    longest = max(lengths, key=lambda one: lengths[one])
    rest = sum(lengths.values()) - lengths[longest]
    if lengths[longest] >= rest:
        what = (
            f"it cannot be closed: {longest}, {lengths[longest]:g}, is not shorter than the others together, {rest:g}"
        )
        raise wrong(name, what, f"a {longest} below {rest:g}")


def _grashof(ground: float, crank: float, coupler: float, rocker: float) -> str:
    """Return what moves how, by Grashof's condition (F. Grashof, Theoretische Maschinenlehre, 1883)."""
    lengths = {"ground": ground, "crank": crank, "coupler": coupler, "rocker": rocker}
    shortest, longest = min(lengths, key=lambda k: lengths[k]), max(lengths.values())
    surplus = sum(lengths.values()) - 2.0 * (lengths[shortest] + longest)
    if abs(surplus) <= FOLDED * longest:
        return "A change-point linkage: shortest and longest together are as long as the others (Grashof)."
    if surplus < 0.0:
        return "No link turns fully: shortest and longest together are longer than the others (Grashof)."
    said = {
        "crank": "The crank turns fully, the rocker swings (Grashof).",
        "ground": "Crank and rocker both turn fully: a double crank (Grashof).",
        "coupler": "Crank and rocker both swing, the coupler turns fully: a double rocker (Grashof).",
        "rocker": "The rocker turns fully, the crank swings (Grashof).",
    }
    return said[shortest]


def _four_bar_pose(
    ground: float, crank: float, coupler: float, rocker: float, closure: Closure
) -> Callable[[float], Pose | None]:
    """Return a function of the crank's angle with the pins B and C."""

    def pose(angle: float) -> Pose | None:
        b = complex(crank * np.exp(1j * angle))
        c = _pin(b, coupler, complex(ground), rocker, closure)
        return None if c is None else {"B": b, "C": c}

    return pose


def _beside(first: complex, second: complex, place: complex) -> complex:
    """Return where a place of a link is, seen from its first point with the x axis toward the second."""
    return first + place * (second - first) / abs(second - first)


def _turning(crank: str) -> Drive:
    return drive(crank, values=deg(np.arange(0, 361, 5)))


def _made(title: str, unit: str, outputs: Sequence[str], description: str, *items: Item) -> Mechanism:
    return Mechanism(title, *items, unit=unit, outputs=tuple(outputs), description=description)


# --- four-bars and slider-cranks --------------------------------------------------------------------------------

_UNIT = "The unit of lengths, any word."
_CLOSURE = "Which of two ways to assemble it."


@linkage(
    "ground=60 crank=20 coupler=50 rocker=40",
    ground="Distance of the fixed pivots A and D.",
    crank="Length of the crank, A to B.",
    coupler="Length of the coupler, B to C.",
    rocker="Length of the rocker, D to C.",
    point="A point P of the coupler: its distance from B, and its angle from BC.",
    closure=_CLOSURE,
    unit=_UNIT,
)
def four_bar(
    ground: Length, crank: Length, coupler: Length, rocker: Length, *,
    point: Place | None = None, closure: Closure = "open", unit: str = "",
) -> Mechanism:  # fmt: skip
    """Return a four-bar linkage: crank AB, coupler BC, rocker DC, fixed pivots A and D.

    Open, C is to the left of the way from B to D; crossed, to the right. `point` is the distance of P from B and its
    angle from BC (radians). Raises InvalidInput for lengths that cannot be closed.

    >>> linkage = four_bar(60, 20, 50, 40, point=(30, np.pi / 9))
    >>> list(linkage.links), linkage.description
    (['frame', 'crank', 'coupler', 'rocker'], 'The crank turns fully, the rocker swings (Grashof).')
    """
    _check_closes("four-bar", {"ground": ground, "crank": crank, "coupler": coupler, "rocker": rocker})
    traced = {} if point is None else {"P": polar_place("point", point)}
    return _made(
        "Four-bar linkage", unit, ["rocker.angle", "coupler.angle", *(["P.position"] if traced else [])],
        _grashof(ground, crank, coupler, rocker),
        link("frame", A=0, D=ground), link("crank", A=0, B=crank), link("coupler", B=0, C=coupler, **traced),
        link("rocker", D=0, C=rocker), *_driven("four-bar", _four_bar_pose(ground, crank, coupler, rocker, closure)),
    )  # fmt: skip


@linkage(
    "crank=20 rod=60 offset=5",
    crank="Length of the crank, O to A.",
    rod="Length of the connecting rod, A to B.",
    offset="Distance of the guide above the crank's pivot.",
    closure="Open, the slide is ahead of the crank; crossed, behind it.",
    unit=_UNIT,
)
def slider_crank(
    crank: Length, rod: Length, *, offset: Real = 0.0, closure: Closure = "open", unit: str = ""
) -> Mechanism:
    """Return a slider-crank: crank OA, rod AB, a slide at B on a level guide.

    Raises InvalidInput for a rod that does not reach the guide.

    >>> slider_crank(20, 60).outputs
    ('stroke.value', 'rod.angle')
    """
    if abs(offset) >= crank + rod:
        what = f"crank and rod together, {crank + rod:g}, do not reach the guide"
        raise wrong("offset", what, f"an offset below {crank + rod:g}")

    def pose(angle: float) -> Pose | None:
        a = complex(crank * np.exp(1j * angle))
        square = rod**2 - (a.imag - offset) ** 2
        ahead = np.sqrt(max(square, 0.0)) * (1.0 if closure == "open" else -1.0)
        return None if square < 0.0 else {"A": a, "B": complex(a.real + ahead, offset)}

    turns = crank + abs(offset) < rod
    return _made(
        "Slider-crank", unit, ["stroke.value", "rod.angle"],
        "The crank turns fully." if turns else "The crank swings: the rod is not longer than crank and offset.",
        link("frame", O=0), link("crank", O=0, A=crank), link("rod", A=0, B=rod), link("slider", B=0),
        slide("slider", on="frame", at="B", through="O", angle=0, offset=offset, name="stroke"),
        *_driven("slider-crank", pose),
    )  # fmt: skip


@linkage(
    "ground=50 crank=20",
    ground="Distance of the pivots O of the crank and C of the guide.",
    crank="Length of the crank, O to A.",
    unit=_UNIT,
)
def inverted_slider_crank(ground: Length, crank: Length, *, unit: str = "") -> Mechanism:
    """Return an inverted slider-crank: the block on the crank's pin A slides along a guide that turns about C.

    A crank shorter than the ground makes the guide swing, a longer one makes it turn. Raises InvalidInput where they
    are equal, for then block and pivot meet.

    >>> inverted_slider_crank(50, 20).description
    'The guide swings: the crank is shorter than the ground.'
    """
    if crank == ground:
        raise wrong("crank", "it is as long as the ground: its pin meets the pivot of the guide", "another length")
    a = complex(crank * np.exp(1j * DRAWN))
    swings = "swings: the crank is shorter" if crank < ground else "turns: the crank is longer"
    return _made(
        "Inverted slider-crank", unit, ["guide.angle", "slot.value"], f"The guide {swings} than the ground.",
        link("frame", O=0, C=-ground), link("crank", O=0, A=crank), link("block", A=0), link("guide", C=0),
        slide("block", on="guide", at="A", through="C", angle=0, name="slot"), _turning("crank"), drawn(A=a),
    )  # fmt: skip


@linkage(
    "kind=crank-shaper ground=25 crank=10 lever=65 rod=30 height=50",
    kind="crank-shaper: the slotted lever swings; Whitworth: it turns.",
    ground="Distance of the pivots of crank and lever.",
    crank="Length of the crank.",
    lever="Length of the lever from its pivot to the rod.",
    rod="Length of the rod to the ram.",
    height="Height of the ram above the lever's pivot.",
    unit=_UNIT,
)
def quick_return(
    kind: QuickReturn, ground: Length, crank: Length, lever: Length, rod: Length, *,
    height: Real = 0.0, unit: str = "",
) -> Mechanism:  # fmt: skip
    """Return a quick return: a crank turns a slotted lever, which moves a ram by a rod, slowly there and quickly back.

    The crank's pivot is above the lever's. Of a crank-shaper the crank is shorter than the ground, of a Whitworth
    mechanism longer. Raises InvalidInput where it is not, or where the rod does not reach the ram.

    >>> quick_return("Whitworth", 20, 40, 75, 200).outputs
    ('stroke.value', 'lever.angle')
    """
    turns = kind == "Whitworth"
    if turns != (crank > ground):
        shape, sense = ("turns", "longer") if turns else ("swings", "shorter")
        what = f"the lever of a {kind} {shape}: its crank is {sense} than the ground, {ground:g}"
        raise wrong("crank", what, f"a crank {'above' if turns else 'below'} {ground:g}, or the other kind")
    highest, lowest = lever, -lever if turns else lever * float(np.sqrt(1.0 - (crank / ground) ** 2))
    far = max(abs(highest - height), abs(lowest - height))
    if far >= rod:
        raise wrong("rod", f"{rod:g} does not reach the ram at all poses", f"a rod above {far:g}, or another height")
    a = 1j * ground + crank * np.exp(1j * np.pi / 6.0)
    b = lever * a / abs(a)
    e = complex(b.real + np.sqrt(rod**2 - (b.imag - height) ** 2), height)
    title = "Whitworth quick return" if turns else "Crank-shaper quick return"
    return _made(
        title, unit, ["stroke.value", "lever.angle"], f"The lever {'turns' if turns else 'swings'}.",
        link("frame", O=1j * ground, C=0), link("crank", O=0, A=crank), link("block", A=0), link("lever", C=0, B=lever),
        link("rod", B=0, E=rod), link("ram", E=0),
        slide("block", on="lever", at="A", through="C", angle=0, name="slot"),
        slide("ram", on="frame", at="E", through="C", angle=0, offset=height, name="stroke"),
        _turning("crank"), drawn(A=complex(a), B=complex(b), E=e),
    )  # fmt: skip


# --- six-bars ---------------------------------------------------------------------------------------------------

# The places that each kind of six-bar needs beside its lengths.
_SIX_BARS: Mapping[str, tuple[str, ...]] = {
    "Watt I": ("coupler_point", "rocker_point"),
    "Watt II": ("rocker_point", "pivot"),
    "Stephenson I": ("crank_point", "rocker_point"),
    "Stephenson II": ("crank_point", "plate_point"),
    "Stephenson III": ("coupler_point", "pivot"),
}


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
    unit=_UNIT,
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
    given = {"coupler_point": coupler_point, "rocker_point": rocker_point, "crank_point": crank_point,
             "plate_point": plate_point, "pivot": pivot}  # fmt: skip
    needed = _SIX_BARS[kind]
    for name, one in given.items():
        if (one is None) == (name in needed):
            what = f"a {kind} needs it" if one is None else f"a {kind} has none"
            raise wrong(name, what, f"it needs {' and '.join(needed)}")
    if kind == "Stephenson II":
        return _stephenson_ii((ground, crank, coupler, rocker, fifth, sixth), given, closure, unit)
    _check_closes("six-bar", {"ground": ground, "crank": crank, "coupler": coupler, "rocker": rocker})
    p, q, s = (None if given[name] is None else polar_place(name, given[name])
               for name in ("coupler_point", "rocker_point", "crank_point"))  # fmt: skip
    e = None if pivot is None else place("pivot", pivot)
    base = _four_bar_pose(ground, crank, coupler, rocker, closure)

    def pose(angle: float) -> Pose | None:
        found = base(angle)
        if found is None:
            return None
        b, c = found["B"], found["C"]
        found |= {"P": _beside(b, c, p)} if p is not None else {}
        found |= {"Q": _beside(complex(ground), c, q)} if q is not None else {}
        found |= {"S": _beside(0j, b, s)} if s is not None else {}
        ends = [found[letter] for letter in "SPQ" if letter in found] + ([e] if e is not None else [])
        r = _pin(ends[0], fifth, ends[1], sixth, second)
        return None if r is None else {**found, "R": r}

    more = {letter: place for letter, place in (("P", p), ("Q", q), ("S", s)) if place is not None}
    ends = [letter for letter in "SPQ" if letter in more] + (["E"] if e is not None else [])
    return _made(
        f"{kind} six-bar", unit, ["rocker.angle", "sixth.angle", "R.position"],
        _grashof(ground, crank, coupler, rocker),
        link("frame", A=0, D=ground, **({"E": e} if e is not None else {})),
        link("crank", A=0, B=crank, **({"S": s} if s is not None else {})),
        link("coupler", B=0, C=coupler, **({"P": p} if p is not None else {})),
        link("rocker", D=0, C=rocker, **({"Q": q} if q is not None else {})),
        link("fifth", **{ends[0]: 0, "R": fifth}), link("sixth", **{ends[1]: 0, "R": sixth}),
        *_driven("six-bar", pose),
    )  # fmt: skip


def _stephenson_ii(lengths: Sequence[float], given: Mapping[str, Any], closure: Closure, unit: str) -> Mechanism:
    """Return a Stephenson II, driven at its crank: a group of four links, whose poses are found along the rocker."""
    ground, crank, coupler, rocker, fifth, plate = lengths
    s, f = polar_place("crank_point", given["crank_point"]), polar_place("plate_point", given["plate_point"])

    def with_rocker(angle: float, swung: float) -> tuple[Pose | None, float]:
        """Return the pose with the rocker at an angle, but for the fifth link, and by how much that does not fit."""
        b = complex(crank * np.exp(1j * angle))
        g = complex(ground + rocker * np.exp(1j * swung))
        c = _pin(b, coupler, g, plate, closure)
        if c is None:
            return None, np.nan
        found = {"B": b, "S": _beside(0j, b, s), "G": g, "C": c, "F": _beside(g, c, f)}
        return found, abs(found["F"] - found["S"]) - fifth

    def pose(angle: float) -> Pose | None:
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
    return _made(
        "Stephenson II six-bar", unit, ["rocker.angle", "plate.angle"],
        "Driven at the crank, its other links are one Assur group of four.",
        link("frame", A=0, D=ground), link("crank", A=0, B=crank, S=s), link("coupler", B=0, C=coupler),
        link("rocker", D=0, G=rocker), link("fifth", S=0, F=fifth), link("plate", G=0, C=plate, F=f),
        drive("crank", values=angle + deg(np.arange(-20, 21, 1))), drawn(**shown),
    )  # fmt: skip


# --- others -----------------------------------------------------------------------------------------------------


def _five_bar_pins(
    ground: float, left: float, left_coupler: float, right_coupler: float, right: float, closure: Closure
) -> Callable[[float, float], Pose | None]:
    def pose(one: float, two: float) -> Pose | None:
        b, d = complex(left * np.exp(1j * one)), complex(ground + right * np.exp(1j * two))
        c = _pin(b, left_coupler, d, right_coupler, closure)
        return None if c is None else {"B": b, "C": c, "D": d}

    return pose


_FIVE = {
    "ground": "Distance of the fixed pivots A and E.",
    "left": "Length of the left crank, A to B.",
    "left_coupler": "Length from B to C.",
    "right_coupler": "Length from D to C.",
    "right": "Length of the right crank, E to D.",
}


@linkage("ground=50 left=20 left_coupler=50 right_coupler=50 right=20", **_FIVE, closure=_CLOSURE, unit=_UNIT)
def five_bar(
    ground: Length, left: Length, left_coupler: Length, right_coupler: Length, right: Length, *,
    closure: Closure = "open", unit: str = "",
) -> Mechanism:  # fmt: skip
    """Return a five-bar linkage: two cranks AB and ED, each driven, and two links that meet at C.

    Both cranks turn together, at the same angle. Raises InvalidInput for lengths that cannot be assembled so.

    >>> [drive.name for drive in five_bar(50, 20, 50, 50, 20).drives]
    ['left', 'right']
    """
    pins = _five_bar_pins(ground, left, left_coupler, right_coupler, right, closure)
    own, shown = _driven("five-bar", lambda angle: pins(angle, angle), "left")
    return _made(
        "Five-bar linkage", unit, ["C.position"], "Two drivers: mobility 2.",
        *_five_bar_links(ground, left, left_coupler, right_coupler, right),
        own, drive("right", values=own.values), shown,
    )  # fmt: skip


def _five_bar_links(
    ground: float, left: float, left_coupler: float, right_coupler: float, right: float
) -> tuple[Item, ...]:
    return (
        link("frame", A=0, E=ground), link("left", A=0, B=left), link("left-coupler", B=0, C=left_coupler),
        link("right-coupler", D=0, C=right_coupler), link("right", E=0, D=right),
    )  # fmt: skip


@linkage(
    "ground=50 left=20 left_coupler=50 right_coupler=50 right=20 ratio=-1 phase=90",
    **_FIVE,
    ratio="Turns of the right crank for one of the left; negative where gears turn it the other way round.",
    phase="Angle of the right crank where that of the left is zero.",
    closure=_CLOSURE,
    unit=_UNIT,
)
def geared_five_bar(
    ground: Length, left: Length, left_coupler: Length, right_coupler: Length, right: Length, *,
    ratio: Real = -1.0, phase: Angle = 0.0, closure: Closure = "open", unit: str = "",
) -> Mechanism:  # fmt: skip
    """Return a geared five-bar: a five-bar whose cranks are geared to each other, so that one drives both.

    A negative ratio is that of two gears, a positive one that of a belt or of gears with an idler. Raises InvalidInput
    for a ratio of zero, and for lengths that cannot be assembled.

    >>> geared_five_bar(50, 20, 50, 50, 20, phase=np.pi / 2).outputs
    ('C.position',)
    """
    if ratio == 0.0:
        raise wrong("ratio", "zero is no ratio of gears", "turns of the right crank for one of the left")
    pins = _five_bar_pins(ground, left, left_coupler, right_coupler, right, closure)
    own, shown = _driven("geared-five-bar", lambda angle: pins(angle, phase + ratio * angle), "left")
    sizes = (abs(ratio), 1.0)
    radii = tuple(size * ground / sum(sizes) for size in sizes)
    joined = (gear if ratio < 0.0 else belt)("left", "right", radii=radii, phase=phase)
    return _made(
        "Geared five-bar", unit, ["C.position"], "",
        *_five_bar_links(ground, left, left_coupler, right_coupler, right), joined, own, shown,
    )  # fmt: skip


@linkage("crank=20", crank="Length of the crank; the stroke is twice as long.", unit=_UNIT)
def scotch_yoke(crank: Length, *, unit: str = "") -> Mechanism:
    """Return a Scotch yoke: the pin of a crank in the straight slot of a yoke, which moves by a cosine.

    >>> scotch_yoke(20).outputs
    ('stroke.value',)
    """
    a = complex(crank * np.exp(1j * DRAWN))
    return _made(
        "Scotch yoke", unit, ["stroke.value"], "The yoke moves by the cosine of the crank's angle.",
        link("frame", O=0), link("crank", O=0, A=crank), link("block", A=0), link("yoke", Y=0, Z=2.0 * crank),
        slide("block", on="yoke", at="A", through="Y", angle=np.pi / 2.0, name="slot"),
        slide("yoke", on="frame", at="Y", through="O", angle=0, name="stroke"),
        _turning("crank"), drawn(A=a, Y=complex(a.real)),
    )  # fmt: skip


@linkage(
    "crank=20 rod=100 upper=60 lower=60 pivot=110,55",
    crank="Length of the crank, O to A.",
    rod="Length of the rod, A to the knee B.",
    upper="Length of the upper link, from its pivot C to the knee B.",
    lower="Length of the lower link, from the knee B to the ram D.",
    pivot="The pivot C, x and y from the crank's pivot O; the ram is on a level line below it.",
    unit=_UNIT,
)
def toggle(crank: Length, rod: Length, upper: Length, lower: Length, pivot: Place, *, unit: str = "") -> Mechanism:
    """Return a toggle: a crank and its rod straighten a knee of two links, which presses a ram down.

    The knee is at the side of the crank. Raises InvalidInput for lengths that cannot be assembled.

    >>> toggle(20, 100, 60, 60, (110, 55)).outputs
    ('ram.value',)
    """
    c = place("pivot", pivot)

    def pose(angle: float) -> Pose | None:
        a = complex(crank * np.exp(1j * angle))
        b = _pin(a, rod, c, upper, "crossed" if c.real >= 0.0 else "open")
        if b is None or abs(b.real - c.real) > lower:
            return None
        return {"A": a, "B": b, "D": complex(c.real, b.imag - np.sqrt(lower**2 - (b.real - c.real) ** 2))}

    return _made(
        "Toggle", unit, ["ram.value"], "Where the knee is straight the ram stands still, and its force is greatest.",
        link("frame", O=0, C=c), link("crank", O=0, A=crank), link("rod", A=0, B=rod), link("upper", C=0, B=upper),
        link("lower", B=0, D=lower), link("slider", D=0),
        slide("slider", on="frame", at="D", through="C", angle=-np.pi / 2.0, name="ram"), *_driven("toggle", pose),
    )  # fmt: skip


@linkage(
    "stages=2 arm=2 low=0.7 high=1.9",
    stages="How many crosses of arms stand on each other.",
    arm="Length of the arms.",
    low="Least distance of the feet, with the platform at its highest.",
    high="Greatest distance of the feet, below the length of an arm.",
    unit=_UNIT,
)
def scissor(stages: Count, arm: Length, low: Length, high: Length, *, unit: str = "") -> Mechanism:
    """Return a scissor lift: crosses of arms on each other, raised by drawing the feet together.

    The platform is at stages x sqrt(arm^2 - x^2) above the ground, x the distance of the feet. Raises InvalidInput
    where this is not between zero and an arm.

    >>> len(scissor(2, 2.0, 0.7, 1.9).links)
    8
    """
    if stages > MOST_STAGES:
        raise wrong("stages", f"{stages} stages are more than anybody builds", f"{MOST_STAGES} at most")
    if not low < high < arm:
        raise wrong("high", f"feet from {low:g} to {high:g} apart do not fit arms of {arm:g}", "low < high < arm")
    x = 0.5 * (low + high)
    rise = float(np.sqrt(arm**2 - x**2))
    shown: Pose = {"A": 0j, "B": complex(x)}
    links: list[Item] = []
    feet = ("A", "B")
    for k in range(1, stages + 1):
        tops = (f"L{k}", f"R{k}")
        shown |= {f"M{k}": complex(x / 2.0, (k - 0.5) * rise), tops[0]: 1j * k * rise, tops[1]: complex(x, k * rise)}
        for n, (foot, top) in enumerate(zip(feet, reversed(tops), strict=True)):
            links.append(link(f"arm-{2 * k - 1 + n}", **{foot: 0, f"M{k}": arm / 2.0, top: arm}))
        feet = tops
    left, right = feet
    return _made(
        f"Scissor lift, {stages} stage{'s' if stages > 1 else ''}", unit, [f"{left}.{POSITION}", "feet.value"],
        "The platform stays level.",
        link("frame", A=0), link("foot", B=0), *links, link("block", **{right: 0}),
        link("platform", **{left: 0, "T": 1.2 * high}),
        slide("foot", on="frame", at="B", through="A", angle=0, name="feet"),
        slide("block", on="platform", at=right, through=left, angle=0, name="top"),
        drive("foot", values=np.linspace(high, low, POSES), speed=-1.0),
        drawn(**{letter: place for letter, place in shown.items() if letter != "A"}),
    )  # fmt: skip


@linkage(
    "slots=4 distance=100",
    slots="How many slots the wheel has, at least 3.",
    distance="Distance of the pivots of crank and wheel.",
    unit=_UNIT,
)
def geneva(slots: Count, distance: Length, *, unit: str = "") -> Mechanism:
    """Return a Geneva wheel while it moves: the pin of a crank in one slot, which it enters and leaves along it.

    The crank is distance x sin(pi / slots) long, so that the wheel begins and ends at rest. Dwells between engagements
    are those of `ck.figures.intermittent_motion`. Raises InvalidInput for fewer than three slots.

    Source: J. H. Bickford, Mechanisms for Intermittent Motion, Industrial Press 1972, chapter 9.

    >>> round(float(geneva(4, 100.0).links["crank"].points["A"].real), 6)
    70.710678
    """
    if slots < 3:
        raise wrong("slots", f"{slots} slots are too few", "3 or more")
    crank = distance * float(np.sin(np.pi / slots))
    half = np.pi / 2.0 - np.pi / slots
    end = -distance * float(np.cos(np.pi / slots))
    return _made(
        f"Geneva wheel with {slots} slots", unit, ["wheel.angle", "wheel.angular_velocity"],
        "One engagement: the wheel turns by one slot, and is at rest where the pin enters and leaves.",
        link("frame", O=0, C=distance), link("crank", O=0, A=crank), link("wheel", C=0, E=end),
        slot("crank", on="wheel", at="A", through="C", angle=np.pi, name="slot"),
        drive("crank", values=np.linspace(-half, half, 37)), drawn(A=complex(crank), E=complex(distance + end)),
    )  # fmt: skip


@linkage(
    "base=40 rise=30 rise_over=120 dwell_over=60 fall_over=120 follower=roller roller=10",
    base="Radius of the base circle.",
    rise="How far the follower rises.",
    rise_over="Angle of the cam over which it rises.",
    dwell_over="Angle over which it stays up.",
    fall_over="Angle over which it falls; the rest of the turn it stays down.",
    follower="What touches the cam.",
    roller="Radius of the roller.",
    offset="Distance of the follower's guide to the left of the cam's axis.",
    law="The law of rise and fall: 3-4-5, cycloidal, harmonic, ...",
    unit=_UNIT,
)
def cam_follower(
    base: Length, rise: Length, rise_over: Angle, dwell_over: Angle, fall_over: Angle, *, follower: Follower = "knife",
    roller: Real = 0.0, offset: Real = 0.0, law: RiseLaw = "3-4-5", unit: str = "",
) -> Mechanism:  # fmt: skip
    """Return a disc cam with a follower that rises, dwells, falls and rests, straight up.

    The profile is made for this motion (`ck.profiles.synthesise`). Angles in radians. Raises InvalidMechanism for a cam
    that cannot be, with the least base circle that would do.

    >>> cam_follower(40, 30, 2.0, 1.0, 2.0, follower="roller", roller=10).outputs
    ('P.position', 'P.velocity')
    """
    rest = TURN - rise_over - dwell_over - fall_over
    if rest < -1e-9 or min(rise_over, fall_over) <= 0.0 or dwell_over < 0.0:
        what = "rise, dwell and fall do not fit into one turn"
        raise wrong("fall_over", what, "angles above zero that are a turn at most together")
    stages = [rise_by(rise, over=rise_over, law=law), *([dwell(dwell_over)] if dwell_over > 0.0 else []),
              fall(rise, over=fall_over, law=law), *([dwell(rest)] if rest > 1e-9 else [])]  # fmt: skip
    made = synthesise(program(*stages), base=base, follower=follower, roller=roller, offset=offset)
    return cam_mechanism(made, title="Disc cam with its follower", unit=unit).replace(
        outputs=("P.position", "P.velocity")
    )


@linkage(
    "sun=32 planet=20 module=2 driver=arm",
    sun="Teeth of the sun.",
    planet="Teeth of a planet; the ring has those of the sun and twice those of a planet.",
    module="Pitch diameter by number of teeth.",
    driver="The link that is driven: arm or sun.",
    unit=_UNIT,
)
def planetary(
    sun: Count, planet: Count, module: Length = 1.0, *, driver: ArmOrSun = "arm", unit: str = ""
) -> Mechanism:
    """Return a planetary train: sun, planet and arm within a ring that is the frame.

    The sun turns 1 + ring / sun times as fast as the arm (R. Willis, Principles of Mechanism, 1841).

    >>> planetary(32, 20, 2.0).outputs
    ('sun.angle', 'planet.angle', 'arm.angle')
    """
    ring = sun + 2 * planet
    arm = module * (sun + planet) / 2.0
    return _made(
        "Planetary train", unit, ["sun.angle", "planet.angle", "arm.angle"],
        f"Ring {ring}, sun {sun}, planet {planet} teeth: the sun turns {1.0 + ring / sun:g} times as fast as the arm.",
        link("frame", O=0), link("arm", O=0, P=arm), link("planet", P=0, Q=module * planet / 2.0),
        link("sun", O=0, S=module * sun / 2.0),
        gear("planet", "frame", carrier="arm", teeth=(planet, ring), module=module, internal=True, name="in ring"),
        gear("planet", "sun", carrier="arm", teeth=(planet, sun), module=module, name="on sun"),
        _turning(driver),
    )  # fmt: skip


# --- by name ----------------------------------------------------------------------------------------------------


def linkage_of(specification: str) -> Mechanism | None:
    """Return the linkage of a specification such as "four-bar:60,20,50,40", or None for a text that is none.

    Parts are separated by commas, blanks or semicolons. Raises InvalidInput, and UnknownName for the name of a linkage
    with a slip in it.

    >>> list(linkage_of("four-bar:60,20,50,40,point=30,20").links["coupler"].points)
    ['B', 'C', 'P']
    >>> linkage_of("six-bar.toml") is None
    True
    """
    name, _, rest = specification.partition(":")
    if not is_linkage(specification):
        if rest and get_close_matches(_spelled(name), list(LINKAGES), n=1):
            kind_named(name)
        return None
    kind = kind_named(name)
    places = {one.name for one in kind.parameters if one.kind == "Place"}
    parts: list[str] = []
    for part in rest.replace(";", ",").replace(" ", ",").split(","):
        if parts and parts[-1].partition("=")[0] in places and "," not in parts[-1]:
            parts[-1] += f",{part}"  # the second number of a place
        elif part:
            parts.append(part)
    return kind.written(parts)


def kinds() -> tuple[LinkageKind, ...]:
    """Return all kinds of linkages, in the order in which they are listed."""
    return tuple(LINKAGES.values())


def is_linkage(specification: str) -> bool:
    """Return whether a text names a linkage with its lengths, possible or not."""
    name, colon, _ = specification.partition(":")
    return bool(colon) and _spelled(name) in LINKAGES


def kind_named(name: str) -> LinkageKind:
    """Return the kind of a name, "four-bar" as well as Python's "four_bar". Raises UnknownName with the nearest."""
    if _spelled(name) not in LINKAGES:
        raise UnknownName(Problem(name, "there is no such linkage", suggestion(_spelled(name), list(LINKAGES))))
    return LINKAGES[_spelled(name)]


def _spelled(name: str) -> str:
    """Return the name of the linkage that a name means, spelled otherwise or by others: "fourbar", "crank-slider"."""
    plain = plain_word(name)
    meant = [one for one in LINKAGES if plain_word(one) == plain or one in OTHER_WORDS.get(plain, ())]
    return meant[0] if meant else name.strip().lower().replace("_", "-")
