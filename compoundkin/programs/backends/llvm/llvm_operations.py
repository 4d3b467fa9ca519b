"""The operations of programs as LLVM's instructions, one entry each; sines and cosines share their reduction."""

from __future__ import annotations

from collections.abc import Callable

from compoundkin.programs.backends.llvm.llvm_functions import arctangent, exponential, logarithm
from compoundkin.programs.backends.llvm.llvm_text import LaneText


def _extreme(how: str, keeps_none: bool) -> Callable[..., str]:
    """Return what writes the greater or the lesser of two; where either is no number, that or the other one."""

    def written(text: LaneText, a: str, b: str) -> str:
        found, doubtful = text.select(text.compare(how, a, b), a, b), a if keeps_none else b
        return text.select(text.compare("uno", doubtful, doubtful), a, found)

    return written


lesser, _greater = _extreme("olt", True), _extreme("ogt", True)
_lesser_number, _greater_number = _extreme("olt", False), _extreme("ogt", False)


def _two(instruction: str) -> Callable[..., str]:
    return lambda text, a, b: text.two(instruction, a, b)


def _call(function: str) -> Callable[..., str]:
    return lambda text, a: text.call(function, a)


def _compare(how: str) -> Callable[..., str]:
    return lambda text, a, b: text.compare(how, a, b)


# What is written for an operation, by its name; `sin` and `cos` are written by the section, which shares reductions.
INSTRUCTIONS: dict[str, Callable[..., str]] = {
    "add": _two("fadd"),
    "sub": _two("fsub"),
    "mul": _two("fmul"),
    "neg": lambda text, a: text.put(f"fneg {text.real} {a}"),
    "inv": lambda text, a: text.exact("fdiv", text.number(1.0), a),
    "sqrt": _call("sqrt"),
    "abs": _call("fabs"),
    "atan2": arctangent,
    "exp": exponential,
    "log": logarithm,
    "max": _greater,
    "min": lesser,
    "fmax": _greater_number,
    "fmin": _lesser_number,
    "floor": _call("floor"),
    "ceil": _call("ceil"),
    "rint": _call("rint"),
    "ge": _compare("oge"),
    "gt": _compare("ogt"),
    "eq": _compare("oeq"),
    "and": lambda text, a, b: text.truths("and", a, b),
    "or": lambda text, a, b: text.truths("or", a, b),
    "not": lambda text, a: text.put(f"xor {text.truth} {a}, {'true' if text.lanes == 1 else 'splat (i1 true)'}"),
    "select": lambda text, truth, one, other: text.select(truth, one, other),
}
# Which operands are truths: all of these, and the first of a choice.
ON_TRUTHS = {"and", "or", "not"}
