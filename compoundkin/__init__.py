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

from compoundkin.errors import (
    CompoundkinError,
    InvalidInput,
    InvalidMechanism,
    NotAssembled,
    NotDetermined,
    UnassembledPoses,
    UnknownName,
)
from compoundkin.freedom import MobilityAnalysis, mobility_analysis
from compoundkin.gaps import Gap, gaps
from compoundkin.laws import constant_acceleration, constant_speed, dwell, fall, program, rise, time_table
from compoundkin.mechanism import Mechanism
from compoundkin.motion import Motion, solve
from compoundkin.pairs import arc, belt, cam, face, gear, rack, roll, roll_around, slide, slot
from compoundkin.profiles import disc, formula, profile, synthesise
from compoundkin.quantities import quantity
from compoundkin.structure import Structure, decompose
from compoundkin.words import deg, drawn, drive, expect, link, mode, polar

if TYPE_CHECKING:
    from compoundkin.animation import Animation, animate
    from compoundkin.branches import circuits, configurations
    from compoundkin.cams import CamAnalysis, cam_analysis
    from compoundkin.centres import instant_centres
    from compoundkin.checks import Check, Finding, verify
    from compoundkin.choices import alternatives
    from compoundkin.composing import Composer, random_mechanism
    from compoundkin.drawing import Picture, draw, draw_structure, vector_polygon
    from compoundkin.equations import loop_equations
    from compoundkin.equivalents import equivalent_linkage
    from compoundkin.formats import load, save, save_table, to_pandas
    from compoundkin.inverting import with_driver, with_frame
    from compoundkin.pages import Page, page
    from compoundkin.plots import plot
    from compoundkin.reports import rendered, report

__version__ = "0.1.0"

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
    "draw_structure",
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
    "rendered",
    "report",
    "rise",
    "roll",
    "roll_around",
    "save",
    "save_table",
    "slide",
    "slot",
    "solve",
    "synthesise",
    "time_table",
    "to_pandas",
    "vector_polygon",
    "verify",
    "with_driver",
    "with_frame",
]

# What only some programs need is imported when they ask for it: the module of each such word.
_LATE = {
    "Animation": "animation",
    "animate": "animation",
    "circuits": "branches",
    "configurations": "branches",
    "CamAnalysis": "cams",
    "cam_analysis": "cams",
    "instant_centres": "centres",
    "Check": "checks",
    "Finding": "checks",
    "verify": "checks",
    "alternatives": "choices",
    "Composer": "composing",
    "random_mechanism": "composing",
    "Picture": "drawing",
    "draw": "drawing",
    "draw_structure": "drawing",
    "vector_polygon": "drawing",
    "loop_equations": "equations",
    "equivalent_linkage": "equivalents",
    "load": "formats",
    "save": "formats",
    "save_table": "formats",
    "to_pandas": "formats",
    "with_driver": "inverting",
    "with_frame": "inverting",
    "Page": "pages",
    "page": "pages",
    "plot": "plots",
    "rendered": "reports",
    "report": "reports",
}


def __getattr__(name: str) -> Any:
    if name in _LATE:
        return getattr(import_module(f"compoundkin.{_LATE[name]}"), name)
    if name in ("catalog", "plots"):
        return import_module(f"compoundkin.{name}")
    raise AttributeError(f"module 'compoundkin' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*__all__, "catalog", "plots"]
