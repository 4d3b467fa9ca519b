"""Cognates: other linkages that draw the same coupler curve (Roberts and Chebyshev).

Of a four-bar with fixed pivots a, b, joints A, B and the coupler point P, three linkages draw the curve of P. With the
complex ratio ``m = (P - A) / (B - A)``, which is constant, the third pivot is ``c = a + m (b - a)``; the second linkage
has the joints ``a + P - A`` and ``a + m (B - a)``, the third those about b. Cranks at the same pivot belong to
parallelograms, so that the crank of the second turns like the coupler of the first.

Sources: S. Roberts, On three-bar motion in plane space, Proc. London Math. Soc. 7 (1875) 14-23; P. L. Chebyshev, Les
plus simples systemes de tiges articulees, 1878; A. Cayley, On three-bar motion, Proc. London Math. Soc. 7 (1876)
136-166 (the triangle); R. L. Norton, Design of Machinery, chapter 3 (parallel motion, geared five-bars).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.dimensional.dyads import PR, RR, Dyad
from compoundkin.dimensional.linkages import Linkage, of_dyads


def crank_cognates(z: Number, u: Number, one: Dyad, other: Dyad) -> Iterator[Linkage]:
    """Yield the linkages whose crank turns like a body that two dyads guide, and that draw the curve of its origin.

    `z` and `u` are origins and orientations of the body, arrays (n,). Two cranks have two, a crank and a slider one.
    """
    for first, second in ((one, other), (other, one)):
        if first.kind == RR:
            made = crank_cognate(z, u, first, second)
            if made is not None:
                yield made


def crank_cognate(z: Number, u: Number, first: Dyad, second: Dyad) -> Linkage | None:
    """Return the cognate about the fixed pivot of `first`, whose crank turns like the body; None where it has none."""
    a, arm = first.fixed, -first.moving
    along = second.moving - first.moving
    if abs(along) < 1e-9 * max(abs(arm), abs(second.moving)) or abs(arm) < 1e-12 * max(first.length, 1e-300):
        return None
    m = arm / along
    # the new coupler: its origin is the point, and it turns like the old crank
    old = z + u * first.moving - a
    turned = old / np.abs(old)
    crank = Dyad(RR, a, complex(-first.length), None, abs(arm))
    joint = (m - 1.0) * first.length
    pivot = complex(a + m * (second.fixed - a))
    if second.kind == PR:
        assert second.direction is not None
        end = Dyad(PR, pivot, complex(joint), second.direction * m / abs(m))
    else:
        end = Dyad(RR, pivot, complex(joint), None, abs(m) * second.length)
    return next(of_dyads(z, turned, [(crank, end)]), None)
