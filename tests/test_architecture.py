"""The house: its rooms, which import only from those above them, and what else of its order tools can tell.

Each rule has one test that lists all offenders. What a rule still has to forgive stands in a list below the rules;
such a list may only shrink: what no longer offends must be taken off it.
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from importlib import import_module
from inspect import isabstract
from pathlib import Path
from pkgutil import iter_modules
from types import ModuleType
from typing import Any

import networkx as nx
import pytest

import compoundkin
from compoundkin.base.suffixes import SUFFIXES
from compoundkin.kinematics.groups import DYADS
from compoundkin.model import loads, profiles
from compoundkin.model.attributes import ALIASES, CATALOGUE, DERIVED, MOTION_FIGURES
from compoundkin.model.fields import Item
from compoundkin.model.pairs import KINDS
from tests.source import (
    FILES,
    PACKAGE,
    ROOT,
    Function,
    classes,
    code_without_text,
    files_used,
    functions,
    nodes,
    room,
    rooms_used,
    texts,
    tree,
    where,
)


@pytest.fixture(scope="module", autouse=True)
def _code_is_forgotten() -> Iterator[None]:
    """A million parts of trees, which later tests of the same process would go through again and again."""
    yield
    for kept in (tree, nodes):
        kept.cache_clear()


# From the ground up: each room imports only from those before it. Rooms of one line are sisters, without arrows
# between them but those that ALLOWED_BETWEEN_SISTERS lists.
ROOMS = (
    ("base",),
    ("model",),
    ("structure",),
    ("kinematics",),
    ("programs", "configurations", "analysis", "dynamics", "synthesis", "files"),
    ("studies",),
    ("dimensional",),
    ("view",),
    ("studio",),
    ("cli",),
)
FLOOR = {room: floor for floor, rooms in enumerate(ROOMS) for room in rooms}
ALLOWED_BETWEEN_SISTERS: set[tuple[str, str]] = {
    ("dynamics", "analysis"),  # a mechanical advantage as a ratio of forces is held against that of velocities
}
# `__init__`, `__main__` and the named modules of the public face, such as `laws`: no rooms, and nobody imports them.
FACE = sorted(path for path in FILES if path.parent == PACKAGE)
# Files that play the same part in sister folders.
SAME_PART = {"__init__.py", "contract.py"}
# Pins follow from shared letters, so revolute pairs are made of them; __init__ gives users the words.
ALLOWED_KINDS = {("model/definition.py", "Revolute"), ("structure/__init__.py", "Revolute")}
OF_KINDS = ("model/pairs/", "kinematics/groups/")
# Words of attributes that are keys of files, words of drives, façades or single letters as well.
COMMON = {"advantage", "angle", "displacement", "x", "y", "speed", "rate", "value", "second", "acceleration", "jerk"}
COMMON |= {"force", "moment", "effort", "power"}
# Problems name places in files and calls, and remedies parts, that are called like attributes.
KEYS_OF_PROBLEMS = {
    "analysis/mechanical_advantage.py: .angle",
    "dynamics/driver_course.py: .effort",
    "dynamics/driver_course.py: .power",
    "dynamics/reactions/driver_efforts.py: .power",
    "model/loads/force.py: .force",
    "model/loads/pretension.py: .force",
    "model/pairs/cylinder.py: .stroke",
    "model/pairs/geared.py: .pressure_angle",
    "model/validation.py: .value",
    "view/plot/plane_plots.py: .x",
}
# Names with an underscore that Python and IPython give meaning to.
PROTOCOLS = re.compile(r"__\w+__|_replace|_asdict|_fields|_repr_\w+_")
# Nouns of the field among the names that end so.
NOUNS = {"finding", "bracketing", "sampling", "tracking", "rolling", "matching", "wording", "spring", "bearing"}

# dyads, synthesise and cognates are the last of the names; tasks, with eight kinds of them, is the last of the modules
# curve is the ninth of the tasks
# linkages, with thirteen of them, is a module of its own: they are looked up by these names
# exercise makes the sheets of a class, and with_dimensions stands beside with_driver and with_frame
# studio shows its window in a notebook
# coupler_atlas is looked up by itself: what is near a curve is asked many times
NAMES_AT_MOST, NAMES_OF_MODULES_AT_MOST, MODULES_AT_MOST = 72, 224, 12


def only_shrinks(found: Iterable[str], still: Iterable[str] = ()) -> None:
    """Nothing offends but what is listed, and all that is listed still does."""
    offending, known = set(found), set(still)
    assert not offending - known, f"offends: {sorted(offending - known)}"
    assert not known - offending, f"no longer offends, take it off the list: {sorted(known - offending)}"


# --- rooms ------------------------------------------------------------------------------------------------


def test_rooms_import_downward_only() -> None:
    """Lazy imports and those for types count too; the public face sees everything, and no room sees it."""
    offenders = []
    for path in FILES:
        own = room(path)
        for used in rooms_used(path) - {own}:
            sisters = FLOOR.get(used) == FLOOR.get(own) and (own, used) not in ALLOWED_BETWEEN_SISTERS
            if own in FLOOR and (used not in FLOOR or FLOOR[used] > FLOOR[own] or sisters):
                offenders.append(f"{where(path)} imports from {used}")
    only_shrinks(offenders)


def test_every_room_is_on_the_list() -> None:
    assert {path.name for path in PACKAGE.iterdir() if (path / "__init__.py").is_file()} == set(FLOOR)


def test_no_circle_of_files() -> None:
    """Lazy imports and those for types count; whatever is imported, one file of two is the deeper one."""
    graph = nx.DiGraph([(where(a), where(b)) for a, used in files_used().items() for b in used])
    only_shrinks(" ".join(sorted(circle)) for circle in nx.strongly_connected_components(graph) if len(circle) > 1)


BYTES_OF_A_FILE = 11_000  # on average, at least; it was 5,400 once


def test_the_house_is_not_cut_finer() -> None:
    """A file is an idea, not a fragment: a new one is welcome, but not many short ones."""
    # kinds have one file each, however short
    sizes = [path.stat().st_size for path in FILES if not where(path).startswith(OF_KINDS)]
    assert sum(sizes) / len(sizes) >= BYTES_OF_A_FILE


# --- names ------------------------------------------------------------------------------------------------


def test_no_class_is_named_twice() -> None:
    named = Counter(node.name for path in FILES for node in classes(path))
    only_shrinks((name for name, count in named.items() if count > 1))


def test_no_file_is_named_twice_in_a_room() -> None:
    """But for those that play the same part in sister folders."""
    paths = (path for path in FILES if path.name not in SAME_PART and path not in FACE)
    named = Counter((room(path), path.name) for path in paths)
    only_shrinks(f"{room}: {name}" for (room, name), count in named.items() if count > 1)


def test_public_names_are_few() -> None:
    assert len(compoundkin.__all__) == len(set(compoundkin.__all__)) <= NAMES_AT_MOST
    assert len(compoundkin._MODULES) <= MODULES_AT_MOST
    modules = [getattr(compoundkin, name) for name in compoundkin._MODULES]
    assert sum(len(module.__all__) for module in modules) <= NAMES_OF_MODULES_AT_MOST


# --- kinds of pairs, loads and profiles, ways to solve groups -----------------------------------------------


def kinds_below(base: type[Any], folder: ModuleType) -> set[type[Any]]:
    """What can be made of a base class, in the files of a folder."""
    for file in iter_modules(folder.__path__):
        import_module(f"{folder.__name__}.{file.name}")
    below = {kind for one in base.__subclasses__() for kind in (one, *kinds_below(one, folder))}
    return {kind for kind in below if kind.__module__.startswith(folder.__name__) and not isabstract(kind)}


def test_registries_know_every_kind_by_its_own_name() -> None:
    """They import its file when it is asked for: nobody would miss a line that is forgotten."""
    listed = [*loads.WRITTEN.items(), *loads.ALONG_PAIRS.items()]
    in_files = {kind for kind in kinds_below(loads.ListedLoad, loads) if hasattr(kind, "table")}
    assert {kind for _, kind in listed} == in_files
    assert [name for name, kind in listed if kind.table != name] == []
    written = {kind for kind in kinds_below(profiles.Profile, profiles) if kind.keys}
    assert {*profiles.WRITTEN.values()} == written
    assert [name for name, kind in profiles.WRITTEN.items() if kind.kind != name] == []


def test_kinds_are_named_in_their_own_folders_only() -> None:
    kinds = {kind.__name__ for kind in KINDS.values()} | set(DYADS)
    only_shrinks(
        f"{where(path)}: {kind}"
        for path in FILES
        if not where(path).startswith(OF_KINDS)
        for kind in sorted(kinds & set(re.findall(r"\w+", code_without_text(path))))
        if (where(path), kind) not in ALLOWED_KINDS
    )


def is_protocol(node: ast.ClassDef) -> bool:
    return any("Protocol" in ast.unparse(base) for base in node.bases)


def classes_told_apart(path: Path) -> Iterator[str]:
    """The names of classes that a file asks an object for, by `isinstance`, `issubclass` or a pattern."""
    for node in nodes(path):
        asked: list[ast.expr] = []
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            asked = node.args[1:2] if node.func.id in ("isinstance", "issubclass") else []
        elif isinstance(node, ast.MatchClass):
            asked = [node.cls]
        for one in asked:
            yield from (n.id if isinstance(n, ast.Name) else n.attr for n in ast.walk(one) if isinstance(n, NAMED))


NAMED = (ast.Name, ast.Attribute)


def test_pairs_are_told_apart_in_their_own_folder_only() -> None:
    """By their kind, by its base classes, and by the protocols of what only some kinds have."""
    bases = {base for kind in KINDS.values() for base in kind.__mro__ if base.__module__.startswith("compoundkin")}
    told = {base.__name__ for base in bases - {Item}}  # whatever a mechanism is written with
    folder = [path for path in FILES if where(path).startswith("model/pairs/")]
    told |= {node.name for path in folder for node in classes(path) if is_protocol(node)}
    others = [path for path in FILES if path not in folder]
    only_shrinks(f"{where(p)}: {name}" for p in others for name in classes_told_apart(p) if name in told)


def test_solvers_are_told_apart_in_their_own_folder_only() -> None:
    folder = [path for path in FILES if where(path).startswith("kinematics/groups/")]
    told = {node.name for path in folder for node in classes(path)}
    others = [path for path in FILES if path not in folder]
    only_shrinks(f"{where(p)}: {name}" for p in others for name in classes_told_apart(p) if name in told)


def test_nobody_follows_configurations_outside_kinematics() -> None:
    """Neither by the class and its module, nor by the function."""
    modules = r"\bcompoundkin\.kinematics\.curve\.(configuration_curve|followed_poses)\b"
    tracking = re.compile(rf"\bConfigurationCurve\b|{modules}")
    others = [path for path in FILES if room(path) not in ("kinematics", "__init__")]
    only_shrinks(f"{where(p)}: {word}" for p in others for word in tracking.findall(code_of(p)))


def code_of(path: Path) -> str:
    """A file's code with the modules that it imports from."""
    modules = (node.module for node in nodes(path) if isinstance(node, ast.ImportFrom))
    return code_without_text(path) + " " + " ".join(module or "" for module in modules)


