"""The classes of what the functions return, for annotations.

>>> import compoundkin as ck
>>> isinstance(ck.decompose(ck.load("six-bar")), ck.results.Structure)
True
"""

from __future__ import annotations

from compoundkin.analysis.cam_analysis import CamAnalysis
from compoundkin.analysis.centres import Centres
from compoundkin.analysis.characteristics.characteristics import Characteristics
from compoundkin.analysis.checks import Check, Finding
from compoundkin.analysis.comparison import MechanismComparison
from compoundkin.analysis.equations.loop_equations import LoopEquations
from compoundkin.analysis.interference import Interference
from compoundkin.analysis.singularity import Singularities, Singularity
from compoundkin.configurations.circuit_search import Circuits
from compoundkin.configurations.workspace import Workspace
from compoundkin.dimensional.cognates import Cognates
from compoundkin.dimensional.dyads import Dyads
from compoundkin.dimensional.synthesis import Answer
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.intermittent_motion import IntermittentMotion
from compoundkin.dynamics.motor_sizing import Sizing
from compoundkin.dynamics.simulation.phases import SimulationPhase
from compoundkin.dynamics.simulation.simulation import Simulation
from compoundkin.dynamics.strength import Strength
from compoundkin.files.exchange.contract import Exported, Imported
from compoundkin.kinematics import Motion
from compoundkin.kinematics.configuration import Configuration, Configurations
from compoundkin.kinematics.gaps import Gap
from compoundkin.kinematics.quantities import Quantity, Table
from compoundkin.programs.compiled_path import CompiledPath
from compoundkin.structure import Group, Structure
from compoundkin.structure.redundancy import MobilityAnalysis
from compoundkin.studies.optimisation.optimum import Optimum
from compoundkin.studies.study import Study
from compoundkin.studies.study_result import StudyResult
from compoundkin.studies.tolerances.tolerance_analysis import ToleranceAnalysis
from compoundkin.view.animation import Animation
from compoundkin.view.page import Page
from compoundkin.view.plot import Plot
from compoundkin.view.report import Report
from compoundkin.view.report.exercises import Exercise, Exercises
from compoundkin.view.sketch import Picture

__all__ = [
    "Animation",
    "Answer",
    "CamAnalysis",
    "Centres",
    "Characteristics",
    "Check",
    "Circuits",
    "Cognates",
    "CompiledPath",
    "Configuration",
    "Configurations",
    "Dyads",
    "Exercise",
    "Exercises",
    "Exported",
    "Finding",
    "Forces",
    "Gap",
    "Group",
    "Imported",
    "Interference",
    "IntermittentMotion",
    "LoopEquations",
    "MechanismComparison",
    "MobilityAnalysis",
    "Motion",
    "Optimum",
    "Page",
    "Picture",
    "Plot",
    "Quantity",
    "Report",
    "Simulation",
    "SimulationPhase",
    "Singularities",
    "Singularity",
    "Sizing",
    "Strength",
    "Structure",
    "Study",
    "StudyResult",
    "Table",
    "ToleranceAnalysis",
    "Workspace",
]
