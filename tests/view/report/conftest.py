"""Mechanisms and motions that the tests of reports share."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import compoundkin as ck
from tests import catalog
from tests.view.report.support import four_bar


@pytest.fixture(scope="session")
def six_bar() -> ck.results.Motion:
    return catalog.motion("six-bar")


@pytest.fixture(scope="session")
def broken() -> ck.results.Motion:
    """A four-bar of 73 poses that cannot be assembled between 56.1 and 303.9 degrees."""
    with warnings.catch_warnings(action="ignore", category=ck.errors.UnassembledPoses):
        return ck.solve(four_bar(6.5, ck.drive("crank")))


@pytest.fixture(scope="session")
def sweep() -> ck.results.Motion:
    """Two designs, the second of them the broken one."""
    with warnings.catch_warnings(action="ignore", category=ck.errors.UnassembledPoses):
        return ck.solve(four_bar(np.array([[4.0], [6.5]]), ck.drive("crank")))
