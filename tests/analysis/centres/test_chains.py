"""Every chain of four, six and eight links, at random geometry, against the null vector of the loop equations."""

from __future__ import annotations

import json

import networkx as nx
import numpy as np
import pytest

from compoundkin.analysis.centres import instant_centres
from compoundkin.analysis.centres.derivation import Trial, derive
from compoundkin.analysis.centres.evaluation import Evaluation, recompute
from compoundkin.analysis.centres.homogeneous import sine_between
from compoundkin.analysis.centres.known_centres import null_twists
from tests.analysis.centres.chains import DOUBLE_BUTTERFLY, SINGLE_FLIER, chains, diagram, random_mechanism, solved
from tests.analysis.centres.twists import disagreement, loop_twists, solved_twists
from tests.support import REFERENCE

ALL = {n: chains(n) for n in (4, 6, 8)}
MANY = 500
EXACT = 1e-9


def is_chain(graph: nx.Graph, graph6: str) -> bool:
    return bool(nx.is_isomorphic(graph, nx.from_graph6_bytes(graph6.encode())))


INDETERMINATE = [g for g in ALL[8] if is_chain(g, DOUBLE_BUTTERFLY) or is_chain(g, SINGLE_FLIER)]
each = pytest.mark.parametrize(
    "graph", [g for n in ALL for g in ALL[n]], ids=[f"{n}-{k}" for n in ALL for k in range(len(ALL[n]))]
)


def test_as_many_chains_as_are_known() -> None:
    counts = json.loads((REFERENCE / "counts.json").read_text())[0]["expected"]
    assert {n: len(graphs) for n, graphs in ALL.items()} == {n: counts[str(n)] for n in ALL}
    assert len(INDETERMINATE) == 2


@each
def test_crossing_suffices_but_for_the_two_indeterminate_chains(graph: nx.Graph) -> None:
    derivation = derive(diagram(graph))
    trials = [rule for rule in derivation.rules if isinstance(rule, Trial)]
    n = len(graph)
    assert len(derivation.steps) == n * (n - 1) // 2
    assert {step.kind for step in derivation.steps} <= {"primary", "crossing", "trial"}
    if graph in INDETERMINATE:
        # one centre by two trial positions and one final collinearity; all others by crossing
        assert [(len(t.found), t.values, len(t.meetings)) for t in trials] == [(1, 1, 1)]
    else:
        assert trials == []


@pytest.mark.parametrize(("graph6", "direct"), [(DOUBLE_BUTTERFLY, 10), (SINGLE_FLIER, 12)])
def test_crossing_stalls_where_it_is_known_to(graph6: str, direct: int) -> None:
    steps = derive(diagram(nx.from_graph6_bytes(graph6.encode()))).steps
    assert [step.kind for step in steps].index("trial") == direct


@each
def test_every_step_uses_only_what_was_found_before(graph: nx.Graph) -> None:
    known: set[frozenset[str]] = set()
    for step in derive(diagram(graph)).steps:
        for line in step.lines:
            used = [frozenset(text.strip("()").split()) for text in line]
            assert step.kind == "trial" or known.issuperset(used)
        assert frozenset(step.centre) not in known
        known.add(frozenset(step.centre))


@each
def test_against_the_null_vector_at_many_random_geometries(graph: nx.Graph) -> None:
    circle = diagram(graph)
    places = np.random.default_rng(5).uniform(-1.0, 1.0, (len(circle.primaries), 2, MANY))
    units = [np.stack([x, y, np.ones(MANY)]) / np.sqrt(x * x + y * y + 1.0) for x, y in places]
    found = Evaluation(derive(circle), units, [np.ones(1)])
    found.run(None)
    recompute(found)
    twists, gap = null_twists(circle, units, [np.ones(1)])
    compared = 0
    for (i, j), point in found.points.items():
        relative = twists[j] - twists[i]
        # a link that all but rests beside the fastest, or a pose that is all but singular, proves nothing
        firm = (found.spread[i, j] < 1e6) & (np.sqrt((relative**2).sum(axis=0)) > 1e-4) & (gap > 1e-5)
        compared += int(np.broadcast_to(firm, MANY).sum())
        assert np.max(sine_between(point, relative), where=firm, initial=0.0) < EXACT
    assert compared > 0.98 * MANY * len(found.points)


@each
def test_the_conditioning_tells_the_error(graph: nx.Graph) -> None:
    """Rounding times the magnification bounds the error, within a factor of a hundred of the median."""
    circle = diagram(graph)
    places = np.random.default_rng(6).uniform(-1.0, 1.0, (len(circle.primaries), 2, MANY))
    units = [np.stack([x, y, np.ones(MANY)]) / np.sqrt(x * x + y * y + 1.0) for x, y in places]
    moved = [u + 1e-9 * np.random.default_rng(k).standard_normal(u.shape) for k, u in enumerate(units)]
    one, other = Evaluation(derive(circle), units, []), Evaluation(derive(circle), moved, [])
    one.run(None)
    other.run(None)
    for c, point in one.points.items():
        ratio = sine_between(point, other.points[c]) / (1e-9 * one.spread[c])
        assert np.percentile(ratio[one.spread[c] < 1e5] if one.spread[c].size > 1 else ratio, 95) < 10.0


@each
@pytest.mark.parametrize("seed", range(2))
def test_as_a_mechanism_solved_group_by_group(graph: nx.Graph, seed: int) -> None:
    motion = solved(random_mechanism(graph, seed))
    centres = instant_centres(motion)
    check = centres.velocity_check()
    assert check.compared == 1.0
    assert check.worst < EXACT
    for twists in (loop_twists(centres)[0], solved_twists(motion, centres.scale)):
        assert max(float(v) for v in disagreement(centres, twists).values()) < EXACT
    assert max(float(v) for v in centres.collinearity().values()) < EXACT
