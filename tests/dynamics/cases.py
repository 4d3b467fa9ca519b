"""The mechanisms of `tests/reference/forces.json`, built from words, with rows to hold their forces against."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

import compoundkin as ck
from compoundkin.results import Motion
from tests.support import reference

SI = {"length": "m", "mass": "kg", "force": "N"}
Row = Mapping[str, Any]


@dataclass(frozen=True)
class Case:
    """A mechanism, and the rows of the reference that it is held against; `size` is its largest dimension."""

    mechanism: ck.Mechanism
    rows: tuple[Row, ...]
    values: Any
    size: float
    rates: Mapping[str, Any] = field(default_factory=dict)
    inertia: bool = True

    @property
    def motion(self) -> Motion:
        """The motion through the poses of the rows."""
        return ck.solve(self.mechanism, self.values, **self.rates)

    @property
    def forces(self) -> Any:
        """The forces of that motion."""
        return ck.force_analysis(self.motion, inertia=self.inertia)


def misfits(case: Case, tolerance: float = 1e-9) -> list[str]:
    """Return what differs from the rows by more than the tolerance, relative to the row's greatest force."""
    forces, found = case.forces, []
    for pose, row in enumerate(case.rows):
        greatest = max(abs(complex(*pair["force"])) for pair in row["pairs"].values())
        levers = {"force": 1.0, "moment": case.size, "driver": case.size}
        for what, kind, value, expected in _compared(case, forces, pose, row):
            if not abs(value - expected) <= tolerance * greatest * levers[kind]:
                found.append(f"row {pose}: {what} is {value}, not {expected}")
    return found


def _compared(case: Case, forces: Any, pose: int, row: Row) -> Iterator[tuple[str, str, complex, complex]]:
    """Yield what is compared at a pose, whether it is a force or a moment, what it is and what it should be."""
    ((driver, of_driver),) = forces.drives.items()
    effort, driven = of_driver.effort[pose], forces.motion.structure.driven[driver].pair
    yield "driver", "driver", effort, row["driver"]
    for name, pair in row["pairs"].items():
        if name not in forces.pairs:
            continue
        force, moment = complex(*pair["force"]), pair.get("moment", 0.0)
        if name == driven.name:
            # its force has the driver's effort in it; driven guides of the reference lie along x
            force, moment = (force, effort) if driven.free_is_angle else (force + effort, moment)
        found = forces.pairs[name].on(pair["on"])
        yield f"force of {name}", "force", found.force[pose], force
        yield f"moment of {name}", "moment", found.moment[pose], moment
    frame = forces.on_frame
    yield "force on the frame", "force", frame.force.reshape(-1)[pose], complex(*row["on_frame"]["force"])
    yield "moment on it", "moment", frame.moment.reshape(-1)[pose], row["on_frame"]["moment_about_origin"]


def masses(written: Mapping[str, Any]) -> Iterator[Any]:
    """Yield the masses of a case, as words."""
    for link, own in written.items():
        yield ck.mass(link, own["mass"], at=tuple(own["mass_centre"]), inertia=own["inertia"])


def cranks(rows: list[Row]) -> Any:
    """Return the crank angles of rows."""
    return {"crank": ck.deg([row["crank_deg"] for row in rows])}


def six_bar(rows: str, inertia: bool) -> Case:
    """The main example, Example 3-4 in metres."""
    entry = reference("sixbar_example_3_4_masses", "forces")
    m, own = entry["dimensions"]["m"], entry["dimensions"]
    mechanism = ck.Mechanism(
        "Six-bar of Example 3-4",
        ck.link("frame", E=m["E"], B=m["B"], F=m["F"]),
        ck.link("crank", E=(0, 0), D=(m["ED"], 0)),
        ck.link("plate", D=(0, 0), A=(m["DA"], 0), C=ck.polar(m["DC"], ck.deg(m["angle_ADC_deg"]))),
        ck.link("rocker", B=(0, 0), A=(m["BA"], 0)),
        ck.link("bar", F=(0, 0), G=(m["FG"], 0)),
        ck.link("block", C=(0, 0)),
        ck.slide("block", on="bar", at="C", through="F", angle=0, name="slot"),
        ck.mode(1, "rocker"),
        ck.mode(1, "bar"),
        ck.drive("crank"),
        *masses(own["masses"]),
        ck.gravity(*own["gravity"]),
        ck.force("bar", own["loads"][0]["force"], at="G"),
        ck.torque("rocker", own["loads"][1]["torque"]),
        units=SI,
    )
    rates = {"speed": own["speed"], "acceleration": own["acceleration"]}
    found = entry["expected"][rows]
    return Case(mechanism, tuple(found), cranks(found), 0.055, rates, inertia)


