"""A mechanism with all its lengths multiplied by a factor: nothing but units may change."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np

import compoundkin as ck
from compoundkin.model.elements import Drawn, Drive, Expectation, Link
from compoundkin.model.laws.constant_laws import ConstantAcceleration, ConstantSpeed
from compoundkin.model.laws.function_law import FunctionLaw
from compoundkin.model.laws.motion_programs import Program
from compoundkin.model.laws.table_laws import TimeTable
from compoundkin.model.loads.contract import Load
from compoundkin.model.loads.friction import Friction
from compoundkin.model.loads.gravity import Gravity
from compoundkin.model.loads.mass import Mass
from compoundkin.model.loads.pretension import Pretension
from compoundkin.model.prescribed_motion import PrescribedMotion
from compoundkin.model.prescribed_paths import CurvePath
from compoundkin.model.profiles.profile import DiscProfile, FormulaProfile, PointsProfile
from compoundkin.model.profiles.synthesised import Synthesised

# Lengths by the kind of their field; a number of teeth is declared as a length, for it may vary over designs too.
LENGTHS = {"length", "point"}
NO_LENGTHS = {"teeth"}
DIMENSIONS_OF_A_PROFILE = ("base", "roller", "offset", "arm", "face")


def scaled(mechanism: ck.Mechanism, factor: float) -> ck.Mechanism:
    """Return it with every length `factor` times as long, without its masses and loads and what was published of it."""
    drives = [driven for body in ck.decompose(mechanism).bodies for driven in body.driven if not driven.is_passive]
    lengths = {driven.drive.name for driven in drives if not driven.pair.free_is_angle}
    items = [
        _item(item, factor, isinstance(item, Drive) and (item.name or item.link) in lengths)
        for item in mechanism.items
        if not isinstance(item, Expectation | Mass | Gravity | Load | Friction | Pretension)
    ]
    outputs = mechanism.outputs if mechanism.units is None else ()
    return ck.Mechanism(mechanism.title, *items, outputs=outputs, time=mechanism.time)


def _item(item: Any, factor: float, is_length: bool) -> Any:
    if isinstance(item, Link | Drawn):
        return replace(item, points={k: None if p is None else p * factor for k, p in item.points.items()})
    if isinstance(item, PrescribedMotion) and item.point:
        laws = {"x": _law(item.x, factor), "y": _law(item.y, factor)}
        return replace(item, **laws, along=None if item.along is None else _path(item.along, factor))
    if isinstance(item, Drive):
        return _drive(item, factor) if is_length else item
    if is_dataclass(item) and not isinstance(item, type):
        return replace(item, **dict(_dimensions(item, factor)))
    return item


def _path(path: Any, factor: float) -> Any:
    if isinstance(path, CurvePath):
        return replace(path, profile=_profile(path.profile, factor), law=_law(path.law, factor))
    return replace(path, places=tuple(place * factor for place in path.places))


def _dimensions(pair: Any, factor: float) -> Any:
    for field in fields(pair):
        value, kind = getattr(pair, field.name), field.metadata.get("kind")
        if value is None or kind is None:
            continue
        if kind in LENGTHS and field.name not in NO_LENGTHS:
            yield field.name, value * factor
        elif kind == "two" and field.name in ("radii", "stroke"):
            yield field.name, tuple(v * factor for v in value)
        elif kind == "reach":
            yield field.name, tuple(end if end is None or isinstance(end, str) else end * factor for end in value)
        elif kind == "profile":
            yield field.name, _profile(value, factor)


def _drive(drive: Drive, factor: float) -> Drive:
    rates = {k: getattr(drive, k) * factor for k in ("speed", "acceleration", "jerk")}
    values = None if drive.values is None else drive.values * factor
    return replace(drive, values=values, law=_law(drive.law, factor), **rates)


def _law(law: Any, factor: float) -> Any:
    if law is None:
        return None
    if isinstance(law, ConstantSpeed | ConstantAcceleration):
        return replace(law, **{f.name: getattr(law, f.name) * factor for f in fields(law)})
    if isinstance(law, TimeTable):
        return replace(law, values=law.values * factor)
    if isinstance(law, FunctionLaw):
        return FunctionLaw(lambda t: _times(law.f(t), factor))
    assert isinstance(law, Program)
    segments = tuple(replace(part, rise=part.rise * factor) for part in law.segments)
    return replace(law, segments=segments, start=law.start * factor)


def _times(made: Any, factor: float) -> Any:
    return tuple(part * factor for part in made) if isinstance(made, tuple) else np.asarray(made) * factor


def _profile(profile: Any, factor: float) -> Any:
    if isinstance(profile, DiscProfile):
        return replace(profile, radius=profile.radius * factor, middle=profile.middle * factor)
    if isinstance(profile, PointsProfile):
        return replace(profile, points=tuple(p * factor for p in profile.points))
    if isinstance(profile, FormulaProfile):
        return replace(profile, function=lambda s: np.asarray(profile.function(s)) * factor)
    assert isinstance(profile, Synthesised)
    sizes = {k: getattr(profile, k) * factor for k in DIMENSIONS_OF_A_PROFILE}
    pivot = None if profile.pivot is None else profile.pivot * factor
    program = profile.program if profile.oscillates else _law(profile.program, factor)
    return replace(profile, **sizes, pivot=pivot, program=program)
