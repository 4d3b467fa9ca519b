"""A free dimension: a point of a link, a coordinate of one, or a number of a pair or law; found by its name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.series import Number
from compoundkin.model.attributes import PARTS
from compoundkin.model.component_names import AXES, component_names
from compoundkin.programs.graph.input_kinds import DIMENSION
from compoundkin.programs.graph.operation_graph import InputNumber

# The word of a law's numbers.
LAW = "law"


@dataclass(frozen=True)
class FreeDimension:
    """A dimension by its name.

    It is of a link (`word` is the letter of a point, `part` empty for both coordinates), of a pair or cylinder
    (`word` is a field, `part` which of two numbers), or of the law of a driver (`part` is the number), whose values
    and rates programs then have as inputs, and not the number itself.
    """

    name: str
    owner: str
    word: str
    part: str = ""
    is_of_link: bool = False
    is_of_law: bool = False

    @property
    def is_vector(self) -> bool:
        """Whether it is a point, not a number."""
        return self.is_of_link and not self.part

    @property
    def base(self) -> str:
        """The name without its part."""
        return f"{self.owner}.{self.word}"

    @property
    def number(self) -> str:
        """The name of a pair's number, as `numbers_of` has it."""
        return f"{self.word}.{self.part}" if self.part else self.word

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The names of its numbers: both coordinates of a point."""
        return component_names(self.name) if self.is_vector else (self.name,)

    @property
    def inputs(self) -> tuple[InputNumber, ...]:
        """The inputs of a program that it is: two of a point."""
        if self.is_vector:
            return tuple(InputNumber(DIMENSION, self.name, part) for part in AXES)
        if self.is_of_link:
            return (InputNumber(DIMENSION, self.base, self.part),)
        return (InputNumber(DIMENSION, self.name),)

    def parts_of(self, value: Number) -> Iterator[tuple[InputNumber, Number]]:
        """Yield the inputs that it is with their parts of a value."""
        yield from zip(self.inputs, (np.real(value), np.imag(value)), strict=False)

    def part_of(self, value: Number) -> Number:
        """Return its part of a point."""
        return PARTS[self.part](value) if self.part else value

    def value_in(self, given: Mapping[InputNumber, Number]) -> Number:
        """Return its value among the inputs of a call, perhaps a single number."""
        parts = [given[one] for one in self.inputs]
        whole = parts[0] + 1j * parts[1] if self.is_vector else parts[0]
        return whole.item() if np.size(whole) == 1 else whole