def engine() -> Case:
    """A slider-crank with gas pressure: the force at each pose as an array."""
    entry = reference("slider_crank_engine", "forces")
    own, rows = entry["dimensions"], entry["expected"]["rows"]
    angle = ck.deg([row["crank_deg"] for row in rows])
    gas = -2000 - 1500 * np.cos(angle) - 1800 * np.sin(angle) + 0j
    mechanism = ck.Mechanism(
        "Engine",
        ck.link("frame", O=(0, 0)),
        ck.link("crank", O=(0, 0), A=(own["OA"], 0)),
        ck.link("rod", A=(0, 0), B=(own["AB"], 0)),
        ck.link("piston", B=(0, 0)),
        ck.slide("piston", on="frame", at="B", through="O", angle=0, name="cylinder"),
        ck.drive("crank"),
        *masses(own["masses"]),
        ck.force("piston", gas, at="B"),
        ck.mode(1, "rod"),
        units=SI,
    )
    return Case(mechanism, tuple(rows), cranks(rows), 0.25, {"speed": own["speed"]})


def class_iii() -> Case:
    """A triad: three legs and a plate."""
    entry = reference("class_iii_six_bar_masses", "forces")
    own, rows = entry["dimensions"], entry["expected"]["rows"]
    load = own["loads"][0]
    legs = [("leg-1", "A1", "B1"), ("leg-2", "A2", "B2"), ("leg-3", "A3", "B3")]
    mechanism = ck.Mechanism(
        "Class III six-bar",
        ck.link("frame", **own["frame"]),
        ck.link("crank", O=(0, 0), A3=(own["crank"], 0)),
        *(ck.link(n, **{a: (0, 0), b: (long, 0)}) for (n, a, b), long in zip(legs, own["legs"], strict=True)),
        ck.link("plate", **own["plate"]),
        ck.drive("crank"),
        ck.drawn(A3=(0, 10), B1=(14.92, -1.34), B2=(24.1, 13.02), B3=(8.49, 18.48)),
        *masses(own["masses"]),
        ck.gravity(*own["gravity"]),
        ck.force("plate", load["force"], at=load["at"]),
        ck.torque("plate", load["torque"]),
        units=SI,
    )
    rates = {"speed": own["speed"], "acceleration": own["acceleration"]}
    return Case(mechanism, tuple(rows), cranks(rows), 25.0, rates)


def yoke() -> Case:
    """A scotch yoke with an oblique slot: two slides of one dyad, the outer and the inner."""
    entry = reference("scotch_yoke_and_rapson_slide", "forces")
    own, rows = entry["dimensions"]["yoke"], entry["expected"]["yoke"]
    load = own["load"]
    mechanism = ck.Mechanism(
        "Scotch yoke",
        ck.link("frame", O=(0, 0)),
        ck.link("crank", O=(0, 0), A=(own["OA"], 0)),
        ck.link("block", A=(0, 0)),
        ck.link("yoke", Y=(0, 0), Z=(0.2, 0), P=load["at"]),
        ck.slide("block", on="yoke", at="A", through="Y", angle=ck.deg(own["slot_angle_deg"]), name="slot"),
        ck.slide("yoke", on="frame", at="Y", through="O", angle=0, name="guide"),
        ck.drive("crank"),
        *masses(own["masses"]),
        ck.gravity(*entry["dimensions"]["gravity"]),
        ck.force("yoke", load["force"], at="P"),
        ck.torque("yoke", load["moment"]),
        units=SI,
    )
    rates = {"speed": own["speed"], "acceleration": own["acceleration"]}
    return Case(mechanism, tuple(rows), cranks(rows), 0.2, rates)


def tiller() -> Case:
    """A tiller that slides through a crosshead: two outer slides."""
    entry = reference("scotch_yoke_and_rapson_slide", "forces")
    own, rows = entry["dimensions"]["tiller"], entry["expected"]["tiller"]
    on_b, on_a = own["loads"]
    mechanism = ck.Mechanism(
        "Tiller",
        ck.link("frame", O=(0, 0), G=(0, own["rail_y"])),
        ck.link("carrier", O=(0, 0), T=(0.5, 0)),
        ck.link("a", X=(0, 0), P=on_a["at"]),
        ck.link("b", X=(0, 0)),
        ck.slide("a", on="carrier", at="X", through="O", angle=ck.deg(own["groove_angle_deg"]), name="groove"),
        ck.slide("b", on="frame", at="X", through="G", angle=0, name="rail"),
        ck.drive("carrier"),
        *masses(own["masses"]),
        ck.gravity(*entry["dimensions"]["gravity"]),
        ck.force("b", on_b["force"], at="X"),
        ck.force("a", on_a["force"], at="P"),
        ck.torque("a", on_a["moment"]),
        units=SI,
    )
    rates = {"speed": own["speed"], "acceleration": own["acceleration"]}
    return Case(mechanism, tuple(rows), {"carrier": cranks(rows)["crank"]}, 0.5, rates)


