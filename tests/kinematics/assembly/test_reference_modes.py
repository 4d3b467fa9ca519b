"""Published and independently computed numbers of assembly modes, and complete lists of the real ones."""

import json

import numpy as np
import pytest

from compoundkin.kinematics.assembly import all_configurations, exact_count
from compoundkin.kinematics.assembly.loop_closure import GroupGraph
from tests.kinematics.assembly.cases import as_drawn, seven_bar, three_legs, triad
from tests.kinematics.assembly.laman import laman_number
from tests.kinematics.assembly.trusses import from_graph6, random_truss
from tests.support import REFERENCE, reference

ENTRIES = json.loads((REFERENCE / "assembly_modes.json").read_text(encoding="utf-8"))
TRUSSES = [entry["id"] for entry in ENTRIES if entry["id"].startswith("baranov")]


def same_sets(found, expected, tolerance):
    """Every configuration is in the other list, and none twice; both (configurations, angles)."""
    gaps = np.abs(np.exp(1j * np.asarray(found))[:, None] - np.exp(1j * np.asarray(expected))[None]).max(axis=-1)
    assert gaps.shape == (len(expected), len(expected))
    assert np.all((gaps < tolerance).sum(axis=0) == 1)
    assert np.all((gaps < tolerance).sum(axis=1) == 1)


@pytest.mark.parametrize("name", TRUSSES)
def test_trusses(name):
    entry = reference(name, "assembly_modes")
    found = all_configurations(as_drawn(entry["dimensions"]))
    expected = entry["expected"]
    assert found.certified
    assert found.count == expected["n_complex"]
    assert found.real_count == expected["n_real"]
    # the reference lists links by their rotation from the drawn pose, which is the frame of every body here
    same_sets(found.states[:, 2::3], expected["real_solutions_angles"], 1e-8)


def test_platform_on_three_legs():
    entry = reference("triad_3RPR_six_real", "assembly_modes")
    found = all_configurations(three_legs(entry["dimensions"]))
    assert found.certified
    assert found.count == found.real_count == 6
    platform = found.states[:, 9:]
    rows = np.array(entry["expected"]["full_precision_rows"])
    order = np.argsort(platform[:, 2])
    assert np.abs(platform[order] - rows[np.argsort(rows[:, 2])]).max() < 1e-8


def test_seven_bar():
    entry = reference("sevenbar_quaternary_generic", "assembly_modes")
    found = all_configurations(seven_bar(entry["dimensions"]))
    assert found.certified
    assert found.count == entry["expected"]["n_complex"]
    same_sets(found.states[:, 2::3], entry["expected"]["real_solutions_angles_t1_to_t6"], 1e-8)


@pytest.mark.parametrize("graph6", reference("counts_assembly_modes_baranov", "assembly_modes")["expected"])
def test_numbers_of_trusses(graph6):
    modes = reference("counts_assembly_modes_baranov", "assembly_modes")["expected"][graph6]["modes"]
    graph = from_graph6(graph6)
    for held in graph:
        truss = random_truss(graph, np.random.default_rng(held), held)
        assert exact_count(truss.graph()) == modes


@pytest.mark.full
def test_numbers_of_triads_with_slides():
    expected = reference("triad_P_counts", "assembly_modes")["expected"]
    words = [word for word, count in expected.items() if isinstance(count, int)]
    assert len(words) == 16
    for word in words:
        found = all_configurations(triad(word, np.random.default_rng(len(word))))
        assert (found.possible, found.count) == (expected[word], expected[word]), word
        assert found.certified == ("P" not in word)


def test_numbers_of_small_graphs():
    expected = reference("laman_small", "assembly_modes")["expected"]
    graphs = {
        "K3": [(0, 1), (1, 2), (2, 0)],
        "K4-e": [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3)],
        "K33": [(a, b) for a in range(3) for b in range(3, 6)],
        "prism": [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)],
    }
    for name, edges in graphs.items():
        assert laman_number(edges) == expected[name]


def test_a_structure_with_slides_has_no_exact_number():
    assert exact_count(GroupGraph(2, ((None, 0), (0, 1), (None, 1)), (False, True, False), ((0, 0),) * 3)) is None
