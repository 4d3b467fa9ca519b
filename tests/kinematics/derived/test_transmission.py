"""Transmission angles and indices: closed forms, published angles, the forces of a cut group, limit positions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.kinematics.derived.transmission_angle import block_of
from compoundkin.kinematics.groups.general import GeneralSolver
from compoundkin.model.geometry import FRAME
from tests import catalog
from tests.support import KINDS_OF_DYAD, drawn_values, random_sketch

FULL = ck.deg(np.arange(0.0, 361.0, 5.0))


def values(motion: ck.results.Motion, name: str) -> Any:
    return ck.quantity(motion, name).values


# --- closed forms and published numbers -------------------------------------------------------------------------


def test_four_bar_of_norton() -> None:
    """Its extremes by the cosine rule where crank and frame are in line; at 40 degrees theta4 - theta3 of Example 4-1.

    R. L. Norton, Design of Machinery, sections 3.3 and 4.10: cos mu = (b^2 + c^2 - (d -+ a)^2) / (2 b c).
    """
    a, b, c, d = 40.0, 120.0, 80.0, 100.0
    for name in ("four-bar-norton", "four-bar-norton-crossed"):
        motion = ck.solve(catalog.mechanism(name), {"crank": ck.deg([0.0, 40.0, 180.0])})
        found = values(motion, "rocker.transmission_angle")
        ends = [np.arccos((b**2 + c**2 - (d + sign * a) ** 2) / (2 * b * c)) for sign in (-1, 1)]
        assert found[[0, 2]] == pytest.approx(np.minimum(ends, np.pi - np.array(ends)), rel=1e-12)
        assert np.rad2deg(found[1]) == pytest.approx(57.325 - 20.298, abs=1e-3)
        assert values(motion, "coupler.transmission_angle") == pytest.approx(found)
        assert values(motion, "rocker.transmission_index") == pytest.approx(np.sin(found))


@pytest.mark.parametrize("offset", [0.0, 15.0])
def test_slider_crank_by_the_angle_of_its_rod(offset: float) -> None:
    """It is 90 degrees less the angle between rod and guide, whose sine is (r sin q - e) / l."""
    r, rod = 40.0, 110.0
    mechanism = ck.Mechanism(
        "offset", ck.link("frame", A=0, G=(0, offset)), ck.link("crank", A=0, B=r), ck.link("rod", B=0, C=rod),
        ck.link("piston", C=0), ck.slide("piston", on="frame", at="C", through="G"), ck.drive("crank"),
    )  # fmt: skip
    motion = ck.solve(mechanism, {"crank": FULL})
    angle = np.arcsin((r * np.sin(FULL) - offset) / rod)
    for link in ("rod", "piston"):
        assert values(motion, f"{link}.transmission_angle") == pytest.approx(np.pi / 2 - np.abs(angle), abs=1e-12)


def oscillating_guide(offset: float) -> ck.Mechanism:
    """A crank pin whose block slides on a lever, the guide beside the lever's pin."""
    return ck.Mechanism(
        "guide", ck.link("frame", C=(0, 80), D=0), ck.link("crank", C=0, A=30), ck.link("block", A=0),
        ck.link("lever", D=0), ck.slide("block", on="lever", at="A", through="D", offset=offset, name="slot"),
        ck.drive("crank", speed=2.0),
    )  # fmt: skip


def test_oscillating_guide_with_an_offset() -> None:
    """The force across the guide has the lever arm sqrt(s^2 - e^2) of s, the distance of the pins: cos mu = e / s."""
    motion = ck.solve(oscillating_guide(12.0), {"crank": FULL})
    apart = np.abs(np.asarray(motion.points["A"].position))
    assert np.cos(values(motion, "lever.transmission_angle")) == pytest.approx(12.0 / apart, rel=1e-12)
    straight = ck.solve(oscillating_guide(0.0), {"crank": FULL})
    assert values(straight, "lever.transmission_angle") == pytest.approx(np.pi / 2, abs=1e-12)


