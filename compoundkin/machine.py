"""Figures of machines: equivalent inertia, balancing, flywheels, efforts over a cycle, equilibrium positions.

>>> import compoundkin as ck
>>> items = ck.link("frame", A=0), ck.link("arm", A=0, B=4), ck.drive("arm"), ck.mass("arm", 3.0, at=(2, 0), inertia=0)
>>> arm = ck.Mechanism("Arm", *items, units={"length": "m", "mass": "kg", "force": "N"})
>>> ck.machine.equivalent_inertia(ck.solve(arm, [0.0])).inertia
array([12.])
"""

from __future__ import annotations

from compoundkin.dynamics.balance.balance_figures import BalanceFigure
from compoundkin.dynamics.balance.counterweight_masses import Counterweight
from compoundkin.dynamics.balance.counterweights import ForceBalance, counterweights
from compoundkin.dynamics.drives.drive_figures import DriveFigures, drive_figures
from compoundkin.dynamics.drives.equilibria import EquilibriumPositions, equilibria
from compoundkin.dynamics.drives.equilibrium_kind import EquilibriumPosition
from compoundkin.dynamics.drives.flywheel import Flywheel, flywheel
from compoundkin.dynamics.drives.force_ratio import force_ratio
from compoundkin.dynamics.drives.harmonics import Harmonics, harmonics
from compoundkin.dynamics.work.equivalent_inertia import EquivalentInertia, equivalent_inertia

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
