"""The operations that a program is made of, on real numbers and on truths, and how NumPy computes each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Operation:
    """One operation.

    How many operands it has, how NumPy computes it, and whether it answers true or false. Truths are held as booleans
    by NumPy; other back ends choose.
    """

    name: str
    operands: int
    compute: Callable[..., Any]
    is_truth: bool = False
    is_commutative: bool = False


def _reciprocal(x: Any, out: Any = None) -> Any:
    return np.divide(1.0, x, out=out)


def _select(truth: Any, one: Any, other: Any, out: Any = None) -> Any:
    if out is None:
        return np.where(truth, one, other)
    np.copyto(out, other)
    np.copyto(out, one, where=truth)
    return out


# The registry: what is not listed here cannot be recorded.
OPERATIONS: dict[str, Operation] = {
    one.name: one
    for one in (
        Operation("add", 2, np.add, is_commutative=True),
        Operation("sub", 2, np.subtract),
        Operation("mul", 2, np.multiply, is_commutative=True),
        Operation("neg", 1, np.negative),
        Operation("inv", 1, _reciprocal),
        Operation("sqrt", 1, np.sqrt),
        Operation("abs", 1, np.abs),
        Operation("sin", 1, np.sin),
        Operation("cos", 1, np.cos),
        Operation("atan2", 2, np.arctan2),
        Operation("exp", 1, np.exp),
        Operation("log", 1, np.log),
        # NumPy's maximum and minimum keep a NaN; fmin and fmax leave it out where the other operand is a number
        Operation("max", 2, np.maximum, is_commutative=True),
        Operation("min", 2, np.minimum, is_commutative=True),
        Operation("fmax", 2, np.fmax, is_commutative=True),
        Operation("fmin", 2, np.fmin, is_commutative=True),
        Operation("floor", 1, np.floor),
        Operation("ceil", 1, np.ceil),
        Operation("rint", 1, np.rint),
        Operation("ge", 2, np.greater_equal, is_truth=True),
        Operation("gt", 2, np.greater, is_truth=True),
        Operation("eq", 2, np.equal, is_truth=True, is_commutative=True),
        Operation("and", 2, np.logical_and, is_truth=True, is_commutative=True),
        Operation("or", 2, np.logical_or, is_truth=True, is_commutative=True),
        Operation("not", 1, np.logical_not, is_truth=True),
        Operation("select", 3, _select),
    )
}

# Reductions over the poses of a design: what comes out is fixed by the design. The least keeps a NaN.
TOTAL, LEAST = "total", "least"
REDUCTIONS: dict[str, Callable[..., Any]] = {TOTAL: np.add.reduce, LEAST: np.minimum.reduce}
# Leaves: a number, a number given at each call.
CONSTANT, INPUT = "constant", "input"
