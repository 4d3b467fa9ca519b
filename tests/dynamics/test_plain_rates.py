"""The equation of motion of one coordinate in plain numbers, and the integrator that uses them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.dynamics.reactions import undetermined
from compoundkin.dynamics.reactions.undetermined import pressing_force
from compoundkin.dynamics.simulation import contact_watches, drive_table, tabulated_chart
from compoundkin.dynamics.simulation.coordinate_change import by_links, chart_of
from compoundkin.dynamics.simulation.dormand_prince import PlainSolver
from compoundkin.dynamics.simulation.normal_force_table import tabulated_pressing
from compoundkin.dynamics.simulation.tabulated_chart import TabulatedChart
from compoundkin.model.pairs.profile_contact import as_profile_contact
from tests.dynamics.cases import SI, crank_rocker


def sprung(*loads: Any) -> ck.Mechanism:
    """A crank and rocker with masses and weights, whose spring has a potential."""
    spring = ck.spring("rocker", "B", to="frame", at="O", stiffness=60.0, free_length=0.1)
    return crank_rocker(ck.gravity(0, -9.81), spring, *loads)


LOADS = {
    "none": (),
    "numbers": (ck.effort("crank", 0.3), ck.torque("rocker", -0.2)),
    "functions": (
        ck.effort("crank", lambda w, q: 0.2 * np.cos(q) - 0.01 * w),
        ck.effort("O", lambda t: np.sin(t), name="b"),
    ),
    "one way": (ck.effort("crank", 0.4, only="back"), ck.effort("O", lambda t: 0.1 * t, only="forward", name="f")),
    "a table": (ck.effort("crank", {"over": "rate", "at": [-60, 0, 60], "values": [3, 1, -4]}),),
    "a smooth table": (ck.effort("crank", {"over": "time", "at": [0, 1, 2], "values": [0, 1, -1], "smooth": True}),),
    "a damper": (ck.damper(pair="O", rate=0.03),),
    "a law of damping": (ck.damper(pair="O", rate=lambda w, q: 0.01 * w * abs(w) * (2 + np.sin(q))),),
    "direct current": (ck.motor("crank", stall=0.2, no_load=200.0, gear=-5.0, efficiency=0.8, limit=0.15),),
    "induction": (ck.motor("crank", breakdown=0.9, synchronous=40.0, slip=0.2, power=12.0),),
    "losses at a rotor": (ck.motor("crank", stall=0.2, no_load=200.0, gear=-5.0, efficiency=0.8, inertia=2e-4),),
    "two of them": (
        ck.motor("crank", stall=0.2, no_load=200.0, gear=5.0, efficiency=0.7, inertia=3e-4),
        ck.motor("O", speed=lambda t: 40 * t, gain=0.05, limit=0.6, gear=-2.0, efficiency=0.6, inertia=1e-3, name="b"),
    ),
    "a servo": (ck.motor("crank", speed=lambda t: 10 * t, gain=0.05, limit=0.6),),
    "points": (ck.damper("rocker", "B", to="frame", at="O", rate=2.0), ck.torque("rocker", lambda t: 0.3 * t)),
}


@pytest.mark.parametrize("kind", LOADS)
def test_plain_rates_are_those_of_solved_states(kind: str) -> None:
    mechanism = sprung(*LOADS[kind])
    chart = chart_of(ck.solve(mechanism, {"crank": [0.3]}), ("crank",), {})
    assert isinstance(chart, TabulatedChart)
    assert (chart.plain_efforts is None) == (kind == "points")
    plain, rng = chart.plain_rates(), np.random.default_rng(7)
    for _ in range(20):
        t, q, w = rng.uniform(0.0, 2.0), rng.uniform(-9.0, 9.0), rng.uniform(-50.0, 50.0)
        solved = super(TabulatedChart, chart).rates(t, np.array([q]), np.array([w]))
        a, power = plain(t, q, w)
        assert a == pytest.approx(solved.accelerations[0], rel=1e-9, abs=1e-8)
        assert power == pytest.approx(solved.power, rel=1e-9, abs=1e-8)


def test_functions_are_checked_at_every_state() -> None:
    with pytest.raises(ck.errors.InvalidInput, match="not finite"):
        ck.simulate(sprung(ck.effort("crank", lambda t: np.where(t < 0.5, 1.0, np.inf))), until=1.0)
    with pytest.raises(ck.errors.InvalidInput, match="outside its table"):
        ck.simulate(sprung(ck.effort("crank", {"over": "time", "at": [0, 0.5], "values": [0, 1]})), until=1.0)


def test_the_integrator_is_scipys() -> None:
    """As many steps of the same lengths, states in them, and the work beside them."""
    from scipy.integrate import DOP853

    def rates(t: float, q: float, w: float) -> tuple[float, float]:
        return -np.sin(q) - 0.1 * w + np.cos(t), w * np.cos(t)

    allowed, state = np.full(3, 1e-10), np.array([1.0, 0.5, 0.0])
    own = PlainSolver(rates, 0.0, state, 20.0, 1e-10, allowed)
    other = DOP853(lambda t, y: np.array([y[1], *rates(t, y[0], y[1])]), 0.0, state, 20.0, rtol=1e-10, atol=allowed)
    for _ in range(1000):
        own.step()
        other.step()
        # lengths of steps follow from errors, which are rounding in part
        assert own.step_size == pytest.approx(other.step_size, rel=1e-2)
        middle = (own.t + own.t_old) / 2.0
        if other.t_old < middle < other.t:
            assert own.dense_output()(np.array(middle)) == pytest.approx(other.dense_output()(middle), abs=1e-8)
        if own.status == "finished":
            break
    assert own.status == other.status == "finished"
    assert own.y == pytest.approx(other.y, abs=1e-8)


@pytest.mark.parametrize("name", ["disc-cam-roller-program", "constant-breadth-yoke"])
def test_tables_hold_in_the_dwells_of_cams(name: str) -> None:
    """There weights do no work, and what is rounding alone was halved in vain: states were solved one by one."""
    plain = ck.load(name)
    size = plain.geometry.size
    masses = [ck.mass(link, 1.0, inertia=0.1 * size**2) for link in plain.links if link != "frame"]
    units = {"length": "mm", "mass": "kg", "force": "N"}
    cam = plain.replace(*masses, ck.gravity(0, -9.81), unit="", units=units)
    (driver,) = cam.drives
    found = ck.simulate(cam, start={driver.name: (0.3, 200.0)}, until=0.003)
    chart = found.course.steps[0].chart
    assert isinstance(chart, TabulatedChart)
    assert chart.table is not None
    held = sum(piece.high - piece.low for piece in chart.table.pieces)
    assert held > 0.97 * (chart.table.high - chart.table.low)
    assert np.ptp(found.motion.drives[driver.name].value) > 0.5
    assert found.energy.worst < 1e-9


def test_a_way_of_many_sizes_takes_few_tables(monkeypatch: pytest.MonkeyPatch) -> None:
    """A letter for each link has no size: two metres in millimetres took 2,001 tables, one for each."""
    made, table_of = [], tabulated_chart.drive_table

    def counted(*given: Any) -> Any:
        made.append(given)
        return table_of(*given)

    monkeypatch.setattr(tabulated_chart, "drive_table", counted)
    block = ck.Mechanism(
        "Block",
        *(ck.link("frame", O=0), ck.link("block", P=0)),
        ck.slide("block", on="frame", at="P", through="O", angle=0.0, name="way"),
        *(ck.drive("block"), ck.mass("block", 1.0, at="P", inertia=0), ck.effort("way", 1.0)),
        units={"length": "mm", "mass": "kg", "force": "N"},
    )
    found = ck.simulate(block, start=0.0, until=2.0)
    assert found.motion.drives["block"].value[-1] == pytest.approx(2000.0, rel=1e-12)
    assert len(made) < 15


def test_nothing_is_halved_where_nothing_is_assembled(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beyond the limits of a rocker that drives, pieces were halved seven times in vain: 18,000 poses."""
    solved, between = [0], drive_table.between

    def counted(motion: ck.Motion, design: int, places: Any) -> ck.Motion:
        solved[0] += len(places)
        return between(motion, design, places)

    monkeypatch.setattr(drive_table, "between", counted)
    plain = sprung()
    items = [item for item in plain.items if item is not plain.drives[0]]
    rocker = ck.Mechanism("By its rocker", *items, ck.drive("rocker"), units=SI)
    chart = chart_of(ck.solve(rocker, {"rocker": [1.9]}), ("rocker",), {})
    assert isinstance(chart, TabulatedChart)
    assert chart.table is not None
    assert chart.table.motion.failed.any()
    assert chart.table.piece(1.9) is not None
    assert 0 < solved[0] < 4000


