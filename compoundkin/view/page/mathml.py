r"""Formulas as MathML: those in sentences, and those of reports, which write them in a small part of LaTeX.

The part is letters, numbers, brackets, commas, `_`, `^`, `\theta`, `\varphi`, `\circ`, `\text{...}`, `\overline{...}`,
`\operatorname{...}`, `\left` and `\right`, `\sin` and `\cos`, `\sqrt{...}`, `\dot` and `\ddot`, `\prime`,
`\partial`, "/", `\:`, and matrices in brackets (`bmatrix`).
Source: W3C, MathML Core.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator

from compoundkin.view.page.markup import safe
from compoundkin.view.report.wording import FUNCTIONS, formula_latex, formulas_in

LETTERS = {r"\theta": "θ", r"\varphi": "φ", r"\partial": "∂"}
SIGNS = {"-": "−", "+": "+", "=": "=", ",": ","}
OTHER_SIGNS = {"/": "/", "·": "·", r"\prime": "′"}
# Dots over a letter.
DOTS = {r"\dot": "˙", r"\ddot": "¨"}
# What ends an entry and a row of a matrix.
NEXT, ROW = "&", r"\\"
_TOKEN = re.compile(r"\s+|\\[a-zA-Z]+|\\.|\d+(?:\.\d+)?(?:e[+-]?\d+)?|.", re.DOTALL)
_WORDS = (r"\text", r"\operatorname")


class UnknownLatex(ValueError):
    """LaTeX that is not of the small part."""


def mathml(latex: str, breaks: bool = True) -> str:
    r"""Return a formula as MathML, its terms one after the other. So lines may be broken between them, if it `breaks`.

    Raises UnknownLatex for LaTeX that it does not know.

    >>> mathml(r"q_{\text{crank}} = 90^\circ")
    '<math><msub><mi>q</mi><mtext>crank</mtext></msub></math> <math><mo form="infix">=</mo><mn>90</mn><mo>°</mo></math>'
    """
    reader = _Reader(latex)
    parts: list[list[str]] = [[]]
    for atom in reader.atoms(""):
        if breaks and reader.depth == 0 and atom in _BREAKS and parts[-1]:
            # at the head of a part it would be taken for a sign, and be set close
            parts.append([atom.replace("<mo>", '<mo form="infix">')])
        else:
            parts[-1].append(atom)
    return " ".join(f"<math>{''.join(part)}</math>" for part in parts)


class _Reader:
    """Reads LaTeX, atom by atom; `depth` is how many brackets are open."""

    def __init__(self, latex: str) -> None:
        self.tokens = _TOKEN.findall(latex)
        self.at = 0
        self.depth = 0

    def next(self) -> str:
        if self.at >= len(self.tokens):
            raise UnknownLatex("it ends too early")
        self.at += 1
        return str(self.tokens[self.at - 1])

    def peek(self) -> str:
        return str(self.tokens[self.at]) if self.at < len(self.tokens) else ""

    def atoms(self, end: str) -> Iterator[str]:
        """Return all atoms up to an end, each with what is below and above it."""
        while self.peek() != end:
            atom = self.atom()
            if atom:
                yield self.with_scripts(atom)
        if end:
            self.next()

    def with_scripts(self, base: str) -> str:
        below = self.script("_")
        above = self.script("^")
        if above == "<mo>°</mo>":
            return (f"<msub>{base}{below}</msub>" if below else base) + above
        if below and above:
            return f"<msubsup>{base}{below}{above}</msubsup>"
        if below or above:
            return f"<msub>{base}{below}</msub>" if below else f"<msup>{base}{above}</msup>"
        return base

    def script(self, mark: str) -> str:
        if self.peek() != mark:
            return ""
        self.next()
        return self.group() if self.peek() == "{" else self.atom()

    def group(self) -> str:
        self.next()
        inner = list(self.atoms("}"))
        return inner[0] if len(inner) == 1 else f"<mrow>{''.join(inner)}</mrow>"

    def atom(self) -> str:
        token = self.next()
        if token.isspace() or token == r"\,":
            return ""
        if token == r"\:":
            return '<mspace width="0.17em"></mspace>'
        if token in _WORDS:
            return f"<mtext>{safe(self.words())}</mtext>"
        if token == r"\overline":
            # a bar that stretches needs a font for mathematics; the bar over a text does not
            return self.group().replace("<mtext>", '<mtext class="over">')
        if token == r"\sqrt":
            return f"<msqrt>{self.group()}</msqrt>"
        if token in (r"\left", r"\right"):
            return self.bracket(self.next(), stretches=True)
        if token in DOTS:
            return f'<mover accent="true">{self.group()}<mo>{DOTS[token]}</mo></mover>'
        if token == r"\begin":
            return self.matrix()
        return self.bracket(token) if token in "()[]" else _single_token(token)

    def matrix(self) -> str:
        """Return a matrix in brackets, row by row."""
        if self.words() != "bmatrix":
            raise UnknownLatex("no matrix")
        self.depth += 1
        rows: list[list[list[str]]] = [[[]]]
        while self.peek() != r"\end":
            if self.peek() == NEXT:
                rows[-1].append([])
            elif self.peek() == ROW:
                rows.append([[]])
            else:
                atom = self.atom()
                rows[-1][-1] += [self.with_scripts(atom)] if atom else []
                continue
            self.next()
        self.next()
        if self.words() != "bmatrix":
            raise UnknownLatex("no end of a matrix")
        self.depth -= 1
        cells = ("".join(f"<mtd>{''.join(cell)}</mtd>" for cell in row) for row in rows)
        table = "".join(f"<mtr>{row}</mtr>" for row in cells)
        return f"<mrow><mo>[</mo><mtable>{table}</mtable><mo>]</mo></mrow>"

    def bracket(self, token: str, stretches: bool = False) -> str:
        if token not in "()[]":
            raise UnknownLatex(token)
        self.depth += 1 if token in "([" else -1
        return f"<mo>{token}</mo>" if stretches else f'<mo stretchy="false">{token}</mo>'

    def words(self) -> str:
        """Tell what stands in braces, as it is, escapes undone."""
        if self.next() != "{":
            raise UnknownLatex("no brace")
        found = ""
        while (token := self.next()) != "}":
            found += self.escaped(token) if token.startswith("\\") else token
        return found

    def escaped(self, token: str) -> str:
        if token in (r"\^", r"\~") and self.peek() == "{":
            self.next()
            self.next()
        return token[1:]


def _single_token(token: str) -> str:
    if token in SIGNS:
        return f"<mo>{SIGNS[token]}</mo>"
    if token in OTHER_SIGNS:
        return f"<mo>{OTHER_SIGNS[token]}</mo>"
    if token in FUNCTIONS:
        return f'<mi>{FUNCTIONS[token]}</mi><mspace width="0.17em"></mspace>'
    if token in LETTERS:
        return f"<mi>{LETTERS[token]}</mi>"
    if token == r"\circ":
        return "<mo>°</mo>"
    if token[0].isdigit():
        return f"<mn>{token}</mn>"
    if len(token) == 1 and token.isalpha():
        return f"<mi>{safe(token)}</mi>"
    raise UnknownLatex(token)


# Before these a browser may break a long equation; inside of a term it may not.
_BREAKS = tuple(f"<mo>{sign}</mo>" for sign in SIGNS.values())


def with_formulas(sentence: str, names: Collection[str] = ()) -> str:
    r"""Return a text as HTML, with the formulas in it as mathematics.

    A formula has "=" or "^" or a function. `names` are words that may follow a number or a letter, as in "2 arm".

    >>> with_formulas("It rises by 2 sqrt(L^2 - x^2).").partition("<math>")[0]
    'It rises by '
    >>> with_formulas("a = b, less than c").count("<math>"), with_formulas("x-axis, and/or 3 + 4 of them")
    (1, 'x-axis, and/or 3 + 4 of them')
    """
    parts: list[str] = []
    for text, is_formula in formulas_in(sentence, names):
        if not is_formula:
            parts.append(safe(text))
            continue
        try:
            parts.append(mathml(formula_latex(text), breaks=False))
        except UnknownLatex:
            parts.append(safe(text))
    return "".join(parts)
