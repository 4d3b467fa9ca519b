"""What the words of loads do to links: against equivalent forces, closed forms, and energy."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import compoundkin as ck
from compoundkin.dynamics.loaded_block import LoadedBlock, loaded_blocks
from compoundkin.errors import InvalidInput, InvalidMechanism, LikelySlip
from compoundkin.model.loads.mass import uniform_body
from tests.support import examples

SI = {"length": "m", "mass": "kg", "force": "N"}
CRANK = np.linspace(0.0, 2.0 * np.pi, 721)


def press(*words: Any, values: Any = CRANK) -> ck.Mechanism:
    """A slider-crank with its ram along x."""
    return ck.Mechanism(
        "Press", ck.link("frame", O=0, S=(1, 2)), ck.link("crank", O=0, A=1), ck.link("rod", A=0, B=3, G=(1, 0.5)),
        ck.link("ram", B=0), ck.slide("ram", on="frame", through="O", name="stroke"),
        ck.drive("crank", values=values, speed=2.0), *words, units=SI,
    )  # fmt: skip


def torque(mechanism: ck.Mechanism, driver: str = "crank") -> Any:
    return ck.force_analysis(ck.solve(mechanism)).drives[driver].effort


def block(mechanism: ck.Mechanism) -> LoadedBlock:
    return next(loaded_blocks(ck.solve(mechanism)))


RAM_RIGHT = (np.pi + 1e-9 < CRANK) & (2 * np.pi - 1e-9 > CRANK)
SAME = {
    "thrust": (ck.effort("stroke", 5.0), ck.force("B", (5, 0))),
    "thrust forward": (
        ck.effort("stroke", 5.0, only="forward"), ck.force("ram", (5, 0), at="B", while_moving=(1, 0)),
    ),
    "thrust back": (ck.effort("stroke", 5.0, only="back"), ck.force("ram", (5, 0), at="B", while_moving=(-2, 0))),
    "thrust by mask": (ck.effort("stroke", np.where(RAM_RIGHT, 5.0, 0.0)), ck.effort("stroke", 5.0, only="forward")),
    "place": (ck.force("rod", (1, 2), at="G"), ck.force("rod", (1, 2), at=(1, 0.5))),
    "letter of a point": (ck.force("rod", (1, 2), at="G"), ck.force("G", (1, 2))),
    "driver": (ck.effort("crank", 3.0), ck.torque("crank", 3.0)),
    "full name of a pin": (ck.effort("O(crank-frame)", -3.0), ck.torque("crank", 3.0)),
    "function of the coordinate": (
        ck.effort("crank", np.sin), ck.torque("crank", {"over": "crank", "at": CRANK, "values": np.sin(CRANK)}),
    ),
    "function of the rate": (ck.effort("stroke", lambda s, v: -4.0 * v), ck.damper(pair="stroke", rate=4.0)),
    "damper between points": (ck.damper("ram", "B", at="O", rate=4.0), ck.damper(pair="stroke", rate=4.0)),
    "function of a damper": (
        ck.damper("rod", "G", at="S", rate=lambda v: 4 * v), ck.damper("rod", "G", at="S", rate=4),
    ),
    "spring along": (
        ck.spring(pair="stroke", stiffness=7.0, free=1.5, preload=2.0),
        ck.spring("ram", "B", at="O", stiffness=7.0, free_length=1.5, preload=2.0),
    ),
    "one side": (
        ck.spring(pair="stroke", stiffness=7.0, free=3.0, only="tension"),
        ck.spring("ram", "B", at="O", stiffness=lambda x: 7.0 * x * (x > 0), free_length=3.0),
    ),
    "other side": (
        ck.spring(pair="stroke", stiffness=lambda x: 7.0 * x, free=3.0, only="compression"),
        ck.spring("ram", "B", at="O", stiffness=7.0, free_length=3.0, only="compression"),
    ),
    "table of a spring": (
        ck.spring("ram", "B", at="O", stiffness={"at": [-9, 9], "values": [-63, 63]}, free_length=1.0),
        ck.spring("ram", "B", at="O", stiffness=7.0, free_length=1.0),
    ),
    "components": (
        ck.force("G", (2.0, {"over": "crank", "at": [0, 7], "values": [0, 7]})),
        ck.force("G", {"over": "crank", "at": [0, 7], "values": [(2, 0), (2, 7)]}),
    ),
    "turning with a link": (
        ck.force("crank", (1, 2), at="A", fixed_in="crank"), ck.force("crank", (1 + 2j) * np.exp(1j * CRANK), at="A"),
    ),
}  # fmt: skip


@pytest.mark.parametrize(("one", "other"), SAME.values(), ids=SAME)
def test_two_ways_to_say_it(one: Any, other: Any) -> None:
    first, second = torque(press(one)), torque(press(other))
    assert np.max(np.abs(first)) > 0.5
    # at the dead points a load of one direction acts or not by rounding
    clear = np.abs(np.sin(CRANK)) > 1e-6
    np.testing.assert_allclose(first[clear], second[clear], rtol=0, atol=1e-9)


CONSERVATIVE = (
    ck.spring("rod", "G", at="S", stiffness=5.0, free_length=1.0, preload=0.5),
    ck.spring("rod", "G", at="S", stiffness=5.0, free_length=2.0, preload=0.5, only="tension"),
    ck.spring("rod", "G", to="crank", at=(0.2, -1), stiffness=5.0, free_length=2.0, only="compression"),
    ck.spring("ram", "B", at="S", stiffness=5.0),
    ck.spring(pair="A", stiffness=5.0, free=0.4, preload=1.0),
    ck.spring(pair="stroke", stiffness=5.0, free=3.0, preload=-1.0, only="tension"),
)


@pytest.mark.parametrize("spring", CONSERVATIVE, ids=lambda spring: f"{spring.name} {spring.only}")
def test_springs_give_back_their_energy(spring: Any) -> None:
    """The work of a spring between two poses is what its energy falls by: Simpson's rule over the power."""
    from scipy.integrate import simpson

    loaded = block(press(spring))
    power = sum(np.broadcast_to(w.power(loaded.pose(link)), (1, CRANK.size)) for _, link, w in loaded.named_loads())
    energy = np.broadcast_to(next(iter(loaded.motion.mechanism.loads.values())).energy(loaded), (1, CRANK.size))
    for end in (181, 361, 401, 721):
        work = simpson(power[0, :end], x=CRANK[:end] / 2.0)
        assert work == pytest.approx(energy[0, 0] - energy[0, end - 1], abs=1e-4 * np.max(np.abs(energy)))