def toggle_press() -> Case:
    """A toggle press with a pin of three links; statics."""
    entry = reference("toggle_press_static", "forces")
    own, rows = entry["dimensions"], entry["expected"]["rows"]
    mechanism = ck.Mechanism(
        "Toggle press",
        ck.link("frame", O=own["O"], C=own["C"]),
        ck.link("crank", O=(0, 0), A=(own["OA"], 0)),
        ck.link("AB", A=(0, 0), B=(own["AB"], 0)),
        ck.link("CB", C=(0, 0), B=(own["CB"], 0)),
        ck.link("BD", B=(0, 0), D=(own["BD"], 0)),
        ck.link("slider", D=(0, 0)),
        ck.slide("slider", on="frame", at="D", through="C", angle=0, name="press"),
        ck.drive("crank"),
        ck.drawn(A=(0.1273, 0.1273), B=(0.0977, -0.2315), D=(0.6222, -0.36)),
        ck.force("slider", own["load"]["force"], at="D"),
        units=SI,
    )
    return Case(mechanism, tuple(rows), cranks(rows), 1.0, inertia=False)


def scissor_lift(rows: str, inertia: bool) -> Case:
    """A scissor lift of two stages driven by its foot."""
    entry = reference("scissor_lift_statics", "forces")
    own, found = entry["dimensions"], entry["expected"][rows]
    arm, half = own["arms"], own["arms"] / 2
    pins = [("arm-1", "A", "M1", "D"), ("arm-2", "B", "M1", "C"), ("arm-3", "C", "M2", "F"), ("arm-4", "D", "M2", "E")]
    mechanism = ck.Mechanism(
        "Scissor lift",
        ck.link("frame", A=(0, 0)),
        ck.link("foot", B=(0, 0)),
        *(ck.link(name, **{a: (0, 0), m: (half, 0), b: (arm, 0)}) for name, a, m, b in pins),
        ck.link("top", F=(0, 0)),
        ck.link("platform", E=(0, 0), T=(2, 0), P=own["load"]["at"]),
        ck.slide("foot", on="frame", at="B", through="A", angle=0, name="floor"),
        ck.slide("top", on="platform", at="F", through="E", angle=0, name="rail"),
        ck.drive("foot"),
        ck.drawn(B=(1.6, 0), M1=(0.8, 0.6), C=(0, 1.2), D=(1.6, 1.2), M2=(0.8, 1.8), E=(0, 2.4), F=(1.6, 2.4)),
        ck.drawn(T=(2, 2.4), P=(0.5, 2.4)),
        *(ck.mass(name, own["masses"]["arm"][0], at=(half, 0), inertia=own["masses"]["arm"][1]) for name, *_ in pins),
        ck.mass("foot", own["masses"]["foot"], at=(0, 0), inertia=0),
        ck.mass("top", own["masses"]["top"], at=(0, 0), inertia=0),
        ck.mass("platform", own["masses"]["platform"][0], at=own["platform_mass_centre"], inertia=25),
        ck.gravity(*own["gravity"]),
        ck.force("platform", own["load"]["force"], at="P"),
        units=SI,
    )
    values = {"foot": [row["foot"] for row in found]}
    rates = {"speed": -0.4, "acceleration": 0.3} if inertia else {}
    return Case(mechanism, tuple(found), values, 5.0, rates, inertia)


def four_bar(rows: str) -> Case:
    """A four-bar with counterweights; and one without."""
    entry = reference("balanced_four_bar", "forces")
    own, found = entry["dimensions"], entry["expected"][rows]
    written = {link: dict(mass) for link, mass in own["masses"].items()}
    if rows == "unbalanced":
        written["crank"]["mass_centre"], written["rocker"]["mass_centre"] = (0.02, 0), (0.05, 0)
    mechanism = ck.Mechanism(
        "Four-bar",
        ck.link("frame", O=own["O"], C=own["C"]),
        ck.link("crank", O=(0, 0), A=(own["OA"], 0)),
        ck.link("coupler", A=(0, 0), B=(own["AB"], 0)),
        ck.link("rocker", C=(0, 0), B=(own["CB"], 0)),
        ck.drive("crank"),
        ck.drawn(A=(0.05, 0), B=(0.12, 0.12)),
        *masses(written),
        units=SI,
    )
    return Case(mechanism, tuple(found), cranks(found), 0.2, {"speed": own["speed"]})


