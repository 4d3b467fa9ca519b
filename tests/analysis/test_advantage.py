"""Mechanical advantage: by the centres, by finite differences, by formulas, and published numbers."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.analysis import coupler
from compoundkin.analysis.mechanical_advantage import ForcePort, TorquePort, mechanical_advantage
from compoundkin.files import load
from tests.analysis.relative_motions import catalog, random_mechanism
from tests.support import differences, drawn_values

pytestmark = pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")


def test_four_bar_of_norton() -> None:
    """Norton, Example 6-7: crank at 25 rad/s, rocker at 6.998, coupler at -4.121."""
    motion = ck.solve(load("four-bar-norton"), {"crank": [np.deg2rad(40.0)]})
    assert mechanical_advantage(motion, "rocker", "crank").velocity_ratio == pytest.approx(6.998 / 25, abs=5e-5)
    assert mechanical_advantage(motion, "coupler", "crank").advantage == pytest.approx(-25 / 4.121, abs=2e-3)


@pytest.mark.parametrize("name", ["crank-rocker", "six-bar", "watt-ii", "stephenson-iii", "class-iii-six-bar"])
def test_ratio_of_angular_velocities_by_the_centres(name: str) -> None:
    """A. B. W. Kennedy: the links' distances of their common centre from their centres on the frame."""
    motion = catalog(name)
    links = [link for link in motion.links if link != "frame"]
    for one in links:
        for other in links[: links.index(one)]:
            common, a, b = (coupler.pole(motion, *pair) for pair in ((one, other), (one, "frame"), (other, "frame")))
            good = ~(common.infinite | a.infinite | b.infinite) & common.defined & a.defined & b.defined
            centre, a0, b0 = (found.world[good] for found in (common, a, b))
            base = np.conj(a0 - b0)
            far, close = (((centre - end) * base).real for end in (b0, a0))
            near = (np.abs(close) > 1e-3 * motion.size**2) & (np.abs(centre) < 1e3 * motion.size)
            expected = far / np.where(near, close, 1.0)
            found = mechanical_advantage(motion, one, other).velocity_ratio[good]
            assert found[near] == pytest.approx(expected[near], rel=1e-6, abs=1e-9)


def test_slider_crank_by_its_centre_on_the_crank() -> None:
    """v = omega |O P| with P the centre of crank and piston, on the normal of the guide through O."""
    motion = catalog("slider-crank")
    common = coupler.pole(motion, "piston", on="crank")
    found = mechanical_advantage(motion, "stroke", "crank")
    assert found.velocity_ratio == pytest.approx(-common.world.imag, abs=1e-12)
    assert found.advantage[~found.output_rests] == pytest.approx(-1.0 / common.world.imag[~found.output_rests])


def test_toggle_positions_are_infinite() -> None:
    motion = catalog("slider-crank")
    found = mechanical_advantage(motion, "stroke", "crank")
    assert np.flatnonzero(found.output_rests).tolist() == [0, 36, 72]
    assert np.isposinf(found.advantage[[0, 36, 72]]).all()
    assert np.all(found.velocity_ratio[[0, 36, 72]] == 0)
    back = mechanical_advantage(motion, "crank", "stroke")
    assert np.isposinf(back.velocity_ratio[[0, 36, 72]]).all()
    assert np.all(back.advantage[[0, 36, 72]] == 0)
    assert back.input_rests.tolist() == found.output_rests.tolist()


@pytest.mark.parametrize("seed", range(12))
def test_ratios_against_differences_of_the_positions(seed: int) -> None:
    mechanism, step = random_mechanism(seed), 5e-4
    motion = ck.solve(mechanism, {k: v + step * np.arange(-4, 5) for k, v in drawn_values(mechanism).items()})
    driver = mechanism.drives[0].name
    translating = motion.structure.translating_links
    for link in [name for name in motion.links if name != "frame"]:
        ratio = mechanical_advantage(motion, translating.get(link, link), driver).velocity_ratio
        place = motion.pairs[translating[link]].value if link in translating else motion.links[link].angle
        assert ratio[4] == pytest.approx(differences(place, step)[0], rel=1e-5, abs=1e-6)
        for letter in mechanism.geometry.points[link]:
            at = ForcePort(link, letter, angle=0.7)
            path = (np.asarray(motion.points[letter].position) * np.exp(-0.7j)).real
            ratio = mechanical_advantage(motion, at, driver).velocity_ratio
            assert ratio[4] == pytest.approx(differences(path, step)[0], rel=1e-5, abs=1e-5)


