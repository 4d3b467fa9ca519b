"""compoundkin: compound planar mechanisms taken apart into Assur groups and solved group by group.

>>> import compoundkin as ck
>>> frame, link = ck.link("frame", A=(0, 0)), ck.link("crank", A=(0, 0), B=(2, 0))
>>> crank = ck.Mechanism("Crank", frame, link, ck.drive("crank"))
>>> motion = ck.solve(crank, {"crank": ck.deg([0, 90])}, speed=3)
>>> motion.points["B"].velocity.xy.round(12).tolist()
[[0.0, 6.0], [-6.0, 0.0]]
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import compoundkin.dynamics
import compoundkin.view  # noqa: F401  (says how objects show themselves)
from compoundkin.base.moved_names import MOVED as _MOVED
from compoundkin.base.version import VERSION
from compoundkin.model.elements import drawn, drive, expect, link, mode
from compoundkin.model.geometry import deg, polar
from compoundkin.model.mechanism import Mechanism

if TYPE_CHECKING:
    from compoundkin import chains as chains
    from compoundkin import equations as equations
    from compoundkin import errors as errors
    from compoundkin import exchange as exchange
    from compoundkin import figures as figures
    from compoundkin import goals as goals
    from compoundkin import laws as laws
    from compoundkin import linkages as linkages
    from compoundkin import plots as plots
    from compoundkin import profiles as profiles
    from compoundkin import results as results
    from compoundkin import tasks as tasks
    from compoundkin.analysis.centres import instant_centres
    from compoundkin.analysis.characteristics.characteristics import characteristics
    from compoundkin.analysis.checks import verify
    from compoundkin.analysis.equations.loop_equations import loop_equations
    from compoundkin.analysis.interference import interference
    from compoundkin.analysis.singularities import singularities
    from compoundkin.configurations.circuit_search import circuits
    from compoundkin.configurations.enumeration import configurations
    from compoundkin.dimensional.cognates import cognates
    from compoundkin.dimensional.coupler_atlas import coupler_atlas
    from compoundkin.dimensional.dyads import dyads
    from compoundkin.dimensional.synthesis import synthesise
    from compoundkin.dynamics.force_analysis import force_analysis
    from compoundkin.dynamics.simulation.forward_dynamics import simulate
    from compoundkin.files import load
    from compoundkin.files.saved_files import save
    from compoundkin.kinematics import solve
    from compoundkin.kinematics.gaps import gaps
    from compoundkin.kinematics.quantities import quantity
    from compoundkin.model.loads.attachments import effort
    from compoundkin.model.loads.damper import damper
    from compoundkin.model.loads.force import force, torque
    from compoundkin.model.loads.friction import friction
    from compoundkin.model.loads.gravity import gravity
    from compoundkin.model.loads.latch import latch, release
    from compoundkin.model.loads.mass import mass
    from compoundkin.model.loads.motor import motor
    from compoundkin.model.loads.pressure import pressure
    from compoundkin.model.loads.pretension import pretension
    from compoundkin.model.loads.spring import spring
    from compoundkin.model.loads.stop import stop
    from compoundkin.model.outlines import outline
    from compoundkin.model.pairs.arc import arc
    from compoundkin.model.pairs.belt import belt
    from compoundkin.model.pairs.cam import cam
    from compoundkin.model.pairs.cylinder import cylinder
    from compoundkin.model.pairs.face import face
    from compoundkin.model.pairs.gear import gear
    from compoundkin.model.pairs.prismatic import slide
    from compoundkin.model.pairs.rack import rack
    from compoundkin.model.pairs.rolling import roll, roll_around
    from compoundkin.model.pairs.slot import slot
    from compoundkin.programs.compiled_path import compile
    from compoundkin.programs.dimensions import with_dimensions
    from compoundkin.structure import decompose
    from compoundkin.structure.redundancy import mobility_analysis
    from compoundkin.studies.optimisation.design_optimisation import optimise
    from compoundkin.studies.samples.value_ranges import around
    from compoundkin.studies.study import study
    from compoundkin.studies.tolerances.tolerance import tolerance
    from compoundkin.studio.notebook import studio
    from compoundkin.synthesis.alternatives import alternatives
    from compoundkin.synthesis.inversion import with_driver, with_frame
    from compoundkin.view.animation import animate
    from compoundkin.view.plot import plot
    from compoundkin.view.report import page, report
    from compoundkin.view.report.exercises import exercise
    from compoundkin.view.report.forces_section import sheet
    from compoundkin.view.sketch import draw

__version__ = VERSION

__all__ = [
    "Mechanism",
    "alternatives",
    "animate",
    "arc",
    "around",
    "belt",
    "cam",
    "characteristics",
    "circuits",
    "cognates",
    "compile",
    "configurations",
    "coupler_atlas",
    "cylinder",
    "damper",
    "decompose",
    "deg",
    "draw",
    "drawn",
    "drive",
    "dyads",
    "effort",
    "exercise",
    "expect",
    "face",
    "force",
    "force_analysis",
    "friction",
    "gaps",
    "gear",
    "gravity",
    "instant_centres",
    "interference",
    "latch",
    "link",
    "load",
    "loop_equations",
    "mass",
    "mobility_analysis",
    "mode",
    "motor",
    "optimise",
    "outline",
    "page",
    "plot",
    "polar",
    "pressure",
    "pretension",
    "quantity",
    "rack",
    "release",
    "report",
    "roll",
    "roll_around",
    "save",
    "sheet",
    "simulate",
    "singularities",
    "slide",
    "slot",
    "solve",
    "spring",
    "stop",
    "studio",
    "study",
    "synthesise",
    "tolerance",
    "torque",
    "verify",
    "with_dimensions",
    "with_driver",
    "with_frame",
]

# Two rooms have the name of a function: they are loaded once and their names given back, so that `__getattr__` finds
# the functions. The rooms themselves hold nothing, so that this costs nothing.
for _room in ("configurations", "studio"):
    import_module(f"compoundkin.{_room}")
    globals().pop(_room, None)

# What not every mechanism is written with is imported when it is first asked for: the module of each such word.
_LATE = {
    "alternatives": "synthesis.alternatives",
    "animate": "view.animation",
    "arc": "model.pairs.arc",
    "around": "studies.samples.value_ranges",
    "belt": "model.pairs.belt",
    "cam": "model.pairs.cam",
    "characteristics": "analysis.characteristics.characteristics",
    "circuits": "configurations.circuit_search",
    "cognates": "dimensional.cognates",
    "compile": "programs.compiled_path",
    "configurations": "configurations.enumeration",
    "coupler_atlas": "dimensional.coupler_atlas",
    "cylinder": "model.pairs.cylinder",
    "damper": "model.loads.damper",
    "decompose": "structure",
    "draw": "view.sketch",
    "dyads": "dimensional.dyads",
    "effort": "model.loads.attachments",
    "exercise": "view.report.exercises",
    "face": "model.pairs.face",
    "force": "model.loads.force",
    "force_analysis": "dynamics.force_analysis",
    "friction": "model.loads.friction",
    "gaps": "kinematics.gaps",
    "gear": "model.pairs.gear",
    "gravity": "model.loads.gravity",
    "instant_centres": "analysis.centres.instant_centres",
    "interference": "analysis.interference",
    "latch": "model.loads.latch",
    "load": "files",
    "loop_equations": "analysis.equations.loop_equations",
    "mass": "model.loads.mass",
    "mobility_analysis": "structure.redundancy.mobility_analysis",
    "motor": "model.loads.motor",
    "optimise": "studies.optimisation.design_optimisation",
    "outline": "model.outlines",
    "page": "view.report",
    "plot": "view.plot",
    "pressure": "model.loads.pressure",
    "pretension": "model.loads.pretension",
    "quantity": "kinematics.quantities",
    "rack": "model.pairs.rack",
    "release": "model.loads.latch",
    "report": "view.report",
    "roll": "model.pairs.rolling",
    "roll_around": "model.pairs.rolling",
    "save": "files.saved_files",
    "sheet": "view.report.forces_section",
    "simulate": "dynamics.simulation.forward_dynamics",
    "singularities": "analysis.singularities",
    "slide": "model.pairs.prismatic",
    "slot": "model.pairs.slot",
    "solve": "kinematics",
    "spring": "model.loads.spring",
    "stop": "model.loads.stop",
    "studio": "studio.notebook",
    "study": "studies.study",
    "synthesise": "dimensional.synthesis",
    "tolerance": "studies.tolerances.tolerance",
    "torque": "model.loads.force",
    "verify": "analysis.checks",
    "with_dimensions": "programs.dimensions",
    "with_driver": "synthesis.inversion",
    "with_frame": "synthesis.inversion",
}

# The modules that hold all other public names: no rooms, each a list of what rooms have.
_MODULES = (
    *("chains", "equations", "errors", "exchange", "figures"),
    *("goals", "laws", "linkages", "plots", "profiles", "results", "tasks"),
)


def __getattr__(name: str) -> Any:
    if name in _LATE:
        found = globals()[name] = getattr(import_module(f"compoundkin.{_LATE[name]}"), name)
        return found
    if name in _MODULES:
        return import_module(f"compoundkin.{name}")
    if name in _MOVED:
        raise AttributeError(f"compoundkin.{name} is now {_MOVED[name]}")
    what = f"module 'compoundkin' has no attribute {name!r}"
    raise AttributeError(what if name.startswith("_") else f"{what}{_meant(name)}")


def _meant(name: str) -> str:
    """Return what an unknown name means of the words of the modules, spelled otherwise or called so by others."""
    from compoundkin.base.errors import OTHER_WORDS, plain_word

    others = OTHER_WORDS.get(plain_word(name), ())
    words = [(f"{one}.", word) for one in _MODULES for word in import_module(f"compoundkin.{one}").__all__]
    words += [("", word) for word in __all__]
    meant = [f"compoundkin.{m}{word}" for m, word in words if plain_word(word) == plain_word(name) or word in others]
    return f"; did you mean {' or '.join(meant[:2])}?" if meant else ""


def __dir__() -> list[str]:
    return [*__all__, *_MODULES]
