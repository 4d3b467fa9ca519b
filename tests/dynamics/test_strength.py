"""Forces along the bars of links, against closed forms and their own equilibrium."""

from __future__ import annotations

import re
import warnings
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.dynamics.strength import BENDING, NORMAL, SHEAR

UNITS = {"length": "m", "mass": "kg", "force": "N"}
# Equilibrium at the far end is so good, of the largest force or moment.
ROUNDING = 1e-10


def arm(*items: Any, **points: Any) -> ck.Mechanism:
    """An arm of 2 m on the frame, driven."""
    return ck.Mechanism(
        "Arm", ck.link("frame", A=0), ck.link("arm", A=0, B=2, **points), ck.drive("arm"), *items, units=UNITS
    )


def slider_crank(angle: float = 0.0) -> ck.Mechanism:
    """A slider-crank with uniform bars, all of it turned by an angle."""
    u = complex(np.exp(1j * angle))
    return ck.Mechanism(
        "Slider-crank",
        ck.link("frame", O=0),
        ck.link("crank", O=0, A=0.05),
        ck.link("rod", A=0, B=0.2),
        ck.link("piston", B=0),
        ck.slide("piston", on="frame", through="O", angle=angle, name="cylinder"),
        ck.drive("crank"),
        ck.mass("crank", 2.0),
        ck.mass("rod", 0.8),
        ck.mass("piston", 0.5),
        ck.force("piston", (-300 * u.real, -300 * u.imag), at="B"),
        units=UNITS,
    )


def test_a_cantilever_under_a_force_at_its_end() -> None:
    mechanism = arm(ck.force("arm", (30, -50), at="B"))
    bar = ck.figures.strength(ck.force_analysis(ck.solve(mechanism, {"arm": [0.0]}), inertia=False)).bars["arm"]
    np.testing.assert_allclose(bar.normal[(bar.position > 0) & (bar.position < 2)], 30.0)
    least, greatest = bar.extremes(BENDING)
    np.testing.assert_allclose(least[:2], (-100.0, 0.0), atol=1e-12)
    np.testing.assert_allclose(greatest.value, 0.0, atol=1e-12)
    np.testing.assert_allclose(bar.extremes(SHEAR)[1].value, 50.0)


def simply_supported() -> ck.Mechanism:
    """A level parallelogram: its coupler of 3 m lies on two equal cranks."""
    return ck.Mechanism(
        "Table",
        ck.link("frame", O=(0, 0), C=(3, 0)),
        ck.link("crank", O=(0, 0), A=(0, 1)),
        ck.link("top", A=(0, 0), B=(3, 0)),
        ck.link("rocker", C=(0, 0), B=(0, 1)),
        ck.drive("crank"),
        ck.mass("top", 6.0),
        ck.gravity(0, -10),
        units=UNITS,
    )


def test_a_simply_supported_bar_under_its_weight() -> None:
    """M = q l^2 / 8 in its middle."""
    motion = ck.solve(simply_supported(), {"crank": [0.0]})
    bar = ck.figures.strength(ck.force_analysis(motion, inertia=False), "top").bars["top"]
    np.testing.assert_allclose(bar.extremes(BENDING)[1][:2], (20 * 9 / 8, 1.5))
    np.testing.assert_allclose([end.value for end in bar.extremes(SHEAR)], [-30, 30])


def four_bar() -> ck.Mechanism:
    """A four-bar whose rocker alone has a mass."""
    return ck.Mechanism(
        "Four-bar",
        ck.link("frame", O=(0, 0), C=(0.14, 0)),
        ck.link("crank", O=(0, 0), A=(0.05, 0)),
        ck.link("coupler", A=(0, 0), B=(0.15, 0)),
        ck.link("rocker", C=(0, 0), B=(0.12, 0)),
        ck.drive("crank"),
        ck.mass("rocker", 1.5),
        units=UNITS,
    )


