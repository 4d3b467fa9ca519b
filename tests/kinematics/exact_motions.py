"""Mechanisms near limits and change points, and their motion in forty digits by equations that share no code."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from math import factorial
from typing import Any

import numpy as np
from mpmath import mp, mpc, mpf

import compoundkin as ck

ORDER = 3
DIGITS = 40


class Jet:
    """A complex number with its time derivatives, as the coefficients of a power series, in forty digits.

    One of a single coefficient is a constant; otherwise the shorter of two says how far their result goes.
    """

    def __init__(self, *c: Any) -> None:
        self.c = [mpc(x) for x in c]

    def at(self, k: int) -> Any:
        return self.c[k] if k < len(self.c) else mpc(0)

    def with_length_of(self, other: Jet) -> int:
        one, two = len(self.c), len(other.c)
        return max(one, two) if min(one, two) == 1 else min(one, two)

    def __add__(self, other: Any) -> Jet:
        other = jet(other)
        return Jet(*(self.at(k) + other.at(k) for k in range(self.with_length_of(other))))

    __radd__ = __add__

    def __neg__(self) -> Jet:
        return Jet(*(-a for a in self.c))

    def __sub__(self, other: Any) -> Jet:
        return self + -jet(other)

    def __mul__(self, other: Any) -> Jet:
        other = jet(other)
        if len(other.c) == 1:
            return Jet(*(a * other.c[0] for a in self.c))
        n = self.with_length_of(other)
        return Jet(*(sum((self.at(j) * other.at(k - j) for j in range(k + 1)), mpc(0)) for k in range(n)))

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Jet:
        other, q = jet(other), list[Any]()
        for k in range(self.with_length_of(other)):
            q.append((self.at(k) - sum((other.at(j) * q[k - j] for j in range(1, k + 1)), mpc(0))) / other.c[0])
        return Jet(*q)

    def root(self) -> Jet:
        r = [mp.sqrt(self.c[0])]
        for k in range(1, len(self.c)):
            r.append((self.c[k] - sum((r[j] * r[k - j] for j in range(1, k)), mpc(0))) / (2 * r[0]))
        return Jet(*r)

    def turn(self) -> Jet:
        """exp(i x)."""
        u = [mp.expj(self.c[0])]
        for k in range(1, len(self.c)):
            u.append(sum((j * mpc(0, 1) * self.c[j] * u[k - j] for j in range(1, k + 1)), mpc(0)) / k)
        return Jet(*u)

    def conj(self) -> Jet:
        return Jet(*(mp.conj(a) for a in self.c))

    def abs2(self) -> Jet:
        return self * self.conj()


def jet(value: Any) -> Jet:
    return value if isinstance(value, Jet) else Jet(value)


def direction(start: Jet, end: Jet) -> Jet:
    """The unit vector from one place to another."""
    way = end - start
    return way / way.abs2().root()


def apex(a: Jet, b: Jet, r: Any, s: Any, side: float) -> Jet:
    """The point at distances r from a and s from b, to the left of the way from a to b for side +1."""
    r, s = mpf(r), mpf(s)
    line = b - a
    line2 = line.abs2()
    foot = (line2 + (r * r - s * s)) * mpf("0.5")
    height = (line2 * (r * r) - foot * foot).root()
    return a + line * (foot + height * mpc(0, side)) / line2


Unknowns = Sequence[Jet]


def solved(equations: Callable[[Unknowns], Sequence[Jet]], start: Sequence[float]) -> list[Jet]:
    """Real unknowns with all derivatives that make real equations zero: Newton, then one linear system an order."""
    n = len(start)
    x = [mpf(v) for v in start]

    def matrix(at: Sequence[Any]) -> Any:
        columns = [equations([Jet(v, 1 if i == j else 0) for i, v in enumerate(at)]) for j in range(n)]
        still = equations([Jet(v, 0) for v in at])
        return mp.matrix([[mp.re(columns[j][i].at(1) - still[i].at(1)) for j in range(n)] for i in range(n)])

    for _ in range(12):
        residual = mp.matrix([mp.re(e.c[0]) for e in equations([Jet(v, 0) for v in x])])
        step = mp.lu_solve(matrix(x), residual)
        x = [v - d for v, d in zip(x, step, strict=True)]
        if max(abs(d) for d in step) < mpf(10) ** (-DIGITS + 12):
            break
    found, inverse = [[v] for v in x], matrix(x) ** -1
    for k in range(1, ORDER + 1):
        residual = mp.matrix([mp.re(e.at(k)) for e in equations([Jet(*c, 0) for c in found])])
        for c, d in zip(found, inverse * residual, strict=True):
            c.append(-d)
    return [Jet(*c) for c in found]


@dataclass(frozen=True)
class Case:
    """A mechanism near a special value of its driver: how it is drawn, and where each link is in forty digits.

    `poses(driver, here)` gives origin and orientation of each link from the driver as a jet; `here` are the links'
    poses as they were solved, from which Newton may start.
    """

    mechanism: ck.Mechanism
    driver: str
    special: Callable[[], Any]
    sense: float
    poses: Callable[[Jet, Mapping[str, tuple[complex, complex]]], dict[str, tuple[Jet, Jet]]]
    modes: Mapping[str, int] | None = None


Links = dict[str, tuple[Jet, Jet]]
Here = Mapping[str, tuple[complex, complex]]
ORIGIN = Jet(0)


def bar(start: Jet, end: Jet) -> tuple[Jet, Jet]:
    return start, direction(start, end)


# A triple rocker: crank and its neighbours in line at the limit.
def _four_bar(phi: Jet, here: Here) -> Links:
    b, d = phi.turn() * 4, Jet(7)
    c = apex(b, d, 5, 3, 1)
    return {"crank": (ORIGIN, phi.turn()), "coupler": bar(b, c), "rocker": bar(d, c)}


FOUR_BAR = Case(
    ck.Mechanism(
        "four-bar",
        ck.link("frame", A=(0, 0), D=(7, 0)),
        ck.link("crank", A=0, B=4),
        ck.link("coupler", B=0, C=5),
        ck.link("rocker", D=0, C=3),
        ck.drive("crank"),
        ck.mode(-1, "rocker"),
    ),
    "crank",
    lambda: mp.acos(mpf(1) / 56),
    -1.0,
    _four_bar,
)


def _slider_crank(phi: Jet, here: Here) -> Links:
    a = phi.turn() * 3
    y = Jet(*(mp.im(c) for c in a.c))
    x = Jet(*(mp.re(c) for c in a.c)) + (-(y * y) + 4).root()
    return {"crank": (ORIGIN, phi.turn()), "rod": bar(a, x), "piston": (x, Jet(1))}


SLIDER_CRANK = Case(
    ck.Mechanism(
        "slider-crank",
        ck.link("frame", O=(0, 0), X=(1, 0)),
        ck.link("crank", O=0, A=3),
        ck.link("rod", A=0, B=2),
        ck.link("piston", B=0),
        ck.slide("piston", on="frame", at="B", through="O", toward="X"),
        ck.drive("crank"),
        ck.mode(1, "rod"),
    ),
    "crank",
    lambda: mp.asin(mpf(2) / 3),
    -1.0,
    _slider_crank,
)


def _parallelogram(phi: Jet, here: Here) -> Links:
    return {"crank": (ORIGIN, phi.turn()), "coupler": (phi.turn() * 2, Jet(1)), "rocker": (Jet(5), phi.turn())}


PARALLELOGRAM = Case(
    ck.Mechanism(
        "parallelogram",
        ck.link("frame", A=(0, 0), D=(5, 0)),
        ck.link("crank", A=0, B=2),
        ck.link("coupler", B=0, C=5),
        ck.link("rocker", D=0, C=2),
        ck.drive("crank"),
        ck.drawn(A=0, D=5, B=(0, 2), C=(5, 2)),
    ),
    "crank",
    lambda: mp.pi,
    -1.0,
    _parallelogram,
)

# A ternary link on three bars: the first to a crank, the others to the frame.
_PLATE = {"B": 0j, "C": 3 + 0j, "P": 1 + 2j}
_REACH, _FEET = (3.0, 3.5, 2.5), (5 - 1j, 2 + 4.5j)


def _three_bars(crank: Jet, x: Unknowns) -> tuple[list[Jet], list[Jet], list[Jet]]:
    u = x[2].turn()
    ends = [x[0] + x[1] * mpc(0, 1) + u * p for p in _PLATE.values()]
    feet = [crank, Jet(_FEET[0]), Jet(_FEET[1])]
    lacking = [(e - f).abs2() - mpf(r) ** 2 for e, f, r in zip(ends, feet, _REACH, strict=True)]
    return ends, feet, lacking


def _class_three(phi: Jet, here: Here) -> Links:
    crank = phi.turn() * 3
    z, u = here["plate"]
    x = solved(lambda x: _three_bars(crank, x)[2], (z.real, z.imag, _angle(u)))
    ends, feet, _ = _three_bars(crank, x)
    plate = (x[0] + x[1] * mpc(0, 1), x[2].turn())
    bars = {name: bar(f, e) for name, f, e in zip(("first", "second", "third"), feet, ends, strict=True)}
    return {"crank": (ORIGIN, phi.turn()), "plate": plate, **bars}


def _angle(u: complex) -> float:
    return float(mp.arg(mpc(u)))


def _meeting(equations: Callable[[Jet, Unknowns], Sequence[Jet]], start: Sequence[float]) -> Any:
    """The driver's value, the last of the unknowns, at which the equations become singular."""

    def system(*x: Any) -> list[Any]:
        n = len(x) - 1
        rows = []
        for j in range(n):
            moved = [Jet(v, 1 if i == j else 0) for i, v in enumerate(x[:n])]
            rows.append([mp.re(e.at(1)) for e in equations(Jet(x[n]), moved)])
        still = [mp.re(e.c[0]) for e in equations(Jet(x[n]), [Jet(v) for v in x[:n]])]
        return [*still, mp.det(mp.matrix(rows))]

    return mp.findroot(system, start)[len(start) - 1]