def test_springs_whose_ends_meet() -> None:
    """Without a free length exactly no force; with one its direction is not known, which is said."""
    arm = ck.Mechanism("Arm", ck.link("frame", O=0, S=1), ck.link("arm", O=0, A=1),
                       ck.drive("arm", values=[0.0, 0.5]), units=SI)  # fmt: skip
    found = torque(arm.replace(ck.spring("arm", "A", at="S", stiffness=3)), driver="arm")
    assert found.tolist() == pytest.approx([0.0, 3.0 * np.sin(0.5)])
    loaded = block(arm.replace(ck.spring("arm", "A", at="S", stiffness=3, free_length=1)))
    with pytest.warns(LikelySlip, match="its ends coincide"):
        pulls = [np.ravel(wrench.force) for *_, wrench in loaded.named_loads()]
    assert [np.isnan(pull).tolist() for pull in pulls] == [[True, False]] * 2


def test_a_torsion_spring_winds_up() -> None:
    found = torque(press(ck.spring(pair="O", stiffness=2.0), values=np.linspace(0, 6 * np.pi, 37)))
    np.testing.assert_allclose(found, np.linspace(0, 12 * np.pi, 37), atol=1e-9)


def test_a_load_on_a_pin_is_carried_by_its_first_link() -> None:
    load = press(ck.force("B", (0, -3))).loads["force on B"]
    assert (load.link, load.at, load.on_pin) == ("rod", "B", "B")
    assert press(ck.force("G", (0, -3))).loads["force on G"].on_pin == ""


def test_smooth_tables_repeat() -> None:
    """A periodic spline through a cosine is one; one turn on it is the same."""
    at = np.linspace(0, 2 * np.pi, 73)
    table = {"over": "crank", "at": at, "values": np.cos(at), "period": 2 * np.pi, "smooth": True}
    turns = np.linspace(-3.0, 20.0, 50)
    np.testing.assert_allclose(torque(press(ck.torque("crank", table), values=turns)), -np.cos(turns), atol=1e-6)