# --- each thing in one place --------------------------------------------------------------------------------


def places_of(words: Iterable[str]) -> dict[str, set[str]]:
    """In which files each word is a literal."""
    found: dict[str, set[str]] = defaultdict(set)
    for path in FILES:
        for text in texts(path):
            found[text].add(where(path))
    return {word: found[word] for word in words}


def test_each_word_of_an_attribute_is_a_literal_in_one_module() -> None:
    """As a word, and as what follows a name: `f"{name}.angle"`."""
    words = {word for table in (*CATALOGUE.values(), *ALIASES.values(), *DERIVED.values()) for word in table}
    found = places_of([*(words - COMMON), *(f".{word}" for word in (*words, *MOTION_FIGURES))])
    offending = {f"{place}: {word}" for word in found for place in found[word] - {"model/attributes.py"}}
    only_shrinks(offending - KEYS_OF_PROBLEMS)


def test_each_suffix_of_files_stands_in_one_table() -> None:
    found = places_of({suffix for table in SUFFIXES.values() for suffix in table})
    only_shrinks(f"{place}: {word}" for word in found for place in found[word] - {"base/suffixes.py"})


def private_names(path: Path) -> Iterator[str]:
    """Private names that a file takes from elsewhere: imported, or members of objects that are not its own."""
    own = {node.name for node in nodes(path) if isinstance(node, Function | ast.ClassDef)}
    own |= {node.id for node in nodes(path) if isinstance(node, ast.Name)}
    own |= {node.attr for node in nodes(path) if isinstance(node, ast.Attribute) and ast.unparse(node.value) in OWN}
    taken = {node.attr for node in nodes(path) if isinstance(node, ast.Attribute)} - own
    taken |= {alias.name for node in nodes(path) if isinstance(node, ast.ImportFrom) for alias in node.names}
    return (name for name in taken if name.startswith("_") and not PROTOCOLS.fullmatch(name))


