"""Sobol's sequence, scrambled: it fills the range of the dimensions more evenly than random numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar, Self

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, LikelySlip, Problem, warn
from compoundkin.studies.samples.design_sample import UnitSample, columns_of
from compoundkin.studies.samples.variation import Variation

BITS = 30


@dataclass(frozen=True)
class SobolSample(UnitSample):
    """The first designs of Sobol's sequence, those of scipy.stats.qmc.

    Sources: I. M. Sobol' 1967; direction numbers of S. Joe and F. Y. Kuo 2008; scrambled after J. Matoušek 1998.
    """

    word: ClassVar[str] = "sobol"
    count: int
    seed: int = 0

    @classmethod
    def of(cls, count: int | None, seed: int, variations: Mapping[str, Variation]) -> Self:
        """Return the sample; raises InvalidInput. It warns where the count is no power of two."""
        from scipy.stats import qmc

        found, columns = super().of(count, seed, variations), columns_of(variations)
        if columns > qmc.Sobol.MAXDIM:
            what = f"the dimensions take {columns} numbers a design, and Sobol's sequence has {qmc.Sobol.MAXDIM}"
            raise InvalidInput(Problem("sample", what, "take 'latin-hypercube' or 'random'"))
        if found.count & (found.count - 1):
            below = 1 << (found.count.bit_length() - 1)
            what = f"Sobol's sequence is even at powers of two, and {found.count} is none"
            warn(f"{what}; take count={below} or {2 * below}", LikelySlip)
        return found

    def units(self, columns: int, rows: range) -> Number:
        """Return rows of the sequence. Each is the one before it with one direction number changed."""
        if not len(rows):
            return np.empty((0, columns))
        first, directions = _directions(columns, self.seed, max(self.count - 1, 1).bit_length())
        steps = np.empty((len(rows), columns), dtype=np.uint32)
        bits = _gray_bits(rows.start)
        steps[0] = np.bitwise_xor.reduce(directions[bits], axis=0, initial=0) ^ first
        index = np.arange(rows.start + 1, rows.stop)
        # the exponent of the last bit of the index: an exact power of two
        steps[1:] = directions[np.log2(index & -index).astype(np.int64)]
        return np.bitwise_xor.accumulate(steps, axis=0) * 2.0**-BITS


def _gray_bits(index: int) -> list[int]:
    """The bits of a Gray code that are set."""
    code = index ^ (index >> 1)
    return [k for k in range(code.bit_length()) if code >> k & 1]


@lru_cache(maxsize=8)
def _directions(columns: int, seed: int, bits: int) -> tuple[Number, Number]:
    """The first point and the direction numbers, read off scipy's sequence.

    The Gray code of 2^(k+1) - 1 has the bit k alone, so that this point and the first one differ by direction k.
    """
    from scipy.stats import qmc

    # older versions of scipy know no `rng`, and all take a generator as `seed`
    engine = qmc.Sobol(columns, scramble=True, bits=BITS, seed=np.random.default_rng(seed))
    first, found = _whole(engine.random(1)), []
    for k in range(bits):
        if k:
            engine.fast_forward(2**k - 1)
        found.append(_whole(engine.random(1)) ^ first)
    return first, np.array(found)


def _whole(point: Number) -> Number:
    return np.asarray(np.round(point[0] * 2.0**BITS).astype(np.uint32))
