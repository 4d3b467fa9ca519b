"""Names of mechanisms whose names are known, and that names do not depend on how links are called."""

from __future__ import annotations

import random

import networkx as nx
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compoundkin.base.errors import UnknownName
from compoundkin.files import load
from compoundkin.structure import decompose
from compoundkin.synthesis.chains import (
    Chain,
    ChainName,
    Joint,
    Joints,
    chain_name,
    chains,
    inversions,
    name_of,
    trusses,
)
from compoundkin.synthesis.chains.mechanism_names import loop_letters, slider_name
from tests import catalog
from tests.catalog import THIRD

TITLES = {
    "watt-i": "Watt I",
    "watt-ii": "Watt II",
    "watt-ii-driven-at-ternary": "Watt II",
    "stephenson-i": "Stephenson I",
    "stephenson-ii": "Stephenson II",
    "stephenson-ii-driven-at-binary": "Stephenson II",
    "stephenson-iii": "Stephenson III",
    "stephenson-iii-driven-at-dyad": "Stephenson III",
    "stephenson-iii-driven-at-rocker": "Stephenson III",
    "stephenson-iii-floating-driver": "Stephenson III",
    # W. W. Klann's leg and the Atkinson engine are Stephenson III, a windscreen wiper is two four-bars in a row
    "klann-leg": "Stephenson III",
    "windscreen-wiper": "Watt II",
    "crank-rocker": "four-bar",
    "parallelogram": "four-bar",
    "five-bar": "five-bar",
    "slider-crank": "slider-crank",
    "slider-crank-offset": "slider-crank",
    "slider-crank-driven-by-piston": "slider-crank",
    "scott-russell": "slider-crank",
    "elliptic-trammel": "elliptic trammel",
    "oldham-coupling": "Oldham coupling",
    "scotch-yoke": "Scotch yoke",
    "rapson-slide": "Rapson slide",
    "hand-pump": "slider-crank driven at the connecting rod",
    "whitworth-turning-guide": "inverted slider-crank with turning or oscillating guide",
    "oscillating-guide": "inverted slider-crank with turning or oscillating guide",
    "crank-shaper": "Watt II with 2 slides",
    "toggle-press": "6-link chain with one double pin and one slide, derived from Stephenson III or Watt II",
    "peaucellier": "8-link chain with 4 double pins, derived from 36 inversions of simple-jointed chains",
}
ALSO = {
    "hand-pump": "hand pump",
    "whitworth-turning-guide": "Whitworth",
    "oscillating-guide": "crank and slotted lever",
    "oscillating-cylinder": "oscillating cylinder",
}
# The codes of the two are found by intersecting lines of instant centres, `counts_kennedy_determinate`.
DOUBLE_BUTTERFLY, SINGLE_FLIER = "G?q`qg", "G?qb_w"


def named(name: str) -> ChainName:
    mechanism = load(name)
    return name_of(decompose(mechanism).graph, "frame", mechanism.drives[0].link)


def graph_of(*pairs: str) -> nx.MultiGraph:
    """A graph of links with letters for names; a pair is its two links, then a colon and its code if it is no pin."""
    graph = nx.MultiGraph()
    for pair in pairs:
        links, _, code = pair.partition(":")
        graph.add_edge(*links, code=code or "R", **({"held": 1} if code == "G" else {}))
    return graph


def test_titles_of_the_catalog_and_well_known_mechanisms_of_the_same_structure():
    assert {name: named(name).title for name in TITLES} == TITLES
    assert not [name for name, also in ALSO.items() if also not in named(name).also]


@catalog.each(THIRD)
def test_every_mechanism_of_the_catalog_has_a_name_that_renaming_its_links_does_not_change(name):
    mechanism = load(name)
    graph = decompose(mechanism).graph
    for _, _, data in graph.edges(data=True):
        data["pin"] = data["pair"].letters[0]
        data["held"] = data["pair"].held
        del data["pair"]
    links = list(graph)
    mixed = random.Random(5).sample(links, len(links))
    other = nx.MultiGraph()
    calling = dict(zip(links, (f"k{k}" for k in range(len(links))), strict=True))
    other.add_nodes_from(calling[link] for link in mixed)
    other.add_edges_from((calling[b], calling[a], data) for a, b, data in reversed(list(graph.edges(data=True))))
    first = name_of(graph, "frame", mechanism.drives[0].link)
    second = name_of(other, calling["frame"], calling[mechanism.drives[0].link])
    for field in ("title", "chain", "driven", "mobility", "assortment", "derived_from", "symmetries", "code"):
        assert getattr(first, field) == getattr(second, field)
    assert sorted(first.parts) == sorted(second.parts)


