"""The textbook routines agree with `solve` and with formulas written out here, and say what is wrong with numbers."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any, cast

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import compoundkin as ck
from compoundkin.kinematics.groups import DYADS
from compoundkin.structure import Group
from tests import catalog
from tests.support import drawn_values, random_sketch

dyads = ck.equations
ROUTINES: dict[str, Callable[..., Any]] = {name: getattr(dyads, name.lower()) for name in DYADS}
# Of the largest of each kind, divided by the margin: next to a limit position rounding of what is given is magnified.
AGREE = 1e-13
SEEDS = st.integers(0, 2**32 - 1)


def test_every_dyad_has_its_routine() -> None:
    assert {"LINK", *DYADS} <= {name.upper() for name in dyads.__all__}


# --- with solve -------------------------------------------------------------------------------------------


@dataclass
class Read:
    """A dyad of a motion, its pairs as points and lines: what a textbook would give its routine."""

    motion: ck.results.Motion
    group: Group

    def __post_init__(self) -> None:
        (inner,) = self.group.inner
        order = list(range(2))
        if self.group.name == "RPR" and inner.members[0] in self.group.bodies[1].links:
            order.reverse()  # its first link carries the guide
        self.links = [self.group.bodies[k].links[0] for k in order]
        self.outer = [self.group.outer[k] for k in order]
        self.inner = [self.end(inner, link) for link in self.links]
        self.local = [self.end(pair, link) for pair, link in zip(self.outer, self.links, strict=True)]

    def end(self, pair: Any, link: str) -> Any:
        return self.motion.inputs.ends[pair.name][pair.members.index(link)]

    def outside(self, k: int) -> tuple[Any, Any]:
        pair = self.outer[k]
        (other,) = (name for name in pair.members if name != self.links[k])
        return self.motion.links[other], self.end(pair, other)

    def pin(self, k: int) -> Any:
        link, end = self.outside(k)
        return link.at(end.point)

    def guide(self, k: int) -> Any:
        link, end = self.outside(k)
        rates = link.angular_velocity, link.angular_acceleration
        return dyads.MovingLine(link.at(end.point), link.angle + np.angle(end.direction), *rates)

    def across(self, k: int, line: Any, place: Any) -> Any:
        """How far a place of link k is to the left of a line of it."""
        return ((place.point - line.point) * np.conj(line.direction)).imag

    def length(self, k: int) -> Any:
        return np.abs(self.inner[k].point - self.local[k].point)

    def mode(self) -> Any:
        """The mode by the meaning of its sign, at every pose."""
        a, b = (np.asarray(self.pin(k).position) for k in (0, 1))
        c = np.asarray(self.motion.links[self.links[0]].at(self.inner[0].point).position)
        if self.group.name == "RRR":
            return signs((np.conj(c - a) * (b - c)).imag)
        if self.group.name == "RRP":
            return signs((np.exp(-1j * self.guide(1).angle) * (c - a)).real)
        line = self.motion.links[self.links[0]].angle + np.angle(self.inner[0].direction)
        return signs((np.exp(-1j * line) * (b - a)).real)

    def given(self) -> dict[str, Any]:
        """The arguments of its routine."""
        inner, local = self.inner, self.local
        match self.group.name:
            case "RRR":
                return {"a": self.pin(0), "b": self.pin(1), "first_length": self.length(0),
                        "second_length": self.length(1), "mode": self.mode()}  # fmt: skip
            case "RRP":
                return {"a": self.pin(0), "guide": self.guide(1), "length": self.length(0),
                        "offset": self.across(1, local[1], inner[1]), "mode": self.mode()}  # fmt: skip
            case "RPR":
                offset = self.across(1, inner[1], local[1]) - self.across(0, inner[0], local[0])
                return {"a": self.pin(0), "b": self.pin(1), "offset": offset, "mode": self.mode()}
            case "PRP":
                return {"first": self.guide(0), "second": self.guide(1),
                        "first_offset": self.across(0, local[0], inner[0]),
                        "second_offset": self.across(1, local[1], inner[1])}  # fmt: skip
        turn = np.angle(inner[1].direction * np.conj(local[1].direction))
        offset = self.across(0, inner[0], local[0]) - self.across(1, inner[1], local[1])
        return {"a": self.pin(0), "guide": self.guide(1), "angle": turn, "offset": offset}

    def differences(self, found: Any) -> Iterator[tuple[Any, Any]]:
        """What the routine found beside what `solve` did: the links' rates, and a place of each, found or given."""
        for name, line in zip(self.links, (found.first, found.second), strict=True):
            own = self.motion.links[name]
            yield line.angular_velocity, own.angular_velocity
            yield line.angular_acceleration, own.angular_acceleration
        if self.inner[0].direction is None:
            yield from same_point(found.inner, self.motion.links[self.links[0]].at(self.inner[0].point))
        if self.group.name == "RPP":
            yield from same_point(found.second.point, self.motion.links[self.links[1]].at(self.local[1].point))
        if self.group.name == "RPR":
            turn = np.exp(1j * self.motion.links[self.links[0]].angle) * self.inner[0].direction
            yield np.exp(1j * found.first.angle), turn


