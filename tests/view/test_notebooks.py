"""The tutorial notebooks: each runs from top to bottom, shows its pictures, and is stored without its results."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

import compoundkin as ck

NOTEBOOKS = sorted((Path(__file__).parents[2] / "docs" / "notebooks").glob("*.ipynb"))
# The last lines of cells that show a picture.
DRAWS = re.compile(r"(ck\.draw|ck\.plots|ck\.animate|.*\bmotion\.plot|plt\.show)")
PICTURES = ("image/svg+xml", "image/png")


def code_of(path: Path) -> list[dict[str, Any]]:
    return [cell for cell in json.loads(path.read_text(encoding="utf-8"))["cells"] if cell["cell_type"] == "code"]


def source_of(cell: dict[str, Any]) -> str:
    return "".join(cell["source"])


def assert_it_ran(path: Path) -> None:
    """A notebook with its results has no errors and warnings in them, and shows its pictures and a table.

    The site runs all notebooks as it is built: its test asks this of them.
    """
    cells = code_of(path)
    outputs = [(source_of(cell), output) for cell in cells for output in cell["outputs"]]
    assert [(s, o["ename"], o["evalue"]) for s, o in outputs if o["output_type"] == "error"] == []
    assert [(s, o["text"]) for s, o in outputs if o.get("name") == "stderr"] == []
    drawing = [cell for cell in cells if DRAWS.match(source_of(cell).splitlines()[-1])]
    assert len(drawing) >= 2
    for cell in drawing:
        assert any(kind in output.get("data", {}) for output in cell["outputs"] for kind in PICTURES), source_of(cell)
    pages = ["".join(output["data"]["text/html"]) for _, output in outputs if "text/html" in output.get("data", {})]
    assert any("<table" in page for page in pages)


def test_there_are_notebooks() -> None:
    first = ["better-press", "compound-mechanism", "design-sweep", "exercises", "first-mechanism", "forces"]
    assert [path.stem for path in NOTEBOOKS] == [*first, "wiper-tolerances"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_is_stored_without_results_in_one_form(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    notebook = json.loads(text)
    assert text == json.dumps(notebook, indent=1, ensure_ascii=False) + "\n"
    assert [cell["id"] for cell in notebook["cells"]] == [f"cell-{k:02d}" for k in range(1, len(notebook["cells"]) + 1)]
    assert {cell["cell_type"] for cell in notebook["cells"]} == {"code", "markdown"}
    assert all(cell["metadata"] == {} for cell in notebook["cells"])
    for cell in code_of(path):
        assert (cell["outputs"], cell["execution_count"]) == ([], None)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_begins_with_its_only_title_and_points_to_pages_that_exist(path: Path) -> None:
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    prose = [source_of(cell) for cell in cells if cell["cell_type"] == "markdown"]
    lines = "\n".join(prose).splitlines()
    assert [line for line in lines if line.startswith("# ")] == [prose[0]]
    links = [target for line in lines for target in re.findall(r"\]\(([^)#]+)", line)]
    assert links
    assert [target for target in links if not (path.parent / target).is_file()] == []


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_uses_public_words_only(path: Path) -> None:
    source = "\n".join(source_of(cell) for cell in code_of(path))
    assert set(re.findall(r"\bck\.(\w+)", source)) <= set(dir(ck))
    assert re.findall(r"^.*compoundkin.*$", source, flags=re.MULTILINE) == ["import compoundkin as ck"]
