"""The page on adding kinds is true: the pair it adds passes the contract tests, the group it shows is the real one."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from compoundkin.kinematics.groups import DyadSolver, GroupSolver
from compoundkin.model.pairs import Pair

pytestmark = pytest.mark.full

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "adding.md").read_text(encoding="utf-8")
PAIR, EXAMPLE, GROUP = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
CONTRACTS = (
    "tests/model/pairs/test_contract.py",
    "tests/analysis/centres/test_pairs.py",
    "tests/view/sketch/test_parts.py",
)


@pytest.fixture(scope="module")
def extended(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the package and its tests with the pair of the page in it, added as the page says."""
    root = tmp_path_factory.mktemp("extended")
    for name in ("compoundkin", "tests", "docs", "catalog"):
        shutil.copytree(ROOT / name, root / name, ignore=shutil.ignore_patterns("__pycache__", "gallery"))
    shutil.copy(ROOT / "pyproject.toml", root)
    (root / "compoundkin" / "model" / "pairs" / "oldham.py").write_text(PAIR, encoding="utf-8")
    for change in re.findall(r"```diff\n(.*?)```", PAGE, re.DOTALL):
        apply(root, change)
    return root


def apply(root: Path, change: str) -> None:
    """A file with lines taken out ("-") and put in ("+"), which must be there once."""
    first, *lines = change.splitlines()
    path = root / first.removeprefix("--- ")
    old = "\n".join(line[1:] for line in lines if line[0] != "+")
    new = "\n".join(line[1:] for line in lines if line[0] != "-")
    text = path.read_text(encoding="utf-8")
    assert text.count(f"\n{old}\n") == 1, f"{path.name} has changed: mend docs/adding.md"
    path.write_text(text.replace(f"\n{old}\n", f"\n{new}\n"), encoding="utf-8")


def run(root: Path, *words: str) -> str:
    """What Python says in the copy; it must succeed."""
    environment = {**os.environ, "PYTHONPATH": str(root), "PYTEST_ADDOPTS": ""}
    ran = subprocess.run([sys.executable, *words], cwd=root, env=environment, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout


def test_the_pair_passes_the_contract_tests(extended: Path) -> None:
    """All that a pin in a slot passes, which holds one coordinate too."""
    said = run(
        extended, "-m", "pytest", "-v", "-p", "no:cacheprovider", "-p", "no:xdist", "-k", "[T] or [S]", *CONTRACTS
    )
    passed = {code: set(re.findall(rf"::(\w+)\[{code}\] PASSED", said)) for code in "ST"}
    assert passed["S"] == passed["T"]
    assert "test_jacobian_against_central_differences" in passed["T"]


def test_its_example_is_true(extended: Path) -> None:
    said = run(extended, "-c", f"{EXAMPLE}\nprint(ck.__file__)")
    assert Path(said.strip()).is_relative_to(extended)


def test_its_docstrings_and_style(extended: Path) -> None:
    file = "compoundkin/model/pairs/oldham.py"
    run(extended, "-m", "doctest", file)
    run(extended, "-m", "ruff", "check", "--no-cache", file)


def test_the_group_it_shows_is_the_real_one() -> None:
    assert (ROOT / "compoundkin" / "kinematics" / "groups" / "prp.py").read_text(encoding="utf-8") == GROUP


def test_it_names_everything_that_must_be_answered() -> None:
    named = set(re.findall(r"`(\w+)`", PAGE))
    for contract in (Pair, GroupSolver, DyadSolver):
        assert contract.__abstractmethods__ <= named
        assert set(contract.__annotations__) <= named
