from __future__ import annotations

import random
import subprocess
import sys

import networkx as nx
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from compoundkin.model.elements import drive, link
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.prismatic import slide
from compoundkin.structure import Structure, decompose
from tests.support import examples


def numbered(structure: Structure) -> list[frozenset[int]]:
    return [frozenset(int(name.strip("kx")) for name in group.links) for group in structure.groups]


def check_whole(structure: Structure) -> None:
    """What must hold of every determinate structure."""
    mechanism = structure.mechanism
    assert structure.faults == ()
    solved = dict.fromkeys(structure.ground.links)
    used = [step.pair for step in structure.ground.driven]
    for group in structure.groups:
        links = set(group.links)
        assert set(group.uses) <= set(solved)
        for pair in group.outer:
            assert len(links & set(pair.members)) == 1
        for pair in group.inner:
            assert set(pair.members) <= links
        if len(group.bodies) == 2 and len(group.inner) == 1:
            assert all(set(b.links) & set(p.members) for b, p in zip(group.bodies, group.outer, strict=True))
        solved |= dict.fromkeys(group.links)
        used += [*group.inner, *group.outer, *(step.pair for body in group.bodies for step in body.driven)]
        held = sum(pair.held for pair in (*group.inner, *group.outer))
        assert held == 3 * len(group.bodies)
        assert group.order == len(group.outer)
    assert set(solved) == set(mechanism.links)
    names = [pair.name for pair in structure.pairs]
    assert len(set(names)) == len(names)
    assert sorted(names) == sorted(pair.name for pair in used)
    pins = sum(len(names) - 1 for names in mechanism.pins.values())
    assert len(names) == pins + len(mechanism.written_pairs)
    assert structure.mobility.is_determinate


def test_reference(decomposition_case, reference_plan):
    structure = decompose(reference_plan.build())
    check_whole(structure)
    expected = decomposition_case["expected"]
    driven = {b for _, b in reference_plan.drivers if (0, b) in map(tuple, reference_plan.drivers)}
    groups = [frozenset(g) for g in expected["groups_in_solving_order"] if not set(g) <= driven]
    assert set(numbered(structure)) == set(groups)
    assert structure.mobility.freedoms == expected["gruebler_F"]


def test_order_and_names_of_links_do_not_matter(reference_plan):
    groups = set(numbered(decompose(reference_plan.build())))
    for seed in range(10):
        order = list(range(reference_plan.links + 1))
        random.Random(seed).shuffle(order)
        shuffled = decompose(reference_plan.build(order, "x{}".format))
        check_whole(shuffled)
        assert set(numbered(shuffled)) == groups


