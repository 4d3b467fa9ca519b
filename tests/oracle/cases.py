"""What is asked about: shipped mechanisms, random ones and bad files kept as text, and commands."""

from __future__ import annotations

import gzip
import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from tests.oracle import parts, program

# Texts of mechanism files written once, by their names; bad ones are called "bad ...".
STORE = Path(__file__).with_name("cases.json.gz")
BAD = "bad "
QUICK = 60
PAGES = ("six-bar", "five-bar", "disc-cam-roller-program", "geared-five-bar", "class-iii-six-bar")
# Every so many of the random mechanisms have their texts recorded too.
TEXTS_OF = 10

Question = Callable[[], Any]


@dataclass(frozen=True)
class Case:
    """A mechanism, a bad file or a command, and what is asked about it, by the parts of the record."""

    name: str
    questions: dict[str, Question]


def cases(quick: bool) -> Iterator[Case]:
    """All cases in their order; a quick record leaves out texts, commands and most random mechanisms."""
    for name in program.catalog_names():
        yield Case(f"catalog/{name}", _catalog(name, quick))
    good = [name for name in stored() if not name.startswith(BAD)]
    chosen = good[:: max(1, len(good) // QUICK)][:QUICK] if quick else good
    for name in chosen:
        yield Case(f"random/{name}", _random(name, not quick and good.index(name) % TEXTS_OF == 0))
    for name in stored():
        if name.startswith(BAD):
            yield Case(name, {"refusal": lambda name=name: parts.reading(_loading(name)())})
    if not quick:
        for words in commands():
            yield Case(f"command {' '.join(words)}", {"commands": lambda words=words: program.command(*words)})


@cache
def stored() -> dict[str, str]:
    """The texts of the mechanism files that were written once."""
    found: dict[str, str] = json.loads(gzip.decompress(STORE.read_bytes()))
    return dict(sorted(found.items()))


def commands() -> Iterator[tuple[str, ...]]:
    """Commands with their words, each verb on some mechanisms."""
    yield ("--help",)
    yield from ((verb, "--help") for verb in program.verbs())
    for line in COMMANDS.strip().splitlines():
        for name in MECHANISMS if "FILE" in line else ("",):
            yield tuple(line.replace("FILE", name).split())
    yield from (tuple(line.split()) for line in OTHERS.strip().splitlines())


def _catalog(name: str, quick: bool) -> dict[str, Question]:
    mechanism = cache(lambda: program.catalog_mechanism(name))
    page = {"page": parts.page} if name in PAGES and not quick else {}
    asked = {**parts.ALWAYS, **({} if quick else parts.TEXTS), **page}
    if quick:
        # some take seconds, and those of the random mechanisms are asked for
        del asked["alternatives"]
    return {part: lambda ask=ask: ask(mechanism()) for part, ask in asked.items()}


def _random(name: str, texts: bool) -> dict[str, Question]:
    mechanism = cache(_loading(name))
    asked = {**parts.ALWAYS, **(parts.TEXTS if texts else {})}
    return {part: lambda ask=ask: ask(mechanism()) for part, ask in asked.items()}


def _loading(name: str) -> Question:
    path = Path(f"{name.replace(' ', '-').replace('!', '')}.toml")

    def loading() -> Any:
        path.write_text(stored()[name], "utf-8")
        return program.loaded(str(path))

    return loading


MECHANISMS = ("six-bar", "five-bar", "disc-cam-offset-roller", "stephenson-iii", "parallelogram-third-crank")
COMMANDS = """
report FILE
report FILE --format markdown
report FILE --format json
structure FILE
structure FILE --alternatives
structure FILE --equations
structure FILE --equations --format json
structure FILE --format markdown
solve FILE
solve FILE --order 3 -o table.csv
solve FILE --order 1 -o table.json
draw FILE
draw FILE --view graph
centres FILE
centres FILE --derivation
centres FILE --format json
configurations FILE
configurations FILE --format json
circuits FILE
circuits FILE --format json
check FILE
check FILE --format json
catalog show FILE
"""
OTHERS = """
catalog
catalog list
catalog list --format json
catalog show six-bra
schema
completion bash
completion zsh
completion fish
atlas --links 6
atlas --links 6 --inversions
atlas --links 7 --mobility 2
atlas --links 7 --trusses
atlas --links 6 --groups
atlas --links 4 --format json
new drawn-up.toml
new ./drawn-up.toml
report drawn-up.toml
report six-bar --at 35
report six-bar --centres 35
report six-bar --from 0 --to 90 --step 10 --speed 300rpm --order 3
report six-bar --output G.velocity,bar.angle
report six-bar --format html
report triple-rocker
report no-such-mechanism
report six-bar --no-such-option
reprot six-bar
solve six-bar --at 0,35,60
solve six-bar --at 35 --output G.velocity,bar.angle
solve six-bar --at 35 --output Q.velocity
solve six-bar --mode rocker=-1 --at 35
solve six-bar --time 0:1:0.1
solve five-bar --drive left=0:90:10 --drive right=100
solve disc-cam-roller-program --time 0:1:0.05
solve six-bar -o table.xyz
draw six-bar --view loops
draw six-bar --view groups
draw six-bar --view circle
draw six-bar --at 35 --centres
draw six-bar --at 35 --vectors velocity
draw six-bar --at 35 --polygon velocity
plot six-bar G.speed -o plot.svg
plot six-bar
plot six-bar Z.speed
animate six-bar -o moving.svg
animate six-bar -o moving.txt
circuits five-bar --driver left --at right=100
circuits six-bar --from 20 --to 35
configurations six-bar --at 35
centres five-bar --at left=60 --at right=100
check triple-rocker
"""
