"""Texts of programs: each operation, random graphs and what names may be, in every language against the tape."""

from __future__ import annotations

import keyword
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compoundkin.base.arrays import Number
from compoundkin.programs.backends.tape_backend import TapeRunner
from compoundkin.programs.graph.flat_program import BY_POSE, flat_program
from compoundkin.programs.graph.operation_graph import OPERATIONS, InputNumber, OperationGraph
from compoundkin.programs.sources import LANGUAGES
from compoundkin.programs.sources.statements import RESERVED, Identifiers, identifier, reading_order
from compoundkin.programs.sources.written_program import Argument, Result, WrittenProgram
from tests.programs.languages import assert_alike, run

# What may go wrong at an operation: signs, zeros, halves, numbers beyond integers, and what is no number.
EDGES = np.array([0.0, -0.0, 0.5, -0.5, 1.5, -2.5, 0.49999999999999994, 1.0, -1.0, 3.7, 1e-310, 710.0, -750.0, 1e18,
                  1e18 + 2048, 5e300, np.inf, -np.inf, np.nan])  # fmt: skip
EXACT = (
    "add",
    "sub",
    "mul",
    "neg",
    "inv",
    "sqrt",
    "abs",
    "max",
    "min",
    "fmax",
    "fmin",
    "floor",
    "rint",
    "ge",
    "select",
)


def by_tape(program: WrittenProgram, poses: Number) -> Number:
    """What the tape computes: (assembled, *results) x poses, masked where it is not assembled."""
    wanted = [program.assembled, *(one.node for one in program.results)]
    flat = flat_program(program.graph, wanted, {one.given: BY_POSE for one in program.arguments})
    rows = dict(zip([one.given for one in program.arguments], poses, strict=True))
    given = [rows[program.graph.nodes[k].given][None, :] for k in flat.inputs]
    count = poses.shape[1]
    out = [np.empty(flat.shape(k, 1, count)) for k in flat.outputs]
    TapeRunner(flat)(given, out, (1, count))
    found = np.array([np.broadcast_to(row, (1, count))[0] for row in out])
    found[1:, found[0] == 0.0] = np.nan
    return found


def given_numbers(graph: OperationGraph, count: int) -> tuple[list[int], tuple[Argument, ...]]:
    numbers = [InputNumber("drive", f"x{k}", "0") for k in range(count)]
    return [graph.input(one) for one in numbers], tuple(
        Argument(one, one.name, f"number {one.name}") for one in numbers
    )


def of_one_operation(name: str) -> WrittenProgram:
    graph = OperationGraph()
    nodes, arguments = given_numbers(graph, OPERATIONS[name].operands)
    if name in ("and", "or", "not", "select"):
        truths = [graph.apply("gt", node, graph.constant(0.5)) for node in nodes]
        nodes = [truths[0], *(nodes[1:] if name == "select" else truths[1:])]
    made = graph.apply(name, *nodes)
    return WrittenProgram(f"only_{name}", name, graph, arguments, (Result(made, "y", name),), graph.constant(1.0))


def random_program(seed: int) -> WrittenProgram:
    """Exact operations put together at random, some used often, with numbers of 17 digits and of all signs."""
    random = np.random.default_rng(seed)
    graph = OperationGraph()
    numbers, arguments = given_numbers(graph, 3)
    numbers += [graph.constant(value) for value in (np.pi, -1.0 / 3.0, 2.0, 1e-3)]
    for _ in range(int(random.integers(20, 120))):
        name = str(random.choice(EXACT))
        picked = [numbers[int(len(numbers) * random.uniform() ** 0.5)] for _ in range(OPERATIONS[name].operands)]
        if name == "ge" or name == "select":
            truth = graph.apply("ge", *picked[:2])
            truth = graph.apply(
                "or", truth, graph.apply("not", graph.apply("and", truth, graph.apply("gt", numbers[0], picked[0])))
            )
            numbers.append(graph.apply("select", truth, picked[0], numbers[-1]))
        else:
            numbers.append(graph.apply(name, *picked))
    results = tuple(Result(node, f"y{k}", f"result {k}") for k, node in enumerate(numbers[-6:]))
    assembled = graph.apply("gt", numbers[0], graph.constant(-0.7))
    return WrittenProgram(f"random_{seed}", "At random", graph, arguments, results, assembled)


