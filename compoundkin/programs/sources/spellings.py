"""How operations are spelled: infix signs, calls, choices; how tightly each binds, so that few brackets are needed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

# How tightly a text binds, from the loosest on. A sign binds like a sum: -a*b is (-a)*b to the last bit.
CHOICE, EITHER, BOTH, NOT, COMPARISON, SUM, PRODUCT, FACTOR, ATOM = range(9)
# A quotient is no operation of graphs: it is what is written for a product with a reciprocal.
QUOTIENT = "quotient"


class Phrase(NamedTuple):
    """A text and how tightly it binds."""

    text: str
    level: int = ATOM

    def within(self, level: int) -> str:
        """Return the text, in brackets where something tighter is needed."""
        return self.text if self.level >= level else f"({self.text})"


@dataclass(frozen=True)
class Spelling:
    """How one operation is spelled.

    Its operands need brackets where they bind less than `needed`. What `is_chain`
    goes without brackets where it is its own first operand: a + b + c.
    """

    form: str
    level: int = ATOM
    needed: int = CHOICE
    is_chain: bool = False

    def of(self, operands: Sequence[Phrase]) -> Phrase:
        """Return the operation on some operands."""
        first, *rest = operands
        level = self.level if self.is_chain and first.level == self.level else self.needed
        texts = (first.within(level), *(other.within(self.needed) for other in rest))
        return Phrase(self.form.format(*texts), self.level)


def infix(sign: str, level: int, needed: int, is_chain: bool = True) -> Spelling:
    """Return the spelling of a sign between two operands."""
    return Spelling(f"{{}}{sign}{{}}", level, needed, is_chain)


def call(function: str, operands: int = 1) -> Spelling:
    """Return the spelling of a call.

    >>> call("atan2", 2).of((Phrase("y"), Phrase("a + b", SUM))).text
    'atan2(y, a + b)'
    """
    return Spelling(f"{function}({', '.join(['{}'] * operands)})")


def calls(names: Mapping[str, str], operands: int = 1) -> dict[str, Spelling]:
    """Return the spellings of operations that are calls, by operation."""
    return {operation: call(function, operands) for operation, function in names.items()}


# What all languages have alike.
ARITHMETIC: Mapping[str, Spelling] = {
    "add": infix(" + ", SUM, PRODUCT),
    "sub": infix(" - ", SUM, PRODUCT),
    "mul": infix("*", PRODUCT, FACTOR),
    "inv": Spelling("1.0/{}", PRODUCT, FACTOR),
    QUOTIENT: infix("/", PRODUCT, FACTOR),
    "neg": Spelling("-{}", SUM, PRODUCT),
    "ge": infix(" >= ", COMPARISON, SUM, is_chain=False),
    "gt": infix(" > ", COMPARISON, SUM, is_chain=False),
    "eq": infix(" == ", COMPARISON, SUM, is_chain=False),
}
# What C and JavaScript have alike.
OF_BRACES: Mapping[str, Spelling] = {
    "and": infix(" && ", BOTH, NOT),
    "or": infix(" || ", EITHER, NOT),
    "not": Spelling("!{}", NOT, ATOM),
    "select": Spelling("{} ? {} : {}", CHOICE, EITHER),
}


def number(value: float, nan: str, infinity: str) -> Phrase:
    """Return a number that reads back exactly, never as an integer.

    >>> number(2.0, "NAN", "INFINITY"), number(-0.1, "NAN", "INFINITY")
    (Phrase(text='2.0', level=8), Phrase(text='-0.1', level=5))
    """
    text = nan if value != value else repr(value).replace("inf", infinity)
    return Phrase(text, SUM if text.startswith("-") else ATOM)
