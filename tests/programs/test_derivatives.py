"""Tangents and adjoints of graphs against differences in long doubles, and against each other."""

import numpy as np
import pytest

from compoundkin.programs.backends.tape_backend import Tape
from compoundkin.programs.derivatives.differentiation import SLOPE_RULES, forward, reverse, slopes
from compoundkin.programs.graph.flat_program import BY_BOTH, BY_DESIGN, BY_POSE, FIXED_NUMBER, flat_program
from compoundkin.programs.graph.operation_graph import CONSTANT, OPERATIONS, TOTAL, InputNumber, OperationGraph

SHAPE = (3, 5)
ROWS = {FIXED_NUMBER: (1, 1), BY_DESIGN: (3, 1), BY_POSE: (1, 5), BY_BOTH: SHAPE}


def in_long_doubles(graph, wanted, values):
    """Compute nodes operation by operation, at more digits than a program has."""
    found = dict(values)
    for k in graph.needed(wanted):
        node = graph.nodes[k]
        if node.operation == CONSTANT:
            found[k] = np.longdouble(node.value)
        elif node.operation == TOTAL:
            found[k] = np.broadcast_to(found[node.operands[0]], SHAPE).sum(axis=1, keepdims=True)
        elif k not in found:
            found[k] = OPERATIONS[node.operation].compute(*(found[n] for n in node.operands))
    return [found[k] for k in wanted]


def grown(rng, size=60):
    """A random graph of every operation on inputs of every stratum: its inputs and the total of its last node."""
    graph = OperationGraph()
    given = {InputNumber("parameter", f"p{k}"): k % 4 for k in range(8)}
    inputs = [graph.input(each) for each in given]
    real, truth = [*inputs, graph.constant(0.7)], []

    def put(operation, *operands):
        return graph.apply(operation, *operands)

    def small(node):  # keeps numbers near 1, away from poles
        return put("sin", node)

    one = graph.constant(1.0)
    names = list(OPERATIONS)
    for k in range(size):
        name = names[k % len(names)]
        a, b = (real[int(j)] for j in rng.integers(max(0, len(real) - 12), len(real), 2))
        above = put("add", one, put("mul", a, a))
        if OPERATIONS[name].is_truth:
            if name in ("ge", "gt", "eq"):
                truth.append(put(name, a, b))
            else:
                truth.append(
                    put(name, *(truth[int(j)] for j in rng.integers(0, len(truth), OPERATIONS[name].operands)))
                )
        elif name == "select":
            real.append(put(name, truth[-1], a, b))
        elif name in ("inv", "sqrt", "log"):
            real.append(put(name, above))
        elif name == "atan2":
            real.append(put(name, a, above))
        else:
            real.append(put(name, *(small(n) if name == "exp" else n for n in (a, b)[: OPERATIONS[name].operands])))
        real[-1] = small(real[-1])
    sums = real[-1]
    for k, given_number in zip(real[-9:-1], inputs, strict=True):
        sums = put("add", sums, put("mul", k, small(given_number)))
    return graph, inputs, given, put(TOTAL, sums)


def on_the_tape(graph, wanted, given, values):
    program = flat_program(graph, wanted, given)
    out = [np.empty(program.shape(k, *SHAPE)) for k in wanted]
    Tape().runner(program)([values[k] for k in program.inputs], out, SHAPE)
    return out


@pytest.mark.parametrize("seed", range(6))
def test_a_random_graph_has_the_slopes_of_differences(seed):
    """Reverse equals forward to 1e-12 and differences in long doubles to 1e-9, for inputs of every stratum."""
    rng = np.random.default_rng(seed)
    graph, inputs, given, root = grown(rng)
    values = {k: rng.normal(size=ROWS[s]) for k, s in zip(inputs, given.values(), strict=True)}
    backward = on_the_tape(graph, reverse(graph, root, inputs, given), given, values)
    onward = on_the_tape(graph, [forward(graph, [root], {k: 1.0})[0] for k in inputs], given, values)
    long = {k: v.astype(np.longdouble) for k, v in values.items()}
    for k, slope, rate in zip(inputs, backward, onward, strict=True):
        whole = np.broadcast_to(slope, np.broadcast_shapes(slope.shape, (3, 1))).sum(axis=1, keepdims=True)
        np.testing.assert_allclose(whole, np.broadcast_to(rate, (3, 1)), rtol=1e-12, atol=1e-12)
        h = np.longdouble(1e-6)
        ends = [in_long_doubles(graph, [root], {**long, k: long[k] + d})[0] for d in (h, -h)]
        np.testing.assert_allclose(
            np.broadcast_to((ends[0] - ends[1]) / (2.0 * h), (3, 1)).astype(float), whole, rtol=1e-8, atol=1e-8
        )


def test_the_slope_by_what_the_pose_gives_is_that_of_each_pose():
    """A number that varies from pose to pose has a slope at each, for each design."""
    rng = np.random.default_rng(9)
    graph, inputs, given, root = grown(rng)
    values = {k: rng.normal(size=ROWS[s]) for k, s in zip(inputs, given.values(), strict=True)}
    (drive,) = [k for k in inputs[:4] if given[graph.nodes[k].given] == BY_POSE]
    (found,) = on_the_tape(graph, reverse(graph, root, [drive], given), given, values)
    assert found.shape == SHAPE
    long, h = {k: v.astype(np.longdouble) for k, v in values.items()}, np.longdouble(1e-6)
    for j in range(5):
        step = h * (np.arange(5) == j)
        ends = [in_long_doubles(graph, [root], {**long, drive: long[drive] + d})[0] for d in (step, -step)]
        np.testing.assert_allclose(((ends[0] - ends[1])[:, 0] / (2.0 * h)).astype(float), found[:, j], 1e-8, 1e-8)


def test_every_operation_has_a_slope_rule():
    """What can be recorded has derivatives; a truth has none."""
    assert set(SLOPE_RULES) == set(OPERATIONS)
    graph = OperationGraph()
    x = [graph.input(InputNumber("parameter", str(k))) for k in range(3)]
    for name, operation in OPERATIONS.items():
        if operation.is_truth:
            assert slopes(graph, graph.apply(name, *x[: operation.operands])) == []


def test_a_guard_has_the_slope_of_what_it_guards():
    """Beside the limit, where rounding has made a discriminant negative, its slope is still its own."""
    graph = OperationGraph()
    given = {InputNumber("parameter", "d"): BY_BOTH}
    d = graph.input(next(iter(given)))
    margin = graph.apply("add", d, graph.constant(1e-13))
    clipped = graph.apply("max", d, graph.constant(0.0))
    guard = graph.apply("select", graph.apply("ge", margin, graph.constant(0.0)), clipped, graph.constant(float("nan")))
    assert forward(graph, [guard], {d: 1.0}) == [graph.constant(1.0)]
    assert reverse(graph, graph.apply(TOTAL, guard), [d], given) == [graph.constant(1.0)]


def test_what_does_not_depend_on_an_input_has_the_slope_zero():
    """Dead directions are constants, so that nothing is computed for them."""
    graph = OperationGraph()
    given = {InputNumber("parameter", name): BY_DESIGN for name in "xy"}
    x, y = (graph.input(each) for each in given)
    root = graph.apply(TOTAL, graph.apply("sin", x))
    assert reverse(graph, root, [y], given) == forward(graph, [root], {y: 1.0}) == [graph.constant(0.0)]
