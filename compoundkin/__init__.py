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

import compoundkin.view  # noqa: F401  (says how objects show themselves)
from compoundkin.base.errors import (
    CompoundkinError,
    InvalidInput,
    InvalidMechanism,
    NotAssembled,
    NotDetermined,
    UnassembledPoses,
    UnknownName,
)
from compoundkin.base.version import VERSION
from compoundkin.kinematics import Motion, solve
from compoundkin.kinematics.gaps import Gap, gaps
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.elements import drawn, drive, expect, link, mode
from compoundkin.model.geometry import deg, polar
from compoundkin.model.laws import constant_acceleration, constant_speed, dwell, fall, program, rise, time_table
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import arc, belt, cam, face, gear, rack, roll, roll_around, slide, slot
from compoundkin.model.profiles import disc, formula, profile, synthesise
from compoundkin.structure import Structure, decompose
from compoundkin.structure.redundancy import MobilityAnalysis, mobility_analysis

if TYPE_CHECKING:
    from compoundkin.analysis.cam_analysis import CamAnalysis, cam_analysis
    from compoundkin.analysis.centres import instant_centres
    from compoundkin.analysis.checks import Check, Finding, verify
    from compoundkin.analysis.equations import loop_equations
    from compoundkin.analysis.equivalents import equivalent_linkage
    from compoundkin.configurations.circuit_search import circuits
    from compoundkin.configurations.enumeration import configurations
    from compoundkin.files import load, save
    from compoundkin.synthesis.alternatives import alternatives
    from compoundkin.synthesis.composer import Composer, random_mechanism
    from compoundkin.synthesis.inversion import with_driver, with_frame
    from compoundkin.view.animation import Animation, animate
    from compoundkin.view.page import Page
    from compoundkin.view.plot import plot
    from compoundkin.view.report import page, report
    from compoundkin.view.sketch import Picture, draw

__version__ = VERSION

__all__ = [
    "Animation",
    "CamAnalysis",
    "Check",
    "Composer",
    "CompoundkinError",
    "Finding",
    "Gap",
    "InvalidInput",
    "InvalidMechanism",
    "Mechanism",
    "MobilityAnalysis",
    "Motion",
    "NotAssembled",
    "NotDetermined",
    "Page",
    "Picture",
    "Structure",
    "UnassembledPoses",
    "UnknownName",
    "alternatives",
    "animate",
    "arc",
    "belt",
    "cam",
    "cam_analysis",
    "circuits",
    "configurations",
    "constant_acceleration",
    "constant_speed",
    "decompose",
    "deg",
    "disc",
    "draw",
    "drawn",
    "drive",
    "dwell",
    "equivalent_linkage",
    "expect",
    "face",
    "fall",
    "formula",
    "gaps",
    "gear",
    "instant_centres",
    "link",
    "load",
    "loop_equations",
    "mobility_analysis",
    "mode",
    "page",
    "plot",
    "polar",
    "profile",
    "program",
    "quantity",
    "rack",
    "random_mechanism",
    "report",
    "rise",
    "roll",
    "roll_around",
    "save",
    "slide",
    "slot",
    "solve",
    "synthesise",
    "time_table",
    "verify",
    "with_driver",
    "with_frame",
]

# A room has the name of a function: the room is loaded once and its name given back, so that `__getattr__` finds the
# function. The room itself holds nothing, so that this costs nothing.
import_module("compoundkin.configurations")
globals().pop("configurations", None)

# What only some programs need is imported when they ask for it: the module of each such word.
_LATE = {
    "Animation": "view.animation",
    "animate": "view.animation",
    "circuits": "configurations.circuit_search",
    "configurations": "configurations.enumeration",
    "CamAnalysis": "analysis.cam_analysis",
    "cam_analysis": "analysis.cam_analysis",
    "instant_centres": "analysis.centres",
    "Check": "analysis.checks",
    "Finding": "analysis.checks",
    "verify": "analysis.checks",
    "alternatives": "synthesis.alternatives",
    "Composer": "synthesis.composer",
    "random_mechanism": "synthesis.composer",
    "Picture": "view.sketch",
    "draw": "view.sketch",
    "loop_equations": "analysis.equations",
    "equivalent_linkage": "analysis.equivalents",
    "load": "files",
    "save": "files",
    "with_driver": "synthesis.inversion",
    "with_frame": "synthesis.inversion",
    "Page": "view.page",
    "page": "view.report",
    "plot": "view.plot",
    "report": "view.report",
}


_MODULES = {"chains": "synthesis.chains", "catalog": "files.shipped_mechanisms", "plots": "view.plot"}


def __getattr__(name: str) -> Any:
    if name in _LATE:
        return getattr(import_module(f"compoundkin.{_LATE[name]}"), name)
    if name in _MODULES:
        return import_module(f"compoundkin.{_MODULES[name]}")
    raise AttributeError(f"module 'compoundkin' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*__all__, *_MODULES]
