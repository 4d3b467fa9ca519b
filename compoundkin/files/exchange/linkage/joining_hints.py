"""Connectors at one place that are not joined, and links that float because of them."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, islice

from compoundkin.base.display import abbreviated_list
from compoundkin.files.exchange.linkage.joined_links import JoinedLinks
from compoundkin.files.exchange.linkage.linkage_records import LinkageConnector

# Connectors are at one place that are nearer to each other than this part of the size; those meant to be snap.
ONE_PLACE = 1e-6
# No drawing is smaller; of such a division would leave nothing.
_LEAST = 1e-200
# More hints are no help.
_MOST = 6


def unjoined(joined: JoinedLinks, size: float) -> Iterator[tuple[LinkageConnector, LinkageConnector]]:
    """Yield pairs of connectors at one place without a link in common."""
    near = ONE_PLACE * max(size, _LEAST)
    places: dict[tuple[int, int], list[LinkageConnector]] = {}
    for one in joined.file.connectors.values():
        if joined.at(one.id):
            places.setdefault((round(one.at.real / near), round(one.at.imag / near)), []).append(one)
    for here in places.values():
        for one, two in islice(combinations(here, 2), _MOST):
            if not set(joined.at(one.id)) & set(joined.at(two.id)):
                yield one, two


def hint(pairs: list[tuple[LinkageConnector, LinkageConnector]]) -> str:
    """Return the question that may help, or nothing.

    >>> hint([])
    ''
    """
    said = [f"{one.id} and {two.id}" for one, two in pairs]
    return f"did you mean to join connectors {abbreviated_list(said, _MOST)}?" if said else ""
