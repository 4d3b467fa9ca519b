"""The reference numbers of the six-bar."""

from __future__ import annotations

import json
from pathlib import Path

import pytest


@pytest.fixture
def reference_rows() -> list[dict[str, object]]:
    """Poses of Example 3-4 computed with 40 digits."""
    path = Path(__file__).parents[1] / "reference" / "kinematics.json"
    rows: list[dict[str, object]] = json.loads(path.read_text())[0]["expected"]["rows"]
    return rows
