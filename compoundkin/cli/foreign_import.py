"""Mechanisms out of other programs' files, wherever a command takes a file, and what is said of them."""

from __future__ import annotations

import sys
from os.path import isfile
from pathlib import Path
from typing import TYPE_CHECKING

from compoundkin.base.suffixes import SUFFIXES, suffix_for, suffix_of
from compoundkin.cli.shell import say

if TYPE_CHECKING:
    from compoundkin.files.exchange.exchanged import Imported

# Of mechanisms with more pairs only the links are counted: finding out what holds what twice may take minutes.
_MANY = 100


def is_foreign(source: str) -> bool:
    """Tell whether a link or a file is to be read as another program's. Nothing is said of what is neither."""
    from compoundkin.files.exchange.content import content_of, is_itself

    if is_itself(source):
        return True
    if suffix_of(source) == suffix_for("mechanism", "toml") or not isfile(source):
        return False
    from compoundkin.base.errors import InvalidInput
    from compoundkin.files.exchange.known_formats import readable_formats
    from compoundkin.files.exchange.recognition import recognised

    try:
        recognised(content_of(Path(source)), readable_formats())
    except InvalidInput:
        # what is no file of ours either by its suffix is told what it is
        return suffix_of(source) not in SUFFIXES["mechanism"]
    return True


def imported(source: str, form: str = "") -> Imported:
    """Return what a file, a link or standard input holds. What does not come across is said."""
    from compoundkin.files.exchange.conversion import read

    found = read(_piped() if source == "-" else source, form)
    say(f"Read {found.mechanism.title!r} ({found.form}): {_in_short(found)}.")
    for note in found.notes:
        say(f"Note: {note}")
    return found


def _in_short(found: Imported) -> str:
    """What it is made of; where something keeps it from being solved, that."""
    from compoundkin.structure import decompose

    if len(found.mechanism.pins) + len(found.mechanism.written_pairs) > _MANY:
        return found.mechanism.in_numbers
    structure = decompose(found.mechanism)
    groups = ", ".join(group.name for group in structure.groups)
    faults = "; ".join(fault.text for fault in structure.faults)
    told = f"groups {groups}" if groups else "no groups"
    said = f"{found.mechanism.in_numbers}, mobility {structure.mobility.freedoms}, {told}"
    return f"{said}; it cannot be solved as it is: {faults}" if faults else said


def _piped() -> str:
    """Return what is piped in; a line end tells it from a path."""
    from compoundkin.base.errors import InvalidInput, Problem
    from compoundkin.files.exchange.content import MOST_BYTES, as_utf8

    raw = sys.stdin.buffer.read(MOST_BYTES + 1)
    try:
        return as_utf8(raw).decode("utf-8-sig") + "\n"
    except UnicodeDecodeError:
        raise InvalidInput(Problem("standard input", "it is not UTF-8 text", "name the file")) from None
