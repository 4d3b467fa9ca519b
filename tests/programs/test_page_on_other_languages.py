"""The page on programs in other languages is true: its programs run, and all print what `solve` finds."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

import compoundkin as ck
from compoundkin.cli import cli
from tests.catalog import mechanism
from tests.programs.languages import there

PAGE = (Path(__file__).parents[2] / "docs" / "programs_in_other_languages.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```(\w+)\n(.*?)```", PAGE, re.DOTALL)
COMMANDS = {
    "c": ("c", "gcc -Wall -Wextra -std=c99 -pedantic -Werror use.c -o use -lm && ./use"),
    "c++": ("c", "g++ -Wall -Wextra -pedantic -Werror -x c++ use.c -o use && ./use"),
    "python": ("py", f"{sys.executable} use.py"),
    "javascript": ("js", "node use.js"),
    "matlab": ("m", "octave-cli --norc --no-history use.m"),
}


@pytest.mark.parametrize("language", COMMANDS)
def test_the_programs_of_the_page_print_what_is_solved(
    language: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    there(language)
    if language == "c++" and shutil.which("g++") is None:
        pytest.skip("g++ is not there")
    suffix, command = COMMANDS[language]
    monkeypatch.chdir(tmp_path)
    (export,) = re.findall(r"^    compoundkin (export .*)", PAGE, re.MULTILINE)
    asked = export.replace(".c", f".{suffix}").split()
    assert CliRunner().invoke(cli, asked, catch_exceptions=False).exit_code == 0
    use = [text for name, text in BLOCKS if name == language.rstrip("+") and "import compoundkin" not in text]
    Path(f"use.{suffix}").write_text(use[0], encoding="utf-8")
    shown = subprocess.run(command, shell=True, capture_output=True, text=True)
    assert (shown.returncode, shown.stderr) == (0, "")
    place = ck.solve(mechanism("six-bar"), {"crank": [0.5]}).points["G"].position[0]
    assert [float(word) for word in shown.stdout.split()] == pytest.approx([place.real, place.imag], abs=1e-8)


def test_a_path_writes_itself_as_the_command_line_does(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (block,) = [text for _, text in BLOCKS if "import compoundkin" in text]
    names: dict[str, object] = {}
    exec(block, names)
    (export,) = re.findall(r"^    compoundkin (export .*)", PAGE, re.MULTILINE)
    assert CliRunner().invoke(cli, export.split(), catch_exceptions=False).exit_code == 0
    assert Path("six_bar.c").read_text(encoding="utf-8") == names["text"]
