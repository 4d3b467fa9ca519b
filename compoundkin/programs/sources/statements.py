"""The statements of a text: values with a name, and expressions of as many operations as a line can hold.

Values are computed in an order in which few wait at once. Names are those of the mechanism, made fit for every
language, no two alike.
"""

from __future__ import annotations

import re
import unicodedata
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite

from compoundkin.programs.graph.operation_graph import CONSTANT, REDUCTIONS, InputNumber, OperationGraph
from compoundkin.programs.sources.spellings import QUOTIENT, Phrase, Spelling
from compoundkin.programs.sources.written_program import WrittenProgram, within_comment

# So long may the expression of a line be, and one that is used once to go without a name.
LINE, NAMELESS = 84, 44


# A number that is written more than once gets a name where it is longer than this.
SHORT = 6


ASSEMBLED = "assembled"


_OPPOSITE = {"add": "sub", "sub": "add"}


OF_NUMBERS, OF_ASSEMBLING = "numbers of the mechanism", "whether it can be assembled"


@dataclass(frozen=True)
class Statement:
    """A value with a name, its expression, and what it is first needed for."""

    name: str
    expression: str
    is_truth: bool
    section: str


@dataclass(frozen=True)
class Statements:
    """All statements of a text: numbers, values in order, the phrases of the results."""

    numbers: tuple[Statement, ...]
    values: tuple[Statement, ...]
    results: tuple[Phrase, ...]
    assembled: Phrase

    def body(self, line: Callable[[Statement], str], comment: Callable[[str], str]) -> Iterator[str]:
        """Yield the lines of numbers and values, each section under its comment."""
        section = None
        for one in (*self.numbers, *self.values):
            if one.section != section:
                section = one.section
                yield from ("", comment(within_comment(section)))
            yield line(one)

    @property
    def whether(self) -> tuple[Statement, ...]:
        """What tells whether it is assembled, unless it is among the values."""
        found = Statement(ASSEMBLED, self.assembled.text, True, "")
        return () if found.expression == ASSEMBLED else (found,)

    def calls(self, function: str) -> bool:
        """Tell whether a function is called anywhere."""
        texts = (*(one.expression for one in self.values), *(one.text for one in (*self.results, self.assembled)))
        called = re.compile(rf"\b{function}\(")
        return any(called.search(text) for text in texts)


