"""Circuits of the shipped mechanisms."""

from __future__ import annotations

import time

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.configurations.circuit_search import Circuits
from compoundkin.files import load
from tests import catalog
from tests.configurations.mechanisms import four_bar
from tests.configurations.test_random import check_counts

# Those that are special too: change points, several drivers, slides as drivers, gears.
CHOSEN = sorted({*catalog.THIRD, "parallelogram", "antiparallelogram",
                 "scott-russell", "pantograph", "stephenson-iii", "hydraulic-digger", "planetary-train",
                 "rack-and-pinion-steering", "class-iii-six-bar"})  # fmt: skip


def of(name: str) -> Circuits:
    mechanism = load(name)
    return ck.circuits(mechanism, mechanism.drives[0].name)


@catalog.each(CHOSEN)
def test_branches_are_as_many_as_configurations(name: str) -> None:
    found = of(name)
    check_counts(found)
    assert found.start is not None


@pytest.mark.parametrize(
    ("name", "windings", "branches"),
    [
        ("crank-rocker", [1, 1], [1, 1]),
        ("double-crank", [1, 1], [1, 1]),
        ("double-rocker", [0, 0], [2, 2]),
        ("triple-rocker", [0], [2]),
        ("v8-engine", [1] * 256, [1] * 256),
        ("elliptic-trammel", [1], [1]),
        ("geared-five-bar-symmetrical", [1, 1], [1, 1]),
    ],
)
def test_what_textbooks_say_of_them(name: str, windings: list[int], branches: list[int]) -> None:
    found = of(name)
    assert [circuit.winding for circuit in found.circuits] == windings
    assert [len(circuit.branches) for circuit in found.circuits] == branches


def test_configurations_that_were_not_found_here_are_refused() -> None:
    found = of("five-bar")
    other = ck.configurations(found.structure, {"left": 1.2, "right": 1.9}).pick(0)
    with pytest.raises(ck.errors.InvalidInput, match="right stand"):
        found.at(other)


def test_circuits_of_different_number_are_not_connected() -> None:
    found = of("crank-rocker")
    with pytest.raises(ck.errors.InvalidInput, match="not connected"):
        found.path(1, 2)
    with pytest.raises(ck.errors.InvalidInput, match="no branch 7"):
        found.path(1, 7)


@pytest.mark.parametrize(
    ("words", "text"),
    [
        ({"driver": "crnk"}, "did you mean 'crank'"),
        ({"values": {"rod": 1.0}}, "no driver 'rod'"),
        ({"between": (2.0, 1.0)}, "not a range"),
        ({"between": 3}, "no list of numbers"),
    ],
)
def test_wrong_words(words: dict[str, object], text: str) -> None:
    with pytest.raises(ck.errors.InvalidInput, match=text):
        ck.circuits(load("crank-rocker"), **words)  # type: ignore[arg-type]


def test_a_range_is_kept_to() -> None:
    found = ck.circuits(load("triple-rocker"), between=(-0.5, 1.0))
    assert [circuit.closed for circuit in found.circuits] == [False, False]
    assert {(branch.low, branch.high) for branch in found.branches} == {(-0.5, 1.0)}
    assert {branch.open_ends for branch in found.branches} == {("the end of the range",) * 2}


def test_class_iii_six_bar_over_a_cycle_takes_little_time() -> None:
    """361 poses with all configurations at each."""
    mechanism, values = load("class-iii-six-bar"), np.deg2rad(np.arange(361.0))
    ck.configurations(mechanism, values)
    start = time.process_time()
    found = ck.configurations(mechanism, values)
    assert time.process_time() - start < 0.6
    assert np.all(found.real_count == 6)
    assert found.certified


def test_one_design_of_several() -> None:
    """The crank of the first turns fully; in the second it turns back where coupler and rocker are stretched."""
    mechanism = four_bar(1.0, 3.0, 3.0, np.array([[4.0], [6.5]]))
    first, second = (ck.circuits(mechanism, design=k) for k in (0, 1))
    assert [circuit.winding for circuit in first.circuits] == [1, 1]
    limit = float(np.arccos((1 + 6.5**2 - 36) / 13))
    assert sorted(one.value for one in second.limits) == pytest.approx([-limit, limit], abs=1e-12)
    with pytest.raises(ck.errors.InvalidInput, match="no design 7"):
        ck.circuits(mechanism, design=7)


def test_a_roller_follower_has_two_circuits_of_full_turns() -> None:
    found = of("oscillating-roller-follower")
    assert [circuit.winding for circuit in found.circuits] == [1, 1]
    assert found.consistent


def test_an_overconstrained_parallelogram_has_lost_the_other_circuit() -> None:
    """A third crank closes only where the coupler stays parallel: one configuration, one circuit of full turns."""
    three = ck.Mechanism(
        "Three cranks",
        ck.link("frame", A=0, D=4, G=2),
        ck.link("crank", A=0, B=1),
        ck.link("coupler", B=0, C=4, F=2),
        ck.link("rocker", D=0, C=1),
        ck.link("middle", G=0, F=1),
        ck.drive("crank"),
        ck.drawn(B=(0.6, 0.8), C=(4.6, 0.8), F=(2.6, 0.8)),
    )
    assert int(ck.configurations(three, {"crank": 1.0}).real_count) == 1
    found = ck.circuits(three)
    assert [circuit.winding for circuit in found.circuits] == [1]
    assert found.consistent
    assert found.start is not None
