"""Path synthesis of the literature: mechanisms that were published, and ours, at least as good."""

from __future__ import annotations

import numpy as np
import pytest

from tests.studies.path_cases import CASES


@pytest.mark.parametrize("name", CASES)
def test_published_mechanisms_are_as_their_sources_compute_them(name: str) -> None:
    case = CASES[name]
    for one in case.published:
        found = float((abs(one.motion.points["P"].position - case.target) ** 2).sum())
        assert found == pytest.approx(one.error(case.target), rel=1e-9, abs=1e-14), one.who
        assert found < 0.07, one.who  # so the numbers are copied well; Kunjur and Krishnamurty's is the greatest
        assert np.ptp(np.sign(np.diff(one.angles))) == 0, one.who
