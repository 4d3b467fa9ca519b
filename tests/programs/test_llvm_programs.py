"""LLVM's code against every operation computed plainly: any strata, strides, remainders, threads, marches."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from compoundkin.base.errors import InvalidInput
from compoundkin.programs.backends import chosen_back_end, llvm_backend, runner_of
from compoundkin.programs.backends.llvm_plan import Machine
from compoundkin.programs.graph.flat_program import BY_BOTH, BY_DESIGN, BY_POSE, Carried, flat_program
from compoundkin.programs.graph.operation_graph import BEFORE, InputNumber, OperationGraph
from tests.benchmarks import six_bar
from tests.programs.test_tape import arrays, plain, program_of_everything

SHAPES = [(1, 1), (1, 17), (1, 2500), (700, 1), (21, 5), (40, 1100), (3, 2100), (2, 8), (16, 16), (130, 31)]


@pytest.fixture(autouse=True)
def _own_cache(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COMPOUNDKIN_CACHE", str(tmp_path_factory.getbasetemp() / "objects"))
    monkeypatch.setattr(llvm_backend, "POSES_PER_THREAD", 1)


@pytest.fixture(params=[None, Machine(8, True, False), Machine(4, False, False)], ids=["this", "eight", "four"])
def machine(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Any:
    """This processor, and code as for others: fewer lanes, and no masks for remainders."""
    if request.param:
        monkeypatch.setattr(llvm_backend, "host_target", lambda: (request.param, ""))
    return request.param


@pytest.mark.full
def test_every_operation_in_every_stratum() -> None:
    """Many designs or many poses, and one runner for all shapes; two threads change no bit."""
    graph, given, outputs = program_of_everything(7)
    program = flat_program(graph, outputs, given)
    runner = runner_of(program, "llvm")
    for shape in SHAPES:
        values = dict(zip((graph.input(each) for each in given), arrays(given, shape, 5), strict=True))
        found = [[np.full(program.shape(k, *shape), -7.0) for k in outputs] for _ in range(2)]
        for threads, each in enumerate(found):
            runner([values[k] for k in program.inputs], each, shape, threads + 1)
        for k, ours, other, theirs in zip(outputs, *found, plain(graph, outputs, values, shape), strict=True):
            theirs = np.broadcast_to(theirs, ours.shape)
            np.testing.assert_allclose(ours, theirs, rtol=1e-11, atol=1e-12, err_msg=f"{shape} {graph.nodes[k]}")
            np.testing.assert_array_equal(ours, other)


def placed(array: Any, way: str) -> Any:
    """The same numbers elsewhere: parts of complex numbers, every third of a longer array, turned round, by columns."""
    rows, columns = array.shape
    if way == "third":
        found = np.full((rows, 3 * columns), -3.0)[:, ::3]
    elif way == "back":
        found = np.full((rows, columns), -3.0)[::-1, ::-1]
    elif way == "columns":
        found = np.full((columns, rows), -3.0).T
    elif way == "odd":  # a place that is no multiple of eight
        found = np.frombuffer(bytearray(array.nbytes + 1), np.uint8)[1:].view(float).reshape(array.shape)
    else:
        return array
    found[...] = array
    return found


@pytest.mark.parametrize("shape", [(5, 43), (43, 5)])
def test_arrays_of_any_strides(shape: tuple[int, int], machine: Any) -> None:
    graph = OperationGraph()
    strata = {InputNumber("parameter", str(s)): s for s in (BY_DESIGN, BY_POSE, BY_BOTH)}
    a, b, c = (graph.input(each) for each in strata)
    both = graph.apply("add", graph.apply("mul", a, b), c)
    outputs = [
        both,
        graph.apply("sub", both, c),
        graph.apply("neg", b),
        graph.apply("mul", a, a),
        graph.apply("sin", both),
    ]
    program = flat_program(graph, outputs, strata)
    runner, random = runner_of(program, "llvm"), np.random.default_rng(0)
    plainly = {k: random.normal(size=program.shape(k, *shape)) for k in program.inputs}
    expected = plain(graph, outputs, plainly, shape)
    ways = ("as it is", "third", "back", "columns")
    for n, way in enumerate((*ways, "odd")):
        inputs = [placed(plainly[k], way) for k in program.inputs]
        found = [placed(np.zeros(program.shape(k, *shape)), ways[(i + n) % 4]) for i, k in enumerate(outputs)]
        z = np.zeros((2, *shape), complex)
        found[0], found[1] = z[n % 2].real, z[n % 2].imag
        runner(inputs, found, shape)
        for ours, theirs in zip(found, expected, strict=True):
            np.testing.assert_allclose(ours, theirs, rtol=1e-14, atol=1e-14, err_msg=way)
        assert not z[1 - n % 2].any()


@pytest.mark.parametrize("shape", [(1, 1), (1, 1100), (1, 5003), (3, 530), (40, 5)])
def test_an_input_is_read_a_pose_before_too(shape: tuple[int, int], machine: Any) -> None:
    """At the first pose it is as it is there; copies of inputs are results."""
    graph, x = OperationGraph(), InputNumber("drive", "crank", "0")
    now, before = graph.input(x), graph.input(x._replace(part=BEFORE))
    step = graph.apply("sub", now, before)
    outputs = [step, graph.apply("least", step), graph.apply("cos", graph.apply("add", now, before)), now]
    stratum = BY_POSE * (shape[1] > 1) | BY_DESIGN * (shape[0] > 1)
    values = np.random.default_rng(0).normal(size=shape)
    late = np.concatenate([values[:, :1], values[:, :-1]], axis=1)
    expected = [values - late, (values - late).min(axis=1, keepdims=True), np.cos(values + late), values]
    program = flat_program(graph, outputs, {x: stratum, x._replace(part=BEFORE): stratum})
    for backend in ("llvm", "numpy"):
        runner = runner_of(program, backend)
        for way in ("as it is", "third", "back"):
            for threads in (1, 2):
                found = [np.full(program.shape(k, *shape), -3.0) for k in outputs]
                runner([placed(values, way)], found, shape, threads)
                for ours, theirs in zip(found, expected, strict=True):
                    np.testing.assert_allclose(ours, theirs, rtol=0, atol=3e-16, err_msg=f"{backend} {way}")


def test_nothing_is_written_beyond_an_array(machine: Any) -> None:
    graph, x = OperationGraph(), InputNumber("drive", "crank", "0")
    nodes = [graph.apply(name, graph.input(x)) for name in ("cos", "sin")]
    runner = runner_of(flat_program(graph, [*nodes, nodes[0]], {x: BY_POSE}), "llvm")
    for poses in range(1, 41):
        whole, real, angles = np.full((1, poses + 40), 9 + 9j), np.full((1, poses + 40), 9.0), np.arange(poses + 0.0)
        part = whole[:, 20 : 20 + poses]
        runner([angles[None]], [part.real, part.imag, real[:, 20 : 20 + poses]], (1, poses))
        np.testing.assert_allclose(part[0], np.exp(1j * angles), rtol=0, atol=2e-16)
        np.testing.assert_allclose(real[0, 20 : 20 + poses], np.cos(angles), rtol=0, atol=2e-16)
        for each, kept in ((whole, 9 + 9j), (real, 9.0)):
            assert np.all(each[:, :20] == kept)
            assert np.all(each[:, 20 + poses :] == kept)


def test_what_does_not_fit_is_refused() -> None:
    graph, x = OperationGraph(), InputNumber("drive", "crank", "0")
    runner = runner_of(flat_program(graph, [graph.apply("cos", graph.input(x))], {x: BY_POSE}), "llvm")
    good, out = np.zeros((1, 9)), np.zeros((1, 9))
    for _ in range(2):  # a first call compiles
        runner([good], [out], (1, 9))
        runner([good.astype(">f8")], [out], (1, 9))
        runner([good.astype(int)], [out], (1, 9))
        assert np.all(out == 1.0)
        still = np.zeros((1, 9))
        still.flags.writeable = False
        for inputs, outputs in (
            ([good[:, :8]], [out]),
            ([good], [out.astype(int)]),
            ([good], [still]),
            ([good], [out.T]),
        ):
            with pytest.raises(ValueError, match="array"):
                runner(inputs, outputs, (1, 9))


def test_totals_are_the_same_whatever_the_threads(machine: Any) -> None:
    graph, x, a = OperationGraph(), InputNumber("drive", "crank", "0"), InputNumber("dimension", "a")
    wave = graph.apply("mul", graph.input(a), graph.apply("cos", graph.input(x)))
    root = graph.apply("sqrt", graph.input(x))
    outputs = [graph.apply("total", wave), graph.apply("least", wave), graph.apply("least", root)]
    outputs.append(graph.apply("inv", outputs[0]))
    runner = runner_of(flat_program(graph, outputs, {x: BY_POSE, a: BY_DESIGN}), "llvm")  # reads a, then x
    random = np.random.default_rng(3)
    for shape in [(1, 100_001), (3, 30_000), (100, 5000), (999, 3)]:
        angles, sizes = random.uniform(0, 9, (1, shape[1])), random.normal(size=(shape[0], 1))
        angles[0, shape[1] // 2] *= -1.0
        found = [[np.empty((shape[0], 1)) for _ in outputs] for _ in range(4)]
        for threads, each in zip((1, 2, 3, 5), found, strict=True):
            runner([sizes, angles], each, shape, threads)
        whole = sizes * np.cos(angles)
        np.testing.assert_allclose(found[0][0], whole.sum(1, keepdims=True), rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(found[0][1], whole.min(1, keepdims=True), rtol=0, atol=1e-15)
        assert np.all(np.isnan(found[0][2]))
        for other in found[1:]:
            np.testing.assert_array_equal(other, found[0])


@pytest.mark.parametrize("shape", [(1, 6), (600, 40), (3, 1100), (4, 1)])
def test_a_march_carries_numbers_from_pose_to_pose(shape: tuple[int, int], machine: Any) -> None:
    """The mean of the last two with a drift: two numbers carried, one of them the other's past."""
    graph = OperationGraph()
    names = ("x", "y", "start", "drift", "share")
    x, y, start, drift, share = (graph.input(InputNumber("seed", name)) for name in names)
    half = graph.constant(0.5)
    new = graph.apply("mul", graph.apply("add", graph.apply("add", x, y), graph.apply("mul", drift, drift)), half)
    least = graph.apply("least", graph.apply("add", new, share))
    outputs = [new, x, graph.apply("cos", new), graph.apply("total", new), least, graph.apply("neg", least)]
    given = {graph.nodes[k].given: s for k, s in zip((x, y, start, drift, share), (3, 3, 1, 2, 3), strict=True)}
    program = flat_program(graph, outputs, given, [Carried(x, start, new), Carried(y, half, x)])  # type: ignore[arg-type]
    random = np.random.default_rng(0)
    first, drifts, shares = random.random((shape[0], 1)), random.random((1, shape[1])), random.random(shape)
    expected, now, before = np.empty((2, *shape)), first[:, 0], np.full(shape[0], 0.5)
    for k in range(shape[1]):
        expected[1, :, k] = now
        now, before = (now + before + drifts[0, k] ** 2) / 2, now
        expected[0, :, k] = now
    given_arrays = {start: first, drift: drifts, share: shares}
    for threads in (1, 2):
        found = [np.empty(program.shape(k, *shape)) for k in outputs]
        runner_of(program, "llvm")([given_arrays[k] for k in program.given], found, shape, threads)
        np.testing.assert_allclose(found[:3], [*expected, np.cos(expected[0])], rtol=1e-13)
        np.testing.assert_allclose(found[3], expected[0].sum(1, keepdims=True), rtol=1e-13)
        np.testing.assert_allclose(found[4], (expected[0] + shares).min(1, keepdims=True), rtol=1e-13)
        np.testing.assert_array_equal(found[5], -found[4])


