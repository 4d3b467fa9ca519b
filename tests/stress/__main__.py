"""The stress suite: `python -m tests.stress --count N --seed S`; subcommands `files` and `misuse`."""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from tests.stress.command import main

if __name__ == "__main__":
    main()
