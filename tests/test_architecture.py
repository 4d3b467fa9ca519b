"""The house: its rooms, which import only from those above them, and what else of its order tools can tell."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from compoundkin.kinematics.groups import DYADS
from compoundkin.model.pairs import KINDS

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "compoundkin"
FILES = sorted(PACKAGE.rglob("*.py"))

# From the ground up: each room imports only from those before it. Rooms of one line are sisters, without arrows
# between them but those that ALLOWED_BETWEEN_SISTERS lists.
ROOMS = (
    ("base",),
    ("model",),
    ("structure",),
    ("kinematics",),
    ("configurations", "analysis", "synthesis", "files"),
    ("view",),
    ("cli",),
)
FLOOR = {room: floor for floor, rooms in enumerate(ROOMS) for room in rooms}
ALLOWED_BETWEEN_SISTERS: set[tuple[str, str]] = set()


@cache
def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def where(path: Path) -> str:
    return str(path.relative_to(PACKAGE))


def room(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imports(path: Path) -> Iterator[str]:
    """The modules of the package that a file imports: also in functions, also for types only."""
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.ImportFrom) and node.module:
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)


def rooms_used(path: Path) -> set[str]:
    return {name.split(".")[1] for name in imports(path) if name.startswith("compoundkin.")}


def test_rooms_import_downward_only() -> None:
    """Lazy imports and those for types count too; `__init__` and `__main__` of the package see everything."""
    offenders = []
    for path in FILES:
        own = room(path)
        for used in rooms_used(path) - {own}:
            sisters = FLOOR.get(used) == FLOOR.get(own) and (own, used) not in ALLOWED_BETWEEN_SISTERS
            if own in FLOOR and (used not in FLOOR or FLOOR[used] > FLOOR[own] or sisters):
                offenders.append(f"{where(path)} imports from {used}")
    assert not offenders


def loaded_by(statement: str) -> set[str]:
    code = f"import sys\n{statement}\nprint(*{{name.split('.')[0] for name in sys.modules}})"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    return set(result.stdout.split())


def test_importing_the_package_loads_nothing_heavy_but_numpy() -> None:
    loaded = loaded_by("import compoundkin")
    assert "numpy" in loaded
    assert not loaded & {"scipy", "networkx", "rich", "click", "matplotlib", "pandas", "pyarrow", "tomli_w"}


def test_solving_loads_nothing_heavy_either() -> None:
    words = (
        "import compoundkin as ck\n"
        "m = ck.Mechanism('m', ck.link('frame', A=0, D=4), ck.link('c', A=0, B=1), ck.link('k', B=0, C=3),"
        " ck.link('r', D=0, C=3), ck.drive('c'))\n"
        "ck.solve(m)"
    )
    assert not loaded_by(words) & {"scipy", "networkx", "rich", "click"}


def code_without_text(path: Path) -> str:
    """The names and string constants of a file's code, its docstrings and comments left out."""
    docs = {
        node.body[0].value
        for node in ast.walk(tree(path))
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)
        and node.body
        and isinstance(node.body[0], ast.Expr)
        and isinstance(node.body[0].value, ast.Constant)
    }
    words = []
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.Name):
            words.append(node.id)
        elif isinstance(node, ast.Attribute):
            words.append(node.attr)
        elif isinstance(node, ast.alias):
            words.append(node.name)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and node not in docs:
            words.append(node.value)
    return " ".join(words)


# Pins follow from shared letters, so the structure makes revolute pairs itself; __init__ gives users the words.
ALLOWED = {("structure/composites.py", "Revolute"), ("structure/__init__.py", "Revolute")}
OF_KINDS = ("model/pairs/", "kinematics/groups/")


def test_kinds_are_named_in_their_own_folders_only() -> None:
    kinds = {kind.__name__ for kind in KINDS} | set(DYADS)
    offenders = [
        f"{where(path)}: {kind}"
        for path in FILES
        if not where(path).startswith(OF_KINDS)
        for kind in sorted(kinds)
        if re.search(rf"\b{kind}\b", code_without_text(path)) and (where(path), kind) not in ALLOWED
    ]
    assert not offenders


def test_no_import_in_a_function_of_the_numeric_core() -> None:
    """Imports inside functions are for start-up speed and optional extras: never in what runs for every block."""
    core = [PACKAGE / "base" / "series.py", PACKAGE / "base" / "poses.py", *(PACKAGE / "kinematics").rglob("*.py")]
    offenders = [
        f"{where(path)}: {function.name}"
        for path in core
        for function in ast.walk(tree(path))
        if isinstance(function, ast.FunctionDef)
        if any(isinstance(node, ast.Import | ast.ImportFrom) for node in ast.walk(function))
    ]
    assert not offenders
