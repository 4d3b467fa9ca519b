"""Figures of machines: equivalent inertia, balancing, flywheels, efforts over a cycle, equilibrium positions.

>>> import compoundkin as ck
>>> items = ck.link("frame", A=0), ck.link("arm", A=0, B=4), ck.drive("arm"), ck.mass("arm", 3.0, at=(2, 0), inertia=0)
>>> arm = ck.Mechanism("Arm", *items, units={"length": "m", "mass": "kg", "force": "N"})
>>> ck.machine.equivalent_inertia(ck.solve(arm, [0.0])).inertia
array([12.])
"""

from __future__ import annotations

from compoundkin.dynamics.counterweights import BalanceFigure, Counterweight, ForceBalance, counterweights
from compoundkin.dynamics.driver_course import DriveFigures, drive_figures, force_ratio
from compoundkin.dynamics.equilibria import EquilibriumPosition, EquilibriumPositions, equilibria
from compoundkin.dynamics.flywheel import Flywheel, flywheel
from compoundkin.dynamics.harmonics import Harmonics, harmonics
from compoundkin.dynamics.mass_motion import EquivalentInertia, equivalent_inertia

__all__ = [
    "BalanceFigure",
    "Counterweight",
    "DriveFigures",
    "EquilibriumPosition",
    "EquilibriumPositions",
    "EquivalentInertia",
    "Flywheel",
    "ForceBalance",
    "Harmonics",
    "counterweights",
    "drive_figures",
    "equilibria",
    "equivalent_inertia",
    "flywheel",
    "force_ratio",
    "harmonics",
]
