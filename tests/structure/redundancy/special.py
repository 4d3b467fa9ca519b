"""The overconstrained reference cases as mechanisms, and others with special dimensions."""

from __future__ import annotations

from typing import Any

import numpy as np

import compoundkin as ck
from tests.support import reference

LETTERS = "ABCDEFGHIJ"


def bars(name: str, driven: str = "") -> ck.Mechanism:
    """A reference case of points and bars: every bar a link, every joint a pin."""
    given = reference(name, "overconstrained")["dimensions"]
    places = {letter: complex(*point) for letter, point in zip(LETTERS, given["points"], strict=False)}
    fixed = [LETTERS[k] for k in given["fixed_points"]]
    links = [[LETTERS[k] for k in bar] for bar in given["bars"] if not set(bar) <= set(given["fixed_points"])]
    items: list[Any] = [ck.link("frame", *fixed), *(ck.link("".join(ends).lower(), *ends) for ends in links)]
    return ck.Mechanism(name, *items, *([ck.drive(driven)] if driven else []), ck.drawn(**places))


def cranks(*drives: Any, off: float = 0.0) -> ck.Mechanism:
    """The parallelogram with a third crank of the reference, the third one longer by `off`."""
    given = reference("parallelogram_extra_crank", "overconstrained")["dimensions"]
    length = abs(complex(*given["crank"]))
    pins = [complex(*p) for p in given["coupler_pins"]]
    ground = [complex(*p) for p in given["ground"]]
    places = [p + complex(*given["crank"]) for p in ground]
    return ck.Mechanism(
        "Three cranks",
        ck.link("frame", **dict(zip("ADF", ground, strict=True))),
        ck.link("crank", A=0, B=length),
        ck.link("coupler", **dict(zip("BCE", pins, strict=True))),
        ck.link("second", D=0, C=length),
        ck.link("third", F=0, E=length + off),
        *drives,
        ck.drawn(**dict(zip("BCE", places, strict=True))),
    )


def wedge(*drives: Any) -> ck.Mechanism:
    """The loop of three slides of the reference, in its three directions."""
    one, two, three = np.deg2rad(reference("wedge_PPP", "overconstrained")["dimensions"]["directions_deg"])
    return ck.Mechanism(
        "Wedge",
        ck.link("frame", O=0, G=(5, 0)),
        ck.link("wedge", W=0, S=(5, 0)),
        ck.link("ram", R=0),
        ck.slide("wedge", on="frame", at="W", through="O", angle=one, name="bed"),
        ck.slide("ram", on="wedge", at="R", through="S", angle=two, turn=three - two, name="slope"),
        ck.slide("ram", on="frame", at="R", through="G", angle=three, name="column"),
        *drives,
    )


def guides(skew: float = 0.0) -> ck.Mechanism:
    """A table that a crank moves on two guides, the second one turned by `skew`."""
    return ck.Mechanism(
        "Table on two guides",
        ck.link("frame", A=0, B=(0, 2), O=(-5, 1)),
        ck.link("table", P=0, Q=(0, 2), T=(0, 1)),
        ck.link("crank", O=0, C=1),
        ck.link("rod", C=0, T=5),
        ck.slide("table", on="frame", at="P", through="A", name="first"),
        ck.slide("table", on="frame", at="Q", through="B", angle=skew, name="second"),
        ck.drive("crank"),
    )


def with_parallel_crank(base: ck.Mechanism, coupler: str, crank: str, place: complex) -> ck.Mechanism:
    """A mechanism whose `coupler` moves in translation, with a further crank like `crank` at a place of the coupler."""
    (letter,) = set(base.links[crank].points) & set(base.links["frame"].points)
    (pin,) = set(base.links[crank].points) & set(base.links[coupler].points)
    arm = base.links[crank].points[pin] - base.links[crank].points[letter]
    shift = place - base.links[coupler].points[pin]
    ground = base.links["frame"].points[letter] + shift
    return base.replace(
        ck.link("frame", **base.links["frame"].points, X=ground),
        ck.link(coupler, **base.links[coupler].points, Y=place),
        ck.link("further", X=0, Y=abs(arm)),
        ck.drawn(**base.sketch, Y=base.sketch[pin] + shift),
    )
