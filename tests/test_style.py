"""The house style that tools can tell: strict types, lint and layout."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent

pytestmark = pytest.mark.full


# what mypy would keep for a second run takes a tenth of its time
@pytest.mark.parametrize(
    "tool", [["mypy", "--no-incremental"], ["ruff", "check", "."], ["ruff", "format", "--check", "."]], ids=" ".join
)
def test_the_tool_is_content(tool):
    result = subprocess.run([sys.executable, "-m", *tool], cwd=ROOT, capture_output=True, text=True)
    assert result.returncode == 0, result.stdout + result.stderr
