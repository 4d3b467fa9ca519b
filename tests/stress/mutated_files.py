"""Mutated mechanism files: whatever is in a file, reading, solving and reporting answer or say what is wrong.

Catalog files are changed byte by byte, token by token and value by value. Anything but an answer or one of the
package's own errors is a fault, and so is what takes too long or writes half a file.
"""

from __future__ import annotations

import copy
import json
import random
import re
import tempfile
import time
import tomllib
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import compoundkin as ck
from compoundkin.files import dumps, loads
from tests.stress.outcome import Outcome, TooSlow, broken_off

CATALOG = Path(__file__).parents[2] / "catalog"
# One in so many files that can be read is solved and reported too: that takes far longer than reading it.
SOLVED = 8
# Seconds.
SLOW = 10.0
# Values that are written where other values stood.
ODD: tuple[Any, ...] = (
    *(0, -1, 1, 2**31, 2**63 - 1, -(2**63), 10**40, 0.0, -0.0, 1e308, -1e308, 5e-324, 1e-300, 1e150, 3e10),
    *(
        float("nan"),
        float("inf"),
        -float("inf"),
        True,
        False,
        "",
        " ",
        "frame",
        "A",
        "a.b",
        "0",
        "\x00",
        "\u202e",
        "é" * 300,
    ),
    *(
        [],
        [[]],
        [None],
        {},
        {"a": 1},
        [1, 2],
        [1, 2, 3],
        ["A", "B"],
        [[1, 2], [3, 4]],
        [[1], [1.2]],
        {"rad": 1},
        {"rad": {}},
    ),
    *({"polar": [1, 2]}, {"polar": 3}, {"from": 0, "to": 360, "step": 5}, {"from": 0, "to": 1, "step": 0}),
    *({"from": 0, "to": 1e9, "step": 1e-9}, {"rpm": 60}, {"deg": "x"}, "60 rpm", "0:360:5", [0] * 2000),
)


def mutated(seed: int, number: int) -> Outcome:
    """The outcome of a changed file: always the same for its number."""
    rng = random.Random(f"{seed} {number}")
    outcome, (text, suffix) = Outcome(number), written(rng)
    began = time.process_time()
    try:
        with broken_off(SLOW), warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            stage = answered(text, suffix, rng, outcome)
        outcome.counts[f"file {stage}"] += 1
        outcome.faults += [
            f"warning: {w.category.__name__}: {w.message}"[:200]
            for w in caught
            if issubclass(w.category, RuntimeWarning)
        ]
    except TooSlow:
        outcome.faults.append(f"slow: broken off after {SLOW:g} s")
    except RecursionError as error:
        outcome.faults.append(f"traceback: RecursionError: {str(error)[:100]}")
    except Exception as error:
        outcome.faults.append(f"traceback: {type(error).__name__}: {str(error)[:200]}")
    outcome.seconds = time.process_time() - began
    return outcome


def answered(text: str, suffix: str, rng: random.Random, outcome: Outcome) -> str:
    """Read a file and go on as far as it goes; return how far."""
    stage = "read"
    try:
        mechanism = loads(text, suffix.removeprefix("."))
        if rng.randrange(5) == 0:
            stage = "written"
            again = loads(dumps(mechanism, suffix.removeprefix(".")), suffix.removeprefix("."))
            if again != mechanism:
                outcome.faults.append("written: what is saved is another mechanism")
        if rng.randrange(SOLVED) == 0:
            for name, ask in STAGES.items():
                stage = name
                ask(mechanism)
            return "reported"
    except ck.errors.CompoundkinError as error:
        if not error.problems or not all(p.what for p in error.problems):
            outcome.faults.append(f"mute: {type(error).__name__} says nothing")
        return f"refused when {stage}"
    return "read"


