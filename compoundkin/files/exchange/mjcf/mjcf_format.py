"""MuJoCo's XML files: a mechanism as a model with joints at zero in the pose as drawn."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from math import radians, tan
from typing import Any, ClassVar
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import numpy as np

from compoundkin.base.arrays import TURN, first_entry
from compoundkin.base.display import printable
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.contract import Exported, Writable
from compoundkin.files.exchange.foreign_texts import shortest
from compoundkin.files.exchange.mjcf.model_elements import (
    ModelLoads,
    add_shapes,
    body_elements,
    constraint_elements,
    driver_elements,
    fastest,
    place,
)
from compoundkin.files.exchange.mjcf.model_plan import ModelPlan, plan_of
from compoundkin.files.exchange.posed_mechanism import PosedMechanism
from compoundkin.model.geometry import FRAME

# In how many steps drivers catch up.
_OF_DRIVERS = 16.0


# MuJoCo's own name of the frame.
_WORLD = "world"


class MjcfFormat(Writable):
    """MuJoCo's models. They are written, not read."""

    name: ClassVar[str] = "mjcf"
    program: ClassVar[str] = "MuJoCo"
    title: ClassVar[str] = "MuJoCo model (MJCF)"
    suffix: ClassVar[str] = ".xml"

    def write(self, shown: PosedMechanism, **options: Any) -> Exported:
        """Return the model. Raises InvalidInput listing all that hinges, slides and their sums cannot say.

        >>> from compoundkin.files.exchange.posed_mechanism import posed_mechanism
        >>> from compoundkin.files import load
        >>> found = FORMAT.write(posed_mechanism(load("slider-crank")))
        >>> found.text.count("<body "), found.text.count("<connect ")
        (3, 1)
        """
        plan = plan_of(shown)
        bodies = body_elements(plan)
        loads = ModelLoads(plan, bodies)
        notes = (*_notes(plan, loads.left), *plan.notes)
        model = _model(plan, bodies, loads, notes)
        indent(model)
        return Exported(tostring(model, "utf-8", xml_declaration=False) + b"\n", self.name, notes)


def _model(plan: ModelPlan, bodies: Mapping[str, Element], loads: ModelLoads, notes: tuple[str, ...]) -> Element:
    """Return the whole model."""
    world = bodies[FRAME]
    add_shapes(plan, bodies)
    world.append(camera(plan))
    model = Element("mujoco", model=printable(plan.shown.mechanism.title))
    model.extend(settings(plan, notes))
    model.append(world)
    model.extend(constraint_elements(plan, loads.tendons))
    model.extend(driver_elements(plan, world, loads.actuators, _OF_DRIVERS * step_of(plan)))
    _hold_names(model)
    return model


def _notes(plan: ModelPlan, left: list[str]) -> Iterator[str]:
    """Yield in sentences what the numbers mean, and what of the mechanism is left out."""
    yield plan.units.told
    laws = [drive.name for drive in plan.shown.mechanism.drives if drive.law is not None]
    if laws:
        yield f"laws of time are not in a model: {', '.join(laws)} keeps the speed of this pose"
    for free in plan.shown.structure.passive:
        yield f"{free}: it is held as it is drawn"
    if left:
        yield f"loads that no model says are left out: {', '.join(left)}"


def _hold_names(model: Element) -> None:
    """Raise InvalidInput where two elements of one sort would have one name."""
    named = Counter({("body", _WORLD): 1})
    for section in model:
        within = section.iter() if section.tag == "worldbody" else iter(section)
        sort = "" if section.tag == "worldbody" else section.tag
        named.update((sort or own.tag, own.get("name", "")) for own in within if own.get("name"))
    twice = [
        Problem(name, f"two of one name: {sort}", "call one of them otherwise")
        for (sort, name), count in named.items()
        if count > 1
    ]
    if twice:
        raise InvalidInput(twice, heading="a model of MuJoCo has every name once")


FORMAT = MjcfFormat()


# The longest step (seconds), and how many make a turn of the fastest driver, or a way of six sizes.
_LONGEST, _STEPS = 2.5e-4, 2000


# In how many steps constraints catch up. Two are the least in MuJoCo, which suit where nothing moves fast beside the
# driver; with eight all shipped mechanisms run.
_OF_CONSTRAINTS = 8.0


# How hard constraints are, between MuJoCo's own 0.9 to 0.95 and 1: they stand for pairs.
_HARD = "0.99 0.999 0.001"


# What the camera sees: an angle (degrees), and so many times what is drawn.
_ANGLE, _ROOM = 30.0, 1.2


# The radius of points, by the mechanism's size.
_POINT = 0.006


def step_of(plan: ModelPlan) -> float:
    """Return the step of a model in seconds."""
    rate = fastest(plan)
    return min(_LONGEST, TURN / rate / _STEPS) if rate else _LONGEST


def settings(plan: ModelPlan, notes: tuple[str, ...]) -> Iterator[Element]:
    """Yield what stands before the bodies. The notes are in it, as texts."""
    yield Element("compiler", angle="radian", autolimits="true")
    fall, step = complex(first_entry(plan.shown.mechanism.gravity)), step_of(plan)
    option = Element("option", timestep=shortest(step), integrator="implicitfast", gravity=place(fall))
    SubElement(option, "flag", contact="disable")
    yield option
    middle, width = _view(plan)
    yield Element("statistic", center=place(middle), extent=shortest(width))
    defaults = Element("default")
    SubElement(defaults, "equality", solref=f"{shortest(_OF_CONSTRAINTS * step)} 1", solimp=_HARD)
    SubElement(defaults, "geom", contype="0", conaffinity="0")
    SubElement(defaults, "site", size=shortest(_POINT * plan.size))
    yield defaults
    yield from _appearance()
    custom = Element("custom")
    for k, note in enumerate(notes):
        SubElement(custom, "text", name=f"note {k + 1}", data=printable(note))
    yield custom


def _appearance() -> Iterator[Element]:
    """Yield light from the eye, and a bright background."""
    visual, asset = Element("visual"), Element("asset")
    SubElement(visual, "headlight", ambient="0.5 0.5 0.5", diffuse="0.5 0.5 0.5", specular="0.1 0.1 0.1")
    SubElement(asset, "texture", type="skybox", builtin="flat", rgb1="1 1 1", rgb2="1 1 1", width="8", height="8")
    yield from (visual, asset)


def camera(plan: ModelPlan) -> Element:
    """Return a camera that looks at the plane, y being up."""
    middle, width = _view(plan)
    height = _ROOM * width / 2.0 / tan(radians(_ANGLE / 2.0))
    at = f"{shortest(middle.real)} {shortest(middle.imag)} {shortest(height)}"
    return Element("camera", name="plane", pos=at, xyaxes="1 0 0 0 1 0", fovy=shortest(_ANGLE))


def _view(plan: ModelPlan) -> tuple[complex, float]:
    """Return the middle and the width of what is seen: of all poses, where they are known."""
    shown = plan.shown
    seen = np.array([shown.place(link, own) for link, points in shown.points.items() for own in points.values()])
    if shown.motion is not None:
        moved = [np.ravel(shown.motion.points[letter].position) for letter in shown.mechanism.carriers]
        seen = np.concatenate([seen, *moved])
    found = seen * plan.units.length
    sides = [(np.nanmin(part), np.nanmax(part)) for part in (found.real, found.imag)]
    middle = complex(*(float(low + high) / 2.0 for low, high in sides))
    return middle, float(max(*(high - low for low, high in sides), 0.1 * plan.size))
