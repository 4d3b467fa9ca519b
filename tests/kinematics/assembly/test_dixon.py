"""Dixon's matrices against the determinant that defines them, on random complex instances."""

import numpy as np
import pytest

from compoundkin.kinematics.assembly.elimination import pencil, sets
from compoundkin.kinematics.assembly.loop_closure import random_equations
from tests.kinematics.assembly.cases import dyad
from tests.kinematics.assembly.trusses import baranov_trusses, random_truss


def loops_of_truss(links):
    rng = np.random.default_rng(links)
    drawn = dyad("RRR", rng) if links == 3 else random_truss(baranov_trusses(links)[0], rng)
    return random_equations(drawn.graph(), rng)


def determinant(loops, x, theta, alpha):
    """The functions at theta, then their differences as one theta after another becomes an alpha, by that change."""
    columns = loops.columns

    def functions(values):
        f = loops.constant[:, 0] + x * columns[-1, :, 0] + values @ columns[:-1, :, 0]
        g = loops.constant[:, 1] + columns[-1, :, 1] / x + (1 / values) @ columns[:-1, :, 1]
        return np.concatenate([f, g])

    rows, values = [functions(theta)], theta.copy()
    for k in range(len(theta)):
        before, values[k] = functions(values), alpha[k]
        rows.append((functions(values) - before) / (alpha[k] - theta[k]))
    return np.linalg.det(np.array(rows))


def products(theta, chosen):
    return np.array([np.prod(1 / theta[list(s)]) for s in chosen])


@pytest.mark.parametrize("links", [3, 5, 7])
def test_the_bilinear_form_is_the_determinant(links):
    loops = loops_of_truss(links)
    n = 2 * loops.count - 1
    rng = np.random.default_rng(1)
    p, q = pencil(loops, n)
    own = sets(loops.count)
    chosen = [*own.large.tolist(), *own.small.tolist()]
    for _ in range(3):
        theta, alpha = (rng.standard_normal(n) + 1j * rng.standard_normal(n) for _ in range(2))
        x = complex(*rng.standard_normal(2))
        rows = products(alpha, chosen)
        rows[len(own.large) :] /= x  # the rows of the smaller sets are multiplied by x
        form = rows @ (p + x * q) @ products(theta, chosen)
        expected = determinant(loops, x, theta, alpha)
        assert abs(form - expected) < 1e-10 * abs(expected)
