"""The tape against every operation computed plainly: any strata, reductions, marches, layouts of blocks, threads."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from compoundkin.programs.backends import tape_backend
from compoundkin.programs.backends.tape_backend import Tape
from compoundkin.programs.graph.flat_program import BY_BOTH, BY_DESIGN, BY_POSE, FIXED_NUMBER, Carried, flat_program
from compoundkin.programs.graph.operation_graph import (
    CONSTANT,
    INPUT,
    OPERATIONS,
    REDUCTIONS,
    InputNumber,
    OperationGraph,
)
from compoundkin.programs.recording.recorded_number import RecordedNumber
from tests.benchmarks import six_bar

STRATA = (FIXED_NUMBER, BY_DESIGN, BY_POSE, BY_BOTH)


def plain(graph: OperationGraph, outputs: list[int], given: dict[int, Any], shape: tuple[int, int]) -> list[Any]:
    """Every operation on whole arrays, the sums of all poses as NumPy takes them."""
    values: dict[int, Any] = {}
    with np.errstate(all="ignore"):
        for k in graph.needed(outputs):
            node = graph.nodes[k]
            operands = [values[n] for n in node.operands]
            if node.operation == INPUT:
                values[k] = given[k]
            elif node.operation == CONSTANT:
                values[k] = np.full((1, 1), node.value)
            elif node.operation in REDUCTIONS:
                whole = np.broadcast_to(operands[0], shape).astype(float)
                values[k] = REDUCTIONS[node.operation](whole, axis=1, keepdims=True)
            else:
                logical = node.operation in ("select", "and", "or", "not")
                values[k] = OPERATIONS[node.operation].compute(*(x if logical else x.astype(float) for x in operands))
    return [values[k] for k in outputs]


def program_of_everything(seed: int, times: int = 6) -> tuple[OperationGraph, dict[InputNumber, int], list[int]]:
    """A graph of all operations on values of all strata, with reductions and what depends on them."""
    random, graph = np.random.default_rng(seed), OperationGraph()
    given = {InputNumber("parameter", f"{n}"): STRATA[n % 4] for n in range(8)}
    numbers, truths = [graph.input(each) for each in given], []
    for name in [name for name in OPERATIONS for _ in range(times)]:
        operands = [int(k) for k in random.choice(numbers[:2] + numbers[-30:], OPERATIONS[name].operands)]
        if name in ("and", "or", "not"):
            operands = [int(k) for k in random.choice(truths, OPERATIONS[name].operands)]
        elif name == "select":
            operands[0] = int(random.choice(truths))
        made = graph.apply(name, *operands)
        (truths if graph.is_truth(made) else numbers).append(made)
    thrice = [graph.apply("mul", angle, graph.constant(3.0)) for angle in numbers[:4]]
    turned = [graph.apply(name, angle) for angle in thrice for name in ("cos", "sin")]
    sums = [graph.apply("total", k) for k in (*numbers[:4], truths[0], truths[-1], graph.constant(0.3), *turned)]
    least = [graph.apply("least", k) for k in (*numbers[:4], *turned)]
    late = graph.apply("sqrt", graph.apply("add", graph.apply("mul", sums[3], sums[3]), numbers[1]))
    return graph, given, [*numbers, *truths, *turned, *sums, *least, late, late]


def arrays(given: dict[InputNumber, int], shape: tuple[int, int], seed: int) -> list[Any]:
    random = np.random.default_rng(seed)
    return [random.uniform(0.2, 2.0, size(stratum, shape)) for stratum in given.values()]


def size(stratum: int, shape: tuple[int, int]) -> tuple[int, int]:
    return shape[0] if stratum & BY_DESIGN else 1, shape[1] if stratum & BY_POSE else 1


@pytest.mark.parametrize("shape", [(1, 1), (1, 2500), (700, 1), (5, 3), (40, 1100), (3, 2100)])
def test_every_operation_in_every_stratum(shape: tuple[int, int]) -> None:
    graph, given, outputs = program_of_everything(7)
    program = flat_program(graph, outputs, given)
    values = dict(zip((graph.input(each) for each in given), arrays(given, shape, 5), strict=True))
    found = [np.full(program.shape(k, *shape), -7.0) for k in outputs]
    runner = Tape().runner(program)
    for _ in range(2):  # rows are used again
        runner([values[k] for k in program.inputs], found, shape)
    for k, ours, theirs in zip(outputs, found, plain(graph, outputs, values, shape), strict=True):
        theirs = np.broadcast_to(theirs, ours.shape)
        np.testing.assert_allclose(ours, theirs, rtol=1e-11, atol=1e-12, err_msg=str(graph.nodes[k]))


@pytest.mark.parametrize("shape", [(1, 9000), (37, 500), (900, 7), (2, 5000)])
def test_blocks_and_threads_change_no_bit(shape: tuple[int, int], monkeypatch: pytest.MonkeyPatch) -> None:
    graph, given, outputs = program_of_everything(3)
    program = flat_program(graph, outputs, given)
    values = dict(zip((graph.input(each) for each in given), arrays(given, shape, 2), strict=True))
    monkeypatch.setattr(tape_backend, "NUMBERS_PER_THREAD", 1)
    found = []
    for block, threads in ((8192, 1), (2048, 1), (1024, 3), (100_000, 2)):
        monkeypatch.setattr(tape_backend, "BLOCK_SIZE", block)
        found.append([np.empty(program.shape(k, *shape)) for k in outputs])
        Tape().runner(program)([values[k] for k in program.inputs], found[-1], shape, threads)
    for other in found[1:]:
        for one, two in zip(found[0], other, strict=True):
            np.testing.assert_array_equal(one, two)


def test_the_six_bar_written_by_hand(monkeypatch: pytest.MonkeyPatch) -> None:
    """Recorded from the same text; results go into the parts of complex arrays, and into every second place."""
    graph, crank = OperationGraph(), InputNumber("drive", "crank", "0")
    recorded = six_bar.by_hand(RecordedNumber.given(graph, crank))
    angles = np.linspace(-7.0, 7.0, 20_001)
    names = [(name, order) for name in six_bar.POINTS for order in range(3)]
    outputs = [part for name, order in names for part in (recorded[name][order].x, recorded[name][order].y)]
    found = np.full((len(names), 1, 2 * len(angles)), np.nan, complex)[:, :, ::2]
    runner = Tape().runner(flat_program(graph, outputs, {crank: BY_POSE}))
    runner([angles[None, ::-1][:, ::-1]], [part for z in found for part in (z.real, z.imag)], (1, len(angles)))
    for (name, order), ours in zip(names, found, strict=True):
        theirs = six_bar.by_hand(angles)[name][order]
        assert np.max(np.abs(ours[0] - theirs)) < 1e-13 * np.max(np.abs(theirs)), (name, order)


@pytest.mark.parametrize("shape", [(1, 6), (600, 40), (3, 1100), (4, 1)])
def test_a_march_carries_numbers_from_pose_to_pose(shape: tuple[int, int], monkeypatch: pytest.MonkeyPatch) -> None:
    """Fibonacci's recursion with a drift that varies by pose: two numbers carried, one of them the other's past."""
    graph = OperationGraph()
    x, y, start, drift, share = (
        graph.input(InputNumber("seed", name)) for name in ("x", "y", "start", "drift", "share")
    )
    half = graph.constant(0.5)
    new = graph.apply("mul", graph.apply("add", graph.apply("add", x, y), graph.apply("mul", drift, drift)), half)
    cosine = graph.apply("cos", new)
    outputs = [new, x, cosine, graph.apply("total", new), graph.apply("least", graph.apply("add", new, share))]
    given = {graph.nodes[k].given: s for k, s in zip((x, y, start, drift, share), (3, 3, 1, 2, 3), strict=True)}
    carried = [Carried(x, start, new), Carried(y, half, x)]
    program = flat_program(graph, outputs, given, carried)  # type: ignore[arg-type]
    random = np.random.default_rng(0)
    first, drifts, shares = random.random((shape[0], 1)), random.random((1, shape[1])), random.random(shape)
    given_arrays = {start: first, drift: drifts, share: shares}
    expected, now, before = np.empty((2, *shape)), first[:, 0], np.full(shape[0], 0.5)
    for k in range(shape[1]):
        expected[1, :, k] = now
        now, before = (now + before + drifts[0, k] ** 2) / 2, now
        expected[0, :, k] = now
    monkeypatch.setattr(tape_backend, "NUMBERS_PER_THREAD", 1)
    for threads in (1, 2):
        found = [np.empty(program.shape(k, *shape)) for k in outputs]
        Tape().runner(program)([given_arrays[k] for k in program.given], found, shape, threads)
        np.testing.assert_allclose(found[:3], [*expected, np.cos(expected[0])], rtol=1e-13)
        np.testing.assert_allclose(found[3], expected[0].sum(1, keepdims=True), rtol=1e-13)
        np.testing.assert_allclose(found[4], (expected[0] + shares).min(1, keepdims=True), rtol=1e-13)


def test_the_least_keeps_what_is_no_number() -> None:
    graph, x = OperationGraph(), InputNumber("drive", "crank", "0")
    outputs = [graph.apply("least", graph.apply("sqrt", graph.input(x)))]
    program = flat_program(graph, outputs, {x: BY_BOTH})
    given = np.linspace(0.0, 1.0, 5000) + np.zeros((3, 1))
    given[1, 3210] = -1e-3
    found = np.empty((3, 1))
    Tape().runner(program)([given], [found], given.shape)
    np.testing.assert_array_equal(found, [[0.0], [np.nan], [0.0]])