# the fixture holds no state
@settings(max_examples=examples(60), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(seed=st.integers(0, 10**6), groups=st.integers(1, 12))
def test_groups_found_are_those_attached(random_plans, seed, groups):
    plan, made = random_plans(random.Random(seed), groups)
    structure = decompose(plan.build())
    check_whole(structure)
    assert set(numbered(structure)) == made


@pytest.mark.parametrize("seed", range(40))
def test_brute_force_by_rank_agrees(seed, random_plans):
    plan, _ = random_plans(random.Random(seed), 3, multiple=True)
    structure = decompose(plan.build())
    if structure.faults:
        with pytest.raises(StopIteration):
            plan.groups_by_rank()
    else:
        check_whole(structure)
        assert set(numbered(structure)) == plan.groups_by_rank()


def test_every_baranov_truss_with_any_link_fixed_is_one_group(counts, plan):
    for size, graphs in counts["counts_baranov"]["graph6_5_7_9"].items():
        for text in graphs:
            graph = nx.from_graph6_bytes(text.encode())
            for fixed in graph:
                number = {**{k: k for k in graph}, 0: fixed, fixed: 0}
                pins = [[number[a], number[b]] for a, b in graph.edges]
                structure = decompose(plan(int(size) - 1, pins).build())
                assert len(structure.groups) == 1
                check_whole(structure)


def test_solving_order_reads_as_written(bars):
    links = bars(frame="AD", crank="AB", p="BC", q="CDX", r="XY", s="YF", t="XZ", u="ZG", w="F", v="G")
    frame = link("frame", A=0, D=4, F=7, G=9)
    structure = decompose(Mechanism("m", frame, *links[1:-2], drive("crank")))
    assert [g.links for g in structure.groups] == [("p", "q"), ("r", "s"), ("t", "u")]


def test_driven_cylinder_between_moving_links_is_one_body(bars):
    links = bars(frame="AB", boom="AC", cylinder="BT", rod="Ct")
    cylinder = slide("rod", on="cylinder", at="t", through="T")
    structure = decompose(Mechanism("m", *links, cylinder, drive("rod", on="cylinder", values=1.0)))
    (group,) = structure.groups
    check_whole(structure)
    assert [body.links for body in group.bodies] == [("boom",), ("cylinder", "rod")]
    (step,) = group.bodies[1].driven
    assert (step.parent, step.link, step.pair) == ("cylinder", "rod", cylinder)
    assert [pair.members for pair in (*group.outer, *group.inner)] == [
        ("frame", "boom"), ("frame", "cylinder"), ("boom", "rod"),
    ]  # fmt: skip


def test_driven_pin_of_a_multiple_pin_is_between_its_two_links(bars):
    links = bars(frame="A", arm="AJ", hand="JB", rod="JC", tie="CD")
    links[0] = link("frame", A=0, D=5)
    structure = decompose(Mechanism("m", *links, drive("arm"), drive("hand", on="arm")))
    check_whole(structure)
    assert structure.ground.links == ("frame", "arm", "hand")
    assert [(s.parent, s.link, s.pair.name) for s in structure.ground.driven] == [
        ("frame", "arm", "A"), ("arm", "hand", "J(arm-hand)"),
    ]  # fmt: skip
    assert structure.groups[0].outer[0].name == "J(arm-rod)"


def test_base_of_a_composite_is_its_first_link_and_the_tree_leads_outwards(bars):
    links = bars(frame="AD", a="AB", b="BC", c="CE", d="EFD")
    structure = decompose(Mechanism("m", *links, drive("a", on="b"), drive("b", on="c")))
    (body,) = [b for g in structure.groups for b in g.bodies if "a" in b.links]
    assert body.links == ("a", "b", "c")
    assert [(step.parent, step.link) for step in body.driven] == [("a", "b"), ("b", "c")]


def test_pair_names_are_unique_even_where_links_have_dashes(bars):
    links = bars(**{"frame": "A", "a-b": "AJ", "a": "J", "b-c": "J", "c": "J"})
    structure = decompose(Mechanism("m", *links))
    names = [pair.name for pair in structure.pairs]
    assert len(names) == len(set(names)) == 4


def test_importing_does_not_load_networkx_or_scipy():
    code = "import sys, compoundkin.structure; print(sorted({'networkx', 'scipy'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_deterministic_across_hash_seeds():
    code = (
        "from compoundkin.model.mechanism import *\n"
        "from compoundkin.model.elements import *\nfrom compoundkin.structure import decompose\n"
        "L = [link('frame', A=0, D=4), link('a', A=0, B=1), link('b', B=0, C=3, E=1j), link('c', C=0, D=3)]\n"
        "s = decompose(Mechanism('m', *L, link('d', E=0, F=1), link('e', F=0, B=2)))\n"
        "print(s.faults, [g.links for g in s.groups], [str(l) for l in s.loops])"
    )
    runs = {
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True,
                       env={"PYTHONHASHSEED": seed, "PYTHONPATH": ":".join(sys.path)}).stdout
        for seed in ("1", "2")
    }  # fmt: skip
    assert len(runs) == 1


@pytest.mark.parametrize("ternary", [2, 10, 150])
def test_a_chain_of_ternary_links_with_legs_is_one_group(ternary, plan):
    """Large enough, at the end, for the sparse confirmation."""
    chain = [[k, k + 1] for k in range(1, ternary)]
    legs = [1, *range(1, ternary + 1), ternary]
    pins = [[k, ternary + 1 + i] for i, k in enumerate(legs)]
    pins += [[0, ternary + 1 + i] for i in range(len(legs))]
    structure = decompose(plan(2 * ternary + 2, chain + pins).build())
    check_whole(structure)
    (group,) = structure.groups
    assert (group.class_, group.order) == (3, ternary + 2)


@pytest.mark.parametrize(("size", "amount"), [(6, 3), (24, 3), pytest.param(300, 1, marks=pytest.mark.full)])
def test_floating_rings_count_as_determined_and_are_not(size, amount, plan):
    graph = nx.circular_ladder_graph(size // 2)
    pins = [[0, size + 1], *([a + 1, b + 1] for a, b in graph.edges)]
    structure = decompose(plan(size + 1, pins, drivers=[(0, size + 1)]).build())
    assert structure.groups == ()
    assert [(fault.kind, len(fault.links), fault.amount) for fault in structure.faults] == [
        ("over", size, amount), ("under", size, amount),
    ]  # fmt: skip
