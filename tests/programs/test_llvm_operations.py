"""Every operation as LLVM's code against NumPy: on numbers of all sizes, on what is none, on lanes and remainders."""

from __future__ import annotations

from itertools import product
from typing import Any

import mpmath
import numpy as np
import pytest

from compoundkin.programs.backends import runner_of
from compoundkin.programs.graph.flat_program import BY_POSE, FIXED_NUMBER, flat_program
from compoundkin.programs.graph.operation_graph import OPERATIONS, InputNumber, OperationGraph

pytest.importorskip("llvmlite")
SPECIAL = (
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    2.5,
    -3.5,
    np.inf,
    -np.inf,
    np.nan,
    5e-324,
    -1e-310,
    1e308,
    -1.7e308,
    1e-300,
    1e22,
)
# Within how many units in the last place; all others are exact.
ROUNDED = {"exp": 2, "log": 2, "atan2": 2}


def numbers() -> Any:
    """Pairs of special numbers, and of random ones of all sizes."""
    random = np.random.default_rng(4)
    sizes = random.normal(size=(2, 3001)) * 10.0 ** random.integers(-12, 12, (2, 3001))
    return np.hstack([np.array(list(product(SPECIAL, SPECIAL))).T, sizes, random.uniform(-800, 800, (2, 1000))])


def computed(operation: str, *operands: Any, stratum: int = BY_POSE) -> Any:
    """One operation on arrays; truths are given as comparisons with zero."""
    graph = OperationGraph()
    given = [InputNumber("parameter", str(k)) for k in range(len(operands))]
    nodes = [graph.input(each) for each in given]
    truths = {"and": 2, "or": 2, "not": 1, "select": 1}.get(operation, 0)
    zero = graph.constant(0.0)
    nodes = [graph.apply("gt", k, zero) if i < truths else k for i, k in enumerate(nodes)]
    program = flat_program(graph, [graph.apply(operation, *nodes)], dict.fromkeys(given, stratum))
    by_input = dict(zip(given, operands, strict=True))
    arrays = [by_input[graph.nodes[k].given][None] for k in program.inputs]  # type: ignore[index]
    out = np.full_like(arrays[0], -7.0)
    runner_of(program, "llvm")(arrays, [out], (1, arrays[0].shape[1]))
    return out[0]


@pytest.mark.parametrize("operation", sorted(set(OPERATIONS) - {"sin", "cos"}))
def test_each_operation_is_that_of_numpy(operation: str) -> None:
    a, b = numbers()
    operands = (a, b, -a)[: OPERATIONS[operation].operands]
    truths = {"and": 2, "or": 2, "not": 1, "select": 1}.get(operation, 0)
    with np.errstate(all="ignore"):
        expected = OPERATIONS[operation].compute(*(x > 0 if i < truths else x for i, x in enumerate(operands)))
    found, expected = computed(operation, *operands), np.asarray(expected, float)
    if operation in ROUNDED:
        number = np.isfinite(expected)
        np.testing.assert_array_equal(found[~number], expected[~number])
        np.testing.assert_array_max_ulp(found[number], expected[number], ROUNDED[operation])
    else:
        np.testing.assert_array_equal(found, expected)
    if operation not in ("max", "min", "fmax", "fmin"):  # of two zeros NumPy takes either
        sure = ~np.isnan(expected)
        np.testing.assert_array_equal(np.signbit(found[sure]), np.signbit(expected[sure]))


@pytest.mark.parametrize(("operation", "exact"), [("sin", mpmath.sin), ("cos", mpmath.cos)])
def test_sines_of_angles_of_any_size(operation: str, exact: Any) -> None:
    """Angles next to whole quarters of a turn as well, where the parts of pi/2 nearly cancel."""
    random = np.random.default_rng(1)
    quarters = np.round(10.0 ** random.uniform(0, 8.7, 300)) * (np.pi / 2)
    angles = np.concatenate(
        [random.uniform(-7, 7, 3000), random.uniform(-1e9, 1e9, 300), quarters, [0.0, -0.0, 5e-324]]
    )
    exactly = getattr(np, operation)(angles)
    assert np.max(np.abs(computed(operation, angles) - exactly)) < 2.3e-16
    few = np.concatenate([angles[:200], quarters[:100]])
    with mpmath.workdps(60):
        sure = [exact(mpmath.mpf(float(x))) for x in few]
        error = max(abs(mpmath.mpf(float(y)) - z) for y, z in zip(computed(operation, few), sure, strict=True))
    assert error < 1.25e-16
    for stratum in (BY_POSE, FIXED_NUMBER):
        large = np.array([3e9, -1e22, 1e308, np.inf, -np.inf, np.nan, 2.0, 1e9])
        large = large if stratum else large[2:3]
        with np.errstate(invalid="ignore"):
            expected = getattr(np, operation)(large)
        np.testing.assert_allclose(computed(operation, large, stratum=stratum), expected, rtol=0, atol=2.3e-16)


def test_directions_and_powers_against_many_digits() -> None:
    random = np.random.default_rng(2)
    y, x = random.normal(size=(2, 200)) * 10.0 ** random.integers(-3, 3, (2, 200))
    powers, sizes = random.uniform(-700, 700, 200), 10.0 ** random.uniform(-300, 300, 200)
    sizes[:100] = 1.0 + random.normal(size=100) * 1e-3
    with mpmath.workdps(40):
        for name, operands in (("atan2", (y, x)), ("exp", (powers,)), ("log", (sizes,))):
            found = computed(name, *operands)
            sure = [getattr(mpmath, name)(*map(mpmath.mpf, map(float, row))) for row in zip(*operands, strict=True)]
            error = max(abs((mpmath.mpf(float(f)) - s) / s) for f, s in zip(found, sure, strict=True))
            assert error < 2.3e-16, (name, error)
