"""Writes the golden pictures of `test_sketch.py`: `python -m tests.view.sketch.goldens`; look at what it wrote."""

from __future__ import annotations

from pathlib import Path

import compoundkin as ck

if __name__ == "__main__":
    for path in sorted((Path(__file__).parent / "golden").glob("*.svg")):
        ck.draw(ck.load(path.stem)).save(path)
