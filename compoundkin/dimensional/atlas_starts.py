"""Designs of an atlas as dimensions of a mechanism that somebody else has written: where `optimise` may begin.

The mechanism and a chain are the same where their links and pairs are, with frame, driven crank and the link that has a
point of its own each in its place. A design is then brought to the mechanism's scale and into the coordinates of its
links, both as it is and mirrored.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import NamedTuple

import networkx as nx
import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dimensional.curve_chains import CRANK, GUIDE_OFFSET, CurveChain
from compoundkin.model.attributes import AXES
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.studies.samples.random_samples import SobolSample

# So many designs of each chain are given, mirrored ones among them.
GIVEN = 8192

# A chain, and what reads its designs (designs, numbers).
ChainDesigns = tuple[CurveChain, Callable[[], Number]]
Ranges = Mapping[str, tuple[complex, complex]]


def designs_for(chains: Iterable[ChainDesigns], mechanism: Mechanism, ranges: Ranges, seed: int) -> dict[str, Number]:
    """Return values of free dimensions by name, (designs,), complex of points, of all chains that a mechanism is.

    What designs do not determine, such as where the frame lies, is drawn from the ranges. Raises InvalidInput where the
    mechanism is no chain of the atlas.
    """
    graph = _graph(mechanism, _driver(mechanism))
    chains = list(chains)
    found = [one for chain, read in chains for one in _of_chain(chain, read, graph, mechanism, ranges, seed)]
    if not found:
        links = ", ".join(map(str, sorted({chain.links for chain, _ in chains})))
        what = f"{mechanism.title} is no chain of this atlas, whose linkages have {links} links"
        remedy = "dyads one on another with a crank on the frame are, of an atlas of as many links; else leave it out"
        raise InvalidInput(Problem("atlas", what, remedy))
    return {name: np.concatenate([one[name] for one in found]) for name in ranges}


def _of_chain(
    chain: CurveChain, read: Callable[[], Number], graph: nx.Graph, mechanism: Mechanism, ranges: Ranges, seed: int
) -> Iterator[dict[str, Number]]:
    """Yield the values of designs of a chain that the mechanism is, for each way in which it is that."""
    own = _graph(chain.mechanism, CRANK)
    if not any(has for _, has in graph.nodes(data="has_point")):
        for node in own.nodes:
            own.nodes[node]["has_point"] = False
    is_same = (lambda a, b: a == b), (lambda a, b: a["code"] == b["code"])
    found = list(nx.isomorphism.GraphMatcher(own, graph, *is_same).isomorphisms_iter())
    if not found:
        return
    designs = read()[: max(1, GIVEN // (2 * len(found)))].astype(float)
    for links in found:
        letters = {
            own.edges[edge]["letter"]: graph.edges[links[edge[0]], links[edge[1]]]["letter"] for edge in own.edges
        }
        one = _SameChain(chain, mechanism, links, letters, ranges)
        for mirrored in (False, True):
            yield one.values(designs, mirrored, seed)


def _driver(mechanism: Mechanism) -> str:
    """Return the crank: the one link that is driven, on a pin of the frame. Raises InvalidInput."""
    drives = [one.link for one in mechanism.drives if one.on == FRAME]
    if len(drives) != 1 or len(mechanism.drives) != 1:
        what = f"{mechanism.title} is not driven by one crank on the frame"
        raise InvalidInput(Problem("atlas", what, "chains of the atlas are; else leave it out"))
    return drives[0]


def _graph(mechanism: Mechanism, crank: str) -> nx.Graph:
    """Return links as nodes and pairs as edges with their letters; which link is which, and which has a free point."""
    graph = nx.Graph()
    shared = {letter for letter, on in mechanism.carriers.items() if len(on) > 1}
    of_pairs = {letter for pair in mechanism.written_pairs for letter in pair.letters}
    for name, own in mechanism.links.items():
        has_point = name != FRAME and bool(set(own.points) - shared - of_pairs)
        graph.add_node(name, is_frame=name == FRAME, is_crank=name == crank, has_point=has_point)
    for letter in shared:
        on = mechanism.carriers[letter]
        for k, one in enumerate(on):
            for other in on[k + 1 :]:
                graph.add_edge(one, other, letter=letter, code="")
    for pair in mechanism.written_pairs:
        graph.add_edge(*pair.members[:2], letter=pair.name, code=pair.code)
    return graph


class _SameChain(NamedTuple):
    """A chain and the mechanism that it is, with the mechanism's `links` and `letters` by those of the chain."""

    chain: CurveChain
    mechanism: Mechanism
    links: Mapping[str, str]
    letters: Mapping[str, str]
    ranges: Ranges

    def values(self, designs: Number, mirrored: bool, seed: int) -> dict[str, Number]:
        """Return values of the free dimensions for designs (designs, numbers)."""
        found = self._drawn(len(designs), seed)
        dimensions = {name: value[:, 0] for name, value in self.chain.dimensions(designs).items()}
        points = {name: self._points(name, dimensions, mirrored) for name in self.chain.mechanism.links}
        scale = self._scale(points, found)
        for name, own in points.items():
            self._bring(name, own, scale, found)
        for name in found:
            link, _, what = name.rpartition(".")
            if what == "offset" and GUIDE_OFFSET in dimensions and link in self.letters.values():
                found[name] = scale * dimensions[GUIDE_OFFSET] * (-1.0 if mirrored else 1.0)
        return found

    def _drawn(self, count: int, seed: int) -> dict[str, Number]:
        """Return values of all free dimensions drawn from their ranges."""
        sample = SobolSample(1 << max(count, 2).bit_length(), seed)
        units = iter(sample.units(2 * len(self.ranges), range(count)).T)
        found = dict[str, Number]()
        for name, (low, high) in self.ranges.items():
            x, y = next(units), next(units)
            value = low.real + (high.real - low.real) * x
            is_point = name.rpartition(".")[2] not in AXES and (low.imag or high.imag)
            found[name] = value + 1j * (low.imag + (high.imag - low.imag) * y) if is_point else value
        return found

    def _points(self, name: str, dimensions: Mapping[str, Number], mirrored: bool) -> dict[str, Number]:
        """Return the points of a link of the chain, by the letters of the mechanism."""
        found = dict[str, Number]()
        free = self._free_letter(name)
        for letter, place in self.chain.mechanism.geometry.points[name].items():
            value = dimensions.get(
                f"{name}.{letter}", dimensions.get(f"{name}.{letter}.{AXES[0]}", complex(np.ravel(place)[0]))
            )
            seen = self.letters.get(letter, free)
            if seen:
                found[seen] = np.conj(value) if mirrored else value
        return found

    def _free_letter(self, name: str) -> str:
        """Return the point of the mechanism's link that no other link has."""
        own = self.mechanism.links[self.links[name]].points
        return next((letter for letter in own if letter not in self.letters.values()), "")

    def _place(self, link: str, letter: str, found: Mapping[str, Number]) -> Number:
        """Return where a point of the mechanism is on its link, with the values so far."""
        own = complex(np.ravel(self.mechanism.geometry.points[link][letter])[0])
        whole, (x, y) = f"{link}.{letter}", (f"{link}.{letter}.{axis}" for axis in AXES)
        if whole in found:
            return found[whole]
        return found.get(x, own.real) + 1j * found.get(y, own.imag)

    def _scale(self, points: Mapping[str, Mapping[str, Number]], found: Mapping[str, Number]) -> Number:
        """Return the mechanism's size in that of the chain: of the frame's first two pivots, else of the crank."""
        name = FRAME if len(points[FRAME]) > 1 else CRANK
        link = self.links[name]
        a, b = [letter for letter in self.mechanism.links[link].points if letter in points[name]][:2]
        wide = np.abs(self._place(link, b, found) - self._place(link, a, found))
        return wide / np.abs(points[name][b] - points[name][a])

    def _bring(self, name: str, points: Mapping[str, Number], scale: Number, found: dict[str, Number]) -> None:
        """Change the free dimensions of a link: its points as they lie to the first two."""
        link = self.links[name]
        ordered = [letter for letter in self.mechanism.links[link].points if letter in points]
        # what is held by those that stay
        ordered.sort(key=lambda letter: any(name.startswith(f"{link}.{letter}") for name in self.ranges))
        if len(ordered) < 2:
            return
        a, b = ordered[:2]
        start, way = self._place(link, a, found), self._place(link, b, found) - self._place(link, a, found)
        way = way / np.abs(way)
        own = points[b] - points[a]
        for letter in ordered[2:] if name == FRAME else ordered[1:]:
            place = start + way * scale * (points[letter] - points[a]) * np.abs(own) / own
            if f"{link}.{letter}" in found:
                found[f"{link}.{letter}"] = place
            for axis, part in zip(AXES, (place.real, place.imag), strict=True):
                if f"{link}.{letter}.{axis}" in found:
                    found[f"{link}.{letter}.{axis}"] = part
