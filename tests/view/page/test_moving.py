"""A motion as data for a page: unpacked again, it is what was solved."""

import base64
import json
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import CompoundkinError
from compoundkin.files import load
from compoundkin.files.shipped_mechanisms import shipped
from compoundkin.view.page.markup import packed_doubles, packed_floats
from compoundkin.view.page.motion_data import FEWEST_POSES, MOST_POSES, MotionData
from compoundkin.view.page.viewer import framed_player, player, viewer, viewer_of
from compoundkin.view.report.pose_sample import Sample
from tests import catalog


def unpacked(packed: Any, count: int) -> np.ndarray:
    if packed is None:
        return np.full(count, np.nan)
    if isinstance(packed, float | int):
        return np.full(count, float(packed))
    form = {"d": "<f8", "f": "<f4"}[packed[0]]
    return np.frombuffer(base64.b64decode(packed[2:]), form).astype(float)


def six_bar(poses: int = 37) -> ck.results.Motion:
    return ck.solve(load("six-bar"), {"crank": np.linspace(0, 2 * np.pi, poses)}, speed=10)


def test_packing_is_exact_or_has_seven_digits() -> None:
    values = np.array([np.pi, -1e-300, np.nan, 1e300, -0.0])
    np.testing.assert_array_equal(unpacked(packed_doubles(values), 5), np.where(values == 0, 0.0, values))
    some = np.array([np.pi, 2.5, np.nan])
    np.testing.assert_allclose(unpacked(packed_floats(some), 3), some, rtol=1e-7)
    assert packed_doubles(np.full(7, 2.5)) == 2.5
    assert packed_floats(np.full(3, np.nan)) is None
    # minus zero would be shown as -0
    assert str(packed_doubles(np.array([-0.0, 0.0]))) == "0.0"


def test_points_from_the_data_are_those_of_the_solver() -> None:
    motion = six_bar()
    data = MotionData(Sample(motion)).data
    count = data["poses"]
    assert count == 37
    for point in data["points"]:
        link = data["links"][point["link"]]
        x, y, angle = (unpacked(link[key], count) for key in ("x", "y", "angle"))
        p = point["x"] + 1j * point["y"]
        place = x + 1j * y + np.exp(1j * angle) * p
        np.testing.assert_allclose(place, motion.points[point["name"]].position, atol=1e-12)
        vx, vy, w = (unpacked(part, count) for part in link["v"])
        velocity = vx + 1j * vy + 1j * w * np.exp(1j * angle) * p
        solved = np.asarray(motion.points[point["name"]].velocity)
        assert np.abs(velocity - solved).max() <= 1e-6 * max(1.0, np.abs(solved).max())


def test_centres_from_the_data_are_the_instant_centres() -> None:
    motion = six_bar()
    moving = MotionData(Sample(motion))
    centres = ck.instant_centres(motion)
    for packed in moving.data["centres"]:
        x, y, w = (unpacked(part, 37) for part in packed["at"])
        centre = centres[tuple(packed["links"])]
        near = ~centre.at_infinity & (np.abs(centre.point) < 1e3)
        place = (x + 1j * y)[near] / w[near]
        np.testing.assert_allclose(place, centre.point[near], rtol=1e-4, atol=1e-4)
        np.testing.assert_array_equal(w[centre.at_infinity], 0.0)
    assert len(moving.data["centres"]) == 15


def test_lines_lead_through_three_centres_in_a_row() -> None:
    motion = six_bar()
    data = MotionData(Sample(motion)).data
    at = np.array([[unpacked(part, 37) for part in centre["at"]] for centre in data["centres"]])
    assert data["lines"]
    for line in data["lines"]:
        assert len(line) == 3
        three = at[line]
        three = three / np.linalg.norm(three, axis=1, keepdims=True)
        area = np.linalg.det(np.moveaxis(three, -1, 0))
        assert np.abs(area).max() < 1e-5


def test_long_motions_are_thinned_and_it_is_said() -> None:
    motion = six_bar(5001)
    made = viewer(motion)
    assert made.data["poses"] <= MOST_POSES + 1 < made.data["all"] == 5001
    assert "5,001" in made.html
    indices = unpacked(made.data["indices"], made.data["poses"]).astype(int)
    np.testing.assert_array_equal(
        unpacked(made.data["along"]["values"], len(indices)), np.linspace(0, 360, 5001)[indices].round(12)
    )
    assert "poses; tables" not in viewer(six_bar()).html


