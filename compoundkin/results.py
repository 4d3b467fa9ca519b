"""The classes of what the functions return, for annotations.

>>> import compoundkin as ck
>>> isinstance(ck.decompose(ck.catalog.load_named("six-bar")), ck.results.Structure)
True
"""

from __future__ import annotations

from compoundkin.analysis.centres import Centres
from compoundkin.analysis.characteristics.characteristics import Characteristics
from compoundkin.analysis.checks import Check, Finding
from compoundkin.analysis.comparison_result import (
    ComparedDriver,
    ComparedFact,
    ComparedLength,
    MechanismComparison,
    PlaceDifference,
    TurnDifference,
)
from compoundkin.analysis.equations.loop_equations import LoopEquations
from compoundkin.analysis.interference import Interference, LinkClearance, LinkTouch
from compoundkin.configurations.circuit_search import Circuits
from compoundkin.configurations.workspace import Workspace
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.friction.efficiency import Efficiency
from compoundkin.dynamics.friction.friction_forces import FrictionForces, PairFriction, PoseStretch, Wedged
from compoundkin.dynamics.reactions.driver_efforts import DriverEffort, Powers
from compoundkin.dynamics.reactions.link_forces import LinkForces, PinForces, ShakingForce
from compoundkin.dynamics.reactions.link_wrench import LinkWrench
from compoundkin.dynamics.reactions.pair_forces import LiftOff, LiftOffSpeed, PairForce
from compoundkin.dynamics.reactions.singular_poses import SingularPose
from compoundkin.dynamics.reactions.undetermined import Undetermined
from compoundkin.dynamics.reactions.virtual_work import HoldingEffort
from compoundkin.dynamics.simulation.simulated_energy import SimulatedEnergy
from compoundkin.dynamics.simulation.simulation import Simulation
from compoundkin.dynamics.simulation.simulation_events import SimulationEvent
from compoundkin.files.exchange.exchanged import Exported, Imported
from compoundkin.files.exchange.known_formats import KnownFormat
from compoundkin.kinematics import LinkMotion, Motion, PairMotion, PointMotion
from compoundkin.kinematics.chosen_modes import GroupMode
from compoundkin.kinematics.configuration import Configuration
from compoundkin.kinematics.configuration_arrays import Configurations
from compoundkin.kinematics.gaps import Gap
from compoundkin.kinematics.jacobian import Jacobian
from compoundkin.kinematics.quantities import Quantity
from compoundkin.kinematics.table import Table
from compoundkin.programs.compiled_path import CompiledPath
from compoundkin.programs.derivatives.path_objective import ObjectivePose, PathObjective
from compoundkin.programs.derivatives.path_sensitivities import PathSensitivities
from compoundkin.programs.jax_path import JaxPath
from compoundkin.programs.path_values import PathValues
from compoundkin.structure import Group, Structure
from compoundkin.structure.redundancy import MobilityAnalysis
from compoundkin.studies.optimisation.optimum import ChangedDimension, HeldConstraint, LocalMinimum, Optimum
from compoundkin.studies.samples.value_ranges import AroundCentre
from compoundkin.studies.study import Study
from compoundkin.studies.study_result import StudyResult
from compoundkin.studies.tolerances.output_tolerance import OutputTolerance, SampledOutput
from compoundkin.studies.tolerances.tolerance_analysis import ToleranceAnalysis
from compoundkin.view.animation import Animation
from compoundkin.view.page import Page
from compoundkin.view.plot import Plot
from compoundkin.view.report import Report
from compoundkin.view.sketch import Picture

__all__ = [
    "Animation",
    "AroundCentre",
    "Centres",
    "ChangedDimension",
    "Characteristics",
    "Check",
    "Circuits",
    "ComparedDriver",
    "ComparedFact",
    "ComparedLength",
    "CompiledPath",
    "Configuration",
    "Configurations",
    "DriverEffort",
    "Efficiency",
    "Exported",
    "Finding",
    "Forces",
    "FrictionForces",
    "Gap",
    "Group",
    "GroupMode",
    "HeldConstraint",
    "HoldingEffort",
    "Imported",
    "Interference",
    "Jacobian",
    "JaxPath",
    "KnownFormat",
    "LiftOff",
    "LiftOffSpeed",
    "LinkClearance",
    "LinkForces",
    "LinkMotion",
    "LinkTouch",
    "LinkWrench",
    "LocalMinimum",
    "LoopEquations",
    "MechanismComparison",
    "MobilityAnalysis",
    "Motion",
    "ObjectivePose",
    "Optimum",
    "OutputTolerance",
    "Page",
    "PairForce",
    "PairFriction",
    "PairMotion",
    "PathObjective",
    "PathSensitivities",
    "PathValues",
    "Picture",
    "PinForces",
    "PlaceDifference",
    "Plot",
    "PointMotion",
    "PoseStretch",
    "Powers",
    "Quantity",
    "Report",
    "SampledOutput",
    "ShakingForce",
    "SimulatedEnergy",
    "Simulation",
    "SimulationEvent",
    "SingularPose",
    "Structure",
    "Study",
    "StudyResult",
    "Table",
    "ToleranceAnalysis",
    "TurnDifference",
    "Undetermined",
    "Wedged",
    "Workspace",
]  # fmt: skip
