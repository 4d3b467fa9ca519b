"""The page on the file format is true: its snippets run, its example of an error is what is raised."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

from compoundkin.base.errors import InvalidMechanism
from compoundkin.files import loads
from compoundkin.files.document import DRAWN, HEAD, table_forms
from compoundkin.files.json_schema import schema
from compoundkin.kinematics import solve

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "file-format.md").read_text("utf-8")


def snippets(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)


@pytest.mark.parametrize("text", snippets("toml"), ids=lambda text: tomllib.loads(text)["title"])
def test_files_on_the_page_load_and_move(text: str) -> None:
    Draft202012Validator(schema()).validate(tomllib.loads(text))
    mechanism = loads(text)
    if mechanism.title != "Two lengths of crank":
        assert solve(mechanism).assembled.any()


def test_python_on_the_page_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "catalog").symlink_to(ROOT / "catalog")
    for code in snippets("python"):
        exec(code, {})


def test_every_key_is_on_the_page() -> None:
    keys = [*HEAD, DRAWN, *(key for table in table_forms() for key in table.keys)]
    missing = [key.name for key in keys if not re.search(rf"\b{key.name}\b", PAGE)]
    assert missing == []


def test_the_example_of_an_error_is_what_is_raised(text: str) -> None:
    for old, new in [("[14, 0]", '["14", 0]'), ("angle = 0", "agle = 0"), ('link = "crank"', 'link = "crnk"')]:
        text = text.replace(old, new)
    with pytest.raises(InvalidMechanism) as caught:
        loads(text, where="six-bar.toml")
    assert str(caught.value) in re.sub(r"^    ", "", PAGE, flags=re.MULTILINE)
