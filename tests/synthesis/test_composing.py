"""Mechanisms composed of groups fall apart into the same groups, in order."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import compoundkin as ck
from compoundkin.base.errors import InvalidInput, UnknownName
from compoundkin.synthesis.chains import assur_group, assur_groups, group_name, group_truss
from compoundkin.synthesis.composer import DYAD_NAMES, Composer, random_mechanism
from tests.support import examples


def groups(mechanism: ck.Mechanism) -> list[tuple[str, frozenset[str]]]:
    structure = ck.decompose(mechanism)
    assert structure.faults == ()
    return [(group.name, frozenset(group.links)) for group in structure.groups]


@given(st.lists(st.sampled_from([*DYAD_NAMES, "triad", "4-link group 1"]), max_size=8), st.integers(0, 10**6))
@settings(max_examples=examples(30), deadline=None)
def test_groups_come_back_in_order(kinds, seed):
    composer = Composer("m").drive("crank")
    known, choice = ["frame", "crank"], np.random.default_rng(seed)
    for k, kind in enumerate(kinds):
        size, outer = (2, 2) if kind in DYAD_NAMES else (4, assur_group(kind).outer)
        links = [f"{k}-{n}" for n in range(size)]
        to = choice.choice(known, outer, replace=len(known) < outer)
        composer.attach(kind, links, [str(link) for link in to])
        known += links
    found = groups(composer.mechanism())
    assert [links for _, links in found] == [frozenset(f"{k}-{n}" for n in range(2 if kind in DYAD_NAMES else 4))
                                             for k, kind in enumerate(kinds)]  # fmt: skip
    assert [name for name, _ in found if len(name) == 3] == [kind for kind in kinds if kind in DYAD_NAMES]


@pytest.mark.parametrize("number", range(1, 11))
def test_every_group_of_six_links_is_attached_and_found_with_its_truss(number):
    group = assur_groups(6)[number - 1]
    composer = Composer("m").drive("crank").attach("RRR", ("a", "b"), to=("crank", "frame"))
    to = ["frame", "crank", "a", "b"][: group.outer]
    composer.attach(f"6-link group {number}", [f"g{k}" for k in range(6)], to=to)
    _, found = ck.decompose(composer.mechanism()).groups
    assert found.order == group.outer
    assert set(found.links) == {f"g{k}" for k in range(6)}
    assert group_truss(found) == (f"7-link truss {ck_number(group)}",)


def ck_number(group) -> int:
    from compoundkin.synthesis.chains import number_of

    return number_of(group.truss)


def test_places_and_letters_are_kept_and_it_assembles_as_drawn():
    composer = Composer("six").place(A=(0, 0), B=(0, 1), C=(3, 2), D=(4, 0), E=(6, 0))
    composer.drive("crank", "A on frame").attach("RRR", ("rod", "rocker"), to=("B on crank", "D on frame"), at=("C",))
    composer.attach("RRP", ("bar", "block"), to=("C on rod", "E on frame"), at=("F",)).place(F=(6, 1))
    mechanism = composer.mechanism(unit="m")
    assert mechanism.pins["C"] == ("rod", "rocker", "bar")
    assert [name for name, _ in groups(mechanism)] == ["RRR", "RRP"]
    motion = ck.solve(mechanism, {"crank": np.pi / 2})
    assert abs(complex(motion.points["C"].position.item()) - (3 + 2j)) < 1e-12
    assert abs(complex(motion.points["F"].position.item()) - (6 + 1j)) < 1e-12


def test_random_mechanisms_are_reproducible_and_assemble_as_drawn():
    first, second = random_mechanism(60, seed=5), random_mechanism(60, seed=5)
    assert first == second
    assert first != random_mechanism(60, seed=6)
    with warnings.catch_warnings():
        warnings.simplefilter("error", ck.errors.UnassembledPoses)
        motion = ck.solve(first)
    drawn = np.array([first.sketch[letter] for letter in first.carriers])
    found = np.array([motion.points[letter].position.item() for letter in first.carriers])
    assert np.max(np.abs(found - drawn)) < 1e-6


@pytest.mark.parametrize(("groups", "seed"), [(2, 415), (3, 158), (3, 659)])
def test_outer_pins_of_a_random_group_are_not_one_pin(groups, seed):
    # one pin of both links, by two links that carry it, was refused beside the slide between them
    motion = ck.solve(random_mechanism(groups, seed=seed))
    assert not motion.failed.any()


def test_a_large_one_falls_into_its_groups():
    mechanism = random_mechanism(400, seed=2, kinds=(*DYAD_NAMES, "triad"))
    found = groups(mechanism)
    assert [sorted({link.split("-")[0] for link in links}) for _, links in found] == [[str(k)] for k in range(400)]


@pytest.mark.parametrize("links", [2, 4, 6])
def test_names_of_groups_are_those_they_are_found_by(links):
    for group in assur_groups(links):
        assert assur_group(group_name(group)).code == group.code


@pytest.mark.parametrize(
    ("build", "error", "said"),
    [
        (lambda c: c.attach("RRQ", ("x", "y"), to=("frame", "crank")), UnknownName, "no such Assur group"),
        (lambda c: c.attach("RRR", ("x", "y"), to=("frame", "crnk")), UnknownName, "did you mean 'crank'"),
        (lambda c: c.attach("RRR", ("x",), to=("frame", "crank")), InvalidInput, "has 2 links"),
        (lambda c: c.attach("RRR", ("x", "crank"), to=("frame", "crank")), InvalidInput, "there is a link 'crank'"),
        (lambda c: c.attach("RRR", ("x", "y"), to=("frame",)), InvalidInput, "2 outer pairs, but entries for 1"),
        (lambda c: c.attach("RRR", ("x", "y"), to=("frame", "Q on crank"), at=("A",)), InvalidInput, "A is a point of"),
        (lambda c: c.drive("z", pair="X"), InvalidInput, "no pair to drive"),
    ],
)
def test_what_cannot_be_attached(build, error, said):
    with pytest.raises(error, match=said):
        build(Composer("m").drive("crank", "A on frame"))
