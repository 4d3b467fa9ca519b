"""The pages on PMKS, pyslvs and tables of joints print what they show."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

PAGES = Path(__file__).parents[3] / "docs" / "exchange"


@pytest.mark.parametrize("page", ["pmks", "pyslvs", "joint-tables"])
def test_pages_print_what_they_show(page: str, capsys: pytest.CaptureFixture[str]) -> None:
    names: dict[str, Any] = {}
    found = re.findall(
        r"```python\n(.*?)```\n\n```text\n(.*?)```", (PAGES / f"{page}.md").read_text("utf-8"), re.DOTALL
    )
    assert len(found) > 1
    for code, shown in found:
        exec(code, names)
        assert capsys.readouterr().out == shown
