"""The pages on pictures, on circuits and on a press drive are true: read from the top, their Python runs."""

from __future__ import annotations

import inspect
import re
from pathlib import Path
from typing import Any

import pytest

import compoundkin as ck

DOCS = Path(__file__).parents[1] / "docs"


@pytest.mark.parametrize("page", ["pictures.md", "circuits.md", "press-drive.md", "machine.md", "simulation.md"])
def test_the_python_of_a_page_runs(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    lines = [line[4:] for line in (DOCS / page).read_text("utf-8").splitlines() if line.startswith("    ")]
    assert len(lines) > 10
    exec("\n".join(line for line in lines if not line.startswith("compoundkin ")), {})


def test_the_page_on_loads_prints_what_it_shows(capsys: pytest.CaptureFixture[str]) -> None:
    page = (DOCS / "loads.md").read_text("utf-8")
    exec("\n".join(re.findall(r"```python\n(.*?)```", page, re.DOTALL)), {})
    (shown,) = re.findall(r"```text\n(.*?)```", page, re.DOTALL)
    printed = capsys.readouterr().out
    assert shown in printed
    assert "mass centre and inertia of a uniform bar A-B\n(15+0j) 30.0\n" in printed


def test_the_page_on_machines_prints_what_it_shows() -> None:
    page = (DOCS / "machine.md").read_text("utf-8")
    lines = [line[4:] for line in page.splitlines() if line.startswith("    ")]
    names: dict[str, Any] = {}
    exec("\n".join(lines[: lines.index("print(balance.text())")]), names)
    assert names["balance"].text() in page


def test_the_words_for_profiles_are_named_with_their_module() -> None:
    for page in DOCS.glob("*.md"):
        bare = re.findall(r"`(?:disc|profile|formula|synthesise|cam_analysis)`", page.read_text("utf-8"))
        assert bare == [] or page.name == "modules.md", page.name


def test_the_help_of_an_arc_names_its_parameters() -> None:
    named = re.findall(r"`(\w+)`", (ck.arc.__doc__ or "").partition("Held:")[0])
    assert "centre_at" in named
    assert set(named) <= set(inspect.signature(ck.arc).parameters)
