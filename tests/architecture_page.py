"""The tables of docs/architecture.md and docs/modules.md, made from the modules' own first sentences.

Run `python -m tests.architecture_page` to write them.
"""

from __future__ import annotations

import ast
import re
from pathlib import Path

from tests.source import FILES, PACKAGE, ROOT, tree
from tests.test_architecture import ROOMS

PAGE, MODULES = ROOT / "docs" / "architecture.md", ROOT / "docs" / "modules.md"
BEGIN, END = "<!-- made by python -m tests.architecture_page -->", "<!-- end -->"
INIT = "__init__.py"
# What a page is made of besides Python.
OTHERS = {"view/page": "assets/ with style sheets, scripts and the libraries of others"}


def sentence(path: Path) -> str:
    """The first sentence of a module, without its full stop."""
    text = ast.get_docstring(tree(path)) or ""
    return re.sub(r"\s+", " ", re.split(r"\.(?:\s|$)", text, maxsplit=1)[0]).replace("|", r"\|")


def folders() -> list[Path]:
    """The package's folders, from the ground up, each before those in it."""
    rooms = [room for floor in ROOMS for room in floor]
    below = {path.parent for path in FILES if path.name == INIT} - {PACKAGE}
    return sorted(below, key=lambda path: (rooms.index(path.relative_to(PACKAGE).parts[0]), path))


def modules_in(folder: Path) -> list[Path]:
    """The modules of a folder, its `__init__` left out."""
    return [path for path in FILES if path.parent == folder and path.name != INIT]


def name(folder: Path) -> str:
    return folder.relative_to(PACKAGE).as_posix()


def table_of_folders() -> str:
    """A row for each folder: what it holds, and its files; the public face on top of all."""
    rows = ["| folder | what it holds | its files |", "|---|---|---|"]
    for folder in folders():
        files = ", ".join(path.stem for path in modules_in(folder))
        more = f"; {OTHERS[name(folder)]}" if name(folder) in OTHERS else ""
        rows.append(f"| `{name(folder)}/` | {sentence(folder / INIT)} | {files}{more} |")
    face = ", ".join(path.stem for path in modules_in(PACKAGE) if path.stem != "__main__")
    rows.append(f"| the public face | {sentence(PACKAGE / INIT)} | {face} |")
    return "\n".join(rows)


def list_of_modules() -> str:
    """A section for each folder, with a row for each file."""
    parts = []
    for folder in (PACKAGE, *folders()):
        title = "The package" if folder == PACKAGE else f"{name(folder)}/"
        rows = "\n".join(f"| `{path.stem}` | {sentence(path)} |" for path in modules_in(folder))
        parts.append(f"## {title}\n\n{sentence(folder / INIT)}.\n\n| file | what it holds |\n|---|---|\n{rows}")
    return "\n\n".join(parts)


def renewed(page: Path, made: str) -> str:
    """A page with what stands between its markers made anew."""
    text = page.read_text(encoding="utf-8")
    head, rest = text.split(BEGIN)
    _, tail = rest.split(END)
    return f"{head}{BEGIN}\n\n{made}\n\n{END}{tail}"


def pages() -> dict[Path, str]:
    """Both pages as they should be."""
    return {PAGE: renewed(PAGE, table_of_folders()), MODULES: renewed(MODULES, list_of_modules())}


if __name__ == "__main__":
    for path, text in pages().items():
        path.write_text(text, encoding="utf-8")
