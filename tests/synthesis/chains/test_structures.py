"""Names of decomposed mechanisms and their groups; mechanisms made of chains."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import InvalidInput, UnknownName
from compoundkin.files import load
from compoundkin.synthesis.chains import (
    chains,
    group_truss,
    inversions,
    mechanism_from,
    structure_name,
    symmetric_drivers,
)
from compoundkin.synthesis.composer import random_mechanism
from compoundkin.view.report import report

# Every six-bar and each seventh inversion of eight links, with all places for a driver.
CASES = [
    (one, driver) for one in [*inversions(6), *inversions(8)[::7]] for driver in symmetric_drivers(one.chain, one.frame)
]


@pytest.mark.parametrize("name", ["disc-cam-offset-roller", "oscillating-roller-follower"])
def test_a_roller_is_a_part_of_its_follower(name):
    # cam, follower and frame; the contact counts as a binary link: the chain is a loop of four
    title = structure_name(ck.decompose(load(name))).title
    assert "mobility" not in title
    assert title.startswith("four-bar") or title.endswith("derived from four-bar")


def test_six_bars_have_no_variety_and_their_symmetries():
    name = structure_name(ck.decompose(load("stephenson-iii")))
    assert name.variety == 0
    assert sorted(map(len, name.equivalent_links)) == [2, 2, 2]
    facts = dict(report(ck.decompose(load("stephenson-iii"))).section("chain").blocks[0].facts)
    assert facts["links"] == "4 binary, 2 ternary"


def test_a_chain_with_a_part_of_less_mobility_has_variety():
    # two four-bars that share the frame: each moves alone, with mobility 1 of 2
    two = next(chain for chain in chains(7, mobility=2) if chain.joints_of_parts)
    assert structure_name(ck.decompose(mechanism_from(two))).variety == 1


def test_a_loop_of_slides_is_not_called_a_truss():
    wedge = ck.Mechanism("wedge", ck.link("frame", A=0, C=3), ck.link("w", a=0, b=1), ck.link("v", c=0, d=1),
                         ck.slide("w", on="frame", at="a", through="A"), ck.slide("v", on="w", at="c", through="b"),
                         ck.slide("v", on="frame", at="d", through="C", name="top"))  # fmt: skip
    assert structure_name(ck.decompose(wedge)).title == "wedge mechanism (3 slides)"


def test_huge_mechanisms_have_a_modest_name():
    structure = ck.decompose(random_mechanism(300, seed=1, kinds=("RRR",), multiple=0.0))
    assert structure_name(structure).title == "602-link chain"
    assert "not computed for more than" in report(structure).text()


@pytest.mark.parametrize(("one", "driver"), CASES)
def test_a_mechanism_made_of_a_chain_has_its_name_and_the_groups_of_theory(one, driver):
    mechanism = mechanism_from(one.chain, one.frame, driver)
    structure = ck.decompose(mechanism)
    assert structure.faults == ()
    assert structure_name(structure).title == mechanism.title
    assert sum(len(group.bodies) for group in structure.groups) == one.chain.links - 2
    for group in structure.groups:
        # each is one of the atlas; a driver between two moving links may make a part of a group rigid on its own
        assert len(group_truss(group)) == 1 or one.frame not in driver


def test_the_drawn_pose_assembles():
    mechanism = mechanism_from(chains(8)[3])
    motion = ck.solve(mechanism)
    assert motion.assembled.all()
    for letter, place in mechanism.sketch.items():
        assert np.abs(motion.points[letter].position - place).max() < 1e-6


def test_chains_of_more_freedoms_get_as_many_drivers():
    structure = ck.decompose(mechanism_from(chains(9, mobility=2)[7]))
    assert structure.faults == ()
    assert structure.mobility.drivers == 2


def test_drivers_that_cannot_be():
    with pytest.raises(UnknownName, match="no such link"):
        mechanism_from(chains(4)[0], 9)
    chain = chains(4)[0]
    opposite = next(k for k in range(1, 4) if k not in chain.neighbours[0])
    with pytest.raises(InvalidInput, match="are not joined"):
        mechanism_from(chain, 0, opposite)
