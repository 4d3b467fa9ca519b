"""The examples of the page on composing run."""

from __future__ import annotations

import doctest
from pathlib import Path


def test_examples_of_the_page():
    found = doctest.testfile(str(Path(__file__).parent.parent / "docs" / "composing.md"), module_relative=False)
    assert found.attempted > 10
    assert found.failed == 0
