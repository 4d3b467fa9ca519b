"""Four-bars, and those of which a link slides: slider-cranks, their inversions and quick returns."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from compoundkin.model.elements import drawn, link
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.prismatic import slide
from compoundkin.synthesis.linkage_words import (
    CLOSURE,
    DRAWN,
    FOLDED,
    UNIT,
    Closure,
    Length,
    PinPlaces,
    Place,
    QuickReturn,
    Real,
    drawn_linkage,
    driven_crank,
    full_turn,
    linkage,
    polar_place,
    third_pin,
    wrong,
)


def check_closes(name: str, lengths: Mapping[str, float]) -> None:
    """Raise InvalidInput where the longest link is as long as all others together."""
    longest = max(lengths, key=lambda one: lengths[one])
    rest = sum(length for name, length in lengths.items() if name != longest)
    if lengths[longest] >= rest:
        what = (
            f"it cannot be closed: {longest}, {lengths[longest]:g}, is not shorter than the others together, {rest:g}"
        )
        raise wrong(name, what, f"a {longest} below {rest:g}")


def grashof(ground: float, crank: float, coupler: float, rocker: float) -> str:
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


def four_bar_pose(
    ground: float, crank: float, coupler: float, rocker: float, closure: Closure
) -> Callable[[float], PinPlaces | None]:
    """Return a function of the crank's angle with the pins B and C."""

    def pose(angle: float) -> PinPlaces | None:
        b = complex(crank * np.exp(1j * angle))
        c = third_pin(b, coupler, complex(ground), rocker, closure)
        return None if c is None else {"B": b, "C": c}

    return pose


@linkage(
    "ground=60 crank=20 coupler=50 rocker=40",
    ground="Distance of the fixed pivots A and D.",
    crank="Length of the crank, A to B.",
    coupler="Length of the coupler, B to C.",
    rocker="Length of the rocker, D to C.",
    point="A point P of the coupler: its distance from B, and its angle from BC.",
    closure=CLOSURE,
    unit=UNIT,
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
    check_closes("four-bar", {"ground": ground, "crank": crank, "coupler": coupler, "rocker": rocker})
    traced = {} if point is None else {"P": polar_place("point", point)}
    return drawn_linkage(
        "Four-bar linkage", unit, ["rocker.angle", "coupler.angle", *(["P.position"] if traced else [])],
        grashof(ground, crank, coupler, rocker),
        link("frame", A=0, D=ground), link("crank", A=0, B=crank), link("coupler", B=0, C=coupler, **traced),
        link("rocker", D=0, C=rocker),
        *driven_crank("four-bar", four_bar_pose(ground, crank, coupler, rocker, closure)),
    )  # fmt: skip


@linkage(
    "crank=20 rod=60 offset=5",
    crank="Length of the crank, O to A.",
    rod="Length of the connecting rod, A to B.",
    offset="Distance of the guide above the crank's pivot.",
    closure="Open, the slide is ahead of the crank; crossed, behind it.",
    unit=UNIT,
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

    def pose(angle: float) -> PinPlaces | None:
        a = complex(crank * np.exp(1j * angle))
        square = rod**2 - (a.imag - offset) ** 2
        ahead = np.sqrt(max(square, 0.0)) * (1.0 if closure == "open" else -1.0)
        return None if square < 0.0 else {"A": a, "B": complex(a.real + ahead, offset)}

    turns = crank + abs(offset) < rod
    return drawn_linkage(
        "Slider-crank", unit, ["stroke.value", "rod.angle"],
        "The crank turns fully." if turns else "The crank swings: the rod is not longer than crank and offset.",
        link("frame", O=0), link("crank", O=0, A=crank), link("rod", A=0, B=rod), link("slider", B=0),
        slide("slider", on="frame", at="B", through="O", angle=0, offset=offset, name="stroke"),
        *driven_crank("slider-crank", pose),
    )  # fmt: skip


@linkage(
    "ground=50 crank=20",
    ground="Distance of the pivots O of the crank and C of the guide.",
    crank="Length of the crank, O to A.",
    unit=UNIT,
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
    return drawn_linkage(
        "Inverted slider-crank", unit, ["guide.angle", "slot.value"], f"The guide {swings} than the ground.",
        link("frame", O=0, C=-ground), link("crank", O=0, A=crank), link("block", A=0), link("guide", C=0),
        slide("block", on="guide", at="A", through="C", angle=0, name="slot"), full_turn("crank"), drawn(A=a),
    )  # fmt: skip


@linkage(
    "kind=crank-shaper ground=25 crank=10 lever=65 rod=30 height=50",
    kind="crank-shaper: the slotted lever swings; Whitworth: it turns.",
    ground="Distance of the pivots of crank and lever.",
    crank="Length of the crank.",
    lever="Length of the lever from its pivot to the rod.",
    rod="Length of the rod to the ram.",
    height="Height of the ram above the lever's pivot.",
    unit=UNIT,
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
    return drawn_linkage(
        title, unit, ["stroke.value", "lever.angle"], f"The lever {'turns' if turns else 'swings'}.",
        link("frame", O=1j * ground, C=0), link("crank", O=0, A=crank), link("block", A=0), link("lever", C=0, B=lever),
        link("rod", B=0, E=rod), link("ram", E=0),
        slide("block", on="lever", at="A", through="C", angle=0, name="slot"),
        slide("ram", on="frame", at="E", through="C", angle=0, offset=height, name="stroke"),
        full_turn("crank"), drawn(A=complex(a), B=complex(b), E=e),
    )  # fmt: skip
