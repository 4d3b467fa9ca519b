"""Simpler forms have the value of what they stand for: random arithmetic recorded, against NumPy's own."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from compoundkin.base.arrays import Number
from compoundkin.programs.backends import runner_of
from compoundkin.programs.graph.flat_program import BY_POSE, flat_program
from compoundkin.programs.graph.operation_graph import InputNumber, OperationGraph
from compoundkin.programs.recording.recorded_number import RecordedNumber
from tests.support import examples

# Neutral numbers, signs and powers of two among others.
NUMBERS = (0.0, 1.0, -1.0, 2.0, -0.5, 4.0, 0.3, -1.7)
STEPS = 40


def arithmetic(rng: np.random.Generator, start: list[Number]) -> list[Number]:
    """Do the same random steps on numbers of any kind, some of them taken again."""
    known: list[Number] = [*start, *NUMBERS]
    for _ in range(STEPS):
        a, b = (known[k] for k in rng.integers(0, len(known), 2))
        way = rng.integers(0, 9)
        if way < 6:
            known.append((a + b, a - b, a * b, b * a, -a, a * 0.5)[way])
        elif way == 6:
            known.append(np.sqrt(a * a + 1.0) * np.sqrt(a * a + 1.0) - b)
        elif way == 7:
            known.append(1.0 / (1.0 / (a * a + 2.0)))
        else:
            known.append(np.where(a > 0.0, a, 0.0) + np.where(a > 0.0, 0.0, b))
    return known[len(start) + len(NUMBERS) :]


@settings(max_examples=examples(25))
@given(st.integers(0, 2**32 - 1))
def test_what_is_recorded_is_what_is_computed(seed: int) -> None:
    x, y = values = np.random.default_rng(seed).uniform(-1.0, 1.0, (2, 7))
    expected = arithmetic(np.random.default_rng(seed), [x, y])
    graph = OperationGraph()
    inputs = [InputNumber("parameter", name) for name in "xy"]
    start = [RecordedNumber.given(graph, one) for one in inputs]
    found = [start[0].like(each) for each in arithmetic(np.random.default_rng(seed), list(start))]
    flat = flat_program(graph, [each.x for each in found], dict.fromkeys(inputs, BY_POSE))
    outputs = [np.empty(flat.shape(k, 1, 7)) for k in flat.outputs]
    read = [values[inputs.index(graph.nodes[k].given)][None] for k in flat.inputs]
    runner_of(flat, "numpy")(read, outputs, (1, 7))
    for own, value in zip(outputs, expected, strict=True):
        np.testing.assert_allclose(
            np.broadcast_to(own[0], 7), value, rtol=1e-10, atol=1e-12 * (1 + np.max(np.abs(value)))
        )
