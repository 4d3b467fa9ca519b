"""The public face: forty names, the rest in named modules; what moved says where it is; nothing names what is gone."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from functools import cache, reduce
from importlib import import_module
from pathlib import Path

import pytest

import compoundkin as ck
from compoundkin.cli import VERBS
from tests.packages import CALLS
from tests.source import FILES, PACKAGE, ROOT
from tests.test_architecture import only_shrinks

MOVED: dict[str, str] = ck._MOVED
MODULES: tuple[str, ...] = ck._MODULES
DOCS = sorted((*ROOT.glob("docs/**/*.md"), *ROOT.glob("docs/**/*.rst"), *ROOT.glob("docs/**/*.ipynb")))


def test_every_public_name_is_there() -> None:
    only_shrinks(name for name in ck.__all__ if not hasattr(ck, name))
    assert set(dir(ck)) == {*ck.__all__, *MODULES}


def test_every_name_stands_in_one_place() -> None:
    listed = [*ck.__all__, *(name for part in MODULES for name in getattr(ck, part).__all__)]
    # a plot of circuits, in polar coordinates, ...: the kinds of plots are called like what they show
    # and `equations.link` is the textbook routine of that name;
    # `laws.dwell` is a part of a driver's program, `goals.dwell` one of an output; poses and functions are approached
    # by `goals` and met by `tasks`; `synthesise` makes linkages, that of `profiles` cams
    known = {*ck.plots.__all__, "dwell", "function", "link", "poses", "synthesise"}
    twice = {name for name in listed if listed.count(name) > 1} - known
    assert twice == set()


def test_named_modules_only_list_what_rooms_have() -> None:
    """A sentence, an example, imports from rooms and the list of their names: nothing else."""
    for part in MODULES:
        module = import_module(f"compoundkin.{part}")
        body = ast.parse((PACKAGE / f"{part}.py").read_text(encoding="utf-8")).body
        imports = [node for node in body if isinstance(node, ast.ImportFrom)]
        names = {alias.name for node in imports for alias in node.names if node.module != "__future__"}
        assert len(body) == len(imports) + 2, part
        assert ">>>" in (module.__doc__ or ""), part
        assert set(module.__all__) == names, part


def test_named_modules_need_no_import_and_are_loaded_when_asked_for() -> None:
    words = (
        "import sys, compoundkin as ck",
        "names = {f'compoundkin.{part}' for part in ck._MODULES}",
        "print(len(names), len(names & set(sys.modules)))",
        "print(all(getattr(ck, part).__all__ for part in ck._MODULES))",
        "from compoundkin.laws import rise",
        "from compoundkin import configurations, results",
        "print(rise is ck.laws.rise, configurations.__name__, results.Motion.__name__)",
    )
    ran = subprocess.run([sys.executable, "-c", "\n".join(words)], capture_output=True, text=True, check=True, cwd=ROOT)
    assert ran.stdout == f"{len(MODULES)} 0\nTrue\nTrue configurations Motion\n"


@pytest.mark.parametrize("name", MOVED)
def test_a_name_that_moved_says_where_it_is(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(AttributeError, match=re.escape(f"compoundkin.{name} is now {MOVED[name]}")):
        getattr(ck, name)
    monkeypatch.chdir(tmp_path)
    mechanism = ck.load("crank-rocker")
    known = {"compoundkin": ck, "mechanism": mechanism, "motion": ck.solve(mechanism, {"crank": [0.5]})}
    eval(MOVED[name], known)


def test_the_changelog_tells_what_moved() -> None:
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (.*?) \| (.*?) \|$", text, re.MULTILINE)
    told = {old: new for olds, new in rows for old in re.findall(r"`(\w+)`", olds)}
    for name, target in MOVED.items():
        short = target.replace("compoundkin.", "ck.")
        assert {f"`{short}`", f"`{short.removesuffix(f'.{name}')}`"} & set(re.findall(r"`.*?`", told[name])), name


# What docs/adding.md adds, and a global name of the page's scripts.
NOT_OURS = {"compoundkin.model.pairs.oldham", "compoundkin.oldham", "compoundkin.uPlot"}


@cache
def is_there(path: str) -> bool:
    """Whether a dotted path leads anywhere: to a module, or from one on by attributes."""
    parts = path.split(".")
    return any(leads(parts[:k], parts[k:]) for k in range(1, len(parts) + 1))


def leads(module: list[str], attributes: list[str]) -> bool:
    try:
        reduce(getattr, attributes, import_module(".".join(module)))
    except (ImportError, AttributeError):
        return False
    return True


def paths(text: str) -> Iterator[str]:
    """The dotted paths into the package that a text names, `ck.laws.rise` or `compoundkin.base.errors`."""
    for rest in re.findall(r"(?<![\w./-])(?:ck|compoundkin)((?:\.[A-Za-z_]\w*)+)", text):
        yield f"compoundkin{rest}"


def described(text: str) -> Iterator[str]:
    """The names that a page of the reference describes or lists."""
    text, module = re.sub(r"^\.\. toctree::.*?^(?=\S)", "", text, flags=re.MULTILINE | re.DOTALL), "compoundkin"
    for word, name, listed in re.findall(r"^\.\. (currentmodule|auto\w+):: (\S+)$|^   (\w+)$", text, re.MULTILINE):
        if word == "currentmodule":
            module = name
        else:
            yield name if name.startswith("compoundkin.") else f"{module}.{name or listed}"


def test_nothing_names_what_is_gone() -> None:
    """The README, the pages, the notebooks and all sources with their examples."""
    offenders = []
    for path in (ROOT / "README.md", *DOCS, *FILES):
        text = path.read_text(encoding="utf-8")
        named = {*paths(text), *(described(text) if path.suffix == ".rst" else ())}
        offenders += [f"{path.relative_to(ROOT)}: {name}" for name in sorted(named - NOT_OURS) if not is_there(name)]
    only_shrinks(offenders)


def test_packages_are_tried_with_every_verb() -> None:
    assert set(CALLS) == set(VERBS)
