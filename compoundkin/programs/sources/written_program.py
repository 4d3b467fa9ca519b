"""A program as every language writes it: arguments, results, head comment; the interface of languages."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from compoundkin.base.display import ShortRepr
from compoundkin.base.version import VERSION
from compoundkin.programs.graph.operation_graph import CONSTANT, InputNumber, OperationGraph


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
class WrittenProgram(ShortRepr):
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

    @staticmethod
    def text(program: WrittenProgram) -> str:
        """Return the text of a file that has the function and all it needs."""


WIDTH = 96


def head_comment(program: WrittenProgram, use: str) -> list[str]:
    """Return the lines of the comment, without the signs of one. `use` tells how the function is called."""
    whether = "always true" if program.always else "whether it can be assembled; all others are NaN where it cannot"
    inputs = [(one.name, one.unit, _with_own_value(one.meaning, one.own)) for one in program.arguments]
    outputs = [(one.name, one.unit, one.meaning) for one in program.results]
    lines = [program.title, "", f"{program.name}: one pose of this mechanism, of the numbers given. {use}"]
    lines += ["", "Inputs", *_table(inputs), "", "Outputs"]
    lines += _table([("assembled", "", whether), *outputs])
    for note in program.notes:
        lines += ["", note]
    lines += ["", f"Made by compoundkin {VERSION}."]
    return [within_comment(part) for line in lines for part in _wrapped_line(line)]


def _with_own_value(meaning: str, own: float | None) -> str:
    return meaning if own is None else f"{meaning}; {own!r} in the mechanism"


def _table(rows: Sequence[tuple[str, str, str]]) -> list[str]:
    """Rows with their columns below each other."""
    names, units = (max(len(row[k]) for row in rows) if rows else 0 for k in (0, 1))
    return [f"  {name:<{names}}  {unit:<{units}}  {told}" for name, unit, told in rows]


def _wrapped_line(line: str) -> list[str]:
    indent = "    " if line.startswith("  ") else ""
    return textwrap.wrap(line, WIDTH, subsequent_indent=indent, break_long_words=False) or [""]


def within_comment(line: str) -> str:
    """A line that ends no comment in any language, whatever a title says."""
    line = " ".join(line.splitlines()).replace("\\", "/").replace('"""', "'''").replace("??", "? ?")
    return line.replace("*/", "* /").replace("/*", "/ *").rstrip()
