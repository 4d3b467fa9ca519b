"""Path synthesis of four-bars in the literature: points to be led through, bounds, and mechanisms that were published.

The points are those of J. A. Cabrera, A. Simon, M. Prado, Optimal synthesis of mechanisms with genetic algorithms,
Mech. Mach. Theory 37 (2002) 1165-1177 (a line, five and eighteen points; the latter two after A. Kunjur,
S. Krishnamurty, J. Appl. Mech. Robot. 4 (1997) 18-24), and of S. K. Acharyya, M. Mandal, Performance of EAs for
four-bar linkage synthesis, Mech. Mach. Theory 44 (2009) 1784-1794 (the ellipse). Mechanisms are tabulated by
S. Nguyen-Van et al., A new study on optimization of four-bar mechanisms based on a hybrid-combined differential
evolution and Jaya algorithm, Symmetry 14 (2022) 381, doi 10.3390/sym14020381, with their program.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

import compoundkin as ck
from compoundkin.base.arrays import Number

TWENTY = np.deg2rad(20.0 * np.arange(18))


class Published(NamedTuple):
    """A four-bar of the literature.

    `sizes` are frame r1, crank r2, coupler r3, rocker r4, the coupler's point along and across it, the crank's pivot
    x, y and the frame's angle; `angles` those of the crank to the frame, at the points. `mode` is the side on which
    the coupler's end lies.
    """

    who: str
    sizes: tuple[float, ...]
    angles: Number
    mode: int = 1

    def error(self, target: Number) -> float:
        """The sum of the squares of the distances, by the closed form that the sources use."""
        r1, r2, r3, r4, along, across, x, y, tilt = self.sizes
        crank = r2 * np.exp(1j * self.angles)
        diagonal = r1 - crank
        length = abs(diagonal)
        foot = (length**2 + r3**2 - r4**2) / (2 * length)
        coupler = (foot + self.mode * 1j * np.sqrt(r3**2 - foot**2)) * diagonal / length / r3
        places = x + 1j * y + np.exp(1j * tilt) * (crank + (along + 1j * across) * coupler)
        return float((abs(places - target) ** 2).sum())

    @property
    def motion(self) -> ck.results.Motion:
        """The mechanism, moved to the points."""
        r1, r2, r3, r4, along, across, x, y, tilt = self.sizes
        pivot = complex(x, y)
        plan = four_bar(pivot, pivot + r1 * np.exp(1j * tilt), r2, r3, complex(along, across), r4, -self.mode)
        return ck.solve(plan, {"crank": self.angles + tilt})


class PathCase(NamedTuple):
    """Points, and within which bounds lengths and places may be; `steps` are turns of the crank if they are given."""

    target: Number
    lengths: tuple[float, float]
    places: float
    published: tuple[Published, ...]
    steps: Number | None = None

    @property
    def best(self) -> float:
        """The least error among those published."""
        return min(one.error(self.target) for one in self.published)


def four_bar(
    pivot: complex, other: complex, crank: complex, coupler: float, point: complex, rocker: float, mode: int = 1
) -> ck.Mechanism:
    """A four-bar with a point of its coupler."""
    return ck.Mechanism(
        "Four-bar",
        ck.link("frame", A=pivot, D=other),
        ck.link("crank", A=0, B=crank),
        ck.link("coupler", B=0, C=coupler, P=point),
        ck.link("rocker", D=0, C=rocker),
        ck.drive("crank"),
        ck.mode(mode, "rocker"),
    )


def closed(*angles: float) -> Number:
    """Angles that are given within one turn, as they follow one another."""
    return np.unwrap(np.array(angles))


CASES = {
    "line": PathCase(
        20 + 1j * np.array([20, 25, 30, 35, 40, 45]),
        (5.0, 60.0),
        60.0,
        (
            Published(
                "J. A. Cabrera et al., Mech. Mach. Theory 46 (2011) 127-141 (MUMSA)",
                (31.788264, 8.2046468, 24.932131, 31.385926, 34.193719, 14.415668, -6.366519, 56.83676, 4.015959),
                closed(1.366547, 2.330773, 2.871039, 3.394591, 3.97096, 4.96349),
            ),
            Published(
                "S. Nguyen-Van et al. 2022",
                (14.201369, 8.0143127, 16.309922, 12.253871, 27.797721, 11.305412, -2.309531, 45.695083, 4.5172417),
                closed(6.2532447, 2.4038981, 2.9362397, 3.4905751, 4.0650776, 5.2095019),
            ),
        ),
    ),
    "five": PathCase(
        np.array([3 + 3j, 2.759 + 3.363j, 2.372 + 3.663j, 1.890 + 3.862j, 1.355 + 3.943j]),
        (0.0, 50.0),
        50.0,
        (
            Published(
                "A. Kunjur, S. Krishnamurty 1997",
                (3.509643, 1.857606, 4.725835, 3.518721, 1.959538, 1.558898, 0, 0, 0),
                np.deg2rad([30, 45, 60, 75, 90]),
            ),
            Published(
                "J. A. Cabrera et al. 2002",
                (3.0630424, 1.9959624, 3.305823, 2.524706, 1.645158, 1.708959, 0, 0, 0),
                np.deg2rad([30, 45, 60, 75, 90]),
            ),
            Published(
                "J. A. Cabrera et al. 2011 (MUMSA)",
                (3.77326856, 2.00000403, 4.11697104, 2.74615671, 1.67848787, 1.67098007, 0, 0, 0),
                np.deg2rad([30, 45, 60, 75, 90]),
            ),
        ),
        np.deg2rad([30, 45, 60, 75, 90]),
    ),
    "eighteen": PathCase(
        np.array(
            [0.5 + 1.1j, 0.4 + 1.1j, 0.3 + 1.1j, 0.2 + 1j, 0.1 + 0.9j, 0.05 + 0.75j, 0.02 + 0.6j, 0.5j, 0.4j,
             0.03 + 0.3j, 0.1 + 0.25j, 0.15 + 0.2j, 0.2 + 0.3j, 0.3 + 0.4j, 0.4 + 0.5j, 0.5 + 0.7j, 0.6 + 0.9j,
             0.6 + 1j]
        ),
        (0.0, 50.0),
        50.0,
        (
            Published(
                "A. Kunjur, S. Krishnamurty 1997",
                (1.87966, 0.274853, 1.180253, 2.138209, -0.833592, -0.37877, 1.132062, 0.663433, 4.354224),
                2.558625 + TWENTY,
            ),
            Published(
                "J. A. Cabrera et al. 2002",
                (3.057878, 0.237803, 4.828954, 2.056456, 0.767038, 1.850828, 1.776808, -0.641991, 1.002168),
                0.226186 + TWENTY,
            ),
            Published(
                "J. A. Cabrera et al. 2011 (MUMSA)",
                (4.453772, 0.297057, 3.913095, 0.849372, -2.067338, 1.6610626, -1.309243, 2.806964, 2.7387359),
                4.853543 + TWENTY,
            ),
            Published(
                "S. Nguyen-Van et al. 2022",
                (49.800886, 0.28817159, 48.476138, 1.633642, -23.41281, 7.6644886, -14.836153, 20.140223, 2.5286091),
                5.0644224 + TWENTY,
            ),
        ),
        TWENTY,
    ),
    "ellipse": PathCase(
        np.array(
            [20 + 10j, 17.66 + 15.142j, 11.736 + 17.878j, 5 + 16.928j, 0.60307 + 12.736j, 0.60307 + 7.2638j,
             5 + 3.0718j, 11.736 + 2.1215j, 17.66 + 4.8577j, 20 + 10j]
        ),
        (5.0, 80.0),
        80.0,
        (
            Published(
                "J. A. Cabrera et al. 2011 (MUMSA)",
                (79.516068, 9.723973, 45.842524, 51.432848, 8.213922, -2.9539575, 2.021109, 13.2165878, 5.5969445),
                closed(0.6376873, 1.3255329, 2.0080339, 2.6955659, 3.3845794, 4.0829376, 4.7984548, 5.5117057,
                       6.2127919, 0.6371866),
            ),
            Published(
                "W.-Y. Lin, Mech. Mach. Theory 45 (2010) 1096-1107 (GA-DE)",
                (80.0, 8.045662, 50.81902, 42.20801, -10.63697, -2.29109, 8.494813, -0.7579678, 3.88921),
                closed(2.449437, 3.153969, 3.837114, 4.520171, 5.204799, 5.898536, 0.316204, 1.023555, 1.738992,
                       2.449437),
            ),
            Published(
                "S. Nguyen-Van et al. 2022",
                (79.999856, 8.1232008, 50.870344, 42.360533, -10.853763, 0.091433127, 7.5379031, -0.52254141,
                 4.0121195),
                closed(2.3428599, 3.0535127, 3.7417464, 4.4255457, 5.1086716, 5.7983829, 0.21286893, 0.91658554,
                       1.6304135, 2.3428152),
            ),
        ),
    ),
}  # fmt: skip
