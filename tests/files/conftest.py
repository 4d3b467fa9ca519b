"""The documents that the tests of the formats start from."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest


@pytest.fixture
def text() -> str:
    """The six-bar, which says a little of everything."""
    return (Path(__file__).parent / "samples" / "six-bar.toml").read_text("utf-8")


@pytest.fixture
def document(text: str) -> dict[str, Any]:
    return tomllib.loads(text)