def test_a_rocker_under_an_inertia_load_that_grows_along_it() -> None:
    """Supported at both ends under a triangle of q = m alpha: M = q l^2 / (9 sqrt 3) at l / sqrt 3.

    The coupler without mass is a member with two forces: neither shear nor moment.
    """
    turn = np.deg2rad(np.arange(0.0, 360.0, 20.0))
    found = ck.figures.strength(ck.force_analysis(ck.solve(four_bar(), turn, speed=100)))
    rocker, alpha = found.bars["rocker"], found.forces.links["rocker"].angular_acceleration
    greatest = np.abs(rocker.bending).max(axis=-1)
    np.testing.assert_allclose(greatest, 1.5 * np.abs(alpha) * 0.12**2 / (9 * np.sqrt(3)), rtol=1e-10)
    at = np.take_along_axis(rocker.position, np.abs(rocker.bending).argmax(axis=-1)[:, None], axis=-1)
    np.testing.assert_allclose(at, 0.12 / np.sqrt(3), rtol=1e-9)
    coupler = found.bars["coupler"]
    np.testing.assert_allclose(coupler.shear, 0.0, atol=ROUNDING * np.abs(coupler.normal).max())
    np.testing.assert_allclose(coupler.bending, 0.0, atol=ROUNDING * np.abs(coupler.normal).max())


def test_a_rod_under_any_inertia_load_as_by_quadrature() -> None:
    """The rod of a slider-crank: accelerations of its ends, and the bar's shear and moment integrated numerically."""
    forces = ck.force_analysis(ck.solve(slider_crank(), {"crank": [1.3]}, speed=100))
    bar = ck.figures.strength(forces, "rod").bars["rod"]
    along = np.conj(np.exp(1j * forces.links["rod"].angle[0]))
    across = [(along * forces.points[name].acceleration[0]).imag for name in "AB"]
    s, step = np.linspace(0.0, 0.2, 20001, retstep=True)
    load = -0.8 / 0.2 * (across[0] + (across[1] - across[0]) * s / 0.2)
    support = np.trapezoid(load * (0.2 - s), dx=step) / 0.2
    shear = -support + np.concatenate([[0.0], np.cumsum((load[1:] + load[:-1]) / 2 * step)])
    bending = np.concatenate([[0.0], np.cumsum((shear[1:] + shear[:-1]) / 2 * step)])
    k = int(np.argmax(np.abs(bending)))
    found = max(bar.extremes(BENDING), key=lambda end: abs(end.value))
    np.testing.assert_allclose(found.value, bending[k], rtol=1e-6)
    np.testing.assert_allclose(found.position, s[k], atol=2 * step)


@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_forces_return_to_zero_behind_the_last_point(angle: float) -> None:
    turn = np.deg2rad(np.arange(0.0, 360.0, 7.0))
    found = ck.figures.strength(ck.force_analysis(ck.solve(slider_crank(angle), turn + angle, speed=150)))
    assert set(found.bars) == {"crank", "rod"}
    assert set(found.undefined) == {"piston"}
    for bar in found.bars.values():
        for values, size in ((bar.normal, 1.0), (bar.shear, 1.0), (bar.bending, bar.length[0])):
            np.testing.assert_allclose(values[:, [0, -1]], 0.0, atol=ROUNDING * size * np.abs(bar.normal).max())
        step = np.diff(bar.position, axis=-1)
        inside = step > 1e-6
        middle = (bar.shear[:, 1:] + bar.shear[:, :-1]) / 2
        # of a parabola the trapezoidal rule errs by V'' h^3 / 12, and V'' is m alpha / l
        alpha = np.abs(found.forces.links[bar.link].angular_acceleration)[:, None]
        mass = found.forces.mechanism.masses[bar.link].mass
        error = mass * alpha / bar.length[0] * step**3 / 12 + ROUNDING * np.abs(bar.bending).max()
        assert np.all((np.abs(np.diff(bar.bending, axis=-1) - middle * step) <= error)[inside])


def test_turning_the_mechanism_changes_nothing() -> None:
    turn = np.deg2rad(np.arange(0.0, 360.0, 30.0))
    bars = [
        ck.figures.strength(ck.force_analysis(ck.solve(slider_crank(angle), turn + angle, speed=150))).bars["rod"]
        for angle in (0.0, 1.1)
    ]
    for what in (NORMAL, SHEAR, BENDING):
        values = [[end.value for end in bar.extremes(what)] for bar in bars]
        np.testing.assert_allclose(values[0], values[1], rtol=1e-9, atol=1e-9)


