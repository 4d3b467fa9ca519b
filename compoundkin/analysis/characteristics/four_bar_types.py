"""Types of four-bars by Grashof and Barker: which links turn fully, and how such a linkage is called.

With the lengths s shortest, l longest, p and q, the shortest link turns fully against all others where s + l < p + q.
Sources: R. L. Norton, Design of Machinery, sections 2.13 and 2.14; C. R. Barker, A complete classification of planar
four-bar linkages, Mechanism and Machine Theory 20 (1985) 535-554.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked, real_numbers
from compoundkin.base.arrays import LONGEST, Number
from compoundkin.base.errors import InvalidInput, Problem

# Lengths whose sums differ by less than this part of the loop are equal: a change point, and not a gap of rounding.
EQUAL = 1e-9

# Three links that rock, before the number of the longest link.
_ROCKERS = 3 * "R"

NAMES = {
    "GCCC": "double-crank (drag link)",
    "GCRR": "crank-rocker",
    "GRCR": "Grashof double-rocker",
    "GRRC": "rocker-crank",
    **{f"{_ROCKERS}{k}": "triple-rocker" for k in range(1, 5)},
    "SCCC": "change-point double-crank",
    "SCRR": "change-point crank-rocker",
    "SRCR": "change-point double-rocker",
    "SRRC": "change-point rocker-crank",
    "S2X": "change-point linkage with two pairs of equal links",
    "S3X": "change-point linkage of four equal links",
    "": "cannot be assembled",
}
_GRASHOF, _CHANGE = ("GCCC", "GCRR", "GRCR", "GRRC"), ("SCCC", "SCRR", "SRCR", "SRRC")
# Two pairs of equal links: opposite to each other, or side by side.
PARALLELOGRAM, KITE = "parallelogram (or antiparallelogram)", "kite (deltoid)"


@dataclass(frozen=True)
class FourBar:
    """A loop of four pins. Links and lengths are those of base, input, coupler and output.

    `code` is Barker's: G with C for a crank and R for a rocker at input, coupler and output; RRR with 1 to 4 for which
    link is longest; S for change points. `driven` is the link that is solved first, "" where none is before the rest.
    """

    links: tuple[str, str, str, str]
    pins: tuple[str, str, str, str]
    lengths: tuple[float, float, float, float]
    code: str
    driven: str

    @property
    def name(self) -> str:
        """What such a linkage is called."""
        if self.code == "S2X":
            base, one, _, other = self.lengths
            return PARALLELOGRAM if abs(one - other) < min(abs(base - one), abs(base - other)) else KITE
        return NAMES[self.code]

    @property
    def is_grashof(self) -> bool:
        """Whether its shortest link turns fully against the others, change points included."""
        return self.code[:1] in ("G", "S")

    @property
    def turns(self) -> tuple[str, ...]:
        """The links that can turn fully against the base."""
        letters = self.code[1:] if self.code[:1] in ("G", "S") and "X" not in self.code else ""
        if self.code.endswith("X"):
            letters = "".join("C" if self._may_turn(k) else "R" for k in (1, 2, 3))
        return tuple(link for link, letter in zip(self.links[1:], letters, strict=False) if letter == "C")

    def _may_turn(self, k: int) -> bool:
        """Tell whether a link can be beside the base in both directions."""
        base, own = self.lengths[0], self.lengths[k]
        one, other = (length for i, length in enumerate(self.lengths) if i not in (0, k))
        near = EQUAL * sum(self.lengths)
        return base + own <= one + other + near and abs(base - own) >= abs(one - other) - near

    @property
    def shortest(self) -> str:
        """The shortest link, the first of several."""
        return self.links[int(np.argmin(self.lengths))]

    @property
    def margin(self) -> float:
        """The other two lengths less the shortest and the longest. Negative: no link turns."""
        short, second, third, long = sorted(self.lengths)
        return second + third - short - long

    def __repr__(self) -> str:
        lengths = ", ".join(f"{n} {v:.6g}" for n, v in zip(self.links, self.lengths, strict=True))
        return f"FourBar({self.name}, {self.code or 'no code'}: {lengths})"


@checked
def four_bar_code(base: Any, input: Any, coupler: Any, output: Any) -> Number:
    """Return Barker's codes of four-bars by their lengths, numbers or arrays.

    An empty code where no such lengths can be assembled.

    >>> four_bar_code(2.0, 1.0, [2.5, 0.7, 6.0], 2.5).tolist()
    ['GCRR', 'RRR4', '']
    """
    lengths = _lengths(base=base, input=input, coupler=coupler, output=output)
    total = lengths.sum(axis=-1)
    ranked = np.sort(lengths, axis=-1)
    margin = ranked[..., 1] + ranked[..., 2] - ranked[..., 0] - ranked[..., 3]
    near = EQUAL * total
    grashof = np.asarray(_GRASHOF)[lengths.argmin(axis=-1)]
    rockers = np.char.add(_ROCKERS, (lengths.argmax(axis=-1) + 1).astype(str))
    change = np.asarray(_CHANGE)[lengths.argmin(axis=-1)]
    pairs = ranked[..., 1] - ranked[..., 0] <= near
    change = np.where(pairs, np.where(ranked[..., 3] - ranked[..., 0] <= near, "S3X", "S2X"), change)
    closed = 2.0 * ranked[..., 3] - total <= near
    return np.where(closed, np.where(np.abs(margin) <= near, change, np.where(margin > 0, grashof, rockers)), "")


def _lengths(**given: Any) -> Number:
    """Return the lengths of links in a last axis of four. Raises InvalidInput for what is no length."""
    lengths = {name: real_numbers(name, value) for name, value in given.items()}
    for name, value in lengths.items():
        if not np.all((value > 0) & (value < LONGEST)):
            raise InvalidInput(Problem(name, "links of a four-bar are longer than nothing", "give positive lengths"))
    try:
        return np.stack(np.broadcast_arrays(*lengths.values()), axis=-1)
    except ValueError:
        shapes = ", ".join(str(np.shape(value)) for value in lengths.values())
        raise InvalidInput(
            Problem("lengths", f"arrays of shapes {shapes} do not fit each other", "one shape")
        ) from None
