"""The stress suite: `python -m tests.stress --count 300 --seed 1` holds random mechanisms against independent equations."""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from tests.stress.command import main

if __name__ == "__main__":
    main()
