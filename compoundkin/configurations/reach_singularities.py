"""How well the drivers hold a point over its reach: condition numbers, and the curves where they lose their hold.

Where the point is led the rates of the drivers are the inverse of the Jacobian; where its determinant is zero the
mechanism moves though its drivers rest (C. Gosselin and J. Angeles, 1990, the second kind).
"""

from __future__ import annotations

import numpy as np

from compoundkin.base.arrays import TURN, Number
from compoundkin.configurations.led_point import ACROSS, ALONG, TURN_OF, LiveSigns
from compoundkin.configurations.reach import Reach
from compoundkin.configurations.region_boundary import Lattice
from compoundkin.kinematics.block import BLOCK
from compoundkin.kinematics.solving_order import run

# So many angles of the point's link are tried where any will do.
ANGLES = 12


def inverse_rates(reach: Reach, z: Number, angle: Number, number: Number) -> Number:
    """Return the rates (n, drivers, coordinates) of drivers as the point is led.

    They are free of units. Its coordinates are x, y and, where it is led, the angle of its link; `number` is the
    configuration of each place.
    """
    cuts = [slice(k, k + BLOCK) for k in range(0, max(len(z), 1), BLOCK)]
    return np.concatenate([_rates(reach, z[k], angle[k], number[k]) for k in cuts])


def _rates(reach: Reach, z: Number, angle: Number, number: Number) -> Number:
    led, size = reach.led, reach.led.driven.size
    signs = LiveSigns({k: v[number][None] for k, v in (reach.live or {}).items()})
    columns = []
    for moved, unit in ((ALONG, size), (ACROSS, size), *([(TURN_OF, 1.0)] if led.turns else [])):
        block, _ = led.block(z, angle, 1, moved)
        with np.errstate(all="ignore"):
            run(led.led, block, signs)
            rates = {name: one.derivative(1) for name, one in led.coordinates(block).items()}
        units = {name: 1.0 if led.driven.structure.driven_angles[name] else size for name in rates}
        columns.append([np.broadcast_to(one, (1, len(z)))[0] * unit / units[name] for name, one in rates.items()])
    return np.moveaxis(np.array(columns), (0, 1, 2), (2, 1, 0))


def condition(reach: Reach, lattice: Lattice) -> Number:
    """Return the least condition numbers (n,) at the inner places of a lattice.

    They are of the Jacobian to the point alone, over the configurations that lead there; where the point's link may
    have any angle, over some angles too.
    """
    z = lattice.places[lattice.inside]
    least = np.full(len(z), np.nan)
    for turned in TURN * np.arange(ANGLES) / ANGLES if reach.seeks_angle else [reach.angle or 0.0]:
        angle = np.full(len(z), turned)
        for number, on in enumerate(reach.margins(z, angle) >= 0.0):
            count = np.full(np.count_nonzero(on), number)
            least[on] = np.fmin(least[on], _condition(inverse_rates(reach, z[on], angle[on], count)))
    return least


def _condition(rates: Number) -> Number:
    """Return the condition numbers of the place by the drivers, from the drivers' rates."""
    unit = np.eye(rates.shape[1])
    safe = np.where(np.isfinite(rates).all(axis=(1, 2))[:, None, None], rates, 0.0 * unit)
    held = np.abs(np.linalg.det(safe)) > 0.0
    values = np.linalg.svd(np.linalg.inv(np.where(held[:, None, None], safe, unit))[:, :2], compute_uv=False)
    return np.where(held, values[:, 0] / values[:, -1], np.inf)


def determinants(reach: Reach, lattice: Lattice) -> Number:
    """Return the determinants of the drivers' rates over a lattice, (configurations, rows, columns).

    Of the configurations that occur, NaN where each is none; none where the point's link may have any angle.
    """
    if reach.live is None or reach.seeks_angle:
        return np.empty((0, *lattice.places.shape))
    z, angle = lattice.places.ravel(), lattice.angle.ravel()
    margins = reach.margins(z, angle, own=False)
    found = np.full(margins.shape, np.nan)
    for number, on in enumerate(margins >= 0.0):
        count = np.full(np.count_nonzero(on), number)
        found[number, on] = np.linalg.det(inverse_rates(reach, z[on], angle[on], count))
    return found.reshape(-1, *lattice.places.shape)
