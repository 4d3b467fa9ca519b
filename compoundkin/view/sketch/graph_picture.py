"""The kinematic graph as a picture: links as numbered circles, pairs as lines between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from compoundkin.base.series import Number
from compoundkin.model.elements import FRAME
from compoundkin.model.pairs import Pair
from compoundkin.structure import Structure
from compoundkin.view.sketch.label_places import Label, placed, text_half
from compoundkin.view.sketch.picture import Picture, Window, checked_size, fitted
from compoundkin.view.sketch.shapes import CircleShape, Polygon, Polyline, Shape, ShapeGroup, Text, sheet
from compoundkin.view.sketch.sketch_labels import below, lines_of_text
from compoundkin.view.sketch.sketch_style import SMALL, style_of

# The distance of two links that a pair joins, in picture units, and the radius of a link.
APART, NODE = 110.0, 14.0
# Rounds of majorization; a graph of some dozens of links has settled by then.
ROUNDS = 200
# Two pairs between the same links bulge by this.
BULGE = 26.0


def graph(structure: Structure, numbers: Mapping[str, int], groups: Mapping[str, int], size: float | None) -> Picture:
    """Draw the kinematic graph, each link in the colour of its group. Driven pairs are drawn thick."""
    names = list(numbers)
    places = dict(zip(names, spread(names, structure.pairs), strict=True))
    window = fitted(Window(1.0, 0j, 0.0, 0.0), np.array(list(places.values())))
    places = {name: complex(window.at(np.conjugate(place))) for name, place in places.items()}
    driven = {step.pair.name for step in structure.driven.values()}
    lines, named = _edges(structure.pairs, places, driven)
    nodes = [node(name, places[name], numbers[name], groups[name]) for name in names]
    found = placed(named, [*lines, *nodes], window.width, window.height)
    texts: list[Shape] = [Text(at, key.partition(" ")[2], "code") for key, at in found.items()]
    notes = [f"{number} {name}" for name, number in numbers.items()]
    notes += ["thick lines: driven pairs"] if driven else []
    said, height = below(lines_of_text(notes, window.width - 32.0), window.height)
    paper = sheet(window.width, height)
    title = f"{structure.mechanism.title}: kinematic graph"
    described = f"{len(names)} links, {len(structure.pairs)} pairs"
    shapes = (paper, *lines, *nodes, *texts, *said)
    return Picture(shapes, window.width, height, title, described, checked_size(size))


def node(name: str, at: complex, number: int, group: int) -> Shape:
    """Draw a link as a numbered circle; the frame is square."""
    corner = (1 + 1j) * NODE * 0.9
    style = "pin frame" if name == FRAME else f"pin {style_of('ring', group)}"
    around = tuple(at + corner * turn for turn in (1, 1j, -1, -1j))
    rim: Shape = Polygon(around, style) if name == FRAME else CircleShape(at, NODE, style)
    return ShapeGroup((rim, Text(at, str(number), "number")), title=name, links=(name,))


def _edges(pairs: Sequence[Pair], places: Mapping[str, complex], driven: set[str]) -> tuple[list[Shape], list[Label]]:
    """A line for each pair with its name; from that of a gear pair or belt a thin one to the carrier."""
    lines: list[Shape] = []
    named: list[Label] = []
    count: dict[frozenset[str], int] = {}
    for k, pair in enumerate(pairs):
        first, second = (places[name] for name in pair.members[:2])
        between = frozenset(pair.members[:2])
        bulge = _bulge(count.get(between, 0))
        count[between] = count.get(between, 0) + 1
        across = 1j * (second - first) / (abs(second - first) or 1.0)
        middle = (first + second) / 2.0 + across * bulge
        style = "bold" if pair.name in driven else "edge"
        lines.append(ShapeGroup((Polyline((first, middle, second), style),), title=f"{pair.name}, {pair.title}"))
        lines += [Polyline((middle, places[name]), "ray") for name in pair.members[2:]]
        named.append(_label(k, pair, first, middle, second, across))
    return lines, named


def _bulge(k: int) -> float:
    """The first pair between two links is straight, the next ones bulge to one side and the other."""
    return BULGE * ((k + 1) // 2) * (1 if k % 2 else -1)


def _label(k: int, pair: Pair, first: complex, middle: complex, second: complex, across: complex) -> Label:
    text = f"{pair.code} {pair.letters[0]}"
    half = text_half(text, SMALL)
    places, costs = [], []
    for share in (0.5, 0.4, 0.6, 0.3, 0.7):
        on = first + (middle - first) * 2.0 * share if share <= 0.5 else second + (middle - second) * 2.0 * (1 - share)
        for off in (7.0, -7.0, 12.0, -12.0, 18.0, -18.0):
            side = abs(across.real) * half.real + abs(across.imag) * half.imag
            places.append(on + across * (off + (side if off > 0 else -side)))
            costs.append(abs(off) / 3.0 + 12.0 * abs(share - 0.5))
    return Label(f"{k} {text}", half, tuple(places), tuple(costs))


def spread(names: Sequence[str], pairs: Sequence[Pair]) -> list[complex]:
    """Return places for the links, as far apart as there are pairs between them.

    Source: J. de Leeuw, Applications of convex analysis to multidimensional scaling, 1977 (majorization of stress).
    """
    index = {name: k for k, name in enumerate(names)}
    joined = [(index[p.members[0]], index[p.members[1]]) for p in pairs]
    wanted = _steps(len(names), joined)
    rng = np.random.default_rng(0)
    # the same orders every time: the seed is fixed
    starts = min(MOST_STARTS, STARTS // len(names))
    tried = _settled(wanted, np.array([np.arange(len(names)), *(rng.permutation(len(names)) for _ in range(starts))]))
    places = min(tried, key=lambda found: _crossings(found, joined))
    places = places - places[0]
    # the frame below, as it is drawn
    far = np.mean(places) if len(names) > 1 else 1j
    return [complex(p) for p in places * 1j * np.conjugate(far) / (abs(far) or 1.0) * APART]


def _settled(wanted: Number, orders: Number) -> Number:
    """Places (orders, links) that have settled from circles on which the links stand in some orders."""
    count = orders.shape[1]
    places = np.exp(2j * np.pi * orders / max(count, 1) + 1j * START) * max(1.0, count / 4.0)
    weights, itself = np.where(wanted > 0, 1.0 / np.maximum(wanted, 1.0) ** 2, 0.0), np.eye(count)
    for _ in range(ROUNDS if count > 2 else 0):
        apart = places[:, :, None] - places[:, None]
        pull = weights * (places[:, None] + wanted * apart / (np.abs(apart) + itself))
        places = pull.sum(axis=2) / weights.sum(axis=1)
    return places


def _crossings(places: Number, joined: Sequence[tuple[int, int]]) -> int:
    """How many lines between links cross."""
    first, second = np.array(joined, dtype=int).reshape(-1, 2).T
    a, b = places[first], places[second]
    side = (np.conjugate(b - a)[:, None] * (np.stack([a, b])[:, None] - a[:, None])).imag
    apart = side[0] * side[1] < -CLEAR
    shared = (first[:, None] == first) | (first[:, None] == second) | (second[:, None] == first)
    return int(np.count_nonzero(apart & apart.T & ~(shared | (second[:, None] == second))) // 2)


# Of so many starting orders, by the number of links, the one is taken whose lines cross least.
STARTS, MOST_STARTS = 500, 40
# Products of distances below this are rounding.
CLEAR = 1e-9
# Not along an axis, so that no two links start at one height.
START = 0.3


def _steps(count: int, joined: Sequence[tuple[int, int]]) -> Number:
    """How many pairs are between every two links; where nothing joins them, many. Source: Floyd and Warshall, 1962."""
    far = float(max(count, 2))
    steps = np.full((count, count), far)
    for one, two in joined:
        steps[one, two] = steps[two, one] = 1.0
    np.fill_diagonal(steps, 0.0)
    for k in range(count):
        steps = np.minimum(steps, steps[:, k, None] + steps[None, k])
    # links two steps apart a little farther, so that triangles are no needles
    return np.where(steps == 2.0, 1.75, steps)