def signs(values: Any) -> Any:
    return np.where(values < 0, -1, 1)


def same_point(found: Any, own: Any) -> Iterator[tuple[Any, Any]]:
    yield found.position, own.position
    yield found.velocity, own.velocity
    yield found.acceleration, own.acceleration


def dyads_of(motion: ck.results.Motion) -> list[Read]:
    """The dyads of a motion whose bodies are single links."""
    groups = [group for group in motion.structure.groups if group.name in ROUTINES]
    return [Read(motion, group) for group in groups if all(len(body.links) == 1 for body in group.bodies)]


@cache
def over_the_catalog() -> list[tuple[str, Read]]:
    """The dyads of all shipped mechanisms, drivers moving and speeding up."""
    found = []
    for name in catalog.NAMES:
        if any(group.name in ROUTINES for group in catalog.structure(name).groups):
            # a driver with a law has its own speed
            drives = {drive.name: 1.0 for drive in catalog.mechanism(name).drives if drive.law is None}
            motion = ck.solve(catalog.structure(name), speed=drives, acceleration=dict.fromkeys(drives, 0.5))
            found += [(name, one) for one in dyads_of(motion)]
    return found


def worst(one: Read) -> float:
    """The greatest difference of a dyad from `solve`, times the margin, in parts of the largest of each."""
    given = one.given()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
        found = ROUTINES[one.group.name](**given)
    assert np.array_equal(found.assembled, one.motion.assembled)
    regular = one.motion.regular.reshape(one.motion.shape)
    weight = np.where(regular, np.clip(found.margin, 0.0, 1.0), 0.0)
    assert weight.max() > 0.001
    gaps = [np.nan_to_num(np.abs(a - b)) * weight / (np.max(np.abs(b[regular])) + 1.0)
            for a, b in one.differences(found)]  # fmt: skip
    return float(np.max(gaps))


def test_agrees_with_solve_over_the_catalog() -> None:
    found = {f"{name}: {one.group.links}": worst(one) for name, one in over_the_catalog()}
    assert len(found) > 90
    assert max(found.values()) < AGREE, {name: gap for name, gap in found.items() if gap >= AGREE}


@pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")
@pytest.mark.parametrize("kind", DYADS)
def test_agrees_with_solve_over_designs_and_poses(kind: str) -> None:
    """Random dyads on a crank and the frame, also with guides that turn; five designs, eleven poses."""
    count = 0
    for seed in range(12):
        rng = np.random.default_rng(seed)
        sketch = random_sketch(rng, (kind,), multiple=0.0)
        values = drawn_values(sketch.mechanism())
        mechanism = sketch.mechanism(lambda p, rng=rng: p + 0.05 * rng.standard_normal((5, 1)))  # type: ignore[misc]
        name, value = next(iter(values.items()))
        near = {name: value + np.linspace(-0.2, 0.2, 11)}
        motion = ck.solve(mechanism, near, speed=2.0, acceleration=-1.0)
        for one in dyads_of(motion):
            assert motion.shape == (5, 11)
            assert worst(one) < AGREE
            count += 1
    assert count >= 10


