"""Writes the golden pictures of `test_sketch.py`: `python -m tests.view.sketch.goldens`; look at what it wrote."""

from __future__ import annotations

from pathlib import Path

import compoundkin as ck
from compoundkin.files import shipped_mechanisms

if __name__ == "__main__":
    for path in sorted((Path(__file__).parent / "golden").glob("*.svg")):
        ck.draw(shipped_mechanisms.load_named(path.stem)).save(path)
