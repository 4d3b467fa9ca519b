"""Full force balance: which moments of mass on links leave the mass centre of the whole mechanism at rest.

The mass centre is a sum of constants times the unit vectors of links. It rests where this sum is one of those that the
loops keep constant: complex linear equations in the moments of mass that counterweights add.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from compoundkin.base.arrays import Number, first_entry
from compoundkin.dynamics.balance.pin_ways import PinWays, dependent_rows
from compoundkin.dynamics.work.mass_motion import place_of
from compoundkin.model.geometry import FRAME

# What is left of the mass centre's way is nothing below this part of what the masses do.
BALANCED = 1e-9


class BalanceConditions:
    """The conditions of full force balance of one design. `scale` is what they are measured by."""

    def __init__(self, ways: PinWays, closed: bool) -> None:
        self.ways = ways
        self.masses = {name: complex(first_entry(mass.mass)) for name, mass in ways.motion.mechanism.masses.items()}
        # a motion that is no whole cycle may show too many, as near to dependent as its vectors move little
        rows = [dependent_rows(ways)] if closed else []
        # what is left of a row when loops have taken from it all that they can; zeros stand for no row at all
        rows += [ways.loops / ways.motion.size, np.zeros((1, ways.count))]
        _, sizes, right = np.linalg.svd(np.vstack(rows), full_matrices=True)
        rank = int(np.count_nonzero(sizes > BALANCED * max(sizes, default=0.0)))
        self._left = right[rank:]
        self.total = self._total()
        self.scale = sum(abs(mass) for mass in self.masses.values()) * ways.motion.size

    @property
    def unreached(self) -> tuple[str, ...]:
        """The links with mass that no way through pins leads to."""
        return tuple(name for name, mass in self.masses.items() if name not in self.ways.origins and mass != 0)

    def _total(self) -> Number:
        """Return the row of all masses that are reached."""
        motion, found = self.ways.motion, np.zeros(self.ways.count, dtype=complex)
        for name, mass in motion.mechanism.masses.items():
            if name in self.ways.origins:
                place = complex(np.ravel(place_of(motion, mass))[0])
                found = found + self.masses[name] * self.ways.row(name, place)
        return found

    def pivot_row(self, link: str) -> Number:
        """Return the row of the pin through which a link is reached. It is nothing for one pinned to the frame."""
        return self.ways.row(link, self.ways.reached[link].pivot)

    def left(self, row: Number) -> Number:
        """Return what loops leave of a row."""
        return np.conj(self._left) @ row

    def moments(self, links: Sequence[str], added: Mapping[str, float]) -> tuple[Number, float]:
        """Return the moments of mass about their pivots that counterweights on links must have.

        `added` are their masses. Return also what is left unbalanced, in parts of the scale.
        """
        total = self.total + sum((added[name] * self.pivot_row(name) for name in links), 0j)
        columns = self._columns(links)
        wanted = -self.left(total)
        found = np.linalg.lstsq(columns, wanted, rcond=None)[0] if len(links) else np.empty(0, dtype=complex)
        rest = float(np.max(np.abs(columns @ found - wanted), initial=0.0))
        return found, rest / self.scale if self.scale else 0.0

    def chosen(self) -> tuple[str, ...]:
        """Return links whose counterweights balance. Those pinned to the frame come first, then the nearest to it."""
        order = sorted(self.ways.reached, key=lambda name: self.ways.reached[name].depth)
        links: list[str] = []
        for name in (name for name in order if name != FRAME and name in self.ways.turning):
            nothing = dict.fromkeys([*links, name], 0.0)
            if self.moments(links, nothing)[1] <= BALANCED:
                break
            if np.linalg.matrix_rank(self._columns([*links, name]), tol=BALANCED) > len(links):
                links.append(name)
        return tuple(links)

    def _columns(self, links: Sequence[str]) -> Number:
        rows = [self.left(self.ways.unit(name)) for name in links]
        return np.array(rows, dtype=complex).reshape(len(links), len(self._left)).T

    @property
    def pinned(self) -> tuple[str, ...]:
        """The links pinned to the frame that turn."""
        return tuple(name for name, one in self.ways.reached.items() if one.depth == 1 and name in self.ways.turning)