def test_advantages_multiply_along_the_mechanism_and_invert() -> None:
    motion = ck.solve(load("six-bar"), {"crank": np.linspace(0.3, 1.2, 7)}, speed=10.0)
    ab, bc, ac = (
        mechanical_advantage(motion, *ports).advantage
        for ports in (("rocker", "crank"), ("bar", "rocker"), ("bar", "crank"))
    )
    assert ab * bc == pytest.approx(ac, rel=1e-9)
    back = mechanical_advantage(motion, "crank", "rocker")
    assert back.velocity_ratio == pytest.approx(ab, rel=1e-12)
    assert back.advantage == pytest.approx(1.0 / ab, rel=1e-12)


def test_scissor_lift_by_its_formula() -> None:
    """Height 2 sqrt(L^2 - x^2) with L = 2: force up / force in = -sqrt(L^2 - x^2) / (2 x)."""
    motion = catalog("scissor-lift")
    x = motion.points["B"].x
    found = mechanical_advantage(motion, ForcePort("platform", "T", np.pi / 2), "foot")
    assert found.advantage == pytest.approx(-np.sqrt(4.0 - x**2) / (2.0 * x), rel=1e-9)


def test_torque_between_two_moving_links_and_a_pair_by_name() -> None:
    motion = catalog("crank-rocker")
    expected = motion.links["coupler"].angular_velocity - motion.links["crank"].angular_velocity
    found = mechanical_advantage(motion, TorquePort("coupler", on="crank"), "crank")
    assert found.velocity_ratio == pytest.approx(expected)
    pin = mechanical_advantage(motion, "B", "crank")
    assert np.abs(pin.velocity_ratio) == pytest.approx(np.abs(expected))


@pytest.mark.parametrize("speed", [1e-3, 7.0, -2.0])
def test_advantage_does_not_depend_on_speed_and_acceleration(speed: float) -> None:
    mechanism = load("crank-shaper")
    values = {mechanism.drives[0].name: np.linspace(0.4, 2.0, 5)}
    driver, output = mechanism.drives[0].name, list(mechanism.links)[-1]
    one, two = (ck.solve(mechanism, values, speed=s, acceleration=s) for s in (1.0, speed))
    for port in ("ram", ForcePort(output, next(iter(mechanism.geometry.points[output])), 0.0)):
        a, b = (mechanical_advantage(motion, port, driver) for motion in (one, two))
        assert a.velocity_ratio == pytest.approx(b.velocity_ratio, rel=1e-9)
        assert a.output_rests.tolist() == b.output_rests.tolist()


def test_poses_without_rates_are_masked() -> None:
    motion = catalog("triple-rocker", values={"driver": np.linspace(0.0, 2 * np.pi, 73)})
    found = mechanical_advantage(motion, "rocker", "driver")
    assert found.defined.tolist() == motion.regular.reshape(motion.shape).tolist()
    assert np.isnan(found.advantage[~found.defined]).all()
    assert np.isnan(found.velocity_ratio[~found.defined]).all()


def test_both_at_rest_is_not_defined() -> None:
    motion = catalog("slider-crank")
    found = mechanical_advantage(motion, ForcePort("piston", "B", np.pi / 2), ForcePort("piston", "B", np.pi / 2))
    assert not found.defined.any()
    assert np.isnan(found.advantage).all()


def test_bad_input_says_what_is_wrong() -> None:
    motion = catalog("crank-rocker")
    with pytest.raises(ck.errors.UnknownName, match="no moving link, pair or driver 'rockr'; did you mean 'rocker'"):
        mechanical_advantage(motion, "rockr", "crank")
    with pytest.raises(ck.errors.UnknownName, match="input: there is no moving link"):
        mechanical_advantage(motion, "rocker", "frame")
    with pytest.raises(ck.errors.UnknownName, match="no such point"):
        mechanical_advantage(motion, ForcePort("coupler", "Q", 0.0), "crank")
    with pytest.raises(ck.errors.InvalidInput, match="output: 3 is no text or torque port"):
        mechanical_advantage(motion, 3, "crank")  # type: ignore[arg-type]
    with pytest.raises(ck.errors.InvalidInput, match=r"output.angle: 'up' is not an angle"):
        mechanical_advantage(motion, ForcePort("coupler", "C", "up"), "crank")
    with pytest.raises(ck.errors.InvalidInput, match="no driver moves"):
        mechanical_advantage(ck.solve(load("crank-rocker"), speed=0.0), "rocker", "crank")
    with pytest.raises(ck.errors.InvalidInput, match="solved to order 0"):
        mechanical_advantage(ck.solve(load("crank-rocker"), order=0), "rocker", "crank")
    with pytest.raises(ck.errors.InvalidInput, match="several drivers move at once"):
        mechanical_advantage(catalog("five-bar"), "left", "right")
