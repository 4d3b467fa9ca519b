"""The least of a value, taken of its parts: the same as of the whole, and no number where a part is none."""

from __future__ import annotations

import numpy as np

from compoundkin.programs.backends import runner_of
from compoundkin.programs.graph.flat_program import BY_BOTH, flat_program
from compoundkin.programs.graph.operation_graph import InputNumber, OperationGraph
from compoundkin.programs.recording.recorded_limits import least_value


def test_the_least_of_parts_is_that_of_the_whole() -> None:
    graph, names = OperationGraph(), [InputNumber("drive", name) for name in "ab"]
    put, (a, b) = graph.apply, map(graph.input, names)
    shifted = put("sub", put("mul", graph.constant(0.3), put("sqrt", b)), graph.constant(0.1))
    turned = put("sub", graph.constant(1.0), put("mul", graph.constant(-2.0), a))  # falls, or grows: not taken apart
    whole = put("min", put("fmin", a, shifted), put("min", put("cos", turned), graph.constant(0.9)))
    outputs = [put("least", whole), least_value(graph, whole), least_value(graph, graph.constant(2.0))]
    values = np.random.default_rng(0).uniform(0.5, 9.0, (2, 40, 50))
    values[0, 3, 7], values[1, 5, 9] = np.nan, -1.0
    found = [np.empty((40, 1)) for _ in outputs]
    program = flat_program(graph, outputs, dict.fromkeys(names, BY_BOTH))
    runner_of(program, "numpy")(
        [values["ab".index(graph.nodes[k].given.name)] for k in program.inputs], found, (40, 50)
    )  # type: ignore[union-attr]
    assert np.all(np.isnan(found[1][[3, 5]]))
    found[0][[3, 5]] = found[1][[3, 5]] = 0.0  # `fmin` of the whole leaves out what is no number
    np.testing.assert_allclose(found[1], found[0], rtol=1e-15)
    assert np.all(found[2] == 2.0)
