"""Writes the golden pictures of `test_sketch.py`: run `python -m tests.drawing.goldens` and look at what it wrote."""

from __future__ import annotations

from pathlib import Path

import compoundkin as ck
from compoundkin import catalog

if __name__ == "__main__":
    for path in sorted((Path(__file__).parent / "golden").glob("*.svg")):
        ck.draw(catalog.load_named(path.stem)).save(path)
