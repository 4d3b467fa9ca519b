"""Misuse: every public function called with what it is not for. Only the package's own errors may come of it.

One argument or two of a call that is right are replaced by something odd. What a word makes of it is put into a
mechanism and solved, for some slips show only there.
"""

from __future__ import annotations

import contextlib
import inspect
import io
import os
import random
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import compoundkin as ck
from tests.stress.outcome import Outcome, TooSlow, broken_off

# Seconds.
SLOW = 10.0
# What takes long or makes windows is asked less often: one in so many.
SELDOM = 10
HEAVY = (
    "animate",
    "page",
    "plot",
    "plots.",
    "chains.",
    "chains.random_mechanism",
    "alternatives",
    "circuits",
    "report",
)
MODULES = ("chains", "equations", "exchange", "figures", "laws", "plots", "profiles")
# Atlases of more links take minutes by design and say so; they are no slips.
LEFT_OUT = ("exchange.formats", "exchange.shipped", "chains.chains_of", "chains.symmetric_drivers")


class Strange:
    """An object of no use."""

    def __repr__(self) -> str:
        return "Strange()"


def odd(rng: random.Random) -> Any:
    """Something that is hardly meant."""
    made: tuple[Callable[[], Any], ...] = (
        *(
            lambda v=v: v
            for v in (None, True, False, 0, 1, -1, 7, 2**70, 0.0, -1.5, 1e308, 5e-324, 1j, "", " ", "x", "A", "coupler")
        ),
        *(
            lambda v=v: v
            for v in (float("nan"), float("inf"), -float("inf"), b"A", "\x00", "\ud800", "A.x", "coupler.angle", "../x")
        ),
        *(
            lambda v=v: v
            for v in ((), (1,), (1, 2), ("a", "b"), (None,), [[1.0], [2.0, 3.0]], {1: 2}, {"crank": None}, {"x": "y"})
        ),
        *(lambda v=v: v for v in (range(3), slice(1), int, len, Ellipsis, np.float32(2), np.datetime64("2020-01-01"))),
        lambda: [],
        lambda: {},
        lambda: {1, 2},
        lambda: np.array([]),
        lambda: np.zeros((2, 3)),
        lambda: np.array([1.0, np.nan]),
        lambda: np.ma.masked_array([1.0, 2.0], [True, False]),
        lambda: np.array([1 + 1j, 2.0]),
        lambda: np.array(["a"], dtype=object),
        lambda: iter([1, 2]),
        Strange,
        lambda: four_bar(),
        lambda: motion(),
        lambda: ck.decompose(four_bar()),
        lambda: ck.profiles.disc(1.0),
        lambda: ck.laws.constant_speed(1.0),
        lambda: ck.drive("crank"),
    )
    return rng.choice(made)()


@cache
def items() -> tuple[Any, ...]:
    return (
        ck.link("frame", A=(0, 0), D=(4, 0)),
        ck.link("crank", A=(0, 0), B=(1, 0)),
        ck.link("coupler", B=(0, 0), C=(3, 0), P=(1, 1)),
        ck.link("rocker", D=(0, 0), C=(3, 0)),
        ck.drive("crank"),
    )


@cache
def four_bar() -> Any:
    return ck.Mechanism("Four-bar", *items())


@cache
def motion() -> Any:
    return ck.solve(four_bar(), np.linspace(0.5, 1.0, 4))


@cache
def cam_motion() -> Any:
    return ck.solve(ck.load("disc-cam-offset-roller"))


@cache
def chain() -> Any:
    return ck.chains.chains(4)[0]


def right(function: str, name: str) -> Any:
    """A right value of an argument."""
    special = {
        "figures.cam_analysis.name": "follower",
        "quantity.name": "coupler.angle",
        "plots.phase.name": "coupler.angle",
        "chains.assur_group.name": "RRR",
        "chains.name_of.frame": None,
        "chains.named.frame": None,
        "mode.links": "coupler",
        "mode.sign": 1,
        "link.name": "extra",
        "link.letters": "P",
        "slide.link": "block",
    }
    table = {
        **{
            "motion": cam_motion() if function.startswith("cams") else motion(),
            "mechanism": four_bar(),
            "what": motion(),
        },
        **{"link": "coupler", "on": "frame", "point": (1, 1), "points": [(2, 0), (0, 1), (-2, 0), (0, -1)], "at": "C"},
        **{
            "through": "D",
            "centre_at": "D",
            "radius": 1.0,
            "circle": 4.0,
            "profile": ck.profiles.disc(1.0),
            "to": "frame",
        },
        **{"first": "crank", "second": "rocker", "rack": "coupler", "pinion": "crank", "angle": 0.3, "title": "t"},
        **{
            "output": "rocker",
            "input": "crank",
            "chain": chain(),
            "frame": 0,
            "links": 4,
            "graph": ck.decompose(four_bar()).graph,
        },
        **{
            "structure": ck.decompose(four_bar()),
            "group": ck.chains.assur_groups(2)[0],
            "acceleration": 1.0,
            "speed": 1.0,
        },
        **{"over": 1.0, "amount": 2.0, "times": [0, 1, 2, 3, 4, 5, 6], "values": [0, 1, 4, 2, 3, 1, 0], "base": 4.0},
        **{"program": ck.laws.program(ck.laws.rise(1.0, over=3.0), ck.laws.fall(1.0, over=3.283185307179586))},
        **{
            "function": lambda s: np.cos(s) + 1j * np.sin(s),
            "low": 0.0,
            "high": 2 * np.pi,
            "quantity": "P.x",
            "value": 1.0,
        },
        **{
            "tolerance": 1.0,
            "segments": ck.laws.dwell(1.0),
            "name_or_path": "six-bar",
            "names": "coupler.angle",
            "items": items()[0],
        },
    }
    return special.get(f"{function}.{name}", table.get(name))