def test_a_given_mass_is_a_force_at_its_centre_and_a_point_aside_carries_nothing() -> None:
    mechanism = arm(ck.mass("arm", 3, at=(0.5, 0.4), inertia=1), ck.gravity(0, -10), C=(1, 1))
    forces = ck.force_analysis(ck.solve(mechanism, {"arm": [0.0]}), inertia=False)
    assert "no bar" in ck.figures.strength(forces).undefined["arm"]
    loaded = mechanism.replace(ck.force("arm", (0, -1), at="B"))
    bar = ck.figures.strength(ck.force_analysis(ck.solve(loaded, {"arm": [0.0]}), inertia=False)).bars["arm"]
    np.testing.assert_allclose(bar.extremes(BENDING)[0][:2], (-30 * 0.5 - 2.0, 0.0))
    assert "force and a moment" in bar.assumed


def test_stresses_of_sections_and_pins_and_the_buckling_load() -> None:
    """A strut of two forces: Euler's load, N / A, and the pin's F / A and F / (d b) by hand."""
    turn = np.deg2rad(np.arange(0.0, 360.0, 20.0))
    forces = ck.force_analysis(ck.solve(four_bar(), turn, speed=100))
    round_bar, tube = {"diameter": 0.02}, {"diameter": 0.02, "wall": 0.01}
    rectangle = {"width": 0.01, "height": 0.03}
    given = {"sections": {"coupler": round_bar, "rocker": rectangle}, "elasticity": {"coupler": 2.1e11}}
    found = ck.figures.strength(forces, **given, pins={"B": (0.01, 0.02), "A": (0.01, 0.02, 2)})
    normal = found.bars["coupler"].normal
    np.testing.assert_allclose(found.buckling["coupler"].load, np.pi**3 * 2.1e11 * 0.02**4 / 64 / 0.15**2)
    np.testing.assert_allclose(found.buckling["coupler"].compression, -normal.min())
    np.testing.assert_allclose(found.stresses["coupler"].max(), np.abs(normal).max() / (np.pi * 1e-4), rtol=1e-9)
    bending = found.bars["rocker"].bending
    normal = found.bars["rocker"].normal
    by_hand = np.abs(normal) / 3e-4 + np.abs(bending) * 0.015 / (0.01 * 0.03**3 / 12)
    np.testing.assert_allclose(found.stresses["rocker"], by_hand)
    force = np.abs(forces.pairs["B"].force).max()
    np.testing.assert_allclose(found.pins["B"].shear, force / (np.pi * 0.01**2 / 4))
    np.testing.assert_allclose(found.pins["B"].pressure, force / (0.01 * 0.02))
    np.testing.assert_allclose(found.pins["A"].shear, np.abs(forces.pairs["A"].force).max() / (np.pi * 0.01**2 / 2))
    solid = ck.figures.strength(forces, sections={"coupler": tube}).stresses["coupler"]
    np.testing.assert_allclose(solid, found.stresses["coupler"])
    assert {"buckling load", "bearing pressure", "N/m^2"} == set(
        re.findall("buckling load|bearing pressure|N/m.2", found.text())
    )


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"sections": {"coupler": {"diameter": -1}}}, "diameter: -1 is no number above zero"),
        ({"sections": {"coupler": {"radius": 1}}}, "is no section"),
        ({"sections": {"coupler": {"diameter": 1, "wall": 0.6}}}, "more than half"),
        ({"sections": {"couple": {"diameter": 1}}}, "did you mean 'coupler'"),
        ({"elasticity": {"coupler": 2e11}}, "without a section"),
        ({"sections": {"crank": {"diameter": 1}}, "elasticity": {"crank": 2e11}}, "not pinned at two ends"),
        ({"pins": {"B": (0, 1)}}, "diameter: 0 is no number above zero"),
        ({"pins": {"B": 3}}, "is no pin"),
        ({"pins": {"X": (1, 1)}}, "X"),
    ],
)
def test_sections_and_pins_that_are_refused(given: Any, message: str) -> None:
    forces = ck.force_analysis(ck.solve(four_bar(), {"crank": [1.0]}, speed=100))
    with pytest.raises((ck.errors.InvalidInput, ck.errors.UnknownName), match=message):
        ck.figures.strength(forces, **given)


