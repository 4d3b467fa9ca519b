"""The documents that the tests of the formats start from."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
SAMPLES = sorted([*Path(__file__).parent.glob("samples/*.toml"), *ROOT.glob("catalog/*.toml")])


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """`sample` is every mechanism file there is: those of these tests and the catalog."""
    if "sample" in metafunc.fixturenames:
        metafunc.parametrize("sample", SAMPLES, ids=[path.stem for path in SAMPLES])


@pytest.fixture
def text() -> str:
    """The six-bar, which says a little of everything."""
    return (Path(__file__).parent / "samples" / "six-bar.toml").read_text("utf-8")


@pytest.fixture
def document(text: str) -> dict[str, Any]:
    return tomllib.loads(text)
