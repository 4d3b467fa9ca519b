"""Courses with one peak or two: found among samples and refined between them, by compiled programs of a few steps.

Of most courses one peak may be the greatest value, or two, as at the ends of a cycle. What `base/extremes` does for
those is straight-line arithmetic, the same for every design. NumPy passes over arrays some hundred times for it, and at
each pass threads wait for each other.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, partial
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.extremes import (
    ALIKE,
    AT_ENDS,
    AT_FINE,
    DERIVATIVES,
    FINE,
    FIT,
    INNER,
    MOST_ADDED,
    NEWTON,
    POLE,
    ROUNDING,
    SAMPLES,
    SLOPE_OF_ERROR,
    SLOPE_OF_ROUNDING,
    SLOPES,
    SUMS,
    TRUSTED,
    ZERO,
    Windows,
)
from compoundkin.programs.backends import runner_of
from compoundkin.programs.backends.runner import THREAD_TURNS
from compoundkin.programs.call_numbers import CallNumbers, ReadyProgram
from compoundkin.programs.graph.flat_program import BY_BOTH, BY_DESIGN, BY_POSE, FIXED_NUMBER, flat_program
from compoundkin.programs.graph.operation_graph import PARAMETER, TOTAL, InputNumber, OperationGraph
from compoundkin.programs.recording.recorded_number import RecordedNumber


class PeakCount(NamedTuple):
    """How many samples of courses may be next to an extreme, and the first and last of their numbers, (designs,)."""

    count: Number
    first: Number
    last: Number


class SampledBest(NamedTuple):
    """The greatest samples of courses times their `sign`, the `least` ones so too, and the places of the greatest.

    All are (n,).
    """

    value: Number
    least: Number
    place: Number
    sign: Number

    def some(self, index: Number) -> SampledBest:
        """Return some of them by index, in order."""
        return self if len(index) == len(self.value) else SampledBest(*(each.take(index) for each in self))


class Vertices(NamedTuple):
    """The vertices of courses in windows, (n,).

    `place` is where each is, between `low` and `high` is the polynomial there, times the sign. `is_inside` tells
    whether it is within the window, `is_right` whether the polynomial is trusted, `is_narrowed` whether the window was
    narrowed: to the places `before` and `after` of the samples beside the greatest one. `value` is that of the course.
    """

    place: Number
    low: Number
    high: Number
    is_inside: Number
    is_right: Number
    before: Number
    after: Number
    is_narrowed: Number
    value: Number

    def some(self, part: Any) -> Vertices:
        """Return some of them, by index or slice."""
        return Vertices(*(each[part] for each in self))


@dataclass(frozen=True)
class CoursePrograms:
    """The programs of a back end, for courses or, where these are lengths, their squares."""

    squared: bool
    backend: str | None

    def counted_peaks(self, course: Number, high: Number, low: Number) -> dict[float, PeakCount]:
        """Count samples of courses (designs, three or more) next to which their greatest values, the sign 1, may be.

        Those next to the least values have the sign -1. No neighbour of theirs is beyond, and the bend is large enough.
        `high` and `low` (designs,) are the greatest and least samples.
        """
        inner, last = course.shape[1] - 2, course.shape[1] - 1
        inputs = {name: course[:, k : k + inner] for k, name in enumerate(SIDES)}
        inputs |= {
            name: course[:, k] for name, k in zip(FIRST + LAST, (0, 1, 2, last - 2, last - 1, last), strict=True)
        }
        inputs |= {"high": high, "low": low, "number": np.arange(1.0, last)[None], "end": np.full((1, 1), float(last))}
        found = _computed(self._counting, inputs, inner)
        return {1.0: PeakCount(*found[:3]), -1.0: PeakCount(*found[3:])}

    def vertices(self, windows: Windows, best: SampledBest) -> Vertices:
        """Return the vertices of courses in windows; their values are not known yet."""
        inputs = {name: windows.values[:, k] for k, name in enumerate(SAMPLED)}
        inputs |= {"low": windows.low, "high": windows.high, **best._asdict()}
        return Vertices(*_computed(self._refining, inputs), *np.zeros((2, len(windows.low))))

    def best_of_few(self, best: SampledBest, found: Sequence[Vertices], last: float) -> list[Number]:
        """Return the greatest of samples and of one or two vertices, times the sign, its place, whether it is far.

        The second vertices come after the first; `last` is the last place of all. Of equally high peaks, and of values
        that differ by rounding, the first is taken. What is far beyond all samples of one sign may be infinite.
        """
        inputs = {f"{name} {k}": each for k, one in enumerate(found) for name, each in one._asdict().items()}
        inputs |= best._asdict() | {"last": np.full((1, 1), last)}
        return _computed(self._choosing_of_two if len(found) > 1 else self._choosing, inputs)

    @cached_property
    def _counting(self) -> ReadyProgram[int]:
        strata = dict.fromkeys(SIDES, BY_BOTH) | _by_design(*FIRST, *LAST, "high", "low")
        return _program({**strata, "number": BY_POSE, "end": FIXED_NUMBER}, _counts, self.backend)

    @cached_property
    def _refining(self) -> ReadyProgram[int]:
        names = _by_design(*SAMPLED, "low", "high", *SampledBest._fields)
        return _program(names, partial(_refined, self.squared), self.backend)

    @cached_property
    def _choosing(self) -> ReadyProgram[int]:
        return self._chosen(1)

    @cached_property
    def _choosing_of_two(self) -> ReadyProgram[int]:
        return self._chosen(2)

    def _chosen(self, vertices: int) -> ReadyProgram[int]:
        names = [f"{name} {k}" for k in range(vertices) for name in Vertices._fields]
        strata = {**_by_design(*SampledBest._fields, *names), "last": FIXED_NUMBER}
        return _program(strata, partial(_first_of_best, self.squared, vertices), self.backend)


# The back end whose programs take less time than NumPy's passes over arrays.
COMPILES = "llvm"


@cache
def course_programs(squared: bool, backend: str) -> CoursePrograms | None:
    """Return the programs for courses or their squares, made once; None of a back end that does not compile."""
    return CoursePrograms(squared, backend) if backend == COMPILES else None


# The inputs of programs by name: samples with those beside them, those at both ends, and those of a window.
SIDES = ("before", "own", "after")
FIRST, LAST = (tuple(f"{end} {k}" for k in range(3)) for end in ("first", "last"))
SAMPLED = tuple(f"sample {k}" for k in range(INNER + 2))
Inputs = Mapping[str, Any]


def _computed(program: ReadyProgram[int], inputs: Mapping[str, Number], poses: int = 1) -> list[Number]:
    """Return the results of a program, (designs,) each; inputs are such too, or have poses."""
    given = {_input(name): each if each.ndim > 1 else each[:, None] for name, each in inputs.items()}
    shape = max(len(each) for each in given.values()), poses
    numbers = CallNumbers(given, shape, frozenset())
    with THREAD_TURNS.left():
        found = program.run(numbers)
    return [np.ravel(each) for each in found.values()]


def _input(name: str) -> InputNumber:
    return InputNumber(PARAMETER, name)


def _program(
    strata: Mapping[str, int], record: Callable[[Inputs], Sequence[Any]], backend: str | None
) -> ReadyProgram[int]:
    """Return the program of what is recorded from inputs, which vary as their strata say."""
    graph = OperationGraph()
    inputs = {name: RecordedNumber.given(graph, _input(name)) for name in strata}
    with np.errstate(all="ignore"):
        nodes = [number.x for number in record(inputs)]
    flat = flat_program(graph, nodes, {_input(name): stratum for name, stratum in strata.items()})
    return ReadyProgram(flat, runner_of(flat, backend), {k: (node,) for k, node in enumerate(nodes)})


def _by_design(*names: str) -> dict[str, int]:
    return dict.fromkeys(names, BY_DESIGN)


def _counts(at: Inputs) -> list[Any]:
    """Record how many samples may be next to the greatest value, the first and the last; then next to the least."""
    found = []
    for sign, best in ((1.0, at["high"]), (-1.0, at["low"])):
        inner, first, last = (_may_be_next(sign, best, *(at[name] for name in names)) for names in (SIDES, FIRST, LAST))
        count, total, squares = (
            _total(np.where(inner[1], own, 0.0)) + np.where(first[0], begin, 0.0) + np.where(last[2], end, 0.0)
            for own, begin, end in (
                (1.0, 1.0, 1.0), (at["number"], 0.0, at["end"]), (at["number"] ** 2, 0.0, at["end"] ** 2),
            )
        )  # fmt: skip
        # two numbers are known by their sum and the sum of their squares
        apart = np.where(count > 1.0, np.sqrt(np.maximum(2.0 * squares - total**2, 0.0)), 0.0)
        half = np.where(count > 1.0, 0.5, 1.0)
        found += [count, half * (total - apart), half * (total + apart)]
    return found


def _total(number: Any) -> Any:
    return number.of(TOTAL, number.x)


def _may_be_next(sign: float, best: Any, before: Any, own: Any, after: Any) -> tuple[Any, Any, Any]:
    """Record whether the greatest value, or the least with the sign -1, may be next to three samples in a row.

    The first and the last are ends, to which the bend between stands for theirs.
    """
    rise, fall = sign * (own - before), sign * (after - own)
    added = MOST_ADDED * np.abs(fall - rise)
    bends = added > ROUNDING * np.abs(best)
    rises, falls = rise >= 0.0, fall <= 0.0
    begin, middle, end = (bends & (added >= sign * (best - one)) for one in (before, own, after))
    return begin & (rise <= 0.0), middle & rises & falls, end & (fall >= 0.0)


def _refined(squared: bool, at: Inputs) -> list[Any]:
    """Record the first fields of `Vertices`."""
    smooth = [at["sign"] * (at[name] * at[name] if squared else at[name]) for name in SAMPLED]
    largest = _largest(at)
    inside, height, off, is_right = _vertex(smooth, ROUNDING * (largest * largest if squared else largest))
    place, before, after = (_place(at, each) for each in (inside, *_beside_greatest(smooth)))
    heights = [height - off, height + off]
    if squared:
        heights = [at["sign"] * np.sqrt(np.maximum(at["sign"] * each, 0.0)) for each in heights]
    shown = np.where(is_right, place, at["low"])
    return [shown, *heights, _number(np.abs(inside) < 1.0), _number(is_right), before, after]


def _largest(at: Inputs) -> Any:
    return np.maximum(np.abs(at["value"]), np.abs(at["least"]))


def _place(at: Inputs, inside: Any) -> Any:
    """Record a place in a window from -1 to 1 as one from low to high."""
    low, high = at["low"], at["high"]
    return np.where(inside >= 1.0, high, low + (1.0 + inside) * 0.5 * (high - low))


def _beside_greatest(samples: Sequence[Any]) -> tuple[Any, Any]:
    """Record where in a window, from -1 to 1, the samples beside the greatest one are."""
    top, before, after = samples[0].like(-np.inf), samples[0].like(-1.0), samples[0].like(1.0)
    for k, one in enumerate(samples):
        is_higher = one > top
        before = np.where(is_higher, SAMPLES[max(k - 1, 0)], before)
        after = np.where(is_higher, SAMPLES[min(k + 1, len(SAMPLES) - 1)], after)
        top = np.fmax(top, one)
    return before, after


def _number(truth: Any) -> Any:
    return np.where(truth, 1.0, 0.0)


def _vertex(samples: Sequence[Any], rounding: Any) -> tuple[Any, Any, Any, Any]:
    """Record where the polynomial through samples is greatest, from -1 to 1, and its value there.

    Besides by how much it may be off, and whether it is trusted. So does `Windows.vertices` with arrays. What varies by
    no more than rounding is greatest from the beginning.
    """
    c = _products(samples[1:-1], FIT)
    sizes = [np.abs(one) for one in c]
    (varies,) = _products(sizes, SUMS[:, :1])
    at_ends = [np.abs(one - end) for one, end in zip(_products(c, AT_ENDS), (samples[0], samples[-1]), strict=True)]
    # what is without limit at an end tells nothing
    at_ends = [np.where(off < np.inf, off, 0.0) for off in at_ends]
    off = np.maximum(np.maximum(*at_ends), sizes[-1])
    is_right = off <= TRUSTED * varies + rounding
    spacing = FINE[1] - FINE[0]
    start = _finest(c)
    low, high = np.maximum(start - spacing, -1.0), np.minimum(start + spacing, 1.0)
    rates = [_products(c, DERIVATIVES[:, k].T) for k in range(2)]
    t = start
    for _ in range(NEWTON):
        slope, bend = (_chebyshev(t, rate) for rate in rates)
        step = slope / bend
        # where there is no step it stays
        step = np.where(np.abs(step) < np.inf, step, 0.0)
        t = np.minimum(np.maximum(t - step, low), high)
    # a curve that runs into a plateau is level at the end, as nearly as the polynomial tells it
    slopes, is_first = _products(c, SLOPES.T), t < 0.0
    slope, off_there = np.abs(np.where(is_first, slopes[1], slopes[0])), np.where(is_first, *at_ends)
    most = sizes[0]
    for size in sizes[1:]:
        most = np.maximum(most, size)
    level = slope <= SLOPE_OF_ERROR * off_there + SLOPE_OF_ROUNDING * most
    outer = np.abs(start) >= 1.0 - 1.5 * spacing
    t = np.where(level & outer, np.where(is_first, -1.0, 1.0), t)
    t = np.where(varies <= rounding, -1.0, t)
    return t, _chebyshev(t, c), off, is_right


def _finest(c: Sequence[Any]) -> Any:
    """Record where among `FINE` a polynomial is greatest, at first."""
    middle, sides = len(FINE) // 2, []
    for k in range(middle + 1):
        # even polynomials are the same on both sides of the middle, odd ones have the other sign
        even, odd = (_products(c[part::2], AT_FINE[part::2, k : k + 1])[0] for part in (0, 1))
        sides.append((even + odd, even - odd))
    (low, high), left, right = sides[0], FINE[0], FINE[-1]
    for k, (here, there) in enumerate(sides[1:], 1):
        left, low = np.where(here > low, FINE[k], left), np.maximum(low, here)
        if k < middle:
            right, high = np.where(there >= high, FINE[-1 - k], right), np.maximum(high, there)
    return np.where(high > low, right, left)


def _products(numbers: Sequence[Any], weights: Number) -> list[Any]:
    """Record numbers times a matrix (numbers, results)."""
    found = []
    for column in weights.T.tolist():
        total: Any = 0.0
        for number, weight in zip(numbers, column, strict=True):
            total = total + number * weight if weight else total
        found.append(total)
    return found


def _chebyshev(t: Any, c: Sequence[Any]) -> Any:
    """Record Chebyshev polynomials at a place (C. W. Clenshaw, 1955)."""
    twice, last, before = 2.0 * t, c[-1], c[-2]
    for one in c[-3::-1]:
        last, before = last * twice + before, one - last
    return last * t + before


def _counts_too(one: Any, other: Any, at: Inputs) -> Any:
    """Record whether a vertex counts beside one before it: not where both are equally high peaks."""
    best: Any = np.fmax(np.fmax(at["value"], one.low), other.low)
    alike = ALIKE * (at["value"] - at["least"]) + ROUNDING * _largest(at)
    # a vertex just before the end of a cycle is beside its beginning
    is_beside = (other.place <= one.place + 1.0) | ((one.place == 0.0) & (other.place >= at["last"] - 1.0))
    return is_beside | (other.high - other.low > alike) | ~(one.high >= best - alike)


def _first_of_best(squared: bool, vertices: int, at: Inputs) -> list[Any]:
    """Record the greatest of a sample and of vertices, and where it is first taken, as `best_of` finds it."""
    found: list[Any] = [Vertices(*(at[f"{name} {k}"] for name in Vertices._fields)) for k in range(vertices)]
    values = [at["sign"] * one.value for one in found]
    if vertices > 1:
        values[1] = np.where(_counts_too(found[0], found[1], at), values[1], -np.inf)
    top: Any = at["value"]
    for value in values:
        top = np.fmax(top, value)
    largest = _largest(at)
    enough = top - largest * (np.where(np.abs(top) <= ZERO * largest, ZERO, ROUNDING) if squared else ROUNDING)
    place: Any = np.where(at["value"] >= enough, at["place"], np.inf)
    inside: Any = place.like(np.inf)
    for one, value in zip(found, values, strict=True):
        place = np.minimum(place, np.where(value >= enough, one.place, np.inf))
        inside = np.minimum(inside, np.where((value >= enough) & (one.is_inside > 0.0), one.place, np.inf))
    # just before a vertex values differ from its own by rounding
    place = np.where((inside > place) & (inside <= place + 0.5), inside, place)
    return [top, place, _number(top > POLE * np.maximum(np.maximum(at["least"], -at["value"]), 0.0))]
