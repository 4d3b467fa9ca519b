"""Motion programs: published peaks, joints of the pieces, symmetry, derivatives against differences."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compoundkin.base.errors import InvalidInput, InvalidMechanism
from compoundkin.base.series import Series
from compoundkin.model.laws.cam_laws import LAWS, Discontinuity, unit_pieces
from compoundkin.model.laws.motion_programs import Program, ProgramSegment, dwell, fall, program, rise

MOVING = [law for law in LAWS if law != "dwell"]

# Peak velocity, acceleration and jerk for a rise of 1 over a span of 1 as the tables of R. L. Norton, Design of
# Machinery, chapter 8, and Cam Design and Manufacturing Handbook print them; the modified sine also in PSMotion's
# MechDesigner manual (1.76, 5.53, 69.47). None: infinite. The closed forms are below.
PEAKS = {
    "constant-velocity": (1.0, None, None),
    "parabolic": (2.0, 4.0, None),
    "harmonic": (1.571, 4.945, None),
    "cycloidal": (2.0, 6.283, 39.5),
    "3-4-5": (1.875, 5.774, 60.0),
    "4-5-6-7": (2.188, 7.526, 52.5),
    "modified-trapezoid": (2.0, 4.888, 61.4),
    "modified-sine": (1.760, 5.528, 69.5),
}
# Two printed accelerations are 0.2 % above the closed forms: 4.945 for pi**2 / 2 = 4.935, 7.526 for 7.513.
PRINTED = 2.5e-3

EXACT = {
    "harmonic": (pi / 2, pi**2 / 2),
    "cycloidal": (2.0, 2 * pi, 4 * pi**2),
    "3-4-5": (15 / 8, 10 / sqrt(3), 60.0),
    "4-5-6-7": (35 / 16, 84 * sqrt(5) / 25, 52.5),
    "modified-trapezoid": (2.0, 8 * pi / (2 + pi), 32 * pi**2 / (2 + pi)),
    "modified-sine": (4 * pi / (4 + pi), 4 * pi**2 / (4 + pi), 16 * pi**3 / (4 + pi)),
}


def derivatives(moving: Program, x: object, order: int = 3, repeat: bool | None = None) -> list[np.ndarray]:
    """Position and derivatives with respect to the coordinate itself."""
    x = np.asarray(x, dtype=float)
    along = moving.at(Series((x, np.ones_like(x), *[np.zeros_like(x)] * (order - 1))[: order + 1]), repeat)
    return [along.derivative(k) for k in range(order + 1)]


# Places between 0 and 1 that are never a joint, symmetric about the middle.
INSIDE = (np.arange(4000) + 0.5) / 4000


@pytest.mark.parametrize("law", MOVING)
def test_peaks_are_the_published_ones(law: str) -> None:
    found = derivatives(program(rise(1.0, over=1.0, law=law)), np.linspace(1e-9, 1 - 1e-9, 40001))
    for printed, values in zip(PEAKS[law], found[1:], strict=True):
        if printed is not None:
            assert np.max(np.abs(values)) == pytest.approx(printed, rel=PRINTED)


@pytest.mark.parametrize("law", EXACT)
def test_peaks_are_those_of_the_closed_forms(law: str) -> None:
    found = derivatives(program(rise(1.0, over=1.0, law=law)), np.linspace(1e-9, 1 - 1e-9, 40001))
    for exact, values in zip(EXACT[law], found[1:], strict=False):
        assert np.max(np.abs(values)) == pytest.approx(exact, rel=1e-6)


def test_the_jerk_of_the_modified_sine_at_the_crossover_is_the_published_one() -> None:
    """PSMotion's MechDesigner manual, modified sinusoid: -23.15."""
    middle = derivatives(program(rise(1.0, over=1.0, law="modified-sine")), 0.5)
    assert middle[3] == pytest.approx(-23.15, abs=0.02)


@pytest.mark.parametrize("law", MOVING)
def test_laws_are_symmetric(law: str) -> None:
    place, speed, acceleration, jerk = derivatives(program(rise(1.0, over=1.0, law=law)), INSIDE)
    np.testing.assert_allclose(place + place[::-1], 1.0, atol=1e-14)
    np.testing.assert_allclose(speed, speed[::-1], atol=1e-12)
    np.testing.assert_allclose(acceleration, -acceleration[::-1], atol=1e-11)
    np.testing.assert_allclose(jerk, jerk[::-1], atol=1e-9)


@pytest.mark.parametrize("law", MOVING)
def test_velocity_integrates_to_the_rise_and_never_turns_back(law: str) -> None:
    speed = derivatives(program(rise(7.0, over=3.0, law=law)), 3.0 * INSIDE)[1]
    assert np.mean(speed) * 3.0 == pytest.approx(7.0, rel=1e-6)
    assert np.all(speed >= -1e-12)


