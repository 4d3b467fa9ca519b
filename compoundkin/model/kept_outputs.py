"""Which outputs of a mechanism there still are once it is driven elsewhere."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING

from compoundkin.model.attributes import CATALOGUE, DERIVED

if TYPE_CHECKING:
    from compoundkin.model.mechanism import Mechanism

_OF_OTHERS = {word for kind in ("points", "links", "pairs") for word in (*CATALOGUE[kind], *DERIVED[kind])}
# What drivers have alone, such as their efforts.
OF_DRIVERS_ALONE = frozenset({*CATALOGUE["drives"], *DERIVED["drives"]} - _OF_OTHERS)


def kept_outputs(mechanism: Mechanism, drivers: Collection[str]) -> list[str]:
    """Return the outputs that there are with these drivers.

    An effort or a power of a link that does not drive any more is none of them.
    """
    known = {*mechanism.carriers, *mechanism.links, *(pair.name for pair in mechanism.written_pairs)}
    return [name for name in mechanism.outputs if _is_kept(name, known, drivers)]


def _is_kept(name: str, known: Collection[str], drivers: Collection[str]) -> bool:
    owner, words = name.split("(")[0].split(".")[0], name.rpartition(")")[2].split(".")[1:]
    return owner in drivers or (owner in known and not OF_DRIVERS_ALONE & set(words))
