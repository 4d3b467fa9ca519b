"""Tables of frames and drivers against what theory says of them, and against inverted mechanisms taken apart."""

from __future__ import annotations

import time

import pytest

import compoundkin as ck
from compoundkin.base.errors import InvalidInput
from compoundkin.files import load
from compoundkin.model.pairs.contract import as_drivable
from compoundkin.synthesis.alternatives import alternatives
from compoundkin.synthesis.chains import chains, mechanism_from, structure_name
from compoundkin.synthesis.chains.mechanism_names import group_count
from compoundkin.synthesis.inversion import with_driver, with_frame
from compoundkin.view.report.atlas_sections import alternatives_section
from tests import catalog
from tests.kinematics.assembly.laman import laman_number


def test_a_four_bar_has_one_frame_and_two_places_for_a_driver():
    # by hand: all links of the loop are alike; a driver is next to the frame or opposite to it, two pins each
    found = alternatives(load("crank-rocker"))
    assert [(choice.frame, choice.title, choice.class_, choice.configurations, choice.alike) for choice in found] == [
        ("frame", "four-bar", 2, 2, 8),
        ("frame", "four-bar", 2, 2, 8),
    ]


@pytest.mark.parametrize("name", ["stephenson-ii", "watt-i", "geared-five-bar"])
def test_every_choice_is_the_inverted_mechanism_taken_apart(name):
    mechanism = load(name)
    found = alternatives(mechanism)
    places = sum(len(links) * (len(links) - 1) // 2 for links in mechanism.pins.values())
    places += sum(as_drivable(pair) is not None and len(pair.members) == 2 for pair in mechanism.written_pairs)
    assert sum(choice.alike for choice in found) == places * len(mechanism.links)
    assert sum(choice.present for choice in found) == 1
    made = {frame: with_frame(mechanism, frame) for frame in dict.fromkeys(choice.frame for choice in found)}
    for choice in found:
        (place,) = choice.drivers
        names = {choice.frame: "frame", "frame": "old frame"} if choice.frame != "frame" else {}
        words = {"link": names.get(place.link, place.link), "on": names.get(place.on, place.on), "pair": place.pair}
        structure = ck.decompose(with_driver(made[choice.frame], **words, values=0.0))
        groups = tuple((group.name, group.class_, group.order) for group in structure.groups)
        assert sorted(groups) == sorted(choice.groups)
        assert bool(structure.faults) == bool(choice.faults)
        assert structure_name(structure).title == choice.title


def test_what_makes_a_stephenson_chain_dyadic_is_said():
    # driven at its dyad's link a Stephenson III needs a class III group, driven in its four-bar loop it does not
    section = alternatives_section(catalog.structure("stephenson-iii-driven-at-dyad"))
    assert any("Drive AB on frame (A)" in getattr(block, "text", "") for block in section.blocks)
    section = alternatives_section(catalog.structure("stephenson-iii"))
    assert any(getattr(block, "text", "") == "The mechanism is dyadic as it is." for block in section.blocks)


def test_configurations_of_a_triad_are_six_as_by_its_laman_graph():
    (group,) = catalog.structure("class-iii-six-bar").groups
    # base and platform triangles joined by three bars (the Desargues framework): 24 realizations, up to a reflection
    # of each of the two triangles, which are links here
    prism = [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)]
    assert group_count(group) == laman_number(prism) // 4 == 6


@pytest.mark.parametrize("number", [0, 57, 229])
def test_ten_links_take_no_time(number):
    mechanism = mechanism_from(chains(10)[number])
    start = time.process_time()
    found = alternatives(mechanism)
    # two seconds on a quiet machine; more where others use it
    assert time.process_time() - start < 6.0
    assert sum(choice.alike for choice in found) == 10 * 13


def test_too_many_choices_are_refused_and_the_report_takes_the_present_frame():
    from compoundkin.synthesis.composer import random_mechanism

    mechanism = random_mechanism(20, seed=1, kinds=("RRR",))
    with pytest.raises(InvalidInput, match="name some frames"):
        alternatives(mechanism)
    assert alternatives_section(ck.decompose(mechanism)).blocks[0].text.startswith("The frame as it is")


def test_nothing_to_drive():
    structure = ck.decompose(
        ck.Mechanism("m", ck.link("frame", A=0, D=4), ck.link("a", A=0, B=3), ck.link("b", B=0, D=3))
    )
    assert alternatives(structure) == ()