class StatementWriter:
    """Writes what a program needs as statements of one language."""

    def __init__(
        self,
        program: WrittenProgram,
        spelled: Mapping[str, Spelling],
        number: Callable[[float], Phrase],
        truths: tuple[str, str],
    ) -> None:
        self.graph, self.program, self.spelled, self.number, self.truths = (
            program.graph,
            program,
            spelled,
            number,
            truths,
        )
        self.names = Identifiers(one.name for one in program.arguments)
        self.last = {"t": 0, "c": 0}
        self.numbers: list[Statement] = []
        self.values: list[Statement] = []
        self.texts: dict[int, Phrase] = {}
        self.nameless: set[int] = set()
        self.section = ""
        wanted = [program.assembled, *(one.node for one in program.results)]
        needed = self.graph.needed(wanted)
        self.uses = Counter(operand for k in needed for operand in self.graph.nodes[k].operands)
        self.uses.update(wanted)
        # reciprocals that become a quotient with the product which alone uses them
        self.divisors = {k: divisor for k in needed if (divisor := self._divisor(k)) is not None}
        self.absorbed = set(self.divisors.values())

    def written(self) -> Statements:
        """Return all statements."""
        program = self.program
        arguments = {one.given: one.name for one in program.arguments}
        self._section(program.assembled, OF_ASSEMBLING, arguments)
        for one in program.results:
            self._section(one.node, one.meaning, arguments)
        results = tuple(self.texts[one.node] for one in program.results)
        return Statements(tuple(self.numbers), tuple(self.values), results, self._whether())

    def _whether(self) -> Phrase:
        """Whether it can be assembled, which may be known."""
        node = self.graph.nodes[self.program.assembled]
        return (
            Phrase(self.truths[bool(node.value)]) if node.operation == CONSTANT else self.texts[self.program.assembled]
        )

    def _section(self, wanted: int, section: str, arguments: Mapping[InputNumber, str]) -> None:
        self.section = section
        for k in reading_order(self.graph, [wanted]):
            if k in self.texts or k in self.absorbed:
                continue
            node = self.graph.nodes[k]
            if node.given is not None:
                self.texts[k] = Phrase(arguments[node.given])
            elif node.operation == CONSTANT:
                self._constant(k, node.value)
            else:
                self._operation(k)

    def _constant(self, k: int, value: float) -> None:
        self.texts[k] = self.number(value)
        if self._has_name(k):
            self._name(k, self.numbers, "c")

    def _has_name(self, k: int) -> bool:
        """Whether a number has a name."""
        value = self.graph.nodes[k].value
        return self.uses[k] > 1 and isfinite(value) and len(self.number(value).text) > SHORT

    def _operation(self, k: int) -> None:
        """Write a node; where the line would be too long, its longest operands get names first."""
        operation, operands = self._spelled_as(k)
        if operation in REDUCTIONS:
            self.texts[k] = self.texts[operands[0]]  # over one pose
            return
        operation, last = self._without_minus(operation, operands[-1])
        spelling = self.spelled[operation]

        def phrases() -> list[Phrase]:
            return [*(self.texts[n] for n in operands[:-1]), last or self.texts[operands[-1]]]

        made = spelling.of(phrases())
        while len(made.text) > LINE and (nameless := self.nameless.intersection(operands)):
            # of two as long the earlier one, so that the text is always the same
            self._name(max(sorted(nameless), key=lambda n: len(self.texts[n].text)), self.values, "t")
            made = spelling.of(phrases())
        self.texts[k] = made
        self.nameless.add(k)
        if self.uses[k] > 1 or k in self.program.called or k == self.program.assembled or len(made.text) > NAMELESS:
            self._name(k, self.values, "t")

    def _name(self, k: int, among: list[Statement], letter: str) -> None:
        called = self.program.called.get(k)
        if k == self.program.assembled:
            name = ASSEMBLED
        elif called is None:
            name, self.last[letter] = self.names.take_numbered(letter, self.last[letter] + 1)
        else:
            name = self.names.take(called)
        section = self.section if among is self.values else OF_NUMBERS
        among.append(Statement(name, self.texts[k].text, self.graph.is_truth(k), section))
        self.texts[k] = Phrase(name)
        self.nameless.discard(k)

    def _spelled_as(self, k: int) -> tuple[str, tuple[int, ...]]:
        """The operation and the operands that a node is written with."""
        node, divisor = self.graph.nodes[k], self.divisors.get(k)
        if divisor is None:
            # numbers first: 2.0*x
            is_turned = node.operation == "mul" and self.graph.nodes[node.operands[1]].operation == CONSTANT
            return node.operation, node.operands[::-1] if is_turned else node.operands
        other = next(n for n in node.operands if n != divisor)
        return QUOTIENT, (other, self.graph.nodes[divisor].operands[0])

    def _without_minus(self, operation: str, last: int) -> tuple[str, Phrase | None]:
        """The operation for a number added that is below zero: x - 2.0, not x + (-2.0)."""
        node = self.graph.nodes[last]
        if operation not in _OPPOSITE or node.operation != CONSTANT or not node.value < 0.0 or self._has_name(last):
            return operation, None
        return _OPPOSITE[operation], self.number(-node.value)

    def _divisor(self, k: int) -> int | None:
        """The operand of a product that is a reciprocal nothing else uses."""
        node = self.graph.nodes[k]
        if node.operation != "mul":
            return None
        return next((n for n in node.operands if self.graph.nodes[n].operation == "inv" and self.uses[n] == 1), None)


def reading_order(graph: OperationGraph, wanted: Sequence[int]) -> list[int]:
    """Return all nodes that some nodes need, operands first.

    What is wanted first comes first. Of the operands of a node, the one for which more values have to wait is computed
    first (Sethi and Ullman, The generation of optimal code for arithmetic expressions, J. ACM 17, 1970, p. 715).
    """
    waits = _waiting(graph, wanted)
    found: dict[int, None] = {}
    for root in wanted:
        waiting = [(root, False)]
        while waiting:
            node, is_ready = waiting.pop()
            if node in found:
                continue
            if is_ready:
                found[node] = None
                continue
            waiting.append((node, True))
            # the last one put is the first one taken
            operands = sorted(enumerate(graph.nodes[node].operands), key=lambda one: (waits[one[1]], -one[0]))
            waiting.extend((operand, False) for _, operand in operands)
    return list(found)


