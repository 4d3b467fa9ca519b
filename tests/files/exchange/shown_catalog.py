"""The shipped mechanisms at their drawn poses, each solved once in a process, for all formats that write them."""

from __future__ import annotations

from functools import cache

from compoundkin.files.exchange.shown_mechanism import ShownMechanism, shown_mechanism
from tests.catalog import mechanism


@cache
def shown(name: str) -> ShownMechanism:
    return shown_mechanism(mechanism(name))
