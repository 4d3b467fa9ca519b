"""The shipped mechanisms, each read, decomposed, solved and reported once in a process, for all tests in it."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from functools import cache, wraps
from pathlib import Path
from typing import Any

import pytest

import compoundkin as ck
from compoundkin.files import load
from compoundkin.files.shipped_mechanisms import shipped
from compoundkin.view.report import Report, report
from tests.support import EVERYTHING

TESTS = Path(__file__).parent
NAMES = shipped()
# Every mechanism file there is: those of the tests of files, and the catalog.
FILES = sorted([*TESTS.glob("files/samples/*.toml"), *TESTS.parent.glob("catalog/*.toml")])

# What is asked of every shipped mechanism is asked of these, which have all kinds of pairs, of groups, of laws and of
# loads between them; and of all with COMPOUNDKIN_TESTS=all, as `.ci/run` sets it.
_CHOSEN = """
    differential elliptic-trammel engine-gas-pressure five-bar-led flat-faced-follower geared-five-bar geared-press
    geneva-wheel groove-cam-plate hibbeler-quick-return hydraulic-digger oscillating-roller-follower
    rack-driven-double-slider rolling-wheel scotch-yoke six-bar stephenson-iii-floating-driver wedge-press
"""
CHOSEN = NAMES if EVERYTHING else tuple(_CHOSEN.split())
# What is dear, as reports and pictures, is asked of these and of a third of all others.
THIRD = tuple(sorted({*_CHOSEN.split(), *NAMES[::3]})) if EVERYTHING else CHOSEN


def each(names: Iterable[Any]) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Make one test of a claim about each mechanism or file: it tries all of them, and tells every one that fails.

    A test of its own for each of them would cost more in pytest than most of these claims.
    """

    def made(claim: Callable[..., None]) -> Callable[..., None]:
        @wraps(claim)
        def test(**fixtures: object) -> None:
            failures: dict[object, BaseException] = {}
            for name in names:
                try:
                    claim(name, **fixtures)
                except (Exception, pytest.fail.Exception) as failure:
                    failure.add_note(f"of {name}")
                    failures[name] = failure
            if failures:
                raise BaseExceptionGroup(f"{claim.__name__}: {', '.join(map(str, failures))}", [*failures.values()])

        asked = inspect.signature(claim)
        test.__signature__ = asked.replace(parameters=list(asked.parameters.values())[1:])  # type: ignore[attr-defined]
        return test

    return made


@cache
def mechanism(name: str) -> ck.Mechanism:
    return load(name)


@cache
def structure(name: str) -> ck.results.Structure:
    return ck.decompose(mechanism(name))


@cache
def motion(name: str) -> ck.results.Motion:
    """The motion over the range that the file gives."""
    return ck.solve(mechanism(name))


@cache
def report_of(name: str) -> Report:
    """The report of that motion."""
    return report(motion(name))


@cache
def structure_report(name: str) -> Report:
    """The report of the structure alone."""
    return report(structure(name))
