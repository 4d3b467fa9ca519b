"""Problems of free dimensions, told by the argument that frees them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from compoundkin.base.errors import CompoundkinError, Problem

# The argument of `compile` that frees them, by which it tells their problems.
FREE = "free"


@contextmanager
def freed_by(argument: str) -> Iterator[None]:
    """Tell what is wrong with free dimensions by the argument that has them."""
    try:
        yield
    except CompoundkinError as error:
        raise type(error)([_placed(one, argument) for one in error.problems], error.heading) from None


def _placed(problem: Problem, argument: str) -> Problem:
    first, dot, name = problem.where.partition(".")
    return replace(problem, where=f"{argument}.{name}") if dot and first == FREE else problem
