"""All configurations of a group at slices of the segments it is attached to, joined by arcs from slice to slice.

Every configuration at a slice has two ports, toward greater and lesser angles. An arc leaves through one port and
arrives at another; it arrives at a configuration that is known, or the slice lacked one.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.configurations.continuation_arcs import LONGEST, ContinuationArc, ContinuationPaths
from compoundkin.configurations.segment_closure import SegmentClosure
from compoundkin.kinematics.configuration_arrays import state_distance

# Every segment is cut by so many slices.
STRIPS = 48
# An arc arrives at a configuration within this (parts of the size, radians).
MATCHED = 1e-5
# Where two arcs arrive at one port, both are followed again with steps this much shorter.
FINER = 0.1
# Arcs arrive at configurations that the slices lacked, whose ports are new; where they are not isolated, without end.
ROUNDS = 6


class Port(NamedTuple):
    """A way out of a configuration. The row of the segment, the slice, the number there, +1 ahead or -1 back."""

    row: int
    slice: int
    number: int
    ahead: int

    @property
    def across(self) -> Port:
        """The other port of the same configuration."""
        return self._replace(ahead=-self.ahead)


class Roadmap:
    """The configurations at all slices and the arcs between them. `lost` counts arcs that ended nowhere."""

    def __init__(self, closure: SegmentClosure, strips: int) -> None:
        self.closure = closure
        self.slices = np.linspace(0.0, np.pi, strips + 1)
        shape = (closure.segments.rows, strips + 1)
        block = closure.blocks(self.slices)
        states = closure.solver.every(block).states
        states = np.broadcast_to(states, (*shape, *states.shape[-2:]))
        self.known = {
            (row, j): [self._scaled(state, j) for state in states[row, j] if np.isfinite(state).all()]
            for row, j in np.ndindex(*shape)
        }
        self.arcs: dict[Port, tuple[ContinuationArc, bool]] = {}
        self.ends: dict[Port, Port] = {}
        self.lost = 0
        self._join()

    def _scaled(self, state: Number, j: int) -> Number:
        return np.append(state * self.closure.weights, self.slices[j])

    def is_outer(self, port: Port) -> bool:
        """Tell whether it leads out of the segment."""
        return port.slice == (len(self.slices) - 1 if port.ahead > 0 else 0)

    def ports(self, ahead: int) -> list[Port]:
        """Return all ports in one direction that lead to no arc yet."""
        every = (Port(row, j, c, ahead) for (row, j), found in self.known.items() for c in range(len(found)))
        return [port for port in every if port not in self.ends and not self.is_outer(port)]

    def state(self, port: Port) -> Number:
        """Return the state at a port."""
        return self.known[port.row, port.slice][port.number]

    def _join(self) -> None:
        """Follow every port with long steps, then with short ones those that still lead to no arc."""
        for longest in (LONGEST, LONGEST * FINER):
            tried: set[Port] = set()
            for _ in range(ROUNDS):
                before = len(tried)
                for ahead in (1, -1):
                    new = [port for port in self.ports(ahead) if port not in tried]
                    tried.update(new)
                    self._follow(new, longest)
                if len(tried) == before:
                    break
        self.lost = sum(len(self.ports(ahead)) for ahead in (1, -1))

    def _follow(self, ports: list[Port], longest: float) -> None:
        if not ports:
            return
        rows, at, ahead = (np.array([getattr(p, name) for p in ports]) for name in ("row", "slice", "ahead"))
        with np.errstate(all="ignore"):
            paths = ContinuationPaths(
                self.closure, rows, np.array([self.state(p) for p in ports]), at, ahead, self.slices
            )
            arcs = paths.go(longest)
        for port, arc in zip(ports, arcs, strict=True):
            if arc.end is not None and port not in self.ends:
                self._arrive(port, arc)

    def _arrive(self, port: Port, arc: ContinuationArc) -> None:
        assert arc.end is not None
        number = self._number(port.row, arc.end, arc.nodes[-1])
        # an even number of turning points is passed, or the arc comes back
        ahead = -port.ahead if len(arc.turns) % 2 == 0 else port.ahead
        goal = Port(port.row, arc.end, number, ahead)
        if goal in self.ends or goal == port:
            # two arcs at one port: one of them has left its curve
            other = self.ends.pop(goal, None)
            self.arcs.pop(goal, None)
            if other is not None:
                self.ends.pop(other, None)
                self.arcs.pop(other, None)
            return
        self.ends[port], self.ends[goal] = goal, port
        self.arcs[port], self.arcs[goal] = (arc, False), (arc, True)

    def _number(self, row: int, j: int, y: Number) -> int:
        """Return which configuration of a slice a state is; a new one where none is near."""
        found = self.known[row, j]
        if found:
            gaps = state_distance(np.array(found)[:, :-1], y[:-1], 1.0)
            if np.min(gaps) < MATCHED:
                return int(np.argmin(gaps))
        found.append(y)
        return len(found) - 1
