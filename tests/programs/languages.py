"""Runs texts of programs: by gcc, Python, Node and Octave, many programs and poses at once."""

from __future__ import annotations

import ctypes
import json
import math
import os
import shutil
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from compoundkin.base.arrays import Number
from compoundkin.programs.sources import LANGUAGES
from compoundkin.programs.sources.written_program import WrittenProgram

# What a language needs to be run.
NEEDED = {"c": "gcc", "javascript": "node", "matlab": "octave-cli"}
WARNINGS = ("-Wall", "-Wextra", "-pedantic", "-Wmissing-prototypes", "-Wconversion", "-Wshadow", "-Werror")
Poses = Sequence[Number]  # of each program: arguments x poses


def there(language: str) -> None:
    """Skip where a language cannot be run, unless it is required."""
    needed = NEEDED.get(language)
    if needed is not None and shutil.which(needed) is None:
        assert os.environ.get("COMPOUNDKIN_LANGUAGES") != "required", f"{needed} is required, and not there"
        pytest.skip(f"{needed} is not there")


def run(language: str, programs: Sequence[WrittenProgram], poses: Poses, folder: Path) -> list[Number]:
    """The numbers of each program: (assembled, *results) x poses."""
    there(language)
    texts = [LANGUAGES[language].text(program) for program in programs]
    return RUNS[language](programs, texts, poses, folder)


