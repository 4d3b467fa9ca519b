"""Toggle positions: where a link on the frame comes to an extreme of its motion while the driver goes on."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.base.arrays import wrapped
from compoundkin.base.bracketing import bisected
from compoundkin.base.series import Number
from compoundkin.configurations.circuit import Circuit, Toggle
from compoundkin.configurations.segment_poses import Placing
from compoundkin.model.pairs import Pair

CELLS = 72
HALVINGS = 48
# A link whose rate is below this (of the size, or radians, a radian of the strand's angle) throughout stands still.
STILL = 1e-9


def toggles_of(placing: Placing, circuits: tuple[Circuit, ...]) -> tuple[Toggle, ...]:
    """All toggle positions, by circuit and branch, in the order in which the circuit passes them."""
    found: dict[int, list[tuple[float, Toggle]]] = {}
    with np.errstate(all="ignore"):
        for link, pair in _on_frame(placing):
            for row, phi, toggle in _of_link(placing, circuits, link, pair):
                found.setdefault(row, []).append((phi, toggle))
    ordered = []
    for visit in (v for c in circuits for b in c.branches for v in b.visits):
        ordered += [t for _, t in sorted(found.get(visit.row, []), key=lambda e: (visit.sense * e[0], e[1].link))]
    return tuple(ordered)


def _on_frame(placing: Placing) -> Iterator[tuple[str, Pair]]:
    """Links that a pair of one freedom joins to the frame, no driver being in it."""
    ground = placing.sweep.plan.structure.ground.links[0]
    driven = {d.pair.name for d in placing.sweep.plan.driven.values()}
    for name, pair in placing.sweep.plan.pairs.items():
        if pair.held == 2 and name not in driven and ground in pair.members and len(pair.members) == 2:
            yield next(link for link in pair.members if link != ground), pair


def _of_link(
    placing: Placing, circuits: tuple[Circuit, ...], link: str, pair: Pair
) -> Iterator[tuple[int, float, Toggle]]:
    strands = placing.strands
    rows, phi = np.arange(strands.rows), (np.arange(CELLS) + 0.5) * np.pi / CELLS
    rate = _rate(placing, pair, rows, np.broadcast_to(phi, (len(rows), CELLS)))
    size = 1.0 if pair.free_is_angle else placing.sweep.plan.size
    moving = np.max(np.abs(rate), axis=1) > STILL * size
    at, cell = np.nonzero((rate[:, 1:] > 0) != (rate[:, :-1] > 0))
    kept = moving[at]
    at, low, high = at[kept], phi[cell[kept]], phi[cell[kept] + 1]
    if not len(at):
        return

    def rises(phi: Number) -> Number:
        return _rate(placing, pair, at, phi[:, None])[:, 0] > 0

    rising = rises(high)
    _, low = bisected(lambda phi: rises(phi) == rising, high, low, HALVINGS)
    values = strands.at(at, low[:, None])[:, 0]
    owner = {v.row: (c, b) for c in circuits for b in c.branches for v in b.visits}
    period = placing.sweep.plan.driven[placing.sweep.driver].pair.free_is_angle
    for row, angle, s, one in zip(
        at.tolist(), low.tolist(), values.tolist(), placing.configurations(at, values), strict=True
    ):
        circuit, branch = owner[row]
        value = wrapped(s) if period else s
        yield row, angle, Toggle(float(value), link, pair.name, one, circuit.number, branch.number)


def _rate(placing: Placing, pair: Pair, rows: Number, phi: Number) -> Number:
    """The derivative of a pair's coordinate by the angle along strands, (rows, columns)."""
    strands = placing.strands
    block = placing.sweep.run(strands, rows, strands.at(rows, phi), strands.rate(rows, phi))
    poses = tuple(block.world[name] for name in pair.members)
    coordinate = pair.coordinate(block.ends[pair.name], poses)
    return np.broadcast_to(coordinate.c[1] if len(coordinate.c) > 1 else 0.0, phi.shape)
