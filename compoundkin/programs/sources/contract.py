"""What is written as a program in another language, and what each language answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

from compoundkin.base.display import PrintsShort
from compoundkin.programs.graph.operation_graph import InputNumber, OperationGraph
from compoundkin.programs.graph.operations import CONSTANT


@dataclass(frozen=True)
class Argument:
    """A number that a program is given.

    It has a name there, a meaning and a unit. `own` is the number that the mechanism itself has;
    who calls the program may leave it out where there is one. `start` is that of its own motion's first pose.
    """

    given: InputNumber
    name: str
    meaning: str
    unit: str = ""
    own: float | None = None
    start: float = 0.0


@dataclass(frozen=True)
class Result:
    """A number that a program answers: its node, its name there, its meaning."""

    node: int
    name: str
    meaning: str
    unit: str = ""


@dataclass(frozen=True, repr=False)
class WrittenProgram(PrintsShort):
    """A program of one pose as all languages write it.

    `assembled` is the node of the truth without which all results are NaN. `called` names nodes that mean something.
    `notes` are paragraphs of the comment: modes, ranges.
    """

    name: str
    title: str
    graph: OperationGraph
    arguments: tuple[Argument, ...]
    results: tuple[Result, ...]
    assembled: int
    notes: tuple[str, ...] = ()
    called: Mapping[int, str] = field(default_factory=dict)

    @property
    def read(self) -> tuple[Argument, ...]:
        """The arguments that results depend on."""
        nodes = self.graph.inputs((self.assembled, *(one.node for one in self.results)))
        given = {self.graph.nodes[k].given for k in nodes}
        return tuple(one for one in self.arguments if one.given in given)

    @property
    def always(self) -> bool:
        """Whether it is known to be assembled everywhere."""
        return self.graph.nodes[self.assembled].operation == CONSTANT and self.graph.nodes[self.assembled].value != 0.0


class Language(Protocol):
    """A language that programs are written in."""

    name: str

    def text(self, program: WrittenProgram) -> str:
        """Return the text of a file that has the function and all it needs."""