OWN = ("self", "cls")


def test_no_private_member_of_another_modules_object() -> None:
    # os._exit is documented, with its underscore
    documented = {"cli/shell.py: _exit"}
    only_shrinks((f"{where(path)}: {name}" for path in FILES for name in private_names(path)), documented)


# --- what is imported when ----------------------------------------------------------------------------------


def modules_loaded_by(statement: str) -> set[str]:
    code = f"import sys\n{statement}\nprint(*sys.modules)"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    return set(result.stdout.split())


def loaded_by(statement: str) -> set[str]:
    return {name.split(".")[0] for name in modules_loaded_by(statement)}


def test_importing_the_package_loads_nothing_heavy_but_numpy() -> None:
    loaded = loaded_by("import compoundkin")
    assert "numpy" in loaded
    assert not loaded & {"scipy", "networkx", "rich", "click", "matplotlib", "pandas", "pyarrow", "tomli_w"}


# What every mechanism is written with, and what is read of one from its file.
BEGINNING = ("import compoundkin", "import compoundkin\ncompoundkin.load('four-bar-norton')")


@pytest.mark.parametrize("statement", BEGINNING)
def test_what_a_mechanism_has_not_is_not_loaded(statement: str) -> None:
    """Kinds of pairs but pins and slides, loads, laws, profiles; whatever solves."""
    loaded = modules_loaded_by(statement)
    kinds = {kind.__module__ for kind in (*KINDS.values(), *loads.WRITTEN.values())}
    used = {f"compoundkin.model.{name}" for name in ("pairs.revolute", "pairs.prismatic", "loads.mass")}
    assert loaded & kinds == used
    rooms = ("model.laws", "model.profiles", "base.curves", "structure", "kinematics", "files.json_schema")
    assert not [name for name in loaded if name.startswith(tuple(f"compoundkin.{room}" for room in rooms))]


