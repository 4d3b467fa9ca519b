"""A drawing leads where it says: driven slides drawn backward, links of one point, drawings far from the frame."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.kinematics import Motion
from tests.support import REFERENCE, reference

NAMES = ("case_5315", "case_5489", "case_5089", "case_5488", "case_30235")


def case(name: str) -> tuple[ck.Mechanism, dict[str, Any], dict[str, Any]]:
    """A hard case: the mechanism, its drivers' values and what is expected."""
    entry = reference(name, "hard")
    return ck.load(REFERENCE / entry["file"]), entry["drivers"], entry["expected"]


def quietly(mechanism: ck.Mechanism, values: Any = None, **words: Any) -> Motion:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
        return ck.solve(mechanism, values, **words)


def off_the_drawing(motion: Motion, pose: int = 0) -> float:
    """How far the points of a pose are from the drawing at most, as a part of the size."""
    mechanism = motion.structure.mechanism
    off = [abs(motion.points[k].position.flat[pose] - p) for k, p in mechanism.sketch.items()]
    return float(np.max(off)) / mechanism.geometry.size


@pytest.mark.parametrize("name", NAMES)
def test_an_exact_drawing_leads_where_it_says(name: str) -> None:
    """The first pose is the drawing; the last one reached is where an independent continuation leads."""
    mechanism, values, expected = case(name)
    motion = quietly(mechanism, values, order=0)
    last = expected["assembled_at_least_from_the_first_pose_on"] - 1
    assert motion.assembled[: last + 1].all()
    assert off_the_drawing(motion) < 1e-6
    off = [abs(motion.points[k].position[last] - complex(*p)) for k, p in expected["at_last_reached"].items()]
    assert max(off) < 1e-6 * mechanism.geometry.size


def backward(values: Any) -> ck.Mechanism:
    """A piston that is drawn, and driven, behind the origin of its guide."""
    return ck.Mechanism(
        "drawn backward",
        ck.link("frame", O=0, H=-6 + 3j),
        ck.link("piston", "B"),
        ck.link("bar", B=0, C=4),
        ck.link("rocker", H=0, C=3),
        ck.slide("piston", on="frame", through="O"),
        ck.drive("piston", on="frame", values=values),
        ck.drawn(O=0, H=-6 + 3j, B=-8, C=-8.8598 + 3.9065j),
    )


def test_a_driven_slide_drawn_at_a_negative_displacement() -> None:
    """C stays where it is drawn, not at -4.06+0.71j."""
    motion = ck.solve(backward([-8.0, -7.95, -7.9]))
    assert abs(motion.points["C"].position[0] - (-8.8598 + 3.9065j)) < 1e-4
    assert np.max(np.abs(np.diff(motion.points["C"].position))) < 0.02


@pytest.mark.parametrize("sign", [1, -1])
def test_a_length_drawn_by_two_points_takes_the_sign_of_its_values(sign: int) -> None:
    """Barrel and rod of one letter each: their distance is the driver's value but for its sign."""
    joints = {"A": 0j, "D": 3 - 1j, "C": 1.2 + 1.6j}
    length = abs(joints["C"] - joints["D"])
    mechanism = ck.Mechanism(
        "boom",
        ck.link("frame", "A", "D"),
        ck.link("boom", "A", "C"),
        ck.link("barrel", "D"),
        ck.link("rod", "C"),
        ck.slide("rod", on="barrel", at="C", through="D"),
        ck.drive("rod", on="barrel", values=sign * np.linspace(length, length + 0.1, 3)),
        ck.drawn(**joints),
    )
    motion = ck.solve(mechanism)
    assert off_the_drawing(motion) < 1e-12
    assert abs(motion.links["barrel"].angle[0] - np.angle(sign * (joints["C"] - joints["D"]))) < 1e-12


def turned_off(angles: Any, expected: Any) -> Any:
    """How far angles (radians) are from expected ones (degrees), full turns left out."""
    return np.abs(np.angle(np.exp(1j * (np.asarray(angles) - np.deg2rad(expected)))))


