"""The pages of other programs: read from the top, their Python runs and prints what they show."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

_DOCS = Path(__file__).parents[3] / "docs" / "exchange"


def prints_what_it_shows(page: str, capsys: pytest.CaptureFixture[str]) -> None:
    names: dict[str, Any] = {}
    text = (_DOCS / page).read_text("utf-8")
    blocks = re.findall(r"```python\n(.*?)```(?:\n\n```text\n(.*?)```)?", text, re.DOTALL)
    assert blocks
    for code, shown in blocks:
        exec(code, names)
        assert capsys.readouterr().out == shown
