"""Forces and simulations in notebooks and on animations."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.view.page.live.live_data import LiveData
from compoundkin.view.page.motion_data import MotionData
from compoundkin.view.report.pose_sample import Sample
from compoundkin.view.sketch.shapes import ShapeGroup, leaves
from tests import catalog
from tests.view.loaded import MASS, REACH, crank, crank_forces, six_bar_forces


def test_a_notebook_shows_forces_and_simulations() -> None:
    shown = six_bar_forces()._repr_html_() or ""
    assert "ck-reaction" in shown
    assert "Reactions" in shown
    fallen = ck.simulate(crank(), start={"crank": 0.5}, until=0.1)._repr_html_() or ""
    assert "iframe" in fallen
    assert "energy balance" in fallen


def test_forces_and_simulations_are_texts() -> None:
    text = crank_forces().text()
    peak = MASS * 9.81 * REACH
    assert f"{peak:.6g}" in text
    assert f"{peak / 1000:.6g}" in text, "N mm and N m"
    assert max(map(len, text.splitlines())) <= 80
    fallen = ck.simulate(crank(), start={"crank": 0.5}, until=0.1)
    assert "fastest" in fallen.text()
    fastest = float(np.max(np.abs(fallen.motion.drives["crank"].rate)))
    assert f"{fastest * 30 / np.pi:.6g}" in fallen.text()
    assert "[rpm]" in fallen.text()


def test_arrows_move_with_the_motion_at_one_scale() -> None:
    forces = crank_forces()
    film = ck.animate(forces, size=300)
    scales = {one.scale.kind: one.scale.per_unit for one in film.arrows}
    assert len(set(scales.values())) == 1
    weight = next(one for one in film.arrows if one.scale.kind == "load")
    ((key, rates),) = weight.rates.items()
    assert np.allclose(rates, -9.81j * MASS)
    middle = film.sketch.window.at(np.asarray(forces.points["B"].position) / 2.0)
    assert np.allclose(weight.places[key], middle[film.sketch.scene.known])
    titles = [shape.title for shape in film.frame(3).shapes if isinstance(shape, ShapeGroup)]
    assert any("load" in title for title in titles)
    assert "ck-inertia" in film.svg
    assert len(list(leaves(film.frame(0).shapes))) > 10


def test_rounding_of_forces_is_zero_in_tables() -> None:
    # what lets a mechanism go does not drive it: its effort is what rounding leaves
    sample = Sample(ck.simulate(crank(), start={"crank": 0.5}, until=0.1).motion)
    effort, force = sample.quantity("crank.effort"), sample.quantity("A.force")
    largest = float(np.abs(force.values).max())
    assert 1e-13 * largest < sample.floor(effort) < 1e-9 * largest
    assert np.abs(effort.values).max() <= sample.floor(effort)


@pytest.mark.parametrize(
    ("name", "is_live"),
    # a general group and a spring, a table over the crank, gears; a guide that rubs, a table over the ram
    [("andrews-squeezer-dynamics", True), ("engine-gas-pressure", True), ("planetary-train-torques", True),
     ("shaper-cutting-force", False), ("geared-press", False)],
)  # fmt: skip
def test_pages_have_the_program_of_forces_where_it_reproduces_them(name: str, is_live: bool) -> None:
    motion = catalog.motion(name)
    moving = MotionData(Sample(motion, 0), most=9, with_centres=True)
    found = LiveData(motion, moving.chosen, moving.links, moving.outputs, moving.drawn_forces).forces
    assert (found is not None) == is_live
