"""The page on the architecture is short, every module begins with a sentence, and CONTRIBUTING names what exists."""

from __future__ import annotations

import re

from tests.source import FILES, ROOT, where
from tests.test_architecture import FLOOR, only_shrinks

PAGE = ROOT / "docs" / "architecture.md"


def test_it_is_one_page_with_all_rooms() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 150
    only_shrinks(room for room in FLOOR if not re.search(rf"\b{room}\b", text))


def test_every_module_begins_with_a_sentence() -> None:
    """Of one line, with a full stop or a colon at its end."""
    first = {path: path.read_text(encoding="utf-8").partition("\n")[0] for path in FILES}
    sentence = re.compile(r'r?"""[^"].*[.:]("""(  # .*)?)?')
    only_shrinks(where(path) for path, line in first.items() if not sentence.fullmatch(line))


def test_pages_for_developers_name_files_that_exist() -> None:
    for page in (ROOT / "CONTRIBUTING.md", PAGE):
        text = page.read_text(encoding="utf-8")
        named = set(re.findall(r"\b((?:compoundkin|tests|docs)/[\w/.-]*\w)", text))
        only_shrinks(place for place in named if "NAME" not in place and not (ROOT / place).exists())
