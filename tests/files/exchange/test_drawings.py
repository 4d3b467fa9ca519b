"""Drawings: from a mechanism to a drawing of one pose and back it is the same mechanism."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import InvalidInput
from compoundkin.files.exchange.drawing import Drawing, DrawnDriver, DrawnLink, DrawnMass, DrawnPoint, drawing_of
from compoundkin.files.exchange.drawn_mechanism import mechanism_of
from compoundkin.files.exchange.posed_mechanism import posed_mechanism
from compoundkin.files.mechanism_files import dumps, loads
from tests.catalog import NAMES
from tests.catalog import mechanism as catalog_mechanism
from tests.files.exchange.shown_catalog import shown
from tests.support import KINDS_OF_DYAD, random_sketch

# What no drawing of joints can say.
REFUSED = ("cams", "faces", "rollings", "drives", "roll_arounds")


def same_motion(one: ck.Mechanism, other: ck.Mechanism, step: float, tolerance: float = 1e-9) -> None:
    """Compare all points of two mechanisms a step of the drivers from the same drawn pose."""
    first, second = posed_mechanism(one), posed_mechanism(other)
    places = {k: first.place(links[0], k) for k, links in one.carriers.items()}
    for k, place in places.items():
        assert abs(second.place(other.carriers[k][0], k) - place) <= tolerance * one.geometry.size
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        moved = [
            ck.solve(shown.mechanism, {k: v + step for k, v in shown.values.items()}, hint=places)
            for shown in (first, second)
        ]
    for k in one.carriers:
        a, b = (motion.points[k].position for motion in moved)
        np.testing.assert_allclose(a, b, rtol=0, atol=tolerance * one.geometry.size)


@pytest.mark.parametrize("seed", range(12))
def test_random_mechanisms_come_back(seed: int) -> None:
    rng = np.random.default_rng(seed)
    sketch = random_sketch(rng, rng.choice(KINDS_OF_DYAD, 3))
    mechanism = sketch.mechanism()
    back = mechanism_of(drawing_of(posed_mechanism(mechanism)), "drawing").mechanism
    same_motion(mechanism, back, 1e-3)
    assert loads(dumps(back)) == back


@pytest.mark.full
def test_the_catalog_comes_back() -> None:
    said, refused = 0, []
    for name in NAMES:
        mechanism = catalog_mechanism(name)
        try:
            drawing = drawing_of(shown(name))
        except InvalidInput as error:
            refused += [problem.where.split("[")[0].split(".")[0] for problem in error.problems]
            continue
        said += 1
        back = mechanism_of(drawing, "drawing").mechanism
        assert back.unit == mechanism.unit
        for point in drawing.points:
            assert set(back.carriers[point.key]) == set(point.links)
            assert back.sketch[point.key] == point.at
        # solved again is the drawn pose only where guides, wheels and arcs have come back too
        for one in (drawing.guides or drawing.arcs or drawing.gears or drawing.racks)[:1]:
            again = posed_mechanism(back)
            assert all(abs(again.place(p.links[0], p.key) - p.at) < 1e-9 * mechanism.geometry.size
                       for p in drawing.points), (name, one.key)  # fmt: skip
    assert said >= 85
    assert set(refused) <= set(REFUSED)


def test_several_drivers_start_together_from_the_drawn_pose() -> None:
    robot = mechanism_of(replace(drawing_of(shown("3-rrr")), drivers=tuple(
        replace(one, travel=None) for one in drawing_of(shown("3-rrr")).drivers)), "sample").mechanism  # fmt: skip
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(robot)
    assert motion.assembled[0]
    assert abs(motion.points["A1"].position[0] - robot.sketch["A1"]) < 1e-9


PLACES = {"A": (0j, "frame", "crank.1"), "B": (1j, "crank.1", "rod"), "C": (4 + 2j, "rod", "rocker"),
          "D": (3 + 0j, "frame", "rocker")}  # fmt: skip
FOUR_BAR = Drawing(
    "four-bar",
    tuple(DrawnLink(name) for name in ("frame", "crank.1", "rod", "rocker")),
    tuple(DrawnPoint(key, at, tuple(links)) for key, (at, *links) in PLACES.items()),
    drivers=(DrawnDriver("crank.1", "frame", "A", 2.0),),
)


def test_a_file_holds_one_pose() -> None:
    with pytest.raises(ck.errors.InvalidInput, match="at: it is given 2 poses"):
        posed_mechanism(catalog_mechanism("crank-rocker"), {"crank": np.array([0.0, 1.0])})


def test_names_that_cannot_be_are_changed_and_told() -> None:
    found = mechanism_of(FOUR_BAR, "sample")
    assert "crank-1" in found.mechanism.links
    assert found.notes == ("names are unique here, without dots and commas: 'crank.1' is 'crank-1'",)


def test_what_does_not_move_anything_is_counted_once() -> None:
    found = mechanism_of(replace(FOUR_BAR, dropped=(("colour", 3), ("mass", 1), ("text", 0))), "sample")
    assert found.notes[-1] == "left out, for it does not move anything: 3 colours, 1 mass"


def test_a_link_that_is_joined_to_nothing_is_told_with_what_may_be_meant() -> None:
    flap = DrawnPoint("E", 5j, ("flap",), where="line 9"), DrawnPoint("F", 5j, ("rod",))
    links = (*FOUR_BAR.links, DrawnLink("flap", where="line 8"))
    with pytest.raises(
        InvalidInput, match=r"line 8: link 'flap': it is joined to nothing.*did you mean to join E and F"
    ):
        mechanism_of(replace(FOUR_BAR, points=(*FOUR_BAR.points, *flap), links=links), "sample")


def test_an_odd_mass_is_told_with_the_rest_and_not_warned_about() -> None:
    odd = replace(FOUR_BAR, masses=(DrawnMass("rod", 1.0, 1e-9, 2 + 1j),), units=("mm", "kg", "N"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = mechanism_of(odd, "sample")
    assert any("inertia" in note for note in found.notes)