@pytest.mark.parametrize("name", ["cam-return-spring", "oscillating-flat-follower"])
def test_what_presses_a_contact_is_tabulated(name: str) -> None:
    """It is that of the forces of a solved state, with loads that depend on speed and time."""
    plain = ck.load(name)
    size, (driver,) = plain.geometry.size, plain.drives
    masses = [ck.mass(link, 1.0, inertia=0.1 * size**2) for link in plain.links if link != "frame"]
    follower = next(link for link in plain.links if link not in ("frame", driver.link))
    loads = (
        ck.torque(driver.link, lambda t, w: np.sin(t) - 0.3 * w),
        ck.force(follower, (lambda t: 3.0 * t, 2.0), at=0j),
    )
    units = {"length": "mm", "mass": "kg", "force": "N"}
    cam = plain.replace(*masses, ck.gravity(0, -9.81), *loads, unit="", units=units)
    chart = chart_of(ck.solve(cam, {driver.name: [0.3]}), (driver.name,), {})
    assert isinstance(chart, TabulatedChart)
    contact = next(pair.name for pair in cam.written_pairs if as_profile_contact(pair) is not None)
    known = 0
    for value in np.linspace(-2.4, 2.6, 8).tolist():
        found = tabulated_pressing(chart, contact, 0.7, value, 3.0)
        if found is None:  # next to a corner of the program
            continue
        known += 1
        state = chart.state(0.7, np.array([value]), np.array([3.0]))
        assert found == pytest.approx(pressing_force(ck.force_analysis(state.motion), contact), rel=1e-11)
    assert known >= 6


