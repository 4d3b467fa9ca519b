"""Compiled paths under JAX: equal to the tape and `solve`, differentiated, mapped over designs, at the user's digits.

All 64-bit numbers are within `jax.enable_x64()`: the switch of the whole process is never touched.
"""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import CompoundkinError, InvalidInput, UnknownName
from compoundkin.programs.compiled_path import compile
from compoundkin.programs.graph.operation_graph import OperationGraph
from tests.benchmarks import six_bar
from tests.programs.test_tape import arrays, plain, program_of_everything

jax = pytest.importorskip("jax")
# Compiled for one call: nothing is gained by good code.
QUICK = {"xla_backend_optimization_level": 0}
OUTPUTS = ["G.position", "G.velocity", "G.acceleration", "bar.angle", "rocker.angular_acceleration"]
CRANK = np.linspace(0.0, 6.0, 40)
PLACES = np.array([[12.0 + 9.0j], [11.5 + 8.0j], [13.0 + 9.5j]])


def quick(function: Any, *arguments: Any) -> Any:
    found = jax.jit(function, compiler_options=QUICK)(*arguments)
    return jax.tree.map(np.asarray, found)


def path() -> Any:
    return compile(six_bar.mechanism(), OUTPUTS, free=["plate.C", "crank.D"])


def test_every_operation_of_a_graph() -> None:
    """In every stratum, with what is no number here and there."""
    from compoundkin.programs.jax_path import evaluate_graph

    graph, given, outputs = program_of_everything(7, times=2)
    values = dict(zip((graph.input(each) for each in given), arrays(given, (4, 7), 5), strict=True))
    with jax.enable_x64():
        found = quick(lambda given: evaluate_graph(graph, outputs, given), values)
    for k, ours, theirs in zip(outputs, found, plain(graph, outputs, values, (4, 7)), strict=True):
        one, other = (np.broadcast_to(x, (4, 7)) for x in (ours, theirs))
        np.testing.assert_allclose(one, other, rtol=1e-11, atol=1e-12, err_msg=str(graph.nodes[k]))


def test_it_equals_solve_and_the_tape_under_jit_and_vmap() -> None:
    compiled = path()
    function = compiled.jax()
    given = {"crank": CRANK}
    with jax.enable_x64():
        found = quick(lambda places: function(given, {"plate.C": places}, speed=10.0), PLACES)
        one = jax.vmap(lambda place: function(given, {"plate.C": place}, speed=10.0))
        mapped = quick(one, PLACES[:, 0])
    tape = compiled(given, {"plate.C": PLACES}, speed=10.0)
    for d, place in enumerate(PLACES[:, 0]):
        plan = six_bar.mechanism().replace(ck.link("plate", D=0, A=six_bar.DA, C=place))
        motion = ck.solve(plan, given, speed=10.0)
        theirs = [*(getattr(motion.points["G"], word.partition(".")[2]) for word in OUTPUTS[:3])]
        theirs += [motion.links["bar"].angle, motion.links["rocker"].angular_acceleration]
        for name, expected in zip(OUTPUTS, theirs, strict=True):
            for ours in (found[name][d], mapped[name][d], tape[name][d]):
                np.testing.assert_allclose(ours, expected, rtol=0.0, atol=1e-12 * np.max(np.abs(expected)))
    assert found["assembled"].all()
    assert mapped["certain"].tolist() == found["certain"].tolist() == [True, True, True]
    assert found["G.position"].dtype == complex


@pytest.mark.full
def test_slopes_are_those_of_differences() -> None:
    """Of a cost, by dimensions, driver values and speed at once."""
    function = compile(six_bar.mechanism(), ["G.acceleration", "bar.angle"], free=["plate.C", "crank.D"]).jax()

    def cost(numbers: Any) -> Any:
        places = {"plate.C": numbers[0] + 1j * numbers[1], "crank.D": numbers[2] + 1j * numbers[3]}
        found = function(CRANK + numbers[4], places, speed=numbers[5])
        return abs(found["G.acceleration"]).sum() + found["bar.angle"].sum()

    at = np.array([12.0, 9.0, 14.0, 0.5, 0.1, 3.0])
    with jax.enable_x64():
        slope = quick(jax.grad(cost), at)
        ends = [quick(jax.vmap(cost), at + sign * 1e-5 * np.eye(len(at))) for sign in (1, -1)]
    np.testing.assert_allclose(slope, (ends[0] - ends[1]) / 2e-5, rtol=1e-7)