def test_the_table_of_loads_is_in_equilibrium_in_the_axes_of_each_link() -> None:
    turn = np.deg2rad(np.arange(0.0, 360.0, 40.0))
    forces = ck.force_analysis(ck.solve(slider_crank(0.7), turn, speed=100))
    table = ck.figures.strength(forces).table()
    names = [name for name in table.names if name.startswith("rod.") and name.endswith(".moment")]
    assert [name.split(".")[1] for name in names] == ["pair A", "pair B", "inertia rod"]
    force, moment = 0j, 0.0
    for name in (name.removesuffix(".moment") for name in names):
        place, own = (
            table[f"{name}.{word}.x"].values + 1j * table[f"{name}.{word}.y"].values for word in ("place", "force")
        )
        force, moment = force + own, moment + table[f"{name}.moment"].values + (np.conj(place) * own).imag
    size = np.abs(table["rod.pair A.force.x"].values).max()
    np.testing.assert_allclose(force, 0.0, atol=ROUNDING * size)
    np.testing.assert_allclose(moment, 0.0, atol=ROUNDING * size)
    np.testing.assert_allclose(table["rod.pair B.place.x"].values, 0.2)


def test_arms_of_a_bell_crank() -> None:
    """Arms of 2 and 1 m at right angles: 10 N at the end of one and 20 N at that of the other hold each other."""
    mechanism = ck.Mechanism(
        "Bell crank",
        ck.link("frame", P=0),
        ck.link("bell", P=0, A=2, B=1j),
        ck.drive("bell"),
        ck.force("bell", (0, -10), at="A", name="pull"),
        ck.force("bell", (-20, 5), at="B", name="rod"),
        ck.mass("bell", 1.0),
        ck.gravity(0, -9),
        units=UNITS,
    )
    forces = ck.force_analysis(ck.solve(mechanism, {"bell": [0.0]}), inertia=False)
    found = ck.figures.strength(forces, sections={"bell A-P": {"diameter": 0.1}})
    assert list(found.bars) == ["bell A-P", "bell B-P"]
    first, second = found.bars.values()
    # of A-P, x from A to P: the force of 10 N down is +10 in its y, and the moment at P 20
    np.testing.assert_allclose(first.extremes(BENDING)[1][:2], (20.0, 2.0))
    np.testing.assert_allclose(first.extremes(NORMAL)[1].value, 0.0, atol=1e-12)
    np.testing.assert_allclose(np.abs(second.bending).max(), 20.0)
    np.testing.assert_allclose(second.extremes(NORMAL)[1].value, 5.0)
    for bar in (first, second):
        np.testing.assert_allclose([bar.normal[0, -1], bar.shear[0, -1], bar.bending[0, -1]], 0.0, atol=1e-12)
    np.testing.assert_allclose(found.stresses["bell A-P"].max(), 20 * 32 / (np.pi * 1e-3))
    assert "an arm held at P" in found.text()


