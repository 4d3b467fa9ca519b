"""The pages on PMKS, pyslvs and tables of joints print what they show."""

from __future__ import annotations

import pytest

from tests.files.exchange.pages import prints_what_it_shows


@pytest.mark.parametrize("page", ["pmks.md", "pyslvs.md", "joint-tables.md"])
def test_pages_print_what_they_show(page: str, capsys: pytest.CaptureFixture[str]) -> None:
    prints_what_it_shows(page, capsys)
