"""The method of Dormand and Prince of order 8 for one coordinate, in plain numbers.

A step of a table takes microseconds, while a call of an array library takes one: the stages are written out as
straight-line arithmetic from the coefficients that SciPy has.

Source: E. Hairer, S. P. Norsett and G. Wanner, Solving Ordinary Differential Equations I, 2nd ed., Springer 1993,
sections II.4 (first step), II.5 (the method) and II.6 (the state in between).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import count
from math import inf, isfinite, nextafter, sqrt
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number

# The acceleration and the power at a time, a value and its speed.
PlainRates = Callable[[float, float, float], tuple[float, float]]
# Steps change by these factors; the error of a step is of the order 8.
SAFETY, LEAST, MOST, ORDER = 0.9, 0.2, 10.0, 8.0
# Stages of a step, with those that the state in between needs as well, and their coefficients of interpolation.
STAGES, ALL_STAGES, BETWEEN = 12, 16, 7


def _sum(row: Sequence[float], letter: str) -> str:
    """Return a sum of stages as source text, without those of no weight."""
    return " + ".join(f"{c!r} * {letter}{k}" for k, c in enumerate(row) if c) or "0.0"


@cache
def _written_out() -> Callable[..., tuple[Any, ...]]:
    """Return the function of a step: the next state with its rates, the errors, and all stages."""
    from scipy.integrate import DOP853

    rows = [*DOP853.A[1:].tolist(), DOP853.B.tolist(), *DOP853.A_EXTRA.tolist()]
    places = [*DOP853.C[1:].tolist(), 1.0, *DOP853.C_EXTRA.tolist()]
    lines = ["def step(rates, t, h, q, w, a0, p0):", " w0 = w"]
    for k, (row, place) in enumerate(zip(rows, places, strict=True), 1):
        row = row[:k]
        lines += [f" w{k} = w + h * ({_sum(row, 'a')})", f" q{k} = q + h * ({_sum(row, 'w')})"]
        lines += [f" a{k}, p{k} = rates(t + {place!r} * h, q{k}, w{k})"]
    names = [f"{letter}{k}" for letter in "wap" for k in range(ALL_STAGES)]
    errors = [_sum(row.tolist(), letter) for row in (DOP853.E5, DOP853.E3) for letter in "wap"]
    work = f"h * ({_sum(DOP853.B.tolist(), 'p')})"
    end = f"q{STAGES}, w{STAGES}, {work}, a{STAGES}, p{STAGES}"
    lines += [f" return {end}, ({', '.join(errors)}), ({', '.join(names)})"]
    found: dict[str, Any] = {}
    exec("\n".join(lines), found)  # coefficients and letters alone
    written: Callable[..., tuple[Any, ...]] = found["step"]
    return written


@dataclass(eq=False)
class PlainStep:
    """A step as a function of time: states at times in it, in columns."""

    first: float
    length: float
    begin: tuple[float, float, float]
    end: tuple[float, float, float]
    stages: tuple[float, ...]

    @cached_property
    def polynomial(self) -> Number:
        """The coefficients of the value, the speed and the work."""
        return polynomials([self])[0]

    def __call__(self, times: Any) -> Number:
        """Return the states."""
        x = (np.atleast_1d(times) - self.first) / self.length
        found = between(self.polynomial[None], np.array(self.begin)[None], x)
        return found if np.ndim(times) else found[:, 0]


def polynomials(steps: Sequence[PlainStep]) -> Number:
    """Return the coefficients of steps, (steps, 7, 3)."""
    stages = np.array([one.stages for one in steps]).reshape(len(steps), 3, ALL_STAGES)
    h = np.array([one.length for one in steps])[:, None]
    change = np.array([one.end for one in steps]) - np.array([one.begin for one in steps])
    found = np.empty((len(steps), BETWEEN, 3))
    found[:, 0], found[:, 1] = change, h * stages[:, :, 0] - change
    found[:, 2] = 2.0 * change - h * (stages[:, :, STAGES] + stages[:, :, 0])
    found[:, 3:] = h[:, :, None] * (_weights() @ stages.transpose(0, 2, 1))
    return found


def states_between(steps: Sequence[PlainStep], index: Number, times: Number) -> Number:
    """Return the states at times, each in the step of its index, in columns."""
    firsts, lengths = (np.array(row) for row in zip(*((one.first, one.length) for one in steps), strict=True))
    begins = np.array([one.begin for one in steps])
    return between(polynomials(steps)[index], begins[index], (times - firsts[index]) / lengths[index])


@cache
def _weights() -> Number:
    from scipy.integrate import DOP853

    found: Number = DOP853.D
    return found


def between(coefficients: Number, begins: Number, x: Number) -> Number:
    """Return states at parts of steps, in columns; there is one row of coefficients for each of them, or for all."""
    found = np.zeros((len(x), 3))
    for k in range(BETWEEN):
        found += coefficients[:, BETWEEN - 1 - k]
        found *= (x if k % 2 == 0 else 1.0 - x)[:, None]
    whole: Number = (found + begins).T
    return whole


class PlainSolver:
    """The integrator of one coordinate: `step` makes a step, as SciPy's solvers do."""

    is_implicit = False

    def __init__(
        self, rates: PlainRates, time: float, state: Number, end: float, rtol: float, allowed: Number,
        first_step: float | None = None,
    ) -> None:  # fmt: skip
        self.rates, self.t, self.bound = rates, float(time), float(end)
        self.value, self.speed, self.work = state.tolist()
        self.acceleration, self.power = rates(self.t, self.value, self.speed)
        self.rtol, self.allowed, self.atol = rtol, allowed, allowed
        self.t_old, self.max_step = self.t, inf
        self.step_size: float | None = None
        self.last: PlainStep | None = None
        self.nfev = 1
        self.status = "running" if self.bound > self.t else "finished"
        self.made = _written_out()
        self.h_abs = self._first_step() if first_step is None else first_step

    @property
    def y(self) -> Number:
        """The state."""
        return np.array([self.value, self.speed, self.work])

    @property
    def f(self) -> Number:
        """The rates of the state."""
        return np.array([self.speed, self.acceleration, self.power])

    def dense_output(self) -> PlainStep:
        """Return the last step as a function of time."""
        assert self.last is not None
        return self.last

    def _first_step(self) -> float:
        """Return the first step, by the size of the second derivatives."""
        state, rates = (self.value, self.speed, self.work), (self.speed, self.acceleration, self.power)
        scales = [one + abs(y) * self.rtol for one, y in zip(self.atol.tolist(), state, strict=True)]
        d0, d1 = (_norm(row, scales) for row in (state, rates))
        h0 = 1e-6 if d0 < 1e-5 or d1 < 1e-5 else 0.01 * d0 / d1
        h0 = min(h0, self.bound - self.t)
        if not (isfinite(h0) and h0 > 0.0):
            return self.bound - self.t
        speed = self.speed + h0 * self.acceleration
        acceleration, power = self.rates(self.t + h0, self.value + h0 * self.speed, speed)
        change = (speed - self.speed, acceleration - self.acceleration, power - self.power)
        d2 = _norm(change, scales) / h0
        h1 = max(1e-6, h0 * 1e-3) if max(d1, d2) <= 1e-15 else (0.01 / max(d1, d2)) ** (1.0 / ORDER)
        return min(100.0 * h0, h1, self.bound - self.t)

    def step(self) -> None:
        """Make a step, as long as its error allows; `failed` where it would be shorter than rounding."""
        t, q, w, a, p = self.t, self.value, self.speed, self.acceleration, self.power
        least = 10.0 * (nextafter(t, inf) - t)
        h, rejected = max(least, min(self.h_abs, self.max_step)), False
        for _ in count():
            if h < least:
                self.status = "failed"
                return
            end = min(t + h, self.bound)
            h = end - t
            self.nfev += ALL_STAGES - 1
            q1, w1, work, a1, p1, errors, stages = self.made(self.rates, t, h, q, w, a, p)
            error = self._error(h, (q1, w1, self.work + work), errors)
            if error < 1.0:
                grown = MOST if error == 0.0 else min(MOST, SAFETY * error ** (-1.0 / ORDER))
                self.h_abs = h * (min(1.0, grown) if rejected else grown)
                break
            rejected, factor = True, SAFETY * error ** (-1.0 / ORDER) if isfinite(error) else LEAST
            h *= max(LEAST, factor)
        self.last = PlainStep(t, h, (q, w, self.work), (q1, w1, self.work + work), stages)
        self.t_old, self.t, self.step_size = t, end, h
        self.value, self.speed, self.work, self.acceleration, self.power = q1, w1, self.work + work, a1, p1
        if end >= self.bound:
            self.status = "finished"

    def _error(self, h: float, state: tuple[float, ...], errors: tuple[float, ...]) -> float:
        """Return the error of a step against what is allowed."""
        fifth = third = 0.0
        begin, allowed = (self.value, self.speed, self.work), self.atol.tolist()
        for k in range(3):
            size = allowed[k] + max(abs(begin[k]), abs(state[k])) * self.rtol
            five, three = errors[k] / size, errors[3 + k] / size
            fifth, third = fifth + five * five, third + three * three
        if fifth == third == 0.0:
            return 0.0
        return abs(h) * fifth / sqrt((fifth + 0.01 * third) * 3.0)


def _norm(row: Sequence[float], scales: Sequence[float]) -> float:
    parts = [one / size for one, size in zip(row, scales, strict=True)]
    return sqrt(sum(one * one for one in parts) / len(parts))