def test_many_links_have_fewer_poses() -> None:
    large = ck.chains.random_mechanism(20, seed=3, kinds=("RRR",))
    drive = large.drives[0]
    motion = ck.solve(large, {drive.name: drive.values + np.linspace(0, 1e-3, 1000)})
    moving = MotionData(Sample(motion))
    assert FEWEST_POSES <= len(moving.chosen) < 400
    assert moving.data["centres"] == []
    assert len(json.dumps(moving.data)) < 1_300_000


def test_what_plays_on_and_on() -> None:
    assert MotionData(Sample(six_bar())).closes
    part = ck.solve(load("six-bar"), {"crank": ck.deg(range(0, 181, 5))})
    assert not MotionData(Sample(part)).closes
    timed = ck.solve(load("six-bar"), {"crank": 0.0}, speed=2.0, time=np.linspace(0, 1.5, 11))
    assert MotionData(Sample(timed)).data["seconds"] == pytest.approx(1.5)
    assert MotionData(Sample(timed)).data["along"]["name"] == "time"
    quick = ck.solve(load("six-bar"), {"crank": 0.0}, speed=200.0, time=np.linspace(0, 0.02, 11))
    made = viewer(quick)
    assert made.data["seconds"] == pytest.approx(1.0)
    assert "50 times slower" in made.html
    assert "slower" not in viewer(timed).html


def test_the_pose_shown_first_is_an_assembled_one() -> None:
    rocker = ck.with_driver(load("crank-rocker"), "rocker")
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(rocker, {rocker.drives[0].name: ck.deg(range(0, 360, 5))})
    data = MotionData(Sample(motion)).data
    assembled = unpacked(data["assembled"], 72)
    np.testing.assert_array_equal(assembled == 1, motion.assembled)
    assert assembled[data["start"]] == 1


def test_nothing_moves_where_nothing_closes() -> None:
    long = ck.Mechanism(
        "Too long", ck.link("frame", A=0, D=20), ck.link("crank", A=0, B=1), ck.link("rod", B=0, C=2),
        ck.link("rocker", D=0, C=2), ck.drive("crank"))  # fmt: skip
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(long, {"crank": ck.deg([0, 10])})
    assert viewer_of(motion) is None
    assert motion._repr_html_() is None


def test_names_are_text_wherever_they_stand() -> None:
    bad = '<script>alert("x")</script>'
    arm = ck.Mechanism(bad, ck.link("frame", A=0), ck.link("a<b>&", A=0, B=1), ck.drive("a<b>&"))
    motion = ck.solve(arm, {"a<b>&": ck.deg([0, 10, 20])})
    made = viewer(motion, outputs=["B.position"])
    for text in (made.html, made.plots, player(motion), framed_player(motion) or ""):
        assert "<script>alert" not in text
        assert "<b>&" not in text


def test_a_frame_is_small_and_asks_for_nothing() -> None:
    html = framed_player(six_bar(361))
    # half of it is what makes it live
    assert len(html) < 320_000
    assert "http" not in html.replace("http://www.w3.org/2000/svg", "").replace("http-equiv", "")
    assert framed_player(six_bar(361)) == html
    assert ck.solve(load("six-bar"), {"crank": ck.deg([30])})._repr_html_() is None


def test_a_mechanism_whose_point_is_led_has_a_page() -> None:
    """Its instant centres are those of links that the page does not show, too."""
    assert "ck-motion" in ck.page(catalog.motion("five-bar-led")).html


@pytest.mark.full
def test_the_catalog_can_be_viewed() -> None:
    """Every sixth mechanism: the live pages of all are made with the site."""
    for name in shipped()[::6]:
        try:
            motion = catalog.motion(name)
        except CompoundkinError:
            continue
        made = viewer_of(motion)
        assert made is not None, name
        assert len(made.data["parts"]) == made.html.count("<g data-links="), name
        json.dumps(made.data, allow_nan=False)