def _c(programs: Sequence[WrittenProgram], texts: Sequence[str], poses: Poses, folder: Path) -> list[Number]:
    """One file of all functions, and loops over the poses, in one library."""
    parts = list(texts)
    for one in programs:
        n, m = len(one.arguments), len(one.results)
        copied = "".join(f"        out[k * {m + 1} + {j + 1}] = y.{r.name};\n" for j, r in enumerate(one.results))
        given = "".join(f"        x.{a.name} = in[k * {n} + {j}];\n" for j, a in enumerate(one.arguments))
        parts.append(
            f"void loop_{one.name}(const double *in, double *out, int poses);\n"
            f"void loop_{one.name}(const double *in, double *out, int poses)\n{{\n"
            f"    {one.name}_inputs x = {one.name.upper()}_OWN;\n    {one.name}_outputs y;\n    int k;\n"
            f"    for (k = 0; k < poses; k++) {{\n{given}"
            f"        out[k * {m + 1}] = {one.name}(&x, &y);\n{copied}    }}\n    (void)in;\n}}\n"
        )
    source, library = folder / "all.c", folder / "all.so"
    source.write_text("\n".join(parts), encoding="utf-8")
    command = ["gcc", "-std=c99", *WARNINGS, "-shared", "-fPIC", str(source), "-o", str(library), "-lm"]
    made = subprocess.run(command, capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    loaded = ctypes.CDLL(str(library))
    found = []
    for one, values in zip(programs, poses, strict=True):
        given = np.ascontiguousarray(np.transpose(values))
        out = np.empty((np.shape(values)[1], len(one.results) + 1))
        pointer = ctypes.POINTER(ctypes.c_double)
        getattr(loaded, f"loop_{one.name}")(given.ctypes.data_as(pointer), out.ctypes.data_as(pointer), len(out))
        found.append(out.T)
    return found


def _python(programs: Sequence[WrittenProgram], texts: Sequence[str], poses: Poses, folder: Path) -> list[Number]:
    found = []
    for one, text, values in zip(programs, texts, poses, strict=True):
        names: dict[str, object] = {}
        exec(compile(text, f"{one.name}.py", "exec"), names)
        function = names[one.name]
        assert callable(function)
        made = [function(**_named(one, pose)) for pose in np.transpose(values).tolist()]
        found.append(np.array([[float(pose[name]) for name in _names(one)] for pose in made]).T)
    return found


def _javascript(programs: Sequence[WrittenProgram], texts: Sequence[str], poses: Poses, folder: Path) -> list[Number]:
    """Each text is a file that is required; numbers go and come as words, for JSON has no NaN."""
    lines = ["const words = (table) => table.map((row) => row.map(String));"]
    for one, text in zip(programs, texts, strict=True):
        (folder / f"{one.name}.js").write_text(text, encoding="utf-8")
    given = [
        [dict(_named(one, map(repr, pose))) for pose in np.transpose(v).tolist()]
        for one, v in zip(programs, poses, strict=True)
    ]
    lines.append(f"const given = {json.dumps(given)};")
    lines.append("const number = (word) => ({ nan: NaN, inf: Infinity, '-inf': -Infinity })[word] ?? Number(word);")
    for k, one in enumerate(programs):
        lines.append(f"const f{k} = require('./{one.name}.js');")
        lines.append(
            f"console.log(JSON.stringify(words(given[{k}].map((pose) => {{ const read = {{}}; "
            f"for (const name in pose) read[name] = number(pose[name]); const y = f{k}(read); "
            f"return {json.dumps(_names(one))}.map((name) => Number(y[name])); }}))));"
        )
    script = folder / "all.js"
    script.write_text("\n".join(lines), encoding="utf-8")
    made = subprocess.run(["node", str(script)], capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    tables = [json.loads(line) for line in made.stdout.splitlines()]
    return [np.array([[float(word.replace("Infinity", "inf")) for word in row] for row in table]).T for table in tables]


def _matlab(programs: Sequence[WrittenProgram], texts: Sequence[str], poses: Poses, folder: Path) -> list[Number]:
    """Each text is a function file; all poses are given at once, as rows of a binary file."""
    lines = [f"addpath('{folder}'); out = fopen('{folder}/out.bin', 'w');"]
    for one, text, values in zip(programs, texts, poses, strict=True):
        (folder / f"{one.name}.m").write_text(text, encoding="utf-8")
        np.ascontiguousarray(values, dtype=float).tofile(folder / f"{one.name}.bin")
        n, m = np.shape(values)
        lines.append(f"x = fread(fopen('{folder}/{one.name}.bin'), [{m}, {n}], 'double')';")
        lines.append(f"y = {one.name}({', '.join(f'x({k + 1}, :)' for k in range(n))});")
        lines += [f"fwrite(out, y.{name} + zeros(1, {m}), 'double');" for name in _names(one)]
    script = folder / "every_one.m"
    script.write_text("\n".join([*lines, "fclose(out);"]), encoding="utf-8")
    made = subprocess.run(["octave-cli", "--norc", "--no-history", str(script)], capture_output=True, text=True)
    assert (made.returncode, made.stderr) == (0, "")
    numbers = np.fromfile(folder / "out.bin")
    found = []
    for one, values in zip(programs, poses, strict=True):
        count = (len(one.results) + 1) * np.shape(values)[1]
        found.append(numbers[:count].reshape(len(one.results) + 1, -1))
        numbers = numbers[count:]
    return found


def _names(program: WrittenProgram) -> list[str]:
    return ["assembled", *(one.name for one in program.results)]


def _named(program: WrittenProgram, pose: object) -> dict[str, object]:
    return dict(zip([one.name for one in program.arguments], pose, strict=True))  # type: ignore[call-overload]


RUNS: dict[str, Callable[[Sequence[WrittenProgram], Sequence[str], Poses, Path], list[Number]]] = {
    "c": _c,
    "python": _python,
    "javascript": _javascript,
    "matlab": _matlab,
}


def assert_alike(found: Number, expected: Number, tolerance: float = 1e-12) -> None:
    """Numbers are equal, relative to the largest of their row; what is no number is none in both."""
    assert np.array_equal(np.isnan(found), np.isnan(expected))
    assert np.array_equal(np.isinf(found), np.isinf(expected))
    finite = np.isfinite(expected)
    assert np.array_equal(found[np.isinf(found)], expected[np.isinf(found)])
    largest = np.max(np.where(finite, np.abs(expected), 0.0), axis=1, keepdims=True)
    error = np.where(finite, np.abs(np.where(finite, found, 0.0) - np.where(finite, expected, 0.0)), 0.0)
    assert np.all(error <= tolerance * np.where(largest == 0.0, 1.0, largest)), (error / largest).max()
    assert not math.isnan(float(error.sum()))
