"""Programs in C: C99 with math.h, and C++; one file with two structures and one function."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from compoundkin.programs.sources.spellings import ARITHMETIC, EITHER, OF_BRACES, Phrase, Spelling, call, calls, number
from compoundkin.programs.sources.statements import Statement, Statements, StatementWriter
from compoundkin.programs.sources.written_program import WrittenProgram, head_comment

# Functions that the text brings along, each for one operation: math.h has none that keep what is not a number.
_OWN: Mapping[str, tuple[str, str]] = {
    "max": ("greatest", "(double a, double b) { return a > b || a != a ? a : b; }"),
    "min": ("least", "(double a, double b) { return a < b || a != a ? a : b; }"),
}
_FROM_MATH = {"sqrt": "sqrt", "abs": "fabs", "sin": "sin", "cos": "cos", "exp": "exp", "log": "log"}
_ROUNDED = {"floor": "floor", "ceil": "ceil", "rint": "rint"}
_OF_TWO = {"atan2": "atan2", "fmax": "fmax", "fmin": "fmin"}


class CLanguage:
    """C, as C99 and C++ compilers take it."""

    name = "c"

    @staticmethod
    def text(program: WrittenProgram) -> str:
        """Return a file to compile, or to include."""
        statements = StatementWriter(program, _spelled(program.name), _number, ("0", "1")).written()
        return "\n".join((*_head(program), *_functions(program, statements), *_body(program, statements), *_FOOT, ""))


def _number(value: float) -> Phrase:
    return number(value, "NAN", "INFINITY")


def _spelled(name: str) -> dict[str, Spelling]:
    own = {operation: call(f"{name}_{function}", 2) for operation, (function, _) in _OWN.items()}
    return {**ARITHMETIC, **OF_BRACES, **calls({**_FROM_MATH, **_ROUNDED}), **calls(_OF_TWO, 2), **own}


_FOOT = ("", "#ifdef __cplusplus", "}", "#endif", "#endif")


def _head(program: WrittenProgram) -> Iterator[str]:
    name, guard = program.name, program.name.upper()
    yield from ("/*", *(f" * {line}".rstrip() for line in head_comment(program, _use(program))), " */")
    yield from (f"#ifndef {guard}_C", f"#define {guard}_C", "", "#include <math.h>", "")
    yield from ("#ifdef __cplusplus", 'extern "C" {', "#endif", "")
    yield from _structure(f"{name}_inputs", [f"double {one.name};" for one in program.arguments])
    yield from _structure(f"{name}_outputs", ["int assembled;", *(f"double {one.name};" for one in program.results)])
    yield "/* The inputs as the mechanism has them, for an initialiser; drivers as its own motion begins. */"
    own = ", ".join(_number(one.start).text for one in program.arguments)
    yield from (f"#define {guard}_OWN {{{own or '0.0'}}}", "")
    yield f"int {name}(const {name}_inputs *in, {name}_outputs *out);"


def _use(program: WrittenProgram) -> str:
    return (
        "It returns whether the mechanism can be assembled. Compile this file on its own, or include it; with "
        f"{program.name.upper()}_DECLARED defined, including it only declares the function."
    )


def _structure(name: str, members: list[str]) -> list[str]:
    # C has no structure without members
    return ["typedef struct {", *(f"    {one}" for one in members or ["double unused;"]), f"}} {name};", ""]


def _functions(program: WrittenProgram, statements: Statements) -> Iterator[str]:
    yield from ("", f"#ifndef {program.name.upper()}_DECLARED")
    for function, text in _OWN.values():
        if statements.calls(name := f"{program.name}_{function}"):
            yield from ("", f"static double {name}{text}")


def _body(program: WrittenProgram, statements: Statements) -> Iterator[str]:
    name = program.name
    yield from ("", f"int {name}(const {name}_inputs *in, {name}_outputs *out)", "{")
    yield from (f"    const double {one.name} = in->{one.name};" for one in program.read)
    if not program.read:
        yield "    (void)in;"
    yield from statements.body(_line, lambda section: f"    /* {section} */")
    yield from ("", *map(_line, statements.whether), "    out->assembled = assembled;")
    for result, written in zip(program.results, statements.results, strict=True):
        shown = written.text if program.always else f"assembled ? {written.within(EITHER)} : NAN"
        yield f"    out->{result.name} = {shown};"
    yield from ("    return assembled;", "}", "#endif")


def _line(one: Statement) -> str:
    return f"    const {'int' if one.is_truth else 'double'} {one.name} = {one.expression};"