@pytest.mark.parametrize("language", LANGUAGES)
def test_operations_and_random_graphs_are_those_of_the_tape(language: str, tmp_path: Path) -> None:
    single = [of_one_operation(name) for name in OPERATIONS]
    mixed = [random_program(seed) for seed in range(12)]
    pairs = [np.array(np.meshgrid(*[EDGES] * len(one.arguments))).reshape(len(one.arguments), -1) for one in single]
    poses = [
        *(table[:, :: max(1, table.shape[1] // 400)] for table in pairs),
        *(np.random.default_rng(seed).normal(size=(3, 25)) for seed in range(12)),
    ]
    for program, table, found in zip(
        [*single, *mixed], poses, run(language, [*single, *mixed], poses, tmp_path), strict=True
    ):
        assert_alike(found, by_tape(program, table))


@settings(max_examples=12)
@given(st.lists(st.text(max_size=50), min_size=1, max_size=5))
def test_names_are_taken_by_every_language_and_no_two_are_alike(given: list[str]) -> None:
    names = Identifiers()
    found = [names.take(name) for name in given]
    assert len(set(found)) == len(found)
    for name in found:
        assert re.fullmatch("[A-Za-z][A-Za-z0-9_]{0,61}", name)
        assert not keyword.iskeyword(name)
        assert name not in RESERVED


def test_a_name_is_kept_where_it_can_be() -> None:
    assert [identifier(name) for name in ("crank", "G.position.x", "hüfte", "Ω", "while", "x y", "1st", "日")] == [
        "crank", "G_position_x", "hufte", "omega", "while_", "x_y", "n1st", "n",
    ]  # fmt: skip


@pytest.mark.parametrize("language", LANGUAGES)
def test_no_title_ends_a_comment(language: str, tmp_path: Path) -> None:
    """Nor do notes, meanings and units."""
    evil = 'a */ b """ c \\ d ??/ e\nf %} /* g \\'
    graph = OperationGraph()
    nodes, arguments = given_numbers(graph, 1)
    told = Argument(arguments[0].given, "x0", evil, evil, 0.1)
    results = (Result(graph.apply("sin", nodes[0]), "y", evil, evil),)
    program = WrittenProgram("evil", evil, graph, (told,), results, graph.constant(1.0), (evil,))
    assert_alike(
        run(language, [program], [np.array([[1.0, 2.0]])], tmp_path)[0], by_tape(program, np.array([[1.0, 2.0]]))
    )


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_long_program_is_legible_and_always_the_same(language: str) -> None:
    program = random_program(5)
    text = LANGUAGES[language].text(program)
    assert max(map(len, text.splitlines())) <= 120
    assert text == LANGUAGES[language].text(random_program(5))


def test_few_values_wait_at_once() -> None:
    """Of a balanced tree of sums no more than its height, in whatever order its numbers were made."""
    graph = OperationGraph()
    row, _ = given_numbers(graph, 32)
    while len(row) > 1:
        row = [graph.apply("mul", a, b) for a, b in zip(row[::2], row[1::2], strict=True)]
    order, waiting, most = reading_order(graph, row), set[int](), 0
    for node in order:
        waiting -= set(graph.nodes[node].operands)
        waiting.add(node)
        most = max(most, len(waiting))
    assert most <= 6


def test_numbers_read_back_exactly() -> None:
    from compoundkin.programs.sources.spellings import number

    for value in np.random.default_rng(1).normal(size=500) * 10.0 ** np.arange(-250, 250):
        text = number(float(value), "NAN", "INFINITY").text
        assert float(text) == value
        assert re.search("[.e]", text)
