"""Programs in JavaScript: one plain function, for pages as for Node."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from compoundkin.programs.sources.spellings import ARITHMETIC, EITHER, OF_BRACES, Phrase, Spelling, calls, number
from compoundkin.programs.sources.statements import Statement, Statements, StatementWriter
from compoundkin.programs.sources.written_program import Argument, WrittenProgram, head_comment

# Functions that the text brings along: Math.round takes halves upwards, Math.max keeps what is not a number.
_OWN: Mapping[str, tuple[str, str]] = {
    "fmax": ("greater", "(a, b) => (a >= b || b !== b ? a : b)"),
    "fmin": ("lesser", "(a, b) => (a <= b || b !== b ? a : b)"),
    "rint": ("nearest", "(a) => (Math.abs(a % 1.0) === 0.5 ? 2.0 * Math.round(a / 2.0) : Math.round(a))"),
}
_OF_ONE = ("sqrt", "abs", "sin", "cos", "exp", "log", "floor", "ceil")
_SPELLED: Mapping[str, Spelling] = {
    **ARITHMETIC,
    **OF_BRACES,
    **calls({operation: f"Math.{operation}" for operation in _OF_ONE}),
    **calls({operation: f"Math.{operation}" for operation in ("atan2", "max", "min")}, 2),
    **calls({operation: _OWN[operation][0] for operation in ("fmax", "fmin")}, 2),
    **calls({"rint": _OWN["rint"][0]}),
}


class JavaScriptLanguage:
    """JavaScript as all browsers take it."""

    name = "javascript"

    @staticmethod
    def text(program: WrittenProgram) -> str:
        """Return a script; Node may require it too."""
        statements = StatementWriter(program, _SPELLED, _number, ("false", "true")).written()
        return "\n".join((*_head(program), *_functions(statements), *_body(program, statements), *_foot(program), ""))


def _number(value: float) -> Phrase:
    return number(value, "NaN", "Infinity")


def _head(program: WrittenProgram) -> Iterator[str]:
    use = "It takes one object and returns another, whose properties have these names."
    yield from ("/*", *(f" * {line}".rstrip() for line in head_comment(program, use)), " */")
    told = ", ".join(map(_parameter, program.arguments))
    yield f"function {program.name}({{{f' {told} ' if told else ''}}}) {{"


def _parameter(one: Argument) -> str:
    return one.name if one.own is None else f"{one.name} = {_number(one.own).text}"


def _functions(statements: Statements) -> Iterator[str]:
    for function, text in _OWN.values():
        if statements.calls(function):
            yield f"    const {function} = {text};"


def _body(program: WrittenProgram, statements: Statements) -> Iterator[str]:
    yield from statements.body(_line, lambda section: f"    // {section}")
    yield from ("", *map(_line, statements.whether), "    return {", "        assembled,")
    for result, written in zip(program.results, statements.results, strict=True):
        shown = written.text if program.always else f"assembled ? {written.within(EITHER)} : NaN"
        yield f"        {result.name}: {shown},"
    yield from ("    };", "}")


def _foot(program: WrittenProgram) -> tuple[str, ...]:
    return ("", f'if (typeof module !== "undefined") module.exports = {program.name};')


def _line(one: Statement) -> str:
    return f"    const {one.name} = {one.expression};"