CLASS_THREE = Case(
    ck.Mechanism(
        "class III",
        ck.link("frame", O=(0, 0), D=_FEET[0], E=_FEET[1]),
        ck.link("crank", O=0, A=3),
        ck.link("plate", **_PLATE),
        ck.link("first", A=0, B=_REACH[0]),
        ck.link("second", D=0, C=_REACH[1]),
        ck.link("third", E=0, P=_REACH[2]),
        ck.drive("crank"),
    ),
    "crank",
    lambda: _meeting(lambda phi, x: _three_bars(phi.turn() * 3, x)[2], _near_limit(CLASS_THREE, 3.7544, "plate", 0)),
    -1.0,
    _class_three,
    {"plate": 1},
)

# Two ternary links, one on a crank and one on the frame, and two bars between them.
_LEFT, _RIGHT, _BARS = (2 - 0.3j, 2.4 + 1.6j), (1.8 + 0.5j, 4.1 + 0.2j), (2.1, 3.4)


def _two_bars(crank: Jet, x: Unknowns) -> tuple[list[Jet], list[Jet], list[Jet]]:
    left = [crank + x[0].turn() * p for p in _LEFT]
    right = [x[1].turn() * p + 6 for p in _RIGHT]
    return left, right, [(a - b).abs2() - mpf(r) ** 2 for a, b, r in zip(left, right, _BARS, strict=True)]