# --- with the textbook's own equations ----------------------------------------------------------------------


@dataclass
class Rates:
    """A moving point or line of random numbers, and the same as the routines take it."""

    rng: np.random.Generator
    count: int = 60

    def __post_init__(self) -> None:
        x = self.rng.uniform(-2, 2, (6, self.count))
        self.r, self.v, self.a = x[:3] + 1j * x[3:]
        self.angle, self.w, self.alpha = self.rng.uniform(-2, 2, (3, self.count))
        self.point = dyads.MovingPoint(self.r, self.v, self.a)
        self.line = dyads.MovingLine(self.point, self.angle, self.w, self.alpha)
        self.t = np.exp(1j * self.angle)

    def turned(self, by: float) -> Rates:
        """The line through the same point, at another angle."""
        other = Rates(self.rng, self.count)
        other.r, other.v, other.a, other.w, other.alpha = self.r, self.v, self.a, self.w, self.alpha
        other.t = self.t * np.exp(1j * by)
        return other


def scalar(a: Any, b: Any) -> Any:
    return a.real * b.real + a.imag * b.imag


def crossing(rows: list[tuple[Any, Any]]) -> Any:
    """The vector with two given scalar products, by Cramer's rule: rows are (vector, product)."""
    (p, f), (q, g) = rows
    det = p.real * q.imag - p.imag * q.real
    return ((f * q.imag - g * p.imag) + 1j * (g * p.real - f * q.real)) / det


def circle_rows(c: Any, v: Any, about: Rates) -> list[tuple[Any, Any]]:
    """The rows of velocity and acceleration of a point at a fixed distance: |c - a| is constant."""
    return [(c - about.r, scalar(c - about.r, about.v)),
            (c - about.r, scalar(c - about.r, about.a) - np.abs(v - about.v) ** 2)]  # fmt: skip


def line_rows(c: Any, v: Any, line: Rates) -> list[tuple[Any, Any]]:
    """The rows of a point at a fixed distance beside a turning line: n (c - g) is constant, n' = -w t."""
    n, way, rate = 1j * line.t, c - line.r, v - line.v
    first = scalar(n, line.v) + line.w * scalar(line.t, way)
    turning = 2 * line.w * scalar(line.t, rate) + line.alpha * scalar(line.t, way) + line.w**2 * scalar(n, way)
    return [(n, first), (n, scalar(n, line.a) + turning)]


def check(point: Any, c: Any, rows: Callable[[Any], list[list[tuple[Any, Any]]]], good: Any) -> None:
    """A point found against its place, and its velocity and acceleration by two equations each."""
    v = crossing([one[0] for one in rows(np.zeros_like(c))])
    a = crossing([one[1] for one in rows(v)])
    for found, own in ((point.position, c), (point.velocity, v), (point.acceleration, a)):
        assert np.max(np.abs(found - own)[good] / (1 + np.abs(own[good]))) < 1e-10


@pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")
@settings(max_examples=5)
@given(seed=SEEDS, mode=st.sampled_from([1, -1]))
def test_agrees_with_the_law_of_cosines_and_linear_equations(seed: int, mode: int) -> None:
    """Positions by trigonometry, rates by the projections of the velocity and acceleration equations."""
    rng = np.random.default_rng(seed)
    a, b, g, h = (Rates(rng) for _ in range(4))
    r1, r2, e = rng.uniform(1, 3), rng.uniform(1, 3), rng.uniform(-0.5, 0.5)
    with np.errstate(all="ignore"):
        found = dyads.rrr(a.point, b.point, r1, r2, mode)
        d = np.abs(b.r - a.r)
        c = a.r + r1 * np.exp(1j * (np.angle(b.r - a.r) - mode * np.arccos((d**2 + r1**2 - r2**2) / (2 * d * r1))))
        check(found.inner, c, lambda v: [circle_rows(c, v, a), circle_rows(c, v, b)], found.margin > 0.05)

        found = dyads.rrp(a.point, g.line, r1, e, mode)
        foot = scalar(1j * g.t, a.r - g.r)
        s = scalar(g.t, a.r - g.r) + mode * np.sqrt(r1**2 - (foot - e) ** 2)
        c = g.r + g.t * s + 1j * g.t * e
        check(found.inner, c, lambda v: [circle_rows(c, v, a), line_rows(c, v, g)], found.margin > 0.05)
        assert np.allclose(found.travels[0].value, np.where(found.assembled, s, np.nan), equal_nan=True)

        found = dyads.prp(g.line, h.line, e, -e)
        c = crossing([(1j * g.t, scalar(1j * g.t, g.r) + e), (1j * h.t, scalar(1j * h.t, h.r) - e)])
        check(found.inner, c, lambda v: [line_rows(c, v, g), line_rows(c, v, h)], found.margin > 0.2)

        found = dyads.rpp(a.point, g.line, 1.2, e)
        own, across = g.turned(0.0), g.turned(1.2)
        across.r, across.v, across.a = a.r, a.v, a.a
        c = crossing([(1j * g.t, scalar(1j * g.t, g.r)), (1j * across.t, scalar(1j * across.t, a.r) - e)])
        check(found.second.point, c, lambda v: [line_rows(c, v, own), line_rows(c, v, across)], found.assembled)


@pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")
@settings(max_examples=5)
@given(seed=SEEDS, mode=st.sampled_from([1, -1]))
def test_a_guide_turns_as_the_sine_of_its_eccentricity_says(seed: int, mode: int) -> None:
    rng = np.random.default_rng(seed)
    a, b, e = Rates(rng), Rates(rng), rng.uniform(-1, 1)
    found = dyads.rpr(a.point, b.point, e, mode)
    way, rate, second = b.r - a.r, b.v - a.v, b.a - a.a
    with np.errstate(all="ignore"):
        inside = np.arcsin(e / np.abs(way))
        t = np.exp(1j * (np.angle(way) - (inside if mode > 0 else np.pi - inside)))
        s = scalar(t, way)
        w = scalar(1j * t, rate) / s
        alpha = (scalar(1j * t, second) - 2 * w * scalar(t, rate) - w**2 * e) / s  # of n (b - a) = e, twice
    good = found.margin > 0.05
    for got, own in ((np.exp(1j * found.first.angle), t), (found.first.angular_velocity, w),
                     (found.first.angular_acceleration, alpha), (found.travels[0].value, s),
                     (found.travels[0].rate, scalar(t, rate) + w * scalar(1j * t, way))):  # fmt: skip
        assert np.max((np.abs(got - own) / (1 + np.abs(own)))[good]) < 1e-10


def test_points_of_a_link_and_lines_through_them_undo_each_other() -> None:
    """By v + omega x r and a + alpha x r - omega^2 r, and back from two points."""
    one = Rates(np.random.default_rng(3))
    far = dyads.link(one.line, 2.0, -0.5)
    arm = one.t * (2.0 - 0.5j)
    assert np.allclose(far.velocity, one.v + 1j * one.w * arm, atol=1e-13)
    assert np.allclose(far.acceleration, one.a + 1j * one.alpha * arm - one.w**2 * arm, atol=1e-13)
    line = dyads.line_through(one.point, far)
    assert np.allclose(np.exp(1j * line.angle), arm / np.abs(arm), atol=1e-13)
    assert np.allclose(line.angular_velocity, one.w, atol=1e-13)
    assert np.allclose(line.angular_acceleration, one.alpha, atol=1e-13)


# --- what is wrong ------------------------------------------------------------------------------------------


def test_poses_that_cannot_be_assembled_are_masked_and_told_once() -> None:
    b = np.array([6.0, 12.0, 3.0]) + 0j
    with pytest.warns(
        ck.errors.UnassembledPoses, match=r"RRR: 1 of 3 .* \|AB\| = 12 > \|AC\| \+ \|CB\| = 5 \+ 5 at 1;"
    ) as told:
        found = dyads.rrr((0, 0), b, 5.0, 5.0)
    assert len(told) == 1
    assert found.assembled.tolist() == [True, False, True]
    assert np.array_equal(np.isnan(found.inner.velocity), ~found.assembled)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        chained = dyads.rrr(found.inner, (0, -9), 9.0, 9.0)  # what is not known is told no second time
    assert chained.assembled.tolist() == [True, False, True]