def pressed_cam(*more: Any) -> ck.Mechanism:
    """A cam with a spring-loaded roller follower: no dwell, in which a stop could not hold the cam."""
    plain = ck.load("cam-return-spring")
    size = plain.geometry.size
    masses = [ck.mass(link, 1.0, inertia=0.1 * size**2) for link in plain.links if link != "frame"]
    units = {"length": "mm", "mass": "kg", "force": "N"}
    return plain.replace(*masses, ck.gravity(0, -9.81), *more, unit="", units=units)


@pytest.mark.parametrize("kind", ["friction", "elastic", "rigid", "elastic with friction"])
def test_what_presses_a_contact_under_friction_and_at_stops_is_known_in_three_ways(kind: str) -> None:
    """By the table, by the forces of a solved state with what the stops hold, and by the equations of all pairs."""
    plain = pressed_cam()
    (driver,), structure = plain.drives, ck.decompose(plain)
    (guide,) = (pair.name for pair in structure.pairs if pair.is_simple and not pair.free_is_angle)
    pin = structure.driven[driver.name].pair.name
    contact = next(pair.name for pair in plain.written_pairs if as_profile_contact(pair) is not None)
    rubs = (ck.friction(pin, 0.2, radius=4.0), ck.friction(guide, 0.1)) if "friction" in kind else ()
    reach = ck.solve(plain, {driver.name: np.linspace(0.0, 6.3, 64)}).pairs[guide].value
    high = float(np.min(reach)) if "elastic" in kind else float(np.max(reach)) + 1.0
    hardness = {"stiffness": 5.0, "damping": 0.1} if "elastic" in kind else {}
    ends = () if kind == "friction" else (ck.stop(guide, high=high, **hardness, name="ends"),)
    cam = plain.replace(*rubs, *ends, ck.torque(driver.link, lambda t: 300.0 * np.cos(t)))
    chart = chart_of(ck.solve(cam, {driver.name: [0.3]}), (driver.name,), {})
    assert isinstance(chart, TabulatedChart)
    speed = 0.0 if kind == "rigid" else 3.0
    contact_watches.begin_at_stops(chart, np.array([0.3, speed, 0.0]))
    for value in np.linspace(-2.3, 2.7, 5).tolist():
        state = np.array([value, speed, 0.0])
        chart.begin(0.7, state[:1], state[1:2])
        chart.closed = chart.stop_contacts
        here = chart.state(0.7, state[:1], state[1:2])
        links, by = by_links(chart, here)
        n = len(links.free)
        links.begin(0.7, by[:n], by[n:])
        known = contact_watches.solved_pressing(contact, chart, here, state)
        assert abs(known) > 0.1
        assert tabulated_pressing(chart, contact, 0.7, value, speed) == pytest.approx(known, rel=1e-9)
        assert links.pressing(contact, 0.7, by[:n], by[n:]) == pytest.approx(known, rel=1e-9)


@pytest.mark.parametrize("name", [pytest.param("conjugate-cams", marks=pytest.mark.full), "constant-breadth-yoke"])
def test_cams_that_hold_each_other_are_pressed_without_bound(name: str) -> None:
    """By the table, and by the equations of all pairs: their states of self-stress squeeze both contacts."""
    plain = ck.load(name)
    size, (driver,) = plain.geometry.size, plain.drives
    masses = [ck.mass(link, 1.0, inertia=0.1 * size**2) for link in plain.links if link != "frame"]
    units = {"length": "mm", "mass": "kg", "force": "N"}
    cam = plain.replace(*masses, ck.gravity(0, -9.81), unit="", units=units)
    chart = chart_of(ck.solve(cam, {driver.name: [0.3]}), (driver.name,), {})
    links, state = by_links(chart, chart.state(0.0, np.array([0.3]), np.array([3.0])))
    n, contacts = len(links.free), [pair.name for pair in cam.written_pairs if as_profile_contact(pair) is not None]
    assert len(contacts) == 2
    for contact in contacts:
        assert tabulated_pressing(chart, contact, 0.0, 0.3, 3.0) == np.inf
        assert links.pressing(contact, 0.0, state[:n], state[n:]) == np.inf


def test_what_contacts_that_share_a_force_have_to_spare() -> None:
    """By one state of self-stress in closed form, as by the linear program, for random forces."""
    rng = np.random.default_rng(4)
    for _ in range(20):
        normals, state = rng.normal(size=4), rng.normal(size=4)
        one = undetermined._spare_along(normals, state)
        # a copy of the state changes nothing, and is solved by the linear program
        assert one == pytest.approx(undetermined._spare(normals, np.array([state, state])), rel=1e-9, abs=1e-9)
        assert undetermined._spare_along(normals, np.abs(state)) == np.inf
