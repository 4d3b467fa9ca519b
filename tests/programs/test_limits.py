"""Near limits a program says what `solve` says: which poses are assembled, which rates have digits, which mode."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.kinematics.motion import Motion
from compoundkin.programs import call_numbers
from compoundkin.programs.compiled_path import CompiledPath

DESIGNS = 60
# Linkages that stop short, pass change points, slide to ends; trains, rollers and cylinders.
NAMES = (
    "four-bar-norton", "six-bar", "slider-crank-offset", "crank-shaper", "parallelogram", "antiparallelogram",
    "peaucellier", "geared-five-bar", "excavator-arm", "hydraulic-digger", "rack-driven-double-slider", "scotch-yoke",
    "quick-return-pin-in-slot", "v-engine", "watt-i",
)  # fmt: skip


def _free(mechanism: Any) -> dict[str, complex]:
    points = mechanism.geometry.points
    found = {f"{link}.{letter}": own[letter] for link, own in points.items() for letter in own if own[letter] != 0}
    return dict(list(found.items())[:6])


def _solved(path: CompiledPath, dimensions: Any, speed: Any) -> Motion:
    return path.programs.solve(path.programs.numbers(call_numbers.Call(None, dimensions, speed))).motion


@pytest.mark.parametrize("name", NAMES)
def test_designs_are_assembled_where_solve_assembles_them(name: str) -> None:
    mechanism, rng = ck.load(name), np.random.default_rng(3)
    free, speed = _free(mechanism), {drive.name: 1.0 for drive in mechanism.drives}
    outputs = [f"{letter}.{word}" for letter in mechanism.carriers for word in ("position", "acceleration")]
    path = ck.compile(mechanism, outputs, free=tuple(free))
    spread = rng.choice([0.0, 0.02, 0.4], (DESIGNS, 1))
    noise = rng.standard_normal((2, len(free), DESIGNS, 1))
    designs = {key: own * (1 + spread * (noise[0, k] + 1j * noise[1, k])) for k, (key, own) in enumerate(free.items())}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found, motion = path(None, designs, speed=speed), _solved(path, designs, speed)
    assert np.array_equal(found.assembled, motion.assembled)
    for output in outputs:
        wanted = ck.quantity(motion, output).values
        assert np.array_equal(np.isnan(found[output]), np.isnan(wanted)), output
        assert np.nanmax(np.abs(found[output] - wanted)) <= 2e-10 * np.nanmax(np.abs(wanted)), output


def test_a_parallelogram_goes_on_through_its_change_points() -> None:
    mechanism = ck.load("parallelogram")
    found = ck.compile(mechanism, "C", free="crank.B")(speed=1.0)
    motion = ck.solve(mechanism, speed=1.0)
    assert motion.change_points  # else this tests nothing
    assert np.allclose(found["C"], motion.points["C"].position, rtol=0, atol=1e-10 * motion.size)


def test_poses_not_assembled_are_told_and_are_no_numbers() -> None:
    mechanism = ck.load("four-bar-norton")
    path = ck.compile(mechanism, ["A.position", "B.position"], free="crank.A")
    with pytest.warns(ck.errors.UnassembledPoses, match="cannot be assembled"):
        found = path(None, {"crank.A": np.array([[1.0], [4.0]]) * mechanism.geometry.points["crank"]["A"]})
    assert found.assembled[0].all()
    assert not found.assembled[1].all()
    # the crank's own point too, which closes whatever the dyad does
    assert np.isnan(found["B.position"][~found.assembled]).all()


@pytest.mark.parametrize("backend", ["numpy", None])
def test_designs_whose_wheels_do_not_fit_are_not_assembled(backend: str | None) -> None:
    """By Willis's equation where they fit; where they do not, for the reason for which each is refused alone."""
    path = ck.compile(ck.load("planetary-train"), ["sun.angle", "Q"], free="arm.P.x", backend=backend)
    turn, places = np.linspace(0.0, 1.0, 5), np.array([[51.0], [52.0], [52.0004], [53.0]])
    with pytest.warns(ck.errors.UnassembledPoses, match="10 of 20 poses"):
        found = path(turn, {"arm.P.x": places})
    assert found.assembled.tolist() == [[False] * 5, [True] * 5, [True] * 5, [False] * 5]
    assert np.isnan(found["Q"][~found.assembled]).all()
    np.testing.assert_allclose(np.ptp(found["sun.angle"][1:3], axis=1), 1.0 + 72 / 32, rtol=1e-12)
    for design in (0, 3):
        (gap,) = ck.gaps(found.motion(design))
        with pytest.raises(ck.errors.InvalidMechanism, match=gap.reason):
            path.mechanism({"arm.P.x": float(places[design, 0])})
    with pytest.warns(ck.errors.UnassembledPoses, match="5 of 5 poses"):
        assert not path(turn, {"arm.P.x": 53.0}).assembled.any()
    with pytest.warns(ck.errors.UnassembledPoses, match="10 of 20 poses"):
        slopes = path.derivatives(turn, {"arm.P.x": places}, by="arm.P.x")
    # the tip of the planet goes out with its axis
    rows = slopes["Q", "arm.P.x"]
    assert np.isnan(rows[[0, 3]]).all()
    np.testing.assert_allclose(rows[1:3], np.broadcast_to(np.exp(1j * turn), (2, 5)), atol=1e-12)


@pytest.mark.parametrize("begin", [100.0, 190.0, 300.0])
def test_modes_are_carried_from_the_drawing_to_a_part_of_the_motion(begin: float) -> None:
    drawn = ck.load("parallelogram").replace(ck.drawn(A=0, B=30j, C=60 + 30j, D=60))
    values = np.deg2rad(np.linspace(begin, begin + 30.0, 7))
    found = ck.compile(drawn, "C")({"crank": values})
    # the smooth motion, whatever change points lie between the drawing and here
    assert np.allclose(found["C"], 60.0 + 30.0 * np.exp(1j * values), rtol=0, atol=1e-9)


def test_looks_at_limits_make_their_programs_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """A call at another value than the mechanism's own looks at the way there: what it needs is kept."""
    made: list[Any] = []
    ready = call_numbers.runner_of
    monkeypatch.setattr(call_numbers, "runner_of", lambda flat, name=None: made.append(flat) or ready(flat, name))
    six_bar = ck.load("six-bar")
    path = ck.compile(six_bar, "G.position")
    for angle in (0.5, 0.6, 3.0):
        place = ck.solve(six_bar, angle, modes=path.modes).points["G"].position
        assert np.allclose(path(angle)["G.position"], place, rtol=1e-12, atol=0)
    assert len(made) == 2  # its own, and the one that looks