def test_the_six_bar_written_by_hand() -> None:
    from compoundkin.programs.recording.recorded_number import RecordedNumber

    graph, crank = OperationGraph(), InputNumber("drive", "crank", "0")
    recorded = six_bar.by_hand(RecordedNumber.given(graph, crank))  # type: ignore[arg-type]
    angles = np.linspace(-7.0, 7.0, 20_001)
    names = [(name, order) for name in six_bar.POINTS for order in range(3)]
    outputs = [part for name, order in names for part in (recorded[name][order].x, recorded[name][order].y)]
    found = np.full((len(names), 1, len(angles)), np.nan, complex)
    runner = runner_of(flat_program(graph, outputs, {crank: BY_POSE}), "llvm")
    runner([angles[None]], [part for z in found for part in (z.real, z.imag)], (1, len(angles)), 2)
    for (name, order), ours in zip(names, found, strict=True):
        theirs = six_bar.by_hand(angles)[name][order]
        assert np.max(np.abs(ours[0] - theirs)) < 1e-13 * np.max(np.abs(theirs)), (name, order)


def test_no_poses_and_no_designs() -> None:
    graph, x, a = OperationGraph(), InputNumber("drive", "crank", "0"), InputNumber("dimension", "a")
    length, wave = graph.input(a), graph.apply("cos", graph.input(x))
    outputs = [graph.apply("neg", length), graph.apply("total", wave), graph.apply("mul", length, wave)]
    program = flat_program(graph, outputs, {x: BY_POSE, a: BY_DESIGN})
    runner = runner_of(program, "llvm")
    for shape in ((3, 0), (0, 3), (0, 0)):
        found = [np.full(program.shape(k, *shape), 7.0) for k in outputs]
        runner([np.ones((shape[0], 1)), np.ones((1, shape[1]))], found, shape, 2)
        assert np.all(found[0] == -1.0)
        assert np.all(found[1] == 0.0)


