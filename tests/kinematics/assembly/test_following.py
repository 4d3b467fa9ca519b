"""The parts under all configurations: paths, Newton, duplicates, neighbouring poses."""

import numpy as np

from compoundkin.base.continuation import follow_paths, homotopy_of
from compoundkin.kinematics.assembly import homotopy, rotation_equations
from compoundkin.kinematics.assembly.homotopy import CORRECTOR, LENGTHS
from compoundkin.kinematics.assembly.loop_closure import random_equations, rotation_equations_of
from compoundkin.kinematics.assembly.rotation_equations import distinct, jacobian, polish, residual
from tests.kinematics.assembly.cases import triad, with_slides
from tests.kinematics.assembly.trusses import baranov_trusses


def test_paths_end_at_all_roots_and_not_at_infinity():
    """From z^3 = 1 to (z - 2) (z - 3) = 0, one path to infinity."""
    moving = homotopy_of(
        lambda i, z, t: (1 - t)[:, None] * 1j * (z**3 - 1) + t[:, None] * (z - 2) * (z - 3),
        lambda i, z, t: ((1 - t)[:, None] * 3j * z**2 + t[:, None] * (2 * z - 5))[..., None],
        lambda i, z, t: -1j * (z**3 - 1) + (z - 2) * (z - 3),
    )
    ends = follow_paths(moving, np.exp(2j * np.pi * np.arange(3) / 3)[None], LENGTHS, CORRECTOR)[0]
    found = ends[np.isfinite(ends) & (np.abs(ends) < 1e6)]
    assert np.allclose(sorted(found.real), [2, 3], atol=1e-7)
    assert np.allclose(found.imag, 0, atol=1e-7)


def test_jacobian_against_differences():
    rng = np.random.default_rng(0)
    loops = random_equations(with_slides(baranov_trusses(7)[0], 2, rng).graph(), rng).flat
    x = rng.standard_normal((1, 4, 6)) + 1j * rng.standard_normal((1, 4, 6))
    step = 1e-6
    for k in range(6):
        change = np.zeros(6)
        change[k] = step
        slope = (residual(loops, x + change) - residual(loops, x - change)) / (2 * step)
        assert np.abs(slope - jacobian(loops, x)[..., k]).max() < 1e-6 * np.abs(slope).max()


def test_generic_instances_have_one_number_each():
    rng = np.random.default_rng(1)
    structure = with_slides(baranov_trusses(7)[1], 1, rng).graph()
    other = random_equations(structure, np.random.default_rng(77)).flat
    ends = distinct(polish(other, homotopy.roots(other, structure)))
    assert ends.shape[1] == homotopy.generic_count(structure)


def test_duplicates_and_padding():
    nan = np.nan
    x = np.array([[[1.0, 2.0], [1.0, 2.0 + 1e-9], [3.0, 4.0]], [[nan, 1.0], [5.0, 6.0], [5.0, 6.1]]])
    assert np.array_equal(distinct(x), [[[1.0, 2.0], [3.0, 4.0]], [[5.0, 6.0], [5.0, 6.1]]])


def test_neighbours_ask_anew_only_where_they_must():
    geometry = triad("RR,RR,RR", np.random.default_rng(3))
    first = geometry.connections[0]
    moving = type(first)(first.bodies, (first.points[0] + np.linspace(0, 0.3, 50), first.points[1]))
    loops = rotation_equations_of(type(geometry)(4, (moving, *geometry.connections[1:]), 4.0)).flat
    asked = []

    def solved(some):
        asked.append(len(some.constant))
        return distinct(polish(some, homotopy.roots(some, geometry.graph())))

    found = rotation_equations.solutions(loops, 6, solved)
    assert np.isfinite(found).all()
    assert sum(asked) < 25
    assert np.abs(residual(loops, found)).max() < 1e-10
    anew = distinct(polish(loops, homotopy.roots(loops, geometry.graph())))
    apart = np.abs(found[:, :, None] - anew[:, None]).max(axis=-1)
    assert np.all(apart.min(axis=2) < 1e-6)