@pytest.mark.parametrize("law", ["modified-trapezoid", "modified-sine", "cycloidal", "3-4-5", "4-5-6-7"])
def test_position_velocity_and_acceleration_are_continuous_at_every_joint(law: str) -> None:
    pieces = unit_pieces(law)
    ends = [*(piece.start for piece in pieces[1:]), 1.0]
    for k in range(3):
        before = [0.0, *(piece.derivative(k, end - piece.start) for piece, end in zip(pieces, ends, strict=True))]
        after = [*(piece.derivative(k, 0.0) for piece in pieces), 1.0 if k == 0 else 0.0]
        np.testing.assert_allclose(before, after, atol=1e-13)
    assert program(dwell(1.0), rise(1.0, 1.0, law), dwell(1.0), fall(1.0, 1.0, law)).discontinuities() == ()


def test_jumps_of_velocity_and_acceleration_are_told() -> None:
    harmonic = program(dwell(1.0), rise(2.0, over=1.0, law="harmonic"), dwell(1.0), fall(2.0, over=1.0))
    found = harmonic.discontinuities()
    assert [(one.place, one.order) for one in found] == [(1.0, 2), (2.0, 2)]
    assert [one.jump for one in found] == pytest.approx([pi**2, pi**2])
    linear = program(dwell(1.0), rise(3.0, over=1.5, law="constant-velocity"))
    assert linear.discontinuities() == (Discontinuity(1.0, 1, 2.0), Discontinuity(2.5, 1, -2.0))
    # a harmonic rise and fall without dwells is one cosine: no jump at the turn or where it begins anew
    assert program(rise(1.0, 2.0, "harmonic"), fall(1.0, 2.0, "harmonic")).discontinuities() == ()


def test_harmonic_rise_and_fall_are_one_cosine() -> None:
    moving = program(rise(2.0, 3.0, "harmonic"), fall(2.0, 3.0, "harmonic"), start=1.0)
    x = np.linspace(-7.0, 20.0, 301)
    found = derivatives(moving, x)
    w = pi / 3.0
    for k, values in enumerate(found):
        expected = (2.0 if k == 0 else 0.0) - np.cos(w * x + k * pi / 2) * w**k
        np.testing.assert_allclose(values, expected, atol=1e-12)


def test_cycloidal_rise_is_the_textbook_formula() -> None:
    x = np.linspace(0.0, 2.0, 101)
    place, speed, *_ = derivatives(program(rise(5.0, over=2.0)), x)
    np.testing.assert_allclose(place, 5.0 * (x / 2 - np.sin(pi * x) / (2 * pi)), atol=1e-14)
    np.testing.assert_allclose(speed, 2.5 * (1 - np.cos(pi * x)), atol=1e-13)


def test_the_modified_curves_are_the_textbook_formulas() -> None:
    """Norton, Design of Machinery, chapter 8; those of the modified trapezoid are printed to eight digits."""
    x = np.linspace(0.0, 1.0, 201)
    sine = np.select(
        [x < 1 / 8, x < 7 / 8],
        [
            pi * x - np.sin(4 * pi * x) / 4,
            2 + pi * x - 9 / 4 * np.sin((pi + 4 * pi * x) / 3),
        ],
        4 + pi * x - np.sin(4 * pi * x) / 4,
    ) / (4 + pi)
    np.testing.assert_allclose(derivatives(program(rise(1.0, 1.0, "modified-sine")), x)[0], sine, atol=1e-14)
    x = np.linspace(0.0, 0.5, 101)
    trapezoid = np.select(
        [x < 1 / 8, x < 3 / 8],
        [
            0.38898448 * x - 0.0309544 * np.sin(4 * pi * x),
            2.44406184 * x**2 - 0.22203097 * x + 0.00723407,
        ],
        1.6110154 * x - 0.0309544 * np.sin(4 * pi * x - pi) - 0.3055077,
    )
    found = derivatives(program(rise(1.0, 1.0, "modified-trapezoid")), x)[0]
    np.testing.assert_allclose(found, trapezoid, atol=2e-7)


def test_outside_it_holds_its_ends_unless_it_repeats() -> None:
    once = program(rise(2.0, over=1.0), start=1.0)
    place, *rest = derivatives(once, [-5.0, 9.0])
    assert place.tolist() == [1.0, 3.0]
    assert np.all(np.array(rest) == 0.0)
    there_and_back = program(rise(2.0, over=1.0), fall(2.0, over=1.0))
    np.testing.assert_allclose(derivatives(there_and_back, [0.3, 2.3, -1.7])[0], derivatives(there_and_back, 0.3)[0])
    assert derivatives(there_and_back, 2.5, repeat=False)[0] == pytest.approx(0.0, abs=1e-15)


def test_an_indexing_program_goes_on_from_where_it_is() -> None:
    index = program(rise(60.0, over=1.0, law="modified-sine"), dwell(0.5), repeat=True)
    assert index.repeats
    places = derivatives(index, [0.5, 2.0, 3.5, -0.1, 15.0])[0]
    np.testing.assert_allclose(places, [30.0, 90.0, 150.0, 0.0, 600.0], atol=1e-12)


