"""The workbench: angles, values at a pose, Newton, continuation and bracketing, against what is known exactly."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator
from threading import Event, Thread
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compoundkin.base.arrays import TURN, Number, column, entry, row, turns_above, unwrapped, whole_turns, wrapped
from compoundkin.base.bracketing import bisect_brackets, false_position, golden_section_minimum, newton_maximum
from compoundkin.base.continuation import (
    StepLengths,
    StepResult,
    correct_in_hyperplane,
    tangent,
    trace_paths,
)
from compoundkin.base.linear import Elimination, one_thread
from compoundkin.base.newton import StoppingRule, gauss_newton, newton
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series, constant

ANGLES = st.floats(-100.0, 100.0)


@given(angle=ANGLES)
def test_a_wrapped_angle_is_the_same_direction_within_half_a_turn(angle: float) -> None:
    found = wrapped(angle)
    assert -np.pi - 1e-14 < found <= np.pi + 1e-14
    assert abs(np.exp(1j * found) - np.exp(1j * angle)) < 1e-13


@given(angle=ANGLES, low=ANGLES)
def test_whole_turns_take_an_angle_next_to_another_or_above_a_border(angle: float, low: float) -> None:
    assert abs(angle - whole_turns(angle)) <= np.pi + 1e-12
    assert -1e-12 <= angle - turns_above(angle, low) - low <= TURN + 1e-12


def test_angles_are_unwrapped_row_by_row_over_gaps() -> None:
    angles = np.array([[3.0, np.nan, -3.0], [0.0, 3.0, -1.0]])
    found = unwrapped(angles)
    assert found[0, 2] == pytest.approx(TURN - 3.0)
    assert np.isnan(found[0, 1])
    assert found[1, 2] == pytest.approx(TURN - 1.0)


@given(steps=st.lists(st.floats(-3.1, 3.1), min_size=1, max_size=60), start=st.floats(-3.0, 3.0))
def test_one_row_is_unwrapped_as_it_was_before_it_was_wrapped(steps: list[float], start: float) -> None:
    angles = np.cumsum([start, *steps])
    found = unwrapped(np.asarray(wrapped(angles)))
    np.testing.assert_allclose(found, angles - angles[0] + wrapped(angles[0]), atol=1e-12)
    np.testing.assert_array_equal(unwrapped(np.array([wrapped(angles)] * 2)), [found, found])


@pytest.mark.parametrize("shape", [(), (4,), (1,), (3, 1), (1, 4), (3, 4), (1, 1)])
def test_an_entry_is_that_of_the_broadcast_array(shape: tuple[int, ...]) -> None:
    value = np.arange(float(np.prod(shape))).reshape(shape)
    for at in np.ndindex(3, 4):
        assert entry(value, at) == np.broadcast_to(value, (3, 4))[at]
    if shape and shape[-1] == 4:
        with pytest.raises(IndexError):
            entry(value, (0, 4))


def test_columns_and_rows_are_those_of_the_broadcast_array() -> None:
    assert column(np.array([[1.0], [2.0]]), 2).tolist() == [1.0, 2.0]
    assert row(np.array([1.0, 2.0]), 2).tolist() == [1.0, 2.0]
    assert column(5.0, 2).tolist() == row(5.0, 2).tolist() == [5.0, 5.0]


def test_one_pose_of_many_has_its_rates_and_its_turns() -> None:
    many = Pose(Series((np.array([[1j, 2j]]), 3.0)), constant(np.array([[1j], [-1j]])), constant(7.0))
    one = many.entry((1, 1))
    assert one.z.c == (2j, 3 + 0j)
    assert one.u.c == (-1j,)
    assert one.theta is not None
    assert one.theta.c == (7.0,)


def cubic(x: Number) -> tuple[Number, Number]:
    """The circle of radius 5 and the line x = y + 1, which meet in (4, 3) and (-3, -4)."""
    a, b = x[..., 0], x[..., 1]
    residual = np.stack([a * a + b * b - 25.0, a - b - 1.0], axis=-1)
    one = np.ones_like(a)
    return residual, np.stack([np.stack([2 * a, 2 * b], axis=-1), np.stack([one, -one], axis=-1)], axis=-2)


def test_newton_finds_the_root_near_every_start_and_reports_the_steps() -> None:
    found = newton(cubic, np.array([[4.5, 3.0], [-3.0, -5.0]]), 1e-9, 20)
    assert found.x == pytest.approx(np.array([[4.0, 3.0], [-3.0, -4.0]]), abs=1e-12)
    assert (found.last <= 1e-9).all()
    assert (found.longest > 0.4).all()


def test_a_singular_start_holds_up_no_other() -> None:
    with np.errstate(all="ignore"):
        found = newton(cubic, np.array([[1.0, -1.0], [4.5, 3.0]]), 1e-9, 20)
    assert np.isnan(found.x[0]).all()
    assert found.x[1] == pytest.approx([4.0, 3.0])


def test_newton_stops_after_its_steps_and_says_how_large_the_last_was() -> None:
    found = newton(cubic, np.array([[40.0, 3.0]]), 1e-9, 2)
    assert found.last[0] > 1.0


def test_newtons_steps_can_be_limited() -> None:
    found = newton(cubic, np.array([[40.0, 30.0]]), 1e-9, 3, limited=lambda step: np.clip(step, -1.0, 1.0))
    assert np.abs(found.x - [[40.0, 30.0]]).max() == 3.0
    assert found.longest[0] == 1.0


REST = StoppingRule(exact=1e-15, rounding=1e-12, longest=0.3, patience=10, gain=0.9)


def least_step(matrix: Number, right: Number) -> Number:
    return np.linalg.lstsq(matrix, right)[0]


def circle(x: Number) -> tuple[Number, Number]:
    return np.array([x @ x - 1.0]), 2.0 * x[None]


def test_least_steps_lead_to_the_nearest_point_and_keep_an_exact_start() -> None:
    found = gauss_newton(circle, least_step, np.array([3.0, 4.0]), 60, REST)
    assert found.x == pytest.approx([0.6, 0.8])
    assert found.steps > 10  # no step is longer than 0.3
    start = np.array([0.6, 0.8])
    kept = gauss_newton(circle, least_step, start, 60, REST)
    assert kept.x is start
    assert kept.steps == 0


def test_least_steps_give_up_where_none_leads_on() -> None:
    def apart(x: Number) -> tuple[Number, Number]:
        return np.array([x @ x + 1.0]), 2.0 * x[None]

    found = gauss_newton(apart, least_step, np.array([3.0, 4.0]), 10**9, REST)
    assert found.residual >= 1.0


def test_paths_have_steps_of_their_own_and_arrive_or_are_given_up() -> None:
    t, tried = np.zeros(3), [0, 0, 0]

    def step(i: Number, h: Number) -> StepResult:
        for k in i:
            tried[k] += 1
        # the second cannot pass a half, the third only in short steps
        good = np.where(i == 1, t[i] + h < 0.5, np.where(i == 2, h < 0.02, True))
        t[i] += np.where(good, h, 0.0)
        return StepResult(h, good, t[i] >= 1.0)

    arrived = trace_paths(step, np.ones(3, dtype=bool), StepLengths(0.1, 0.2, 1e-9, 2, 10_000))
    assert arrived.tolist() == [True, False, True]
    assert t[1] == pytest.approx(0.5, abs=1e-8)
    assert tried[0] < tried[1] < 100 < tried[2] + 50


def test_dead_paths_are_never_stepped() -> None:
    def step(i: Number, h: Number) -> StepResult:
        assert i.tolist() == [1]
        return StepResult(h, h > 0.0, h > 0.0)

    arrived = trace_paths(step, np.array([False, True]), StepLengths(0.1, 0.1, 0.0, 1, 5))
    assert arrived.tolist() == [False, True]


def test_a_path_is_corrected_across_its_tangent() -> None:
    def ring(y: Number) -> tuple[Number, Number]:
        return (y * y).sum(axis=1, keepdims=True) - 1.0, 2.0 * y[:, None]

    y = np.array([[1.0, 0.0]])
    along, side = tangent(ring(y)[1], np.array([[0.0, 1.0]]))
    assert along.tolist() == [[0.0, 1.0]]
    assert side.tolist() == [1.0]
    found = correct_in_hyperplane(ring, y + 0.1 * along, along, 1e-12, 9)
    assert found.x == pytest.approx(np.array([[np.sqrt(0.99), 0.1]]))
    assert found.matrix.shape == (1, 1, 2)


def test_bisection_keeps_the_sides_of_every_bracket() -> None:
    inside, outside = np.array([0.0, 3.0]), np.array([2.0, 1.0])
    first, second = bisect_brackets(lambda x: (x > np.e / 2) == np.array([False, True]), inside, outside, 60)
    assert first == pytest.approx(np.e / 2, abs=1e-15)
    assert (first[0] <= np.e / 2) & (second[0] > np.e / 2)
    assert (first[1] > np.e / 2) & (second[1] <= np.e / 2)
    rough, beyond = bisect_brackets(lambda x: x < np.pi, np.ones(1), np.full(1, 9.0), 60, enough=0.01)
    assert 0.005 < (beyond - rough)[0] <= 0.01 * np.pi


def test_false_position_finds_roots_that_one_end_would_keep_from_moving() -> None:
    high = np.array([1.0, 2.0])

    def f(x: Number) -> Number:
        return x**9 - np.array([0.5, 3.0])

    found = false_position(f, high, f(np.zeros(2)), f(high), 1e-13, 40)
    assert found == pytest.approx(np.array([0.5, 3.0]) ** (1 / 9))


def test_golden_section_leaves_brackets_that_are_not_worth_it() -> None:
    centre = np.array([0.3, 5.0])
    calls = np.zeros(2)

    def f(s: Number, which: Number) -> Number:
        calls[which] += 1
        return (s - centre[which]) ** 2

    place, value = golden_section_minimum(
        f, np.zeros(2), np.ones(2), 50, lambda found, width: (found < 1.0) & (width > 1e-6)
    )
    assert place[0] == pytest.approx(0.3, abs=1e-5)
    assert value[0] < 1e-10
    assert calls[1] == 2 < calls[0]
    assert [
        len(found) for found in golden_section_minimum(f, np.zeros(0), np.zeros(0), 50, lambda found, _: found > 0)
    ] == [0, 0]


def test_the_greatest_value_is_found_between_bounds_or_at_one() -> None:
    def rise(s: Number, which: Number) -> tuple[Number, Number]:
        slope = np.array([1.0, 0.0])[which]
        return slope - s**3, -3.0 * s**2

    low, start, high = np.full(2, -2.0), np.array([-1.9, 1.5]), np.full(2, 2.0)
    assert newton_maximum(rise, (low, start, high), 1e-8, 60) == pytest.approx(np.array([1.0, 0.0]), abs=1e-5)
    assert newton_maximum(rise, (low[:1], low[:1], high[:1] - 1.5), 1e-8, 60) == pytest.approx(0.5)


@pytest.mark.parametrize("size", [1, 2, 3, 4, 6, 9])
def test_elimination_equals_lapack(size):
    rng = np.random.default_rng(size)
    matrices = rng.standard_normal((40, size, size))
    known = (rng.random((size, size)) < 0.3) & ~np.eye(size, dtype=bool)
    matrices[:, known] = rng.integers(-1, 2, (size, size))[known]
    rows = [
        {j: float(matrices[0, i, j]) if known[i, j] else matrices[:, i, j] for j in range(size)} for i in range(size)
    ]
    right = rng.standard_normal((40, size))
    system = Elimination(rows, size)
    found = np.stack(np.broadcast_arrays(*system.times(list(right.T))), axis=-1)
    expected = np.linalg.solve(matrices, right[..., None])[..., 0]
    scale = np.abs(expected).max(axis=-1) * np.linalg.cond(matrices)
    assert (np.abs(found - expected).max(axis=-1) <= 1e-15 * size * scale).all()
    assert np.broadcast_to(system.determinant, 40) == pytest.approx(np.linalg.det(matrices), rel=1e-11)


def test_a_zero_first_pivot_is_no_pivot():
    zero = np.zeros(1)
    system = Elimination([{1: zero + 1.0}, {0: zero, 2: zero + 1.0}, {3: zero + 1.0}, {0: zero + 1.0}], 4)
    assert [float(x[0]) for x in system.times([1.0, 2.0, 3.0, 4.0])] == [4.0, 1.0, 2.0, 3.0]


@pytest.fixture
def threads() -> Iterator[Callable[[], int]]:
    """How many threads NumPy's own OpenBLAS takes, two to begin with: asked of the library itself."""
    library = ctypes.CDLL(getattr(np.linalg, "_umath_linalg").__file__)  # noqa: B009 - a private name
    count, put = (getattr(library, f"scipy_openblas_{word}_num_threads64_", None) for word in ("get", "set"))
    if count is None or put is None:
        pytest.skip("NumPy is linked with another library")
    before = count()
    put(2)
    yield count
    put(before)


