"""Settings of the whole test run: the same examples every time, and `tests.support` importable."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from hypothesis import settings

# Several workers share the machine and matrices are small: one thread each, said before NumPy is imported.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).parents[1]))

settings.register_profile("compoundkin", derandomize=True, deadline=None, max_examples=25, database=None)
settings.load_profile("compoundkin")
