"""The shipped mechanisms, each read, taken apart, solved and reported once in a process, for all tests in it."""

from __future__ import annotations

from functools import cache

import compoundkin as ck
from compoundkin.files.shipped_mechanisms import load_named, names
from compoundkin.view.report import Report, report

NAMES = names()


@cache
def mechanism(name: str) -> ck.Mechanism:
    return load_named(name)


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
