"""Forces and simulations in notebooks and on animations."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.view.page.live.live_data import LiveData
from compoundkin.view.page.live.recorded_forces import why_not_recorded
from compoundkin.view.page.motion_data import MotionData
from compoundkin.view.report.pose_sample import Sample
from compoundkin.view.sketch.shapes import ShapeGroup, leaves
from tests.view.loaded import MASS, REACH, UNITS, crank, crank_forces, six_bar_forces


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


# Every kind of load on a slider-crank, amounts of all sorts, and masses that are left out.
TURN = {"at": [0, 2, 4], "values": [3, -5, 1], "period": 2 * np.pi}
LOADS = {
    "force": ck.force("rod", (3, -4), at=(60, 10), fixed_in="rod"),
    "force while moving": ck.force("slider", (-400, 0), at="B", while_moving=(-1, 0)),
    "force over the time": ck.force("slider", (0, {"at": [0, 0.1, 0.4], "values": [0, 9, 2], "smooth": True}), at="B"),
    "torque over its rate": ck.torque("crank", {"over": "rate", "at": [0, 100], "values": [50, 0]}),
    "effort over the crank": ck.effort("guide", {"over": "crank", "smooth": True, **TURN, "values": [3, -5, 3]}),
    "effort over its slide": ck.effort("guide", {"at": [0, 90, 500], "values": [0, -7, 4]}, only="back"),
    "effort at a pin over its angle": ck.effort("A", {"at": [-40, 0, 40], "values": [-9, 0, 20]}),
    "pressure": ck.pressure("guide", {"at": [0, 500], "values": [0.3, 0.1]}, bore=40, rod=10, back=0.02),
    "spring": ck.spring("rod", (50, 0), at=(90, 40), stiffness=2, free_length=30, preload=5),
    "spring by a table, one way": ck.spring(
        "slider", "B", at=(10, 30), stiffness={"at": [0, 500], "values": [0, 900]}, only="tension"
    ),
    "torsion spring one way": ck.spring(pair="A", stiffness=5, free=0.3, only="compression"),
    "damper": ck.damper("rod", (50, 0), at=(90, 40), rate=0.2),
    "damper along a pair": ck.damper(pair="guide", rate=0.3),
    "elastic stop": ck.stop("guide", high=120, stiffness=30, damping=0.1),
    "latch": ck.latch("guide", until=0.5),
    "motor": ck.motor("crank", stall=900, no_load=200, gear=3, efficiency=0.8),
    "bars without inertia": ck.gravity(0, -9.81),
    "a function": ck.effort("guide", lambda s: -400.0 / (10 + s)),
    "friction": ck.friction("guide", coefficient=0.1),
}
NOT_RECORDED = {
    "a function": "effort along guide is a function in Python",
    "friction": "friction is found at each pose",
}


@pytest.mark.parametrize("kind", LOADS)
def test_each_kind_of_load_is_in_the_program_of_a_page_or_it_is_said_why_not(kind: str) -> None:
    links = (
        ck.link("frame", O=0), ck.link("crank", O=0, A=50), ck.link("rod", A=0, B=150, C=(60, 30)),
        ck.link("slider", B=0), ck.slide("slider", name="guide", on="frame", at="B", through="O"),
        ck.drive("crank", law=ck.laws.constant_speed(20.0)),
    )  # fmt: skip
    masses = ck.mass("crank", 0.3), ck.mass("rod", density=0.0004), ck.mass("slider", 0.2)
    loaded = ck.Mechanism("Slider-crank", *links, *masses, LOADS[kind], units=UNITS)
    motion = ck.solve(loaded, time=np.linspace(0, np.pi / 10, 37))
    drawn = MotionData(Sample(motion, 0), with_centres=True).drawn_forces
    assert drawn is not None
    live = LiveData(motion, np.arange(37), tuple(motion.mechanism.links), (), drawn)
    assert why_not_recorded(drawn).startswith(NOT_RECORDED.get(kind, ""))
    assert (live.forces is None) == (kind in NOT_RECORDED)
    if live.forces is not None:
        assert set(live.forces.figures) >= {"guide.force", "A.moment", "crank.effort", "crank.power"}
