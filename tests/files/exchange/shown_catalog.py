"""The shipped mechanisms at their drawn poses, each solved once in a process, for all formats that write them."""

from __future__ import annotations

from functools import cache

from compoundkin.files.exchange.posed_mechanism import PosedMechanism, posed_mechanism
from tests.catalog import mechanism


@cache
def shown(name: str) -> PosedMechanism:
    return posed_mechanism(mechanism(name))
