"""The shipped mechanisms, each read, decomposed, solved and reported once in a process, for all tests in it."""

from __future__ import annotations

import os
from functools import cache

import compoundkin as ck
from compoundkin.files import load
from compoundkin.files.shipped_mechanisms import shipped
from compoundkin.view.report import Report, report

NAMES = shipped()

# What is asked of every shipped mechanism is asked of these, which have all kinds of pairs, of groups, of laws and of
# loads between them; and of all with COMPOUNDKIN_TESTS=all, as `.ci/run` sets it.
_CHOSEN = """
    differential elliptic-trammel engine-gas-pressure five-bar-led flat-faced-follower geared-five-bar geared-press
    geneva-wheel groove-cam-plate hibbeler-quick-return hydraulic-digger oscillating-roller-follower
    rack-driven-double-slider rolling-wheel scotch-yoke six-bar stephenson-iii-floating-driver wedge-press
"""
EVERYTHING = os.environ.get("COMPOUNDKIN_TESTS") == "all"
CHOSEN = NAMES if EVERYTHING else tuple(_CHOSEN.split())


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
