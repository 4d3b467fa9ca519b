"""The four-bar of `four_bar` with its coupler point C by other packages, as far as they are installed.

Each gives C for one turn of the crank at so many poses, with as many derivatives as it has: `mechanism` (loop equations
by SciPy's `fsolve`, pose by pose) and `kimech` (Newton steps, pose by pose) position, velocity and acceleration,
`kinepy` (dyads over arrays) positions. pylinkage's compiled loop is in `four_bar`.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

import compoundkin as ck
from tests.benchmarks import four_bar
from tests.benchmarks.six_bar import AB, DA, DC, ED, SPEED, B

# C over the poses, with its derivatives.
Course = tuple[Any, ...]


def by_kimech(count: int) -> Callable[[], Course]:
    """Return kimech's answer. Raises ImportError where it is missing."""
    import kimech

    mechanism = kimech.Mechanism("four_bar")
    e, b = mechanism.ground.add_point("E", (0.0, 0.0)), mechanism.ground.add_point("B", (B.real, B.imag))
    crank, plate, rocker = (mechanism.add_link(name) for name in ("crank", "plate", "rocker"))
    driven = mechanism.revolute(e, crank.add_point("E", (0.0, 0.0)), name="input")
    mechanism.revolute(crank.add_point("D", (ED, 0.0)), plate.add_point("D", (0.0, 0.0)))
    mechanism.revolute(plate.add_point("A", (DA, 0.0)), rocker.add_point("A", (AB, 0.0)))
    mechanism.revolute(rocker.add_point("B", (0.0, 0.0)), b)
    point = plate.add_point("C", (DC.real, DC.imag))
    start = ck.solve(four_bar.mechanism(), {"crank": 0.0})
    guess = {
        own: (float(z.real), float(z.imag), float(start.links[name].angle))
        for own, name in ((crank, "crank"), (plate, "plate"), (rocker, "rocker"))
        for z in [complex(start.links[name].origin.position)]
    }

    def run() -> Course:
        driver = kimech.KinematicDriver(driven, position=angles(count), velocity=SPEED, acceleration=0.0)
        found = kimech.solve(mechanism, drivers=driver, initial_guess=guess)
        parts = found.point_positions(point), found.point_velocities(point), found.point_accelerations(point)
        return tuple(np.asarray(one)[:, 0] + 1j * np.asarray(one)[:, 1] for one in parts)

    return run


def by_mechanism(count: int) -> Callable[[], Course]:
    """Return the answer of the package `mechanism`. Raises ImportError where it is missing."""
    from mechanism import Mechanism, Vector, get_joints

    e, d, a, b = get_joints("E D A B")
    crank, plate = Vector((e, d), r=ED), Vector((d, a), r=DA)
    ground, rocker = Vector((e, b), r=abs(B), theta=float(np.angle(B))), Vector((b, a), r=AB)
    start = ck.solve(four_bar.mechanism(), {"crank": 0.0})
    first = [float(start.links[name].angle) for name in ("plate", "rocker")]

    def closed(x: Any, driven: Any) -> Any:
        return crank(driven) + plate(x[0]) - ground() - rocker(x[1])

    def run() -> Course:
        turn = angles(count)
        rates = {"vel": np.full(count, SPEED), "acc": np.zeros(count)}
        guess = [first, [0.0, 0.0], [0.0, 0.0]]
        Mechanism((crank, plate, ground, rocker), origin=e, loops=closed, pos=turn, guess=guess, **rates).iterate()
        u, w, alpha = np.exp(1j * plate.pos.thetas), plate.vel.omegas, plate.acc.alphas
        driven = ED * np.exp(1j * turn)
        return (
            driven + DC * u,
            1j * SPEED * driven + 1j * w * DC * u,
            -(SPEED**2) * driven + (1j * alpha - w**2) * DC * u,
        )

    return run


def by_kinepy(count: int) -> Callable[[], Course]:
    """Return kinepy's answer. Raises ImportError where it is missing."""
    import kinepy

    with contextlib.redirect_stdout(io.StringIO()):
        system = kinepy.System()
        crank, plate, rocker = (system.add_solid(name) for name in ("crank", "plate", "rocker"))
        driven = system.add_revolute(0, crank)
        system.add_revolute(crank, plate, p1=(ED, 0.0))
        system.add_revolute(plate, rocker, p1=(DA, 0.0), p2=(AB, 0.0))
        system.add_revolute(0, rocker, p1=(B.real, B.imag))
        system.pilot(driven)
        system.compile()

    def run() -> Course:
        with contextlib.redirect_stdout(io.StringIO()):
            system.solve_kinematics(angles(count))
        x, y = plate.get_point((DC.real, DC.imag))
        return (x + 1j * y,)

    return run


def angles(count: int) -> Any:
    """Return the angles of the crank over a turn."""
    return np.linspace(0.0, 2 * np.pi, count)


BY: Mapping[str, Callable[[int], Callable[[], Course]]] = MappingProxyType(
    {"kinepy": by_kinepy, "kimech": by_kimech, "mechanism": by_mechanism}
)