@pytest.mark.parametrize(
    ("load", "told"),
    [
        (ck.effort("stroke", lambda s: 1 / 0), "efforts.effort along stroke: the function fails: ZeroDivisionError"),
        (ck.effort("stroke", lambda s: s[:-1]), "efforts.effort along stroke: the function returns shape"),
        (ck.effort("stroke", lambda s: "x"), "efforts.effort along stroke: the function does not return numbers"),
        (ck.effort("stroke", lambda s: s * np.inf), "efforts.effort along stroke: the function is not finite at"),
        (ck.torque("crank", lambda t: t), "torques.torque on crank: it depends on the time"),
        (ck.torque("crank", np.zeros(5)), r"torques.torque on crank: shape \(5,\) does not broadcast with \(721,\)"),
        (
            ck.effort("crank", {"at": [0, 1], "values": [0, 1]}),
            "efforts.effort along crank: 1.00.* is outside its table",
        ),
    ],
)
def test_amounts_that_are_none_are_named(load: Any, told: str) -> None:
    with np.errstate(all="ignore"), pytest.raises(InvalidInput, match=told):
        torque(press(load))


def test_functions_of_time() -> None:
    timed = press(ck.torque("crank", lambda t: 3 * np.sin(t)))
    motion = ck.solve(timed.replace(ck.drive("crank", law=lambda t: 2 * t)), time=np.linspace(0, 1, 7))
    found = ck.force_analysis(motion).drives["crank"].effort
    np.testing.assert_allclose(found, -3 * np.sin(np.linspace(0, 1, 7)), atol=1e-12)


def test_loads_stay_with_copies_frames_and_drivers() -> None:
    whole = press(
        ck.mass("rod", 2.0), ck.mass("ram", 1.0), ck.gravity(0, -9.81),
        ck.effort("crank", {"at": [0, 7], "values": [1, 8]}),
        ck.torque("rod", {"over": "crank", "at": [0, 7], "values": [1, 8]}), ck.friction("stroke", 0.0),
        ck.force("ram", (1, 0), at="B"), ck.spring("rod", "G", at="S", stiffness=3.0),
    )  # fmt: skip
    assert pickle.loads(pickle.dumps(whole)) == whole == copy.deepcopy(whole)
    assert whole != whole.replace(ck.mass("ram", 1.1))
    assert hash(whole) == hash(copy.copy(whole))
    driven = ck.with_driver(whole, "ram", values=np.linspace(3.2, 3.6, 5))
    assert driven.units == whole.units
    assert driven.loads["effort along crank"].pair == "O(frame-crank)"
    assert driven.loads["torque on rod"].torque.over == "O(frame-crank)"
    assert np.isfinite(ck.force_analysis(ck.solve(driven)).drives["ram"].effort).all()
    inverted = ck.with_frame(whole, "rod")
    assert set(inverted.masses) == {"ram"}
    assert inverted.loads["force on ram"].fixed_in == "old frame"
    assert set(inverted.loads["spring on rod"].links) == {"frame", "old frame"}


def test_impossible_words_are_all_said_at_once() -> None:
    with pytest.raises(InvalidMechanism) as raised:
        press(
            ck.mass("frame", 1), ck.mass("crank", -1), ck.mass("rod", 1, inertia=-1), ck.mass("ramm", 1),
            ck.mass("ram", [1, 2, 3]), ck.force("rod", (1, 2)), ck.force("rod", (1, 2), at="G", fixed_in="x", name="f"),
            ck.force("rod", (np.nan, 2), at="G", name="nan"),
            ck.torque("crank", {"over": "y", "at": [0, 1], "values": [0, 1]}),
            ck.effort("Q", 1), ck.spring("rod", "G", to="rod", at="A", stiffness=1), ck.spring(pair="S", stiffness=1),
            ck.damper("rod", "G", at="S", rate=-1), ck.damper("ram", "B", at="S", rate=-1, name="damper on rod"),
            ck.friction("O", 0.1), ck.friction("stroke", -0.1, radius=1), ck.pretension("O", 5),
            ck.gravity(0, -9), ck.gravity(0, -9), ck.mass("crank", 2),
        )  # fmt: skip
    assert {problem.where for problem in raised.value.problems} == {
        "masses[0].link", "masses[1].mass", "masses[2].inertia", "masses[3].link", "masses[4].mass", "masses[5]",
        "forces[0].at", "forces[1].fixed_in", "forces[2].force", "torques[0].torque.over", "efforts[0].pair",
        "springs[0].to", "springs[1].pair", "dampers[0].rate", "dampers[1].rate", "dampers[1]", "frictions[0].radius",
        "frictions[1].radius", "frictions[1].coefficient", "pretensions[0].pair", "gravity",
    }  # fmt: skip


