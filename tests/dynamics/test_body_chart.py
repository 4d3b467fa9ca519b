"""Simulations by the coordinates of all links: several free drivers, and one that no other pair can follow."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.dynamics.simulation import forward_dynamics
from compoundkin.dynamics.simulation.coordinate_change import by_links


def heavy(name: str) -> ck.Mechanism:
    """A shipped mechanism under gravity, each link a kilogram with a radius of gyration of a tenth of the size."""
    light = ck.load(name)
    inertia = (0.1 * ck.solve(light).size) ** 2
    masses = [ck.mass(link, 1.0, inertia=inertia) for link in light.links if link != "frame"]
    return light.replace(
        *masses, ck.gravity(0, -9.81), units={"length": light.unit or "mm", "mass": "kg", "force": "N"}
    )


@pytest.mark.parametrize("name", ["crank-rocker", "crank-shaper", "sun-and-planet", "class-iii-six-bar"])
def test_the_motion_is_that_of_the_only_driver(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    machine, times = heavy(name), np.linspace(0.0, 0.1, 21)
    one = ck.simulate(machine, until=0.1, times=times)

    def links(chart, time, state):  # type: ignore[no-untyped-def]
        found, begun = by_links(chart, chart.state(time, state[:1], state[1:2]))
        return found, np.append(begun, state[-1])

    monkeypatch.setattr(forward_dynamics, "integrable", links)
    other = ck.simulate(machine, until=0.1, times=times)
    driver = machine.drives[0].name
    for found, known in ((other, one), (one, other)):
        assert found.energy.worst < 1e-8
        np.testing.assert_allclose(
            found.motion.drives[driver].value, known.motion.drives[driver].value, rtol=1e-8, atol=1e-9
        )
    for link in machine.links:
        off = np.exp(1j * other.motion.links[link].angle) - np.exp(1j * one.motion.links[link].angle)
        assert np.max(np.abs(off)) < 1e-7
    # what is left to the free driver is nothing, by the forces in the pairs
    effort = np.abs(other.forces.drives[driver].effort)
    assert np.all(effort < 1e-8 * np.max(np.abs(other.energy.potential)))


def test_parallelograms_fall_through_their_change_points() -> None:
    """The head of two parallelograms on each other stays level whichever way they lie, flat as well."""
    lift = heavy("double-parallelogram-lift")
    fall = ck.simulate(lift, until=0.2)
    assert fall.times[-1] == 0.2
    assert fall.energy.worst < 1e-5
    level = fall.motion.links["head"].angle
    assert np.max(np.abs(level - level[0])) < 1e-8
    lower = fall.motion.drives["lower"].value
    assert lower.min() < -0.2 < 0.3 < lower.max()  # it has been flat in between
    assert ck.verify(fall.motion).passed


@pytest.mark.parametrize(
    ("name", "until"),
    [("peaucellier", 0.1), pytest.param("hart-inversor", 0.1, marks=pytest.mark.full)],
)
def test_inversors_go_through_their_singular_configurations(name: str, until: float) -> None:
    """Their points go on along the straight line, or leave it where the configurations meet, and no energy is lost."""
    fall = ck.simulate(heavy(name), until=until)
    assert fall.times[-1] == until
    assert fall.energy.worst < 1e-4
    for pair in fall.motion.structure.pairs:
        if pair.title == "revolute pair":
            first, second = (fall.motion.links[link] for link in pair.members)
            ends = fall.motion.inputs.ends[pair.name]
            gap = first.at(ends[0].point).position - second.at(ends[1].point).position
            assert np.max(np.abs(gap)) < 1e-9 * fall.motion.size


@pytest.mark.full
def test_a_platform_on_three_legs_falls() -> None:
    fall = ck.simulate(heavy("3-rrr"), until=0.08)
    assert fall.times[-1] == 0.08
    assert fall.events == ()
    assert fall.energy.worst < 1e-8
    assert max(np.max(np.abs(fall.forces.drives[name].effort)) for name in fall.motion.drives) < 1e-5


@pytest.mark.parametrize("name", ["parallelogram", "antiparallelogram"])
def test_a_start_at_a_change_point_says_how_to_mend_it(name: str) -> None:
    """What the message says to write starts, on the branch that is drawn, and goes on through both change points."""
    machine = heavy(name)
    with pytest.raises(ck.errors.InvalidInput, match="branches meet") as refused:
        ck.simulate(machine, until=1.0)
    assert 'start={"crank": ck.deg(1)}' in str(refused.value)
    assert "modes=" in str(refused.value)
    fall = ck.simulate(machine, start={"crank": (ck.deg(1), -20.0)}, until=0.5)
    crank, follower = (fall.motion.links[link].angle for link in ("crank", "follower"))
    assert np.ptp(crank) > np.pi
    if name == "parallelogram":
        assert np.max(np.abs(np.exp(1j * follower) - np.exp(1j * crank))) < 1e-8
    else:
        # ellipses that roll on each other: tan(follower / 2) = -3 tan(crank / 2), by frame 60 and crank 30
        a, b = crank / 2.0, follower / 2.0
        assert np.max(np.abs(np.sin(b) * np.cos(a) + 3.0 * np.sin(a) * np.cos(b))) < 1e-8
    assert fall.energy.worst < 1e-8


def test_a_start_at_a_limit_position_says_where_to_start() -> None:
    """A slider-crank driven by its piston, stretched out."""
    items = (
        *(ck.link("frame", O=0), ck.link("crank", O=0, A=1), ck.link("rod", A=0, B=3), ck.link("piston", B=0)),
        ck.slide("piston", on="frame", at="B", through="O", name="guide"),
        *(ck.drive("piston"), ck.drawn(O=0, A=1, B=4)),
        *(ck.mass(link, 1.0, inertia=0.1) for link in ("crank", "rod", "piston")),
    )
    stretched = ck.Mechanism("Stretched", *items, units={"length": "m", "mass": "kg", "force": "N"})
    with pytest.raises(ck.errors.InvalidInput, match="at a limit position there"):
        ck.simulate(stretched, start=4.0, until=1.0)
