"""A construction: steps in their order, each an object by its name."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from compoundkin.files.exchange.geogebra.object_names import ObjectNames
from compoundkin.files.exchange.geogebra.polar_sums import number

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
