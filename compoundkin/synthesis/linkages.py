"""Linkages from their lengths, all kinds by name: each an ordinary mechanism, in a pose that is drawn.

Lengths and angles are as books give them; what cannot be assembled is refused with the lengths that would do. Four-bars
and six-bars have files of their own; five-bars, yokes, lifts, wheels, cams and gears are here.
"""

from __future__ import annotations

from collections.abc import Callable
from difflib import get_close_matches

import numpy as np

from compoundkin.base.arrays import TURN
from compoundkin.base.errors import OTHER_WORDS, Problem, UnknownName, plain_word, suggestion
from compoundkin.model.attributes import POSITION
from compoundkin.model.cam_mechanism import cam_mechanism
from compoundkin.model.elements import drawn, drive, link
from compoundkin.model.fields import Item
from compoundkin.model.laws import dwell, fall, program
from compoundkin.model.laws import rise as rise_by
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.belt import belt
from compoundkin.model.pairs.gear import gear
from compoundkin.model.pairs.prismatic import slide
from compoundkin.model.pairs.slot import slot
from compoundkin.model.profiles.synthesised import synthesise
from compoundkin.synthesis.four_bars import four_bar, inverted_slider_crank, quick_return, slider_crank
from compoundkin.synthesis.linkage_words import (
    CLOSURE,
    DRAWN,
    POSES,
    UNIT,
    Angle,
    ArmOrSun,
    Closure,
    Count,
    Follower,
    Length,
    LinkageKind,
    PinPlaces,
    Place,
    Real,
    RiseLaw,
    drawn_linkage,
    driven_crank,
    full_turn,
    kind_of,
    linkage,
    place,
    third_pin,
    wrong,
)
from compoundkin.synthesis.six_bars import six_bar

# A scissor lift of more stages takes minutes to solve.
MOST_STAGES = 100


def _five_bar_pins(
    ground: float, left: float, left_coupler: float, right_coupler: float, right: float, closure: Closure
) -> Callable[[float, float], PinPlaces | None]:
    def pose(one: float, two: float) -> PinPlaces | None:
        b, d = complex(left * np.exp(1j * one)), complex(ground + right * np.exp(1j * two))
        c = third_pin(b, left_coupler, d, right_coupler, closure)
        return None if c is None else {"B": b, "C": c, "D": d}

    return pose


_FIVE = {
    "ground": "Distance of the fixed pivots A and E.",
    "left": "Length of the left crank, A to B.",
    "left_coupler": "Length from B to C.",
    "right_coupler": "Length from D to C.",
    "right": "Length of the right crank, E to D.",
}


