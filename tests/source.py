"""The package's own code, read: its files, classes and functions, and which file imports which."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "compoundkin"
FILES = sorted(PACKAGE.rglob("*.py"))
Function = ast.FunctionDef | ast.AsyncFunctionDef
Documented = ast.Module | ast.ClassDef | Function


@cache
def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def nodes(path: Path) -> tuple[ast.AST, ...]:
    """All that a file's code consists of, as `ast.walk` finds it, but operators and whether names are read or set."""
    found: list[ast.AST] = [tree(path)]
    for node in found:
        for part in vars(node).values():
            if isinstance(part, ast.AST) and part._fields:
                found.append(part)
            elif type(part) is list:
                found += [one for one in part if isinstance(one, ast.AST) and one._fields]
    return tuple(found)


@cache
def texts(path: Path) -> tuple[str, ...]:
    """The string constants of a file's code, its docstrings left out."""
    docs = {docstring_of(node) for node in nodes(path) if isinstance(node, Documented)}
    strings = (node for node in nodes(path) if isinstance(node, ast.Constant) and isinstance(node.value, str))
    return tuple(str(node.value) for node in strings if node not in docs)


def where(path: Path) -> str:
    """A file's place in the package."""
    return path.relative_to(PACKAGE).as_posix()


def room(path: Path) -> str:
    """The folder of the first level that a file is in, or the file's own name."""
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


@cache
def imports(path: Path) -> tuple[str, ...]:
    """The modules and names of the package that a file imports: also in functions, also for types only."""
    found: list[str] = []
    for node in nodes(path):
        if isinstance(node, ast.ImportFrom) and node.module:
            found += (f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Import):
            found += (alias.name for alias in node.names)
    return tuple(found)


def rooms_used(path: Path) -> set[str]:
    return {name.split(".")[1] for name in imports(path) if name.startswith("compoundkin.")}


def file_of(name: str) -> Path | None:
    """The file that holds a module, or the module that a name is imported from; none outside the package."""
    parts = name.split(".")
    if parts[0] != PACKAGE.name:
        return None
    for end in (len(parts), len(parts) - 1):
        place = ROOT.joinpath(*parts[:end])
        for path in (place.with_suffix(".py"), place / "__init__.py"):
            if path.is_file():
                return path
    return None


@cache
def files_used() -> dict[Path, set[Path]]:
    """For every file the files that it imports from."""
    return {path: {used for name in imports(path) if (used := file_of(name))} - {path} for path in FILES}


def classes(path: Path) -> Iterator[ast.ClassDef]:
    return (node for node in nodes(path) if isinstance(node, ast.ClassDef))


def functions(path: Path) -> Iterator[Function]:
    return (node for node in nodes(path) if isinstance(node, Function))


def docstring_of(node: ast.AST) -> ast.Constant | None:
    """The constant that is the docstring of a module, a class or a function."""
    if isinstance(node, Documented) and node.body:
        first = node.body[0]
        if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant) and isinstance(first.value.value, str):
            return first.value
    return None


def length(function: Function) -> int:
    """Its lines, from `def` to its end, its docstring left out."""
    text = docstring_of(function)
    documented = 0 if text is None else (text.end_lineno or 0) - text.lineno + 1
    return (function.end_lineno or 0) - function.lineno + 1 - documented


@cache
def code_without_text(path: Path) -> str:
    """The names and string constants of a file's code, its docstrings and comments left out."""
    words = [*texts(path)]
    for node in nodes(path):
        if isinstance(node, ast.Name):
            words.append(node.id)
        elif isinstance(node, ast.Attribute):
            words.append(node.attr)
        elif isinstance(node, ast.alias):
            words.append(node.name)
    return " ".join(words)
