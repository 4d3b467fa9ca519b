"""Programs in Python: one file that needs the module `math` only."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from compoundkin.programs.sources.spellings import (
    ARITHMETIC,
    BOTH,
    CHOICE,
    EITHER,
    NOT,
    QUOTIENT,
    Phrase,
    Spelling,
    call,
    calls,
    infix,
    number,
)
from compoundkin.programs.sources.statements import Statement, Statements, StatementWriter
from compoundkin.programs.sources.written_program import Argument, WrittenProgram, head_comment

# Functions that the text brings along: those of `math` raise errors where others answer what is not a number.
_OF_ONE: Mapping[str, tuple[str, str]] = {
    "sqrt": ("_root", "math.sqrt(a) if a >= 0.0 else math.nan"),
    "sin": ("_sine", "math.sin(a) if abs(a) < math.inf else math.nan"),
    "cos": ("_cosine", "math.cos(a) if abs(a) < math.inf else math.nan"),
    "exp": ("_power", "math.exp(a) if a < 709.782712893384 else a + math.inf"),
    "log": ("_logarithm", "math.log(a) if a > 0.0 else -math.inf if a == 0.0 else math.nan"),
    "floor": ("_floor", "float(math.floor(a)) if abs(a) < math.inf else a"),
    "ceil": ("_ceil", "float(math.ceil(a)) if abs(a) < math.inf else a"),
    "rint": ("_nearest", "float(round(a)) if abs(a) < math.inf else a"),
}
_OF_TWO: Mapping[str, tuple[str, str]] = {
    "max": ("_greatest", "a if a > b or a != a else b"),
    "min": ("_least", "a if a < b or a != a else b"),
    "fmax": ("_greater", "a if a >= b or b != b else b"),
    "fmin": ("_lesser", "a if a <= b or b != b else b"),
    QUOTIENT: (
        "_quotient",
        "a / b if b != 0.0 else math.nan if a == 0.0 else a * math.copysign(math.inf, b)",
    ),
}
_SPELLED: Mapping[str, Spelling] = {
    **ARITHMETIC,
    **calls({operation: name for operation, (name, _) in _OF_ONE.items()}),
    **calls({operation: name for operation, (name, _) in _OF_TWO.items()}, 2),
    "inv": Spelling("_quotient(1.0, {})"),
    "abs": call("abs"),
    "atan2": call("math.atan2", 2),
    "and": infix(" and ", BOTH, NOT),
    "or": infix(" or ", EITHER, NOT),
    "not": Spelling("not {}", NOT, NOT),
    "select": Spelling("{1} if {0} else {2}", CHOICE, EITHER),
}


class PythonLanguage:
    """Python without NumPy."""

    name = "python"

    @staticmethod
    def text(program: WrittenProgram) -> str:
        """Return a module."""
        statements = StatementWriter(program, _SPELLED, _number, ("False", "True")).written()
        return "\n".join((*_head(program), *_functions(statements), *_body(program, statements), ""))


def _number(value: float) -> Phrase:
    return number(value, "math.nan", "math.inf")


def _head(program: WrittenProgram) -> Iterator[str]:
    first, *others = head_comment(program, "It returns a dictionary.")
    yield from (f'"""{first}', *others, '"""', "", "import math", "")


def _functions(statements: Statements) -> Iterator[str]:
    for table, operands in ((_OF_ONE, "a"), (_OF_TWO, "a, b")):
        for function, text in table.values():
            if statements.calls(function):
                yield from ("", f"def {function}({operands}):", f"    return {text}", "")


def _body(program: WrittenProgram, statements: Statements) -> Iterator[str]:
    yield from ("", f"def {program.name}({_parameters(program.arguments)}):", '    """Compute one pose."""')
    yield from statements.body(_line, lambda section: f"    # {section}")
    yield from ("", *map(_line, statements.whether), "    return {", '        "assembled": assembled,')
    for result, written in zip(program.results, statements.results, strict=True):
        shown = written.text if program.always else f"{written.within(EITHER)} if assembled else math.nan"
        yield f'        "{result.name}": {shown},'
    yield "    }"


def _parameters(arguments: tuple[Argument, ...]) -> str:
    """The parameters; from the first one that may be left out they are told by name."""
    told: list[str] = []
    for one in arguments:
        if one.own is not None and "*" not in told:
            told.append("*")
        told.append(one.name if one.own is None else f"{one.name}={_number(one.own).text}")
    return ", ".join(told)


def _line(one: Statement) -> str:
    return f"    {one.name} = {one.expression}"