def arm(spring: Any, *others: Any, speed: float = 0.0, acceleration: float = 0.0) -> Case:
    """An arm with a spring from it to a point above its pivot."""
    entry = reference("spring_balanced_arm", "forces")
    own, rows = entry["dimensions"], entry["expected"]["rows"]
    mechanism = ck.Mechanism(
        "Spring-balanced arm",
        ck.link("frame", O=(0, 0), S=own["frame_point"]),
        ck.link("arm", O=(0, 0), A=own["A"]),
        ck.drive("arm"),
        ck.mass("arm", own["mass"], at=tuple(own["mass_centre"]), inertia=own["inertia"]),
        ck.gravity(*own["gravity"]),
        spring,
        *others,
        units=SI,
    )
    values = {"arm": ck.deg([row["arm_deg"] for row in rows])}
    return Case(mechanism, tuple(rows), values, 1.0, {"speed": speed, "acceleration": acceleration})


def planetary_train(row: Row) -> Case:
    """A planet between sun and ring; the ring belongs to the frame, the arm is driven."""
    own = reference("planetary_train_torques", "forces")["dimensions"]
    radii, inertia = own["radii"], own["inertia"]
    mechanism = ck.Mechanism(
        "Planetary train",
        ck.link("frame", O=(0, 0)),
        ck.link("arm", O=(0, 0), P=(radii["arm"], 0)),
        ck.link("planet", P=(0, 0), Q=(radii["planet"], 0)),
        ck.link("sun", O=(0, 0), S=(radii["sun"], 0)),
        ck.gear("planet", "frame", carrier="arm", radii=(radii["planet"], radii["ring"]), internal=True, name="ring"),
        ck.gear("planet", "sun", carrier="arm", radii=(radii["planet"], radii["sun"]), name="sun gear"),
        ck.drive("arm"),
        ck.mass("sun", 1.0, at=(0, 0), inertia=inertia["sun"]),
        ck.mass("planet", own["planet_mass"], at=(0, 0), inertia=inertia["planet"]),
        ck.mass("arm", 1.0, at=(0, 0), inertia=inertia["arm about the axis"]),
        ck.torque("sun", row["sun_torque_from_outside"]),
        units=SI,
    )
    rates = {"speed": row["arm_speed"], "acceleration": row["arm_acceleration"]}
    return Case(mechanism, (row,), {"arm": ck.deg([row["arm_deg"]])}, radii["ring"], rates)


def crank_rocker(*loads: Any) -> ck.Mechanism:
    """A crank-rocker of 20 cm with masses, and any loads."""
    return ck.Mechanism(
        "Four-bar",
        ck.link("frame", O=(0, 0), C=(0.2, 0)),
        ck.link("crank", O=(0, 0), A=(0.06, 0)),
        ck.link("coupler", A=(0, 0), B=(0.18, 0)),
        ck.link("rocker", C=(0, 0), B=(0.12, 0)),
        ck.drive("crank"),
        ck.mass("crank", 1.0, at="O", inertia=0.004),
        ck.mass("coupler", 0.8, at=(0.09, 0), inertia=0.003),
        ck.mass("rocker", 1.0, at=(0.06, 0), inertia=0.005),
        *loads,
        units=SI,
    )


CASES: dict[str, Callable[[], Case]] = {
    "sixbar_example_3_4_masses dynamic": lambda: six_bar("dynamic", True),
    "sixbar_example_3_4_masses static": lambda: six_bar("static", False),
    "slider_crank_engine": engine,
    "class_iii_six_bar_masses": class_iii,
    "scotch_yoke_and_rapson_slide yoke": yoke,
    "scotch_yoke_and_rapson_slide tiller": tiller,
    "toggle_press_static": toggle_press,
    "scissor_lift_statics static": lambda: scissor_lift("static", False),
    "scissor_lift_statics dynamic": lambda: scissor_lift("dynamic", True),
    "balanced_four_bar balanced": lambda: four_bar("balanced"),
    "balanced_four_bar unbalanced": lambda: four_bar("unbalanced"),
}
