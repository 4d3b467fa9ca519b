"""The order of the modules, what a plain import loads, and where names of kinds may occur."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

from compoundkin.groups import DYADS
from compoundkin.pairs import KINDS

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "compoundkin"
FILES = sorted(PACKAGE.rglob("*.py"))


def tables() -> dict[str, dict[str, int]]:
    """The rank of every module by the tables of `docs/architecture.md`: of the package ("") and inside folders.

    Modules of one row have one rank and may import each other.
    """
    found: dict[str, dict[str, int]] = {"": {}}
    folder, row = "", 0
    for line in (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8").splitlines():
        heading = re.match(r"Inside `(\w+/)`", line)
        if heading:
            folder = heading[1]
            found[folder] = {}
        elif line.startswith("| `"):
            for name in re.findall(r"`([\w/.]+)`", line.split("|")[1]):
                found[folder][name.removesuffix(".py")] = row
            row += 1
    return found


def part_of(path: Path) -> str:
    """The first name under the package: a module or a folder with a slash."""
    first = path.relative_to(PACKAGE).parts[0]
    return first.removesuffix(".py") if first.endswith(".py") else f"{first}/"


def imports(path: Path) -> list[str]:
    """The modules of the package that a file imports at its top: not in a function, not for types only."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    inside: set[ast.AST] = set()
    for node in ast.walk(tree):
        for_types = isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)
        if isinstance(node, ast.FunctionDef) or for_types:
            inside.update(ast.walk(node))
    found = []
    for node in ast.walk(tree):
        if node not in inside and isinstance(node, ast.ImportFrom) and node.module:
            found += [f"{node.module}.{alias.name}" for alias in node.names]
        elif node not in inside and isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
    return [name.removeprefix("compoundkin.") for name in found if name.startswith("compoundkin.")]


def as_part(name: str) -> str:
    first = name.split(".")[0]
    return f"{first}/" if (PACKAGE / first).is_dir() else first


def test_every_module_has_its_place_in_the_description() -> None:
    missing = {part_of(path) for path in FILES} - {"__init__", "__main__"} - set(tables()[""])
    assert not missing, f"docs/architecture.md does not mention {sorted(missing)}"
    for folder in set(tables()) - {""}:
        inside = {path.stem for path in (PACKAGE / folder).glob("*.py")} - {"__init__"}
        assert inside == set(tables()[folder]), f"docs/architecture.md and {folder} differ"


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_imports_point_up_the_list(path: Path) -> None:
    """Each module imports only from those above it; only `__init__` and `__main__` see everything."""
    own, ranks = part_of(path), tables()
    if own in ranks[""]:
        parts = {as_part(name) for name in imports(path)} & set(ranks[""])
        below = [name for name in parts if ranks[""][name] > ranks[""][own]]
        assert not below, f"{path.name} imports {below}, which stand below it in docs/architecture.md"
    if own in ranks and path.stem in ranks[own]:
        own_folder = own.removesuffix("/") + "."
        inner = {name.removeprefix(own_folder).split(".")[0] for name in imports(path) if name.startswith(own_folder)}
        below = [name for name in inner & set(ranks[own]) if ranks[own][name] > ranks[own][path.stem]]
        assert not below, f"{path.name} imports {below}, which stand below it inside {own}"


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
    tree = ast.parse(path.read_text(encoding="utf-8"))
    docs = {
        node.body[0].value
        for node in ast.walk(tree)
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)
        and node.body
        and isinstance(node.body[0], ast.Expr)
        and isinstance(node.body[0].value, ast.Constant)
    }
    words = []
    for node in ast.walk(tree):
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
ALLOWED = {("structure/pins.py", "Revolute"), ("structure/__init__.py", "Revolute")}


@pytest.mark.parametrize(
    "path", [p for p in FILES if part_of(p) not in ("pairs/", "groups/")], ids=lambda p: str(p.relative_to(PACKAGE))
)
def test_kinds_are_named_in_their_own_folders_only(path: Path) -> None:
    kinds = {kind.__name__ for kind in KINDS} | set(DYADS)
    code = code_without_text(path)
    where = str(path.relative_to(PACKAGE))
    named = {kind for kind in kinds if re.search(rf"\b{kind}\b", code)}
    assert not {kind for kind in named if (where, kind) not in ALLOWED}


def test_no_import_in_a_function_of_the_numeric_core() -> None:
    """Imports inside functions are for start-up speed and optional extras: never in what runs for every block."""
    core = [PACKAGE / "series.py", PACKAGE / "poses.py", *(PACKAGE / "groups").glob("*.py")]
    for path in [*core, *(PACKAGE / "motion").glob("*.py")]:
        tree = ast.parse(path.read_text(encoding="utf-8"))
        functions = [n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef)]
        assert not [n for f in functions for n in ast.walk(f) if isinstance(n, ast.Import | ast.ImportFrom)]