@pytest.mark.full
def test_slopes_are_numbers_where_outputs_are() -> None:
    """A crank too long for a full turn: poses that are left out must not spoil the slope of the others."""
    compiled = compile(six_bar.mechanism(), ["G.acceleration", "A"], free="crank.D")
    function = compiled.jax()

    def cost(length: Any) -> Any:
        found = function(CRANK, {"crank.D": length}, speed=1.0)
        return jax.numpy.where(found["assembled"], abs(found["G.acceleration"]), 0.0).sum()

    with jax.enable_x64():
        found = quick(lambda length: function(CRANK, {"crank.D": length}, speed=1.0), 40.0)
        slope, ends = quick(jax.grad(cost), 40.0), quick(jax.vmap(cost), 40.0 + 1e-6 * np.array([1.0, -1.0]))
    with pytest.warns(ck.errors.UnassembledPoses):
        tape = compiled(CRANK, {"crank.D": 40.0}, speed=1.0)
    assert 0 < found["assembled"].sum() < len(CRANK)
    np.testing.assert_array_equal(found["assembled"], tape.assembled)
    np.testing.assert_array_equal(np.isnan(found["A"]), ~np.asarray(found["assembled"]))
    np.testing.assert_allclose(slope, (ends[0] - ends[1]) / 2e-6, rtol=1e-6)


def test_it_has_the_digits_that_its_user_chose() -> None:
    function = compile(six_bar.mechanism(), "bar.angle").jax()
    found = quick(function, CRANK)
    assert found["bar.angle"].dtype == np.float32
    assert not jax.config.jax_enable_x64
    with jax.enable_x64():
        exact = quick(function, CRANK)
        assert quick(function, CRANK.astype(np.float32))["bar.angle"].dtype == np.float32
    assert exact["bar.angle"].dtype == np.float64
    np.testing.assert_allclose(found["bar.angle"], exact["bar.angle"], atol=1e-5)


def test_angles_go_on_over_full_turns_and_gaps() -> None:
    from compoundkin.programs.jax_path import continuous_angle

    turning, angles = compile(ck.load("double-crank"), ["follower.angle"]), np.linspace(0.0, 15.0, 200)
    rocking = np.where(np.abs(angles - 7.0) < 1.0, np.nan, np.angle(np.exp(-0.7j * angles)))
    with jax.enable_x64():
        found = quick(turning.jax(), angles)["follower.angle"]
        over_gaps = quick(lambda angle: continuous_angle(angle), np.stack([rocking, angles, rocking[::-1]]))
    np.testing.assert_allclose(found, turning(angles)["follower.angle"], atol=1e-12)
    np.testing.assert_allclose(over_gaps[0], np.where(np.isnan(rocking), np.nan, -0.7 * angles), atol=1e-12)
    np.testing.assert_allclose(over_gaps[2] - over_gaps[2, 0], 0.7 * angles + 0.0 * over_gaps[2], atol=1e-12)


def test_where_signs_may_change_nothing_is_certain() -> None:
    found = quick(compile(ck.load("parallelogram"), "coupler.angle").jax(), CRANK)
    assert not found["certain"]


@pytest.mark.full
def test_a_slip_is_told() -> None:
    function = path().jax()
    for call in ({"values": {"cranck": 0.0}}, {"values": 0.0, "dimensions": {"plate.D": 1.0}}):
        with pytest.raises(UnknownName):
            function(**call)
    for call, told in (
        (lambda: function(CRANK, {"plate.C": PLACES[:, 0]}), r"crank \(40,\), plate.C \(3,\) do not broadcast"),
        (lambda: function(jax.numpy.array([1j])), "values.crank: complex"),
        (lambda: function([1j]), "values.crank: complex"),
        (lambda: function("a"), "values.crank: a text"),
        (lambda: function(CRANK[:0]), "no poses"),
        (function, "the driver has no values"),
        (lambda: function(CRANK, {"plate.C": "a"}), "plate.C"),
    ):
        with pytest.raises(CompoundkinError, match=told):
            call()
    with jax.enable_x64():
        assert function(jax.numpy.float32(0.5), {"crank.D": 13.0})["bar.angle"].dtype == np.float32
    places = (12.0, 9.0), (jax.numpy.array(12.0), 9.0), 12.0 + 9.0j
    assert len({float(function(0.5, {"plate.C": place})["bar.angle"]) for place in places}) == 1
    with pytest.raises(InvalidInput, match="needs a search"):
        compile(ck.load("geared-coupler"), "coupler.angle").jax()


def test_the_package_does_without_it() -> None:
    told = "import sys, compoundkin, compoundkin.programs.compiled_path; sys.exit('jax' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", told], check=False).returncode == 0


def test_a_graph_of_constants() -> None:
    from compoundkin.programs.jax_path import evaluate_graph

    graph = OperationGraph()
    (found,) = evaluate_graph(graph, [graph.constant(2.0)], {})
    assert float(found) == 2.0
