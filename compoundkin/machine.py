"""Figures of machines: equivalent inertia, balancing, flywheels, efforts over a cycle, equilibrium positions.

>>> import compoundkin as ck
>>> items = ck.link("frame", A=0), ck.link("arm", A=0, B=4), ck.drive("arm"), ck.mass("arm", 3.0, at=(2, 0), inertia=0)
>>> arm = ck.Mechanism("Arm", *items, units={"length": "m", "mass": "kg", "force": "N"})
>>> ck.machine.equivalent_inertia(ck.solve(arm, [0.0])).inertia
array([12.])
"""

from __future__ import annotations

from compoundkin.dynamics.balance_figures import BalanceFigure
from compoundkin.dynamics.counterweight_masses import Counterweight
from compoundkin.dynamics.counterweights import ForceBalance, counterweights
from compoundkin.dynamics.drive_figures import DriveFigures, drive_figures
from compoundkin.dynamics.equilibria import EquilibriumPositions, equilibria
from compoundkin.dynamics.equilibrium_kind import EquilibriumPosition
from compoundkin.dynamics.equivalent_inertia import EquivalentInertia, equivalent_inertia
from compoundkin.dynamics.flywheel import Flywheel, flywheel
from compoundkin.dynamics.force_ratio import force_ratio
from compoundkin.dynamics.harmonics import Harmonics, harmonics

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