@linkage("ground=50 left=20 left_coupler=50 right_coupler=50 right=20", **_FIVE, closure=CLOSURE, unit=UNIT)
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
    own, shown = driven_crank("five-bar", lambda angle: pins(angle, angle), "left")
    return drawn_linkage(
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
    closure=CLOSURE,
    unit=UNIT,
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
    own, shown = driven_crank("geared-five-bar", lambda angle: pins(angle, phase + ratio * angle), "left")
    sizes = (abs(ratio), 1.0)
    radii = tuple(size * ground / sum(sizes) for size in sizes)
    joined = (gear if ratio < 0.0 else belt)("left", "right", radii=radii, phase=phase)
    return drawn_linkage(
        "Geared five-bar", unit, ["C.position"], "",
        *_five_bar_links(ground, left, left_coupler, right_coupler, right), joined, own, shown,
    )  # fmt: skip


@linkage("crank=20", crank="Length of the crank; the stroke is twice as long.", unit=UNIT)
def scotch_yoke(crank: Length, *, unit: str = "") -> Mechanism:
    """Return a Scotch yoke: the pin of a crank in the straight slot of a yoke, which moves by a cosine.

    >>> scotch_yoke(20).outputs
    ('stroke.value',)
    """
    a = complex(crank * np.exp(1j * DRAWN))
    return drawn_linkage(
        "Scotch yoke", unit, ["stroke.value"], "The yoke moves by the cosine of the crank's angle.",
        link("frame", O=0), link("crank", O=0, A=crank), link("block", A=0), link("yoke", Y=0, Z=2.0 * crank),
        slide("block", on="yoke", at="A", through="Y", angle=np.pi / 2.0, name="slot"),
        slide("yoke", on="frame", at="Y", through="O", angle=0, name="stroke"),
        full_turn("crank"), drawn(A=a, Y=complex(a.real)),
    )  # fmt: skip


@linkage(
    "crank=20 rod=100 upper=60 lower=60 pivot=110,55",
    crank="Length of the crank, O to A.",
    rod="Length of the rod, A to the knee B.",
    upper="Length of the upper link, from its pivot C to the knee B.",
    lower="Length of the lower link, from the knee B to the ram D.",
    pivot="The pivot C, x and y from the crank's pivot O; the ram is on a level line below it.",
    unit=UNIT,
)
def toggle(crank: Length, rod: Length, upper: Length, lower: Length, pivot: Place, *, unit: str = "") -> Mechanism:
    """Return a toggle: a crank and its rod straighten a knee of two links, which presses a ram down.

    The knee is at the side of the crank. Raises InvalidInput for lengths that cannot be assembled.

    >>> toggle(20, 100, 60, 60, (110, 55)).outputs
    ('ram.value',)
    """
    c = place("pivot", pivot)

    def pose(angle: float) -> PinPlaces | None:
        a = complex(crank * np.exp(1j * angle))
        b = third_pin(a, rod, c, upper, "crossed" if c.real >= 0.0 else "open")
        if b is None or abs(b.real - c.real) > lower:
            return None
        return {"A": a, "B": b, "D": complex(c.real, b.imag - np.sqrt(lower**2 - (b.real - c.real) ** 2))}

    return drawn_linkage(
        "Toggle", unit, ["ram.value"], "Where the knee is straight the ram stands still, and its force is greatest.",
        link("frame", O=0, C=c), link("crank", O=0, A=crank), link("rod", A=0, B=rod), link("upper", C=0, B=upper),
        link("lower", B=0, D=lower), link("slider", D=0),
        slide("slider", on="frame", at="D", through="C", angle=-np.pi / 2.0, name="ram"), *driven_crank("toggle", pose),
    )  # fmt: skip


@linkage(
    "stages=2 arm=2 low=0.7 high=1.9",
    stages="How many crosses of arms stand on each other.",
    arm="Length of the arms.",
    low="Least distance of the feet, with the platform at its highest.",
    high="Greatest distance of the feet, below the length of an arm.",
    unit=UNIT,
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
    shown: PinPlaces = {"A": 0j, "B": complex(x)}
    links: list[Item] = []
    feet = ("A", "B")
    for k in range(1, stages + 1):
        tops = (f"L{k}", f"R{k}")
        shown |= {f"M{k}": complex(x / 2.0, (k - 0.5) * rise), tops[0]: 1j * k * rise, tops[1]: complex(x, k * rise)}
        for n, (foot, top) in enumerate(zip(feet, reversed(tops), strict=True)):
            links.append(link(f"arm-{2 * k - 1 + n}", **{foot: 0, f"M{k}": arm / 2.0, top: arm}))
        feet = tops
    left, right = feet
    return drawn_linkage(
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
    unit=UNIT,
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
    return drawn_linkage(
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
    unit=UNIT,
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
    unit=UNIT,
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
    return drawn_linkage(
        "Planetary train", unit, ["sun.angle", "planet.angle", "arm.angle"],
        f"Ring {ring}, sun {sun}, planet {planet} teeth: the sun turns {1.0 + ring / sun:g} times as fast as the arm.",
        link("frame", O=0), link("arm", O=0, P=arm), link("planet", P=0, Q=module * planet / 2.0),
        link("sun", O=0, S=module * sun / 2.0),
        gear("planet", "frame", carrier="arm", teeth=(planet, ring), module=module, internal=True, name="in ring"),
        gear("planet", "sun", carrier="arm", teeth=(planet, sun), module=module, name="on sun"),
        full_turn(driver),
    )  # fmt: skip


# All kinds, in the order in which they are listed.
KINDS = {
    kind.name: kind
    for kind in map(
        kind_of,
        (
            four_bar,
            slider_crank,
            inverted_slider_crank,
            quick_return,
            six_bar,
            five_bar,
            geared_five_bar,
            scotch_yoke,
            toggle,
            scissor,
            geneva,
            cam_follower,
            planetary,
        ),
    )
}


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
        if rest and get_close_matches(_spelled(name), list(KINDS), n=1):
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


def is_linkage(specification: str) -> bool:
    """Return whether a text names a linkage with its lengths, possible or not."""
    name, colon, _ = specification.partition(":")
    return bool(colon) and _spelled(name) in KINDS


def kind_named(name: str) -> LinkageKind:
    """Return the kind of a name, "four-bar" as well as Python's "four_bar". Raises UnknownName with the nearest."""
    if _spelled(name) not in KINDS:
        raise UnknownName(Problem(name, "there is no such linkage", suggestion(_spelled(name), list(KINDS))))
    return KINDS[_spelled(name)]


def _spelled(name: str) -> str:
    """Return the name of the linkage that a name means, spelled otherwise or by others: "fourbar", "crank-slider"."""
    plain = plain_word(name)
    meant = [one for one in KINDS if plain_word(one) == plain or one in OTHER_WORDS.get(plain, ())]
    return meant[0] if meant else name.strip().lower().replace("_", "-")
