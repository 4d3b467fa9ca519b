"""Settings of the whole test run: the same examples every time, and `tests.support` importable."""

from __future__ import annotations

import sys
from pathlib import Path

from hypothesis import settings

sys.path.insert(0, str(Path(__file__).parents[1]))

settings.register_profile("compoundkin", derandomize=True, deadline=None, max_examples=25, database=None)
settings.load_profile("compoundkin")
