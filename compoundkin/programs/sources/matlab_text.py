"""Programs in MATLAB and Octave: one function file, whose arguments may be arrays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from compoundkin.programs.sources.spellings import (
    ARITHMETIC,
    ATOM,
    BOTH,
    EITHER,
    FACTOR,
    NOT,
    PRODUCT,
    QUOTIENT,
    Phrase,
    Spelling,
    call,
    calls,
    infix,
    number,
)
from compoundkin.programs.sources.statements import Statement, Statements, StatementWriter
from compoundkin.programs.sources.written_program import WrittenProgram, head_comment

# Functions that the text brings along: roots of negative numbers are complex there, its max leaves out what is not a
# number, and its round takes halves away from zero.
_OWN: Mapping[str, tuple[str, str, tuple[str, ...]]] = {
    "sqrt": ("root", "a", ("a(a < 0) = NaN;", "y = sqrt(a);")),
    "log": ("logarithm", "a", ("a(a < 0) = NaN;", "y = log(a);")),
    "max": ("greatest", "a, b", ("y = max(a, b);", "y(isnan(a) | isnan(b)) = NaN;")),
    "min": ("least", "a, b", ("y = min(a, b);", "y(isnan(a) | isnan(b)) = NaN;")),
    "rint": (
        "nearest",
        "a",
        ("y = round(a);", "halves = abs(a - fix(a)) == 0.5;", "y(halves) = 2*round(a(halves)/2);"),
    ),
    "select": (
        "choice",
        "truth, a, b",
        (
            "y = b + zeros(size(a + truth));",
            "a = a + zeros(size(y));",
            "truth = truth | false(size(y));",
            "y(truth) = a(truth);",
        ),
    ),
}
_SPELLED: Mapping[str, Spelling] = {
    **ARITHMETIC,
    **{operation: call(name, operands.count(",") + 1) for operation, (name, operands, _) in _OWN.items()},
    **calls({operation: operation for operation in ("abs", "sin", "cos", "exp", "floor", "ceil")}),
    **calls({"atan2": "atan2", "fmax": "max", "fmin": "min"}, 2),
    "mul": infix(".*", PRODUCT, FACTOR),
    "inv": Spelling("1.0./{}", PRODUCT, FACTOR),
    QUOTIENT: infix("./", PRODUCT, FACTOR),
    "and": infix(" & ", BOTH, NOT),
    "or": infix(" | ", EITHER, NOT),
    "not": Spelling("~{}", NOT, ATOM),
}


class MatlabLanguage:
    """MATLAB, as Octave takes it too."""

    name = "matlab"

    @staticmethod
    def text(program: WrittenProgram) -> str:
        """Return a function file."""
        statements = StatementWriter(program, _SPELLED, _number, ("false", "true")).written()
        body = tuple(_body(program, statements))
        return "\n".join((*_head(program), *body, *_functions(body), ""))


def _number(value: float) -> Phrase:
    return number(value, "NaN", "Inf")


def _head(program: WrittenProgram) -> Iterator[str]:
    use = f"Save it as {program.name}.m. It returns a structure; arguments may be arrays of poses."
    yield f"function out = {program.name}({', '.join(one.name for one in program.arguments)})"
    yield from (f"% {line}".rstrip() for line in head_comment(program, use))
    for k, one in enumerate(program.arguments):
        if one.own is not None:
            yield f"    if nargin < {k + 1}, {one.name} = {_number(one.own).text}; end"


def _body(program: WrittenProgram, statements: Statements) -> Iterator[str]:
    yield from statements.body(_line, lambda section: f"    % {section}")
    yield from ("", *map(_line, statements.whether), "    out.assembled = assembled;")
    for result, written in zip(program.results, statements.results, strict=True):
        shown = written.text if program.always else f"choice(assembled, {written.text}, NaN)"
        yield f"    out.{result.name} = {shown};"
    yield "end"


def _functions(body: tuple[str, ...]) -> Iterator[str]:
    for name, operands, lines in _OWN.values():
        if any(f"{name}(" in line for line in body):
            yield from ("", f"function y = {name}({operands})", *(f"    {line}" for line in lines), "end")


def _line(one: Statement) -> str:
    return f"    {one.name} = {one.expression};"
