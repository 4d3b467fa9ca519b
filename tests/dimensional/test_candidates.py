"""Candidates of fixed pivots and joints, and their defects, on a published nine-point problem."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.dimensional.candidates import coupler_orientations, of_points
from compoundkin.dimensional.defects import Rejection, SolvedLinkage, confirmed, judged
from compoundkin.dimensional.tasks import Conditions

# C. W. Wampler, A. P. Morgan, A. J. Sommese, J. Mech. Des. 114 (1992) 153, problem 3.
NINE = np.array([0.25, 0.52 + 0.1j, 0.8 + 0.7j, 1.2 + 1j, 1.4 + 1.3j, 1.1 + 1.48j, 0.7 + 1.4j, 0.2 + 1j, 0.02 + 0.4j])
# The one linkage that passes them in order on one circuit, with its cognates: a, b, A, B when the point is at the
# first; eight digits, so that the points are met to some 1e-7.
VIABLE = [
    (1.21669735 + 0.88585011j, 1.34112894 + 0.08454041j, 0.85017185 + 0.39562559j, 0.84378873 - 0.44125632j),
    (0.7044594 + 0.41389746j, 1.21669735 + 0.88585011j, 0.0914827 + 0.51732693j, 0.6165255 + 0.49022452j),
    (1.34112894 + 0.08454041j, 0.7044594 + 0.41389746j, 0.74734021 + 0.52579674j, 0.8629767 - 0.10342946j),
]


def closed(values):
    """The linkage with its digits completed, so that it closes at all nine points."""
    from scipy.optimize import least_squares

    def open_by(x):
        a, b, first, second = x.view(complex)
        u = coupler_orientations(NINE, a, b, first, second)
        return np.concatenate([np.abs(NINE + u * (joint - NINE[0]) - centre) - abs(joint - centre)
                               for centre, joint in ((a, first), (b, second))])  # fmt: skip

    found = least_squares(open_by, np.array(values).view(float), xtol=1e-15, ftol=1e-15, gtol=1e-15)
    assert np.max(np.abs(found.x - np.array(values).view(float))) < 1e-6
    return found.x.view(complex)


@pytest.mark.parametrize("number", [0, 1, 2])
def test_the_viable_linkage_of_nine_points_has_a_member_without_defects(number):
    (linkage,) = of_points(NINE, *closed(VIABLE[number]))
    found = judged(linkage, Conditions())
    if number == 0:
        assert isinstance(found, SolvedLinkage)
        assert isinstance(confirmed(found, Conditions()), SolvedLinkage)
        motion = ck.solve(found.mechanism, {found.driver: found.values}, order=0)
        assert np.max(np.abs(motion.points["P"].position - NINE)) < 1e-6
    else:
        # the same curve: no link on the frame of a cognate need go on, but all points are on one circuit
        assert isinstance(found, SolvedLinkage) or found.reason in ("branch", "order")


def test_orientations_are_those_of_a_solved_four_bar():
    links = ck.link("crank", A=0, B=2), ck.link("coupler", B=0, C=5, P=(2, 1.5)), ck.link("rocker", D=0, C=4)
    motion = ck.solve(
        ck.Mechanism("m", ck.link("frame", A=0, D=5), *links, ck.drive("crank")), {"crank": [0.1, 1, 2, 4]}
    )
    points = {name: motion.points[name].position for name in "ABCDP"}
    u = coupler_orientations(points["P"], 0, 5, points["B"][0], points["C"][0])
    turn = np.exp(1j * motion.links["coupler"].angle)
    assert np.max(np.abs(u - turn / turn[0])) < 1e-12


def test_points_in_another_order_are_a_defect():
    a, b, first, second = closed(VIABLE[0])
    order = [0, 3, 2, 1, 4, 5, 6, 7, 8]
    (linkage,) = of_points(NINE[order], a, b, first, second)
    found = judged(linkage, Conditions())
    assert isinstance(found, Rejection)
    assert found.reason == "order"
