"""Reading graphs; multiple pins, higher pairs and parts."""

from __future__ import annotations

import networkx as nx
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compoundkin.synthesis.chains import Joint, Joints
from compoundkin.synthesis.chains.chain_names import derived_chains, number_of_derived_chains, trees
from compoundkin.synthesis.chains.mechanism_names import joints_of
from tests import catalog


def joints_in(name: str) -> Joints:
    return joints_of(catalog.structure(name).graph)


def test_the_count_of_freedoms_is_that_of_the_structure():
    for name in catalog.CHOSEN:
        structure = catalog.structure(name)
        joints = joints_of(structure.graph)
        assert joints.mobility == structure.mobility.freedoms + structure.mobility.passive, name
        assert dict(zip(joints.links, joints.degrees, strict=True)) == dict(structure.graph.nodes(data="pairs")), name


def test_pins_of_several_links_are_one_joint_whatever_pairs_they_are_drawn_with():
    peaucellier = joints_in("peaucellier")
    assert sorted(len(joint.links) for joint in peaucellier.joints) == [2, 2, 3, 3, 3, 3]
    squeezer = joints_in("andrews-squeezer")
    assert {tuple(squeezer.links[k] for k in joint.links) for joint in squeezer.multiple} == {
        ("frame", "K5", "K7"),
        ("K2", "K3", "K4", "K6"),
    }


@given(st.integers(2, 6))
def test_trees_are_all_trees_and_each_once(size):
    found = [frozenset(frozenset(pair) for pair in tree) for tree in trees(range(size))]
    # A. Cayley 1889
    assert len(set(found)) == len(found) == size ** (size - 2)
    assert all(nx.is_tree(nx.Graph([tuple(pair) for pair in tree])) for tree in found)


@pytest.mark.parametrize("name", ["toggle-press", "peaucellier", "andrews-squeezer", "slider-crank"])
def test_derived_chains_keep_the_count(name):
    joints = joints_in(name)
    chains = list(derived_chains(joints))
    assert 0 < len(chains) <= number_of_derived_chains(joints)
    assert {(chain.links, chain.mobility) for chain in chains} == {(len(joints.links), joints.mobility)}


def test_a_higher_pair_is_a_binary_link_between_two_pairs():
    gears = Joints(("frame", "pinion", "wheel"), (Joint((0, 1)), Joint((0, 2)), Joint((1, 2), "G", held=1)))
    (chain,) = derived_chains(gears)
    assert (chain.links, chain.mobility, gears.mobility) == (4, 1, 1)
    assert chain.is_loop


def test_the_form_of_a_mechanism_tells_letters_and_marks_apart():
    pins = Joints(("a", "b", "c", "d"), tuple(Joint((k, (k + 1) % 4)) for k in range(4)))
    slide = Joints(pins.links, (*pins.joints[:3], Joint((3, 0), "P")))
    assert pins.canonical().symmetries == 8
    assert slide.canonical().symmetries == 2
    assert slide.canonical().code != pins.canonical().code
    assert pins.canonical({0: "frame"}).code == pins.canonical({2: "frame"}).code
    assert slide.canonical({0: "frame"}).code != slide.canonical({1: "frame"}).code


def test_parts_hang_together_at_links_and_pins():
    excavator = joints_in("excavator-arm")
    parts = [{excavator.links[k] for k in block} for block in excavator.blocks()]
    assert {"frame", "boom", "boom-barrel", "boom-rod"} in parts
    assert {"boom", "stick", "stick-barrel", "stick-rod"} in parts
    assert len(parts) == 3
    assert len(joints_in("peaucellier").blocks()) == 1
