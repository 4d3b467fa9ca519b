"""The gallery of letters: each file turns fully and writes its letter, and the page tells what is so."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from tests import letters


def test_all_letters_have_a_linkage_and_the_page_tells_of_them() -> None:
    assert letters.found() == list(letters.STROKES)
    assert letters.page() == letters.PAGE.read_text(encoding="utf-8")
    picture = letters.PICTURE.read_text(encoding="utf-8")
    assert picture.count("<g ") == len(letters.STROKES)
    assert all(f"<title>{name}: " in picture for name in letters.STROKES)


@pytest.mark.parametrize("name", letters.STROKES)
def test_a_linkage_writes_its_letter_and_turns_fully(name: str) -> None:
    mechanism, curve = ck.load(letters.FOLDER / f"{name}.toml"), letters.letter(name)
    assert len(mechanism.links) <= 9
    assert ck.solve(mechanism, {"crank": np.linspace(0, 2 * np.pi, 181)}, order=0).assembled.all()
    # every place of the letter, by every pair, and every place of what is written
    apart = np.abs(letters.written(name)[::4, None] - curve)
    assert apart.min(axis=0).mean() < 2.0
    assert apart.min(axis=1).mean() < 2.0