def test_the_page_of_a_mechanism_loads_what_is_on_it(tmp_path: Path) -> None:
    """Neither forces nor cams, which a linkage of bars has not; nor studies, nor the graph that users get."""
    page = tmp_path / "page.html"
    loaded = modules_loaded_by(f"from compoundkin.cli import cli\ncli(['report', 'six-bar', '-o', {str(page)!r}], "
                               "standalone_mode=False)")  # fmt: skip
    assert page.exists()
    rooms = (
        "dynamics.",
        "studies",
        "dimensional",
        "model.pairs.cam",
        "model.profiles.synthesised",
        "synthesis.linkages",
    )
    own = [f"compoundkin.{name}" for name in rooms]
    assert not [name for name in loaded if name.startswith((*own, "networkx", "scipy", "pandas", "rich"))]


def test_solving_loads_nothing_heavy_either() -> None:
    words = (
        "import compoundkin as ck\n"
        "m = ck.Mechanism('m', ck.link('frame', A=0, D=4), ck.link('c', A=0, B=1), ck.link('k', B=0, C=3),"
        " ck.link('r', D=0, C=3), ck.drive('c'))\n"
        "ck.solve(m)"
    )
    assert not loaded_by(words) & {"scipy", "networkx", "rich", "click"}


def test_no_import_in_a_function_of_the_numeric_core() -> None:
    """Imports inside functions are for start-up speed and optional extras: never in what runs for every block."""
    core = [PACKAGE / "base" / "series.py", PACKAGE / "base" / "poses.py", *(PACKAGE / "kinematics").rglob("*.py")]
    only_shrinks(
        f"{where(path)}: {function.name}"
        for path in core
        for function in functions(path)
        if any(isinstance(node, ast.Import | ast.ImportFrom) for node in ast.walk(function))
    )