def _class_four(phi: Jet, here: Here) -> Links:
    crank = phi.turn() * 2
    x = solved(lambda x: _two_bars(crank, x)[2], (_angle(here["left"][1]), _angle(here["right"][1])))
    left, right, _ = _two_bars(crank, x)
    bars = {name: bar(a, b) for name, a, b in zip(("low", "high"), left, right, strict=True)}
    return {"crank": (ORIGIN, phi.turn()), "left": (crank, x[0].turn()), "right": (Jet(6), x[1].turn()), **bars}


CLASS_FOUR = Case(
    ck.Mechanism(
        "class IV",
        ck.link("frame", O=(0, 0), D=(6, 0)),
        ck.link("crank", O=0, A=2),
        ck.link("left", A=0, P=_LEFT[0], Q=_LEFT[1]),
        ck.link("right", D=0, R=_RIGHT[0], S=_RIGHT[1]),
        ck.link("low", P=0, R=_BARS[0]),
        ck.link("high", Q=0, S=_BARS[1]),
        ck.drive("crank"),
    ),
    "crank",
    lambda: _meeting(
        lambda phi, x: _two_bars(phi.turn() * 2, x)[2],
        [_near_limit(CLASS_FOUR, 1.1185, name, 1)[0] for name in ("left", "right")] + [1.1185],
    ),
    -1.0,
    _class_four,
    {"left": 1},
)


def _near_limit(case: Case, value: float, link: str, only_angle: int) -> list[float]:
    """The unknowns of a link as they are solved near the limit, and the driver's value."""
    z, u = here_of(ck.solve(case.mechanism, {case.driver: [value - 0.3, value]}, order=0, modes=case.modes), 1)[link]
    return [_angle(u)] if only_angle else [z.real, z.imag, _angle(u), value]


