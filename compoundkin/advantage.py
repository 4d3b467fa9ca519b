"""Mechanical advantage: what a force or torque at one place is worth at another.

>>> import compoundkin as ck
>>> motion = ck.solve(ck.catalog.load_named("crank-rocker"), {"crank": [1.0]}, speed=1)
>>> ck.advantage.mechanical_advantage(motion, "rocker", "crank").advantage.round(3)
array([3.573])
"""

from __future__ import annotations

from compoundkin.analysis.mechanical_advantage import ForcePort, Port, TorquePort, mechanical_advantage
from compoundkin.kinematics.derived.velocity_ratio import Advantage

__all__ = ["Advantage", "ForcePort", "Port", "TorquePort", "mechanical_advantage"]