def test_a_back_end_is_chosen_by_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    from compoundkin.programs import backends

    assert chosen_back_end() == chosen_back_end("llvm") == "llvm"
    with pytest.raises(InvalidInput, match="known: llvm, numpy"):
        chosen_back_end("gpu")
    monkeypatch.setattr(backends, "find_spec", lambda name: None if name == "llvmlite" else name)
    assert chosen_back_end() == "numpy"
    with pytest.raises(InvalidInput, match=r"pip install 'compoundkin\[compiled\]'"):
        chosen_back_end("llvm")


def test_code_is_linked_where_memory_is_in_pieces() -> None:
    """LLVM's older linker ended the process: it asked for each part of an object alone, and they lay 2 GB apart."""
    script = """
import mmap, random
import numpy as np
import compoundkin as ck
from compoundkin.programs.backends import llvm_backend

compiled, texts = llvm_backend.compile_text, []
llvm_backend.compile_text = lambda text: (texts.append(text), compiled(text))[1]
ck.compile(ck.load("six-bar"), ["G.position"])({"crank": np.linspace(0, 1, 30)})
chance, kept, others = random.Random(1), [], []
for _ in range(150):
    kept.append(compiled(texts[0]))
    others.append(mmap.mmap(-1, chance.choice([1 << 16, 1 << 20, 1 << 27, 1 << 31]), prot=mmap.PROT_READ))
    if len(others) > 40:
        others.pop(chance.randrange(40))
"""
    subprocess.run([sys.executable, "-c", script], cwd=Path(__file__).parents[2], check=True)
