"""The page on the architecture is short, its files speak for themselves, and CONTRIBUTING names what there is."""

from __future__ import annotations

import ast
import re

from tests.architecture_page import BEGIN, END, PAGE, pages
from tests.source import FILES, ROOT, tree, where
from tests.test_architecture import only_shrinks


def test_its_tables_are_up_to_date() -> None:
    """If not: run `python -m tests.architecture_page`."""
    only_shrinks(path.name for path, text in pages().items() if path.read_text(encoding="utf-8") != text)


def test_it_is_one_page() -> None:
    """But for the generated table, which has a line for each folder."""
    before, _, after = PAGE.read_text(encoding="utf-8").partition(BEGIN)
    assert len((before + after.partition(END)[2]).splitlines()) <= 250


def test_every_module_begins_with_a_sentence() -> None:
    """Of one line, with a full stop or a colon at its end."""
    first = {path: (ast.get_docstring(tree(path)) or "").split("\n")[0] for path in FILES}
    only_shrinks(where(path) for path, line in first.items() if not line.endswith((".", ":")))


def test_contributing_names_files_that_exist() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    named = set(re.findall(r"\b((?:compoundkin|tests|docs)/[\w/.-]*\w)", text))
    assert len(named) > 20
    only_shrinks(place for place in named if "NAME" not in place and not (ROOT / place).exists())