def _waiting(graph: OperationGraph, wanted: Sequence[int]) -> dict[int, int]:
    """How many values have to be kept at once to compute each node, as if nothing were shared."""
    found: dict[int, int] = {}
    for node in graph.needed(wanted):
        needs = sorted((found[k] for k in graph.nodes[node].operands), reverse=True)
        found[node] = max((need + k for k, need in enumerate(needs)), default=1)
    return found


# A name may have 63 characters in MATLAB; what is put before and behind it must have room too.
LONGEST = 40


_GREEK = re.compile(r"GREEK (?:SMALL|CAPITAL) LETTER (\w+)")


# Words that mean something in one of the languages, and those that the texts use themselves. They are the same for all
# languages, so that a quantity is called alike everywhere.
_OF_C = """
    auto break case char const continue default do double else enum extern float for goto if inline int long register
    restrict return short signed sizeof static struct switch typedef union unsigned void volatile while bool true false
    alignas alignof and and_eq asm bitand bitor catch class compl concept consteval constexpr constinit decltype delete
    dynamic_cast explicit export friend mutable namespace new noexcept not not_eq nullptr operator or or_eq private
    protected public reinterpret_cast requires static_assert static_cast template this thread_local throw try typeid
    typename using virtual wchar_t xor xor_eq complex I NAN INFINITY NULL main div gamma j0 j1 jn y0 y1 yn linux unix
"""


_OF_PYTHON = """
    False None True and as assert async await break class continue def del elif else except finally for from global if
    import in is lambda match nonlocal not or pass raise return try type while with yield abs max min round math nan inf
"""


_OF_JAVASCRIPT = """
    arguments await break case catch class const continue debugger default delete do else enum eval export extends false
    finally for function if implements import in instanceof interface let new null package private protected public
    return static super switch this throw true try typeof undefined var void while with yield Infinity NaN Math Number
    Object module exports require window globalThis name
"""


_OF_MATLAB = """
    break case catch classdef continue else elseif end for function global if otherwise parfor persistent return spmd
    switch try while do until endif endfor endwhile endfunction end_try_catch unwind_protect ans pi e i j Inf NaN eps
    true false nargin nargout varargin varargout isempty struct zeros ones size disp
"""


_OF_TEXTS = """
    in out assembled given abs fabs sqrt sin cos tan atan2 exp log floor ceil round rint fix mod sign max min fmax fmin
    isnan copysign inputs outputs root quotient choice greatest least greater lesser nearest logarithm power sine cosine
"""


RESERVED = frozenset(" ".join((_OF_C, _OF_PYTHON, _OF_JAVASCRIPT, _OF_MATLAB, _OF_TEXTS)).split())


def identifier(name: str) -> str:
    """Return a name that every language takes.

    >>> identifier("plate.C.x"), identifier("α-bar 2"), identifier("4th"), identifier("for"), identifier("__")
    ('plate_C_x', 'alpha_bar_2', 'n4th', 'for_', 'n')
    """
    plain = "".join(map(_letters, unicodedata.normalize("NFKD", name)))
    plain = re.sub(r"[^0-9A-Za-z]+", "_", plain).strip("_")[:LONGEST]
    if not plain or plain[0].isdigit():
        plain = f"n{plain}"
    return f"{plain}_" if plain in RESERVED else plain


def _letters(letter: str) -> str:
    """What stands for a letter: nothing for an accent, the name of a Greek letter."""
    if unicodedata.combining(letter):
        return ""
    greek = _GREEK.fullmatch(unicodedata.name(letter, ""))
    return letter if greek is None else greek[1].lower()


class Identifiers:
    """The names that are taken in one text."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._taken = set(taken)

    def take(self, name: str) -> str:
        """Return a name like this one that nothing else has.

        >>> names = Identifiers()
        >>> names.take("a.b"), names.take("a-b"), names.take("a_b")
        ('a_b', 'a_b_2', 'a_b_3')
        """
        wanted = found = identifier(name)
        count = 2
        while found in self._taken:
            found, count = f"{wanted}_{count}", count + 1
        self._taken.add(found)
        return found

    def take_numbered(self, letter: str, first: int) -> tuple[str, int]:
        """Return a letter with a number that nothing else has, and the number.

        It is the first one from `first` on.
        """
        while f"{letter}{first}" in self._taken:
            first += 1
        self._taken.add(f"{letter}{first}")
        return f"{letter}{first}", first
