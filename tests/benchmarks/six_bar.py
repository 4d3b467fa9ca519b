"""The six-bar of Example 3-4 three times: for compoundkin, written out by hand, and as a loop of `fsolve`.

All give the same numbers: position, velocity and acceleration of the points D, A, C and G, and orientation,
angular velocity and angular acceleration of crank, plate, rocker and bar.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import fsolve

import compoundkin as ck

ED, DA, AB, FG = 14.0, 39.0, 28.0, 55.0
DC = 15.0 * np.exp(1j * np.deg2rad(35.0))
B, F = 41.0 + 0j, -34j
SPEED = 10.0
POINTS = ("D", "A", "C", "G")
LINKS = ("crank", "plate", "rocker", "bar")

Answer = dict[str, tuple[Any, Any, Any]]


def mechanism(rocker: Any = AB, plate: Any = DA) -> ck.Mechanism:
    """The six-bar; lengths may be arrays of designs."""
    return ck.Mechanism(
        "Six-bar of Example 3-4",
        ck.link("frame", E=0, B=B, F=F),
        ck.link("crank", E=0, D=ED),
        ck.link("plate", D=0, A=plate, C=DC),
        ck.link("rocker", B=0, A=rocker),
        ck.link("bar", F=0, G=FG),
        ck.link("block", C=0),
        ck.slide("block", on="bar", at="C", through="F"),
        ck.drive("crank"),
        ck.mode(1, "rocker"),
    )


# Mass, mass centre in the link's frame, inertia about it.
MASSES = {
    "crank": (0.05, (5, 0), 2.0),
    "plate": (0.08, (18, 4), 15.0),
    "rocker": (0.04, (14, 0), 4.0),
    "bar": (0.06, (27.5, 0), 20.0),
    "block": (0.02, (0, 0), 1.0),
}


def loaded(rocker: Any = AB, plate: Any = DA) -> ck.Mechanism:
    """The six-bar with masses on all links, weights, a force and a torque, as in `tests/reference/forces.json`."""
    plan = mechanism(rocker, plate)
    masses = (ck.mass(name, mass, at=at, inertia=inertia) for name, (mass, at, inertia) in MASSES.items())
    loads = ck.gravity(0, -9.81), ck.force("bar", (-3, -5), at="G"), ck.torque("rocker", 20.0)
    units = {"length": "mm", "mass": "kg", "force": "N"}
    return ck.Mechanism(plan.title, *plan.items, *masses, *loads, units=units)


def asked(motion: ck.results.Motion) -> Answer:
    """Everything the other two compute, asked of a motion."""
    found: Answer = {}
    for name in POINTS:
        point = motion.points[name]
        found[name] = point.position, point.velocity, point.acceleration
    for name in LINKS:
        link = motion.links[name]
        found[name] = motion.poses[name].u.c[0], link.angular_velocity, link.angular_acceleration
    return found


def by_hand(crank: np.ndarray) -> Answer:
    """NumPy as one who knows it writes it for this one mechanism: complex vectors, nothing computed twice."""
    u1 = np.cos(crank) + 1j * np.sin(crank)
    d = ED * u1
    vd, ad = 1j * SPEED * d, -(SPEED**2) * d
    # A: two circles
    line = B - d
    inverse = 1.0 / (line.real**2 + line.imag**2)
    foot = 0.5 + (DA**2 - AB**2) * 0.5 * inverse
    arm = line * (foot - 1j * np.sqrt(DA**2 * inverse - foot * foot))
    a = d + arm
    rod = a - B
    u2, u3 = arm / DA, rod / AB
    # velocity and acceleration of D + i w2 arm = B + i w3 rod, each along and across the other link
    det = 1.0 / (arm.real * rod.imag - arm.imag * rod.real)
    w2 = -(vd.real * rod.real + vd.imag * rod.imag) * det
    w3 = -(vd.real * arm.real + vd.imag * arm.imag) * det
    va = 1j * w3 * rod
    rest = ad - w2 * w2 * arm + w3 * w3 * rod
    al2 = -(rest.real * rod.real + rest.imag * rod.imag) * det
    al3 = -(rest.real * arm.real + rest.imag * arm.imag) * det
    aa = (1j * al3 - w3 * w3) * rod
    offset = u2 * DC
    c, vc, ac = d + offset, vd + 1j * w2 * offset, ad + (1j * al2 - w2 * w2) * offset
    # the bar points from F to C
    s = c - F
    inverse = 1.0 / (s.real**2 + s.imag**2)
    u4 = s * np.sqrt(inverse)
    w4 = (s.real * vc.imag - s.imag * vc.real) * inverse
    stretch = s.real * vc.real + s.imag * vc.imag
    al4 = (s.real * ac.imag - s.imag * ac.real - 2.0 * w4 * stretch) * inverse
    tip = FG * u4
    g, vg, ag = F + tip, 1j * w4 * tip, (1j * al4 - w4 * w4) * tip
    return {
        "D": (d, vd, ad), "A": (a, va, aa), "C": (c, vc, ac), "G": (g, vg, ag),
        "crank": (u1, SPEED, 0.0), "plate": (u2, w2, al2), "rocker": (u3, w3, al3), "bar": (u4, w4, al4),
    }  # fmt: skip


def by_fsolve(crank: np.ndarray) -> Answer:
    """Pose by pose as usually done: `fsolve` from the pose before, then two linear systems with its Jacobian."""
    parts: dict[str, list[tuple[Any, Any, Any]]] = {name: [] for name in (*POINTS, *LINKS)}
    first = by_hand(crank[:1])
    x = np.array([*(float(np.angle(first[name][0])[0]) for name in LINKS[1:]), abs(first["C"][0][0] - F)])
    for angle in crank:
        x = fsolve(_loops, x, args=(angle,), fprime=_jacobian, xtol=1e-13)
        for name, values in _pose(x, angle).items():
            parts[name].append(values)
    return {name: tuple(np.array(column) for column in zip(*rows, strict=True)) for name, rows in parts.items()}  # type: ignore[misc]


def _loops(x: np.ndarray, crank: float) -> list[float]:
    plate, rocker, bar, s = x
    d = ED * np.exp(1j * crank)
    one = d + DA * np.exp(1j * plate) - B - AB * np.exp(1j * rocker)
    two = d + DC * np.exp(1j * plate) - F - s * np.exp(1j * bar)
    return [one.real, one.imag, two.real, two.imag]


def _jacobian(x: np.ndarray, crank: float) -> np.ndarray:
    plate, rocker, bar, s = x
    a, b = 1j * DA * np.exp(1j * plate), -1j * AB * np.exp(1j * rocker)
    c, e = 1j * DC * np.exp(1j * plate), -np.exp(1j * bar)
    f = 1j * s * e
    return np.array(
        [
            [a.real, b.real, 0.0, 0.0],
            [a.imag, b.imag, 0.0, 0.0],
            [c.real, 0.0, f.real, e.real],
            [c.imag, 0.0, f.imag, e.imag],
        ]
    )


def _pose(x: np.ndarray, crank: float) -> Answer:
    jacobian = _jacobian(x, crank)
    u1, u2, u3, u4 = (np.exp(1j * angle) for angle in (crank, *x[:3]))
    s = x[3]
    vd, ad = 1j * SPEED * ED * u1, -(SPEED**2) * ED * u1
    w2, w3, w4, ds = np.linalg.solve(jacobian, [-vd.real, -vd.imag, -vd.real, -vd.imag])
    one = ad - w2**2 * DA * u2 + w3**2 * AB * u3
    two = ad - w2**2 * DC * u2 + (w4**2 * s - 2j * w4 * ds) * u4
    al2, al3, al4, _ = np.linalg.solve(jacobian, [-one.real, -one.imag, -two.real, -two.imag])

    def turned(arm: complex, w: float, al: float) -> tuple[complex, complex, complex]:
        return arm, 1j * w * arm, (1j * al - w * w) * arm

    def on(base: tuple[complex, ...], arm: tuple[complex, ...]) -> tuple[Any, Any, Any]:
        return base[0] + arm[0], base[1] + arm[1], base[2] + arm[2]

    d = (ED * u1, vd, ad)
    return {
        "D": d,
        "A": on(d, turned(DA * u2, w2, al2)),
        "C": on(d, turned(DC * u2, w2, al2)),
        "G": on((F, 0, 0), turned(FG * u4, w4, al4)),
        "crank": (u1, SPEED, 0.0), "plate": (u2, w2, al2), "rocker": (u3, w3, al3), "bar": (u4, w4, al4),
    }  # fmt: skip