def test_it_takes_one_thread_within_and_as_many_as_before_after_an_error(
    threads: Callable[[], int],
) -> None:
    with one_thread:
        assert threads() == 1
        with pytest.raises(ValueError, match="wrong"), one_thread:
            raise ValueError("wrong")
        assert threads() == 1
    assert threads() == 2


def test_it_takes_one_thread_until_the_last_of_several_has_left(threads: Callable[[], int]) -> None:
    entered, leave = Event(), Event()

    @one_thread
    def work() -> None:
        entered.set()
        leave.wait(60.0)

    other = Thread(target=work)
    with one_thread:
        other.start()
        assert entered.wait(60.0)
    assert threads() == 1
    leave.set()
    other.join()
    assert threads() == 2


def test_whole_mechanisms_are_decomposed_on_one_thread(
    threads: Callable[[], int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Matrices of all links of a mechanism are the largest: those of its mobility and its report."""
    import compoundkin as ck
    from tests.benchmarks.growth import chain

    seen, svd = list[int](), np.linalg.svd

    def noted(*given: Any, **named: Any) -> Any:
        seen.append(threads())
        return svd(*given, **named)

    monkeypatch.setattr(np.linalg, "svd", noted)
    plan = chain(12)
    ck.mobility_analysis(plan)
    ck.report(ck.solve(plan, {"crank": np.linspace(0.0, 1.0, 3)})).text()
    assert len(seen) > len(plan.links)
    assert set(seen) == {1}
    assert threads() == 2
