"""The four-bar inside the six-bar, with its coupler point C, for compoundkin and for pylinkage.

pylinkage's compiled kernels know cranks, RRR dyads, rigid points and RRP dyads, but no guide that swings:
of the six-bar they can do the crank, A and C. They cannot be given crank angles but step from pose to pose.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import compoundkin as ck
from tests.benchmarks.six_bar import AB, DA, DC, ED, SPEED, B

Answer = dict[str, tuple[np.ndarray, ...]]


def mechanism() -> ck.Mechanism:
    """Crank, plate with C, rocker."""
    return ck.Mechanism(
        "Four-bar",
        ck.link("frame", E=0, B=B),
        ck.link("crank", E=0, D=ED),
        ck.link("plate", D=0, A=DA, C=DC),
        ck.link("rocker", B=0, A=AB),
        ck.drive("crank"),
        ck.mode(1, "rocker"),
    )


def asked(motion: ck.results.Motion, order: int) -> Answer:
    """The points' positions and rates: what pylinkage computes."""
    return {k: tuple(motion.points[k].derivative(j) for j in range(order + 1)) for k in ("D", "A", "C")}


def by_pylinkage(order: int) -> Callable[[int], Answer]:
    """pylinkage's compiled loop over so many poses of a full turn, up to velocity or acceleration.

    Raises ImportError where pylinkage or numba is missing.
    """
    from numba import njit
    from pylinkage.actuators import Crank
    from pylinkage.bridge.solver_conversion import linkage_to_solver_data
    from pylinkage.components import Ground
    from pylinkage.dyads import FixedDyad, RRRDyad
    from pylinkage.simulation import Linkage
    from pylinkage.solver.simulation import simulate_with_kinematics, step_single, step_single_velocity

    @njit
    def with_velocity(positions, velocities, data, omega, cranks, iterations, dt):  # type: ignore[no-untyped-def]
        """As pylinkage's own loop, without its accelerations."""
        found = np.empty((2, iterations, *positions.shape))
        for step in range(iterations):
            step_single(positions, *data, dt)
            step_single_velocity(positions, velocities, *data, omega, cranks)
            found[0, step], found[1, step] = positions, velocities
        return found

    e, b = Ground(0.0, 0.0, name="E"), Ground(B.real, B.imag, name="B")
    start = ck.solve(mechanism(), {"crank": 0.0})
    at = {k: complex(start.points[k].position) for k in "DAC"}
    crank = Crank(anchor=e, radius=ED, angular_velocity=1.0, name="D")
    dyad = RRRDyad(crank.output, b, distance1=DA, distance2=AB, name="A")
    rigid = FixedDyad(crank.output, dyad, distance=abs(DC), angle=float(np.angle(DC)), name="C")
    data = linkage_to_solver_data(Linkage([e, b, crank, dyad, rigid]))
    arrays = data.constraints, data.joint_types, data.parent_indices, data.constraint_offsets, data.solve_order
    cranks, omega, alpha = np.array([2], dtype=np.int32), np.array([SPEED]), np.zeros(1)

    def run(count: int) -> Answer:
        positions = np.array([[0.0, 0.0], [B.real, B.imag], *([at[k].real, at[k].imag] for k in "DAC")])
        rates, second, dt = np.zeros_like(positions), np.zeros_like(positions), 2 * np.pi / count
        if order == 1:
            found = tuple(with_velocity(positions, rates, arrays, omega, cranks, count, dt))
        else:
            found = simulate_with_kinematics(positions, rates, second, *arrays, omega, alpha, cranks, count, dt)
        return {k: tuple(x[:, j, 0] + 1j * x[:, j, 1] for x in found) for j, k in ((2, "D"), (3, "A"), (4, "C"))}

    return run
