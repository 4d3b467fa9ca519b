"""Connectors, links and ratios as they are written, and their text."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from decimal import Decimal
from xml.sax.saxutils import quoteattr

from compoundkin.files.exchange.shortest_numbers import shortest

# Digits after the point: of numbers that are hundreds, all that a float has.
_DIGITS = 12


@dataclass
class WrittenConnector:
    """A connector at a place. `limits` are the ids of the two that it slides between."""

    id: int
    at: complex
    name: str = ""
    anchor: bool = False
    draw: bool = False
    rpm: float | None = None
    range: float = 0.0
    limits: tuple[int, ...] = ()
    radius: float = 0.0

    def lines(self, scale: float) -> Iterator[str]:
        """Yield its lines. A drawing's length is so many of the file's."""
        xy = {"x": place(self.at.real * scale), "y": place(self.at.imag * scale)}
        drives = {} if self.rpm is None else {"input": "true", "rpm": plain(_told(self.rpm))}
        if self.range:
            drives["limitangle"] = plain(self.range)
        slides = {"slider": "true"} if self.limits else {}
        if self.radius:
            slides["slideradius"] = place(self.radius * scale)
        text = {"id": str(self.id), "selected": "false", "layer": "16", **xy, **_flags(anchor=self.anchor)}
        text |= {**drives, **_flags(draw=self.draw), **slides, **_named(self.name)}
        inside = [tag("slidelimit", {"id": str(id_)}) for id_ in self.limits]
        yield from element("connector", text, inside)


@dataclass
class WrittenLink:
    """A link of connectors by their ids. `fastened` is the link that it is one with."""

    id: int
    connectors: list[int] = field(default_factory=list)
    name: str = ""
    gear: bool = False
    fastened: int | None = None
    throw: float = 0.0
    cpm: float = 0.0

    def lines(self, scale: float) -> Iterator[str]:
        """Yield its lines."""
        text = {"id": str(self.id), "selected": "false", "layer": "16", **_named(self.name), "linesize": "1"}
        text |= _flags(gear=self.gear)
        if self.fastened is not None:
            text["fastenlink"] = str(self.fastened)
        if self.throw:
            text |= {"actuator": "true", "throw": place(self.throw * scale), "cpm": plain(_told(self.cpm))}
        yield from element("Link", text, [tag("connector", {"id": str(id_)}) for id_ in self.connectors])


@dataclass(frozen=True)
class WrittenRatio:
    """Two wheels by the ids of their links. Sizes are lengths where `by_size`."""

    kind: str
    links: tuple[int, int]
    sizes: tuple[float, float]
    by_size: bool

    def lines(self, scale: float) -> Iterator[str]:
        """Yield its lines."""
        factor = scale if self.by_size else 1.0
        wheels = zip(self.links, self.sizes, strict=True)
        inside = [tag("link", {"id": str(id_), "size": plain(size * factor)}) for id_, size in wheels]
        yield from element("ratio", {"type": self.kind, "sizeassize": str(self.by_size).lower()}, inside)


def plain(value: float) -> str:
    """Return a number with all its digits and without an exponent.

    >>> plain(0.1), plain(-3.0), plain(1e-7)
    ('0.1', '-3', '0.0000001')
    """
    return format(Decimal(shortest(value)), "f")


def place(value: float) -> str:
    """Return a length, rounded to what a float of some hundreds can tell.

    >>> place(1e-14), place(453.5433070866142)
    ('0', '453.543307086614')
    """
    return plain(round(value, _DIGITS))


def _told(value: float) -> float:
    """Return a speed without what rounding has left of its conversion."""
    return float(f"{value:.15g}")


def tag(name: str, attributes: dict[str, str]) -> str:
    """Return an element without children."""
    return f"<{name} {' '.join(f'{key}={quoteattr(value)}' for key, value in attributes.items())}/>"


def element(name: str, attributes: dict[str, str], inside: list[str]) -> Iterator[str]:
    """Yield the lines of an element, indented by one."""
    own = tag(name, attributes)
    if not inside:
        yield f"\t{own}"
        return
    yield f"\t{own[:-2]}>"
    yield from (f"\t\t{line}" for line in inside)
    yield f"\t</{name}>"


def _flags(**flags: bool) -> dict[str, str]:
    """Return those that hold; what is missing is false there."""
    return {name: "true" for name, holds in flags.items() if holds}


def _named(name: str) -> dict[str, str]:
    return {"name": name} if name else {}
