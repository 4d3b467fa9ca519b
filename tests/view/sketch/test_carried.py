"""A sketch that moves: every part where the solver has its link, every pose as if it were drawn anew."""

from collections.abc import Iterable

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import CompoundkinError, InvalidInput, NotAssembled
from compoundkin.files import load
from compoundkin.view.sketch.kinematic_sketch import layered, moving_sketch
from compoundkin.view.sketch.painter import Painter
from compoundkin.view.sketch.shapes import CircleShape, Polyline, Shape, leaves, shape_corners
from tests import catalog

SOLVABLE = ("six-bar", "jansen-leg", "planetary-train", "geneva-wheel", "disc-cam-roller-program",
            "rack-and-pinion-steering", "class-iii-six-bar", "elliptic-trammel")  # fmt: skip


def solved(name: str) -> ck.results.Motion:
    return catalog.motion(name)


@pytest.mark.parametrize("name", SOLVABLE)
def test_pins_are_where_the_solver_has_them(name: str) -> None:
    motion = solved(name)
    sketch = moving_sketch(motion)
    shown = {part.letter: part for part in sketch.parts if part.letter and not part.is_label}
    assert shown
    for letter, part in shown.items():
        solver = sketch.window.at(motion.points[letter].position[motion.assembled])
        assert np.abs(sketch.places(part) - solver).max() < 1e-9


@pytest.mark.parametrize("name", SOLVABLE)
def test_bars_moved_rigidly_are_the_bars_drawn_anew(name: str) -> None:
    """Each pose drawn by itself has the same bars, to what lines are simplified by."""
    sketch = moving_sketch(solved(name))
    count = sketch.scene.count
    for k in (0, count // 3, count - 1):
        moved = _bars(shape for part in sketch.shapes(k)[1:] for shape in leaves([part]))
        anew = _bars(leaves(layered(Painter(sketch.scene.ghost(k), sketch.window))))
        assert len(moved) == len(anew)
        for one, other in zip(sorted(moved, key=_place), sorted(anew, key=_place), strict=True):
            same = max(abs(np.array(one) - np.array(other)))
            turned = max(abs(np.array(one) - np.array(other[::-1])))
            assert min(same, turned) < 0.3


def _bars(shapes: Iterable[Shape]) -> list[tuple[complex, ...]]:
    straight = (s for s in shapes if isinstance(s, Polyline) and len(s.points) == 2)
    return [s.points for s in straight if s.style.startswith("bar")]


def _place(points: tuple[complex, ...]) -> tuple[float, float]:
    middle = sum(points) / 2
    return round(middle.real), round(middle.imag)


@pytest.mark.parametrize("name", SOLVABLE)
def test_the_window_holds_every_pose(name: str) -> None:
    sketch = moving_sketch(solved(name))
    for k in range(0, sketch.scene.count, 5):
        assert all(sketch.window.holds(p, -1.0) for p in shape_corners(sketch.shapes(k)[1:]))


def test_turns_are_those_of_the_links() -> None:
    motion = solved("six-bar")
    sketch = moving_sketch(motion)
    turned = np.unwrap(np.angle(sketch.turns("bar")))
    angle = motion.links["bar"].angle
    # clockwise on paper is a positive angle there, for y points downward
    np.testing.assert_allclose(turned - turned[0], -(angle - angle[0]), atol=1e-12)


def test_rates_and_their_one_scale() -> None:
    motion = solved("six-bar")
    sketch = moving_sketch(motion)
    rates = sketch.rates("velocity")
    np.testing.assert_allclose(rates["G"], np.asarray(motion.points["G"].velocity), rtol=1e-14)
    longest = max(np.abs(v).max() for v in rates.values())
    assert sketch.scale("velocity").per_unit * longest == pytest.approx(0.2 * sketch.window.diagonal)
    assert "E" not in rates


def test_poses_that_cannot_be_assembled_are_left_out() -> None:
    motion = ck.solve(load("crank-rocker"), {"crank": ck.deg([0, 30, 60])})
    assert moving_sketch(motion).scene.count == 3
    rocker = ck.with_driver(load("crank-rocker"), "rocker")
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(rocker, {rocker.drives[0].name: ck.deg(range(0, 360, 5))})
    sketch = moving_sketch(motion)
    assert 0 < sketch.scene.count == int(motion.assembled.sum()) < 72
    assert all(np.isfinite(shape_corners(sketch.shapes(k))).all() for k in range(sketch.scene.count))


def test_what_never_closes_has_no_sketch_that_moves() -> None:
    long = ck.Mechanism(
        "Too long", ck.link("frame", A=0, D=20), ck.link("crank", A=0, B=1), ck.link("rod", B=0, C=2),
        ck.link("rocker", D=0, C=2), ck.drive("crank"))  # fmt: skip
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(long, {"crank": ck.deg([0, 10])})
    with pytest.raises(NotAssembled):
        moving_sketch(motion)


def test_links_whose_dimensions_change_along_the_motion_are_refused() -> None:
    lengths = np.linspace(2.0, 2.2, 3)
    arm = ck.Mechanism("Arms", ck.link("frame", A=0), ck.link("crank", A=0, B=lengths), ck.drive("crank"))
    motion = ck.solve(arm, {"crank": ck.deg([0, 10, 20])})
    with pytest.raises(InvalidInput, match="B on crank"):
        moving_sketch(motion)
    designs = ck.Mechanism("Arms", ck.link("frame", A=0), ck.link("crank", A=0, B=lengths[:, None]), ck.drive("crank"))
    motion = ck.solve(designs, {"crank": ck.deg([0, 10, 20])})
    for design, length in enumerate(lengths):
        part = next(p for p in moving_sketch(motion, design).parts if p.letter == "B")
        assert part.at == pytest.approx(length)


def test_labels_stay_upright_and_near_their_points() -> None:
    sketch = moving_sketch(solved("six-bar"))
    label = next(p for p in sketch.parts if p.letter == "G" and p.is_label)
    assert not label.turns
    offsets = [leaf.at for leaf in leaves(label.shapes)]
    assert all(0 < abs(at) < 40 for at in offsets)
    badges = [p for p in sketch.parts if p.is_label and not p.letter]
    assert {p.link for p in badges} == set(sketch.motion.mechanism.links) - {"frame"}
    assert all(isinstance(next(leaves(p.shapes)), CircleShape) for p in badges)


@pytest.mark.full
def test_the_mechanisms_of_the_catalog_move() -> None:
    for name in catalog.THIRD:
        try:
            motion = solved(name)
        except CompoundkinError:
            continue
        sketch = moving_sketch(motion)
        assert np.isfinite(shape_corners(sketch.shapes(sketch.scene.count // 2))).all(), name


def test_a_motion_whose_points_return_but_not_its_wheels_does_not_close() -> None:
    wheels = ck.Mechanism(
        "Wheels", ck.link("frame", A=0, B=3), ck.link("first", A=0, P=1), ck.link("second", B=0),
        ck.gear("first", "second", teeth=(20, 30)), ck.drive("first"))  # fmt: skip
    once = ck.solve(wheels, {"first": ck.deg(range(0, 361, 10))})
    assert not moving_sketch(once).scene.closes
    thrice = ck.solve(wheels, {"first": ck.deg(range(0, 1081, 10))})
    assert moving_sketch(thrice).scene.closes
