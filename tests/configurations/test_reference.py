"""Circuits that were computed independently, with dimensions of published mechanisms."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.configurations.circuit import Circuit, Limit
from compoundkin.configurations.circuit_search import Circuits
from tests.configurations.mechanisms import four_bar
from tests.support import REFERENCE

ENTRIES = {e["id"]: e for e in json.loads((REFERENCE / "circuits.json").read_text(encoding="utf-8"))}
LINKS = {"frame": "ADG", "AB": "AB", "BCE": "BCE", "CD": "CD", "EF": "EF", "FG": "FG"}


def made(entry: dict[str, Any]) -> tuple[Circuits, float, dict[str, float]]:
    """The circuits; from the driver's value in the reference to ours; from the links' angles there to ours."""
    d = entry["dimensions"]
    if "joints" not in d:
        driver = "rocker" if "input t3" in entry["description"] else "crank"
        found = ck.circuits(four_bar(d["a"], d["b"], d["c"], d["d"], driver))
        return found, 0.0, {"crank": 0.0, "coupler": 0.0, "rocker": 0.0}
    joints = {k: complex(*v) for k, v in d["joints"].items()}
    driver = "FG" if "triad" in entry["id"] else "AB"
    links = [ck.link(name, *letters) for name, letters in LINKS.items()]
    mechanism = ck.Mechanism(entry["id"], *links, ck.drawn(**joints), ck.drive(driver))
    drawn = {k: float(np.angle(joints[v[1]] - joints[v[0]])) for k, v in LINKS.items() if k != "frame"}
    return ck.circuits(mechanism), drawn[driver], drawn


NAMES = {"t1": "crank", "t2": "coupler", "t3": "rocker"}


def turned(a: Any, b: Any) -> Any:
    """How far angles are apart, whole turns left out."""
    return np.abs(np.angle(np.exp(1j * (np.asarray(a) - np.asarray(b)))))


@pytest.mark.parametrize("name", ENTRIES)
def test_number_of_circuits_limits_and_windings(name: str) -> None:
    entry = ENTRIES[name]
    found, _, _ = made(entry)
    assert found.consistent
    expected = [(c["n_turning_points"], abs(c["input_winding_number"])) for c in entry["expected"]["circuits"]]
    assert sorted((len(c.limits), abs(c.winding)) for c in found.circuits) == sorted(expected)


@pytest.mark.parametrize("name", ENTRIES)
def test_every_limit_position_to_nine_digits(name: str) -> None:
    entry = ENTRIES[name]
    found, zero, drawn = made(entry)
    missing = list(found.limits)
    for circuit in entry["expected"]["circuits"]:
        for value, angles in zip(circuit["input_turning_values"], circuit["turning_configurations"], strict=True):
            named = {NAMES.get(link, link): angle for link, angle in angles.items()}
            at = named.get(found.driver, value)

            def apart(limit: Limit, at: float = at, named: dict[str, float] = named) -> float:
                gaps = [turned(limit.value, at + zero)]
                gaps += [turned(limit.configuration.angles[k], v + drawn[k]) for k, v in named.items()]
                return float(np.max(gaps))

            best = min(missing, key=apart)
            # the reference knows configurations at limits to the square root of rounding
            assert apart(best) < 1e-7
            assert turned(best.value, at + zero) < 1e-9
            missing.remove(best)
    assert not missing


@pytest.mark.parametrize("name", ENTRIES)
def test_the_configurations_of_the_reference_lie_on_different_circuits(name: str) -> None:
    """One configuration of every circuit is given; they are found on different circuits, with as many limits."""
    entry = ENTRIES[name]
    found, zero, drawn = made(entry)
    seen: list[Circuit] = []
    for circuit in entry["expected"]["circuits"]:
        named = {NAMES.get(k, k): v for k, v in circuit["one_configuration"].items()}
        every = ck.configurations(found.structure, {found.driver: named[found.driver] + zero})
        gaps = [max(turned(one.angles[k], v + drawn[k]) for k, v in named.items()) for one in every]
        best = list(every)[int(np.argmin(gaps))]
        assert min(gaps) < 1e-8
        seen.append(found.circuits[found.at(best).circuit - 1])
        assert len(seen[-1].limits) == circuit["n_turning_points"]
    assert len({circuit.number for circuit in seen}) == entry["expected"]["n_circuits"]


@pytest.mark.parametrize("name", ENTRIES)
def test_real_configurations_are_as_many_as_the_reference_has(name: str) -> None:
    entry = ENTRIES[name]
    found, _, _ = made(entry)
    values = np.linspace(-np.pi, np.pi, 721)
    counts = ck.configurations(found.structure, {found.driver: values}).real_count
    assert [int(counts.min()), int(counts.max())] == entry["expected"]["n_real_modes_vs_input"]


def test_published_limits_of_the_stephenson_iii_linkage() -> None:
    """Published sweeps in steps of a degree end between 41 and 42, and between -58 and -59 degrees from the drawing."""
    found, zero, _ = made(ENTRIES["circ_pmks_stephenson_iii"])
    assert found.start is not None
    branch = found.branches[found.start.branch - 1]
    assert np.rad2deg([branch.low - zero, branch.high - zero]) == pytest.approx([-58.8989369, 41.3045818], abs=1e-6)
    assert branch.ends[0] is not None
    assert branch.ends[1] is not None