def test_slips_are_warned_of() -> None:
    with pytest.warns(LikelySlip, match="9810 m/s\\^2 is"):
        ck.gravity(0, -9810)
    with pytest.warns(LikelySlip, match=r"masses\.rod\.inertia: it is 2\.5e-06 of that of a uniform body"):
        press(ck.mass("rod", 2, at=(1, 0), inertia=2e-6))


def test_units_are_needed_and_said_once() -> None:
    links = ck.link("frame", O=0), ck.link("crank", O=0, A=1)
    with pytest.raises(InvalidMechanism, match="units: it has a mass, and masses and forces need units"):
        ck.Mechanism("m", *links, ck.mass("crank", 1))
    with pytest.raises(InvalidMechanism, match="unit: units name the unit of length already"):
        ck.Mechanism("m", *links, units=SI, unit="m")
    with pytest.raises(InvalidMechanism, match=r"units\.mass: 'kgs' is no known unit of mass; did you mean 'kg'\?"):
        ck.Mechanism("m", *links, units={**SI, "mass": "kgs"})
    assert ck.gravity(0, -386.088582677165, unit="in/s^2").vector == pytest.approx(-9.80665j)


def test_masses_and_loads_over_designs() -> None:
    """Each design is as if it were alone, though all move alike."""

    def words(k: Any) -> tuple[Any, ...]:
        return ck.mass("ram", 1.0 + k), ck.spring("rod", "G", at="S", stiffness=2.0 + k), ck.torque("rod", 3.0 * k)

    together = torque(press(*words(np.array([[0.0], [1.0], [2.0]]))))
    assert together.shape == (3, CRANK.size)
    for k in range(3):
        np.testing.assert_allclose(together[k], torque(press(*words(float(k)))), rtol=1e-12, atol=1e-12)


def test_every_load_is_told_in_a_report() -> None:
    table = {"over": "crank", "at": [0, 7], "values": [1, 8]}
    loaded = press(ck.effort("stroke", lambda s: 0 * s), ck.torque("rod", table), ck.force("G", (2.0, table)),
                   ck.spring(pair="A", stiffness=table), ck.damper("rod", "G", at="S", rate=2.0),
                   values=[0.5, 1.0])  # fmt: skip
    told = " ".join(ck.report(loaded).text().split())
    for words in ("amount a function", "torque 1 to 8, a table over crank", "rate 2"):
        assert words in told


def test_a_table_of_unequal_lists_is_named_by_its_place() -> None:
    with pytest.raises(InvalidMechanism, match=r"torques.crank.torque.values: places and values have shapes"):
        ck.torque("crank", {"at": [0.0, 1.0], "values": [1.0]})


def test_a_rectangle_and_a_triangle() -> None:
    """a^2 + b^2 over 12; the sum of the sides' squares over 36 (textbooks, for a unit of mass)."""
    rectangle = uniform_body([1 + 1j, 4 + 3j, 4 + 1j, 1 + 3j, 2 + 2j])
    assert rectangle == ("uniform plate", pytest.approx(6.0), pytest.approx(2.5 + 2j), pytest.approx(13.0 / 12.0))
    a, b, c = 0j, 5 + 1j, 2 + 4j
    triangle = uniform_body([a, b, c])
    sides = abs(b - a) ** 2 + abs(c - b) ** 2 + abs(a - c) ** 2
    assert triangle.extent == pytest.approx(9.0)
    assert triangle.centre == pytest.approx((a + b + c) / 3.0)
    assert triangle.inertia == pytest.approx(sides / 36.0)


def test_points_in_line_are_a_bar() -> None:
    along = np.exp(0.7j)
    bar = uniform_body([along, 0j, 4 * along, 3 * along])
    assert bar == ("uniform bar", pytest.approx(4.0), pytest.approx(2 * along), pytest.approx(16.0 / 12.0))


coordinates = st.integers(-20, 20)