@cache
def functions() -> tuple[tuple[str, Callable[..., Any]], ...]:
    """All public functions by their names."""
    found = [(name, getattr(ck, name)) for name in ck.__all__]
    found += [(f"{m}.{n}", getattr(getattr(ck, m), n)) for m in MODULES for n in getattr(ck, m).__all__]
    kept = [(name, f) for name, f in found if inspect.isroutine(f) and name not in LEFT_OUT]
    return (*kept, ("Mechanism", ck.Mechanism))


def call(rng: random.Random) -> tuple[str, Callable[..., Any], list[Any], dict[str, Any]]:
    """A call that is right but for an argument or two."""
    while True:
        name, function = rng.choice(functions())
        if not name.startswith(HEAVY) or rng.randrange(SELDOM) == 0:
            break
    parameters = list(inspect.signature(function).parameters.values())
    wrong = set(rng.sample(range(len(parameters)), min(len(parameters), rng.choice((1, 1, 2)))))
    args: list[Any] = []
    words: dict[str, Any] = {}
    for k, p in enumerate(parameters):
        value = odd(rng) if k in wrong else right(name, p.name)
        if p.kind is p.VAR_POSITIONAL:
            args += [value] * (k in wrong or value is not None)
        elif p.kind is p.VAR_KEYWORD:
            words |= {rng.choice(("A", "x", "values", "pair")): value} if k in wrong else {}
        elif k in wrong or p.default is p.empty:
            if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD) and len(args) == k:
                args.append(value)
            elif p.name not in words and not (p.kind is p.POSITIONAL_OR_KEYWORD and len(args) > k):
                words[p.name] = value
    return name, function, args, words


def misused(seed: int, number: int) -> Outcome:
    """The outcome of a wrong call: always the same for its number."""
    rng, outcome = random.Random(f"{seed} {number}"), Outcome(number)
    name, function, args, words = call(rng)
    told = f"ck.{name}({', '.join([*map(shown, args), *(f'{k}={shown(v)}' for k, v in words.items())])})"
    began = time.process_time()
    try:
        with broken_off(SLOW), warnings.catch_warnings(record=True) as caught, aside():
            warnings.simplefilter("always")
            made = function(*args, **words)
            if name in WORDS and rng.randrange(2):
                ck.solve(ck.Mechanism("m", *items(), made))
        outcome.counts["misuse answered"] += 1
        outcome.faults += [
            f"warning: {told}: {w.category.__name__}: {w.message}"[:300]
            for w in caught
            if issubclass(w.category, RuntimeWarning | DeprecationWarning)
        ]
    except ck.errors.CompoundkinError as error:
        outcome.counts[f"misuse {type(error).__name__}"] += 1
        if not str(error).strip():
            outcome.faults.append(f"mute: {told}")
    except TooSlow:
        outcome.faults.append(f"slow: {told} takes more than {SLOW:g} s")
    except Exception as error:
        outcome.faults.append(f"traceback: {told}: {type(error).__name__}: {str(error)[:200]}")
    outcome.seconds = time.process_time() - began
    return outcome


WORDS = {"arc", "belt", "cam", "cylinder", "drawn", "drive", "expect", "face", "gear", "link", "mode", "rack", "roll"}
WORDS |= {"roll_around", "slide", "slot"}


@contextlib.contextmanager
def aside() -> Iterator[None]:
    """In a folder of its own, its output kept away: what is written by mistake is gone afterwards."""
    here = Path.cwd()
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        os.chdir(folder)
        try:
            yield
        finally:
            os.chdir(here)


def shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) < 80 else f"{text[:77]}..."
