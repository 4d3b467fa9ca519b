"""Makes the shipped list of chains: ``python -m compoundkin.synthesis.chains.shipped_lists``; a few seconds."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from compoundkin.synthesis.chains.chain_atlas import COMMENT, FILE, MOST_LINKS
from compoundkin.synthesis.chains.generation import chains_of

MOBILITIES = (0, 1, 2, 3)
# A loop of n links has the mobility n - 3.
_LINKS_OF_RIGID_LOOP = 3
HEADING = (
    "Kinematic chains of revolute pairs and, with mobility 0, Baranov trusses, each once: links, mobility, graph6.",
    "Made by python -m compoundkin.synthesis.chains.shipped_lists. The order numbers the chains: never change it.",
)


def lines(most_links: int = MOST_LINKS) -> Iterator[str]:
    """Yield the lines of the list, by mobility, then by links.

    >>> list(lines(most_links=4))[2:6]
    ['3 0 Bw', '4 1 C]']
    """
    yield from (f"{COMMENT} {text}" for text in HEADING)
    for mobility in MOBILITIES:
        for links in range(mobility + _LINKS_OF_RIGID_LOOP, most_links + 1):
            for chain in chains_of(links, mobility, bridged=True):
                yield f"{links} {mobility} {chain.code}"


def make(path: Path = FILE) -> int:
    """Write the list to a file; the number of lines written."""
    text = [*lines()]
    path.write_text("\n".join(text) + "\n", encoding="ascii")
    return len(text)


if __name__ == "__main__":
    print(f"{make()} lines written to {FILE}")