def test_six_bar_inversions_have_the_five_names():
    found = [chain_name(inversion.chain, inversion.frame) for inversion in inversions(6)]
    assert sorted(found) == ["Stephenson I", "Stephenson II", "Stephenson III", "Watt I", "Watt II"]


def test_eight_links_of_indeterminate_centres():
    butterfly, flier = Chain.from_code(DOUBLE_BUTTERFLY), Chain.from_code(SINGLE_FLIER)
    assert chain_name(butterfly).startswith("double butterfly")
    assert chain_name(flier).startswith("single flier")
    # the first has no four-bar loop, the second one only
    loops = [[len(loop) for loop in nx.simple_cycles(nx.Graph(c.pairs), 4)] for c in (butterfly, flier)]
    assert loops == [[], [4]]


@pytest.mark.parametrize("links", [8, 10])
def test_chains_have_names_of_their_own(links):
    found = [chain_name(chain) for chain in chains(links)]
    assert len(set(found)) == len(found)
    assert all(f"{links}-link chain {number}" in name for number, name in enumerate(found, 1))


@given(st.sampled_from(inversions(8)), st.permutations(range(8)))
def test_an_inversion_keeps_its_name_when_links_are_renumbered(inversion, order):
    chain, frame = inversion.chain, inversion.frame
    other = Chain.of(8, [(order[a], order[b]) for a, b in chain.pairs])
    assert chain_name(other, order[frame]) == chain_name(chain, frame)


def test_inversions_of_one_chain_have_different_names():
    found = [chain_name(inversion.chain, inversion.frame) for inversion in inversions(8)]
    assert len(set(found)) == len(found) == 71


def test_trusses_and_loops():
    assert [chain_name(truss) for truss in trusses(7)] == [f"7-link truss {k}" for k in (1, 2, 3)]
    assert chain_name(Chain.of(12, [(k, (k + 1) % 12) for k in range(12)])) == "12-bar"


# Reuleaux's inversions: which link of the loop a-b-c-d is fixed, the slides between which.
@pytest.mark.parametrize(
    ("pairs", "frame", "title"),
    [
        (("ab", "bc", "cd", "da:P"), "a", "slider-crank"),
        (("ab", "bc", "cd", "da:P"), "d", "slider-crank"),
        (("ab", "bc", "cd", "da:P"), "b", "inverted slider-crank"),
        (("ab", "bc", "cd:P", "da:P"), "d", "elliptic trammel"),
        (("ab", "bc", "cd:P", "da:P"), "b", "Oldham coupling"),
        (("ab", "bc", "cd:P", "da:P"), "a", "Scotch yoke"),
        (("ab", "bc:P", "cd", "da:P"), "c", "Rapson slide"),
        (("ab", "bc:P", "cd:P", "da:P"), "a", "four-link chain RPPP, frame RP"),
        (("ab", "bc", "cd", "da:P"), None, "slider-crank chain"),
    ],
)
def test_loops_of_four_links_with_slides(pairs, frame, title):
    assert name_of(graph_of(*pairs), frame).title == title


@pytest.mark.parametrize(
    ("guide", "frame", "title", "also"),
    [
        (3, 3, "slider-crank", ()),
        (3, 2, "slider-crank with fixed block", ("hand pump",)),
        (3, 0, "inverted slider-crank with turning or oscillating guide", None),
        (3, 1, "inverted slider-crank with swinging block", ("oscillating block",)),
    ],
)
def test_which_link_of_the_slide_carries_the_guide(guide, frame, title, also):
    """Links 3 and 0, 0 and 1, 1 and 2 are pinned; 2 and 3 slide."""
    pins = (Joint((3, 0)), Joint((0, 1)), Joint((1, 2)))
    name = slider_name(Joints(("a", "b", "c", "d"), (*pins, Joint((2, 3), "P", guide=guide))), frame, None)
    assert name is not None
    assert name.title == title
    assert also is None or name.also == also