def test_as_a_law_in_time_it_holds_its_last_value_unless_told_to_repeat() -> None:
    lift = rise(1.0, over=1.0), fall(1.0, over=1.0)
    assert program(*lift).coordinate(np.array([2.5]), 2).c[0].tolist() == pytest.approx([0.0], abs=1e-15)
    assert program(*lift, repeat=True).coordinate(np.array([2.5]), 0).c[0].tolist() == pytest.approx([0.5])


def test_shapes_numbers_and_constants_are_kept() -> None:
    moving = program(rise(2.0, over=1.0), fall(2.0, over=1.0))
    assert moving.at(Series((np.full((3, 4), 0.5), 1.0, 0.0))).c[1].shape == (3, 4)
    assert [type(c) for c in moving.at(Series((0.5, 1.0, 0.0))).c] == [float] * 3
    assert moving.at(Series((0.5,))).c == pytest.approx((1.0,))
    assert np.isnan(moving.at(Series((np.array([np.nan]), 1.0))).c[0]).all()


programs = st.builds(
    lambda parts, start: Program(tuple(parts), start),
    st.lists(
        st.builds(
            lambda law, over, amount: ProgramSegment(law, over, 0.0 if law == "dwell" else amount),
            st.sampled_from(list(LAWS)),
            st.floats(0.2, 5.0),
            st.floats(-10.0, 10.0),
        ),
        min_size=1,
        max_size=5,
    ),
    st.floats(-5.0, 5.0),
)


@given(programs, st.floats(0.02, 0.98), st.integers(0, 4))
def test_derivatives_are_those_that_differences_show(moving: Program, share: float, index: int) -> None:
    piece = moving.pieces[index % len(moving.pieces)]
    ends = [*(one.start for one in moving.pieces[1:]), moving.period]
    length = ends[index % len(moving.pieces)] - piece.start
    x, h = piece.start + share * length, 0.01 * length
    steps = np.array([-2.0, -1.0, 0.0, 1.0, 2.0]) * h
    found = derivatives(moving, x + steps, repeat=False)
    natural = max(abs(s.rise) for s in moving.segments) + 1e-3
    for k in range(3):
        # five points: the error is h**4 / 30 times the fifth derivative (Abramowitz and Stegun, 25.3.6)
        slope = found[k] @ np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / (12.0 * h)
        assert slope == pytest.approx(found[k + 1][2], abs=3e-4 * natural * 10.0**k / min(1.0, length) ** (k + 1))


@given(programs, st.floats(-10.0, 30.0), st.tuples(*[st.floats(-2.0, 2.0)] * 3))
def test_along_a_series_the_chain_rule_holds(moving: Program, x: float, rates: tuple[float, float, float]) -> None:
    v, a, j = rates
    f = [float(d) for d in derivatives(moving, x)]
    along = moving.at(Series((x, v, a / 2, j / 6)))
    assert along.derivative(1) == pytest.approx(f[1] * v)
    assert along.derivative(2) == pytest.approx(f[2] * v**2 + f[1] * a, abs=1e-9)
    assert along.derivative(3) == pytest.approx(f[3] * v**3 + 3 * f[2] * v * a + f[1] * j, abs=1e-7)


@given(programs)
def test_values_at_the_breaks_are_sums_of_the_rises(moving: Program) -> None:
    held = derivatives(moving, moving.breaks, order=0, repeat=False)[0]
    np.testing.assert_allclose(held, moving.values, atol=1e-12)
    x = np.linspace(0.0, moving.period, 501)
    assert np.ptp(derivatives(moving, x, order=0, repeat=False)[0]) <= moving.lift + 1e-12


@pytest.mark.parametrize(
    ("make", "where"),
    [
        (lambda: rise(1.0, over=1.0, law="cycloid"), "did you mean 'cycloidal'"),
        (lambda: rise(1.0, over=0.0), "segment.over"),
        (lambda: rise(float("nan"), over=1.0), "segment.rise"),
        (lambda: fall("1", over=1.0), "'1' is no number"),  # type: ignore[arg-type]
        (lambda: dwell(-1.0), "segment.over"),
        (lambda: ProgramSegment("dwell", 1.0, 2.0), "a dwell rises by 0"),
        (lambda: program(), "there is no segment"),
        (lambda: program(rise(1.0, 1.0), 5.0), "is no program segment"),  # type: ignore[arg-type]
        (lambda: program(rise(1.0, 1.0), start=float("inf")), "program.start"),
    ],
)
def test_what_cannot_be_meant_is_said(make: object, where: str) -> None:
    with pytest.raises((InvalidMechanism, InvalidInput)) as caught:
        make()  # type: ignore[operator]
    assert where in str(caught.value)