def _saved(mechanism: ck.Mechanism) -> None:
    """What cannot be written leaves no file, and what was there stays."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "m.toml"
        path.write_text("whole", "utf-8")
        try:
            ck.save(mechanism, path)
        except ck.errors.CompoundkinError:
            assert path.read_text("utf-8") == "whole", "half a file was written"
            raise
        assert [p.name for p in Path(folder).iterdir()] == ["m.toml"], "something was left behind"
        tomllib.loads(path.read_text("utf-8"))


STAGES: dict[str, Callable[[ck.Mechanism], object]] = {
    "decomposed": ck.decompose,
    "saved": _saved,
    "solved": ck.solve,
    "reported": lambda mechanism: ck.report(mechanism).text(),
}


# --- files -----------------------------------------------------------------------------------------------


@cache
def originals() -> tuple[tuple[str, dict[str, Any]], ...]:
    """Every catalog file's text and what it says."""
    texts = [path.read_text("utf-8") for path in sorted(CATALOG.glob("*.toml"))]
    return tuple((text, tomllib.loads(text)) for text in texts)


def written(rng: random.Random) -> tuple[str, str]:
    """A changed file and its suffix."""
    text, data = rng.choice(originals())
    way = rng.choice((_bytes, _tokens, _lines, _values, _values, _values, _keys, _types))
    if way in (_bytes, _tokens, _lines):
        return way(text, rng), ".toml"
    data = copy.deepcopy(data)
    for _ in range(rng.choice((1, 1, 1, 2, 5))):
        way(data, rng)
    return json.dumps(data, default=str), ".json"


def _bytes(text: str, rng: random.Random) -> str:
    raw = bytearray(text.encode("utf-8"))
    for _ in range(rng.choice((1, 2, 10))):
        at = rng.randrange(len(raw))
        kind = rng.randrange(3)
        if kind == 0:
            raw[at] = rng.randrange(256)
        elif kind == 1:
            del raw[at : at + rng.choice((1, 1, 5, 100))]
            raw = raw or bytearray(b"x")
        else:
            raw[at:at] = bytes(rng.randrange(32, 127) for _ in range(rng.choice((1, 3))))
    return raw.decode("utf-8", errors="replace")


def _tokens(text: str, rng: random.Random) -> str:
    tokens = re.findall(r"\s+|[\w.+-]+|.", text)
    for _ in range(rng.choice((1, 2, 5))):
        at, other = rng.randrange(len(tokens)), rng.randrange(len(tokens))
        kind = rng.randrange(4)
        if kind == 0:
            tokens[at], tokens[other] = tokens[other], tokens[at]
        elif kind == 1:
            tokens[at] = tokens[other]
        elif kind == 2:
            tokens[at] = rng.choice(
                ("nan", "inf", "-", '"', "[", "{", "1e999", "0x7f", "1979-05-27", "true", "..", "1_0")
            )
        else:
            tokens[at] *= rng.choice((0, 2, 50))
    return "".join(tokens)


def _lines(text: str, rng: random.Random) -> str:
    lines = text.splitlines()
    at, other = rng.randrange(len(lines)), rng.randrange(len(lines))
    lines[at:at] = lines[other : other + rng.choice((1, 3))]
    del lines[rng.randrange(len(lines))]
    return "\n".join(lines)


def _spots(data: Any) -> list[tuple[Any, Any]]:
    """Every place of a value in nested tables and lists."""
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    return [spot for key, value in items for spot in ((data, key), *_spots(value))]


def _values(data: dict[str, Any], rng: random.Random) -> None:
    table, key = rng.choice(_spots(data) or [(data, "title")])
    old = table.get(key) if isinstance(table, dict) else table[key]
    if isinstance(old, int | float) and rng.random() < 0.6:
        table[key] = rng.choice(
            (-old, 0, old * 1e-9, old * 1e9, old + 1, old * rng.gauss(1, 0.5), [old, old * 1.1, old])
        )
    else:
        table[key] = copy.deepcopy(rng.choice(ODD))


def _keys(data: dict[str, Any], rng: random.Random) -> None:
    table, key = rng.choice([spot for spot in _spots(data) if isinstance(spot[0], dict)] or [(data, "title")])
    new = rng.choice(
        ("", "x", "Frame", "radius", "profile", "on", "points", str(key).upper(), str(key) + "s", "é", "a.b")
    )
    value = table.pop(key, None)
    if rng.random() < 0.7:
        table[new] = value


def _types(data: dict[str, Any], rng: random.Random) -> None:
    table, key = rng.choice(_spots(data) or [(data, "title")])
    old = table.get(key) if isinstance(table, dict) else table[key]
    table[key] = rng.choice(
        ([old], {"x": old}, str(old), [old, old], None, {"rad": old}, {"from": old, "to": old, "step": 1})
    )
