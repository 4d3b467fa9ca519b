"""Passive freedoms: links that may turn without moving anything else, such as the roller of a follower."""

from __future__ import annotations

from collections.abc import Iterator

from compoundkin.model.elements import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure.parts import Passive


def passive_freedoms(mechanism: Mechanism) -> Iterator[Passive]:
    """The links on a single pin about which all their other pairs are round; not those that a driver turns.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import link
    >>> list(passive_freedoms(Mechanism("m", link("frame", A=0), link("crank", A=0, B=1))))
    []
    """
    driven = {name for drive in mechanism.drives for name in (drive.link, drive.on)}
    written: dict[str, list[str | None]] = {}
    for pair in mechanism.written_pairs:
        for name in pair.members:
            written.setdefault(name, []).append(pair.round_at(name))
    for name, places in written.items():
        pins = list(mechanism.pins_on[name])
        if name not in driven and name != FRAME and len(pins) == 1 and set(places) == set(pins):
            on = next(other for other in mechanism.pins[pins[0]] if other != name)
            yield Passive(name, on, pins[0])