def here_of(motion: ck.results.Motion, k: int) -> dict[str, tuple[complex, complex]]:
    """Origin and orientation of every link at one pose of a motion."""
    return {name: (pose.entry((0, k)).z.c[0], pose.entry((0, k)).u.c[0]) for name, pose in motion.poses.items()}


# A knife edge on a slide beside the axis of an elliptic cam. The profile is the spline that follows the ellipse within
# 1e-11 of its size: what the program holds for the profile is taken here for the profile.
ELLIPSE = ck.profiles.formula(lambda s: 2.0 * np.cos(s) + 1j * np.sin(s), 0.0, 2.0 * np.pi)


def _cam(phi: Jet, here: Here) -> Links:
    pieces = ELLIPSE.curve._pieces

    def edge(s: Jet) -> Jet:
        k = int(np.searchsorted(pieces.breaks, float(mp.re(s.c[0])), side="right")) - 1
        x, total = s - mpf(float(pieces.breaks[k])), Jet(0)
        for coefficient in pieces.coefficients[::-1, k]:
            total = total * x + complex(coefficient)
        return phi.turn() * total

    def across(s: Jet) -> Jet:
        place = edge(s)
        return (place + place.conj()) / 2 - mpf("1.5")

    at = complex(mp.expj(-phi.c[0])) * here["follower"][0]
    (s,) = solved(lambda x: [across(x[0])], [float(np.arctan2(at.imag, at.real / 2) % (2 * np.pi))])
    return {"cam": (ORIGIN, phi.turn()), "follower": (edge(s), Jet(1j))}


CAM = Case(
    ck.Mechanism(
        "cam",
        ck.link("frame", O=(0, 0), X=(1.5, 0), Y=(1.5, 1)),
        ck.link("cam", O=0),
        ck.link("follower", T=0),
        ck.slide("follower", on="frame", at="T", through="X", toward="Y", angle=0.0),
        ck.cam("follower", on="cam", at="T", profile=ELLIPSE),
        ck.drive("cam"),
    ),
    "cam",
    lambda: mp.acos(mp.sqrt(mpf("1.25") / 3)),
    -1.0,
    _cam,
)


# Two cranks on gears of 20 and 40 teeth, and two bars: stretched at the limit.
def _gears(phi: Jet, here: Here) -> Links:
    other = phi * mpf("-0.5")
    a, b = phi.turn(), other.turn() * 2 + 4
    c = apex(a, b, 2.5, 2, 1)
    return {
        "pinion": (ORIGIN, phi.turn()),
        "gear": (Jet(4), other.turn()),
        "left": bar(a, c),
        "right": bar(b, c),
    }


GEARS = Case(
    ck.Mechanism(
        "geared five-bar",
        ck.link("frame", O=(0, 0), Q=(4, 0)),
        ck.link("pinion", O=0, A=1),
        ck.link("gear", Q=0, B=2),
        ck.link("left", A=0, C=2.5),
        ck.link("right", B=0, C=2),
        ck.gear("pinion", "gear", carrier="frame", teeth=(20, 40), phase=0.0),
        ck.drive("pinion"),
        ck.mode(-1, "left"),
    ),
    "pinion",
    lambda: mp.findroot(lambda x: abs(mp.expj(x) - 4 - 2 * mp.expj(-x / 2)) - mpf("4.5"), 1.9),
    1.0,
    _gears,
)

CASES = {
    case.mechanism.title: case
    for case in (FOUR_BAR, SLIDER_CRANK, PARALLELOGRAM, CLASS_THREE, CLASS_FOUR, CAM, GEARS)
}  # fmt: skip


@cache
def special(title: str) -> Any:
    """The driver's value at the limit or change point, in forty digits."""
    with mp.workdps(DIGITS):
        return CASES[title].special()


def true_errors(title: str, motion: ck.results.Motion, k: int, value: float, rates: Sequence[float]) -> list[float]:
    """The largest error of any link at a pose, by orders: of its origin, or of its orientation times the size."""
    with mp.workdps(DIGITS):
        driver = Jet(*(mpf(v) / factorial(j) for j, v in enumerate((value, *rates))))
        exact = CASES[title].poses(driver, here_of(motion, k))
        worst = [0.0] * (motion.order + 1)
        for name, (z, u) in exact.items():
            pose = motion.poses[name].entry((0, k))
            for j in range(motion.order + 1):
                for true, found, size in ((z, pose.z.c, 1.0), (u, pose.u.c, motion.size)):
                    gap = mpc(found[j] if j < len(found) else 0.0) - true.at(j)
                    worst[j] = max(worst[j], float(abs(gap) * factorial(j) * size))
        return worst