@settings(max_examples=examples(60))
@given(st.lists(st.builds(complex, coordinates, coordinates), min_size=3, max_size=7), st.randoms())
def test_the_plate_is_that_of_its_hull(points: list[complex], order: object) -> None:
    """Against scipy's hull cut into triangles from its first point; in any order; over designs at once."""
    from scipy.spatial import ConvexHull, QhullError

    body = uniform_body(points)
    order.shuffle(points)  # type: ignore[attr-defined]
    np.testing.assert_allclose(uniform_body(points)[1:], body[1:], rtol=1e-9, atol=1e-9)
    designs = uniform_body([np.array([[p], [2 * p], [1j * p]]) for p in points])
    factors = np.array([1.0, 4.0, 1.0])[:, None]
    if body.kind == "uniform plate":
        np.testing.assert_allclose(designs.extent, body.extent * factors, rtol=1e-9)
    if body.extent:
        np.testing.assert_allclose(designs.inertia, body.inertia * factors, rtol=1e-9)
    try:
        hull = np.array(points)[ConvexHull(np.array([[p.real, p.imag] for p in points])).vertices]
    except QhullError:
        assert body.kind == "uniform bar"
        return
    corners = [(hull[0], b, c) for b, c in pairwise(hull[1:])]
    areas = np.array([abs(((b - a).conjugate() * (c - a)).imag) / 2.0 for a, b, c in corners])
    centres = np.array([(a + b + c) / 3.0 for a, b, c in corners])
    own = np.array([(abs(b - a) ** 2 + abs(c - b) ** 2 + abs(a - c) ** 2) / 36.0 for a, b, c in corners])
    centre = np.sum(areas * centres) / np.sum(areas)
    inertia = np.sum(areas * (own + abs(centres - centre) ** 2)) / np.sum(areas)
    np.testing.assert_allclose(body[1:], (np.sum(areas), centre, inertia), rtol=1e-9)


def test_what_is_assumed_is_said() -> None:
    linkage = ck.Mechanism(
        "m", ck.link("frame", A=0), ck.link("bar", A=0, B=6), ck.link("plate", B=0, C=6, D=3j), ck.link("dot", C=0),
        ck.mass("bar", density=0.5), ck.mass("plate", 2.0, at="C"), ck.mass("dot", 1.0), units=SI,
    )  # fmt: skip
    masses = linkage.masses
    assert (masses["bar"].mass, masses["bar"].at, masses["bar"].inertia) == (3.0, 3.0, 9.0)
    assert masses["bar"].assumed == "mass and mass centre and inertia of a uniform bar A-B"
    assert (masses["plate"].at, masses["plate"].inertia) == ("C", pytest.approx(5.0))
    assert masses["plate"].assumed == "inertia of a uniform plate B-C-D"
    assert (masses["dot"].at, masses["dot"].inertia) == (0.0, 0.0)
    assert linkage.replace(ck.mass("bar", 1, at=(0, 0), inertia=0)).masses["bar"].assumed == ""


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (ck.effort("stroke", lambda w, q: 3.0 * w - q), ck.effort("stroke", lambda q, w: 3.0 * w - q)),
        (ck.effort("stroke", lambda w: -4.0 * w), ck.damper(pair="stroke", rate=4.0)),
        (ck.effort("stroke", lambda speed: -4.0 * speed), ck.damper(pair="stroke", rate=4.0)),
        (ck.spring(pair="stroke", stiffness=lambda w, x: 7.0 * x), ck.spring(pair="stroke", stiffness=7.0)),
        (ck.damper(pair="stroke", rate=lambda q, w: 4.0 * w), ck.damper(pair="stroke", rate=4.0)),
        (ck.torque("crank", lambda w: -4.0 * w), ck.damper(pair="O", rate=4.0)),
        (ck.effort("stroke", lambda q, k=7.0: -k * q), ck.spring(pair="stroke", stiffness=7.0)),
    ],
)
def test_functions_take_what_their_arguments_are_called(one: object, other: object) -> None:
    np.testing.assert_allclose(torque(press(one)), torque(press(other)), atol=1e-9)


@pytest.mark.parametrize(
    ("write", "told"),
    [
        (
            lambda: ck.torque("crank", lambda q: q),
            r"takes 'q'; arguments are known by their names: t \(time\), w \(rate\)",
        ),
        (lambda: ck.force("ram", lambda w: w, at="B"), r"takes 'w'; arguments are known by their names: t \(time\)"),
        (lambda: ck.effort("stroke", lambda *, q: q), "by keyword only"),
        (lambda: ck.effort("stroke", lambda a: a), r"q \(coordinate\), w \(rate\), t \(time\)"),
        (lambda: ck.effort("stroke", lambda q, s: q), "takes 'q', 's'"),
        (lambda: ck.effort("stroke", lambda: 3.0), "takes no arguments"),
    ],
)
def test_other_arguments_are_refused(write: Callable[[], object], told: str) -> None:
    with pytest.raises(InvalidMechanism, match=told):
        write()