def test_a_carrier_gains_no_turn_where_its_motion_has_a_gap() -> None:
    """The carrier L1 of a belt turns steadily, and the wheel L4 stands where an independent continuation has it."""
    mechanism, values, expected = case("case_30235")
    motion = quietly(mechanism, values, order=0)
    for pose, angles in expected["link_angles_deg_by_pose_modulo_360"].items():
        for link, angle in angles.items():
            assert turned_off(motion.links[link].angle[int(pose)], angle) < 1e-9
    assert np.max(np.abs(np.diff(motion.links["L1"].angle[:17]))) < 1.0
    assert abs(np.rad2deg(motion.links["L1"].angle[7]) - 73.0) < 0.1


@pytest.mark.parametrize("between", [2, 3, 7, 40])
def test_turns_do_not_depend_on_the_grid(between: int) -> None:
    """Part of that motion with poses left out, and with many put in between."""
    mechanism, values, _ = case("case_30235")
    whole = quietly(mechanism, {"d0": values["d0"][:17]}, order=0)
    for chosen in (slice(0, 17, between), slice(0, 17, 16)):
        sparse = quietly(mechanism, {"d0": values["d0"][:17][chosen]}, order=0)
        for link in ("L1", "L4"):
            assert np.max(np.abs(sparse.links[link].angle - whole.links[link].angle[chosen])) < 1e-9
    dense = np.interp(np.linspace(0.0, 16.0, 16 * between + 1), np.arange(17), values["d0"][:17])
    motion = quietly(mechanism, {"d0": dense}, order=0)
    for link in ("L1", "L4"):
        assert np.max(np.abs(motion.links[link].angle[::between] - whole.links[link].angle)) < 1e-9


@pytest.mark.parametrize("poses", [2, 5, 73, 1001])
@pytest.mark.parametrize("near", [1e-2, -1e-2, 1e-5, -1e-5])
def test_a_coupler_that_whirls_round_is_counted_at_any_grid(near: float, poses: int) -> None:
    """It turns with the line from B to D: once in a turn of the crank where D lies inside the circle of B, else not."""
    mechanism = ck.Mechanism(
        "whirling",
        ck.link("frame", A=0, D=10),
        ck.link("crank", A=0, B=10 - near),
        ck.link("bar", B=0, C=14, E=2 + 1j),
        ck.link("rocker", D=0, C=14),
        ck.link("wheel", E=0),
        ck.gear("wheel", "crank", carrier="bar", teeth=(20, 30), first_at="E", second_at="B", phase=0.3),
        ck.drive("crank"),
    )
    motion = ck.solve(mechanism, {"crank": np.linspace(np.pi, 3.0 * np.pi, poses)}, order=0)
    rounds = 1.0 if near < 0.0 else 0.0
    turned = {link: (motion.links[link].angle[-1] - motion.links[link].angle[0]) / (2.0 * np.pi) for link in
              ("bar", "wheel")}  # fmt: skip
    assert abs(turned["bar"] - rounds) < 1e-9
    # by Willis's equation: (1 - c) * 30 = -(w - c) * 20 for a turn of the crank
    assert abs(turned["wheel"] - (rounds - 1.5 * (1.0 - rounds))) < 1e-9


@pytest.mark.parametrize("offset", [0.0, 20.0, 25.0, 50.0, 1e3, 1e4])
def test_a_far_origin_costs_nothing(offset: float) -> None:
    """A wheel whose only point is far from its link's origin rolls as it does with the origin there."""
    mechanism = ck.Mechanism(
        "far origin",
        ck.link("frame", A=0),
        ck.link("crank", A=0, B=2),
        ck.link("rod", B=0, M=6),
        ck.link("wheel", M=(0, offset)),
        ck.roll("wheel", on="frame", through="A", at="M", radius=1),
        ck.drive("crank"),
    )
    motion = ck.solve(mechanism, order=0)
    assert motion.assembled.all()
    x, angle = motion.points["M"].position.real, motion.drives["crank"].value
    expected = 2.0 * np.cos(angle) + np.sign(x[0]) * np.sqrt(36.0 - (1.0 - 2.0 * np.sin(angle)) ** 2)
    assert np.max(np.abs(x - expected)) < 1e-9
    assert np.max(np.abs(motion.points["M"].position.imag - 1.0)) < 1e-9
    assert np.max(np.abs(motion.links["wheel"].angle + x)) < 1e-9