def test_a_pose_alone_that_cannot_be_assembled_is_an_error() -> None:
    lines = dyads.MovingLine((0, 0), 0.0), dyads.MovingLine((0, 1), 0.0)
    calls: tuple[tuple[Callable[[], Any], str], ...] = (
        (lambda: dyads.rrr((0, 0), (12, 0), 5, 5), r"\|AB\| = 12 > "),
        (lambda: dyads.rrr((0, 0), (0, 0), 5, 5), "A and B coincide"),
        (lambda: dyads.rrp((0, 3), lines[0], 2), r"A is 3 from the line on which C runs > \|AC\| = 2"),
        (lambda: dyads.rpr((0, 0), (1, 0), 2), r"\|AB\| = 1 < 2"),
        (lambda: dyads.rpr((5, 5), (5, 5)), "coincide"),
        (lambda: dyads.prp(*lines), "parallel"),
        (lambda: dyads.rpp((0, 0), lines[0], 0.0), "parallel"),
        (lambda: dyads.rrr((0, 0), np.array([12, 13j]), 5, 5), "2 of 2 poses"),
    )
    for call, why in calls:
        with pytest.raises(ck.errors.NotAssembled, match=why):
            call()


def test_what_does_not_fit_is_refused_by_its_name() -> None:
    line, nothing = dyads.MovingLine((0, 0), 0.0), cast("Any", (0, 0))
    calls: tuple[tuple[Callable[[], Any], str], ...] = (
        (lambda: dyads.rrr((0, 0), (6, 0), 0, 5), "first_length: 0 is no length"),
        (lambda: dyads.rrr((0, 0), (6, 0), 5, [5, -1]), "second_length: -1 is no length"),
        (lambda: dyads.rrr((0, 0), (6, 0), 5, 5, mode=2), "mode: a mode is"),
        (lambda: dyads.rrr((0, 0), (6, 0), [5, 5], [5, 5, 5]), r"shapes: .*first_length \(2,\), second_length \(3,\)"),
        (lambda: dyads.rrr("A", (6, 0), 5, 5), "a: .*MovingPoint"),
        (lambda: dyads.rrr((0, 0), (np.nan, 0), 5, 5), "NaN at every pose"),
        (lambda: dyads.rrp((0, 0), line, 1, offset=np.inf), "offset: it is not finite"),
        (lambda: dyads.MovingPoint((np.inf, 0)), "position: .* infinite"),
        (lambda: dyads.MovingPoint(np.zeros(2), np.zeros(3)), "shapes: "),
        (lambda: dyads.MovingLine((0, 0), np.zeros(2), np.zeros(3)), "shapes: "),
        (lambda: dyads.line_through((1, 1), (1, 1)), "b: a and b coincide"),
        (lambda: dyads.link(nothing, 1.0), "line: .*moving line"),
        (lambda: dyads.rrp((0, 0), nothing, 1.0), "guide: "),
    )
    for call, where in calls:
        with pytest.raises(ck.errors.InvalidInput, match=where):
            call()


def test_numbers_give_numbers_and_arrays_broadcast() -> None:
    alone = dyads.rrr((0, 0), (6, 0), 5, 5)
    assert (type(alone.inner.position), type(alone.assembled), type(alone.margin)) == (complex, bool, float)
    many = dyads.rrr((0, 0), np.array([6, 5, 4]) + 0j, np.array([[5.0], [4.0]]), 5, np.array([[1], [-1]]))
    assert many.inner.position.shape == many.second.angle.shape == many.assembled.shape == (2, 3)
    assert many.inner.position[0, 0] == alone.inner.position
    assert repr(many).startswith("SolvedDyad(inner=")
