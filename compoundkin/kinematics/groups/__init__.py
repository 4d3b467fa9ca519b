"""The ways of solving an Assur group: one file each, and this registry, of which the first that fits is taken."""

from __future__ import annotations

from collections.abc import Mapping

from compoundkin.kinematics.groups.contract import GroupSolver, equations_of
from compoundkin.kinematics.groups.dyad import DyadSolver
from compoundkin.kinematics.groups.follower import FollowerSolver
from compoundkin.kinematics.groups.gear_train import GearTrainSolver
from compoundkin.kinematics.groups.general import GeneralSolver
from compoundkin.kinematics.groups.prp import PRP
from compoundkin.kinematics.groups.rpp import RPP
from compoundkin.kinematics.groups.rpr import RPR
from compoundkin.kinematics.groups.rrp import RRP
from compoundkin.kinematics.groups.rrr import RRR
from compoundkin.model.pairs.contract import Ends
from compoundkin.structure.mobility_count import Group

SOLVERS: tuple[type[GroupSolver], ...] = (RRR, RRP, RPR, PRP, RPP, GearTrainSolver, FollowerSolver, GeneralSolver)
# The dyads by their names.
DYADS: dict[str, type[DyadSolver]] = {kind.name: kind for kind in SOLVERS if issubclass(kind, DyadSolver)}


def solver_of(index: int, group: Group, size: float, ends: Mapping[str, Ends]) -> GroupSolver:
    """Return the solver of a group, of the first way that fits. The last one fits all."""
    found = (kind.of(index, group, size, ends) for kind in SOLVERS)
    return next(solver for solver in found if solver is not None)


def as_dyad(solver: GroupSolver) -> DyadSolver | None:
    """Return the solver of a dyad as such; None for another one."""
    return solver if isinstance(solver, DyadSolver) else None


__all__ = ["DYADS", "SOLVERS", "DyadSolver", "GroupSolver", "as_dyad", "equations_of", "solver_of"]