@pytest.mark.parametrize("sign", [1, -1])
def test_a_rocker_of_one_point_keeps_the_orientation_that_its_gear_tells(sign: int) -> None:
    """O and B are where they are drawn in both modes; the rocker points from O to B, or away from it."""
    joints = {"O": 0j, "A": 4 + 0j, "B": 4 + 1.5 * np.exp(2j), "W": -2 + 0j, "V": -2 + np.exp(0.7j)}
    angle = float(np.angle(sign * joints["B"]))
    mechanism = ck.Mechanism(
        "geared rocker",
        ck.link("frame", O=0, A=4, W=-2),
        ck.link("crank", A=0, B=1.5),
        ck.link("block", B=0),
        ck.link("rocker", O=0),
        ck.slide("block", on="rocker", at="B", through="O"),
        ck.link("pinion", W=0, V=1),
        ck.gear("pinion", "rocker", carrier="frame", teeth=(20, 30), phase=angle + 20 / 30 * 0.7),
        ck.drive("crank", values=[2.0, 2.01]),
        ck.drawn(**joints),
    )
    motion = ck.solve(mechanism)
    assert off_the_drawing(motion) < 1e-12
    assert abs(motion.links["rocker"].angle[0] - angle) < 1e-12
    assert abs(motion.links["pinion"].angle[0] - 0.7) < 1e-12


def test_where_a_drawing_shows_both_modes_alike_the_mode_is_that_by_default() -> None:
    """Not one by rounding: a rocker of one point whose orientation nothing tells."""
    for turn in np.linspace(0.1, 6.2, 12):
        mechanism = ck.Mechanism(
            "rocker",
            ck.link("frame", O=0, A=4),
            ck.link("crank", A=0, B=1.5),
            ck.link("block", B=0),
            ck.link("rocker", O=0),
            ck.slide("block", on="rocker", at="B", through="O"),
            ck.drive("crank", values=[turn]),
            ck.drawn(O=0, A=4, B=4 + 1.5 * np.exp(1j * turn)),
        )
        motion = ck.solve(mechanism)
        assert motion.followed.curve.chosen_by == {0: "default"}
        assert float(motion.followed.curve.signs[0]) == 1.0


@pytest.mark.parametrize("turns", [0, 1, -2])
@pytest.mark.parametrize("phase", [None, 4 * np.cos(ck.deg(120)) - ck.deg(120)])
def test_a_pinion_on_a_slide_keeps_the_turn_in_which_it_is_drawn(turns: int, phase: float | None) -> None:
    # the block is drawn at 240 degrees, which a drawing shows as -120: the slide's own angles add up to the former
    drawn = {k: ck.polar(r, ck.deg(120)) for k, r in (("A", 3), ("B", 4))}
    mechanism = ck.Mechanism(
        "pinion on a slide",
        ck.link("frame", O=(0, 0), Q=(0, -1)),
        ck.link("crank", O=(0, 0), A=(3, 0)),
        ck.link("block", B=(0, 0), C=(1, 0)),
        ck.slide("block", on="crank", through="A", at="B", turn=ck.deg(120)),
        ck.rack("frame", "block", through="Q", at="B", radius=1, phase=phase),
        ck.drive("crank"),
        ck.drawn(O=0, Q=-1j, C=drawn["B"] + ck.polar(1, ck.deg(-120)), **drawn),
    )
    motion = ck.solve(mechanism, ck.deg([120 + 360 * turns, 121 + 360 * turns]))
    for name, place in drawn.items():
        assert complex(motion.points[name].position[0]) == pytest.approx(place, abs=1e-12)


