"""The kinematic graph, as NetworkX has it: links are nodes, pairs are edges."""

from __future__ import annotations

from typing import TYPE_CHECKING

from compoundkin.structure.parts import Structure

if TYPE_CHECKING:
    import networkx as nx


def kinematic_graph(structure: Structure) -> nx.MultiGraph:
    """The links as nodes (attribute `pairs`: how many each has), the pairs as edges keyed by their names.

    Edges have the attributes `pair` and `code`. A multiple pin of k links is k - 1 edges.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import link
    >>> from compoundkin.structure import decompose
    >>> structure = decompose(Mechanism("m", link("frame", A=0), link("crank", A=0, B=1)))
    >>> list(kinematic_graph(structure).edges(keys=True, data="code"))
    [('frame', 'crank', 'A', 'R')]
    """
    import networkx

    graph = networkx.MultiGraph(title=structure.mechanism.title)
    for name, count in pair_counts(structure).items():
        graph.add_node(name, pairs=count)
    for pair in structure.pairs:
        first, second = pair.members[:2]
        graph.add_edge(first, second, key=pair.name, pair=pair, code=pair.code)
    return graph


def pair_counts(structure: Structure) -> dict[str, int]:
    """How many pairs each link has; at a pin of several links each of them counts one.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import link
    >>> from compoundkin.structure import decompose
    >>> links = [link(name, J=0) for name in ("frame", "crank", "rod")]
    >>> pair_counts(decompose(Mechanism("m", *links)))
    {'frame': 1, 'crank': 1, 'rod': 1}
    """
    mechanism = structure.mechanism
    counts = dict.fromkeys(mechanism.links, 0)
    for names in mechanism.pins.values():
        for name in names:
            counts[name] += 1
    for pair in mechanism.written_pairs:
        for name in pair.members[:2]:
            counts[name] += 1
    return counts


def links_by_pairs(structure: Structure) -> dict[int, tuple[str, ...]]:
    """The links with one pair, the binary links, the ternary ones and so on, by their number of pairs.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import link
    >>> from compoundkin.structure import decompose
    >>> bars = link("frame", A=0, B=1), link("crank", A=0, C=1), link("rod", C=0)
    >>> links_by_pairs(decompose(Mechanism("m", *bars)))
    {1: ('frame', 'rod'), 2: ('crank',)}
    """
    counts = pair_counts(structure)
    return {k: tuple(n for n, c in counts.items() if c == k) for k in sorted(set(counts.values()))}