def test_ratio_of_a_four_bar_by_its_angles() -> None:
    """Norton, section 6.4: m_V = a sin(nu) / (c sin(mu)), nu being the angle between crank and coupler."""
    motion = catalog.motion("crank-rocker")
    a, c = (abs(complex(np.diff(list(motion.mechanism.geometry.points[n].values()))[0])) for n in ("crank", "rocker"))
    nu = motion.links["coupler"].angle - motion.links["crank"].angle
    sine = values(motion, "rocker.transmission_index")
    expected = a * np.abs(np.sin(nu)) / (c * sine)
    assert np.abs(values(motion, "rocker.velocity_ratio")) == pytest.approx(expected, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("name", ["class-iii-six-bar", "3-rrr"])
def test_a_plate_on_three_bars_by_the_pole_of_two(name: str) -> None:
    """Cut one bar: the plate turns about the point where the other two meet, and moves the bar's pin across the ray.

    The output transmission index of J. Wang, C. Wu and X.-J. Liu, Mech. Mach. Theory 45 (2010) 1462, by plain geometry.
    """
    motion = catalog.motion(name)
    (group,) = [group for group in motion.structure.groups if len(group.bodies) == 4]
    plate = max(group.links, key=lambda link: len(motion.mechanism.links[link].points))
    bars = [link for link in group.links if link != plate]
    at = {k: np.asarray(motion.points[k].position) for link in bars for k in motion.mechanism.links[link].points}
    on_plate, pins = motion.mechanism.links[plate].points, []
    for link in bars:
        near, far = sorted(motion.mechanism.links[link].letters, key=lambda k: k not in on_plate)
        pins.append((at[near], (at[near] - at[far]) / np.abs(at[near] - at[far])))
    worst = np.ones(motion.shape)
    for k, (pin, along) in enumerate(pins):
        (one, u), (two, v) = (pins[j] for j in range(3) if j != k)
        pole = one + u * (np.conj(two - one) * v).imag / (np.conj(u) * v).imag
        ray = (pole - pin) / np.abs(pole - pin)
        worst = np.minimum(worst, np.abs((np.conj(ray) * along).imag))
    assert values(motion, f"{plate}.transmission_index") == pytest.approx(worst, rel=1e-9)


# --- the same in two ways, over everything ----------------------------------------------------------------------


def agree(motion: ck.results.Motion) -> None:
    """Every closed form is that of the forces in the group's bodies, which are cut one after another."""
    for solver in motion.solving_order.solvers:
        if not solver.tells_transmission:
            continue
        index = values(motion, f"{solver.group.links[0]}.transmission_index")
        cut = GeneralSolver.of(solver.index, solver.group, motion.size, motion.inputs.ends)
        with np.errstate(all="ignore"):
            found = cut.transmission(block_of(motion, solver))
        known = motion.grid.known(np.abs(found.imag) / np.abs(found))
        assert index == pytest.approx(known, abs=1e-9, nan_ok=True), solver
        assert np.isfinite(index[motion.assembled]).all(), solver
        assert np.isnan(index[~motion.assembled]).all(), solver


@pytest.mark.filterwarnings("ignore::UserWarning")
@catalog.each(catalog.NAMES)
def test_closed_forms_are_those_of_cut_forces(name: str) -> None:
    agree(catalog.motion(name))


@pytest.mark.parametrize("kind", KINDS_OF_DYAD)
def test_dyads_of_every_kind_and_what_must_not_matter(kind: str) -> None:
    """Turned, moved, mirrored and in another unit they transmit as before."""
    for seed in range(4):
        sketch = random_sketch(np.random.default_rng(seed), [kind, kind])
        one, two = map(as_drawn, (sketch.mechanism(), sketch.mechanism(lambda p: (80 - 120j) * p.conjugate() + 70j)))
        agree(one)
        for link in (name for name in one.links if name != FRAME and "transmission_angle" in words(one, name)):
            found = values(two, f"{link}.transmission_angle")
            assert found == pytest.approx(values(one, f"{link}.transmission_angle"), abs=1e-9)


def as_drawn(mechanism: ck.Mechanism) -> ck.results.Motion:
    return ck.solve(mechanism, {name: [value] for name, value in drawn_values(mechanism).items()})


def words(motion: ck.results.Motion, name: str) -> list[str]:
    return [word for word in ("transmission_angle", "transmission_index") if has(motion, f"{name}.{word}")]


def has(motion: ck.results.Motion, name: str) -> bool:
    try:
        ck.quantity(motion, name)
    except ck.errors.UnknownName:
        return False
    return True


@pytest.mark.filterwarnings("ignore::compoundkin.errors.FewDigits")
@pytest.mark.parametrize(
    "name", ["triple-rocker", "double-rocker", "slider-crank-driven-by-piston", "stephenson-ii-driven-at-binary"]
)
def test_nothing_is_transmitted_at_limit_positions(name: str) -> None:
    """A billionth of a radian before them less than a thousandth is left: it goes with the root of the distance."""
    found = ck.circuits(catalog.mechanism(name))
    assert found.limits
    for limit in found.limits[:4]:
        before = limit.value - 1e-9 if limit.greatest else limit.value + 1e-9
        motion = ck.solve(found.structure, {found.driver: [before]}, modes=limit.configuration)
        assert values(motion, f"{limit.links[0]}.transmission_index")[0] < 1e-3


# --- what a motion may be ---------------------------------------------------------------------------------------


@pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")
def test_designs_gaps_and_positions_alone() -> None:
    mechanism = ck.Mechanism(
        "designs", ck.link("frame", A=0, D=100), ck.link("crank", A=0, B=40),
        ck.link("coupler", B=0, C=np.array([[50.0], [120.0]])), ck.link("rocker", D=0, C=80), ck.drive("crank"),
    )  # fmt: skip
    motion = ck.solve(mechanism, {"crank": FULL}, order=0)
    found = values(motion, "rocker.transmission_angle")
    assert found.shape == motion.shape == (2, len(FULL))
    assert np.isnan(found[~motion.assembled]).all()
    assert not motion.assembled[0].all()
    alone = catalog.mechanism("four-bar-norton")
    assert found[1] == pytest.approx(values(ck.solve(alone, {"crank": FULL}), "rocker.transmission_angle"), rel=1e-12)


@pytest.mark.parametrize(
    ("mechanism", "name", "told"),
    [
        ("crank-rocker", "crank.transmission_angle", "no force is passed on to it; known: coupler, rocker"),
        ("crank-rocker", "frame.transmission_index", "it stands still"),
        ("crank-rocker", "C.transmission_angle", "'C' has no 'transmission_angle', which only links have"),
        ("crank-rocker", "rocker.transmision_angle", "did you mean 'rocker.transmission_angle'"),
        ("class-iii-six-bar", "plate.transmission_angle", "4 links has no single angle; .*'plate.transmission_index'"),
        ("planetary-train", "planet.transmission_index", "it moves in fixed proportion to what drives it, as gears do"),
        ("crank-rocker", "rocker.transmission_angle.x", "is no vector"),
    ],
)  # fmt: skip
def test_who_has_none_is_told_why(mechanism: str, name: str, told: str) -> None:
    with pytest.raises(ck.errors.UnknownName, match=told):
        ck.quantity(catalog.motion(mechanism), name)


def test_it_is_an_angle_and_no_column_of_whole_tables() -> None:
    motion = catalog.motion("crank-rocker")
    found = ck.quantity(motion, "rocker.transmission_angle")
    assert (found.unit, found.shown.unit, found.dimension, found.order) == ("rad", "deg", "angle", 0)
    assert ck.quantity(motion, "rocker.transmission_index").unit == ""
    assert not [name for name in motion.table().names if "transmission" in name or "advantage" in name]
    assert motion.table("rocker.transmission_angle").names[-2] == "rocker.transmission_angle"