def test_letters_of_what_is_not_one_loop():
    two = Joints(tuple("abcd"), (Joint((0, 1)), Joint((0, 1), "P"), Joint((2, 3)), Joint((2, 3), "P")))
    assert loop_letters(two) == ""
    assert loop_letters(Joints(("a", "b"), (Joint((0, 1)),))) == ""


@pytest.mark.parametrize(
    ("pairs", "title"),
    [
        (("ab", "ac", "bc:G"), "3-link chain with one higher pair, derived from four-bar"),
        (("ab", "bc", "cd", "de", "ea", "be:G"), "5-link chain with one higher pair, derived from Stephenson I"),
        (("ab", "bc", "cd", "de", "ea", "bd:G"), "5-link chain with one higher pair, derived from Stephenson II"),
        (("ab", "bc"), "open chain"),
        (("ab", "bc", "ca"), "3-link truss 1, inversion 1"),
        (("ab", "bc", "cd", "da", "ac"), "4-link structure of mobility -1"),
        (("ab", "bc", "ca", "cd", "de", "ea"), "5-link structure of mobility 0"),
        (("ab", "bc", "ca", "cd", "de", "ef", "fa"), "6-link chain with a rigid part"),
        (("ab", "bc", "cd", "da", "de"), "5-link chain of mobility 2, one link of it loose"),
    ],
)
def test_other_structures(pairs, title):
    assert name_of(graph_of(*pairs), "a").title == title


def test_a_fractionated_chain_and_its_parts():
    plain = name_of(graph_of("ab", "bc", "cd", "da", "de", "ef", "fg", "gd"), "b")
    assert plain.chain == "7-link chain 4 of mobility 2"
    assert plain.parts == ("four-bar", "four-bar")
    name = name_of(graph_of("ab", "bc", "cd", "da:P", "de", "ef", "fg", "gd"), "b")
    assert name.fractionated_at == ("d",)
    assert sorted(name.parts) == ["four-bar", "inverted slider-crank"]
    assert name.assortment == "6 binary, 1 quaternary"


def test_chains_that_share_a_pin_fall_apart_there():
    graph = nx.MultiGraph()
    for first, second, pin in ["abA", "bcB", "cdC", "efF", "fgG", "ghH", "daJ", "aeJ", "ehJ"]:
        graph.add_edge(first, second, pin=pin)
    name = name_of(graph, "a")
    assert name.mobility == 3
    assert name.parts == ("four-bar", "four-bar")
    assert name.fractionated_at == ("a-d-e-h",)


def test_the_driver_is_described_and_part_of_the_code():
    next_to, away = named("stephenson-iii"), named("stephenson-iii-floating-driver")
    assert next_to.driven == "binary link next to the frame"
    assert away.driven == "binary link away from the frame"
    assert next_to.code != away.code
    assert named("watt-ii-driven-at-ternary").driven == "ternary link next to the frame"


def test_several_drivers():
    mechanism = load("five-bar")
    graph, driven = decompose(mechanism).graph, [drive.link for drive in mechanism.drives]
    name = name_of(graph, "frame", driven)
    assert name.driven == "binary link next to the frame, binary link next to the frame"
    assert len({name.code, name_of(graph, "frame", driven[0]).code, name_of(graph, "frame").code}) == 3


def test_equivalent_links_and_pairs_of_watts_chain():
    name = named("watt-ii")
    assert name.symmetries == 4
    assert sorted(map(len, name.equivalent_links)) == [2, 4]
    assert sorted(map(len, name.equivalent_pairs)) == [1, 2, 4]
    assert ("frame", "DCE") in name.equivalent_links


def test_an_unknown_frame_is_refused():
    with pytest.raises(UnknownName, match="did you mean 'frame'"):
        name_of(catalog.structure("watt-i").graph, "frme")


def test_a_mechanism_of_very_many_links_is_named_without_comparing_them():
    graph = nx.MultiGraph()
    nx.add_cycle(graph, range(3000))
    name = name_of(nx.relabel_nodes(graph, {k: f"k{k}" for k in graph}), "k0", "k1")
    assert (name.title, name.mobility, name.assortment) == ("3000-bar", 2997, "3000 binary")
    assert (name.symmetries, name.code) == (0, "")