# A four-bar linkage whose coupler turns on what is driven on it; no angle of a dyad's links counts by itself.
COUPLED = {"A": 0j, "B": 1 + 1j, "C": 4 + 2j, "D": 5 + 0j, "E": 1.5 + 2j, "F": 2.7 + 2.3j}


@pytest.mark.parametrize("turns", [-2, -1, 0, 1])
def test_a_wheel_is_as_drawn_in_whichever_turn_the_arm_on_a_coupler_is_driven(turns: int) -> None:
    """The arm is some turns ahead of its drawing, and so is the phase that this shows: the wheel goes on by Willis."""
    drawn = {**COUPLED, "G": 2.2 + 4.2j, "H": 3 + 3.1j}
    mechanism = ck.Mechanism(
        "geared arm",
        *(ck.link(n, *k) for n, k in (("frame", "AD"), ("crank", "AB"), ("coupler", "BCEF"), ("rocker", "DC"))),
        *(ck.link(n, *k) for n, k in (("arm", "EG"), ("wheel", "FH"))),
        ck.gear("arm", "wheel", carrier="coupler", first_at="E", second_at="F", teeth=(20, 41)),
        ck.drive("crank"),
        ck.drive("arm", on="coupler"),
        ck.drawn(**drawn),
    )
    angles = {n: np.angle(drawn[k[1]] - drawn[k[0]]) for n, k in (("coupler", "BC"), ("arm", "EG"), ("wheel", "FH"))}
    begin = angles["arm"] - angles["coupler"] + 2 * np.pi * turns
    motion = ck.solve(mechanism, {"crank": np.pi / 4, "arm": begin + np.linspace(0.0, 6.0, 7)})
    assert np.allclose(motion.links["wheel"].angle, angles["wheel"] - 20 / 41 * np.linspace(0.0, 6.0, 7), atol=1e-12)
    assert np.allclose(motion.links["arm"].angle, angles["coupler"] + motion.drives["arm"].value, atol=1e-12)


def test_a_pinion_is_as_drawn_beyond_half_a_turn_of_the_rack_that_slides_on_a_coupler() -> None:
    """The coupler is drawn at 154 degrees, the rack on it at -154: the slide's own angles leave that turn out."""
    drawn = {name: -place.conjugate() for name, place in COUPLED.items()}
    axis = -4 + 4j + (0.5 + 2j) * np.exp(1j * np.angle(-2.5 - 1.2j))
    drawn |= {"G": -4 + 4j, "H": -6.5 + 2.8j, "O": axis, "P": axis - 1 + 0.5j}
    mechanism = ck.Mechanism(
        "rack on a coupler",
        *(ck.link(n, *k) for n, k in (("frame", "ADO"), ("crank", "AB"), ("coupler", "BCEF"), ("rocker", "DC"))),
        *(ck.link(n, *k) for n, k in (("rack", "GH"), ("pinion", "OP"))),
        ck.slide("rack", on="coupler", at="G", through="E", toward="F"),
        ck.rack("rack", "pinion", through="G", toward="H", at="O", radius=2.0),
        ck.drive("crank"),
        ck.drive("rack", on="coupler"),
        ck.drawn(**drawn),
    )
    guide, line = (np.exp(1j * np.angle(drawn[b] - drawn[a])) for a, b in ("EF", "GH"))
    displacement = ((drawn["G"] - drawn["E"]) * np.conj(guide)).real
    ahead = np.array([0.0, 0.5])
    motion = ck.solve(mechanism, {"crank": 3 * np.pi / 4, "rack": displacement + ahead})
    assert np.max(np.abs(motion.points["G"].position - drawn["G"] - ahead * guide)) < 1e-12
    # the rack rolls off by as much of its way as is along its line
    turned = np.angle(drawn["P"] - drawn["O"]) + ahead * (guide * np.conj(line)).real / 2.0
    assert np.allclose(motion.links["pinion"].angle, turned, atol=1e-12)