def test_designs_are_those_alone_and_poses_that_are_not_assembled_are_left_out() -> None:
    """Three rods, the shortest of which cannot turn: each has what it has alone."""
    turn = np.deg2rad(np.arange(0.0, 360.0, 30.0))

    def found(length: Any) -> Any:
        coupler = ck.link("coupler", A=(0, 0), B=(length, 0))
        mechanism = four_bar().replace(coupler, ck.mass("coupler", 0.7))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
            forces = ck.force_analysis(ck.solve(mechanism, turn, speed=10))
        return ck.figures.strength(forces, sections={"coupler": {"diameter": 0.01}}, pins={"B": (0.01, 0.01)})

    lengths = [0.15, 0.16, 0.03]
    several = found(np.array(lengths)[:, None])
    assert not several.forces.assembled.all()
    for k, length in enumerate(lengths):
        alone = found(length)
        for what in (NORMAL, SHEAR, BENDING):
            for one, other in zip(
                several.bars["coupler"].extremes(what, k), alone.bars["coupler"].extremes(what), strict=True
            ):
                np.testing.assert_allclose(one.value, other.value, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(several.pins["B"].pressure[k], alone.pins["B"].pressure[0])
    assert several.text().startswith("design 0")
    assert len(several.table()) == 36


def test_what_is_refused() -> None:
    bare = ck.force_analysis(ck.solve(arm(), {"arm": [0.0]}))
    with pytest.raises(ck.errors.InvalidInput, match="no masses and no loads"):
        ck.figures.strength(bare)
    forces = ck.force_analysis(ck.solve(arm(ck.mass("arm", 1)), {"arm": [0.0]}))
    with pytest.raises(ck.errors.UnknownName, match="did you mean 'arm'"):
        ck.figures.strength(forces, "arn")
    with pytest.raises(ck.errors.UnknownName, match="frame is no bar"):
        ck.figures.strength(forces, "frame")
    with pytest.raises(ck.errors.UnknownName, match="bending"):
        ck.figures.strength(forces).bars["arm"].extremes("bending")


def test_values_between_the_stations() -> None:
    """An arm under its weight: M = -q (l - x)^2 / 2, V = q (l - x), anywhere; all of it at either end."""
    mechanism = arm(ck.mass("arm", 3.0), ck.gravity(0, -10))
    motion = ck.solve(mechanism, {"arm": [0.0, np.pi]})
    bar = ck.figures.strength(ck.force_analysis(motion, inertia=False)).bars["arm"]
    places = np.array([0.0, 0.013, 0.777, 1.4142, 1.999])
    load, sides = 15.0, np.array([[1.0], [-1.0]])
    np.testing.assert_allclose(bar.along(BENDING, places), -sides * load * (2 - places) ** 2 / 2, atol=1e-12)
    np.testing.assert_allclose(bar.along(SHEAR, places), sides * load * (2 - places), atol=1e-12)
    found, least, greatest = bar.envelope(BENDING)
    np.testing.assert_allclose(greatest, load * (2 - found) ** 2 / 2, atol=1e-12)
    np.testing.assert_allclose(least, -greatest, atol=1e-12)
    with pytest.raises(ck.errors.UnknownName, match="torsion"):
        bar.along("torsion", places)


def test_a_force_within_the_bar_is_on_both_of_its_sides() -> None:
    mechanism = arm(ck.force("arm", (0, -8), at="P"), P=0.7)
    bar = ck.figures.strength(ck.force_analysis(ck.solve(mechanism, {"arm": [0.0]}), inertia=False)).bars["arm"]
    places = bar.stations()
    before, behind = places[places < 0.7].max(), places[places > 0.7].min()
    assert behind - before < 1e-8
    np.testing.assert_allclose(bar.along(SHEAR, np.array([before, behind])), [[8.0, 0.0]], atol=1e-12)
    assert bar.places() == {"A": 0.0, "P": 0.7, "B": 2.0}


def test_diagrams_have_the_three_quantities_and_their_envelope() -> None:
    turn = np.deg2rad(np.arange(0.0, 360.0, 15.0))
    found = ck.figures.strength(ck.force_analysis(ck.solve(slider_crank(), turn, speed=80)))
    axes = ck.plots.bar_diagrams(found, "rod", pose=5).figure.axes
    assert [one.get_ylabel() for one in axes] == ["normal force [N]", "shear [N]", "bending moment [N m]"]
    for one, what in zip(axes, (NORMAL, SHEAR, BENDING), strict=True):
        drawn = [line.get_ydata() for line in one.get_lines() if len(line.get_ydata()) > 2]
        places, least, greatest = found.bars["rod"].envelope(what)
        for curve, wanted in zip(drawn, (least, greatest, found.bars["rod"].along(what, places)[5]), strict=True):
            np.testing.assert_array_equal(curve, wanted)
    with pytest.raises(ck.errors.UnknownName, match="did you mean 'rod'"):
        ck.plots.bar_diagrams(found, "rodd")
    with pytest.raises(ck.errors.InvalidInput, match="there is no pose 24"):
        ck.plots.bar_diagrams(found, "rod", pose=24)
