"""A construction that can be dragged: named objects and sums of vectors in polar form."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from compoundkin.files.exchange.foreign_texts import shortest

# A name in an expression: a word with or without an index.
_NAME = re.compile(r"[^\W\d_][^\W_]*'*(?:_\{[^}]*\}|_\w)?")


Kind = Literal["numeric", "point", "vector", "line", "segment", "polygon", "conic", "locus"]


# How a step is shown: dimensions and helpers are not, but can be looked up and changed.
Look = Literal["slider", "dimension", "helper", "fixed", "pin", "guide", "link", "wheel", "curve"]


@dataclass(frozen=True)
class SliderRange:
    """What a slider begins with, and its range and step."""

    value: float
    low: float
    high: float
    step: float


@dataclass(frozen=True)
class ConstructionStep:
    """An object: free, an expression, or the result of a command. `text` is its right-hand side."""

    name: str
    kind: Kind
    look: Look
    text: str
    numbers: tuple[float, ...] = ()  # of a free number or point
    slider: SliderRange | None = None
    command: str = ""
    arguments: tuple[str, ...] = ()
    caption: str = ""

    @property
    def is_free(self) -> bool:
        """Whether it depends on no other object."""
        return bool(self.numbers) or self.slider is not None

    @property
    def lines(self) -> tuple[str, ...]:
        """The commands of the input bar."""
        own = f"{self.name} = {self.text}"
        if self.slider is None or self.slider.value == self.slider.low:
            return (own,)
        return own, f"SetValue({self.name}, {number(self.slider.value)})"


class Construction:
    """Steps as they are taken, and the names in use."""

    def __init__(self) -> None:
        self.names = ObjectNames()
        self.steps: list[ConstructionStep] = []
        self.driven: dict[str, str] = {}  # the sliders of drivers, by these
        self.beyond: tuple[str, ...] = ()  # the drivers whose sliders do not reach the pose shown
        self.sizes: dict[str, tuple[str, ...]] = {}  # the numbers of wheels: of gears two, of a wheel on a line one

    @property
    def lines(self) -> list[str]:
        """All commands of the input bar, in order."""
        return [line for step in self.steps for line in step.lines]

    def is_slider(self, name: str) -> bool:
        """Return whether a name is that of a slider."""
        return any(step.name == name and step.slider for step in self.steps)

    def needs(self, name: str) -> set[str]:
        """Return the names on which an object depends, its own too."""
        needed = {name}
        for step in reversed(self.steps):
            if step.name in needed:
                needed.update(_NAME.findall(step.text))
        return needed

    def slide(self, stem: str, index: str, slider: SliderRange, caption: str) -> str:
        """Add a slider; return its name."""
        text = f"Slider({number(slider.low)}, {number(slider.high)}, {number(slider.step)})"
        name = self.names.number(stem, index)
        return self._add(ConstructionStep(name, "numeric", "slider", text, slider=slider, caption=caption))

    def dimension(self, stem: str, index: str, value: float, caption: str = "") -> str:
        """Add a free number; return its name."""
        name = self.names.number(stem, index)
        return self._add(
            ConstructionStep(name, "numeric", "dimension", number(value), (float(value),), caption=caption)
        )

    def free_point(self, letter: str, place: complex) -> str:
        """Add a point that can be dragged; return its name."""
        name, text = self.names.point(letter), f"({number(place.real)}, {number(place.imag)})"
        return self._add(ConstructionStep(name, "point", "fixed", text, (place.real, place.imag)))

    def measured(self, stem: str, index: str, command: str, arguments: Sequence[str]) -> str:
        """Add a number that a command gives; return its name."""
        return self.shape("numeric", (stem, index), "helper", command, arguments)

    def helper(self, stem: str, index: str, text: str, caption: str = "") -> str:
        """Add a number that is computed; return its name."""
        return self._add(ConstructionStep(self.names.number(stem, index), "numeric", "helper", text, caption=caption))

    def vector(self, index: str, text: str) -> str:
        """Add a vector that is not shown; return its name."""
        return self._add(ConstructionStep(self.names.number("v", index), "vector", "helper", text))

    def point(self, letter: str, text: str) -> str:
        """Add a point of a link by an expression; return its name."""
        return self._add(ConstructionStep(self.names.point(letter), "point", "pin", text))

    def helping_point(self, stem: str, index: str, text: str) -> str:
        """Add a point of no link by an expression; return its name."""
        return self._add(ConstructionStep(self.names.number(stem, index), "point", "helper", text))

    def met(self, letter: str, command: str, arguments: Sequence[str]) -> str:
        """Add a point of a link by a command; return its name."""
        return self._command(self.names.point(letter), "point", "pin", command, arguments)

    def shape(self, kind: Kind, name: tuple[str, str], look: Look, command: str, arguments: Sequence[str]) -> str:
        """Add a shape by a command; `name` is its letter and index. Return its name."""
        return self._command(self.names.number(*name), kind, look, command, arguments)

    def _command(self, name: str, kind: Kind, look: Look, command: str, arguments: Sequence[str]) -> str:
        text = f"{command}({', '.join(arguments)})"
        return self._add(ConstructionStep(name, kind, look, text, command=command, arguments=tuple(arguments)))

    def _add(self, step: ConstructionStep) -> str:
        self.steps.append(step)
        return step.name


# So many units of its last digit an angle may be off once it has been a direction, or the last digit of a turn.
_ULPS = 4.0
_TURN = 360.0


def number(value: float) -> str:
    """Return a number as GeoGebra reads it, to the last digit.

    >>> number(2.0), number(1e-07), number(-0.1)
    ('2', '1E-07', '-0.1')
    """
    return shortest(value).replace("e", "E")


def in_degrees(radians: float) -> float:
    """Return degrees, of those that differ by rounding the ones with fewest decimals.

    >>> in_degrees(0.6108652381980153), in_degrees(1e-17)
    (35.0, 0.0)
    """
    exact = float(np.rad2deg(radians))
    near = (round(exact, digits) for digits in range(14))
    off = max(_ULPS * float(np.spacing(abs(exact))), float(np.spacing(_TURN)))
    return next((value for value in near if abs(value - exact) <= off), exact)


@dataclass(frozen=True)
class Angle:
    """A sum of named angles and of a number, in degrees."""

    names: tuple[tuple[int, str], ...] = ()
    rest: float = 0.0

    def plus(self, other: Angle, sign: int = 1) -> Angle:
        """Return the sum; what is there with both signs is left out."""
        names = list(self.names)
        for own, name in other.names:
            if (-own * sign, name) in names:
                names.remove((-own * sign, name))
            else:
                names.append((own * sign, name))
        return Angle(tuple(names), self.rest + sign * other.rest)

    def minus(self, other: Angle) -> Angle:
        """Return the difference."""
        return self.plus(other, -1)

    @property
    def is_zero(self) -> bool:
        """Whether nothing is left."""
        return not self.names and self.rest == 0.0

    @property
    def text(self) -> str:
        """The sum as it is written.

        >>> Angle(((1, "a"), (-1, "b")), 90.0).text, Angle(((-1, "a"),)).text, Angle().text
        ('a - b + 90', '-a', '0')
        """
        terms = [(sign, name) for sign, name in self.names]
        if self.rest or not terms:
            terms.append((-1 if self.rest < 0 else 1, number(abs(self.rest))))
        return signed(sorted(terms, key=lambda term: -term[0]) if terms[0][0] < 0 else terms)

    @property
    def in_degrees(self) -> str:
        """The sum with the sign of degrees.

        >>> Angle(((1, "a"),)).in_degrees, Angle(((1, "a"),), 5.0).in_degrees
        ('a°', '(a + 5)°')
        """
        one = (not self.names and self.rest >= 0) or (len(self.names) == 1 and not self.rest and self.names[0][0] > 0)
        return f"{self.text}°" if one else f"({self.text})°"


def named(name: str) -> Angle:
    """Return the angle of a name."""
    return Angle(((1, name),))


def signed(terms: list[tuple[int, str]]) -> str:
    """Return a sum of terms with signs.

    >>> signed([(-1, "a"), (1, "b"), (-1, "c")])
    '-a + b - c'
    """
    first = f"-{terms[0][1]}" if terms[0][0] < 0 else terms[0][1]
    return first + "".join(f" {'-' if sign < 0 else '+'} {text}" for sign, text in terms[1:])


@dataclass(frozen=True)
class PolarTerm:
    """A point by its name, or a length in a direction."""

    sign: int
    what: str
    angle: Angle | None = None

    @property
    def text(self) -> str:
        """It without its sign."""
        if self.angle is None:
            return self.what
        return f"({self.what}, 0)" if self.angle.is_zero else f"({self.what}; {self.angle.in_degrees})"


@dataclass(frozen=True)
class PolarSum:
    """A planar vector, or the place of a point: a sum of terms."""

    terms: tuple[PolarTerm, ...] = ()

    def plus(self, other: PolarSum, sign: int = 1) -> PolarSum:
        """Return the sum; what is there with both signs is left out."""
        terms = list(self.terms)
        for own in other.terms:
            opposite = PolarTerm(-own.sign * sign, own.what, own.angle)
            if opposite in terms:
                terms.remove(opposite)
            else:
                terms.append(PolarTerm(own.sign * sign, own.what, own.angle))
        return PolarSum(tuple(terms))

    def minus(self, other: PolarSum) -> PolarSum:
        """Return the difference."""
        return self.plus(other, -1)

    def turned(self, angle: Angle) -> PolarSum:
        """Return it turned. Points of the frame do not turn, nor do they need to."""
        if angle.is_zero:
            return self
        assert all(term.angle is not None for term in self.terms)
        return PolarSum(tuple(PolarTerm(t.sign, t.what, (t.angle or Angle()).plus(angle)) for t in self.terms))

    @property
    def text(self) -> str:
        """The sum as it is written, points first.

        >>> PolarSum((PolarTerm(1, "l", named("a")),)).plus(at("B")).text
        'B + (l; a°)'
        """
        if not self.terms:
            return "(0, 0)"
        terms = sorted(self.terms, key=lambda t: (t.sign < 0, t.angle is not None))
        return signed([(term.sign, term.text) for term in terms])

    @property
    def point(self) -> str | None:
        """The name of the point that it is, if it is one."""
        if len(self.terms) == 1 and self.terms[0].angle is None and self.terms[0].sign > 0:
            return self.terms[0].what
        return None

    def rectangular(self, coordinate: str) -> str:
        """Return a coordinate of a vector without points, "0" where it is none."""
        terms = [(t.sign, _part(t.what, t.angle or Angle(), coordinate)) for t in self.terms]
        return signed(kept) if (kept := [(sign, text) for sign, text in terms if text]) else "0"


def at(name: str) -> PolarSum:
    """Return the place of a point."""
    return PolarSum((PolarTerm(1, name),))


def along(length: str, angle: Angle) -> PolarSum:
    """Return a length in a direction."""
    return PolarSum((PolarTerm(1, length, angle),))


def _part(length: str, angle: Angle, coordinate: str) -> str:
    """Return a coordinate of a length in a direction; nothing where it is zero whatever the numbers are."""
    if not angle.names and angle.rest % 90 == 0:
        factor = (1, 0, -1, 0) if coordinate == "x" else (0, 1, 0, -1)
        own = factor[int(angle.rest // 90) % 4]
        return "" if own == 0 else length if own > 0 else f"(-{length})"
    return f"{length} * {'cos' if coordinate == 'x' else 'sin'}({angle.in_degrees})"


# A letter or two with a number behind is the name of a cell of its spreadsheet, so that the number becomes an index.
_PLAIN = re.compile(r"([A-Z][A-Za-z]*'*)(\d*)")
_FOREIGN = re.compile(r"[^0-9A-Za-z\u00c0-\u024f\u0391-\u03c9]+")
# What its parser takes for something else.
_RESERVED = frozenset({"NaN", "Undefined", "Infinity", "Pi", "True", "False"})


def indexed(stem: str, index: str) -> str:
    """Return a letter with an index.

    >>> indexed("O", "2"), indexed("l", "AB")
    ('O_2', 'l_{AB}')
    """
    index = _FOREIGN.sub("-", index).strip("-")
    if not index:
        return stem
    return f"{stem}_{index}" if len(index) == 1 else f"{stem}_{{{index}}}"


class ObjectNames:
    """The names given so far, each once."""

    def __init__(self) -> None:
        self._used: set[str] = set()

    def point(self, name: str) -> str:
        """Return the name of a point.

        >>> names = ObjectNames()
        >>> [names.point(name) for name in ("A", "O2", "tip", "A")]
        ['A', 'O_2', 'P_{tip}', 'A_2']
        """
        plain = _PLAIN.fullmatch(name)
        if plain and name not in _RESERVED:
            return self._unused(*plain.groups())
        return self._unused("P", name)

    def number(self, stem: str, index: str) -> str:
        """Return the name of a number or of another object."""
        return self._unused(stem, _FOREIGN.sub("-", index).strip("-") or "1")

    def _unused(self, stem: str, index: str) -> str:
        name, k = indexed(stem, index), 2
        while name in self._used:
            name, k = indexed(stem, f"{index}-{k}" if index else str(k)), k + 1
        self._used.add(name)
        return name
