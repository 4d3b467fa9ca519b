"""Six-bars by an added dyad: angles at positions, dwells at both ends of a swing."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck

PLATE = [(2.00, 2.50, 53.1), (1.82, 4.10, 24.8), (-0.47, 3.42, 26.1), (-1.33, 1.34, 45.9), (-0.22, 0.46, 71.4)]


def plate(count):
    return ck.synthesise(ck.tasks.poses("plate", [(x, y, ck.deg(angle)) for x, y, angle in PLATE[:count]]))


def test_a_planted_second_output_is_found():
    """A bar from a point of the plate to an output about (6, 3), whose angles are read off and then asked for."""
    base = plate(5)[0]
    z, u = (base.candidate.z["plate"], base.candidate.u["plate"])
    near, pivot, length, arm = 0.4 - 0.3j, 6 + 3j, 5.0, 4.0
    way = z + u * near - pivot
    cosine = (np.abs(way) ** 2 + arm**2 - length**2) / (2 * arm * np.abs(way))
    angles = np.angle(way) + np.arccos(cosine)
    answer = ck.synthesise(ck.tasks.output(base, angles, pivot=(6, 3)))
    assert "of 4 at most" in answer.complete
    every = [*(one.candidate for one in answer), *(one.candidate for one in answer.rejected)]
    assert min(abs(one.lengths[-2] - length) + abs(one.lengths[-1] - arm) for one in every) < 1e-6
    found = [one for one in answer if abs(one.candidate.lengths[-2] - length) < 1e-6]
    for one in found:
        motion = ck.solve(one.mechanism, {one.driver: one.values})
        assert len(one.mechanism.links) == 6
        turned = motion.links["second output"].angle - angles
        assert np.max(np.abs(np.exp(1j * (turned - turned[0])) - 1)) < 1e-6


@pytest.mark.full  # arcs of some thousand coupler points are compared: four seconds
def test_an_output_rests_at_both_ends_of_its_swing():
    first, second = ck.deg([60, 40])
    answer = ck.synthesise(ck.tasks.dwell(ck.deg(30), dwells=(first, second), tolerance=ck.deg(0.1)))
    best = answer[0]
    assert best.turns
    assert best.error < ck.deg(0.1)
    # solved again over a turn: so long the output moves by no more than twice the error, at two ends 30 degrees apart
    turn = np.linspace(0, 2 * np.pi, 1441)
    angle = np.unwrap(ck.solve(best.mechanism, {best.driver: best.values[0] + turn}).links["second output"].angle)
    assert np.isclose(np.ptp(angle), ck.deg(30), atol=3 * best.error)
    low, high = angle < angle.min() + 3 * best.error, angle > angle.max() - 3 * best.error
    rests = sorted(np.sum(end) * (turn[1] - turn[0]) for end in (low, high))
    assert rests[0] > second * 0.95
    assert rests[1] > first * 0.95


def test_wrong_outputs_and_dwells():
    base = plate(5)
    with pytest.raises(ck.errors.InvalidInput, match="one for each"):
        ck.tasks.output(base[0], [0, 1], pivot=0)
    with pytest.raises(ck.errors.InvalidInput, match="no solved linkage"):
        ck.tasks.output(base, [0] * 5, pivot=0)
    with pytest.raises(ck.errors.InvalidInput, match="no two angles"):
        ck.tasks.dwell(0.5, dwells=(1, 7))
