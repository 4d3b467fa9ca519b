"""Published and independently computed numbers, mechanism by mechanism: `tests/reference/kinematics.json`."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.kinematics import Motion
from tests.support import REFERENCE, reference


def to_printed(value: Any, printed: float, slack: float = 1.0) -> None:
    """Whether a value is what was printed, to half a unit of its last digit."""
    digits = re.sub(r"e.*", "", repr(printed))
    decimals = len(digits.split(".")[1]) if "." in digits else 0
    half = 0.5 * 10.0**-decimals
    assert abs(float(value) - printed) <= half * slack, f"{float(value)} is not {printed}"


def at(motion: Motion, point: str, what: str = "position") -> complex:
    return complex(getattr(motion.points[point], what))


def test_every_entry_is_tested_here() -> None:
    """An entry that comes in has a test that reads it."""
    entries = [e["id"] for e in json.loads((REFERENCE / "kinematics.json").read_text())]
    source = Path(__file__).read_text(encoding="utf-8")
    assert all(f'reference("{name}")' in source for name in entries)


def six_bar() -> ck.Mechanism:
    return ck.Mechanism(
        "Six-bar of Example 3-4",
        ck.link("frame", E=(0, 0), B=(41, 0), F=(0, -34)),
        ck.link("crank", E=(0, 0), D=(14, 0)),
        ck.link("plate", D=(0, 0), A=(39, 0), C=ck.polar(15, ck.deg(35))),
        ck.link("rocker", B=(0, 0), A=(28, 0)),
        ck.link("bar", F=(0, 0), G=(55, 0)),
        ck.link("block", C=(0, 0)),
        ck.slide("block", on="bar", at="C", through="F", angle=0),
        ck.mode(1, "rocker"),
        ck.mode(1, "bar"),
        ck.drive("crank"),
    )


def test_sixbar_example_3_4() -> None:
    """Every number to 1e-9 relative, jerk included; velocities relative to the fastest of their kind."""
    entry = reference("sixbar_example_3_4")
    rows = entry["expected"]["rows"]
    motion = ck.solve(six_bar(), {"crank": ck.deg([row["crank_deg"] for row in rows])}, speed=10, order=3)
    for k, row in enumerate(rows):
        for point in "ACG":
            for name in ("position", "velocity", "acceleration", "jerk"):
                expected = complex(*row[point][name])
                assert abs(getattr(motion.points[point], name)[k] - expected) < 1e-9 * abs(expected)
        for key, link in (("theta3", "plate"), ("theta2", "rocker"), ("theta4", "bar")):
            found = motion.links[link]
            rates = (found.angular_velocity, found.angular_acceleration, found.angular_jerk)
            assert abs(np.angle(np.exp(1j * (found.angle[k] - row[key]["value"])))) < 1e-9
            for value, name in zip(rates, ("rate", "second", "third"), strict=True):
                assert abs(value[k] - row[key][name]) < 1e-9 * abs(row[key][name])
        slide = motion.pairs["block/bar"]
        for name in ("value", "rate", "second", "third"):
            assert abs(getattr(slide, name)[k] - row["slide"][name]) < 1e-9 * abs(row["slide"][name])


def slider_crank(crank: float, rod: float) -> ck.Mechanism:
    return ck.Mechanism(
        "Slider-crank",
        ck.link("frame", O=(0, 0)),
        ck.link("crank", O=(0, 0), A=(crank, 0)),
        ck.link("rod", A=(0, 0), B=(rod, 0)),
        ck.link("piston", B=(0, 0)),
        ck.slide("piston", on="frame", through="O"),
        ck.drive("crank"),
    )


def test_nikravesh_slider_crank() -> None:
    entry = reference("nikravesh_slider_crank")
    d, expected = entry["dimensions"], entry["expected"]
    mechanism = slider_crank(d["L2"], d["L3"])
    one = ck.solve(mechanism, {"crank": ck.deg(d["theta2_deg"])}, speed=d["omega2"])
    first = expected["mode_1"]
    to_printed(np.rad2deg(one.links["rod"].angle) % 360, first["theta3_deg"])
    to_printed(at(one, "B").real, first["slider"])
    to_printed(one.links["rod"].angular_velocity, first["omega3"])
    to_printed(at(one, "B", "velocity").real, first["slider_velocity"])
    to_printed(one.links["rod"].angular_acceleration, first["alpha3"])
    to_printed(at(one, "B", "acceleration").real, first["slider_acceleration"])
    two = ck.solve(mechanism, {"crank": ck.deg(d["theta2_deg"])}, modes={"rod": -1})
    to_printed(np.rad2deg(two.links["rod"].angle) % 360, expected["mode_2"]["theta3_deg"])
    to_printed(at(two, "B").real, expected["mode_2"]["slider"])


def four_bar(ground: float, crank: float, coupler: float, rocker: float, point: complex = 0j) -> ck.Mechanism:
    return ck.Mechanism(
        "Four-bar",
        ck.link("frame", O=(0, 0), C=(ground, 0)),
        ck.link("crank", O=(0, 0), A=(crank, 0)),
        ck.link("coupler", A=(0, 0), B=(coupler, 0), P=point),
        ck.link("rocker", C=(0, 0), B=(rocker, 0)),
        ck.drive("crank"),
    )


def test_nikravesh_four_bar() -> None:
    entry = reference("nikravesh_four_bar")
    d, expected = entry["dimensions"], entry["expected"]
    mechanism = four_bar(d["L1"], d["L2"], d["L3"], d["L4"], ck.polar(d["LPA"], ck.deg(d["beta3_deg"])))
    motion = ck.solve(
        mechanism,
        {"crank": ck.deg(d["theta2_deg"])},
        speed=d["omega2"],
        acceleration=d["alpha2"],
        hint={"B": (5, 4)},
    )
    for key, link in (("3", "coupler"), ("4", "rocker")):
        # the notes stop Newton early: their angles are some hundredths of a degree off
        assert abs(np.rad2deg(motion.links[link].angle) - expected[f"theta{key}_deg"]) < 0.02
        to_printed(motion.links[link].angular_velocity, expected[f"omega{key}"])
    for key, what in (("P", "position"), ("VP", "velocity")):
        found = at(motion, "P", what)
        to_printed(found.real, expected[key][0])
        to_printed(found.imag, expected[key][1])

    # The printed accelerations do not satisfy the notes' own loop equation; the solved ones do.
    def loop(alpha3: float, alpha4: float) -> float:
        w = (d["omega2"], expected["omega3"], expected["omega4"])
        alpha = (d["alpha2"], alpha3, alpha4)
        angles = (ck.deg(120), motion.links["coupler"].angle, motion.links["rocker"].angle)
        arms = [ck.polar(d[k], angle) for k, angle in zip(("L2", "L3", "L4"), angles, strict=True)]
        total = [complex((1j * a - v**2) * r) for a, v, r in zip(alpha, w, arms, strict=True)]
        return abs(total[0] + total[1] - total[2])

    links = (motion.links["coupler"], motion.links["rocker"])
    assert loop(*[float(link.angular_acceleration) for link in links]) < 1e-3
    assert loop(expected["alpha3"], expected["alpha4"]) > 0.1


def test_norton_fourbar_in_both_modes() -> None:
    entry = reference("norton_fourbar_4_1_6_7_7_1")
    d, expected = entry["dimensions"], entry["expected"]
    mechanism = four_bar(d["d"], d["a"], d["b"], d["c"])
    given = {"speed": d["omega2"], "acceleration": d["alpha2"]}
    for name, hint in (("open", {"B": (143, 67)}), ("crossed", {"B": (89, -79)})):
        motion = ck.solve(mechanism, {"crank": ck.deg(d["theta2_deg"])}, hint=hint, **given)
        coupler, rocker = motion.links["coupler"], motion.links["rocker"]
        found = [
            np.rad2deg(coupler.angle),
            np.rad2deg(rocker.angle),
            coupler.angular_velocity,
            rocker.angular_velocity,
            coupler.angular_acceleration,
            rocker.angular_acceleration,
        ]
        assert np.allclose(found, expected["full_precision"][name], rtol=1e-10, atol=0)
        to_printed(found[0], expected[f"theta3_{name}_deg"])
        to_printed(found[1], expected[f"theta4_{name}_deg"])
        if name == "open":
            for value, key in zip(found[2:], ("omega3_open", "omega4_open", "alpha3_open", "alpha4_open"), strict=True):
                to_printed(value, expected[key])


def test_norton_five_bar_with_both_cranks_driven() -> None:
    """The geared five-bar, its gear written as a second driver of twice the angle."""
    entry = reference("norton_geared_fivebar_4_4")
    d, expected = entry["dimensions"], entry["expected"]
    mechanism = ck.Mechanism(
        "Five-bar",
        ck.link("frame", O=(0, 0), C=(d["ground_f"], 0)),
        ck.link("crank", O=(0, 0), A=(d["a"], 0)),
        ck.link("left", A=(0, 0), B=(d["b"], 0)),
        ck.link("right", D=(0, 0), B=(d["c"], 0)),
        ck.link("geared", C=(0, 0), D=(d["d"], 0)),
        ck.drive("crank"),
        ck.drive("geared"),
    )
    theta, ratio = d["theta2_deg"], d["gear_ratio"]
    values = {"crank": ck.deg(theta), "geared": ck.deg(ratio * theta + d["phase_deg"])}
    speeds = {"crank": d["omega2"], "geared": ratio * d["omega2"]}
    for index, (name, sign) in enumerate((("open", 1), ("crossed", -1))):
        motions = [ck.solve(mechanism, values, speed=speeds, modes={"left": s}) for s in (sign, -sign)]
        full = expected["full"][name]
        near = [abs(np.rad2deg(m.links["left"].angle) - full["theta3_deg"]) < 1e-6 for m in motions]
        assert sum(near) == 1
        left, right = (motions[near.index(True)].links[k] for k in ("left", "right"))
        assert np.allclose([left.angular_velocity, right.angular_velocity], [full["omega3"], full["omega4"]], rtol=1e-9)
        rates = [left.angular_acceleration, right.angular_acceleration]
        assert np.allclose(rates, [full["alpha3"], full["alpha4"]], rtol=1e-9)
        to_printed(np.rad2deg(left.angle), expected["printed"]["theta3"][index])
        to_printed(np.rad2deg(right.angle), expected["printed"]["theta4"][index])


def test_meriam_and_kraige() -> None:
    """As drawn at the instant, driven at CB."""
    entry = reference("meriam_sp5_8_5_14")
    d, expected = entry["dimensions"], entry["expected"]
    mechanism = ck.Mechanism(
        "Sample problem 5/8",
        ck.link("frame", "O", "C"),
        ck.link("OA", "O", "A"),
        ck.link("AB", "A", "B"),
        ck.link("CB", "C", "B"),
        ck.drive("CB"),
        ck.drawn(**{k: d[k] for k in "OABC"}),
    )
    motion = ck.solve(mechanism, {"CB": np.pi}, speed=d["omega_CB"], acceleration=d["alpha_CB"])
    rates = [
        motion.links["AB"].angular_velocity,
        motion.links["OA"].angular_velocity,
        motion.links["AB"].angular_acceleration,
        motion.links["OA"].angular_acceleration,
    ]
    assert abs(at(motion, "A") - 0.1j) < 1e-15
    assert np.allclose(rates[:2], [expected["omega_AB"], expected["omega_OA"]], rtol=1e-12)
    to_printed(rates[2], expected["alpha_AB"])
    to_printed(rates[3], expected["alpha_OA"])
    # the reference's own solver has eleven digits
    assert np.allclose(rates, expected["full"], rtol=1e-10)


def test_beer_and_johnston() -> None:
    entry = reference("beer_johnston_sp15_3_15_7")
    d, expected = entry["dimensions"], entry["expected"]
    speed = d["n_rpm"] * 2 * np.pi / 60
    motion = ck.solve(slider_crank(d["r"], d["l"]), {"crank": ck.deg(d["theta_deg"])}, speed=speed)
    rod, piston = motion.links["rod"], motion.points["B"]
    found = [complex(piston.velocity).real / 12, rod.angular_velocity, rod.angular_acceleration]
    found.append(complex(piston.acceleration).real / 12)
    full = expected["full"]
    assert np.allclose(found, [full["v"], full["omega"], full["alpha"], full["a"]], rtol=1e-10)
    to_printed(found[0], expected["v_P_ft_s"])
    to_printed(found[1], expected["omega_BD"])
    assert abs(found[2] - expected["alpha_BD"]) < 5  # three digits are printed
    assert abs(-found[3] - expected["a_P_ft_s2"]) < 5


def test_hibbeler_quick_return() -> None:
    entry = reference("hibbeler_quick_return_16_148")
    d, expected = entry["dimensions"], entry["expected"]
    for degrees, (omega, alpha) in expected["tested"].items():
        arm = ck.polar(d["AB"], ck.deg(float(degrees)))
        mechanism = ck.Mechanism(
            "Quick return",
            ck.link("frame", C=(0, 0), A=1j * d["CB"] - arm),
            ck.link("crank", A=(0, 0), B=(d["AB"], 0)),
            ck.link("block", B=(0, 0)),
            ck.link("slotted", C=(0, 0), D=(1, 0)),
            ck.slide("block", on="slotted", through="C"),
            ck.drive("crank"),
        )
        motion = ck.solve(mechanism, {"crank": ck.deg(float(degrees))}, speed=d["omega_AB"], acceleration=d["alpha_AB"])
        slotted = motion.links["slotted"]
        assert abs(float(slotted.angle) - np.pi / 2) < 1e-12
        assert abs(abs(slotted.angular_velocity) - omega) < 1e-12
        assert abs(abs(slotted.angular_acceleration) - alpha) < 1e-9
        if degrees == "60":
            to_printed(abs(slotted.angular_velocity), expected["omega_CD_abs"])
            to_printed(abs(slotted.angular_acceleration), expected["alpha_CD_abs"])


def test_marghitu_and_dupac() -> None:
    entry = reference("marghitu_dupac_R_RTR_RRT_200deg")
    d, expected = entry["dimensions"], entry["expected"]
    mechanism = ck.Mechanism(
        "R-RTR-RRT",
        ck.link("frame", A=(0, 0), C=d["C"], G=(d["guide_x"], 0)),
        ck.link("crank", A=(0, 0), B=(d["AB"], 0)),
        ck.link("block", B=(0, 0)),
        ck.link("rocker", C=(0, 0), D=(-d["CD"], 0), F=(d["CF"], 0)),
        ck.link("rod", D=(0, 0), E=(d["DE"], 0)),
        ck.link("slider", E=(0, 0)),
        ck.slide("block", on="rocker", through="C"),
        ck.slide("slider", on="frame", through="G", angle=ck.deg(90)),
        ck.drive("crank"),
    )
    motion = ck.solve(mechanism, {"crank": ck.deg(d["phi_deg"])}, speed=d["n_rpm"] * np.pi / 30)
    for key, value in expected.items():
        if re.fullmatch(r"[rva][DEF]", key):
            what = {"r": "position", "v": "velocity", "a": "acceleration"}[key[0]]
            found = at(motion, key[1], what)
            to_printed(found.real, float(value[0]))
            to_printed(found.imag, float(value[1]))
    rocker, rod, crank = (motion.links[k] for k in ("rocker", "rod", "crank"))
    to_printed(rocker.angular_velocity, expected["omega3"])
    to_printed(rocker.angular_acceleration, expected["alpha3"])
    to_printed(rod.angular_velocity, expected["omega4"])
    to_printed(rod.angular_acceleration, expected["alpha4"])
    to_printed(np.rad2deg(rocker.angle), expected["phi3_deg"])
    to_printed(np.rad2deg(rod.angle) - 180, expected["phi4_deg_mod180"])
    # printed is the velocity of the rocker's point against the block: the block's against the rocker, reversed
    to_printed(-motion.pairs["block/rocker"].rate, expected["vB32"])
    to_printed(-motion.pairs["block/rocker"].second, expected["aB32"])
    relative = expected["omega_rel"]
    to_printed(motion.links["block"].angular_velocity - crank.angular_velocity, relative["omega21"])
    to_printed(rod.angular_velocity - rocker.angular_velocity, relative["omega43"])
    to_printed(motion.links["slider"].angular_velocity - rod.angular_velocity, relative["omega54"])
    # Coriolis: twice the rocker's angular velocity, across the relative velocity
    slip = motion.pairs["block/rocker"].rate * np.exp(1j * rocker.angle)
    coriolis = 2j * rocker.angular_velocity * -slip
    to_printed(coriolis.real, expected["aB3B2cor"][0])
    to_printed(coriolis.imag, expected["aB3B2cor"][1])


def test_scotch_yoke() -> None:
    entry = reference("scotch_yoke")
    d = entry["dimensions"]
    mechanism = ck.Mechanism(
        "Scotch yoke",
        ck.link("frame", O=(0, 0)),
        ck.link("crank", O=(0, 0), A=(d["r"], 0)),
        ck.link("pin block", A=(0, 0)),
        ck.link("yoke", Y=(0, 0)),
        ck.slide("pin block", on="yoke", through="Y", angle=ck.deg(90)),
        ck.slide("yoke", on="frame", through="O"),
        ck.drive("crank"),
    )
    motion = ck.solve(mechanism, {"crank": ck.deg(d["theta_deg"])}, speed=d["omega"], acceleration=d["alpha"])
    found = [at(motion, "Y", what) for what in ("position", "velocity", "acceleration")]
    assert np.allclose(found, entry["expected"]["x_xdot_xddot"], rtol=1e-12)


def test_elliptic_trammel() -> None:
    """Driven at the pin between rod and block, neither of them the frame."""
    entry = reference("elliptic_trammel")
    d, expected = entry["dimensions"], entry["expected"]
    # the body frame has its origin in A and its x axis toward B: the rod lies at 180 deg minus th
    mechanism = ck.Mechanism(
        "Trammel",
        ck.link("frame", O=(0, 0)),
        ck.link("rod", A=(0, 0), B=(d["l"], 0), P=d["body_point"]),
        ck.link("first", A=(0, 0)),
        ck.link("second", B=(0, 0)),
        ck.slide("first", on="frame", through="O"),
        ck.slide("second", on="frame", through="O", angle=ck.deg(90)),
        ck.drive("rod", on="first"),
    )
    motion = ck.solve(
        mechanism,
        {"rod": np.pi - ck.deg(d["theta_deg"])},
        speed=-d["theta_dot"],
        acceleration=-d["theta_ddot"],
    )
    whats = ("position", "velocity", "acceleration")
    found = [at(motion, "A", w).real for w in whats] + [at(motion, "B", w).imag for w in whats]
    assert np.allclose(found, expected["xA_v_a_yB_v_a"], rtol=1e-12)
    for what, key in zip(whats, ("point", "point_vel", "point_acc"), strict=True):
        assert abs(at(motion, "P", what) - complex(*expected[key])) < 1e-12
    centre = ck.solve(mechanism, {"rod": np.pi - ck.deg(d["theta_deg"])}, speed=1.0)
    back = centre.links["rod"]
    about = (complex(*expected["IC"]) - at(centre, "A")) * np.exp(-1j * float(back.angle))
    assert abs(complex(back.at(about).velocity)) < 1e-12


def test_oldham() -> None:
    entry = reference("oldham")
    d, expected = entry["dimensions"], entry["expected"]
    mechanism = ck.Mechanism(
        "Oldham coupling",
        ck.link("frame", O=(0, 0), Q=(d["d"], 0)),
        ck.link("one", O=(0, 0)),
        ck.link("two", Q=(0, 0)),
        ck.link("block", M=(0, 0)),
        ck.slide("block", on="one", through="O"),
        ck.slide("block", on="two", through="Q", angle=ck.deg(90), turn=ck.deg(-90)),
        ck.drive("one"),
    )
    motion = ck.solve(mechanism, {"one": ck.deg(d["theta_deg"])}, speed=d["omega"], acceleration=d["alpha"])
    for what, key in (("position", "block_centre"), ("velocity", "block_vel"), ("acceleration", "block_acc")):
        assert abs(at(motion, "M", what) - complex(*expected[key])) < 1e-12
    two = motion.links["two"]
    assert abs(float(two.angle) - ck.deg(d["theta_deg"])) < 1e-14
    assert abs(two.angular_velocity - expected["omega2"]) < 1e-12
    assert abs(motion.links["block"].angular_velocity - expected["omega3"]) < 1e-12
    assert abs(two.angular_acceleration - expected["alpha2"]) < 1e-12


def test_rapson_slide() -> None:
    entry = reference("rapson_slide")
    d, expected = entry["dimensions"], entry["expected"]
    mechanism = ck.Mechanism(
        "Rapson slide",
        ck.link("frame", O=(0, 0), H=(0, d["h"])),
        ck.link("crosshead", X=(0, 0)),
        ck.link("block", X=(0, 0)),
        ck.link("tiller", O=(0, 0)),
        ck.slide("crosshead", on="frame", through="H"),
        ck.slide("block", on="tiller", through="O"),
        ck.drive("crosshead", values=d["x"], speed=d["xd"], acceleration=d["xdd"]),
    )
    tiller = ck.solve(mechanism).links["tiller"]
    found = [tiller.angle, tiller.angular_velocity, tiller.angular_acceleration]
    assert np.allclose(found, [expected["theta"], expected["omega"], expected["alpha"]], rtol=1e-12)


def test_peaucellier() -> None:
    """Multiple pins at O, B, C, D and P."""
    entry = reference("peaucellier")
    d, expected = entry["dimensions"], entry["expected"]
    long, short = d["L"], d["l"]
    mechanism = ck.Mechanism(
        "Peaucellier",
        ck.link("frame", A=(d["OA"], 0), O=(0, 0)),
        ck.link("crank", A=(0, 0), C=(d["AC"], 0)),
        *[ck.link(f"O{k}", **{"O": (0, 0), k: (long, 0)}) for k in "BD"],
        *[ck.link(f"{j}{k}", **{j: (0, 0), k: (short, 0)}) for j in "BD" for k in "CP"],
        ck.drive("crank"),
    )
    rows = expected["rows_thetadeg_Cx_Cy_Px_Py"]
    # near the flat pose at 0 the inversor is as drawn: B above, D below, C left of P
    motion = ck.solve(
        mechanism,
        {"crank": ck.deg([row[0] for row in rows])},
        hint={"B": (1.7, 1.8), "D": (2.2, -1.2), "C": (1.6, -0.8), "P": (2.4, -1.1)},
    )
    # the crank angle of the table is that of OA's end; C turns about A
    assert np.all(motion.assembled)
    for k, (theta, cx, cy, px, py) in enumerate(rows):
        assert abs(motion.points["C"].position[k] - complex(cx, cy)) < 1e-12, theta
        assert abs(motion.points["P"].position[k] - complex(px, py)) < 1e-12
    assert np.allclose(motion.points["P"].x, expected["P_x"], rtol=1e-14)
    assert np.max(np.abs(motion.points["P"].velocity.real)) < 1e-12
    assert np.max(np.abs(motion.points["P"].acceleration.real)) < 1e-12


def test_jansen_leg() -> None:
    entry = reference("jansen_leg")
    d, expected = entry["dimensions"], entry["expected"]

    def third(base: float, near: float, far: float, side: int) -> complex:
        """The third corner of a triangle on a base along x, `near` and `far` from its ends."""
        x = (base**2 + near**2 - far**2) / (2 * base)
        return complex(x, side * np.sqrt(near**2 - x**2))

    rows = expected["rows"]
    first = {k: complex(*v) for k, v in rows[0].items() if k != "theta_deg"}
    # handedness of the two plates as in the first row of the table
    ground = complex(-d["a"], -d["l"])

    def side(origin: complex, along: complex, corner: complex) -> int:
        return int(np.sign((np.conj(along - origin) * (corner - origin)).imag))

    upper = side(ground, first["J2"], first["J3"])
    mechanism = ck.Mechanism(
        "Jansen leg",
        ck.link("frame", O=(0, 0), G=ground),
        ck.link("crank", O=(0, 0), J1=(d["m"], 0)),
        ck.link("j", J1=(0, 0), J2=(d["j"], 0)),
        ck.link("bde", G=(0, 0), J2=(d["b"], 0), J3=third(d["b"], d["d"], d["e"], upper)),
        ck.link("k", J1=(0, 0), J4=(d["k"], 0)),
        ck.link("c", G=(0, 0), J4=(d["c"], 0)),
        ck.link("f", J3=(0, 0), J5=(d["f"], 0)),
        ck.link(
            "ghi",
            J4=(0, 0),
            J5=(d["g"], 0),
            foot=third(d["g"], d["i"], d["h"], side(first["J4"], first["J5"], first["foot"])),
        ),
        ck.drive("crank"),
        ck.drawn(**first),
    )  # fmt: skip
    motion = ck.solve(mechanism, {"crank": ck.deg([row["theta_deg"] for row in rows])})
    for k, row in enumerate(rows):
        for name in first:
            assert abs(motion.points[name].position[k] - complex(*row[name])) < 1e-9
    full = ck.solve(mechanism, {"crank": ck.deg(np.linspace(0, 360, 36001))}, order=0)
    foot = full.points["foot"]
    assert np.all(full.assembled)
    assert np.allclose([foot.x.min(), foot.x.max()], expected["foot_x_range"], atol=1e-4)
    assert np.allclose([foot.y.min(), foot.y.max()], expected["foot_y_range"], atol=1e-4)


def test_andrews_squeezer() -> None:
    """Seven bodies, one pin common to four of them; the initial position of the IVP test set."""
    entry = reference("andrews_squeezer_initial")
    d = entry["dimensions"]
    beta, theta, gamma, phi, delta, omega, epsilon = next(iter(entry["expected"].values()))
    mechanism = ck.Mechanism(
        "Squeezer",
        ck.link("frame", O=(0, 0), A=(d["xa"], d["ya"]), B=(d["xb"], d["yb"])),
        ck.link("K1", O=(0, 0), E=(d["rr"], 0)),
        ck.link("K2", E=(0, 0), P=(-d["d"], 0)),
        ck.link("K3", B=(0, 0), P=(0, -d["ss"])),
        ck.link("K4", F=(0, 0), P=(0, -d["e"])),
        ck.link("K5", A=(0, 0), F=(d["zt"], 0)),
        ck.link("K6", G=(0, 0), P=(d["zf"], 0)),
        ck.link("K7", A=(0, 0), G=(0, -d["u"])),
        ck.drive("K1"),
    )
    drawing = {"P": (-0.021, 0.0), "F": (-0.034, 0.0165), "G": (-0.0316, -0.0156)}
    motion = ck.solve(mechanism, {"K1": beta}, hint=drawing)
    found = {name: float(link.angle) for name, link in motion.links.items()}
    expected = {
        "K2": beta + theta,
        "K3": gamma,
        "K4": phi + delta,
        "K5": delta,
        "K6": omega + epsilon,
        "K7": epsilon,
    }
    for name, angle in expected.items():
        assert abs(np.angle(np.exp(1j * (found[name] - angle)))) < 1e-12, name


@pytest.mark.parametrize("degrees", [0, 35, 60, 120, 270, 315])
def test_six_bar_plain_numbers_give_what_arrays_give(degrees: float) -> None:
    alone = ck.solve(six_bar(), {"crank": ck.deg(degrees)}, speed=10, order=3)
    among = ck.solve(six_bar(), {"crank": ck.deg([degrees, 1.0])}, speed=10, order=3)
    for name in "ACG":
        for k in range(4):
            one, other = complex(alone.points[name].derivative(k)), among.points[name].derivative(k)[0]
            assert abs(one - other) < 1e-12 * abs(other)