@pytest.mark.parametrize("turns", [-1, 0, 1])
def test_a_rack_is_as_drawn_whichever_turn_of_its_wheel_a_stated_phase_of_a_gear_means(turns: int) -> None:
    """The rack's own phase is known within a turn of the wheel only; the gear's puts the wheel turns ahead of it."""
    drawn = {"A": 0j, "B": 2 + 1j, "C": 3 + 3j, "G": -1 - 2j, "H": 1 - 1j}
    wheel, crank, line = (np.angle(drawn[b] - drawn[a]) for a, b in ("BC", "AB", "GH"))
    ahead = wheel + 2 * np.pi * turns
    place = (drawn["B"] - drawn["G"]) * np.exp(-1j * line)
    radius, phase = float(place.imag), float(place.real + place.imag * (wheel - line))
    mechanism = ck.Mechanism(
        "rack on a planet",
        *(ck.link(n, *k) for n, k in (("frame", "A"), ("crank", "AB"), ("planet", "BC"), ("rack", "GH"))),
        ck.gear("frame", "planet", carrier="crank", first_at="A", teeth=(40, 20), phase=ahead - crank - 2.0 * crank),
        ck.slide("rack", on="frame", at="G", through="A", angle=line),
        ck.rack("rack", "planet", through="G", toward="H", at="B", radius=radius, phase=phase),
        ck.drive("crank"),
        ck.drawn(**drawn),
    )
    values = crank + np.linspace(0.0, 1.0, 5)
    motion = ck.solve(mechanism, values)
    # the planet turns three times as fast as the crank, and the rack goes with its axis and by what it rolls off
    assert np.allclose(motion.links["planet"].angle, ahead + 3.0 * (values - crank), atol=1e-12)
    along = ((motion.points["B"].position - drawn["B"]) * np.exp(-1j * line)).real + 3.0 * radius * (values - crank)
    assert np.abs(motion.points["G"].position - drawn["G"] - along * np.exp(1j * line)).max() < 1e-12


def test_a_wheel_whose_phase_is_stated_is_as_drawn_on_an_arm_that_slides_on_a_crank() -> None:
    """The arm is drawn at 69 degrees on a crank at -158: the slide's own angles would put it a turn behind."""
    crank, arm = -2.75, 1.2
    drawn = {"A": 0j, "B": 3 * np.exp(1j * crank), "C": -1 + 1j, "E": 2 + 3j, "D": 4 + 0j, "F": 0.5 + 3j, "H": 1 + 4j}
    drawn["G"] = drawn["C"] + 2 * np.exp(1j * arm)
    bar, wheel = (np.angle(drawn[b] - drawn[a]) for a, b in ("CE", "FH"))
    mechanism = ck.Mechanism(
        "wheel on an arm",
        *(ck.link(n, *k) for n, k in (("frame", "AD"), ("crank", "AB"), ("arm", "CG"), ("bar", "CEF"))),
        *(ck.link(n, *k) for n, k in (("rocker", "ED"), ("wheel", "FH"))),
        ck.slide("arm", on="crank", at="C", through="A", toward="B"),
        ck.gear("arm", "wheel", carrier="bar", teeth=(30, 40), phase=(wheel - bar) + 0.75 * (arm - bar)),
        ck.drive("crank"),
        ck.drive("arm", on="crank"),
        ck.drawn(**drawn),
    )
    place = (drawn["C"] * np.exp(-1j * crank)).real
    motion = ck.solve(mechanism, {"crank": crank + np.linspace(0.0, 0.3, 4), "arm": place + np.linspace(0.0, 0.5, 4)})
    turned = {name: motion.links[name].angle - angle for name, angle in (("arm", arm), ("bar", bar), ("wheel", wheel))}
    assert np.allclose(turned["arm"], np.linspace(0.0, 0.3, 4), atol=1e-12)
    assert abs(np.exp(1j * turned["bar"][0]) - 1.0) < 1e-12
    assert np.allclose(turned["wheel"], 1.75 * turned["bar"] - 0.75 * turned["arm"], atol=1e-12)
